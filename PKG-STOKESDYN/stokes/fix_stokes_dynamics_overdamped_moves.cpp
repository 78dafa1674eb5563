/* Of fix stokes_dynamics/overdamped: how atoms move, free spheres and the members of clumps; and the step of
 * schemes ab2 and euler,
 *
 *   x <- x + dt [V + dt/(2 dt_old) (V - V_old)] + sqrt(2 kT dt) y              euler: V_old = V
 *
 * likewise the turns of clumps, about their centre of mobility where there is noise. */
#include "fix_stokes_dynamics_overdamped.h"

#include "copy.h"

#include "sd_linear.h"

#include "atom.h"
#include "domain.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace StokesDyn;

/* old [6] of the step before (a row of `before`) for a body whose place is now another image */
void FixStokesDynamicsOverdamped::at_image(const Hydrodynamics &hydro, const double *row,
                                           const double *place, double *old) const
{
  double shift[3], jump[3];
  for (int d = 0; d < 3; d++) shift[d] = place[d] - row[6 + d];
  sd_multiply3(hydro.ambient.box_motion().gradient, shift, jump);
  std::copy_n(row, 6, old);
  for (int d = 0; d < 3; d++) old[d] += jump[d];
}

void FixStokesDynamicsOverdamped::move_free(const Hydrodynamics &hydro, int i)
{
  if (is_held(i)) return;
  const double dt = update->dt, *V = motion[i];
  const double scale = noise.on() ? noise.scale(dt) : 0.0;
  double *x = atom->x[i], old[6] = {V[0], V[1], V[2]}, mean[3], step[3];
  if (before.has(i)) at_image(hydro, before[i], x, old);
  sd_mean_velocity(3, V, old, weight(before.has(i)), mean);
  for (int d = 0; d < 3; d++) {
    step[d] = dt * mean[d] + (noise.on() ? scale * random[i][d] : 0.0);
    x[d] += step[d];
  }
  directions.step(i, dt, weight(before.has(i)), scale, random[i] + 3);
  double *row = before.give(i);
  std::copy_n(V, 3, row);
  std::copy_n(x, 3, row + 6);
  moves(i, step);
}

void FixStokesDynamicsOverdamped::moves(int i, const double *step)
{
  displaced = std::max(displaced, sd_dot(step, step) / (atom->radius[i] * atom->radius[i]));
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
  double arm[3], turning[3];
  sd_multiply3(clump.pose, tracked(shape), arm);
  sd_cross(clump.V + 3, arm, turning);
  std::copy_n(clump.V, 6, V);
  for (int d = 0; d < 3; d++) V[d] += turning[d];
}

FixStokesDynamicsOverdamped::Clumps FixStokesDynamicsOverdamped::clumps_now(const Hydrodynamics &hydro)
{
  const WholeClumps &whole = hydro.scene.whole;
  return {hydro.motion().clumps(), whole.x, whole.steps, whole.h};
}

/* Clumps from where they stood; how each goes is what step(c) says. take(i, row) for each of their atoms, which
 * have been moved. Positions are those of images side by side: an atom moves as its image does, less what the
 * edges of the box between them have moved since. */
void FixStokesDynamicsOverdamped::step_clumps(Hydrodynamics &hydro, const Clumps &start, const Step &step,
                                              const std::function<void(int, const double *)> &take)
{
  const WholeClumps &whole = hydro.scene.whole;
  const Lattice now = Lattice::of(domain);
  std::vector<double> places;
  double box[6], row[COLUMNS];
  for (int d = 0; d < 6; d++) box[d] = start.h[d] - now.h[d];
  const auto all = [&](const auto &give) {
    for (size_t c = 0; c < start.all.size(); c++) {
      if (start.all[c].known == SD_BODY_HELD) continue;
      const ClumpPoses::Clump &clump = hydro.motion().clumps()[c];
      const RigidClumps::Body &body = hydro.motion().body(clump);
      const ClumpStep goes = step(c);
      double pose[12];
      copy<12>(start.all[c].pose, pose);
      places.resize(3 * (size_t) body.n);
      sd_pose_step(pose, goes.centre, goes.move, body.n, body.shape->shape.x, row + TURN,
                   places.data());
      if (goes.place) copy<3>(pose + 9, goes.place);
      copy<4>(output[body.atom] + TURNED, row + TURNED_NOW);
      sd_turn_quaternion(row + TURN, row + TURNED_NOW);
      for (int k = 0; k < body.n; k++) {
        const size_t m = hydro.motion().member_of(clump, k);
        sd_minus(&places[3 * (size_t) k], &start.x[3 * m], row + STEP);
        sd_add_edges(box, &start.steps[3 * m], row + STEP);
        give(m, row);
      }
    }
  };
  whole.scatter(COLUMNS, all, [&](int i, const double *of) {
    for (int d = 0; d < domain->dimension; d++) atom->x[i][d] += of[STEP + d];
    directions.turn(i, of + TURN);
    take(i, of);
  });
}

/* A whole step has been made. */
void FixStokesDynamicsOverdamped::clump_moves(Hydrodynamics &hydro, int i, const double *row)
{
  moves(i, row + STEP);
  hydro.turn(i, row + TURN);
  copy<4>(row + TURNED_NOW, output.give(i) + TURNED);
}

void FixStokesDynamicsOverdamped::move_clumps(Hydrodynamics &hydro)
{
  const ClumpPoses &poses = hydro.motion();
  const auto step = [&](size_t number) {
    const ClumpPoses::Clump &clump = poses.clumps()[number];
    const int first = poses.body(clump).atom;
    const bool has = before.has(first);
    double V[6], old[6], mean[6], *row = before.give(first);
    ClumpStep s = {tracked(poses.shape(clump)), {}, row + 6};
    tracked_velocity(clump, poses.shape(clump), V);
    at_image(hydro, row, clump.pose + 9, old);
    std::copy_n(V, 6, row);
    sd_mean_velocity(6, V, old, weight(has), mean);
    for (int d = 0; d < 6; d++) {
      s.move[d] = update->dt * mean[d];
      if (noise.on()) s.move[d] += noise.scale(update->dt) * noise.of_clump(number)[d];
    }
    keep_in_plane(s.move, 6);
    return s;
  };
  step_clumps(hydro, clumps_now(hydro), step,
              [&](int i, const double *row) { clump_moves(hydro, i, row); });
}
