/* Of fix sph/grains: settings, and what it refuses when a run begins and in a step. */
#include "fix_sph_grains.h"

#include "fixes.h"
#include "keywords.h"
#include "pair_sph_artvisc_tenscorr.h"
#include "ranks.h"

#include "atom.h"
#include "domain.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

/* Of grains in a volume: spheres at random have 0.64, and close packing is 0.74. Beside a wall,
 * and in a shock, the mean over a kernel is a little more than the packing. */
static constexpr double MOST = 0.65, CLOSE = 0.74;

FixSphGrains::FixSphGrains(LAMMPS *lmp, int narg, char **arg) :
    SphFix(lmp, narg, arg), rows(1), shown(4), end(lmp), around(lmp)
{
  if (!atom->radius_flag || !atom->rmass_flag)
    voice.fail("atoms have no radius and no mass of their own: use atom_style hybrid sph sphere");
  if (domain->dimension != 3)
    voice.fail("needs dimension 3, since grains are spheres; a thin periodic slice stands for two "
               "dimensions");
  law.drag.law = SD_DRAG_BROWN_LAWLER;
  law.drag.hindrance = SD_HINDRANCE_RICHARDSON_ZAKI;
  Keywords in = keywords(narg, arg);
  in.parse({
      {"viscosity",
       [&] {
         viscosity = in.positive();
       }},
      {"drag",
       [&] {
         law.drag.law = in.option<sd_drag_of_one>({"yade", "schiller_naumann", "brown_lawler",
                                                   "ferguson_church", "ergun", "gidaspow",
                                                   "beetstra", "koch_hill"});
       }},
      {"hindrance",
       [&] {
         parse_hindrance(in);
       }},
      {"fall_diameter",
       [&] {
         law.drag.fall = in.positive();
       }},
      {"displace",
       [&] {
         fills = in.yes_no();
       }},
      {"own_flow",
       [&] {
         own_flow = in.yes_no();
       }},
  });
  if (sd_drag_of_bed(law.drag.law)) {
    in.require(!in.given("hindrance"),
               "keyword hindrance: ergun, gidaspow, beetstra and koch_hill have the neighbours of a grain in them: "
               "leave hindrance out");
    law.drag.hindrance = SD_HINDRANCE_OWN;
  }
  keep({&rows, &shown}, &shown, true);
  restart_global = 1;
  dynamic_group_allow = 1;
  vector_flag = 1;
  size_vector = 4;
  global_freq = 1;
  extvector = 0;
  comm_forward = comm_reverse = 3;
}

void FixSphGrains::parse_hindrance(Keywords &in)
{
  if (in.take("richardson_zaki"))
    law.drag.hindrance = SD_HINDRANCE_RICHARDSON_ZAKI;
  else if (in.take("di_felice"))
    law.drag.hindrance = SD_HINDRANCE_DI_FELICE;
  else {
    law.drag.hindrance = SD_HINDRANCE_POWER;
    law.exponent = in.not_negative();
  }
}

int FixSphGrains::setmask()
{
  return FixConst::PRE_EXCHANGE | FixConst::POST_FORCE | FixConst::POST_RUN;
}

// --- at the beginning of a run -------------------------------------------------------------------

void FixSphGrains::init()
{
  pair = PairSph::of(voice);
  if (pair->dimension() != 3)
    voice.fail("the kernel of pair_style sph/artVisc/tensCorr is that of two dimensions; write its "
               "name without 2d");
  if (!pair->is_newtonian())
    voice.fail("the drag laws are those of grains in a Newtonian fluid, and keyword rheology of "
               "pair_style sph/artVisc/tensCorr gives the water another law: leave one of them out");
  find_held();
  check_scene();
  law.kernel = pair->kernel();
  law.wake = nullptr;
  if (!own_flow) return;
  sd_sph_wake_make(law.kernel, pair->has_laplacian(), &wake);
  law.wake = &wake;
}

/* Forces move those of integrators alone, but for rigid bodies, whose grains do not know the mass
 * that they are moved with: these count as held within a step. */
void FixSphGrains::find_held()
{
  free_bits = groups_of(integrators_of(lmp));
  body_bits = groups_of(fixes_like(lmp, "^rigid"));
  held_bits = 0;
  for (const char *style : {"freeze", "setforce", "move"})
    held_bits |= groups_of(fixes_of(lmp, style));
}

bool FixSphGrains::is_too_large(double diameter) const
{
  return law.h < 2.0 * diameter * (1.0 - 1e-9);
}

std::string FixSphGrains::says_too_large(double diameter) const
{
  return "the smoothing length h = " + text(law.h) + " is below 2 diameters of the largest grain, " + text(diameter) +
      ": water is averaged over many grains; use a larger h and spacing of the water, or "
      "smaller grains (larger bodies: particles of a wall and fix rigid)";
}

/* Those that look like its grains: new atoms are of the group all and of that of their fix. */
void FixSphGrains::look_at_strangers()
{
  std::vector<int> mine(atom->ntypes + 1, 0), of_grains(mine);
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit) mine[atom->type[i]] = 1;
  MPI_Allreduce(mine.data(), of_grains.data(), (int) mine.size(), MPI_INT, MPI_MAX, world);
  const tagint stranger = first_atom(lmp, [&](int i) {
    return of_grains[atom->type[i]] && !(atom->mask[i] & groupbit);
  });
  if (stranger)
    voice.warn("atom " + std::to_string(stranger) +
               " has a type of its grains and is not in its group, so that the water does not know it: put it into "
               "the group (fix deposit and fix pour do so if that is their own group)");
}

/* One h and one viscosity of all water, and grains that are small beside h. */
void FixSphGrains::check_scene()
{
  const tagint both = first_atom(lmp, [this](int i) {
    return (atom->mask[i] & groupbit) && pair->is_particle(i);
  });
  if (both)
    voice.fail("atom " + std::to_string(both) +
               " of its group has a type of pair_style sph/artVisc/tensCorr, which "
               "computes it as water: give grains a type of their own, without pair_coeff ... "
               "sph/artVisc/tensCorr");
  law.h = pair->one_smoothing_length(voice);
  if (law.h == 0.0) voice.fail("there is no particle of pair_style sph/artVisc/tensCorr");
  double mu = 0.0, diameter = 0.0;
  for (int i = 0; i < atom->nlocal; i++)
    if (!pair->is_particle(i))
      diameter = std::max(diameter, atom->mask[i] & groupbit ? 2.0 * atom->radius[i] : 0.0);
    else if (!pair->is_of_wall(i))
      mu = std::max(mu, pair->viscosity(i));
  diameter = largest_of_all(world, diameter);
  law.eta = viscosity > 0.0 ? viscosity : largest_of_all(world, mu);
  if (!(law.eta > 0.0))
    voice.fail("keyword viscosity is required: drag needs the dynamic viscosity of the water, and pair_style "
               "sph/artVisc/tensCorr has none (its keyword viscosity)");
  if (is_too_large(diameter)) voice.fail(says_too_large(diameter));
  look_at_strangers();
}

// --- in a step -----------------------------------------------------------------------------------

void FixSphGrains::check_fractions()
{
  largest = 0.0;
  for (size_t j = 0; j < around.grains.size(); j++) {
    largest = std::max(largest, mean_phi[j]);
    if (is_too_large(2.0 * a[j])) voice.at_step().fail_one(says_too_large(2.0 * a[j]));
    const double most = update->setupflag && !around.is_beside_wall(j) ? MOST : CLOSE;
    if (mean_phi[j] > most)
      voice.at_step().fail_one("the volume fraction of grains around atom " +
                               std::to_string(atom->tag[around.grains[j]]) + " is " + text(mean_phi[j]) +
                               "; above " + text(most) + " no drag law holds, and spheres would overlap: use "
                               "stiffer contacts, or fewer or smaller grains");
  }
  for (size_t p = 0; p < around.points.size(); p++)
    if (phi[around.points[p]] > 0.9)
      voice.at_step().fail_one(
          "grains fill " + text(phi[around.points[p]]) + " of the water at atom " +
          std::to_string(atom->tag[around.points[p]]) +
          ": they overlap, or the spacing of the water is too wide "
          "for its h: use stiffer contacts, fewer or smaller grains, or a larger h");
}

/* Drag on the members of rigid bodies is explicit (find_held): k/M is their rate. */
void FixSphGrains::check_bodies(const std::vector<double> &k)
{
  for (size_t j = 0; j < around.grains.size(); j++) {
    const int i = around.grains[j];
    if (!(atom->mask[i] & body_bits) || update->dt * k[j] <= atom->rmass[i]) continue;
    voice.at_step().fail_one("atom " + std::to_string(atom->tag[i]) +
                             " is of a rigid body, on which drag is explicit: the time step " + text(update->dt) +
                             " must be below its mass over its drag, " + text(atom->rmass[i] / k[j]));
  }
}
