/* Of fix stokes_dynamics/overdamped: steps with noise where the mobility has a drift, by one solve.
 *
 *   final_integrate     y, f_L at x; points at x + dt/2 v', films at x + dt/2 v''; V from one solve there
 *   post_integrate      x += dt V                       hydrodynamics_noise.cpp, sd_drifter.h
 *
 * V, what is printed as v, is the velocity with which the step is made. Loads are those of scheme midpoint,
 * extrapolated by half a step; a box, and the fluid that goes with it, are those of the middle of the step,
 * any other fluid is that of its beginning. Whoever is held, or the plane, is so in the half steps too, and
 * who is moved as told is half way there. */
#include "fix_stokes_dynamics_overdamped.h"

#include "compute_stokes_dynamics_stress.h"

#include "update.h"

using namespace LAMMPS_NS;
using namespace StokesDyn;

void FixStokesDynamicsOverdamped::find_noisy_velocities(Hydrodynamics &hydro, const Solve::ToAtom &take)
{
  const Given known = given();
  const SolveNoise::Draw draw = noise.how_to_draw(hydro);
  hydro.draw(known, draw);
  if (ComputeStokesDynamicsStress::wants_low(lmp)) {
    hydro.stress_of_noise(noise.tolerance_of_solve(), moments_of_noise);
    moments_step = update->ntimestep;
  }
  steps.begin(hydro);
  const Moves of_points = hydro.half_step_of_points(), of_films = hydro.half_step_of_films();
  if (hydro.needs_differences()) {
    const Moves moves = hydro.random_moves(draw);
    for (double sign : {1.0, -1.0}) {
      steps.displace(hydro, moves, sign);
      hydro.begin(Hydrodynamics::MIDDLE);
      hydro.difference(known, sign);
    }
  }
  steps.half_step(hydro, of_films);
  hydro.begin(Hydrodynamics::HALF_LATER);
  hydro.films(known);
  steps.half_step(hydro, of_points);
  hydro.begin(Hydrodynamics::HALF_LATER);
  hydro.velocities(take, known, noise.tolerance_of_solve());
  steps.end_half_steps(hydro);
  steps.return_to_start();
}

const std::vector<double> *FixStokesDynamicsOverdamped::stress_of_noise() const
{
  return moments_step == update->ntimestep ? &moments_of_noise : nullptr;
}
