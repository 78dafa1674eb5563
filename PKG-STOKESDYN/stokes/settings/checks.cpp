#include "checks.h"

#include "engine.h"
#include "fixes.h"
#include "keywords.h"
#include "neighbours_stokes.h"
#include "ranks.h"
#include "settings.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "neighbor.h"
#include "pair.h"
#include "update.h"
#include "utils.h"

#include "sd_linear.h"
#include "sd_neighbor.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>

using namespace LAMMPS_NS;

namespace StokesDyn {

void check_room_of_blas(const Voice &voice)
{
  static bool there = false;    // of the process, as BLAS's memory is
  if (!there && sd_linear_room() != SD_OK)
    voice.fail_one("out of memory: linear algebra (BLAS) needs 0.14 GB of address space at once on "
                   "each rank; is there a limit (ulimit -v)? With precondition none and without "
                   "rigid_clumps and multiblob none is needed");
  there = true;
}

void warn_of_misfit(const Voice &voice, double misfit)
{
  if (misfit < 1e-9) return;
  voice.warn("keyword fluid_velocity: the formula does not have the period of the box, and spheres "
             "near its faces feel the jump; a shear flow needs a triclinic box that fix deform "
             "shears with it, and fluid_velocity box");
}

void warn_of_shared_films(const Voice &voice, double spheres)
{
  if (spheres <= 200.0 || voice.lmp->domain->xperiodic) return;
  voice.warn("keyword lubrication: with one point per sphere it slows down a cloud of " +
             text(spheres) + " close spheres that fall together: by 5 % at 200, by 26 % at 2000; "
             "use multiblob 12");
}

void warn_of_one_molecule(const Voice &voice, const Scene &scene)
{
  int64_t lowest = INT64_MAX, highest = INT64_MIN;
  for (int k = 0; k < scene.size(); k++) {
    lowest = std::min(lowest, scene.molecule(k));
    highest = std::max(highest, scene.molecule(k));
  }
  const MPI_Comm world = voice.lmp->world;
  lowest = smallest_of_all(world, lowest);
  highest = largest_of_all(world, highest);
  if (lowest == highest && lowest != 0 && sum_of_all(world, scene.size()) > 1)
    voice.warn("keyword lubrication: all spheres have the molecule ID " + std::to_string(lowest) +
               ", and there are no films within a molecule: give free spheres the molecule ID 0");
}

void refuse_close_oseen(const Voice &voice, const Scene &scene, const Engine &engine)
{
  const Comm *comm = voice.lmp->comm;
  const sd_law law = scene.settings.law();
  double mine;
  sd_status status;
  if (engine.view() == SD_VIEW_ALL) {
    const sd_spheres spheres = engine.cloud.spheres();
    const int64_t n = engine.cloud.size();
    const int from = n * comm->me / comm->nprocs, to = n * (comm->me + 1) / comm->nprocs;
    status = sd_oseen_coupling(&law, &spheres, nullptr, n, from, to - from, &mine);
  } else {
    const sd_spheres spheres = scene.local();
    const sd_pairs *pairs = scene.settings.clumps_only ? &engine.list() : nullptr;
    status = sd_oseen_coupling(&law, &spheres, pairs, scene.size_with_copies(), 0, scene.size(),
                               &mine);
  }
  if (status != SD_OK) voice.fail_one(sd_status_string(status));
  const double largest = largest_of_all(voice.lmp->world, mine);
  if (largest >= 1.0 - 1e-12)
    voice.at_step().fail("the mobility matrix is not positive definite with tensor oseen: two "
                         "spheres are too close for it, 1.5 sqrt(a_i a_j)/R" +
                         std::string(law.taper == SD_TAPER_NONE ?"" : " times the taper") +
                         " is " + text(largest) + " and must be below 1; use tensor rpy");
}

void warn_of_short_cutoff(const Voice &voice, const Scene &scene, const Engine &engine)
{
  struct Sight {
    tagint molecule;
    // of the clump, and how many others each of them sees, all added up
    bigint spheres, seen;
  };
  std::map<tagint, Sight> clumps;
  const auto add = [&](const Sight &part) {
    Sight &clump = clumps.insert({part.molecule, {part.molecule, 0, 0}}).first->second;
    clump.spheres += part.spheres;
    clump.seen += part.seen;
  };
  const sd_pairs &list = engine.list();
  for (int k = 0; k < scene.size(); k++)
    if (const tagint molecule = scene.molecule(k))
      add({molecule, 1, (bigint) (list.first[k + 1] - list.first[k])});
  std::vector<Sight> mine;
  for (const auto &clump : clumps) mine.push_back(clump.second);
  clumps.clear();
  for (const Sight &part : from_all(voice.lmp->world, mine)) add(part);

  for (const auto &clump : clumps) {
    const bigint n = clump.second.spheres, left_out = n * (n - 1) - clump.second.seen;
    if (left_out == 0) continue;
    voice.warn("cut_off_distance " + text(scene.settings.cutoff) + " is shorter than the clump of "
               "molecule " + std::to_string(clump.first) + ": " + std::to_string(left_out / 2) +
               " of its " + std::to_string(n * (n - 1) / 2) + " pairs do not see each other, so "
               "its drag is too large; clumps_only yes needs no cut_off_distance");
    return;
  }
}

// --- motion without inertia -----------------------------------------------------------------------

static void refuse_pair_settings(const Voice &voice, const StokesSettings &s)
{
  const std::string pair = " of pair_style stokes_dynamics ";
  if (s.add_force)
    voice.fail("keyword add_force" + pair + "must be no: velocities follow from the drag, which is "
               "not added as a force");
  if (s.update_every != 1)
    voice.fail("keyword update_every" + pair + "must be 1, not " + std::to_string(s.update_every) +
               ": velocities follow from the forces of every step");
  if (s.rigid.auto_resolve)
    voice.fail("keyword rigid_clumps" + pair + "must be yes or no, not auto: this fix keeps clumps "
               "rigid");
  if (std::isfinite(s.scene.cutoff) && s.scene.taper == SD_TAPER_NONE && !s.scene.clumps_only)
    voice.fail("keyword cut_off_distance: '" + text(s.scene.cutoff) + "'" + pair + "leaves out flows "
               "that spheres feel at any distance, and in a suspension velocities would be wrong many "
               "times over: use inf, or taper wendland with a length, or clumps_only yes");
  if (s.rigid.on && !s.scene.rotation)
    voice.fail("keyword rigid_clumps" + pair + "requires rotation yes or a shell: without torques "
               "nothing resists the spin of a straight clump");
}

void refuse_inertia(const Voice &voice, const StokesSettings &settings)
{
  LAMMPS *lmp = voice.lmp;
  if (lmp->update->whichflag == 2)
    voice.fail("minimize cannot be used with it: motion without inertia has no minimiser");
  if (utils::strmatch(lmp->update->integrate_style, "^respa"))
    fail(lmp, voice.command + " does not support run_style respa");
  refuse_pair_settings(voice, settings);
  for (const Fix *fix : fixes_of(lmp, "stokes_dynamics"))
    voice.fail(name_of(fix) + " cannot apply or report a force in this run (apply yes or no): use the "
               "output of this fix");
}

/* Of the contacts whose stiffness is known, the longest step; INFINITY: there are none */
static double limit_of(const Contact &contact, double limit, double softer)
{
  const bool linear = !contact.style.empty() && !utils::strmatch(contact.style, "hertz");
  const double along = linear && contact.k > 0.0 ? limit * softer / contact.k : INFINITY;
  const bool rubs = linear && contact.friction > 0.0 && contact.across > 0.0;
  return rubs ? std::min(along, limit / contact.across) : along;
}

void announce_step_limit(const Voice &voice, bool euler, double smallest_drag, double film_gap)
{
  LAMMPS *lmp = voice.lmp;
  Force *force = lmp->force;
  const double part = euler ? 0.78 : 0.39, limit = part * smallest_drag;
  const double softer = film_gap > 0.0 ? std::max(1.0, 0.64 / film_gap) : 1.0;
  const Contact contact = contact_of(lmp);
  const bool walls = fix_like(lmp, "^wall/gran");
  const bool others = strcmp(force->pair_style, "stokes_dynamics") != 0 || force->bond || walls;
  if (!others) return;
  voice.tell("contacts and bonds of stiffness k allow time steps up to " + text(part) +
             " 6 pi eta a / k = " + text(limit) + " / k" +
             (film_gap > 0.0 ? ", springs between surfaces that touch, with films between them, up to " +
                               text(limit * softer) + " / k" : ""));
  const double longest = limit_of(contact, limit, softer);
  if (lmp->update->dt > longest)
    voice.warn("time step " + text(lmp->update->dt) + " is above " + text(longest) +
               ", the longest that pair_style " + contact.style + " with k " + text(contact.k) +
               " allows in dense packings");
}

// --- ghosts and bins of LAMMPS -------------------------------------------------------------------

void refuse_wide_skin(const Voice &voice, double range, double diameter)
{
  const Domain *domain = voice.lmp->domain;
  const double skin = voice.lmp->neighbor->skin;
  double images = 1.0;
  for (int d = 0; d < 3; d++)
    if (domain->periodicity[d]) images *= 1.0 + 2.0 * (range + skin) / domain->prd[d];
  if (images > 1e3 && images * (double) voice.lmp->atom->natoms > 1e6)
    voice.fail("the skin " + text(skin) + " of LAMMPS's command neighbor makes more than 1000 ghosts of each sphere "
               "and 1e6 in all in this periodic box: give a smaller one, such as neighbor " +
               text(0.1 * diameter) + " bin");
}

void SortingBins::limit(double range)
{
  const double wide = (range + neighbor->skin) / 2.0;
  const double volume = domain->xprd * domain->yprd * domain->zprd;
  if (atom->sortfreq > 0 && atom->userbinsize == 0.0 && atom->natoms > 0 &&
      volume > wide * wide * wide * std::max(1e6, 10.0 * atom->natoms))
    atom->userbinsize = ours = cbrt(volume / atom->natoms);
}

/* Whoever has set another since then keeps it. */
SortingBins::~SortingBins()
{
  if (ours > 0.0 && atom->userbinsize == ours) atom->userbinsize = 0.0;
}

}    // namespace StokesDyn
