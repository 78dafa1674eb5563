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
  if (hydro.settings.rigid.on)
    fail(lmp, KEYWORD + "midpoint moves free spheres alone: use ab2 for rigid clumps");
  if (held_bit) fail(lmp, KEYWORD + "midpoint moves all spheres: leave held out");
  for (int i = 0; i < modify->nfix; i++)
    if (utils::strmatch(modify->fix[i]->style, "^deform"))
      fail(lmp, KEYWORD + "midpoint is for boxes that stay as they are, and fix " + modify->fix[i]->id +
                    " of style " + modify->fix[i]->style + " deforms this one: use ab2");
}

/* What pushes atom i in this step, with F [3] in its place afterwards */
void FixStokesDynamicsOverdamped::push(const double *F, int i)
{
  const double scale = noise.on() ? noise.scale(1.0 / update->dt) : 0.0;
  const bool extrapolate = load.has(i);
  const double *f = random[i];
  double *old = load.give(i);
  for (int d = 0; d < 3; d++) {
    const double mean = extrapolate ? 1.5 * F[d] - 0.5 * old[d] : F[d];
    old[d] = F[d];
    atom->f[i][d] = mean + (noise.on() ? scale * f[d] : 0.0);
  }
  if (domain->dimension == 2) atom->f[i][2] = 0.0;
}

/* Atoms keep their ranks and their numbers: nobody migrates in between. */
void FixStokesDynamicsOverdamped::move_by_midpoint(Hydrodynamics &hydro)
{
  const std::vector<int> who = hydro.ambient.who();
  const double dt = update->dt;
  std::vector<double> x, F;
  for (int i : who) {
    x.insert(x.end(), atom->x[i], atom->x[i] + 3);
    F.insert(F.end(), atom->f[i], atom->f[i] + 3);
    push(&F[F.size() - 3], i);
  }
  std::vector<double> V(3 * (size_t) atom->nlocal + 3);
  const auto take = [&V](int i, const double *v, const double * /*force*/) {
    std::copy_n(v, 3, &V[3 * (size_t) i]);
  };
  for (double part : {0.5, 1.0}) {
    if (part == 1.0) hydro.begin();
    hydro.velocities(take, Velocities::Held());
    for (size_t k = 0; k < who.size(); k++)
      for (int d = 0; d < domain->dimension; d++)
        atom->x[who[k]][d] = x[3 * k + d] + part * dt * V[3 * (size_t) who[k] + d];
  }
  for (size_t k = 0; k < who.size(); k++) {
    const double *v = &V[3 * (size_t) who[k]];
    std::copy_n(&F[3 * k], 3, atom->f[who[k]]);
    moves(who[k], dt * sqrt(sd_dot(v, v)), 0.0);
  }
}
