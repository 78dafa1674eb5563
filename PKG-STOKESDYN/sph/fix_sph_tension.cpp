#include "fix_sph_tension.h"

#include "fix_wall_sph.h"
#include "fixes.h"
#include "keywords.h"
#include "pair_sph_artvisc_tenscorr.h"
#include "ranks.h"
#include "sd_constants.h"
#include "sd_sph_deep.h"
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

FixSphTension::FixSphTension(LAMMPS *lmp, int narg, char **arg) : SphFix(lmp, narg, arg), shown(5), drops(lmp)
{
  Keywords in = keywords(narg, arg);
  sigma = in.positional("SIGMA").positive();
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
  size_vector = 5;
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
    in.check(!contacts.count(type), "has an angle already");
    const double angle = in.number();
    in.check(angle > 0.0 && angle < 180.0, "is no contact angle: it is above 0 and below 180 degrees");
    contacts[type] = {cos(angle * SD_PI / 180.0), sin(angle * SD_PI / 180.0)};
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
  walls = !fixes_of(lmp, FixWallAdamiSph::STYLE).empty();
  check_particles();
  check_contacts();
}

/* All fluid is in the group, and has one h and one rho0. */
void FixSphTension::check_particles()
{
  if (const tagint other = first_atom(lmp, [this](int i) {
        return pair->is_particle(i) && !pair->is_of_wall(i) && !(atom->mask[i] & groupbit);
      }))
    voice.fail("atom " + std::to_string(other) +
               " is fluid and not in its group: the surface of a part of the fluid would run through its inside; use "
               "the group of all fluid");
  const double h = pair->one_smoothing_length(voice);
  double V = 0.0, least_rho = HUGE_VAL, most_rho = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!pair->is_particle(i) || pair->is_of_wall(i)) continue;
    const double rho = pair->rest_density(i);
    least_rho = std::min(least_rho, rho);
    most_rho = std::max(most_rho, rho);
    V = std::max(V, Sph::mass(lmp, i) / rho);
  }
  rho0 = smallest_of_all(world, least_rho);
  most_rho = largest_of_all(world, most_rho);
  if (most_rho == 0.0) voice.fail("there is no fluid of pair_style sph/artVisc/tensCorr");
  if (most_rho > rho0 * (1.0 + 1e-9))
    voice.fail("fluids have densities from " + text(rho0) + " to " + text(most_rho) +
               ": it is made for one fluid with a free surface; use one fix sph/pressure with a rho0");
  spacing = pow(largest_of_all(world, V), 1.0 / pair->dimension());
  sd_sph_surface_make(pair->kernel(), pair->dimension(), h, &surface);
}

void FixSphTension::check_contacts()
{
  for (const auto &contact : contacts) {
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
    if (!pair->is_particle(i) || pair->is_of_wall(i)) continue;
    mu = std::min(mu, pair->all_viscosity(i));
    sound = std::min(sound, pair->speed_of_sound(i));
  }
  mu = smallest_of_all(world, mu);
  sound = smallest_of_all(world, sound);
  const double h = surface.h, R = 0.5 * ACROSS * spacing, oh = sd_sph_ohnesorge(mu, sigma, rho0, R),
               dt = sd_sph_capillary_step(sigma, rho0, h), stiff = sound * sound * rho0 * h / sigma;
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
  look_at_particles();
  find_normals();
  find_curvatures();
  find_forces();
  add_forces();
  show();
}

void FixSphTension::look_at_particles()
{
  const int n = atom->nlocal + atom->nghost, nlocal = atom->nlocal;
  list = pair->neighbours_of_each();
  film = {&surface, &list, n, nullptr, nullptr, nullptr, nullptr, 0};
  x4.resize(4 * (size_t) (n + 1));
  sd_sph_pack_x(n, n ? atom->x[0] : nullptr, nullptr, nullptr, 0.0, x4.data());
  mass.resize(nlocal + 1);
  x4[4 * (size_t) n + 3] = 0.0;
  inside.resize(n + 1);
  for (int i = 0; i < n; i++) {
    inside[i] = pair->is_whole(i);
    const double m = pair->is_particle(i) ? Sph::mass(lmp, i) : 0.0;
    x4[4 * (size_t) i + 3] = m / rho0;
    if (i < nlocal) mass[i] = m;
  }
  film.x4 = x4.data();
  film.inside = inside.data();
  find_near();
  if (!walls) return;
  wall.assign(n + 1, 0);
  for (int i = 0; i < n; i++) wall[i] = pair->is_of_wall(i);
  film.wall = wall.data();
}

void FixSphTension::make_rows()
{
  const size_t nlocal = atom->nlocal, n = (size_t) film.all;
  sums.resize(8 * nlocal + 4);
  whole.resize(4 * nlocal + 4);
  at_surface.assign(4 * (n + 1), 0.0);
  turns.resize(SD_SPH_SKIN_SUMS * nlocal + 4);
  rows = {sums.data(), nullptr, whole.data(), at_surface.data(), nullptr, turns.data()};
  if (!walls) return;
  beside.resize(8 * nlocal + 4);
  at_wall.resize(8 * nlocal + 4);
  rows.beside = beside.data();
  rows.at_wall = at_wall.data();
}

/* Where the surface may be: in supports that are cut, and beside walls. */
void FixSphTension::find_near()
{
  marked.resize(film.all);
  for (int i = 0; i < film.all; i++) marked[i] = !inside[i] && x4[4 * (size_t) i + 3] > 0.0;
  near.resize(atom->nlocal + 1);
  cells.resize(SD_SPH_DEEP_CELLS(film.all));
  film.count = sd_sph_find_near(film.all, atom->nlocal, x4.data(), marked.data(), 2.0 * surface.h, cells.data(),
                                near.data());
  film.near = near.data();
}

void FixSphTension::find_normals()
{
  const size_t n = (size_t) film.all;
  make_rows();
  sd_sph_film_sums(&film, &rows);
  if (walls) {
    if (update->setupflag) look_at_walls();
    one.assign(n + 1, 0.0);
    sd_sph_film_wetness(&film, &rows, one.data());
    forward(one.data(), 1);
    contact.assign(4 * (n + 1), 0.0);
    for (size_t i = 0; i < n; i++) {
      if (!wall[i]) continue;
      const auto found = contacts.find(atom->type[i]);
      const std::pair<double, double> angle = found == contacts.end() ? std::make_pair(0.0, 1.0) : found->second;
      const double row[4] = {one[i], angle.first, angle.second, 1.0};
      std::copy_n(row, 4, &contact[4 * i]);
    }
    sd_sph_film_wet_walls(&film, contact.data(), &rows);
  }
  sd_sph_film_normals(&film, &rows);
  forward(at_surface.data(), 4);
}

/* The wetness of a wall particle needs its neighbours in the wall, which inputs often exclude. */
void FixSphTension::look_at_walls() const
{
  for (int k = 0; k < film.count; k++) {
    const int i = near[k];
    const double *row = &sums[8 * (size_t) i], own = x4[4 * (size_t) i + 3] *
        sd_sph_W(surface.kernel, surface.dimension, 0.0, surface.h);
    if (wall[i] && row[0] > 0.0 && row[4] < 1.001 * own)
      voice.fail_one("wall particle " + std::to_string(atom->tag[i]) +
                     " sees fluid and no other wall particle: how wet it is goes by both, so walls need two rows or "
                     "more, and no neigh_modify exclude between their particles");
  }
}

/* k of particles of this rank, and of their ghosts */
const double *FixSphTension::spread(const std::vector<double> &k)
{
  one.assign((size_t) film.all + 1, 0.0);
  std::copy_n(k.data(), atom->nlocal, one.data());
  forward(one.data(), 1);
  return one.data();
}

/* Friction sees the velocities of the time of the force. */
void FixSphTension::find_curvatures()
{
  const size_t nlocal = atom->nlocal, n = (size_t) film.all, entries = sd_sph_skin_size(&film, &rows);
  v4.resize(4 * (n + 1));
  sd_sph_pack_v(film.all, n ? atom->vest[0] : nullptr, atom->rho, v4.data());
  first.resize(nlocal + 1);
  if (skin.size() < entries) {
    skin.resize(entries + entries / 8);
    weights.resize(entries + entries / 8);
  }
  for (auto *each : {&kappa, &once, &twice}) each->resize(nlocal + 1);
  shows.resize(n + 1);
  const sd_sph_skin pairs = {first.data(), shows.data(), skin.data(), weights.data()};
  sd_sph_film_curvatures(&film, &rows, v4.data(), &pairs, kappa.data());
  sd_sph_film_means(&film, &rows, &pairs, spread(kappa), once.data());
  sd_sph_film_means(&film, &rows, &pairs, spread(once), twice.data());
  sd_sph_film_sharpen(&film, &rows, kappa.data(), once.data(), twice.data(), once.data());
  sd_sph_film_inwards(&film, &rows, &pairs, spread(once), kappa.data());
}

void FixSphTension::find_forces()
{
  F.resize(3 * (size_t) atom->nlocal + 1);
  const sd_sph_tension how = {sigma, sd_sph_surface_friction(sigma, rho0, surface.h)};
  area.resize(atom->nlocal + 1);
  sd_sph_tension_forces(&film, &how, &rows, kappa.data(), F.data(), area.data());
  if (!walls) return;
  one.resize(atom->nlocal + 1);
  for (int i = 0; i < atom->nlocal; i++)
    one[i] = pair->is_particle(i) && !pair->is_of_wall(i) ? pair->pressure(i) : 0.0;
  sd_sph_dry_walls(&film, sigma, &rows, kappa.data(), one.data(), F.data());
}

/* Of drops that touch no wall and no open end the momentum stays. */
void FixSphTension::add_forces()
{
  const int nlocal = atom->nlocal;
  held.assign(nlocal + 1, 0.0);
  for (int i = 0; i < nlocal && pair->has_ends(); i++) held[i] = pair->is_held(i) ? 1.0 : 0.0;
  for (int k = 0; k < film.count && walls; k++)
    if (sums[8 * (size_t) near[k] + 4] > 0.0) held[near[k]] = 1.0;
  drops.keep_momentum(film, mass.data(), held.data(), [this](double *name) { forward(name, 1); }, F.data());
  for (int i = 0; i < nlocal; i++)
    for (int d = 0; d < 3; d++) atom->f[i][d] += F[3 * (size_t) i + d];
}

void FixSphTension::show()
{
  for (int i = 0; i < atom->nlocal; i++) {
    const double *n = &at_surface[4 * (size_t) i];
    double *row = shown.writable(i);
    row[0] = kappa[i];
    row[1] = std::max(n[3], 0.0);
    std::copy_n(n, 3, row + 2);
  }
}

double FixSphTension::whole_area() const
{
  const sd_sph_members everybody = {std::min(atom->nlocal, (int) area.size()), atom->mask, 0, nullptr, nullptr};
  return sum_of_all(world, sd_sph_sum(&everybody, area.data()));
}

double FixSphTension::compute_scalar()
{
  return sigma * whole_area();
}

double FixSphTension::compute_vector(int k)
{
  return k < 3 ? drops.force_on_held(k) : k == 3 ? (double) drops.number() : whole_area();
}

double FixSphTension::memory_usage()
{
  double bytes = SphFix::memory_usage();
  for (const auto *each : {&x4, &v4, &at_surface, &contact, &whole, &at_wall, &sums, &beside, &turns})
    bytes += (double) each->capacity() * sizeof(double);
  return bytes + (double) skin.capacity() * (sizeof(int) + sizeof(double));    // and its weights
}
