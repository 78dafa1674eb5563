/* Of fix hydro/vans: what a run may not do as one thinks, said once. */
#include "fix_hydro_vans.h"

#include "fixes.h"
#include "gravity.h"
#include "neighbours_vans.h"
#include "sd_sphere.h"

#include "atom.h"
#include "comm.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

using namespace LAMMPS_NS;
using namespace StokesDyn;

void FixHydroVans::look_at_neighbours()
{
  const unsigned facts =
      (set.fluctuations.kind == VansSettings::Fluctuations::LANGEVIN ? LANGEVIN : 0u) | (set.has_grains() ? DRAGS : 0u);
  neighbourhood.look(set.voice, vans_neighbours, facts,
                     [this](int i) { return (unsigned) ((atom->mask[i] & groupbit) != 0); }, this);
}

/* The slope is told twice, and buoyancy is not to be taken off the weight. */
void FixHydroVans::look_at_gravity() const
{
  if (std::any_of(set.gravity, set.gravity + 3, [](const Field &part) { return part.is_variable(); })) return;
  compare_gravity(set.voice, set.law.g, [this](int i) { return (atom->mask[i] & groupbit) != 0; },
                  {"grains", "they need the same slope as the water, and their full weight, since this fix adds the "
                             "buoyancy; give both the same numbers"});
}

/* The buoyancy lifts grains that have no weight, also those of the density of the water. Not told where another
 * fix may have the weight or holds them, or where nobody moves them. */
void FixHydroVans::tell_weight()
{
  const double *g = set.law.g;
  const bool lifts = g[1] != 0.0 || g[2] != 0.0 || (set.law.rest && g[0] != 0.0);
  if (stream.told.has(VansTold::WEIGHT) || !set.has_grains() || !lifts || update->nsteps == 0) return;
  const tagint first = first_moved(lmp, "gravity addforce* efield* external python* spring* drag smd freeze setforce "
                                        "aveforce planeforce lineforce move",
                                   [this](int i) { return (atom->mask[i] & groupbit) != 0; });
  if (first)
    stream.told.warn(VansTold::WEIGHT,
                     "keyword gravity: no fix gives atom " + std::to_string(first) + " a weight, so that the "
                     "buoyancy, which this fix adds, lifts it: grains need their full weight (fix gravity with the "
                     "same numbers), also those of the density of the water");
}

/* The law that holds unless one is chosen is made for beads of some millimetres in water. Where grains
 * fall at a Reynolds number of 1 to some hundreds it gives up to 1.4 times the speed of spheres: the
 * worst grain of all. By dimensions that ratio follows from weight rho/eta^2, so that one grain stands
 * for all whose weights differ by less than a hundredth. */
void FixHydroVans::tell_fall()
{
  if (stream.told.has(VansTold::FALL) || set.drag_given || set.yade() || !set.has_grains()) return;
  const double g = std::sqrt(set.law.g[0] * set.law.g[0] + set.law.g[1] * set.law.g[1] +
                             set.law.g[2] * set.law.g[2]), rho = set.law.rho, eta = set.law.eta;
  sd_drag_law alone = set.law.drag, sphere = alone;
  sphere.law = SD_DRAG_BROWN_LAWLER;
  select(groupbit);
  struct {
    double ratio;
    int rank;
  } mine = {1.1, comm->me}, worst;
  double found[4] = {0.0, 0.0, 0.0, 0.0};    // radius, its two speeds, Re
  std::set<long> seen;
  for (int i = 0; i < atom->nlocal; i++) {
    const double a = atom->radius[i], m = atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]],
                 weight = g * std::fabs(m - sd_sphere_volume(a) * rho);
    if (!take[i] || !(weight > 0.0) || !seen.insert(std::lround(100.0 * std::log(weight))).second) continue;
    const double w = sd_fall_speed(alone, rho, eta, a, weight),
                 right = sd_fall_speed(sphere, rho, eta, a, weight);
    if (!(w > mine.ratio * right)) continue;
    mine.ratio = w / right;
    const double here[4] = {a, w, right, 2.0 * a * rho * right / eta};
    std::copy_n(here, 4, found);
  }
  MPI_Allreduce(&mine, &worst, 1, MPI_DOUBLE_INT, MPI_MAXLOC, world);
  if (!(worst.ratio > 1.1)) return;
  MPI_Bcast(found, 4, MPI_DOUBLE, worst.rank, world);
  stream.told.warn(VansTold::FALL,
                   "keyword drag: by its default, yade, a lone grain of radius " + text(found[0]) + " falls at " +
                       text(found[1]) + ", a sphere in fact at " + text(found[2]) + " (Re = " + text(found[3]) +
                       "): use drag brown_lawler for spheres, ferguson_church for sand, or write drag yade if you "
                       "want that law");
}

/* Which roughness the law of the mixing length gives a bed of grains that do not move: the middle of
 * two depths of water over one such bed (page vans_stream). The other laws are not known. */
void FixHydroVans::tell_roughness()
{
  if (set.couple != VansSettings::TWO || set.upflow || set.yade()) return;
  const char *name = nullptr;
  double rough = 0.0;
  switch (set.fluid.turbulence) {
    case SD_VANS_LI_SAWAMOTO:
      name = "li_sawamoto";
      rough = set.law.felt_by_volume ? 1.2 : 0.9;
      break;
    case SD_VANS_NI_CAPART:
      name = "ni_capart";
      rough = 1.7;
      break;
    case SD_VANS_ROUSSEAU:
      name = "rousseau";
      rough = 12.0;
      break;
    default:
      return;
  }
  stream.told.tell(VansTold::ROUGHNESS, std::string("turbulence ") + name +
                                            ": a bed of fixed grains is about as rough as k_s = " + text(rough) +
                                            " grain diameters; flumes have 1 to 2");
}

/* Without `sublayer yes` these laws rub on a smooth bottom as if it had grains (page vans_stream). */
void FixHydroVans::tell_smooth()
{
  static const std::map<sd_vans_turbulence, const char *> NAMES = {{SD_VANS_KZ, "kz"},
                                                                   {SD_VANS_PARABOLIC, "parabolic"},
                                                                   {SD_VANS_LI_SAWAMOTO, "li_sawamoto"},
                                                                   {SD_VANS_NI_CAPART, "ni_capart"},
                                                                   {SD_VANS_PIPE, "pipe"}};
  const auto law = NAMES.find(set.fluid.turbulence);
  if (stream.told.has(VansTold::SMOOTH) || !set.solves() || set.fluid.sublayer || set.yade() || law == NAMES.end())
    return;
  const double *phi = stream.phi();
  bigint mine = std::any_of(phi, phi + stream.ncell(), [](double part) { return part > 0.0; }), all;
  if (set.has_grains())
    for (int i = 0; i < atom->nlocal; i++) mine += (atom->mask[i] & average_bit) != 0;
  MPI_Allreduce(&mine, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (all > 0) return;
  stream.told.warn(VansTold::SMOOTH, std::string("keyword turbulence: there are no grains, and with ") + law->second +
                                         " a smooth bottom rubs as if it had grains of 75 nu/u_star: use sublayer "
                                         "yes" + (law->first == SD_VANS_PIPE ? "" : ", or turbulence rousseau"));
}

/* A surface of given velocity is a wall to the law pipe alone. To the others eddies are longest there. */
void FixHydroVans::tell_lid()
{
  const sd_vans_fluid &fluid = set.fluid;
  if (!fluid.driven || !set.solves() || set.yade() || fluid.turbulence == SD_VANS_LAMINAR) return;
  if (fluid.sublayer && stream.drive == 0.0 && !set.dpdx.is_variable() && !set.gravity[0].is_variable())
    stream.told.warn(VansTold::LID,
                     "keyword sublayer: its u_star is that of gravity and pressure gradient along x, and with surface "
                     "speed alone both are 0: there are no eddies at any height; leave sublayer out");
  else if (fluid.turbulence != SD_VANS_PIPE && !set.u_top.is_variable() && set.u_top.number() == 0.0)
    stream.told.warn(VansTold::LID,
                     "keyword surface: speed 0 is a lid at rest, and for all laws of turbulence but pipe eddies are "
                     "long there, so that it takes most of what drives the stream: use turbulence pipe");
}

/* Once: by the default a clump whose members overlap has the buoyancy and the drag of all of them */
void FixHydroVans::tell_overlap()
{
  if (stream.told.has(VansTold::OVERLAP) || set.overlap_given || !atom->molecule_flag || set.yade() ||
      !set.has_grains())
    return;
  const tagint first = overlaps.first(groupbit | average_bit);
  if (first == 0) return;
  stream.told.warn(VansTold::OVERLAP,
                   "keyword overlap: by its default, twice, what members of the clump of molecule " +
                       std::to_string(first) + " share counts twice, in buoyancy, drag and phi: use overlap once, or "
                       "write overlap twice if you want that");
}

/* What a coupling does, where it is not what the keywords seem to say, or takes seconds. */
void FixHydroVans::tell_steps()
{
  const double of_grains = nevery * update->dt, T = set.period > 0.0 ? set.period : of_grains,
               wanted = set.period > 0.0 ? set.dt : 0.1 * T, N = set.ncell();
  double dt = wanted;
  const auto steps = sd_vans_steps(set.law.rules, T, &dt);
  const std::string as_made = std::to_string(steps) + " steps of " + text(dt) + " are used";
  if (std::fabs(dt - wanted) > 1e-9 * wanted)
    set.voice.tell("the step " + text(wanted) + " of keyword solve is no fraction of " + text(T) +
                   ": " + as_made);
  else if (std::fabs(steps * dt - T) > 1e-9 * T)
    set.voice.tell("rules yade: " + as_made + " for the period " + text(T));
  if (set.couple == VansSettings::TWO && std::fabs(T / of_grains - 1.0) > 1e-9)
    set.voice.tell("every coupling solves the stream over the time " + text(T) +
                   ", but the grains move for " + text(of_grains) + " between couplings");
  if (steps * N > 1e9)
    stream.told.warn(VansTold::WORK, "keyword solve: " + text((double) steps) + " steps of " + text(N) +
                                         " slices in every coupling take about " + text(5e-9 * steps * N) +
                                         " seconds each time");
}

/* The exchange of rules yade knows one size or classes. */
void FixHydroVans::tell_sizes()
{
  if (!set.yade() || set.classes) return;
  double mine[2] = {0.0, 0.0}, all[2];    // the largest radius and the largest inverse
  for (int i = 0; i < atom->nlocal; i++)
    if ((atom->mask[i] & average_bit) && atom->radius[i] > 0.0) {
      mine[0] = std::max(mine[0], atom->radius[i]);
      mine[1] = std::max(mine[1], 1.0 / atom->radius[i]);
    }
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_MAX, world);
  if (all[0] * all[1] > 1.01)
    set.voice.warn("rules yade: radii from " + text(1.0 / all[1]) + " to " + text(all[0]) +
                   " are replaced by their mean in the drag on the water, which can be wrong by a "
                   "factor of two: use classes yes, or rules consistent");
}

/* Of each atom; HUGE_VAL where its own mass does not say how it moves: of held grains, and of light ones in bodies */
std::vector<double> FixHydroVans::masses_that_move() const
{
  std::vector<double> mass(atom->nlocal + 1);
  const int free_bits = groups_of(integrators_of(lmp)), rigid_bits = groups_of(fixes_like(lmp, "^rigid"));
  for (int i = 0; i < atom->nlocal; i++) {
    mass[i] = atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]];
    const double added = set.law.added_mass * set.law.rho * sd_sphere_volume(atom->radius[i]);
    const bool in_body = atom->mask[i] & rigid_bits, free = !in_body && (atom->mask[i] & free_bits);
    if (!free && !(in_body && mass[i] > added)) mass[i] = HUGE_VAL;
  }
  return mass;
}

/* Drag acts with the velocity of the step before, added mass with its acceleration: beyond 2/rate a
 * step overshoots and grows. Looked at when a run begins and then every 100 steps at most. */
void FixHydroVans::tell_stiff()
{
  if (stream.told.has(VansTold::STIFF) || !set.has_grains()) return;
  if (looked_step >= 0 && update->ntimestep < looked_step + 100) return;
  looked_step = update->ntimestep;
  select(groupbit);
  const std::vector<double> mass = masses_that_move();
  const sd_vans_grains all = grains();
  const sd_vans_ambient ambient = stream.ambient();
  int stiffest = -1;
  struct {
    double rate;
    int rank;
  } mine = {sd_vans_stiffest(&ambient, &all, mass.data(), &stiffest), comm->me}, largest;
  MPI_Allreduce(&mine, &largest, 1, MPI_DOUBLE_INT, MPI_MAXLOC, world);
  if (!(largest.rate * update->dt > 1.0)) return;
  double tag = stiffest < 0 ? 0.0 : (double) atom->tag[stiffest];
  MPI_Bcast(&tag, 1, MPI_DOUBLE, largest.rank, world);
  const std::string which = std::to_string((bigint) tag);
  if (largest.rate == HUGE_VAL) {
    stream.told.warn(VansTold::STIFF, "keyword added_mass: atom " + which + " is not heavier than " +
                                          text(set.law.added_mass) + " times the water in its place: its velocity "
                                          "grows without bound, however short the time step; use a smaller "
                                          "added_mass, or leave it out");
    return;
  }
  stream.told.warn(VansTold::STIFF,
                   "the time step " + text(update->dt) + " is too long for the drag on atom " + which +
                       ", which changes its velocity at the rate " + text(largest.rate) + ": take at most " +
                       text(1.0 / largest.rate) + "; beyond " + text(2.0 / largest.rate) +
                       " the velocity grows without bound");
}
