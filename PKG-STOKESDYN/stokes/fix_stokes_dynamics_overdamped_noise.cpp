/* Of fix stokes_dynamics/overdamped: steps with noise where the mobility has a drift, by one solve.
 *
 *   final_integrate     y, f_L at x; points at x + dt/2 v', films at x + dt/2 v''; V from one solve there
 *   initial_integrate   x += dt V                       hydrodynamics_noise.cpp, sd_drifter.h
 *
 * V, what is printed as v, is the velocity with which the step is made. Loads are those of scheme
 * midpoint, extrapolated by half a step; the fluid is that of the beginning of the step. Whoever is held,
 * or the plane, is so in the half steps too, and who is moved as told is half way there. Atoms keep their
 * ranks and their numbers: nobody migrates in between. */
#include "fix_stokes_dynamics_overdamped.h"

#include "sd_linear.h"

#include "atom.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

/* Bodies at the start of the step and part times moves from there. */
void FixStokesDynamicsOverdamped::place(Hydrodynamics &hydro, const Start &start, const Moves &moves,
                                        double part)
{
  static const double CENTROID[3] = {0.0, 0.0, 0.0};
  directions.restore(start.mu);
  for (int i : hydro.ambient.who()) std::copy_n(&start.x[3 * (size_t) i], 3, atom->x[i]);
  for (int i : start.lone) {
    double move[6];
    for (size_t d = 0; d < 6; d++) move[d] = part * moves.atoms[6 * (size_t) i + d];
    keep_in_plane(move, 6);
    for (size_t d = 0; d < 3; d++) atom->x[i][d] += move[d];
    directions.turn(i, move + 3, 1.0);
  }
  if (!hydro.settings.rigid.on) return;
  const auto step = [&](size_t c) {
    ClumpStep s = {CENTROID, {}, nullptr};
    for (size_t d = 0; d < 6; d++) s.move[d] = part * moves.clumps[6 * c + d];
    keep_in_plane(s.move, 6);
    return s;
  };
  step_clumps(hydro, start.clumps, step, [](int, const double *) {});
}

void FixStokesDynamicsOverdamped::find_noisy_velocities(Hydrodynamics &hydro, const Solve::Take &take)
{
  const Given known = given();
  const Solve::Draw draw = noise.slip(hydro);
  const double half = 0.5 * update->dt;
  hydro.draw(known, draw);
  start = {hydro.ambient.who(), hydro.motion().lone(), clumps_now(hydro), directions.all(),
           std::vector<double>(3 * (size_t) atom->nlocal + 3)};
  for (int i : hydro.ambient.who()) std::copy_n(atom->x[i], 3, &start.x[3 * (size_t) i]);
  const Moves of_points = hydro.half_step_of_points(), of_films = hydro.half_step_of_films();
  const auto at = [&](const Moves &moves, double part) {
    place(hydro, start, moves, part);
    hydro.begin(Hydrodynamics::MIDDLE);
  };
  if (hydro.needs_differences()) {
    const Moves wander = hydro.wander(draw);
    for (double sign : {1.0, -1.0}) {
      at(wander, sign);
      hydro.difference(known, sign);
    }
  }
  at(of_films, half);
  hydro.films(known);
  at(of_points, half);
  hydro.velocities(take, known, noise.tolerance_of_solve());
  place(hydro, start, of_points, 0.0);
}

/* By the velocities of now. Positions of atoms are those of the start. */
void FixStokesDynamicsOverdamped::move_with_noise(Hydrodynamics &hydro)
{
  const double dt = update->dt;
  for (int i : start.lone) {
    if (is_held(i)) continue;
    const double *v = motion[i], step[3] = {dt * v[0], dt * v[1], dt * v[2]};
    for (size_t d = 0; d < 3; d++) atom->x[i][d] += step[d];
    if (directions.on()) directions.turn(i, directions.turning[i], dt);
    moves(i, step);
  }
  if (hydro.settings.rigid.on) place_clumps(hydro, start.clumps, {dt, false, {}, {}, {}, {}});
  for (int i : hydro.ambient.who()) load_on(i, load.give(i));
}
