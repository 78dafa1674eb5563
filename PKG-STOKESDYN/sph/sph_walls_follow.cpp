#include "sph_walls.h"

#include "fix_sph_inlet.h"
#include "fix_sph_outlet.h"
#include "fix_sph_settings.h"
#include "fix_wall_sph.h"
#include "gravity.h"
#include "ranks.h"
#include "sd_sph_step.h"
#include "sd_sph_wall.h"

#include "atom.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace StokesDyn;

/* Their density becomes the one that has this pressure, so ghosts get it like any other density. The velocity
 * travels as the difference to v, which ghosts have. */
void SphWalls::follow()
{
  const int n = rows.particles.n;
  sd_sph_pack_v(n, Sph::numbers(atom->vest), atom->rho, rows.v4.data());
  const double *w = spins_of_walls();
  rows.weights.resize(8 * (size_t) (n + 1));
  sd_sph_pack_fluid(&rows.particles, rows.P.data(), rows.weights.data());
  rows.sums.assign(8 * (size_t) (n + 1), 0.0);
  sd_sph_before_walls(&rows.model, &rows.pairs, &rows.particles, rows.weights.data(), w, rows.sums.data());
  ghosts.reverse(rows.sums.data(), 8);
  if (sd_sph_of_fluids(&rows.model)) sums_of_other_fluids(w);

  wall_rows.resize(4 * (size_t) (n + 1));
  if (roles.wall) roles.wall->gravity.find(lmp);
  for (auto *inlet : roles.inlets) inlet->gravity.find(lmp);
  look_at_gravity();
  for (auto *inlet : roles.inlets)
    if (inlet->gives_pressure()) inlet->find_pressures();
  for (auto *outlet : roles.outlets) outlet->find_pressures();
  for (int i = 0; i < atom->nlocal; i++) {
    double *row = &wall_rows[4 * (size_t) i];
    row[0] = atom->rho[i];
    if (roles.is_wall(i))
      wall_row(i, &rows.sums[8 * (size_t) i], row);
    else if (roles.is_held(i))
      held_row(i, &rows.sums[8 * (size_t) i], row);
  }
  ghosts.forward(wall_rows.data(), 4);
  for (int i = 0; i < n; i++) {
    if (!roles.is_wall(i) && !roles.is_held(i)) continue;
    const double *row = &wall_rows[4 * (size_t) i];
    atom->rho[i] = row[0];
    for (int d = 0; d < 3; d++) atom->vest[i][d] = atom->v[i][d] + row[1 + d];
  }
  rows.find_pressures();
}

/* The angular velocity of the wall before each fluid particle, for friction [4 (n+1)]; nullptr: no wall
 * moves, or none rubs. x4 and v4 are packed. */
const double *SphWalls::spins_of_walls()
{
  constexpr double SLOWEST = 1e-6;    // of the speed of sound; less is rounding
  if (!roles.wall || roles.wall->slip || !(rows.model.friction || rows.model.artvisc)) return nullptr;
  int moves = 0;
  for (int i = 0; i < atom->nlocal; i++)
    if (roles.is_wall(i) && roles.has_velocity(i)) moves = 1;
  if (!largest_of_all(world, moves)) return nullptr;

  rows.sums.assign(SD_SPH_MOTION * (size_t) (rows.particles.n + 1), 0.0);
  sd_sph_motion_of_walls(&rows.model, &rows.pairs, &rows.particles, rows.sums.data());
  ghosts.reverse(rows.sums.data(), SD_SPH_MOTION);
  spins.assign(4 * (size_t) (rows.particles.n + 1), 0.0);
  double w2_shear2[2] = {0.0, 0.0};
  for (int i = 0; i < atom->nlocal; i++) {
    if (rows.particles.phase[i] < 0 || !settings.used(atom->type[i])) continue;
    double w[3], shear;
    const double speed = sd_sph_spin(&rows.sums[SD_SPH_MOTION * (size_t) i], w, &shear);
    if (speed == 0.0) continue;
    const double sound = roles.speed_of_sound(i);
    if (speed * settings.smoothing_length(atom->type[i]) < SLOWEST * sound) continue;
    std::copy_n(w, 3, &spins[4 * (size_t) i]);
    w2_shear2[0] += speed * speed;
    w2_shear2[1] += shear * shear;
  }
  check_turning(w2_shear2);
  ghosts.forward(spins.data(), 4);
  return spins.data();
}

/* On a wall that turns by w, laplacian lacks the traction mu grad(u).n, of the size mu w beside mu
 * times the shear rate. The squares of both of this rank. Fixes give walls their velocity in the first
 * step of a run; later on they may begin to turn. */
void SphWalls::check_turning(const double w2_shear2[2]) const
{
  constexpr double MOST = 0.02;    // of the stress
  const bool now = !update->setupflag &&
      (neighbor->ago == 0 || update->ntimestep == update->firststep + 1);
  if (rows.model.friction != SD_SPH_LAPLACIAN || !now) return;
  double all[2];
  MPI_Allreduce(w2_shear2, all, 2, MPI_DOUBLE, MPI_SUM, world);
  if (all[0] <= MOST * MOST * all[1]) return;
  roles.wall->voice.at_step().fail("the wall turns: beside it, 'viscosity mu laplacian' of pair_style " +
                                   std::string(Sph::PAIR_STYLE) + " makes a wrong torque; use 'viscosity mu central'");
}

/* A pressure has no jump where two fluids meet: a particle before which none of its own fluid is takes
 * that of the other, if its own state can have it. The same sums with all fluids as one, where its own
 * are empty. */
void SphWalls::sums_of_other_fluids(const double *w)
{
  int alone = 0;
  for (int i = 0; i < atom->nlocal; i++)
    if ((roles.is_wall(i) || roles.is_held(i)) && rows.sums[8 * (size_t) i] == 0.0) alone = 1;
  if (!largest_of_all(world, alone)) return;

  const Rows mine = rows.sums;
  std::vector<int> kinds(rows.phases);
  for (int &kind : kinds) kind = kind < 0 ? ~0 : 0;
  rows.particles.phase = kinds.data();
  rows.sums.assign(8 * (size_t) (rows.particles.n + 1), 0.0);
  sd_sph_before_walls(&rows.model, &rows.pairs, &rows.particles, rows.weights.data(), w, rows.sums.data());
  ghosts.reverse(rows.sums.data(), 8);
  rows.particles.phase = rows.phases.data();
  for (int i = 0; i < atom->nlocal; i++) {
    if (!roles.is_wall(i) && !roles.is_held(i)) continue;
    double *row = &rows.sums[8 * (size_t) i];
    const bool own_fluid = mine[8 * (size_t) i] != 0.0;
    if (own_fluid || !(row[1] > row[0] * sd_sph_least_pressure(&roles.state_of(i)->state)))
      std::copy_n(&mine[8 * (size_t) i], 8, row);
  }
}

/* The row of a wall particle, sd_sph_wall.h. */
void SphWalls::wall_row(int i, const double *sums_i, double *row)
{
  const FixSphPressure *eos = roles.state_of(i);
  const sd_sph_wall how = {&eos->state, roles.wall->slip, roles.wall->suction};
  const double sound = sd_sph_speed_of_sound(&eos->state, row[0]);
  const double rest[3] = {0.0, 0.0, 0.0}, *displaced = roles.stands(i) ? rest : atom->v[i];
  const double *b = roles.wall->body_force(i, displaced, 2.0 * settings.smoothing_length(atom->type[i]) / sound);
  const double asked = sd_sph_wall_particle(&how, sums_i, atom->v[i], b, row);
  if (row[0] == 0.0) no_density(roles.wall->voice, i, text(asked) + " that the fluid asks for");
}

/* Particles of an inlet have the pressure of the fluid before them, as walls, and their own
 * velocity; those of an outlet, and of an inlet by pressure, have the pressure that it is told. */
void SphWalls::held_row(int i, const double *sums_i, double *row)
{
  const FixSphPressure *eos = roles.state_of(i);
  auto *inlet = roles.inlet_of(i);
  if (inlet && !inlet->gives_pressure()) {
    const sd_sph_wall how = {&eos->state, 0, 1};
    const double asked = sd_sph_wall_particle(&how, sums_i, atom->v[i], inlet->gravity.now(), row);
    std::fill_n(row + 1, 3, 0.0);
    if (row[0] == 0.0) no_density(inlet->voice, i, text(asked) + " that the fluid asks for");
    return;
  }
  const FixSphOpening *open = inlet ? (const FixSphOpening *) inlet : roles.outlet_of(i);
  const double given = open->pressure_of(i);
  row[0] = sd_sph_density_of(&eos->state, given);
  std::fill_n(row + 1, 3, 0.0);
  if (row[0] == 0.0) no_density(open->voice, i, text(given) + " that is asked of it");
}

void SphWalls::no_density(const Voice &of, int i, const std::string &asked) const
{
  const FixSphPressure *eos = roles.state_of(i);
  of.at_step().fail_one("atom " + std::to_string(atom->tag[i]) + ": the pressure " + asked +
              " is not above " + text(sd_sph_least_pressure(&eos->state)) + ", the lowest of fix " +
              eos->id + ": if gravity has the right sign, use a larger B or P0");
}

/* A variable may contain the acceleration of the wall. */
void SphWalls::look_at_gravity() const
{
  const auto look = [this](const Voice &of, const BodyForce &gravity) {
    if (gravity.varies()) return;
    compare_gravity(of, gravity.now(), [this](int i) { return settings.used(atom->type[i]) && !roles.is_wall(i); },
                    {"water", "the pressure of the water does not go on as it should; give the numbers of fix "
                              "gravity, or with an acceleration of the wall a variable"});
  };
  if (roles.wall) look(roles.wall->voice, roles.wall->gravity);
  for (auto *inlet : roles.inlets)
    if (!inlet->gives_pressure()) look(inlet->voice, inlet->gravity);
}

double SphWalls::bytes() const
{
  return (spins.capacity() + wall_rows.capacity()) * sizeof(double);
}
