#include "preconditioner.h"

#include "callback.h"
#include "lammps_compat.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"

#include <algorithm>
#include <cmath>
#include <map>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* The rule, which the page has too. */
const sd_precondition_kind *Preconditioner::suited() const
{
  const bool periodic = scene.splitting() && scene.splitting()->box.periodic;
  Kind that = kind;
  if (kind == AUTO) {
    if (periodic)
      that = WAVES;
    else if (extent == CLOUD)
      that = SPARSE;
    else
      that = atom->molecule ? CLUMP : NONE;
  }
  switch (that) {
    case CLUMP:
      return &sd_precondition_blocks;
    case SPARSE:
      return &sd_precondition_sparse;
    case WAVES:
      return &sd_precondition_waves;
    default:
      return nullptr;
  }
}

void Preconditioner::attach(sd_system &system, AtomRows &at, std::vector<double> &its_box)
{
  const auto &settings = scene.settings;
  extent = scene.view() == SD_VIEW_ALL                      ? CLOUD
      : settings.clumps_only && std::isinf(settings.cutoff) ? WHOLE_CLUMPS
                                                            : OWN_PARTS;
  n = extent == CLOUD              ? scene.cloud_size()
      : extent == WHOLE_CLUMPS ? scene.size_with_ghosts()
                               : scene.size();
  width = system.spin ? 6 : 3;
  ready = false;
  places = &at;
  box = &its_box;
  wanted = suited();
  if (!wanted) return forget();
  system.precondition = apply;
  system.precondition_ctx = this;
}

/* Lengths of the periodic edges, and tilts */
static std::vector<double> periodic_lengths(const Domain *domain)
{
  std::vector<double> box = {domain->xy, domain->xz, domain->yz};
  for (int d = 0; d < 3; d++) box.push_back(domain->periodicity[d] ? domain->prd[d] : 0.0);
  return box;
}

/* On all ranks alike. */
void Preconditioner::refresh_places()
{
  double sums[SD_MOVED + 1] = {0.0}, &without = sums[SD_MOVED];
  for (int i : scene.who()) {
    const double *was = (*places)[i];
    double d[3] = {atom->x[i][0] - was[0], atom->x[i][1] - was[1], atom->x[i][2] - was[2]};
    if (!places->has(i)) {
      without++;
      continue;
    }
    Compat::minimum_image(domain, d);
    sd_moved_add(sums, d, atom->radius[i]);
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, SD_MOVED + 1, MPI_DOUBLE, MPI_SUM, world);
  const std::vector<double> now = periodic_lengths(domain);
  if (without == 0.0 && !sd_moved_too_far(sums) && *box == now) return;
  *box = now;
  for (int i : scene.who()) std::copy_n(atom->x[i], 3, places->give(i));
}

/* x: where the spheres stood, in the order of the preconditioner's rows */
void Preconditioner::find_positions()
{
  const size_t own = scene.size();
  rows.resize(3 * own + 3);
  for (size_t k = 0; k < own; k++) std::copy_n((*places)[scene.who()[k]], 3, &rows[3 * k]);
  x.resize(3 * (size_t) n + 3);
  if (extent == CLOUD)
    scene.to_cloud(rows.data(), x.data(), 3);
  else
    std::copy_n(rows.begin(), 3 * own, x.begin());
  if (extent == WHOLE_CLUMPS) scene.refresh_ghosts(rows.data(), &x[3 * own], 3);
}

/* Members of each molecule with two spheres or more. */
void Preconditioner::group_by_molecule()
{
  std::map<int64_t, std::vector<int>> clumps;
  for (int i = 0; i < n && atom->molecule; i++) {
    const int64_t molecule = extent == CLOUD ? scene.cloud_molecules()[i]
                                             : (int64_t) atom->molecule[scene.who()[i]];
    if (molecule != 0 && spheres().a[i] > 0.0) clumps[molecule].push_back(i);
  }
  for (const auto &clump : clumps) {
    if (clump.second.size() < 2) continue;
    member.insert(member.end(), clump.second.begin(), clump.second.end());
    first.push_back(member.size());
  }
}

/* The same where every sphere sees all of its clump, in images that are next to one another. A
 * clump that this rank has at two borders of a periodic box comes twice, as it is seen from either;
 * no atom is in two blocks. The order of the list does not matter. */
void Preconditioner::group_by_list()
{
  const sd_pairs &list = scene.list();
  const int own = scene.size();
  std::vector<char> done(own, 0);
  for (int i = 0; i < own; i++) {
    if (done[i] || list.first[i] == list.first[i + 1]) continue;
    member.push_back(i);
    for (long k = list.first[i]; k < list.first[i + 1]; k++) {
      const int j = list.neighbor[k];
      member.push_back(j);
      if (j < own) done[j] = 1;
    }
    std::sort(member.begin() + first.back(), member.end());
    first.push_back(member.size());
  }
}

/* A clump may lie across a periodic boundary. */
void Preconditioner::put_side_by_side()
{
  for (size_t k = 0; k + 1 < first.size(); k++)
    for (long m = first[k] + 1; m < first[k + 1]; m++) {
      const double *begin = &x[3 * (size_t) member[first[k]]];
      double *there = &x[3 * (size_t) member[m]];
      double d[3] = {there[0] - begin[0], there[1] - begin[1], there[2] - begin[2]};
      Compat::minimum_image(domain, d);
      for (int c = 0; c < 3; c++) there[c] = begin[c] + d[c];
    }
}

sd_status Preconditioner::put()
{
  refresh_places();
  find_positions();
  first.assign(1, 0);
  member.clear();
  if (extent == WHOLE_CLUMPS)
    group_by_list();
  else if (wanted != &sd_precondition_sparse)
    group_by_molecule();
  if (extent != CLOUD) put_side_by_side();
  sd_precondition_case c = {};
  c.law = scene.law();
  c.spheres = {x.data(), spheres().a, spheres().w};
  c.n = n;
  c.width = width;
  c.clumps = first.size() - 1;
  c.first = first.data();
  c.member = member.data();
  if (wanted == &sd_precondition_waves) c.box = &scene.splitting()->box;
  c.part = extent == CLOUD ? comm->me : 0;
  c.parts = extent == CLOUD ? comm->nprocs : 1;
  c.sum = Scene::sum;
  c.sum_ctx = &scene;
  return sd_preconditioner_make(&made, wanted, &c);
}

sd_status Preconditioner::apply(void *ctx, const double *r, double *z)
{
  Preconditioner *p = static_cast<Preconditioner *>(ctx);
  return callback([=] {
    const size_t width = p->width, own = width * p->scene.size();
    if (!p->ready) {
      const sd_status status = p->put();
      if (status != SD_OK) return status;
      p->ready = true;
    }
    p->in.resize(width * p->n + 1);
    p->out.resize(width * p->n + 1);
    if (p->extent == CLOUD)
      p->scene.to_cloud(r, p->in.data(), width);
    else
      std::copy_n(r, own, p->in.begin());
    if (p->extent == WHOLE_CLUMPS) p->scene.refresh_ghosts(r, &p->in[own], width);
    const sd_status status =
        sd_preconditioner_apply(&p->made, p->spheres().w, p->in.data(), p->out.data());
    if (p->extent == CLOUD)
      p->scene.from_cloud(p->out.data(), z, width);
    else
      std::copy_n(p->out.begin(), own, z);
    return status;
  });
}

double Preconditioner::memory_usage() const
{
  return sizeof(double) *
      (double) (rows.capacity() + x.capacity() + in.capacity() + out.capacity());
}

}    // namespace StokesDyn
