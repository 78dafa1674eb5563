#include "sph_scheme.h"

#include "fix_sph_grains.h"
#include "fix_sph_settings.h"
#include "fix_sph_tension.h"
#include "fixes.h"

#include "sd_sph_order.h"

#include "domain.h"

#include <cmath>
#include <tuple>

using namespace LAMMPS_NS;
using namespace StokesDyn;

/* What shift, correction and volume yes need, and what they do not go with; planes: there are walls without
 * particles */
static void check_shift(const SphCoefficients &settings, const SphRoles &roles, bool volume, bool planes)
{
  const char *what = settings.corrects ? "correction yes " : settings.pliant ? "shift pliant " : "shift yes ";
  auto refuse = [&](bool when, const std::string &why) {
    if (when) settings.voice.fail(what + why);
  };
  if (settings.shifts) {
    refuse(!roles.is_leapfrog() || !fixes_of(settings.voice.lmp, "sph").empty(),
           "needs fix sph/density/continuity and fix nve/sph: the shift is computed together with "
           "the rate of the density");
    refuse(!(settings.model.delta > 0.0), "needs fix sph/density/continuity with delta, usually 0.1");
    refuse(settings.model.tenscorr, "does not go with tensCorr: both keep particles apart; leave tensCorr out");
    refuse(settings.model.dimension != settings.voice.lmp->domain->dimension,
           "needs the kernel of the box's dimension: write its name without 2d");
    refuse(!settings.corrects && settings.model.kernel == SD_SPH_CUBICSPLINE,
           "needs kernel wendland: with the cubic spline particles form pairs");
    refuse(settings.corrects && planes,
           "does not go with fix wall/sph and wall/region/sph: there are no particles behind such a "
           "wall; use fix wall/adami/sph or shift yes");
  }
  refuse(settings.pliant && volume, "does not go with volume yes of fix sph/density/continuity: use shift yes");
  if (volume && (!roles.is_leapfrog() || settings.model.tenscorr))
    settings.voice.fail("volume yes of fix sph/density/continuity needs fix nve/sph, and does not go with "
                        "tensCorr");
}

/* The same of fix sph/grains */
static void check_grains(const SphCoefficients &settings, const SphRoles &roles, bool volume)
{
  if (!roles.grains) return;
  const Voice &voice = roles.grains->voice;
  if (!roles.is_leapfrog()) voice.fail("needs fix sph/density/continuity and fix nve/sph");
  if (!volume)
    voice.fail("needs volume yes of fix sph/density/continuity, whose sums go by the volume of a particle: "
               "that of water between grains is not its mass over a density");
  if (settings.corrects || roles.filter)
    voice.fail(settings.corrects
                   ? "does not go with correction yes of pair_style sph/artVisc/tensCorr, which knows one volume of "
                     "a particle: use shift yes"
                   : "does not go with fix sph/density/corr, which would smear water into the grains: use delta of "
                     "fix sph/density/continuity");
}

/* And of the keyword implicit */
static void check_implicit(const SphCoefficients &settings, const SphRoles &roles)
{
  if (!settings.implicit) return;
  if (roles.integrators.empty() || !fixes_of(settings.voice.lmp, "sph").empty())
    settings.voice.fail("keyword implicit needs fix nve/sph, whose step it knows");
  if (roles.grains)
    roles.grains->voice.fail("does not go with keyword implicit of pair_style sph/artVisc/tensCorr");
}

SphScheme StokesDyn::choose_scheme(const SphCoefficients &settings, const SphRoles &roles)
{
  LAMMPS *lmp = settings.voice.lmp;
  const bool volume = roles.continuity && roles.continuity->volume,
             planes = !fixes_of(lmp, "wall/sph").empty() || !fixes_of(lmp, "wall/region/sph").empty();
  check_shift(settings, roles, volume, planes);
  check_grains(settings, roles, volume);
  check_implicit(settings, roles);
  const bool shifts = settings.shifts, corrects = settings.corrects;
  const sd_sph_scheme scheme = volume && corrects ? SD_SPH_VOLUME_CORRECTION
      : volume && shifts                          ? SD_SPH_VOLUME_SHIFT
      : volume                                    ? SD_SPH_VOLUME
      : corrects                                  ? SD_SPH_CORRECTION
      : settings.pliant                           ? SD_SPH_SHIFT_PLIANT
      : shifts                                    ? SD_SPH_SHIFT
                                                  : SD_SPH_PLAIN;
  const bool full = corrects || (shifts && !volume && !planes && roles.background() > 0.0);
  return {scheme, full, fixes_of(lmp, FixSphTension::STYLE).empty() ? 0.0 : SD_SPH_WHOLE};
}

/* Two fluids share a pressure at their interface, that for which the stiffer one is made. One that is
 * much softer is compressed by it beyond what weakly compressible means, and with correction, which
 * holds no particle by a pressure that is the same everywhere, it is torn: Rayleigh-Taylor at a ratio
 * of densities of 100 to 1000 ran with stiffnesses 98 to 1, and stopped with 196 to 1. */
void StokesDyn::check_stiffness(const SphCoefficients &settings, const SphRoles &roles)
{
  constexpr double MOST = 100.0;
  if (settings.model.scheme != SD_SPH_VOLUME_CORRECTION) return;
  const FixSphPressure *soft, *stiff;
  auto stiffness = [](const FixSphPressure *fix) {
    const double c = sd_sph_speed_of_sound(&fix->state, fix->state.rho0);
    return fix->state.rho0 * c * c;
  };
  std::tie(soft, stiff) = roles.least_and_most(stiffness);
  if (!soft || stiffness(stiff) <= MOST * (1.0 + 1e-9) * stiffness(soft)) return;
  settings.voice.fail(std::string("correction yes with volume yes: the fluid of fix ") + soft->id + " is " +
                      text(stiffness(stiff) / stiffness(soft)) + " times softer than that of fix " +
                      stiff->id + " (by rho0 c^2 of these fixes); a fluid that is more than " + text(MOST) +
                      " times softer would be torn: give it a larger B, which makes a speed of sound of " +
                      text(sqrt(stiffness(stiff) / MOST / soft->state.rho0)) + " or more");
}
