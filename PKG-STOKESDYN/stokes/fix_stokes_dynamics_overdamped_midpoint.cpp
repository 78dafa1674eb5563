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
 * Source: reference of the project, noise-faster.md 2. */
#include "fix_stokes_dynamics_overdamped.h"

#include "fixes.h"
#include "keywords.h"

#include "atom.h"
#include "domain.h"
#include "fix.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

void FixStokesDynamicsOverdamped::refuse_midpoint(const Hydrodynamics &hydro) const
{
  const Voice keyword = voice.of("keyword scheme");
  if (hydro.settings.rigid.apart())
    keyword.fail("midpoint is for bodies that feel each other: use ab2 with clumps_only yes");
  if (hydro.settings.rigid.on &&
      first_atom(lmp, [this](int i) { return is_moved(i) && atom->molecule[i] != 0; }))
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

void FixStokesDynamicsOverdamped::begin_step(const Hydrodynamics &hydro)
{
  start.who = hydro.ambient.who();
  start.lone = hydro.motion().lone();
  const Clumps now = clumps_now(hydro);
  start.clumps = {now.all, now.x, now.steps, {}};
  std::copy_n(now.h, 6, start.clumps.h);
  start.x = places_now(hydro);
  start.mu = directions.all();
  start.box = box_of(domain);
}

/* All but those of fix move stay in between, and nobody migrates: atoms keep their ranks and their numbers. */
void FixStokesDynamicsOverdamped::stand_at_start()
{
  for (int i : start.who) std::copy_n(&start.x.atoms[3 * (size_t) i], 3, atom->x[i]);
  directions.restore(start.mu);
}

Places FixStokesDynamicsOverdamped::places_now(const Hydrodynamics &hydro) const
{
  Places x;
  x.atoms.assign(3 * (size_t) atom->nlocal + 3, 0.0);
  for (int i : hydro.ambient.who()) std::copy_n(atom->x[i], 3, &x.atoms[3 * (size_t) i]);
  for (const ClumpPoses::Clump &clump : hydro.motion().clumps())
    x.clumps.insert(x.clumps.end(), clump.pose + 9, clump.pose + 12);
  return x;
}

/* Velocities of the last solve; of those that fix move has moved since the step began their mean in it */
Moves FixStokesDynamicsOverdamped::found(const Hydrodynamics &hydro) const
{
  Moves V;
  V.atoms.assign(6 * (size_t) atom->nlocal + 6, 0.0);
  for (size_t i : start.lone) {
    std::copy_n(motion[i], 3, &V.atoms[6 * i]);
    if (directions.on()) std::copy_n(directions.turning[i], 3, &V.atoms[6 * i + 3]);
    for (size_t d = 0; d < 3 && is_moved(i); d++)
      V.atoms[6 * i + d] = (atom->x[i][d] - start.x.atoms[3 * i + d]) / update->dt;
  }
  for (const ClumpPoses::Clump &clump : hydro.motion().clumps())
    V.clumps.insert(V.clumps.end(), clump.V, clump.V + 6);
  return V;
}

Ride FixStokesDynamicsOverdamped::half_step(const BoxMotion &flow, bool carried) const
{
  const double half = 0.5 * update->dt;
  return {half, carried, start.box, start.box, box_later(flow, start.box, half), flow};
}

/* All from where they stood at the start, by velocities V that are those of the places `there`; take: rows of
 * clumps (step_clumps) */
void FixStokesDynamicsOverdamped::place(Hydrodynamics &hydro, const Ride &ride, const Places &there,
                                        const Moves &V, const Taken &take)
{
  static const double CENTROID[3] = {0.0, 0.0, 0.0};
  const auto go = [&](bool stays, const double *v, const double *at, const double *from, double move[6]) {
    for (int d = 0; d < 6; d++) move[d] = ride.t * v[d];
    if (!stays) ride.step(v, at, from, move);
    keep_in_plane(move, 6);
  };
  stand_at_start();
  for (size_t i : start.lone) {
    double move[6];
    go(stays((int) i), &V.atoms[6 * i], &there.atoms[3 * i], &start.x.atoms[3 * i], move);
    for (size_t d = 0; d < 3; d++) atom->x[i][d] += move[d];
    if (!is_held((int) i)) directions.turn((int) i, move + 3, 1.0);
  }
  if (!hydro.settings.rigid.on) return;
  const auto step = [&](size_t c) {
    const ClumpPoses::Clump &clump = start.clumps.all[c];
    ClumpStep s = {CENTROID, {}, nullptr};
    go(clump.known == SD_BODY_PINNED, &V.clumps[6 * c], &there.clumps[3 * c], clump.pose + 9, s.move);
    return s;
  };
  step_clumps(hydro, start.clumps.clumps(), step, take);
}

/* In its box, by velocities of its middle */
void FixStokesDynamicsOverdamped::make_step(Hydrodynamics &hydro, const Moves &V)
{
  const double dt = update->dt;
  bring_box_to_this_step(lmp);
  const Ride all = {dt,           hydro.ambient.jumps() != nullptr, start.box,
                    start.middle, box_of(domain),                   hydro.ambient.box_motion()};
  place(hydro, all, start.there, V, [&](int i, const double *row) { clump_moves(hydro, i, row); });
  for (int i : start.who) load_on(i, load.give(i));
  for (int i : start.lone) {
    const double *v = &V.atoms[6 * (size_t) i], step[3] = {dt * v[0], dt * v[1], dt * v[2]};
    if (!is_held(i)) moves(i, step);
  }
}

// --- without noise --------------------------------------------------------------------------------------------

void FixStokesDynamicsOverdamped::begin_midpoint(Hydrodynamics &hydro, const Solve::Take &take)
{
  hydro.velocities(take, given());
  begin_step(hydro);
}

/* Half the step by the velocities of now, all of it by those there, in the frame that goes with the box. */
void FixStokesDynamicsOverdamped::move_by_midpoint(Hydrodynamics &hydro)
{
  const size_t width = hydro.rotation() ? 6 : 3;
  const Ride half = half_step(hydro.ambient.box_motion(), hydro.ambient.jumps() != nullptr);
  Moves V = found(hydro);
  dragged.assign(3 * (size_t) atom->nlocal + 3, 0.0);
  for (size_t i : start.lone)
    if (is_moved((int) i)) std::copy_n(&V.atoms[6 * i], 3, &dragged[3 * i]);
  stand_at_start();
  hydro.look_ahead();
  if (half.flow.deforms) put_box(domain, half.to);
  place(hydro, half, start.x, V, [](int, const double *) {});
  hydro.begin(Hydrodynamics::MIDDLE);
  hydro.ambient.half_a_step_back();
  hydro.velocities([this, &V, width](int i, const double *v, const double *) {
    if (!is_moved(i)) std::copy_n(v, width, &V.atoms[6 * (size_t) i]);
  }, given());
  V.clumps.clear();
  for (const ClumpPoses::Clump &clump : hydro.motion().clumps())
    V.clumps.insert(V.clumps.end(), clump.V, clump.V + 6);
  dragged.clear();
  start.middle = half.to;
  start.there = places_now(hydro);
  if (half.flow.deforms) put_box(domain, start.box);
  make_step(hydro, V);
}
