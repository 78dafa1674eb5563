/* Of fix stokes_dynamics/overdamped: do velocities of the step before still count, where a run begins? They do
 * if spheres stand as they did, and what their velocities follow from is the same. */
#include "fix_stokes_dynamics_overdamped.h"

#include "sd_hash.h"

#include "atom.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

/* Does the run begin where, and as, the last one ended? Then the velocities of before still count. */
bool FixStokesDynamicsOverdamped::goes_on(const Hydrodynamics &hydro) const
{
  int moved = last.step != update->ntimestep || !hydro.memory->box_left_as_is();
  for (int i : hydro.ambient.who())
    if (!hydro.memory->placed_as_left(i)) moved = 1;
  return !largest_of_all(world, moved);
}

/* Fingerprints of force, torque, fluid and viscosity: where spheres stand as they did, their velocities
 * follow from these. */
void FixStokesDynamicsOverdamped::find_causes(const Hydrodynamics &hydro, double *causes) const
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
  MPI_Allreduce(sums, causes, KINDS, MPI_DOUBLE, MPI_SUM, world);
  find_kinds(hydro, causes + KINDS);
}

/* The fingerprint of who is free, held, pinned or spun */
void FixStokesDynamicsOverdamped::find_kinds(const Hydrodynamics &hydro, double *kinds) const
{
  double sums[CAUSES - KINDS] = {0.0}, given[6];
  for (int i : hydro.ambient.who()) {
    const double kind = drives.holds_any() ? drives.known(i, given) : SD_BODY_FREE;
    sd_hash_add_row(atom->tag[i], &kind, 1, sums);
  }
  MPI_Allreduce(sums, kinds, CAUSES - KINDS, MPI_DOUBLE, MPI_SUM, world);
}

/* Of the velocities that have been found last: while atoms are as they were then */
void FixStokesDynamicsOverdamped::note_causes(const Hydrodynamics &hydro)
{
  if (causes_due) find_causes(hydro, last.causes);
  causes_due = false;
}

void FixStokesDynamicsOverdamped::post_run()
{
  note_causes(hydrodynamics());
  note_left();
}

/* Are there as many atoms as in the step of the last velocities, and do they follow from the same? which: LOADS, the
 * first of them, or CAUSES, all. Noise leaves the fluid as it is half a step later. */
bool FixStokesDynamicsOverdamped::causes_stand(const Hydrodynamics &hydro, int which) const
{
  double now[CAUSES];
  find_causes(hydro, now);
  bool same = last.atoms == atom->natoms;
  for (int k = 0; k < which; k += 2)
    same = same && fabs(now[k] - last.causes[k]) <= 1e-8 * std::max(now[k + 1], last.causes[k + 1]);
  return same;
}

/* Spheres that are held, pinned or spun since now, or no longer (a dynamic group), jump to another
 * velocity: on the line through both those that are pinned would leave their place. */
void FixStokesDynamicsOverdamped::forget_before_change(const Hydrodynamics &hydro)
{
  if (!drives.holds_any()) return;
  double now[CAUSES - KINDS], *then = last.causes + KINDS;
  find_kinds(hydro, now);
  const bool same = fabs(now[0] - then[0]) <= 1e-8 * std::max(now[1], then[1]);
  std::copy_n(now, (int) (CAUSES - KINDS), then);
  if (same) return;
  before.clear();
  drives.before.clear();
}
