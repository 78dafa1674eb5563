/* Of fix stokes_dynamics/overdamped: the step of schemes ab2 and euler,
 *
 *   x <- x + dt [V + dt/(2 dt_old) (V - V_old)] + sqrt(2 kT dt) y              euler: V_old = V
 *
 * likewise the turns of clumps, about their centre of mobility where there is noise. */
#include "fix_stokes_dynamics_overdamped.h"

#include "copy.h"

#include "sd_linear.h"

#include "atom.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace StokesDyn;

/* old [6] of the step before (a row of `before`) for a body whose place is now another image */
void FixStokesDynamicsOverdamped::at_image(const Hydrodynamics &hydro, const double *row,
                                           const double *place, double *old) const
{
  double shift[3], jump[3];
  copy<6>(row, old);
  if (!hydro.ambient.box_motion().deforms) return;    // all images have the same velocity
  for (int d = 0; d < 3; d++) shift[d] = place[d] - row[6 + d];
  sd_multiply3(hydro.ambient.box_motion().flow.gradient, shift, jump);
  for (int d = 0; d < 3; d++) old[d] += jump[d];
}

void FixStokesDynamicsOverdamped::move_free(const Hydrodynamics &hydro, int i)
{
  if (drives.is_held(i)) return;
  const double *V = lone_velocity[i], *y = noise.on() ? random[i] : nullptr;
  const sd_step step = step_of(before.has(i));
  double old[6] = {V[0], V[1], V[2]}, move[6];
  if (before.has(i)) at_image(hydro, before[i], atom->x[i], old);
  sd_step_move(&step, 3, V, old, y, move);
  directions.turn_of_step(i, step, y ? y + 3 : nullptr, move + 3);
  steps.go(i, move);
  double *row = before.writable(i);
  copy<3>(V, row);
  copy<3>(atom->x[i], row + 6);
}

/* has: does it have a row of the step before? */
sd_step FixStokesDynamicsOverdamped::step_of(bool has) const
{
  return {update->dt, weight(has), noise.on() ? noise.scale(update->dt) : 0.0};
}

/* The point by which a clump is moved, from its centroid in the axes of its shape: with noise the centre
 * of mobility, where there is no drift. */
const double *FixStokesDynamicsOverdamped::tracked(const ClumpShape &shape) const
{
  static const double CENTROID[3] = {0.0, 0.0, 0.0};
  return noise.on() ? shape.noise.centre : CENTROID;
}

/* V [6] of that point and W */
void FixStokesDynamicsOverdamped::tracked_velocity(const ClumpPoses::Clump &clump,
                                                   const ClumpShape &shape, double V[6]) const
{
  double arm[3];
  sd_multiply3(clump.pose, tracked(shape), arm);
  copy<6>(clump.V, V);
  sd_clump_shift_velocity(arm, V);
}

void FixStokesDynamicsOverdamped::move_clumps(Hydrodynamics &hydro)
{
  const ClumpPoses &poses = hydro.poses();
  steps.go(hydro, [&](size_t number) {
    const ClumpPoses::Clump &clump = poses.clumps()[number];
    const int first = poses.own_clump(clump).atom;
    const sd_step step = step_of(before.has(first));
    double V[6], old[6], *row = before.writable(first);
    BodySteps::ClumpStep s = {tracked(poses.shape(clump)), {}, row + 6};
    tracked_velocity(clump, poses.shape(clump), V);
    at_image(hydro, row, clump.pose + 9, old);
    copy<6>(V, row);
    sd_step_move(&step, 6, V, old, noise.on() ? noise.of_clump(number) : nullptr, s.move);
    steps.keep_in_plane(s.move);
    return s;
  });
}
