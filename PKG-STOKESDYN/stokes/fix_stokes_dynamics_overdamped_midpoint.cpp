/* Of fix stokes_dynamics/overdamped: scheme midpoint, steps that have the drift kT div M of a mobility
 * that differs from place to place, without its derivatives.
 *
 *   F* = 3/2 F - 1/2 F_old + sqrt(2 kT/dt) f,   f of covariance M(x)^-1
 *   x_mid = x + dt/2 V(x, F*),   x' = x + dt V(x_mid, F*)
 *
 * The noise is a force, the same in both places: then the second-order term of the step has the mean
 * kT div M dt. Kept as a velocity it would have none. In a plane nobody leaves it in the half step
 * either. Forces are extrapolated, so that they are found once a step.
 * Source: Fixman, J. Chem. Phys. 69, 1527 (1978). */
#include "fix_stokes_dynamics_overdamped.h"

#include "hydrodynamics.h"
#include "keywords.h"

#include "sd_linear.h"
#include "sd_pose.h"

#include "atom.h"
#include "domain.h"
#include "fix.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static const std::string KEYWORD = "Fix stokes_dynamics/overdamped: keyword scheme: ";

void FixStokesDynamicsOverdamped::refuse_midpoint(const Hydrodynamics &hydro) const
{
  if (hydro.settings.rigid.apart())
    fail(lmp, KEYWORD + "midpoint moves what feels each other: use ab2 for clumps_only yes");
  if (hydro.settings.rigid.on && domain->dimension == 2)
    fail(lmp, KEYWORD + "midpoint moves no rigid clumps in two dimensions");
  if (held_bit) fail(lmp, KEYWORD + "midpoint moves all spheres: leave held out");
  for (int i = 0; i < modify->nfix; i++)
    if (utils::strmatch(modify->fix[i]->style, "^deform"))
      fail(lmp, KEYWORD + "midpoint is for boxes that stay as they are, and fix " + modify->fix[i]->id +
                    " of style " + modify->fix[i]->style + " deforms this one: use ab2");
}

/* What pushes atom i in this step, in f and torque */
void FixStokesDynamicsOverdamped::push(int i)
{
  const double scale = noise.on() ? noise.scale(1.0 / update->dt) : 0.0;
  const bool extrapolate = load.has(i);
  const double *f = random[i];
  double *old = load.give(i);
  for (int d = 0; d < (atom->torque_flag ? 6 : 3); d++) {
    double &now = d < 3 ? atom->f[i][d] : atom->torque[i][d - 3];
    const double mean = extrapolate ? 1.5 * now - 0.5 * old[d] : now;
    old[d] = now;
    now = mean + (noise.on() ? scale * f[d] : 0.0);
  }
  if (domain->dimension == 2) atom->f[i][2] = 0.0;
}

/* Clumps from where they stood, start, with spheres at x [3 members], by the velocities of now for dt.
 * Positions of atoms are those of the start. */
void FixStokesDynamicsOverdamped::place_clumps(Hydrodynamics &hydro, const Clumps &start,
                                               const std::vector<double> &x, double dt)
{
  enum { MOVES, STEP, TURN = STEP + 3, COLUMNS = TURN + 9 };
  const Velocities &motion = hydro.motion();
  const WholeClumps &whole = hydro.scene.whole;
  std::vector<double> places, rows(COLUMNS * (size_t) whole.size() + COLUMNS, 0.0);
  for (size_t c = 0; c < start.size(); c++) {
    const RigidClumps::Body &body = *motion.clumps[c].body;
    double pose[12], turn[9];
    std::copy_n(start[c].pose, 12, pose);
    places.resize(3 * (size_t) body.n);
    sd_pose_advance(pose, motion.clumps[c].V, dt, body.n, body.shape->shape.x, turn, places.data());
    for (int k = 0; k < body.n; k++) {
      const size_t m = motion.member_of(motion.clumps[c], k);
      double *row = &rows[COLUMNS * m];
      row[MOVES] = 1.0;
      for (int d = 0; d < 3; d++) row[STEP + d] = places[3 * (size_t) k + d] - x[3 * m + d];
      std::copy_n(turn, 9, row + TURN);
    }
  }
  const bool whole_step = dt == update->dt;
  whole.scatter(COLUMNS, rows.data(), [&](int i, const double *row) {
    if (row[MOVES] == 0.0) return;
    for (int d = 0; d < 3; d++) atom->x[i][d] += row[STEP + d];
    if (!whole_step) return;
    moves(i, sqrt(sd_dot(row + STEP, row + STEP)), 0.0);
    hydro.turn(i, row + TURN);
  });
}

/* Atoms keep their ranks and their numbers: nobody migrates in between. */
void FixStokesDynamicsOverdamped::move_by_midpoint(Hydrodynamics &hydro)
{
  const int n = atom->nlocal;
  const double dt = update->dt;
  const bool turns = atom->torque_flag;
  const std::vector<int> who = hydro.ambient.who(), lone = hydro.motion().lone;
  const Clumps start = hydro.motion().clumps;
  const std::vector<double> of_members = hydro.scene.whole.x;
  std::vector<double> x(3 * (size_t) n + 3), F(6 * (size_t) n + 6), V(3 * (size_t) n + 3);
  for (int i : who) {
    std::copy_n(atom->x[i], 3, &x[3 * (size_t) i]);
    std::copy_n(atom->f[i], 3, &F[6 * (size_t) i]);
    if (turns) std::copy_n(atom->torque[i], 3, &F[6 * (size_t) i + 3]);
    push(i);
  }
  const auto take = [&V](int i, const double *v, const double * /*force*/) {
    std::copy_n(v, 3, &V[3 * (size_t) i]);
  };
  for (double part : {0.5 * dt, dt}) {
    if (part == dt) hydro.begin();
    hydro.velocities(take, Velocities::Held());
    for (int i : who) std::copy_n(&x[3 * (size_t) i], 3, atom->x[i]);
    for (int i : lone)
      for (int d = 0; d < domain->dimension; d++) atom->x[i][d] += part * V[3 * (size_t) i + d];
    if (hydro.settings.rigid.on) place_clumps(hydro, start, of_members, part);
  }
  for (int i : who) {
    std::copy_n(&F[6 * (size_t) i], 3, atom->f[i]);
    if (turns) std::copy_n(&F[6 * (size_t) i + 3], 3, atom->torque[i]);
  }
  for (int i : lone) {
    const double *v = &V[3 * (size_t) i];
    moves(i, dt * sqrt(sd_dot(v, v)), 0.0);
  }
}
