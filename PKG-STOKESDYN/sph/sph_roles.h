/* Who takes part in a run of pair_style sph/artVisc/tensCorr: its fixes, and what each particle is by their
 * groups. */
#ifndef SD_SPH_ROLES_H
#define SD_SPH_ROLES_H

#include "sph.h"
#include "sph_coefficients.h"

#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace StokesDyn {

class FixNveSph;
class FixSphDensityContinuity;
class FixSphDensityCorr;
class FixSphDensitySummation;
class FixSphGrains;
class FixSphInlet;
class FixSphOpening;
class FixSphOutlet;
class FixSphPressure;
class FixSphShift;
class FixWallAdamiSph;

class SphRoles : protected LAMMPS_NS::Pointers {
 public:
  explicit SphRoles(const SphCoefficients &settings);

  // --- before a run, in this order; state is whose the scheme wants

  void find();
  void remember();
  /* that no particle has two roles which do not go together; when layers of open ends stand, who is in two */
  void check_groups();
  void check_openings() const;
  void check_layers() const;

  /* Fails unless the last run that LAMMPS prepared was one of this style, with all fixes that took part still
   * there. */
  void require_prepared() const;
  /* Nobody is prepared any more. */
  void forget() { members.clear(); }

  // --- the fixes; nullptr: there is none

  std::vector<FixSphPressure *> pressures;
  std::vector<FixNveSph *> integrators;
  FixSphDensityContinuity *continuity = nullptr;
  FixSphDensitySummation *summation = nullptr;
  FixSphDensityCorr *filter = nullptr;
  FixWallAdamiSph *wall = nullptr;
  std::vector<FixSphInlet *> inlets;
  std::vector<FixSphOutlet *> outlets;
  FixSphShift *state = nullptr;
  FixSphGrains *grains = nullptr;

  bool has_ends() const { return !inlets.empty() || !outlets.empty(); }
  bool has_walls() const { return wall || has_ends(); }
  /* Does the density advance by nve/sph, with rates from the middle of a step? */
  bool is_leapfrog() const { return leapfrog; }
  bool advances_density(int i) const;
  /* the groups of whom the integrators give a vest */
  int with_own_vest() const { return own_vest_bits; }
  /* [3 n] the velocity that particles are moved with beside their own; nullptr: none. */
  const double *shift() const;
  /* Does this run go on where the last one ended? */
  bool resumes() const;
  /* The P0 of all fluids; the lowest one where they differ. */
  double background() const;
  /* that of the only equation of state; 0: there are several, or it has none */
  double only_rest_density() const;
  /* Among the equations of state with a density rho0; nullptr: there is none. */
  std::pair<const FixSphPressure *, const FixSphPressure *>
  least_and_most(const std::function<double(const FixSphPressure *)> &value) const;

  // --- a particle i, of this rank or a ghost

  bool is_wall(int i) const;
  /* the open end in whose layer it stands; is there one? */
  FixSphInlet *inlet_of(int i) const;
  FixSphOutlet *outlet_of(int i) const;
  bool is_held(int i) const { return has_ends() && (inlet_of(i) || outlet_of(i)); }
  /* Does a fix sph/pressure have it? Which one? */
  bool has_state(int i) const;
  const FixSphPressure *state_of(int i) const;
  double speed_of_sound(int i) const;
  double rest_density(int i) const;
  double volume_of(int i) const;
  /* With fix sph/grains, of each: the part of its volume that grains have; nullptr: there are none */
  const double *fractions() const;
  /* Does it keep its place whatever its velocity is? */
  bool stands(int i) const;
  bool has_velocity(int i) const;
  /* Is it at rest (nve/sph/stationary), and does its density not count those of its own kind? */
  bool rests_alone(int i) const;

  /* The load on walls by rows F of the first atoms: atom->f has what other styles and fixes do as well. What
   * ghosts got is added on the rank that computed it. */
  std::array<double, 3> load_on_walls(const Rows &F, int receivers) const;

 private:
  const SphCoefficients &settings;
  const Voice &voice;
  // all fixes, as errors name them when they are gone
  std::vector<std::pair<const LAMMPS_NS::Fix *, std::string>> members;
  int pressure_bits = 0, leapfrog_bits = 0, own_vest_bits = 0, rest_bits = 0;
  // groups of all fixes that displace particles
  int displaced_bits = 0;
  bool leapfrog = false;
  template <class Style> Style *only(const char *otherwise);
  void find_fixes();
  void find_integrators();
  std::vector<LAMMPS_NS::Fix *> of_ours(std::vector<LAMMPS_NS::Fix *> fixes) const;
  std::vector<FixSphOpening *> openings() const;
  LAMMPS_NS::tagint in_both(int bits, int more_bits) const;
};

}    // namespace StokesDyn
#endif
