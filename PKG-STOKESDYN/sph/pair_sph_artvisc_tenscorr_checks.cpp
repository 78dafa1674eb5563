/* Of pair_style sph/artVisc/tensCorr: what may be wrong with the particles of a scene. */
#include "pair_sph_artvisc_tenscorr.h"

#include "fix_sph_settings.h"
#include "fix_wall_sph.h"
#include "fixes.h"
#include "keywords.h"
#include "ranks.h"
#include "sd_sph_step.h"
#include "sd_sph_wall.h"

#include "atom.h"
#include "domain.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>

using namespace LAMMPS_NS;
using namespace StokesDyn;

/* Owned particles before any sum takes them in (what one lacks is no number in all around it then),
 * and with their ghosts after the density has been advanced. */
void PairSph::look_at_densities(int n)
{
  const double *rho = atom->rho;
  for (int i = 0; i < n; i++) {
    if (rho[i] > 0.0 && std::isfinite(rho[i]) && (atom->mask[i] & pressure_bits)) continue;
    if (!used(atom->type[i])) continue;
    const Voice now = voice.at_step();
    const std::string who = "atom " + std::to_string(atom->tag[i]);
    if (!(atom->mask[i] & pressure_bits))
      now.fail_one(who + " is in the group of no fix sph/pressure");
    const char *cure = update->setupflag ? "; give it one by the command set ... sph/rho"
        : rho[i] == 0.0 ? "; if it was created in this run: fix sph/pressure relativ and Tait give "
                          "new atoms of their group the density rho0"
                        : "; the time step may be too long";
    now.fail_one(who + " has the density " + text(rho[i]) + "; it must be a number > 0" + cure);
  }
}

double PairSph::one_smoothing_length(const Voice &of) const
{
  double least = HUGE_VAL, most = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!is_particle(i)) continue;
    least = std::min(least, smoothing_length(atom->type[i]));
    most = std::max(most, smoothing_length(atom->type[i]));
  }
  least = smallest_of_all(world, least);
  most = largest_of_all(world, most);
  if (most > least * (1.0 + 1e-9))
    of.fail("types of pair_style sph/artVisc/tensCorr have smoothing lengths from " + text(least) + " to " +
            text(most) + ": it needs one h for all of them");
  return most > 0.0 ? least : 0.0;
}

// --- at the beginning of a run ---------------------------------------------------------------------

/* Before any sum, but for look_at_bodies(), which needs the pressures of the first force */
void PairSph::look_at_beginning()
{
  look_at_sound();
  look_at_widths();
  look_at_plane();
  look_at_idlers();
  look_at_fluids();
  if (!resumes()) look_at_scene();
  if (wall) look_at_walls();
  if (wall) tell_of_belts();
  look_at_step();
}

/* Both speeds of sound should be one: limits of the time step, artVisc and delta go by that of
 * pair_coeff, the fluid by that of the equation of state. */
void PairSph::look_at_sound()
{
  struct {
    double off;
    int type;
  } worst = {log(1.1), 0};
  double sound = 0.0;
  for (const auto *fix : pressures)
    for (int i = 0; i < atom->nlocal; i++) {
      const int type = atom->type[i];
      if (!(atom->mask[i] & fix->groupbit) || !used(type) || !has_sound_speed(type)) continue;
      const double rho = fix->state.rho0 > 0.0 ? fix->state.rho0 : atom->rho[i];
      const double c = sd_sph_speed_of_sound(&fix->state, rho), off = fabs(log(c / sound_speed(type)));
      if (!(off > worst.off)) continue;
      worst = {off, type};
      sound = c;
    }
  auto all = worst;
  MPI_Allreduce(&worst, &all, 1, MPI_DOUBLE_INT, MPI_MAXLOC, world);
  if (all.type == 0) return;
  if (worst.type != all.type || worst.off != all.off) sound = 0.0;
  sound = largest_of_all(world, sound);
  voice.warn("type " + std::to_string(all.type) + " has the speed of sound " +
             text(sound_speed(all.type)) + " by pair_coeff c, and " + text(sound) +
             " by its fix sph/pressure: limits of the time step, artVisc and delta use that of "
             "pair_coeff, the fluid has that of fix sph/pressure");
}

double PairSph::growth_limit(int bits) const
{
  double mine = HUGE_VAL;
  for (int i = 0; i < atom->nlocal; i++) {
    const int t = atom->type[i];
    const FixSphPressure *eos = state_of(i);
    if (!(atom->mask[i] & bits) || is_wall(i) || !used(t) || !eos || !(atom->rho[i] > 0.0)) continue;
    const double sound = sd_sph_speed_of_sound(&eos->state, atom->rho[i]);
    const sd_sph_parameters p = {table[H][t][t], sound, table[ALPHA][t][t], table[BETA][t][t],
                                 table[DELTAP][t][t], law == SD_SPH_NEWTON ? table[MU][t][t] : 0.0};
    mine = std::min(mine, sd_sph_growth_limit(&model, &p, atom->rho[i]));
  }
  return smallest_of_all(world, mine);
}

double PairSph::speed_of_sound(int i) const
{
  return sd_sph_speed_of_sound(&state_of(i)->state, atom->rho[i]);
}

double PairSph::all_viscosity(int i) const
{
  const int t = atom->type[i];
  const double artificial =
      model.artvisc ? atom->rho[i] * table[ALPHA][t][t] * table[C][t][t] * table[H][t][t] : 0.0;
  return viscosity(i) + artificial / (2.0 * (model.dimension + 2));
}

/* Among the equations of state with a density rho0; nullptr: there is none. */
template <class Value>
static std::pair<const FixSphPressure *, const FixSphPressure *>
least_and_most(const std::vector<FixSphPressure *> &fixes, const Value &value)
{
  const FixSphPressure *least = nullptr, *most = nullptr;
  for (const auto *fix : fixes) {
    if (!(fix->state.rho0 > 0.0)) continue;
    if (!least || value(fix) < value(least)) least = fix;
    if (!most || value(fix) > value(most)) most = fix;
  }
  return {least, most};
}

/* Two fluids share a pressure at their interface, that for which the stiffer one is made. One that is
 * much softer is compressed by it beyond what weakly compressible means, and with correction, which
 * holds no particle by a pressure that is the same everywhere, it is torn: Rayleigh-Taylor at a ratio
 * of densities of 100 to 1000 ran with stiffnesses 98 to 1, and stopped with 196 to 1. */
void PairSph::check_stiffness()
{
  constexpr double MOST = 100.0;
  if (model.scheme != SD_SPH_VOLUME_CORRECTION) return;
  const FixSphPressure *soft, *stiff;
  auto stiffness = [](const FixSphPressure *fix) {
    const double c = sd_sph_speed_of_sound(&fix->state, fix->state.rho0);
    return fix->state.rho0 * c * c;
  };
  std::tie(soft, stiff) = least_and_most(pressures, stiffness);
  if (!soft || stiffness(stiff) <= MOST * (1.0 + 1e-9) * stiffness(soft)) return;
  voice.fail(std::string("correction yes with volume yes: the fluid of fix ") + soft->id + " is " +
             text(stiffness(stiff) / stiffness(soft)) + " times softer than that of fix " +
             stiff->id + " (by rho0 c^2 of these fixes); a fluid that is more than " + text(MOST) +
             " times softer would be torn: give it a larger B, which makes a speed of sound of " +
             text(sqrt(stiffness(stiff) / MOST / soft->state.rho0)) + " or more");
}

/* The pressure of a pair is that of one width: where widths meet, sums of the two sides differ. */
void PairSph::look_at_widths()
{
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i + 1; j <= atom->ntypes; j++) {
      const double one = table[H][i][i], other = table[H][j][j];
      if (!(one > 0.0 && other > 0.0 && fabs(log(one / other)) > log(1.2))) continue;
      voice.warn("types " + std::to_string(i) + " and " + std::to_string(j) +
                 " differ in h: where they meet, particles do not stay at rest");
      return;
    }
}

/* Distances along z count as any others, also in two dimensions. create_atoms of an older LAMMPS fills a box
 * that is thicker along z than the lattice with several planes, one behind the other, and says nothing. */
void PairSph::look_at_plane()
{
  if (domain->dimension != 2) return;
  double low = HUGE_VAL, high = -HUGE_VAL, h = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!used(atom->type[i])) continue;
    low = std::min(low, atom->x[i][2]);
    high = std::max(high, atom->x[i][2]);
    h = std::max(h, table[H][atom->type[i]][atom->type[i]]);
  }
  low = smallest_of_all(world, low);
  high = largest_of_all(world, high);
  h = largest_of_all(world, h);
  if (high - low > 1e-3 * h)
    voice.fail("in two dimensions all particles must stand in one plane, and they stand from z = " + text(low) +
               " to " + text(high) + ": make the box thinner along z than the spacing of the lattice, of which "
               "create_atoms of an older LAMMPS makes as many planes as have room");
}

/* Whom no fix gives a density or a place: neither water nor a wall. */
void PairSph::look_at_idlers()
{
  const int kept = leapfrog_bits | Sph::groups(fixes_of(lmp, "sph")) | Sph::groups(fixes_of(lmp, "sph/stationary"));
  if (!continuity || update->nsteps == 0) return;
  double idle = 0.0;
  tagint first = MAXTAGINT;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!used(atom->type[i]) || is_wall(i) || (atom->mask[i] & kept)) continue;
    idle++;
    first = std::min(first, atom->tag[i]);
  }
  idle = sum_of_all(world, idle);
  first = smallest_of_all(world, first);
  if (idle > 0.0)
    voice.warn(text(idle) + " particles, the first is atom " + std::to_string(first) +
               ", are in the group of no fix nve/sph, nve/sph/stationary or wall/adami/sph: they act as water whose "
               "density never changes, which is no wall; give particles of walls to fix wall/adami/sph");
}

/* Without volume yes a particle takes the mass of a neighbour for that of its own fluid. */
void PairSph::look_at_fluids()
{
  if (!continuity || continuity->volume) return;
  const FixSphPressure *light, *heavy;
  std::tie(light, heavy) =
      least_and_most(pressures, [](const FixSphPressure *fix) { return fix->state.rho0; });
  if (!light || heavy->state.rho0 <= 1.1 * light->state.rho0) return;
  voice.warn(std::string("fix ") + heavy->id + " has rho0 = " + text(heavy->state.rho0) + ", fix " +
             light->id + " has rho0 = " + text(light->state.rho0) +
             ": where these fluids meet, densities are wrong; use volume yes of fix "
             "sph/density/continuity");
}

/* At a surface that should not be there shift moves particles out of the fluid. found: one of this rank that is
 * at a surface, -1: none. */
void PairSph::look_at_surface(int found)
{
  const tagint at_surface = smallest_of_all(world, found < 0 ? MAXTAGINT : atom->tag[found]);
  if (at_surface < MAXTAGINT)
    voice.warn("P0 of fix sph/pressure is " + text(background()) + ", which says with shift that the fluid fills its "
               "vessel, but atom " + std::to_string(at_surface) + " is at a free surface: use P0 = 0");
}

/* Wall particles stand for fluid: they push with its mass. */
void PairSph::look_at_walls()
{
  constexpr double NOBODY = -1e300;
  const int n = particles.n;
  std::vector<double> likeness(n + 1, NOBODY);
  sd_sph_pack_x(n, Sph::numbers(atom->x), nullptr, nullptr, 0.0, x4.data());
  sd_sph_likeness(&model, &raw, &particles, likeness.data());
  reverse(likeness.data(), 1, true);
  tagint other_mass = MAXTAGINT;
  for (int i = 0; i < atom->nlocal; i++)
    if (is_wall(i) && likeness[i] != NOBODY && likeness[i] < -log(1.1))
      other_mass = std::min(other_mass, atom->tag[i]);
  other_mass = smallest_of_all(world, other_mass);
  if (other_mass < MAXTAGINT)
    wall->voice.warn(
        "the mass of atom " + std::to_string(other_mass) +
        " and the mass of the fluid particles in front of it differ by more than 10 %: wall "
        "particles need the mass and the spacing of the fluid; give a light or heavy body its "
        "true mass by fix rigid ... infile");
}

/* A lid is given by its velocity alone. Who has taken fix move from a wall and forgotten its velocity
 * has one as well. */
void PairSph::tell_of_belts()
{
  double belts = 0.0;
  for (int i = 0; i < atom->nlocal; i++) belts += is_wall(i) && stands(i) && has_velocity(i);
  belts = sum_of_all(world, belts);
  if (belts > 0.0)
    wall->voice.tell(text(belts) + " particles of the wall have a velocity, and no fix moves them: they "
                     "stay where they are and rub as a lid or a belt does");
}

/* Under pressure the arrangement of particles holds bodies back (sd_sph_arrangement). A body that is nearly
 * as heavy as the water is then held where it is. After the first force, which has made the pressures. */
void PairSph::look_at_bodies()
{
  if (model.dimension != domain->dimension) return;
  for (int k = 0; k < lmp->modify->nfix; k++) {
    Fix *fix = lmp->modify->fix[k];
    int dim;
    if (strncmp(fix->style, "rigid", 5) != 0) continue;
    const auto *body = (const int *) fix->extract("body", dim);
    const auto *mass = (const double *) fix->extract("masstotal", dim);
    if (body && mass) look_at_bodies_of(fix, body, mass);
  }
}

void PairSph::look_at_bodies_of(const Fix *rigid, const int *body, const double *mass)
{
  enum { VOLUME, OF_WATER, PRESSURE, WIDTH, NSUMS };
  const int bodies = rigid->size_array_rows, D = model.dimension;
  std::vector<double> mine((size_t) NSUMS * std::max(bodies, 0), 0.0), all(mine.size());
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & rigid->groupbit) || !is_wall(i) || body[i] < 0 || body[i] >= bodies) continue;
    double *sums = &mine[(size_t) NSUMS * body[i]];
    const double V = Sph::mass(lmp, i) / rest_density(i);
    sums[VOLUME] += V;
    sums[OF_WATER] += Sph::mass(lmp, i);
    sums[PRESSURE] += V * (P[i] - reference_pressure());
    sums[WIDTH] += V * smoothing_length(atom->type[i]) / pow(V, 1.0 / D);
  }
  MPI_Allreduce(mine.data(), all.data(), (int) all.size(), MPI_DOUBLE, MPI_SUM, world);
  const double *g = wall->gravity.now(), fall = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  for (int k = 0; k < bodies; k++) {
    const double *sums = &all[(size_t) NSUMS * k], V = sums[VOLUME], weight = fabs(sums[OF_WATER] - mass[k]) * fall;
    if (!(V > 0.0 && fall > 0.0)) continue;
    const double pressure = sums[PRESSURE] / V, length = pow(V, 1.0 / D);
    const double resists = length * sd_sph_arrangement(&model, sums[WIDTH] / V, 1.0, pressure, V);
    if (!(weight < resists)) continue;
    wall->voice.warn("body " + std::to_string(k + 1) + " of fix " + rigid->id + " is moved by " + text(weight) +
                     ", its weight less that of the water; under the pressure " + text(pressure) +
                     " the arrangement of the particles resists with " + text(resists) +
                     " when it goes its own length: it will be too slow, or stay; use " +
                     (model.scheme == SD_SPH_SHIFT_PLIANT ? "" : "shift pliant, or ") + "h = 3 dx");
    return;
  }
}

// --- in a run --------------------------------------------------------------------------------------

/* On a wall that turns by w, laplacian lacks the traction mu grad(u).n, of the size mu w beside mu
 * times the shear rate. The squares of both of this rank. Fixes give walls their velocity in the first
 * step of a run; later on they may begin to turn. */
void PairSph::check_turning(const double w2_shear2[2])
{
  constexpr double MOST = 0.02;    // of the stress
  const bool now = !update->setupflag &&
      (neighbor->ago == 0 || update->ntimestep == update->firststep + 1);
  if (model.friction != SD_SPH_LAPLACIAN || !now) return;
  double all[2];
  MPI_Allreduce(w2_shear2, all, 2, MPI_DOUBLE, MPI_SUM, world);
  if (all[0] <= MOST * MOST * all[1]) return;
  wall->voice.at_step().fail("the wall turns: beside it, 'viscosity mu laplacian' of pair_style " +
                             std::string(STYLE) + " makes a wrong torque; use 'viscosity mu central'");
}
