#include "lubrication.h"

#include "keywords.h"

#include "comm.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

Lubrication::Lubrication(LAMMPS *lmp, const std::string &command) : Pointers(lmp), command(command)
{
}

Lubrication::~Lubrication()
{
  sd_lubrication_free(&near);
  sd_two_sphere_free(functions);
}

/* What may fail on one rank alone */
void Lubrication::check(sd_status status) const
{
  if (status != SD_OK)
    fail_one(lmp, command + ": keyword lubrication: " + sd_status_string(status));
}

/* Functions for all pairs that there are, made anew when radii become more different. */
void Lubrication::provide(double largest, double smallest)
{
  const double ratio = largest / smallest;
  if (ratio <= largest_ratio) return;
  sd_two_sphere *wider = nullptr;
  const sd_status status = sd_two_sphere_create(ratio, &wider);
  if (status == SD_EOUTSIDE)
    fail(lmp,
         command + ": keyword lubrication: radii from " + text(smallest) + " to " + text(largest) +
             ": it knows pairs up to a ratio of 100; use group to select, or lubrication no");
  check(status);
  sd_two_sphere_free(functions);
  functions = wider;
  largest_ratio = ratio;
}

void Lubrication::place(Scene &where, const Ambient &ambient)
{
  if (where.largest() > 0.0) provide(where.largest(), where.smallest());
  u = where.rows(6, [&](int i, double *out) { ambient.fluid(i, out); });
  where.drift(u.data(), 6, 1.0);
  sd_lubrication_scene scene = {};
  scene.functions = functions;
  scene.gap = settings.gap;
  scene.range = settings.range;
  scene.n = where.size();
  scene.n_all = where.size_with_copies();
  scene.spheres = where.local();
  scene.body = where.all_molecules().data();
  scene.u = u.data();
  scene.drift = where.drift_of_copies();
  scene.world.ctx = &where;
  scene.world.me = comm->me;
  scene.world.ranks = comm->nprocs;
  scene.world.refresh = Scene::refresh;
  scene.world.reduce = Scene::reduce;
  scene.world.sum = Scene::sum;
  check(sd_lubrication_place(&near, &scene));
}

void Lubrication::forces(const double *v, double *out)
{
  check(sd_lubrication_apply(&near, v, out));
  for (long j = 0; j < 6 * (long) near.n; j++) out[j] = near.carried[j] - out[j];
}

double Lubrication::memory_usage() const
{
  return sizeof(double) * (14.0 * near.count + 64.0 * near.n_all);
}

}    // namespace StokesDyn
