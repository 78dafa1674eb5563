#include "sph_checks.h"

#include "fix_sph_settings.h"
#include "fix_wall_sph.h"
#include "fixes.h"
#include "ranks.h"
#include "sd_sph_step.h"
#include "sd_sph_wall.h"

#include "atom.h"
#include "domain.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <tuple>

using namespace LAMMPS_NS;
using namespace StokesDyn;

void SphChecks::look_at_beginning()
{
  look_at_sound();
  look_at_widths();
  look_at_plane();
  look_at_idlers();
  look_at_fluids();
  if (!roles.resumes()) look_at_scene();
  if (roles.wall) look_at_walls();
  if (roles.wall) tell_of_belts();
  look_at_step();
}

/* Both speeds of sound should be one: limits of the time step, artVisc and delta go by that of
 * pair_coeff, the fluid by that of the equation of state. */
void SphChecks::look_at_sound()
{
  struct {
    double off;
    int type;
  } worst = {log(1.1), 0};
  double sound = 0.0;
  for (const auto *fix : roles.pressures)
    for (int i = 0; i < atom->nlocal; i++) {
      const int type = atom->type[i];
      if (!(atom->mask[i] & fix->groupbit) || !settings.used(type) || !settings.has_sound_speed(type)) continue;
      const double rho = fix->state.rho0 > 0.0 ? fix->state.rho0 : atom->rho[i];
      const double c = sd_sph_speed_of_sound(&fix->state, rho), off = fabs(log(c / settings.sound_speed(type)));
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
             text(settings.sound_speed(all.type)) + " by pair_coeff c, and " + text(sound) +
             " by its fix sph/pressure: limits of the time step, artVisc and delta use that of "
             "pair_coeff, the fluid has that of fix sph/pressure");
}

/* The pressure of a pair is that of one width: where widths meet, sums of the two sides differ. */
void SphChecks::look_at_widths()
{
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i + 1; j <= atom->ntypes; j++) {
      const double one = settings.smoothing_length(i), other = settings.smoothing_length(j);
      if (!(one > 0.0 && other > 0.0 && fabs(log(one / other)) > log(1.2))) continue;
      voice.warn("types " + std::to_string(i) + " and " + std::to_string(j) +
                 " differ in h: where they meet, particles do not stay at rest");
      return;
    }
}

/* Distances along z count as any others, also in two dimensions. create_atoms of an older LAMMPS fills a box
 * that is thicker along z than the lattice with several planes, one behind the other, and says nothing. */
void SphChecks::look_at_plane()
{
  if (domain->dimension != 2) return;
  double low = HUGE_VAL, high = -HUGE_VAL, h = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!settings.used(atom->type[i])) continue;
    low = std::min(low, atom->x[i][2]);
    high = std::max(high, atom->x[i][2]);
    h = std::max(h, settings.smoothing_length(atom->type[i]));
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
void SphChecks::look_at_idlers()
{
  const int theirs = groups_of(fixes_of(lmp, "sph")) | groups_of(fixes_of(lmp, "sph/stationary"));
  if (!roles.continuity || update->nsteps == 0) return;
  const auto idles = [&](int i) {
    return settings.used(atom->type[i]) && !roles.is_wall(i) && !roles.advances_density(i) && !(atom->mask[i] & theirs);
  };
  for (const auto *fix : integrators_of(lmp))
    if (const tagint moved = first_atom(lmp, [&](int i) { return idles(i) && (atom->mask[i] & fix->groupbit); }))
      voice.fail("atom " + std::to_string(moved) + " is moved by " + name_of(fix) +
                 ", which does not advance its density: water is moved by fix nve/sph, and a wall by fix wall/adami/sph");
  double idle = 0.0;
  tagint first = MAXTAGINT;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!idles(i)) continue;
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
void SphChecks::look_at_fluids()
{
  if (!roles.continuity || roles.continuity->volume) return;
  const FixSphPressure *light, *heavy;
  std::tie(light, heavy) = roles.least_and_most([](const FixSphPressure *fix) { return fix->state.rho0; });
  if (!light || heavy->state.rho0 <= 1.1 * light->state.rho0) return;
  voice.warn(std::string("fix ") + heavy->id + " has rho0 = " + text(heavy->state.rho0) + ", fix " +
             light->id + " has rho0 = " + text(light->state.rho0) +
             ": where these fluids meet, densities are wrong; use volume yes of fix "
             "sph/density/continuity");
}

/* Beyond these two limits a run grows from its first steps on, whatever the flow. Friction is explicit; with a law
 * of viscosity a fluid at rest has mumax, though fix check/timestep/sph sees the viscosities of the moment. */
void SphChecks::look_at_step()
{
  const bool newton = settings.is_newtonian();
  const sd_sph_friction form = settings.explicit_friction();
  double sound = HUGE_VAL, friction = HUGE_VAL;
  for (int i = 0; i < atom->nlocal; i++) {
    const int t = atom->type[i];
    if (!settings.used(t) || roles.is_wall(i) || !roles.state_of(i) || !(atom->rho[i] > 0.0)) continue;
    const double h = settings.smoothing_length(t);
    sound = std::min(sound, h / roles.speed_of_sound(i));
    if (form == SD_SPH_INVISCID) continue;
    const sd_sph_rheology fluid = settings.rheology(t);
    const double most = newton ? fluid.mu : sd_sph_largest_mu(&fluid);
    friction = std::min(friction, sd_sph_friction_limit(form, h, most, atom->rho[i]));
  }
  sound = smallest_of_all(world, sound);
  friction = smallest_of_all(world, friction);
  const std::string dt = text(update->dt), share = text(sd_sph_friction_share(form)), most = text(friction);
  if (update->dt > sound)
    voice.warn("the time step " + dt + " is longer than h/c = " + text(sound) +
               ", the time that sound takes over a smoothing length: the water may fly apart; take 0.2 to 0.4 of it");
  if (update->dt > friction && newton)
    voice.warn("keyword viscosity: the time step " + dt + " is longer than h^2 rho/(" + share + " mu) = " + most +
               ": friction may be unstable; use a smaller time step, or implicit yes");
  else if (update->dt > friction)
    voice.warn("keyword rheology: the time step " + dt + " is longer than h^2 rho/(" + share + " mumax) = " + most +
               ": friction may be unstable where the fluid is nearly at rest; use a smaller mumax (rho c h/" +
               (form == SD_SPH_CENTRAL ? "7" : "3") + " costs no time step), a smaller time step, or implicit yes");
}

/* Wall particles stand for fluid: they push with its mass. */
void SphChecks::look_at_walls()
{
  constexpr double NOBODY = -1e300;
  std::vector<double> likeness(rows.particles.n + 1, NOBODY);
  rows.pack_places();
  sd_sph_likeness(&rows.model, &rows.raw, &rows.particles, likeness.data());
  ghosts.reverse(likeness.data(), 1, true);
  tagint other_mass = MAXTAGINT;
  for (int i = 0; i < atom->nlocal; i++)
    if (roles.is_wall(i) && likeness[i] != NOBODY && likeness[i] < -log(1.1))
      other_mass = std::min(other_mass, atom->tag[i]);
  other_mass = smallest_of_all(world, other_mass);
  if (other_mass < MAXTAGINT)
    roles.wall->voice.warn(
        "the mass of atom " + std::to_string(other_mass) +
        " and the mass of the fluid particles in front of it differ by more than 10 %: wall "
        "particles need the mass and the spacing of the fluid; give a light or heavy body its "
        "true mass by fix rigid ... infile");
}

/* A lid is given by its velocity alone. Who has taken fix move from a wall and forgotten its velocity
 * has one as well. */
void SphChecks::tell_of_belts()
{
  double belts = 0.0;
  for (int i = 0; i < atom->nlocal; i++) belts += roles.is_wall(i) && roles.stands(i) && roles.has_velocity(i);
  belts = sum_of_all(world, belts);
  if (belts > 0.0)
    roles.wall->voice.tell(text(belts) + " particles of the wall have a velocity, and no fix moves them: they "
                           "stay where they are and rub as a lid or a belt does");
}

/* Under pressure the arrangement of particles holds bodies back (sd_sph_arrangement). A body that is nearly
 * as heavy as the water is then held where it is. After the first force, which has made the pressures. */
void SphChecks::look_at_bodies()
{
  if (rows.model.dimension != domain->dimension) return;
  for (Fix *fix : fixes_like(lmp, "^rigid")) {
    int dim;
    const auto *body = (const int *) fix->extract("body", dim);
    const auto *mass = (const double *) fix->extract("masstotal", dim);
    if (body && mass) look_at_bodies_of(fix, body, mass);
  }
}

void SphChecks::look_at_bodies_of(const Fix *rigid, const int *body, const double *mass)
{
  enum { VOLUME, OF_WATER, PRESSURE, WIDTH, NSUMS };
  const int bodies = rigid->size_array_rows, D = rows.model.dimension;
  const double reference = sd_sph_reference(&rows.model, roles.background());
  std::vector<double> mine((size_t) NSUMS * std::max(bodies, 0), 0.0), all(mine.size());
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & rigid->groupbit) || !roles.is_wall(i) || body[i] < 0 || body[i] >= bodies) continue;
    double *sums = &mine[(size_t) NSUMS * body[i]];
    const double V = Sph::mass(lmp, i) / roles.rest_density(i);
    sums[VOLUME] += V;
    sums[OF_WATER] += Sph::mass(lmp, i);
    sums[PRESSURE] += V * (rows.P[i] - reference);
    sums[WIDTH] += V * settings.smoothing_length(atom->type[i]) / pow(V, 1.0 / D);
  }
  MPI_Allreduce(mine.data(), all.data(), (int) all.size(), MPI_DOUBLE, MPI_SUM, world);
  const double *g = roles.wall->gravity.now(), fall = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  for (int k = 0; k < bodies; k++) {
    const double *sums = &all[(size_t) NSUMS * k], V = sums[VOLUME];
    const double weight = fabs(sums[OF_WATER] - mass[k]) * fall;
    if (!(V > 0.0 && fall > 0.0)) continue;
    const double pressure = sums[PRESSURE] / V, length = pow(V, 1.0 / D);
    const double resists = length * sd_sph_arrangement(&rows.model, sums[WIDTH] / V, 1.0, pressure, V);
    if (!(weight < resists)) continue;
    roles.wall->voice.warn("body " + std::to_string(k + 1) + " of fix " + rigid->id + " is moved by " + text(weight) +
                           ", its weight less that of the water; under the pressure " + text(pressure) +
                           " the arrangement of the particles resists with " + text(resists) +
                           " when it goes its own length: it will be too slow, or stay; use " +
                           (rows.model.scheme == SD_SPH_SHIFT_PLIANT ? "" : "shift pliant, or ") + "h = 3 dx");
    return;
  }
}

double SphChecks::growth_limit(int bits) const
{
  double mine = HUGE_VAL;
  for (int i = 0; i < atom->nlocal; i++) {
    const int t = atom->type[i];
    const FixSphPressure *eos = roles.state_of(i);
    if (!(atom->mask[i] & bits) || roles.is_wall(i) || !settings.used(t) || !eos || !(atom->rho[i] > 0.0)) continue;
    const double sound = sd_sph_speed_of_sound(&eos->state, atom->rho[i]);
    sd_sph_parameters p = settings.parameters(t, t);
    p.c = sound;
    if (!settings.is_newtonian()) p.mu = 0.0;
    mine = std::min(mine, sd_sph_growth_limit(&settings.model, &p, atom->rho[i]));
  }
  return smallest_of_all(world, mine);
}
