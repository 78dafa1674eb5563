#include "preconditioner.h"

#include "callback.h"
#include "lammps_compat.h"

#include "atom.h"
#include "comm.h"

#include <algorithm>
#include <cmath>
#include <map>

using namespace LAMMPS_NS;

namespace StokesDyn {

static const double RHO = 3.0;    // reach of the sparse factor: 42 blocks a sphere in a compact cloud

void Preconditioner::release()
{
  if (made) made->free(state.data());
  made = nullptr;
  place = LOST;
}

void Preconditioner::forget()
{
  release();
  wanted = nullptr;
  choice = {};
  candidate = NONE;
}

std::vector<double> Preconditioner::pack() const
{
  return {(double) candidate, choice.with,  choice.spent, choice.solves,
          choice.mean,        choice.other, choice.ratio};
}

void Preconditioner::unpack(const std::vector<double> &v)
{
  const bool ours = v.size() == pack().size();
  candidate = ours ? (Kind) (int) v[0] : NONE;
  choice = ours ? sd_choice{v[1], v[2], v[3], v[4], v[5], v[6]} : sd_choice();
}

/* The spheres that a preconditioner has to do with, but not yet their clumps. */
void Preconditioner::look(const sd_system &system)
{
  const auto &settings = scene.settings;
  extent = scene.view() == SD_VIEW_ALL                      ? CLOUD
      : settings.clumps_only && std::isinf(settings.cutoff) ? WHOLE_CLUMPS
                                                            : OWN_PARTS;
  seen = {};
  seen.law = scene.law();
  seen.width = system.spin ? 6 : 3;
  seen.parts = 1;
  seen.sum = Scene::sum;
  seen.sum_ctx = &scene;
  if (const sd_ewald *e = scene.splitting())
    if (e->box.periodic) seen.box = &e->box;
  if (extent == CLOUD) {
    seen.n = scene.cloud_size();
    seen.spheres = scene.cloud();
    seen.rho = RHO;
    seen.part = comm->me;
    seen.parts = comm->nprocs;
  } else {
    seen.n = scene.size();
    seen.spheres = scene.local();
  }
  first.assign(1, 0);
  member.clear();
}

/* Members of each molecule with two spheres or more; true if they are at least half of the
 * spheres. */
bool Preconditioner::group_by_molecule()
{
  const bool cloud = extent == CLOUD;
  if (!atom->molecule) return false;
  std::map<int64_t, std::vector<int>> clumps;
  size_t spheres = 0;
  for (int i = 0; i < seen.n; i++) {
    if (!(seen.spheres.a[i] > 0.0)) continue;
    spheres++;
    const int64_t molecule =
        cloud ? scene.cloud_molecules()[i] : scene.molecule(i);
    if (molecule != 0) clumps[molecule].push_back(i);
  }
  for (const auto &clump : clumps) {
    if (clump.second.size() < 2) continue;
    member.insert(member.end(), clump.second.begin(), clump.second.end());
    first.push_back(member.size());
  }
  return 2 * member.size() >= spheres && !member.empty();
}

/* The same where every sphere sees all of its clump, in images that are next to one another. A
 * clump that this rank has at two borders of a periodic box comes twice, as it is seen from either;
 * no atom is in two blocks. */
void Preconditioner::group_by_list()
{
  const sd_pairs &list = scene.list();
  const int n = scene.size();
  std::vector<char> done(n, 0);
  for (int i = 0; i < n; i++) {
    if (done[i] || list.first[i] == list.first[i + 1]) continue;
    member.push_back(i);
    for (long k = list.first[i]; k < list.first[i + 1]; k++) {
      const int j = list.neighbor[k];
      member.push_back(j);
      if (j < n) done[j] = 1;
    }
    first.push_back(member.size());
  }
}

/* Sum of the squares of the sizes of all clumps. */
static double squares(const std::vector<long> &first)
{
  double sum = 0.0;
  for (size_t k = 0; k + 1 < first.size(); k++) {
    const double m = first[k + 1] - first[k];
    sum += m * m;
  }
  return sum;
}

/* On all ranks together. A whole clump of m spheres has m (m - 1) pairs, so that its blocks need
 * not be looked at. */
sd_cost Preconditioner::cost_by_list()
{
  const double n = scene.size(), pairs = scene.cost_of_product();
  double sums[3] = {n, pairs, extent == WHOLE_CLUMPS ? pairs + n : squares(first)};
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, world);
  if (sums[1] == 0.0 || sums[2] == 0.0) return {};
  return sd_cost_blocks_by_list(sums[0], seen.width, sums[1], sums[2]);
}

/* The blocks of clumps, if there are any, go with the waves. */
sd_cost Preconditioner::cost_of_waves()
{
  double stored = squares(first);
  MPI_Allreduce(MPI_IN_PLACE, &stored, 1, MPI_DOUBLE, MPI_SUM, world);
  return sd_cost_waves(scene.splitting(), seen.width, stored);
}

/* Which one a scene would have. */
Preconditioner::Kind Preconditioner::suited()
{
  const bool grouped = extent != WHOLE_CLUMPS && kind != SPARSE && group_by_molecule();
  if (kind != AUTO) return kind;
  if (seen.box) return WAVES;
  return grouped || extent != CLOUD ? CLUMP : SPARSE;
}

/* auto: the long waves of a periodic box; in others blocks where there are clumps, else the sparse
 * factor; or nothing, if that costs less. The same on all ranks: the solver's sums and most
 * applications are collective. A solve from zero in a run of warm starts is alone of its kind, and
 * decided alone. */
bool Preconditioner::choose(Kind that, bool lost)
{
  if (that == WAVES)
    cost = cost_of_waves();
  else if (extent != CLOUD)
    cost = cost_by_list();
  else if (that == CLUMP)
    cost = sd_cost_blocks(seen.n, seen.width, first.size() - 1, squares(first));
  else
    cost = sd_cost_sparse(seen.n, seen.width);
  if (kind != AUTO) {
    choice.with = SD_WITH_FOR_GOOD;
    return true;
  }
  if (cost.iteration == 0.0) return false;
  const double unknowns = extent == CLOUD ? (double) seen.width * seen.n : INFINITY;
  const bool at_once = sd_choice_at_once(&cost, tolerance, unknowns);
  if (candidate != that) {
    choice = {};
    candidate = that;
    choice.with = at_once && !warm_start ? SD_WITH : SD_WITHOUT;
  }
  if (lost) sd_choice_lost(&choice, &cost);
  return alone ? at_once : choice.with != SD_WITHOUT;
}

void Preconditioner::attach(sd_system &system)
{
  wanted = nullptr;
  cost = {};
  alone = warm_start && !system.warm;
  if (kind == NONE) return;
  look(system);
  const Kind that = suited();
  wanted = that == WAVES ? &sd_precondition_waves
      : that == CLUMP    ? &sd_precondition_blocks
                         : &sd_precondition_sparse;
  const bool changed = lasts() && scene.spheres_changed();
  const bool kept = place != LOST && made != &sd_precondition_none && lasts();
  if (!choose(that, kept && changed)) {
    wanted = nullptr;
    return release();
  }
  place = kept && !changed && made == wanted ? ELSEWHERE : LOST;
  if (extent == WHOLE_CLUMPS) group_by_list();
  seen.clumps = first.size() - 1;
  seen.first = first.data();
  seen.member = member.data();
  system.precondition = apply;
  system.precondition_ctx = this;
}

sd_status Preconditioner::make(const sd_precondition_kind *which)
{
  release();
  state.assign(which->size / sizeof(double) + 1, 0.0);
  made = which;
  return which->make(state.data(), &seen);
}

/* Makes or moves it for the spheres of this solve: at its first use, since a warm start often needs
 * none at all. What cannot be made is done without. */
sd_status Preconditioner::put()
{
  if (extent == OWN_PARTS) {    // a clump may lie across a periodic boundary: images side by side
    const double *x = seen.spheres.x;
    near.assign(x, x + 3 * (size_t) seen.n);
    near.resize(3 * (size_t) seen.n + 3);
    for (int k = 0; k < seen.clumps; k++)
      for (long m = first[k] + 1; m < first[k + 1]; m++) {
        const double *begin = x + 3 * (long) member[first[k]], *there = x + 3 * (long) member[m];
        double d[3] = {there[0] - begin[0], there[1] - begin[1], there[2] - begin[2]};
        Compat::minimum_image(domain, d);
        for (int c = 0; c < 3; c++) near[3 * (size_t) member[m] + c] = begin[c] + d[c];
      }
    seen.spheres.x = near.data();
  }
  sd_status status = SD_OK;
  if (place == ELSEWHERE) {
    status = made->move(state.data(), &seen);
    if (status != SD_OK) place = LOST;
  }
  if (place == LOST) status = make(wanted);
  if (status != SD_OK) status = make(&sd_precondition_none);
  if (status == SD_OK) place = HERE;
  return status;
}

sd_status Preconditioner::apply(void *ctx, const double *r, double *z)
{
  Preconditioner *p = static_cast<Preconditioner *>(ctx);
  return callback([=] {
    const size_t width = p->seen.width, own = width * p->scene.size();
    const bool cloud = p->extent == CLOUD;
    sd_status status = p->place == HERE ? SD_OK : p->put();
    if (status != SD_OK) return status;
    p->in.resize(width * p->seen.n + 1);
    if (cloud)
      p->scene.to_cloud(r, p->in.data(), width);
    else
      p->in.assign(r, r + own);
    p->out.resize(width * p->seen.n + 1);
    status = p->made->apply(p->state.data(), p->in.data(), p->out.data());
    if (cloud)
      p->scene.from_cloud(p->out.data(), z, width);
    else
      std::copy_n(p->out.begin(), own, z);
    return status;
  });
}

void Preconditioner::learn(const sd_solve_report &report)
{
  if (alone || cost.iteration == 0.0) return;
  if (sd_choice_learn(&choice, &cost, report.iterations)) place = LOST;
}

}    // namespace StokesDyn
