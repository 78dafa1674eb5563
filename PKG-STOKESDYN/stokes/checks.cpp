#include "checks.h"

#include "fixes.h"
#include "hydrodynamics.h"
#include "keywords.h"
#include "neighbours_stokes.h"
#include "ranks.h"

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
#include <cstdio>
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

void check_boundaries(const Voice &voice, const Scene::Settings &settings)
{
  const Domain *domain = voice.lmp->domain;
  int periodic = 0;
  for (int d = 0; d < domain->dimension; d++) periodic += domain->periodicity[d] != 0;
  if (periodic == 0) return;
  if (domain->dimension == 2)
    voice.fail("keyword cut_off_distance: 'inf' in two dimensions requires boundary f f p (or s, m "
               "in x and y): there are no sums over periodic images of a plane");
  if (periodic < 3)
    voice.fail("keyword cut_off_distance: 'inf' requires a box that is periodic in all three "
               "directions (boundary p p p) or in none: with others the flow far from a net force "
               "is not determined. Use boundary p p p with the open directions long enough, or no "
               "periodic direction, or clumps_only yes");
  if (settings.tensor == SD_TENSOR_OSEEN)
    voice.fail("keyword tensor: 'oseen' with cut_off_distance inf requires a box that is not "
               "periodic");
  if (settings.far_field == Scene::Settings::DIRECT)
    voice.fail("keywords far_field direct and precondition sparse require a box that is not "
               "periodic: only Ewald sums go over all periodic images");
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

void refuse_close_oseen(const Voice &voice, const Scene &scene)
{
  const Comm *comm = voice.lmp->comm;
  const sd_law law = scene.law();
  double mine;
  sd_status status;
  if (scene.view() == SD_VIEW_ALL) {
    const sd_spheres spheres = scene.cloud();
    const int64_t n = scene.cloud_size();
    const int from = n * comm->me / comm->nprocs, to = n * (comm->me + 1) / comm->nprocs;
    status = sd_oseen_coupling(&law, &spheres, nullptr, n, from, to - from, &mine);
  } else {
    const sd_spheres spheres = scene.local();
    const sd_pairs *pairs = scene.settings.clumps_only ? &scene.list() : nullptr;
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

void warn_of_short_cutoff(const Voice &voice, const Scene &scene)
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
  const sd_pairs &list = scene.list();
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

// --- the wall ------------------------------------------------------------------------------------

static std::string side_name(const sd_wall &wall)
{
  return std::string(1, "xyz"[wall.axis]) + (wall.sign > 0 ? "lo" : "hi");
}

std::string wall_name(const sd_wall &wall)
{
  return side_name(wall) + " at " + text(wall.at);
}

static double side_of_box(const Domain *domain, const sd_wall &wall)
{
  return wall.sign > 0 ? domain->boxlo[wall.axis] : domain->boxhi[wall.axis];
}

/* Is a side of a triclinic box at right angles to its axis? */
static bool upright(const Domain *domain, int axis)
{
  if (!domain->triclinic || axis == 2) return true;
  return axis == 1 ? domain->yz == 0.0 : domain->xy == 0.0 && domain->xz == 0.0;
}

void find_wall(const Voice &voice, Scene::Settings &settings)
{
  const Domain *domain = voice.lmp->domain;
  sd_wall &wall = settings.wall;
  if (!wall.sign) return;
  for (int d = 0; d < 3; d++)
    if (domain->periodicity[d])
      voice.fail("keyword wall: it needs boundary f, s or m in all directions, and " +
                 std::string(1, "xyz"[d]) + " is periodic: periodic images above a wall are not "
                 "summed");
  if (!settings.at_edge) return;
  if (domain->boundary[wall.axis][wall.sign < 0] != 1)
    voice.fail("keyword wall: EDGE: that side of the box follows the spheres (boundary s or m): "
               "give the position of the wall, or boundary f there");
  if (!upright(domain, wall.axis))
    voice.fail("keyword wall: EDGE: that side of the box is tilted: give the position of the wall");
  wall.at = side_of_box(domain, wall);
}

void check_stream_at_wall(const Voice &voice, const sd_wall &wall,
                          const Ambient::Settings &fluid)
{
  if (!wall.sign || fluid.grid || fluid.box) return;
  for (int k = 1; k <= 3; k++) {    // the one across the wall last
    const int d = (wall.axis + k) % 3;
    const Field &u = fluid.velocity[d];
    if (u.is_variable() || u.number() == 0.0) continue;
    const std::string there = wall_name(wall) + ", and its component " + "xyz"[d] + " is '" +
        text(u.number()) + "' there: ";
    if (k == 3)
      voice.fail("keyword fluid_velocity: nothing flows through the wall " + there +
                 "give 0, or a variable that is 0 at the wall");
    voice.warn("keyword fluid_velocity: the fluid rests at the wall " + there + "a shear flow is a "
               "variable, such as RATE*(z-zlo)");
  }
}

double spheres_cut_by_wall(const Voice &voice, const Scene &scene)
{
  const sd_wall &wall = scene.settings.wall;
  const sd_spheres spheres = scene.local();
  const Domain *domain = voice.lmp->domain;
  double cut = 0.0;
  if (scene.settings.at_edge && wall.at != side_of_box(domain, wall))
    voice.at_step().fail("keyword wall: EDGE: that side of the box is at " +
                         text(side_of_box(domain, wall)) + " now and was at " + text(wall.at) +
                         " when the run began: walls do not move; give its position");
  for (int k = 0; k < scene.size(); k++) {
    const double height = sd_wall_height(&wall, spheres.x + 3 * (size_t) k);
    cut += height < spheres.a[k];
    if (height > 0.0) continue;
    voice.at_step().fail_one("keyword wall: the centre of atom " + std::to_string(scene.tag(k)) +
                             ", radius " + text(spheres.a[k]) + ", is " + text(0.0 - height) +
                             " behind the wall " + wall_name(wall) + ": spheres must stand in "
                             "front of it; is it on the right side? A contact (fix wall/gran) or a "
                             "shorter time step keeps them there");
  }
  return sum_of_all(voice.lmp->world, cut);
}

// --- motion without inertia -----------------------------------------------------------------------

static void refuse_settings(const Voice &voice, const StokesSettings &s)
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

void refuse_inertia(const Voice &voice, const Hydrodynamics &hydro)
{
  LAMMPS *lmp = voice.lmp;
  if (lmp->update->whichflag == 2)
    voice.fail("minimize cannot be used with it: motion without inertia has no minimiser");
  if (utils::strmatch(lmp->update->integrate_style, "^respa"))
    fail(lmp, voice.command + " does not support run_style respa");
  refuse_settings(voice, hydro.settings);
  for (const Fix *fix : fixes_of(lmp, "stokes_dynamics"))
    voice.fail(name_of(fix) + " cannot apply or report a force in this run (apply yes or no): use the "
               "output of this fix");
}

void announce_step_limit(const Voice &voice, bool euler, double smallest_drag)
{
  LAMMPS *lmp = voice.lmp;
  Force *force = lmp->force;
  const double part = euler ? 0.78 : 0.39;
  const Contact contact = contact_of(lmp);
  const bool walls = fix_like(lmp, "^wall/gran");
  const bool others = strcmp(force->pair_style, "stokes_dynamics") != 0 || force->bond || walls;
  if (!others) return;
  const double limit = part * smallest_drag;
  voice.tell("contacts and bonds of stiffness k allow time steps up to " + text(part) +
             " 6 pi eta a / k = " + text(limit) + " / k");
  const bool linear = !contact.style.empty() && !utils::strmatch(contact.style, "hertz");
  if (linear && contact.k > 0.0 && lmp->update->dt > limit / contact.k)
    voice.warn("time step " + text(lmp->update->dt) + " is above " + text(limit / contact.k) +
               ", the longest that pair_style " + contact.style + " with k " + text(contact.k) +
               " allows in dense packings");
}

// --- bins of LAMMPS ------------------------------------------------------------------------------

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
