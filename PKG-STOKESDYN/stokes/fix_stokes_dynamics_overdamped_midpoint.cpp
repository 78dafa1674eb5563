/* Of fix stokes_dynamics/overdamped: scheme midpoint, steps that have the drift kT div M of a
 * mobility that differs from place to place, without its derivatives.
 *
 *   F* = F + dt/(2 dt_old) (F - F_old) + sqrt(2 kT/dt) f,   f of covariance M(x)^-1
 *   v = V(x, F*),  x_mid = x + dt/2 v           where velocities are found: v is output
 *   x' = x + dt V(x_mid, F*)                    where positions advance
 *
 * The noise is a force, the same in both places: then the second-order term of the step has the
 * mean kT div M dt. Kept as a velocity it would have none. Whoever is held, or the plane, is so in
 * the half step too; who is moved as told is half way there, by the mean velocity of the step. The
 * fluid at x_mid is that of the middle of the step.
 * Forces are extrapolated, so that they are found once per step.
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
  if (deform && noise.on())
    voice.of("keyword temperature")
        .fail("Brownian motion of films, multiblobs, clumps that feel each other and whatever else needs "
              "scheme midpoint is for boxes that do not change: take " + name_of(deform) + " away, or "
              "use single points");
  if (deform)
    keyword.fail("midpoint is for boxes that do not change, and " + name_of(deform) +
                 " deforms this one: use ab2");
}

void FixStokesDynamicsOverdamped::begin_midpoint(Hydrodynamics &hydro, const Solve::Take &take)
{
  const int width = hydro.rotation() ? 6 : 3;
  Solve::Draw draw;
  if (noise.on())
    draw = noise.forces(hydro, [this, width](int i, const double *f) {
      std::copy_n(f, width, random.give(i));
    });
  hydro.velocities(take, given(), noise.on() ? &draw : nullptr);
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

/* By the velocities of now, for dt. Positions of atoms are those of the start. */
void FixStokesDynamicsOverdamped::place_clumps(Hydrodynamics &hydro, const Clumps &start,
                                               const std::vector<double> &x, double dt)
{
  static const double CENTROID[3] = {0.0, 0.0, 0.0};
  const auto step = [&](size_t c) {
    ClumpStep s = {CENTROID, {}, nullptr};
    for (int d = 0; d < 6; d++) s.move[d] = dt * hydro.motion().clumps()[c].V[d];
    keep_in_plane(s.move, 6);
    return s;
  };
  step_clumps(hydro, start, x, step, [&](int i, const double *row) {
    if (dt == update->dt) clump_moves(hydro, i, row);
  });
}

/* Half the step by the velocities of now, all of it by those there. Atoms keep their ranks and
 * their numbers: nobody migrates in between. */
void FixStokesDynamicsOverdamped::move_by_midpoint(Hydrodynamics &hydro)
{
  const double dt = update->dt;
  const std::vector<int> who = hydro.ambient.who(), lone = hydro.motion().lone();
  const Clumps start = hydro.motion().clumps();
  const std::vector<double> of_members = hydro.scene.whole.x;
  const std::vector<double> mu = directions.all();
  const size_t width = hydro.rotation() ? 6 : 3;
  std::vector<double> x(3 * (size_t) atom->nlocal + 3), V(2 * x.size());
  for (int i : who) {
    std::copy_n(atom->x[i], 3, &x[3 * (size_t) i]);
    std::copy_n(motion[i], 3, &V[6 * (size_t) i]);
    if (directions.on()) std::copy_n(directions.turning[i], 3, &V[6 * (size_t) i + 3]);
  }
  find_half_step(hydro, x);
  const auto place = [&](double part) {
    for (int i : who) std::copy_n(&x[3 * (size_t) i], 3, atom->x[i]);
    directions.restore(mu);
    for (size_t i : lone) {
      const double *v = is_held((int) i) ? &dragged.v[3 * i] : &V[6 * i];
      for (size_t d = 0; d < 3; d++) atom->x[i][d] += part * v[d];
      if (!is_held((int) i)) directions.turn((int) i, v + 3, part);
    }
    if (hydro.settings.rigid.on) place_clumps(hydro, start, of_members, part);
  };
  for (int i : who) std::copy_n(&x[3 * (size_t) i], 3, atom->x[i]);
  hydro.look_ahead();
  place(0.5 * dt);
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
  if (flow.deforms) box.put(box.end);
  place(hydro, start, {dt, carried, box.start, box.middle, box.end, hydro.ambient.box_motion()}, there, V);
  dragged.v.clear();
  for (int i : start.who) load_on(i, load.give(i));
  for (int i : start.lone) {
    const double *v = &V[6 * (size_t) i], step[3] = {dt * v[0], dt * v[1], dt * v[2]};
    if (!is_held(i)) moves(i, step);
  }
}
