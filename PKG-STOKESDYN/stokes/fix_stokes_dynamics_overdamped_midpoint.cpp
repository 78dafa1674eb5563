/* Of fix stokes_dynamics/overdamped: scheme midpoint, and its two solves, of second order, without noise.
 *
 *   F* = F + dt/(2 dt_old) (F - F_old)
 *   v = V(x, F*),  x_mid = x + dt/2 v           where velocities are found: v is output
 *   x' = x + dt V(x_mid, F*)                    where positions advance
 *
 * Whoever is held, or the plane, is so in the half step too; who is moved as told is half way there, by the
 * mean velocity of the step. The fluid at x_mid is that of the middle of the step.
 * Forces are extrapolated, so that they are found once per step.
 *
 * With noise V is found otherwise, by one solve (fix_stokes_dynamics_overdamped_noise.cpp).
 *
 * Where the fluid takes the box along, the step is the same one for coordinates s = H^-1 (x - x_lo) in the
 * edges H of the box, ds/dt = H^-1 (V - u_box), in which the box stands still: x_mid and its images are
 * those of the box of the middle, and the flow carries the random displacement for the half step that is
 * left, x' = S(dt) x + S(dt/2) dt (V - u_box) in a simple shear S. Added at the end of the step instead, the
 * displacement leaves <xy> of a dumbbell low by half of dt times its rate of relaxation. F_old is kept as it
 * is in space: it is a force that the step needs at x_mid, not one that goes with the box.
 * Source: own derivation; test_brownian_shear.py has closed forms of dumbbells. */
#include "fix_stokes_dynamics_overdamped.h"

#include "fixes.h"
#include "keywords.h"

#include "atom.h"
#include "fix.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace StokesDyn;

void FixStokesDynamicsOverdamped::refuse_midpoint(const Hydrodynamics &hydro) const
{
  const Voice keyword = voice.of("keyword scheme");
  if (hydro.settings.rigid.each_alone())
    keyword.fail("midpoint is for bodies that feel each other: use ab2 with clumps_only yes");
  if (hydro.settings.rigid.on &&
      first_atom(lmp, [this](int i) { return drives.is_moved(i) && atom->molecule[i] != 0; }))
    keyword.fail("midpoint needs the orientation of clumps in the middle of a step, where fix move "
                 "does not give that of keyword held: let them rest, or move spheres");
  const Fix *deform = fix_like(lmp, "^deform");
  const Ambient::Settings &fluid = hydro.ambient.settings;
  if (!deform) return;
  if (!fluid.box && (fluid.grid || !hydro.ambient.varies()))
    keyword.fail("midpoint needs a fluid that goes with the box, which " + name_of(deform) +
                 " deforms: use fluid_velocity box of pair_style stokes_dynamics");
  if (deform->nevery != 1)
    keyword.fail("midpoint needs a box that moves in every step, and " + name_of(deform) +
                 " moves it every " + std::to_string(deform->nevery) + " steps: give it 1");
}

/* Velocities of the last solve; of those that fix move has moved since the step began their mean in it */
Moves FixStokesDynamicsOverdamped::found(const Hydrodynamics &hydro) const
{
  Moves V;
  V.atoms.assign(6 * (size_t) atom->nlocal + 6, 0.0);
  const BodySteps::Start &start = steps.start();
  for (size_t i : start.lone) {
    std::copy_n(lone_velocity[i], 3, &V.atoms[6 * i]);
    if (const double *W = steps.spin((int) i)) std::copy_n(W, 3, &V.atoms[6 * i + 3]);
    for (size_t d = 0; d < 3 && drives.is_moved(i); d++)
      V.atoms[6 * i + d] = (atom->x[i][d] - start.x.atoms[3 * i + d]) / update->dt;
  }
  for (const ClumpPoses::Clump &clump : hydro.poses().clumps())
    V.clumps.insert(V.clumps.end(), clump.V, clump.V + 6);
  return V;
}

/* By velocities of its middle */
void FixStokesDynamicsOverdamped::make_step(Hydrodynamics &hydro, const Moves &V)
{
  steps.whole_step(hydro, V);
  for (int i : steps.start().who) drives.load(i, drives.before.writable(i));
}

// --- without noise --------------------------------------------------------------------------------------------

void FixStokesDynamicsOverdamped::begin_midpoint(Hydrodynamics &hydro, const Solve::ToAtom &take)
{
  hydro.velocities(take, given());
  steps.begin(hydro);
}

/* Half the step by the velocities of now, all of it by those there, in the frame that goes with the box. */
void FixStokesDynamicsOverdamped::move_by_midpoint(Hydrodynamics &hydro)
{
  const size_t width = hydro.scene.width();
  Moves V = found(hydro);
  drives.moved_with.assign(3 * (size_t) atom->nlocal + 3, 0.0);
  for (size_t i : steps.start().lone)
    if (drives.is_moved((int) i)) std::copy_n(&V.atoms[6 * i], 3, &drives.moved_with[3 * i]);
  steps.return_to_start();
  hydro.look_ahead();
  steps.half_step(hydro, V);
  hydro.begin(Hydrodynamics::MIDDLE);
  hydro.ambient.half_a_step_back();
  hydro.velocities([this, &V, width](int i, const double *v, const double *) {
    if (!drives.is_moved(i)) std::copy_n(v, width, &V.atoms[6 * (size_t) i]);
  }, given());
  V.clumps.clear();
  for (const ClumpPoses::Clump &clump : hydro.poses().clumps())
    V.clumps.insert(V.clumps.end(), clump.V, clump.V + 6);
  drives.moved_with.clear();
  steps.end_half_steps(hydro);
  make_step(hydro, V);
}
