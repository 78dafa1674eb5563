#include "fix_sph_tension.h"

#include "fix_wall_sph.h"
#include "fixes.h"
#include "keywords.h"
#include "pair_sph_artvisc_tenscorr.h"
#include "ranks.h"
#include "sd_constants.h"
#include "sd_sph_energy.h"

#include "atom.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

/* What the tests of oscillating drops have shown to hold: doc/fix_sph_tension.md. */
static constexpr double LEAST_OHNESORGE = 0.01, LEAST_STIFFNESS = 12.0;
static constexpr int ACROSS = 20;    // particles over the smallest drop that is resolved

FixSphTension::FixSphTension(LAMMPS *lmp, int narg, char **arg) :
    SphFix(lmp, narg, arg), shown(FreeSurface::SHOWN), film(voice, how, shown, *this)
{
  Keywords in = keywords(narg, arg);
  how.sigma = in.positional("SIGMA").positive();
  in.parse({
      {"contact",
       [&] {
         parse_contact(in);
       }},
      {"force",
       [&] {
         forced = in.yes_no();
       }},
  });
  keep({&shown}, &shown, false);
  peratom_freq = 1;
  scalar_flag = vector_flag = 1;
  size_vector = 5;    // force on drops that are held, their number, the area
  global_freq = 1;
  extscalar = extvector = 0;
  comm_forward = 4;
}

/* Pairs of a type and its angle in degrees. */
void FixSphTension::parse_contact(Keywords &in)
{
  double number;
  do {
    const int type = (int) in.integer(1, atom->ntypes);
    in.check(!how.contacts.count(type), "has an angle already");
    const double angle = in.number();
    in.check(angle > 0.0 && angle < 180.0, "is no contact angle: it is above 0 and below 180 degrees");
    how.contacts[type] = {cos(angle * SD_PI / 180.0), sin(angle * SD_PI / 180.0)};
  } while (in.more() && is_number(in.peek(), number));
}

int FixSphTension::setmask()
{
  return FixConst::POST_FORCE;
}

// --- at the beginning of a run -------------------------------------------------------------------

void FixSphTension::init()
{
  pair = PairSph::of(voice);
  is_set_up = false;
  if (fixes_of(lmp, STYLE).size() > 1)
    voice.fail("more than one: there is one fluid, with one surface tension");
  if (!pair->finds_surface())
    voice.fail("needs shift yes of pair_style sph/artVisc/tensCorr: without it particles are not spread evenly "
               "enough to tell a curvature, and correction yes knows no free surface");
  if (pair->has_fluids())
    voice.fail("does not go with volume yes of fix sph/density/continuity: it is made for one fluid with a free "
               "surface, and two fluids have none between them; grains (fix sph/grains) need volume yes");
  how.walls = !fixes_of(lmp, FixWallAdamiSph::STYLE).empty();
  check_particles();
  check_contacts();
}

bool FixSphTension::is_fluid(int i) const
{
  return pair->is_particle(i) && !pair->is_of_wall(i);
}

/* All fluid is in the group, and has one h and one rho0. */
void FixSphTension::check_particles()
{
  if (const tagint other = first_atom(lmp, [this](int i) { return is_fluid(i) && !(atom->mask[i] & groupbit); }))
    voice.fail("atom " + std::to_string(other) +
               " is fluid and not in its group: the surface of a part of the fluid would run through its inside; use "
               "the group of all fluid");
  const double h = pair->one_smoothing_length(voice);
  double V = 0.0, least_rho = HUGE_VAL, most_rho = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!is_fluid(i)) continue;
    const double rho = pair->rest_density(i);
    least_rho = std::min(least_rho, rho);
    most_rho = std::max(most_rho, rho);
    V = std::max(V, Sph::mass(lmp, i) / rho);
  }
  how.rho0 = smallest_of_all(world, least_rho);
  most_rho = largest_of_all(world, most_rho);
  if (most_rho == 0.0) voice.fail("there is no fluid of pair_style sph/artVisc/tensCorr");
  if (most_rho > how.rho0 * (1.0 + 1e-9))
    voice.fail("fluids have densities from " + text(how.rho0) + " to " + text(most_rho) +
               ": it is made for one fluid with a free surface; use one fix sph/pressure with a rho0");
  spacing = pow(largest_of_all(world, V), 1.0 / pair->dimension());
  sd_sph_surface_make(pair->kernel(), pair->dimension(), h, &how.surface);
}

void FixSphTension::check_contacts()
{
  for (const auto &contact : how.contacts) {
    const int type = contact.first;
    if (first_atom(lmp, [this, type](int i) { return atom->type[i] == type && pair->is_of_wall(i); })) continue;
    voice.fail("keyword contact: there is no particle of type " + std::to_string(type) +
               " in a wall: contact angles belong to types of wall particles (fix wall/adami/sph)");
  }
}

/* Before the first force of a run, when the speed of sound and the viscosity are known. What does not hold is an
 * error, with force yes a warning. */
void FixSphTension::check_range()
{
  double mu = HUGE_VAL, sound = HUGE_VAL;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!is_fluid(i)) continue;
    mu = std::min(mu, pair->all_viscosity(i));
    sound = std::min(sound, pair->speed_of_sound(i));
  }
  mu = smallest_of_all(world, mu);
  sound = smallest_of_all(world, sound);
  const double h = how.surface.h, sigma = how.sigma, rho0 = how.rho0, R = 0.5 * ACROSS * spacing,
               oh = sd_sph_ohnesorge(mu, sigma, rho0, R), dt = sd_sph_capillary_step(sigma, rho0, h),
               stiff = sound * sound * rho0 * h / sigma;
  const std::string line = "the smallest drop that is resolved, " + std::to_string(ACROSS) +
      " particles across, of radius " + text(R) + ", has the Ohnesorge number " + text(oh) +
      "; waves on the surface allow time steps up to " + text(dt) + "; c^2 = " + text(stiff) + " sigma/(rho h)";
  if (told.insert(line).second) voice.tell(line);
  const std::string way_out = " (force yes makes this a warning)";
  const auto objects = [&](bool holds, const std::string &why) {
    if (holds) return;
    if (!forced) voice.fail(why + way_out);
    if (told.insert(why).second) voice.warn(why);
  };
  objects(oh >= LEAST_OHNESORGE * (1.0 - 1e-9),
          "the Ohnesorge number " + text(oh) + " of the smallest drop that is resolved is below " +
              text(LEAST_OHNESORGE) + ", the range in which drops have been shown to ring down as they should: use a "
              "viscosity of at least " + text(mu * LEAST_OHNESORGE / std::max(oh, 1e-300)) + ", or larger particles");
  objects(update->whichflag != 1 || update->nsteps == 0 || update->dt <= dt * (1.0 + 1e-9),
          "the time step " + text(update->dt) + " is above " + text(dt) +
              ", 0.25 sqrt(rho h^3/(2 pi sigma)): the shortest waves on the surface would grow; use a smaller one");
  objects(stiff >= LEAST_STIFFNESS * (1.0 - 1e-9),
          "c^2 = " + text(stiff) + " sigma/(rho h) is below " + text(LEAST_STIFFNESS) +
              " sigma/(rho h): surface tension would compress the fluid; use a speed of sound of at least " +
              text(sound * sqrt(LEAST_STIFFNESS / stiff)));
}

// --- a step --------------------------------------------------------------------------------------

/* Once, whoever asks first: compute sph/energy needs the force that the first step begins with. */
void FixSphTension::setup(int vflag)
{
  if (!is_set_up) post_force(vflag);
  is_set_up = true;
}

void FixSphTension::post_force(int /*vflag*/)
{
  if (update->setupflag) check_range();
  film.pull(pair);
}

double FixSphTension::whole_area() const
{
  const std::vector<double> &area = film.areas();
  const sd_sph_members everybody = {std::min(atom->nlocal, (int) area.size()), atom->mask, 0, nullptr, nullptr};
  return sum_of_all(world, sd_sph_sum(&everybody, area.data()));
}

double FixSphTension::compute_scalar()
{
  return how.sigma * whole_area();
}

double FixSphTension::compute_vector(int k)
{
  return k < 3 ? film.bodies().force_on_held(k) : k == 3 ? (double) film.bodies().number() : whole_area();
}

double FixSphTension::memory_usage()
{
  return SphFix::memory_usage() + film.bytes();
}
