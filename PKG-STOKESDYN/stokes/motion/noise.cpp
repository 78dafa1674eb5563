#include "noise.h"

#include "callback.h"
#include "checks.h"
#include "hydrodynamics.h"
#include "keywords.h"

#include "sd_clump_noise.h"

#include "atom.h"
#include "domain.h"
#include "force.h"
#include "neighbor.h"
#include "universe.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

void Noise::read_temperature(Keywords &in)
{
  temperature = Field::parse(in.value("T"), Field::ONE_FOR_ALL);
  in.check(temperature.number() >= 0.0, "must be >= 0");
  seed = (uint32_t) in.value("seed").integer(1);
}

void Noise::read_tolerance(Keywords &in)
{
  tolerance = in.positive();
  in.check(tolerance < 0.5, "must be below 0.5");
}

double Noise::scale(double dt) const
{
  return sqrt(2.0 * kT * dt);
}

sd_random_key Noise::key(sd_random_purpose what) const
{
  return {seed, what, (uint64_t) update->ntimestep};
}

void Noise::find_temperature(const Hydrodynamics &hydro)
{
  if (temperature.is_variable()) modify->clearstep_compute();
  const double T = temperature.evaluate(lmp);
  if (temperature.is_variable()) modify->addstep_compute(update->ntimestep + 1);
  if (!(T >= 0.0) || std::isinf(T))
    voice.fail("keyword temperature: '" + text(T) + "' must be >= 0, in step " +
               std::to_string(update->ntimestep));
  kT = force->boltz * T;
  last = {};
  of_clumps.assign(6 * hydro.poses().clumps().size() + 6, 0.0);
}

void Noise::draw(Hydrodynamics &hydro, size_t width, const ToAtom &take)
{
  find_temperature(hydro);
  if (hydro.settings.rigid.each_alone())
    draw_alone(hydro, width, take);
  else
    draw_together(hydro, width, take);
}

/* Nobody sees anybody: each sphere by its drag, each clump by the root of its own mobility. */
void Noise::draw_alone(const Hydrodynamics &hydro, size_t width, const ToAtom &take)
{
  const ClumpPoses &poses = hydro.poses();
  const WholeClumps &whole = hydro.scene.whole;
  double normals[6], move[6];
  for (int i : poses.lone()) {
    const sd_random_key of_sphere = key(SD_RANDOM_SPHERE);
    sd_random_normals(&of_sphere, atom->tag[i], (int) width, normals);
    for (size_t d = 0; d < width; d++)
      move[d] = normals[d] / sqrt(hydro.ambient.resistance(i, d));
    take(i, move);
  }
  const sd_random_key of_body = key(SD_RANDOM_BODY);
  for (size_t c = 0; c < poses.clumps().size(); c++) {
    const ClumpPoses::Clump &clump = poses.clumps()[c];
    int64_t lowest = whole.tag[poses.member_of(clump, 0)];
    for (int k = 1; k < poses.own_clump(clump).n; k++)
      lowest = std::min(lowest, (int64_t) whole.tag[poses.member_of(clump, k)]);
    sd_random_normals(&of_body, lowest, 6, normals);
    sd_clump_noise_draw(&poses.shape(clump).noise, clump.pose, clump.eta, normals,
                        &of_clumps[6 * c]);
  }
}

/* The rows with their numbers w and drags D, and the matrix: whole */
sd_noise_spheres Noise::find_spheres(Hydrodynamics &hydro, size_t width)
{
  const Scene &scene = hydro.scene;
  const size_t n = scene.size();
  D = scene.rows((int) width, [&hydro, width](int i, double *out) {
    for (size_t d = 0; d < width; d++) out[d] = hydro.ambient.resistance(i, d);
  });
  for (auto *rows : {&w, &y}) rows->resize(width * (n + 1));
  const sd_random_key of_sphere = key(SD_RANDOM_SPHERE);
  for (size_t k = 0; k < n; k++)
    sd_random_normals(&of_sphere, scene.tag(k), (int) width, &w[width * k]);
  const size_t engine_width = scene.width();
  for (auto *rows : {&engine_F, &engine_u}) rows->assign(engine_width * (n + 1), 0.0);
  return {n, width, engine_width, D.data(), hydro.engine.anybody_sees() ? sd_mobility_apply : nullptr,
          hydro.engine.mobility(),
          engine_F.data(), engine_u.data()};
}

void Noise::no_root(sd_status status) const
{
  fail_by(voice, status, "keyword temperature: the root of the mobility, for the noise, was not "
                         "found in step " + std::to_string(update->ntimestep) + " (" +
                         std::to_string(last.products) + " products, error " + text(last.error) +
                         ", noise_tolerance " + text(tolerance) + "): " + sd_status_string(status));
}

void Noise::draw_together(Hydrodynamics &hydro, size_t width, const ToAtom &take)
{
  sd_mobility *engine = hydro.engine.mobility();
  sd_noise_spheres spheres = find_spheres(hydro, width);
  divided = spheres.apply && sd_mobility_divides(engine);
  if (divided) spheres.apply = sd_mobility_apply_rest;
  sd_noise_matrix M = {};
  M.n = (long) (width * spheres.n);
  M.apply = sd_noise_spheres_apply;
  M.ctx = &spheres;
  M.D = D.data();
  M.world = hydro.engine.ranks();
  sd_status status = sd_noise_velocities(&process, &M, w.data(), tolerance / 3.0, y.data(), &last);
  const sd_random_key of_waves = key(SD_RANDOM_GRID);
  if (status == SD_OK && divided) status = sd_mobility_draw(engine, &of_waves, engine_u.data());
  if (status != SD_OK) no_root(status);
  if (divided) sd_noise_spheres_add(&spheres, engine_u.data(), y.data());
  hydro.scene.to_atoms((int) width, y.data(), take);
}

SolveNoise::Draw Noise::how_to_draw(const Hydrodynamics &hydro)
{
  find_temperature(hydro);
  const auto told = [this](sd_status status, const sd_noise_report &report, bool in_parts) {
    last = report;
    divided = in_parts;
    if (status != SD_OK) no_root(status);
  };
  const auto not_positive = [this] {
    if (!told_of_whole)
      voice.at_step().warn("keyword temperature: the near part of the periodic sum has a negative mode; here the "
                           "noise is made with the whole matrix, which takes more products");
    told_of_whole = true;
  };
  return {&of_bodies,
          key(SD_RANDOM_SPHERE),
          key(SD_RANDOM_FILM),
          key(SD_RANDOM_GRID),
          key(SD_RANDOM_DIFFERENCE),
          tolerance / 3.0,
          scale(1.0 / update->dt),
          kT,
          told,
          not_positive};
}

void Noise::announce(const Hydrodynamics &hydro, double smallest, double drag) const
{
  const double step = drag > 0.0 ? scale(update->dt) / sqrt(drag) : 0.0;
  const double radii = step / smallest;
  const double skins = neighbor->skin > 0.0 ? step / (0.5 * neighbor->skin) : 0.0;
  const std::string of_skin = skins > 0.0 ? ", " + text(skins) + " of half the skin" : "";
  const std::string root = hydro.settings.rigid.each_alone()
      ? "the own one of each clump"
      : (divided ? "waves at once, near part by Lanczos's process, " : "Lanczos's process, ") +
          std::to_string(last.products) + " products, error " + text(last.error);
  voice.tell("Brownian motion, kT = " + text(kT) + ", seed " + std::to_string(seed) +
             "; root of the mobility by " + root + "; a step moves the smallest sphere by " +
             text(radii) + " of its radius" + of_skin + "; " +
             (midpoint ? "v holds the noise of a step" : "v has no noise") +
             ", and temperatures and pressures from v mean nothing" +
             (universe->nworlds > 1 ? "; partitions with one seed draw the same numbers" : ""));
  if (radii > 0.1)
    voice.warn("keyword temperature: a step moves the smallest sphere by " + text(radii) +
               " of its radius: use a shorter time step");
  if (skins > 1.0)
    voice.warn("keyword temperature: a step moves spheres by " + text(skins) + " of half the skin, "
               "so that lists are made anew in every step: use a shorter time step or a larger "
               "skin");
}

void Noise::begin(double last_step)
{
  if (std::isnan(drawn)) drawn = last_step;
}

void Noise::warn_of_repeats()
{
  const double before = drawn, step = (double) update->ntimestep;
  drawn = std::max(before, step);
  if (told_of_repeats || step > before) return;
  told_of_repeats = true;
  voice.at_step().warn("keyword temperature: noise of steps up to " + text(before) + " was drawn with this seed "
                       "before reset_timestep, and the same random numbers come again: give the fix anew with "
                       "another seed");
}

// --- what has a drift that the schemes leave out, or noise of its own or none ---------------------

static const std::string PAIR = " of pair_style stokes_dynamics";

/* Does the viscosity differ from place to place? */
static bool varies(const Ambient::Settings &fluid)
{
  return fluid.visc.is_atom_style() || fluid.grid_has_visc;
}

std::string Noise::drift(const Hydrodynamics &hydro, const std::string &holds) const
{
  const StokesSettings &s = hydro.settings;
  const Ambient::Settings &fluid = hydro.ambient.settings;
  if (domain->dimension == 2) return "dimension 2, which holds a coordinate";
  if (s.rigid.each_alone()) return "";
  if (s.shells.on()) return "keyword multiblob" + PAIR;
  if (s.lubrication.on) return "keyword lubrication" + PAIR;
  if (s.rigid.on) return "keyword rigid_clumps" + PAIR + " with clumps that feel each other";
  if (s.scene.boundary.walled()) return "keyword wall" + PAIR;
  if (varies(fluid)) return "keyword visc" + PAIR + ", which varies in space";
  return holds;
}

/* A mobility that has no root, or a drift that no scheme has */
static void refuse_settings(const Voice &keyword, const StokesSettings &s,
                            const Ambient::Settings &fluid)
{
  if (s.rigid.each_alone() && keyword.lmp->domain->dimension == 2)
    keyword.fail("keyword clumps_only" + PAIR + ": lone clumps in a plane have a drift: use "
                 "clumps_only no");
  if (s.rigid.each_alone() && varies(fluid))
    keyword.fail("keyword clumps_only" + PAIR + ": lone clumps in a viscosity that varies in space "
                 "have a drift: use clumps_only no, or a number for visc");
  if (s.scene.tensor == SD_TENSOR_OSEEN)
    keyword.fail("keyword tensor: 'oseen'" + PAIR + " may have negative mobilities, for which "
                 "there is no noise: use tensor rpy");
  if (s.scene.taper != SD_TAPER_NONE)
    keyword.fail("keyword taper" + PAIR + ": the mobility has a drift, which schemes leave out: "
                 "use cut_off_distance inf");
  if (std::isfinite(s.scene.cutoff) && !s.rigid.each_alone())
    keyword.fail("keyword cut_off_distance: '" + text(s.scene.cutoff) + "'" + PAIR +
                 ": the mobility has a drift, which schemes leave out: use inf");
}

void Noise::refuse(const Hydrodynamics &hydro, const Ways &ways) const
{
  const Voice keyword = voice.of("keyword temperature");
  refuse_settings(keyword, hydro.settings, hydro.ambient.settings);
  const std::string what = drift(hydro, ways.holds);
  if (!what.empty() && !ways.midpoint)
    keyword.fail(what + ": the mobility has a drift, which schemes ab2 and euler leave out: use "
                 "scheme midpoint");
  if (!atom->tag_enable)
    keyword.fail("the noise of an atom depends on its ID, and there are no IDs: atom_modify id "
                 "yes");
  if (update->dt < 0.0)
    keyword.fail("the time step " + text(update->dt) + " is negative, and displacements of Brownian motion grow with "
                 "its root: give a positive one (command timestep)");
  if (ways.adapts)
    keyword.fail("averages over steps of unequal length are not averages over time: leave out "
                 "adapt");
}

void Noise::init(Hydrodynamics &hydro, const Ways &ways)
{
  check_room_of_blas(voice);
  temperature.init(lmp);
  refuse(hydro, ways);
  midpoint = ways.midpoint;
  const bool addition = hydro.settings.shells.on() && hydro.settings.shells.one_body;
  hydro.engine.far_field.positive = addition ? SD_EWALD_POSITIVE_ADDITION : SD_EWALD_POSITIVE;
  told_of_whole = false;
}

}    // namespace StokesDyn
