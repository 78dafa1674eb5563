/* Of fix stokes_dynamics/overdamped: scheme midpoint in two solves, of second order without
 * noise.
 *
 *   F* = F + dt/(2 dt_old) (F - F_old)
 *   v = V(x, F*),  x_mid = x + dt/2 v           where velocities are found: v is output
 *   x' = x + dt V(x_mid, F*)                    where positions advance
 *
 * Whoever is held, or the plane, is so in the half step too; who is moved as told is half way there, by the
 * mean velocity of the step. The fluid at x_mid is that of the middle of the step.
 * Forces are extrapolated, so that they are found once per step.
 *
 * With noise a step is made otherwise (fix_stokes_dynamics_overdamped_noise.cpp), but where the box deforms
 * with the fluid, or a compute asks for the stress. There the noise is a force, the same in both places: then
 * the second-order term of the step has the mean kT div M dt. Kept as a velocity it would have none.
 *
 * Where the fluid takes the box along, the step is the same one for coordinates s = H^-1 (x - x_lo) in the
 * edges H of the box, ds/dt = H^-1 (V - u_box), in which the box stands still: x_mid and its images are
 * those of the box of the middle, and the flow carries the random displacement for the half step that is
 * left, x' = S(dt) x + S(dt/2) dt (V - u_box) in a simple shear S. Added at the end of the step instead, the
 * displacement leaves <xy> of a dumbbell low by half of dt times its rate of relaxation. F_old is kept as it
 * is in space: it is a force that the step needs at x_mid, not one that goes with the box.
 * Source: Fixman, J. Chem. Phys. 69, 1527 (1978). */
#include "fix_stokes_dynamics_overdamped.h"

#include "fixes.h"
#include "keywords.h"

#include "sd_linear.h"

#include "atom.h"
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

/* [6 nlocal] random forces and torques, in whose sum with the others spheres move */
std::vector<double> FixStokesDynamicsOverdamped::random_loads(const Hydrodynamics &hydro) const
{
  std::vector<double> all(6 * (size_t) atom->nlocal + 6, 0.0);
  for (int i : hydro.ambient.who()) std::copy_n(random[i], 6, &all[6 * (size_t) i]);
  return all;
}

void FixStokesDynamicsOverdamped::begin_midpoint(Hydrodynamics &hydro, const Solve::Take &take)
{
  const int width = hydro.rotation() ? 6 : 3;
  Solve::Forces forces;
  if (noise.on())
    forces = noise.forces(hydro, [this, width](int i, const double *f) {
      std::copy_n(f, width, random.give(i));
    });
  if (noise.on() && stress.wants_low()) {
    hydro.velocities([](int, const double *, const double *) {}, given());
    stress.without_noise(hydro);
  }
  hydro.velocities(take, given(), 0.0, noise.on() ? &forces : nullptr);
  if (noise.on()) stress.begin(hydro, random_loads(hydro));
  dragged.x.assign(3 * (size_t) atom->nlocal + 3, 0.0);
  for (int i : hydro.ambient.who())
    if (is_moved(i)) std::copy_n(atom->x[i], 3, &dragged.x[3 * (size_t) i]);
}

/* Of those that fix move has moved: x [3 nlocal] becomes where they were at the start of the step, V
 * their mean velocity in it */
void FixStokesDynamicsOverdamped::find_half_step(const Hydrodynamics &hydro, std::vector<double> &x)
{
  dragged.v.assign(3 * (size_t) atom->nlocal + 3, 0.0);
  for (int i : hydro.ambient.who())
    for (size_t d = 0; d < 3 && is_moved(i); d++) {
      const size_t at = 3 * (size_t) i + d;
      dragged.v[at] = (x[at] - dragged.x[at]) / update->dt;
      x[at] = dragged.x[at];
    }
}

/* By the velocities of now. Positions of atoms are those of the start. */
void FixStokesDynamicsOverdamped::place_clumps(Hydrodynamics &hydro, const Clumps &start, const Ride &ride)
{
  static const double CENTROID[3] = {0.0, 0.0, 0.0};
  const auto step = [&](size_t c) {
    const ClumpPoses::Clump &clump = hydro.motion().clumps()[c];
    ClumpStep s = {CENTROID, {}, nullptr};
    for (int d = 0; d < 6; d++) s.move[d] = ride.t * clump.V[d];
    if (clump.known != SD_BODY_PINNED) ride.step(clump.V, clump.pose + 9, start.all[c].pose + 9, s.move);
    keep_in_plane(s.move, 6);
    return s;
  };
  step_clumps(hydro, start, step, [&](int i, const double *row) {
    if (ride.t == update->dt) clump_moves(hydro, i, row);
  });
}

/* fix deform takes the tilt next to that of before, which is another one beyond half an edge. */
void FixStokesDynamicsOverdamped::check_strain(const BoxMotion &flow) const
{
  double largest = 0.0;
  for (double rate : flow.gradient) largest = std::max(largest, fabs(rate) * update->dt);
  if (largest > 0.45)
    voice.at_step().of("keyword scheme").fail("midpoint: the box strains by " + text(largest) +
                                              " in a step, and fix deform cannot follow: use a shorter time step");
}

/* All from where they stood at the start, by velocities V [6 nlocal], which those that are free have at the
 * places `there` [3 nlocal] */
void FixStokesDynamicsOverdamped::place(Hydrodynamics &hydro, const Start &start, const Ride &ride,
                                        const std::vector<double> &there, const std::vector<double> &V)
{
  const std::vector<double> &x = start.x;
  for (int i : start.who) std::copy_n(&x[3 * (size_t) i], 3, atom->x[i]);
  directions.restore(start.mu);
  for (size_t i : start.lone) {
    const double *v = is_held((int) i) ? &dragged.v[3 * i] : &V[6 * i];
    double step[3];
    if (stays((int) i))
      for (size_t d = 0; d < 3; d++) step[d] = ride.t * v[d];
    else
      ride.step(v, &there[3 * i], &x[3 * i], step);
    for (size_t d = 0; d < 3; d++) atom->x[i][d] += step[d];
    if (!is_held((int) i)) directions.turn((int) i, v + 3, ride.t);
  }
  if (hydro.settings.rigid.on) place_clumps(hydro, start.clumps, ride);
}

/* Half the step by the velocities of now, all of it by those there, in the frame that goes with the box.
 * Atoms keep their ranks and their numbers: nobody migrates in between. */
void FixStokesDynamicsOverdamped::move_by_midpoint(Hydrodynamics &hydro)
{
  const double dt = update->dt;
  const size_t width = hydro.rotation() ? 6 : 3;
  const bool carried = hydro.ambient.jumps();
  const BoxMotion flow = hydro.ambient.box_motion();
  Start start = {hydro.ambient.who(), hydro.motion().lone(), clumps_now(hydro), directions.all(),
                 std::vector<double>(3 * (size_t) atom->nlocal + 3)};
  std::vector<double> V(2 * start.x.size());
  for (int i : start.who) {
    std::copy_n(atom->x[i], 3, &start.x[3 * (size_t) i]);
    std::copy_n(motion[i], 3, &V[6 * (size_t) i]);
    if (directions.on()) std::copy_n(directions.turning[i], 3, &V[6 * (size_t) i + 3]);
  }
  find_half_step(hydro, start.x);
  for (int i : start.who) std::copy_n(&start.x[3 * (size_t) i], 3, atom->x[i]);
  hydro.look_ahead();
  check_strain(flow);
  const BoxInStep box(lmp);
  if (flow.deforms) box.put(box.middle);
  place(hydro, start, {0.5 * dt, carried, box.start, box.start, box.middle, flow}, start.x, V);
  std::vector<double> there(start.x.size());
  for (int i : start.who) std::copy_n(atom->x[i], 3, &there[3 * (size_t) i]);
  hydro.begin(Hydrodynamics::MIDDLE);
  hydro.ambient.half_a_step_back();
  Given known = given();
  if (noise.on())
    known.loads = [this](int i, double *FT) {
      push_on(i, FT);
      for (int d = 0; d < 6; d++) FT[d] += random[i][d];
    };
  hydro.velocities([this, &V, width](int i, const double *v, const double *) {
    std::copy_n(v, width, &V[6 * (size_t) i]);
    keep_in_plane(&V[6 * (size_t) i], 6);
  }, known);
  if (noise.on()) stress.middle(hydro, random_loads(hydro));
  if (flow.deforms) box.put(box.end);
  place(hydro, start, {dt, carried, box.start, box.middle, box.end, hydro.ambient.box_motion()}, there, V);
  dragged.v.clear();
  for (int i : start.who) load_on(i, load.give(i));
  for (int i : start.lone) {
    const double *v = &V[6 * (size_t) i], step[3] = {dt * v[0], dt * v[1], dt * v[2]};
    if (!is_held(i)) moves(i, step);
  }
}
