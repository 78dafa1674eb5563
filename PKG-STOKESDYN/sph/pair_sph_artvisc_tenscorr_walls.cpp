/* Of pair_style sph/artVisc/tensCorr: particles that are no fluid, of walls and of open ends. */
#include "pair_sph_artvisc_tenscorr.h"

#include "fix_sph_grains.h"
#include "fix_sph_inlet.h"
#include "fix_sph_outlet.h"
#include "fix_sph_settings.h"
#include "fix_wall_sph.h"
#include "gravity.h"
#include "keywords.h"
#include "ranks.h"
#include "sd_sph_wall.h"

#include "atom.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace StokesDyn;

bool PairSph::is_wall(int i) const
{
  return wall && (atom->mask[i] & wall->groupbit);
}

/* The load on walls by this style alone: atom->f has what other styles and fixes do as well. What ghosts got
 * is added on the rank that computed it. */
std::array<double, 3> PairSph::load_of(const Rows &F, int receivers) const
{
  std::array<double, 3> sum = {0.0, 0.0, 0.0};
  for (int i = 0; i < receivers; i++) {
    if (!is_wall(i)) continue;
    for (int d = 0; d < 3; d++) sum[d] += F[4 * (size_t) i + d];
  }
  return sum;
}

template <class Style> static Style *holder(const std::vector<Style *> &fixes, const Atom *atom, int i)
{
  for (auto *fix : fixes)
    if ((atom->mask[i] & fix->groupbit) && fix->holds(atom->x[i])) return fix;
  return nullptr;
}

bool PairSph::is_held(int i) const
{
  return holder(inlets, atom, i) || holder(outlets, atom, i);
}

const FixSphPressure *PairSph::state_of(int i) const
{
  for (const auto *fix : pressures)
    if (atom->mask[i] & fix->groupbit) return fix;
  return nullptr;    // look_at_densities has seen to it
}

/* The row of a wall particle, sd_sph_wall.h. */
void PairSph::wall_row(int i, const double *sums_i, double *row)
{
  const FixSphPressure *eos = state_of(i);
  const sd_sph_wall how = {&eos->state, wall->slip, wall->suction};
  const double sound = sd_sph_speed_of_sound(&eos->state, row[0]);
  const double rest[3] = {0.0, 0.0, 0.0}, *displaced = stands(i) ? rest : atom->v[i];
  const double *b = wall->body_force(i, displaced, 2.0 * smoothing_length(atom->type[i]) / sound);
  const double asked = sd_sph_wall_particle(&how, sums_i, atom->v[i], b, row);
  if (row[0] == 0.0) no_density(wall->voice, i, text(asked) + " that the fluid asks for");
}

double PairSph::rest_density(int i) const
{
  const FixSphPressure *eos = state_of(i);
  return eos && eos->state.rho0 > 0.0 ? eos->state.rho0 : atom->rho[i];
}

double PairSph::volume_of(int i) const
{
  const FixSphPressure *eos = state_of(i);
  const double rho = eos ? sd_sph_density_of_water(&eos->state, atom->rho[i]) : atom->rho[i];
  return Sph::mass(lmp, i) / (rho * (grains ? 1.0 - grains->fraction(i) : 1.0));
}

/* Particles of an inlet have the pressure of the fluid before them, as walls, and their own
 * velocity; those of an outlet, and of an inlet by pressure, have the pressure that it is told. */
void PairSph::held_row(int i, const double *sums_i, double *row)
{
  const FixSphPressure *eos = state_of(i);
  auto *inlet = holder(inlets, atom, i);
  if (inlet && !inlet->gives_pressure()) {
    const sd_sph_wall how = {&eos->state, 0, 1};
    const double asked = sd_sph_wall_particle(&how, sums_i, atom->v[i], inlet->gravity.now(), row);
    std::fill_n(row + 1, 3, 0.0);
    if (row[0] == 0.0) no_density(inlet->voice, i, text(asked) + " that the fluid asks for");
    return;
  }
  const FixSphOpening *open = inlet ? (const FixSphOpening *) inlet : holder(outlets, atom, i);
  const double given = open->pressure_of(i);
  row[0] = sd_sph_density_of(&eos->state, given);
  std::fill_n(row + 1, 3, 0.0);
  if (row[0] == 0.0) no_density(open->voice, i, text(given) + " that is asked of it");
}

void PairSph::no_density(const Voice &of, int i, const std::string &asked) const
{
  const FixSphPressure *eos = state_of(i);
  of.at_step().fail_one("atom " + std::to_string(atom->tag[i]) + ": the pressure " + asked +
              " is not above " + text(sd_sph_least_pressure(&eos->state)) + ", the lowest of fix " +
              eos->id + ": if gravity has the right sign, use a larger B or P0");
}

/* The angular velocity of the wall before each fluid particle, for friction [4 (n+1)]; nullptr: no wall
 * moves, or none rubs. x4 and v4 are packed. */
const double *PairSph::spins_of_walls()
{
  constexpr double SLOWEST = 1e-6;    // of the speed of sound; less is rounding
  if (!wall || wall->slip || !(model.friction || model.artvisc)) return nullptr;
  int moves = 0;
  for (int i = 0; i < atom->nlocal; i++)
    if (is_wall(i) && has_velocity(i)) moves = 1;
  if (!largest_of_all(world, moves)) return nullptr;

  sums.assign(SD_SPH_MOTION * (size_t) (particles.n + 1), 0.0);
  sd_sph_motion_of_walls(&model, &pairs, &particles, sums.data());
  reverse(sums.data(), SD_SPH_MOTION);
  spins.assign(4 * (size_t) (particles.n + 1), 0.0);
  double w2_shear2[2] = {0.0, 0.0};
  for (int i = 0; i < atom->nlocal; i++) {
    if (particles.phase[i] < 0 || !used(atom->type[i])) continue;
    double w[3], shear;
    const double speed = sd_sph_spin(&sums[SD_SPH_MOTION * (size_t) i], w, &shear);
    if (speed == 0.0) continue;
    const double sound = sd_sph_speed_of_sound(&state_of(i)->state, atom->rho[i]);
    if (speed * smoothing_length(atom->type[i]) < SLOWEST * sound) continue;
    std::copy_n(w, 3, &spins[4 * (size_t) i]);
    w2_shear2[0] += speed * speed;
    w2_shear2[1] += shear * shear;
  }
  check_turning(w2_shear2);
  forward(spins.data(), 4);
  return spins.data();
}

/* A pressure has no jump where two fluids meet: a particle before which none of its own fluid is takes
 * that of the other, if its own state can have it. The same sums with all fluids as one, where its own
 * are empty. */
void PairSph::sums_of_other_fluids(const double *spins_of_walls)
{
  int alone = 0;
  for (int i = 0; i < atom->nlocal; i++)
    if ((is_wall(i) || is_held(i)) && sums[8 * (size_t) i] == 0.0) alone = 1;
  if (!largest_of_all(world, alone)) return;

  const Rows mine = sums;
  std::vector<int> kinds(phases);
  for (int &kind : kinds) kind = kind < 0 ? ~0 : 0;
  particles.phase = kinds.data();
  sums.assign(8 * (size_t) (particles.n + 1), 0.0);
  sd_sph_before_walls(&model, &pairs, &particles, weights.data(), spins_of_walls, sums.data());
  reverse(sums.data(), 8);
  particles.phase = phases.data();
  for (int i = 0; i < atom->nlocal; i++) {
    if (!is_wall(i) && !is_held(i)) continue;
    double *row = &sums[8 * (size_t) i];
    const bool own_fluid = mine[8 * (size_t) i] != 0.0;
    if (own_fluid || !(row[1] > row[0] * sd_sph_least_pressure(&state_of(i)->state)))
      std::copy_n(&mine[8 * (size_t) i], 8, row);
  }
}

/* What the particles of walls and open ends take from the fluid before them. Their density becomes the
 * one that has this pressure, so ghosts get it like any other density. The velocity travels as the
 * difference to v, which ghosts have. */
void PairSph::wall_particles()
{
  const int n = particles.n;
  sd_sph_pack_v(n, Sph::numbers(atom->vest), atom->rho, v4.data());
  const double *w = spins_of_walls();
  weights.resize(8 * (size_t) (n + 1));
  sd_sph_pack_fluid(&particles, P.data(), weights.data());
  sums.assign(8 * (size_t) (n + 1), 0.0);
  sd_sph_before_walls(&model, &pairs, &particles, weights.data(), w, sums.data());
  reverse(sums.data(), 8);
  if (sd_sph_of_fluids(&model)) sums_of_other_fluids(w);

  wall_rows.resize(4 * (size_t) (n + 1));
  if (wall) wall->gravity.find(lmp);
  for (auto *inlet : inlets) inlet->gravity.find(lmp);
  look_at_gravity();
  for (auto *inlet : inlets)
    if (inlet->gives_pressure()) inlet->find_pressures();
  for (auto *outlet : outlets) outlet->find_pressures();
  for (int i = 0; i < atom->nlocal; i++) {
    double *row = &wall_rows[4 * (size_t) i];
    row[0] = atom->rho[i];
    if (is_wall(i))
      wall_row(i, &sums[8 * (size_t) i], row);
    else if (is_held(i))
      held_row(i, &sums[8 * (size_t) i], row);
  }
  forward(wall_rows.data(), 4);
  for (int i = 0; i < n; i++) {
    if (!is_wall(i) && !is_held(i)) continue;
    const double *row = &wall_rows[4 * (size_t) i];
    atom->rho[i] = row[0];
    for (int d = 0; d < 3; d++) atom->vest[i][d] = atom->v[i][d] + row[1 + d];
  }
  pressures_of_all();
}

/* A variable may contain the acceleration of the wall. */
void PairSph::look_at_gravity() const
{
  const auto look = [this](const Voice &of, const BodyForce &gravity) {
    if (gravity.varies()) return;
    compare_gravity(of, gravity.now(), [this](int i) { return used(atom->type[i]) && !is_wall(i); },
                    {"water", "the pressure of the water does not go on as it should; give the numbers of fix "
                              "gravity, or with an acceleration of the wall a variable"});
  };
  if (wall) look(wall->voice, wall->gravity);
  for (auto *inlet : inlets)
    if (!inlet->gives_pressure()) look(inlet->voice, inlet->gravity);
}

/* Two particles that stand in walls and open ends do no work on the flow, and at the back of an open
 * end it depends on the list of neighbours which of them are there. */
sd_sph_list PairSph::pairs_of_flow()
{
  const int *count = corrects ? near.count.data() : pairs.count;
  size_t entries = 0;
  for (int k = 0; k < pairs.n; k++) entries += count[pairs.first[k]] + SD_SPH_LANES;
  of_flow.resize(atom->nmax, entries);
  const sd_sph_near all = near.room(0.0), flow = of_flow.room(0.0);
  sd_sph_pairs_of_flow(&particles, &pairs, &all, corrects, &flow);
  return {pairs.n, ~0, pairs.first, of_flow.own.data(), of_flow.neighbor.data()};
}
