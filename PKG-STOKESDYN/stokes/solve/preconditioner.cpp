#include "preconditioner.h"

#include "callback.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"

#include <algorithm>
#include <map>

using namespace LAMMPS_NS;

namespace StokesDyn {

using Settings = StokesSettings;

// Do solves begin near to what is good enough? From the last ones, to a tolerance that leaves an iteration or two.
static bool easy(const Settings &settings)
{
  return settings.history() && settings.tolerance >= 1e-3;
}

/* Unknowns whose matrix is inverted as it is. A product with the inverse takes about as long as one
 * with the matrix, making it as long as some hundred. */
static const int FEW = 200;

/* The rule, which the page has too. */
const sd_precondition_kind *Preconditioner::suited() const
{
  const bool periodic = engine.splitting() && engine.splitting()->box.periodic;
  Settings::Precondition that = settings.precondition;
  if (that == Settings::AUTO) {
    if (periodic)
      that = Settings::WAVES;
    else if (of_all())
      that = !few() ? Settings::SPARSE : easy(settings) ? Settings::NONE : Settings::CLUMP;
    else
      that = atom->molecule ? Settings::CLUMP : Settings::NONE;
  }
  switch (that) {
    case Settings::CLUMP:
      return &sd_precondition_blocks;
    case Settings::SPARSE:
      return &sd_precondition_sparse;
    case Settings::WAVES:
      return &sd_precondition_waves;
    default:
      return nullptr;
  }
}

bool Preconditioner::few() const
{
  return of_all() && scene.width() * count() <= FEW;
}

void Preconditioner::attach(sd_system &system, FixStokesDynamicsState &kept_in)
{
  put_in.never();
  memory = &kept_in;
  wanted = suited();
  if (!wanted) return forget();
  system.precondition = apply;
  system.precondition_ctx = this;
}

/* On all ranks alike. */
void Preconditioner::refresh_places()
{
  double sums[SD_MOVED];
  const bool known = memory->moved_since_made(scene.who(), sums);
  std::vector<double> now;
  if (wanted == &sd_precondition_waves)
    now = {domain->prd[0], domain->prd[1], domain->prd[2], domain->xy, domain->xz, domain->yz};
  if (!known || sd_moved_too_far(sums) || memory->global.made_of != now) memory->made_here(scene.who(), now);
}

/* x: where the spheres stood, in the order of the preconditioner's rows */
void Preconditioner::find_positions()
{
  std::vector<double> rows =
      scene.rows(3, [this](int i, double *out) { std::copy_n(memory->made_at[i], 3, out); });
  x.resize(3 * (size_t) count() + 3);
  if (of_all())
    engine.cloud.to_all(rows.data(), x.data(), 3);
  else
    x.swap(rows);
}

/* The spheres of each block. */
void Preconditioner::group()
{
  first.assign(1, 0);
  member.clear();
  if (settings.precondition == Settings::AUTO && few()) {
    for (int i = 0; i < count(); i++) member.push_back(i);
    first.push_back(count());
  } else if (wanted != &sd_precondition_sparse)
    group_by_molecule();
}

/* Members of each molecule with two spheres or more. */
void Preconditioner::group_by_molecule()
{
  std::map<int64_t, std::vector<int>> clumps;
  for (int i = 0, n = count(); i < n && atom->molecule; i++) {
    const int64_t molecule = of_all() ? engine.cloud.molecules()[i] : scene.molecule(i);
    if (molecule != 0 && spheres().a[i] > 0.0) clumps[molecule].push_back(i);
  }
  for (const auto &clump : clumps) {
    if (clump.second.size() < 2) continue;
    member.insert(member.end(), clump.second.begin(), clump.second.end());
    first.push_back(member.size());
  }
  if (scene.settings.boundary.walled()) add_lone();
}

/* A sphere near a wall is a clump with its image. */
void Preconditioner::add_lone()
{
  const int n = count();
  std::vector<char> bound(n + 1, 0);
  for (int i : member) bound[i] = 1;
  for (int i = 0; i < n; i++) {
    if (bound[i] || !(spheres().a[i] > 0.0)) continue;
    member.push_back(i);
    first.push_back(member.size());
  }
}

/* A clump may lie across a periodic boundary. */
void Preconditioner::put_side_by_side()
{
  const Lattice lattice = Lattice::of(domain);
  for (size_t k = 0; k + 1 < first.size(); k++)
    for (long m = first[k] + 1; m < first[k + 1]; m++) {
      int steps[3];
      sd_bring_close(lattice.h, lattice.periodic, &x[3 * (size_t) member[first[k]]],
                     &x[3 * (size_t) member[m]], steps);
    }
}

sd_status Preconditioner::put()
{
  refresh_places();
  find_positions();
  group();
  if (!of_all()) put_side_by_side();
  sd_precondition_case c = {};
  c.law = scene.settings.law();
  c.spheres = {x.data(), spheres().a, spheres().w};
  c.n = count();
  c.width = scene.width();
  c.clumps = first.size() - 1;
  c.first = first.data();
  c.member = member.data();
  if (wanted == &sd_precondition_waves) c.box = &engine.splitting()->box;
  c.part = of_all() ? comm->me : 0;
  c.parts = of_all() ? comm->nprocs : 1;
  c.world = engine.ranks();
  return sd_preconditioner_make(&made, wanted, &c);
}

sd_status Preconditioner::apply(void *ctx, const double *r, double *z)
{
  Preconditioner *p = static_cast<Preconditioner *>(ctx);
  return callback([=] {
    const bool of_all = p->of_all();
    const size_t width = p->scene.width(), own = width * p->scene.size(), all = width * p->count();
    if (!p->put_in.is(p->scene.all_epochs().step)) {
      const sd_status status = p->put();
      if (status != SD_OK) return status;
      p->put_in.set(p->scene.all_epochs().step);
    }
    p->in.resize(all + 1);
    p->out.resize(all + 1);
    if (of_all)
      p->engine.cloud.to_all(r, p->in.data(), width);
    else
      std::copy_n(r, own, p->in.begin());
    const sd_status status =
        sd_preconditioner_apply(&p->made, p->spheres().w, p->in.data(), p->out.data());
    if (of_all)
      p->engine.cloud.to_own(p->out.data(), z, width);
    else
      std::copy_n(p->out.begin(), own, z);
    return status;
  });
}

double Preconditioner::memory_usage() const
{
  return sizeof(double) * (double) (x.capacity() + in.capacity() + out.capacity());
}

}    // namespace StokesDyn
