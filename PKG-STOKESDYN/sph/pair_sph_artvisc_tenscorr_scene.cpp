/* Of pair_style sph/artVisc/tensCorr: who takes part in a run, and what goes with what. */
#include "pair_sph_artvisc_tenscorr.h"

#include "compute_sph_energy.h"
#include "fix_nve_sph.h"
#include "fix_sph_grains.h"
#include "fix_sph_inlet.h"
#include "fix_sph_outlet.h"
#include "fix_sph_settings.h"
#include "fix_sph_shift.h"
#include "fix_sph_tension.h"
#include "fix_wall_sph.h"
#include "fixes.h"
#include "keywords.h"
#include "lammps_compat.h"
#include "neighbours_sph.h"
#include "ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "force.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cstring>
#include <set>

using namespace LAMMPS_NS;
using namespace StokesDyn;

void PairSph::init_style()
{
  Sph::require_scene(voice);
  if (update->whichflag == 2)
    voice.fail("cannot be minimised: it has no energy; define the pair styles without it meanwhile "
               "('pair_style none' if there are no others)");
  if (strncmp(update->integrate_style, "respa", 5) == 0)
    voice.fail("cannot be used with run_style respa");
  if (force->pair_match(STYLE, 1) != this)
    voice.fail("may appear only once in a hybrid pair style");
  if (atom->tag_enable == 0) voice.fail("requires atom IDs");
  single_enable = force->pair != this;    // alone it would say that there are no forces
  find_fixes();
  find_integrators();
  choose_scheme();
  remember_members();
  check_stiffness();
  check_groups();
  check_openings();

  measured = !fixes_of(lmp, FixSphEnergy::STYLE).empty();
  needs_velocity = model.artvisc || model.friction || continuity;
  // As comm_modify vel yes: each pair must see the same velocities on both sides.
  if (needs_velocity && !comm->ghost_velocity) comm->ghost_velocity = asked_for_velocities = 1;
  if (neighbor->skin <= 0.0)
    voice.fail("command neighbor: a skin of 0 is too small; a tenth of h is usual");
  if (neighbor->build_once || (!neighbor->dist_check && std::max(neighbor->every, neighbor->delay) > 1))
    voice.warn(
        "with neigh_modify once yes or check no, LAMMPS does not notice when the neighbour list is outdated");
  dangerous_builds = neighbor->ndanger;
  Compat::request_half_list(neighbor, this, instance_me, !shared);
  around_of = -1;
  begun = false;
}

template <class Style> Style *PairSph::only(const char *otherwise)
{
  const auto found = fixes_of<Style>(lmp);
  if (found.size() > 1) voice.fail(std::string("more than one fix ") + Style::STYLE + otherwise);
  return found.empty() ? nullptr : found[0];
}

void PairSph::find_fixes()
{
  pressures = fixes_of<FixSphPressure>(lmp);
  if (pressures.empty())
    voice.fail("no fix sph/pressure: it sets the pressure that belongs to a density");
  rho0 = pressures.size() == 1 ? pressures[0]->state.rho0 : 0.0;
  continuity = only<FixSphDensityContinuity>(": only one can set the density");
  summation = only<FixSphDensitySummation>(": only one can set the density");
  if (!continuity && !summation)
    voice.fail(
        "no fix sph/density/continuity or sph/density/summation: one of them sets the density");
  if (continuity && summation)
    voice.fail(
        "fix sph/density/continuity and fix sph/density/summation: only one can set the density");
  filter = only<FixSphDensityCorr>("");
  grains = only<FixSphGrains>("; put all grains into one group");
  inlets = fixes_of<FixSphInlet>(lmp);
  outlets = fixes_of<FixSphOutlet>(lmp);
  wall = only<FixWallAdamiSph>("; put all wall particles into one group");
  std::set<std::string> properties;
  for (const auto *fix : fixes_of<FixPropertyGlobal>(lmp))
    if (!properties.insert(fix->property).second)
      voice.fail("more than one fix property/global gives " + fix->property);
}

/* Those with a particle of this style in their group. */
std::vector<Fix *> PairSph::of_ours(std::vector<Fix *> fixes) const
{
  const auto others = [this](const Fix *fix) {
    return first_atom(lmp, [this, fix](int i) {
             return (atom->mask[i] & fix->groupbit) && used(atom->type[i]);
           }) == 0;
  };
  fixes.erase(std::remove_if(fixes.begin(), fixes.end(), others), fixes.end());
  return fixes;
}

/* Who advances the density, and who sets vest. */
void PairSph::find_integrators()
{
  integrators = fixes_of<FixNveSph>(lmp);
  const auto moving = fixes_of(lmp, FixNveSph::STYLE);
  const auto stationary = fixes_of(lmp, FixNveSphStationary::STYLE);
  const auto theirs = of_ours(fixes_of(lmp, "sph")),
             their_stationary = of_ours(fixes_of(lmp, "sph/stationary"));
  const bool ours = !moving.empty() || !stationary.empty(),
             others = !theirs.empty() || !their_stationary.empty();
  if (ours && others)
    voice.fail(std::string("fix nve/sph and fix ") + (theirs.empty() ? "sph/stationary" : "sph") +
               " cannot be mixed: they advance the density at different times; use nve/sph and "
               "nve/sph/stationary");
  if (continuity && !ours && !others && update->whichflag == 1 && update->nsteps > 0)
    continuity->voice.fail("nothing advances the density; use fix nve/sph");
  leapfrog = continuity && ours;
  if (continuity && others && continuity->delta > 0.0)
    voice.warn("delta of fix sph/density/continuity has no effect with fix sph; use fix nve/sph");
  leapfrog_bits = Sph::groups(moving) | Sph::groups(stationary);
  own_vest_bits = Sph::groups(moving) | Sph::groups(theirs);
  rest_bits = Sph::groups(stationary) | Sph::groups(their_stationary);
  displaced_bits = 0;
  for (int k = 0; k < lmp->modify->nfix; k++) {
    const Fix *fix = lmp->modify->fix[k];
    if (fix->time_integrate && !strstr(fix->style, "stationary")) displaced_bits |= fix->groupbit;
  }
}

bool PairSph::rests_alone(int i) const
{
  const bool counts_all = summation || filter || model.delta > 0.0;
  return !counts_all && (atom->mask[i] & rest_bits) && !(atom->mask[i] & own_vest_bits);
}

/* What shift, correction and volume yes need, and what they do not go with; planes: there are walls without
 * particles */
void PairSph::check_shift(bool volume, bool planes) const
{
  const char *what = corrects ? "correction yes " : pliant ? "shift pliant " : "shift yes ";
  auto refuse = [&](bool when, const std::string &why) {
    if (when) voice.fail(what + why);
  };
  if (shifts) {
    refuse(!leapfrog || !fixes_of(lmp, "sph").empty(),
           "needs fix sph/density/continuity and fix nve/sph: the shift is computed together with "
           "the rate of the density");
    refuse(!(model.delta > 0.0), "needs fix sph/density/continuity with delta, usually 0.1");
    refuse(model.tenscorr, "does not go with tensCorr: both keep particles apart; leave tensCorr out");
    refuse(model.dimension != domain->dimension, "needs the kernel of the box's dimension: write its name without 2d");
    refuse(!corrects && model.kernel == SD_SPH_CUBICSPLINE,
           "needs kernel wendland: with the cubic spline particles form pairs");
    refuse(corrects && planes,
           "does not go with fix wall/sph and wall/region/sph: there are no particles behind such a "
           "wall; use fix wall/adami/sph or shift yes");
  }
  refuse(pliant && volume, "does not go with volume yes of fix sph/density/continuity: use shift yes");
  if (volume && (!leapfrog || model.tenscorr))
    voice.fail("volume yes of fix sph/density/continuity needs fix nve/sph, and does not go with "
               "tensCorr");
}

/* The same of fix sph/grains */
void PairSph::check_grains(bool volume) const
{
  if (!grains) return;
  if (!leapfrog)
    grains->voice.fail("needs fix sph/density/continuity and fix nve/sph");
  if (!volume)
    grains->voice.fail("needs volume yes of fix sph/density/continuity, whose sums go by the volume of a particle: "
                       "that of water between grains is not its mass over a density");
  if (corrects || filter)
    grains->voice.fail(corrects ? "does not go with correction yes of pair_style sph/artVisc/tensCorr, which knows one "
                                  "volume of a particle: use shift yes"
                                : "does not go with fix sph/density/corr, which would smear water into the grains: "
                                  "use delta of fix sph/density/continuity");
}

/* And of the keyword implicit */
void PairSph::check_implicit() const
{
  if (!implicit) return;
  if (integrators.empty() || !fixes_of(lmp, "sph").empty())
    voice.fail("keyword implicit needs fix nve/sph, whose step it knows");
  if (grains)
    grains->voice.fail("does not go with keyword implicit of pair_style sph/artVisc/tensCorr");
}

/* What the options make of rate and force */
void PairSph::choose_scheme()
{
  model.delta = continuity && leapfrog ? continuity->delta : 0.0;
  whole = fixes_of(lmp, FixSphTension::STYLE).empty() ? 0.0 : SD_SPH_WHOLE;
  const bool volume = continuity && continuity->volume,
             planes = !fixes_of(lmp, "wall/sph").empty() || !fixes_of(lmp, "wall/region/sph").empty();
  check_shift(volume, planes);
  check_grains(volume);
  check_implicit();
  model.scheme = volume && corrects ? SD_SPH_VOLUME_CORRECTION
      : volume && shifts ? SD_SPH_VOLUME_SHIFT
      : volume           ? SD_SPH_VOLUME
      : corrects         ? SD_SPH_CORRECTION
      : pliant           ? SD_SPH_SHIFT_PLIANT
      : shifts           ? SD_SPH_SHIFT
                         : SD_SPH_PLAIN;
  full = corrects || (shifts && !volume && !planes && background() > 0.0);
  friction_fix.take_away();
  if (implicit) friction_fix.make();
  state = FixSphShift::provide(shift_fix, shifts, corrects || pliant);
  shared = sd_sph_level_of(&model) == SD_SPH_RATE;
}

void PairSph::remember_members()
{
  members.clear();
  const auto join = [this](const Fix *fix) {
    if (fix) members.push_back({fix, name_of(fix)});
  };
  for (const auto *fix : pressures) join(fix);
  for (const auto *fix : integrators) join(fix);
  for (const auto *fix : inlets) join(fix);
  for (const auto *fix : outlets) join(fix);
  join(continuity);
  join(summation);
  join(filter);
  join(wall);
  join(state);
  join(grains);
}

void PairSph::require_prepared() const
{
  if (members.empty())
    voice.fail("no run has prepared it yet: use 'run 0' before, or a run without 'pre no'");
  Fix **begin = modify->fix, **end = begin + modify->nfix;
  for (const auto &member : members)
    if (std::find(begin, end, member.first) == end)
      voice.fail(member.second + " has been deleted since the last run, which it took part in; a run "
                 "without 'pre no' finds out who takes part now");
}

void PairSph::check_groups()
{
  pressure_bits = 0;
  for (const auto *fix : pressures) {
    if (const tagint both = in_both(pressure_bits, fix->groupbit))
      voice.fail("atom " + std::to_string(both) + " is in the groups of two fixes sph/pressure");
    pressure_bits |= fix->groupbit;
  }
  int moved = 0;
  for (const auto *fix : Sph::integrators(lmp)) {
    if (const tagint both = in_both(moved, fix->groupbit))
      voice.fail("atom " + std::to_string(both) + " is integrated twice, by " + name_of(fix) + " and by another "
                 "fix: it would go twice as far in a step; take one of the two out");
    moved |= fix->groupbit;
  }
  if (!wall) return;
  for (const auto *fix : Sph::integrators(lmp))
    if (const tagint both = in_both(wall->groupbit, fix->groupbit))
      wall->voice.fail("atom " + std::to_string(both) + " of its group is also integrated by fix " +
                       fix->id + ", so the wall would flow: let that fix move the fluid alone; a body "
                       "is moved by fix rigid or fix move, and one that bends cannot be a wall");
}

std::vector<FixSphOpening *> PairSph::openings() const
{
  std::vector<FixSphOpening *> all(inlets.begin(), inlets.end());
  all.insert(all.end(), outlets.begin(), outlets.end());
  return all;
}

/* Open ends move and delete particles of the fluid that nve/sph integrates. */
void PairSph::check_openings()
{
  for (const auto *fix : openings()) {
    if (!leapfrog) fix->voice.fail("needs fix sph/density/continuity and fix nve/sph");
    if (const tagint other = first_atom(lmp, [&](int i) {
          return (atom->mask[i] & fix->groupbit) && (!(atom->mask[i] & own_vest_bits) || is_wall(i));
        }))
      fix->voice.fail("atom " + std::to_string(other) +
                      " of its group is not moved by fix nve/sph: the group must be that of the fluid, "
                      "without walls");
  }
}

/* When each of them is known to stand at an end of the flow */
void PairSph::check_layers() const
{
  const std::vector<FixSphOpening *> all = openings();
  for (size_t k = 0; k < all.size(); k++)
    for (size_t m = 0; m < k; m++)
      if (const tagint both = first_atom(lmp, [&](int i) { return all[k]->is_held(i) && all[m]->is_held(i); }))
        all[k]->voice.fail("atom " + std::to_string(both) + " stands in the layer of fix " + all[k]->id +
                           " and in that of fix " + all[m]->id + ": leave one of them out, or give each a group of "
                           "its own");
}

/* The first particle in both of these sets of groups, 0: there is none. */
tagint PairSph::in_both(int bits, int more_bits) const
{
  return first_atom(lmp, [=](int i) {
    return (atom->mask[i] & bits) && (atom->mask[i] & more_bits) && used(atom->type[i]);
  });
}

/* Here and not in init_style, since the domain learns of fix deform after that, and pair styles below a
 * hybrid of their types. */
void PairSph::setup()
{
  begun = true;
  check_layers();
  neighbourhood.look(voice, sph_neighbours(), (continuity ? CONTINUITY : 0u) | (grains ? GRAINS : 0u) |
                    (fixes_of(lmp, FixSphTension::STYLE).empty() ? 0u : TENSION), [this](int i) {
    if (!used(atom->type[i]))
      return grains && (atom->mask[i] & grains->groupbit) ? (unsigned) GRAIN : 0u;
    return (unsigned) (is_wall(i) ? WALL : WATER);
  });
  if (needs_velocity && domain->deform_vremap && !fixes_of(lmp, "sph").empty())
    voice.fail("fix deform with remap v: fix sph extrapolates velocities too early, before LAMMPS "
               "adds the jump at the faces that glide; use fix nve/sph");
  if (domain->deform_vremap && finds_surface())
    voice.fail("fix deform with remap v: the momentum that shift carries would differ on the two "
               "sides of a face that glides; use correction yes");
}
