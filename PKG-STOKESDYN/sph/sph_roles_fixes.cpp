/* The fixes of a run. */
#include "sph_roles.h"

#include "fix_nve_sph.h"
#include "fix_sph_grains.h"
#include "fix_sph_inlet.h"
#include "fix_sph_outlet.h"
#include "fix_sph_settings.h"
#include "fix_sph_shift.h"
#include "fix_wall_sph.h"
#include "fixes.h"
#include "ranks.h"

#include "atom.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

using namespace LAMMPS_NS;
using namespace StokesDyn;

SphRoles::SphRoles(const SphCoefficients &settings) :
    Pointers(settings.voice.lmp), settings(settings), voice(settings.voice)
{
}

void SphRoles::find()
{
  find_fixes();
  find_integrators();
}

template <class Style> Style *SphRoles::only(const char *otherwise)
{
  const auto found = fixes_of<Style>(lmp);
  if (found.size() > 1) voice.fail(std::string("more than one fix ") + Style::STYLE + otherwise);
  return found.empty() ? nullptr : found[0];
}

void SphRoles::find_fixes()
{
  pressures = fixes_of<FixSphPressure>(lmp);
  if (pressures.empty())
    voice.fail("no fix sph/pressure: it sets the pressure that belongs to a density");
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
std::vector<Fix *> SphRoles::of_ours(std::vector<Fix *> fixes) const
{
  const auto others = [this](const Fix *fix) {
    return first_atom(lmp, [this, fix](int i) {
             return (atom->mask[i] & fix->groupbit) && settings.used(atom->type[i]);
           }) == 0;
  };
  fixes.erase(std::remove_if(fixes.begin(), fixes.end(), others), fixes.end());
  return fixes;
}

/* Who advances the density, and who sets vest. */
void SphRoles::find_integrators()
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
  leapfrog_bits = groups_of(moving) | groups_of(stationary);
  own_vest_bits = groups_of(moving) | groups_of(theirs);
  rest_bits = groups_of(stationary) | groups_of(their_stationary);
  displaced_bits = groups_of(movers_of(lmp));
}

bool SphRoles::rests_alone(int i) const
{
  const bool counts_all = summation || filter || settings.model.delta > 0.0;
  return !counts_all && (atom->mask[i] & rest_bits) && !(atom->mask[i] & own_vest_bits);
}

void SphRoles::remember()
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

void SphRoles::require_prepared() const
{
  if (members.empty())
    voice.fail("no run has prepared it yet: use 'run 0' before, or a run without 'pre no'");
  Fix **begin = modify->fix, **end = begin + modify->nfix;
  for (const auto &member : members)
    if (std::find(begin, end, member.first) == end)
      voice.fail(member.second + " has been deleted since the last run, which it took part in; a run "
                 "without 'pre no' finds out who takes part now");
}

void SphRoles::check_groups()
{
  pressure_bits = 0;
  for (const auto *fix : pressures) {
    if (const tagint both = in_both(pressure_bits, fix->groupbit))
      voice.fail("atom " + std::to_string(both) + " is in the groups of two fixes sph/pressure");
    pressure_bits |= fix->groupbit;
  }
  int moved = 0;
  for (const auto *fix : movers_of(lmp)) {
    if (const tagint both = in_both(moved, fix->groupbit))
      voice.fail("atom " + std::to_string(both) + " is integrated twice, by " + name_of(fix) + " and by another "
                 "fix: it would go twice as far in a step; take one of the two out");
    moved |= fix->groupbit;
  }
  if (!wall) return;
  for (const auto *fix : integrators_of(lmp))
    if (const tagint both = in_both(wall->groupbit, fix->groupbit))
      wall->voice.fail("atom " + std::to_string(both) + " of its group is also integrated by fix " +
                       fix->id + ", so the wall would flow: let that fix move the fluid alone; a body "
                       "is moved by fix rigid or fix move, and one that bends cannot be a wall");
}

std::vector<FixSphOpening *> SphRoles::openings() const
{
  std::vector<FixSphOpening *> all(inlets.begin(), inlets.end());
  all.insert(all.end(), outlets.begin(), outlets.end());
  return all;
}

/* Open ends move and delete particles of the fluid that nve/sph integrates. */
void SphRoles::check_openings() const
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
void SphRoles::check_layers() const
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
tagint SphRoles::in_both(int bits, int more_bits) const
{
  return first_atom(lmp, [=](int i) {
    return (atom->mask[i] & bits) && (atom->mask[i] & more_bits) && settings.used(atom->type[i]);
  });
}

// --- what they make of a run ------------------------------------------------------------------------

double SphRoles::background() const
{
  double least = HUGE_VAL;
  for (const auto *fix : pressures) least = std::min(least, fix->state.P0);
  return least;
}

const double *SphRoles::shift() const
{
  return state ? state->du() : nullptr;
}

bool SphRoles::resumes() const
{
  bool all = !state || state->filled();
  for (const auto *fix : integrators) all = all && fix->resumes();
  return all;
}

std::pair<const FixSphPressure *, const FixSphPressure *>
SphRoles::least_and_most(const std::function<double(const FixSphPressure *)> &value) const
{
  const FixSphPressure *least = nullptr, *most = nullptr;
  for (const auto *fix : pressures) {
    if (!(fix->state.rho0 > 0.0)) continue;
    if (!least || value(fix) < value(least)) least = fix;
    if (!most || value(fix) > value(most)) most = fix;
  }
  return {least, most};
}

double SphRoles::only_rest_density() const
{
  return pressures.size() == 1 ? pressures[0]->state.rho0 : 0.0;
}
