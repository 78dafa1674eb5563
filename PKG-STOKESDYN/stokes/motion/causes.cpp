#include "causes.h"

#include "hydrodynamics.h"

#include "sd_hash.h"

#include "atom.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

void Causes::find(const Hydrodynamics &hydro, double *all) const
{
  const int width = hydro.scene.width();
  double sums[KINDS] = {0.0}, fluid[6], of_box[3], given[6], pushed[6];
  sd_squirmer_stroke stroke;
  for (int i : hydro.ambient.who()) {
    const uint64_t tag = atom->tag[i];
    const double eta = hydro.ambient.viscosity(i);
    hydro.ambient.fluid(i, fluid);
    if (hydro.ambient.jumps()) {    // LAMMPS may have made an image of it since
      sd_box_flow_at(&hydro.ambient.box_motion().flow, atom->x[i], of_box);
      for (int d = 0; d < 3; d++) fluid[d] -= of_box[d];
      sd_hash_add_row(tag, hydro.ambient.box_motion().flow.gradient, 9, sums + 4);
    }
    drives.load(i, pushed);
    sd_hash_add_row(tag, pushed, 3, sums);
    if (atom->torque_flag) sd_hash_add_row(tag, pushed + 3, 3, sums + 2);
    sd_hash_add_row(tag, fluid, width, sums + 4);
    sd_hash_add_row(tag, &eta, 1, sums + 6);
    if (drives.holds_any() && drives.known(i, given) != SD_BODY_FREE) sd_hash_add_row(tag, given, 6, sums + 8);
    if (drives.stroke(i, stroke)) {
      const double row[6] = {stroke.e[0], stroke.e[1], stroke.e[2], stroke.B1, stroke.B2, stroke.beta};
      sd_hash_add_row(tag, row, 6, sums + 8);
    }
  }
  MPI_Allreduce(sums, all, KINDS, MPI_DOUBLE, MPI_SUM, world);
  find_kinds(hydro, all + KINDS);
}

/* The fingerprint of who is free, held, pinned or spun */
void Causes::find_kinds(const Hydrodynamics &hydro, double *kinds) const
{
  double sums[ALL - KINDS] = {0.0}, given[6];
  for (int i : hydro.ambient.who()) {
    const double kind = drives.holds_any() ? drives.known(i, given) : SD_BODY_FREE;
    sd_hash_add_row(atom->tag[i], &kind, 1, sums);
  }
  MPI_Allreduce(sums, kinds, ALL - KINDS, MPI_DOUBLE, MPI_SUM, world);
}

void Causes::note(const Hydrodynamics &hydro)
{
  if (due) find(hydro, prints);
  due = false;
}

/* A print, and its size behind it */
static bool same_print(const double *now, const double *then)
{
  return std::fabs(now[0] - then[0]) <= 1e-8 * std::max(now[1], then[1]);
}

bool Causes::stand(const Hydrodynamics &hydro, int which) const
{
  double now[ALL];
  find(hydro, now);
  bool same = true;
  for (int k = 0; k < which; k += 2) same = same && same_print(now + k, prints + k);
  return same;
}

bool Causes::others_held(const Hydrodynamics &hydro)
{
  if (!drives.holds_any()) return false;
  double now[ALL - KINDS], *then = prints + KINDS;
  find_kinds(hydro, now);
  const bool same = same_print(now, then);
  std::copy_n(now, (int) (ALL - KINDS), then);
  return !same;
}

}    // namespace StokesDyn
