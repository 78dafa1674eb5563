/* pair_style sph/artVisc/tensCorr: weakly compressible SPH. The pair style runs the whole step of
 * SPH, in its one possible order (density, walls, pressure, force), whatever the order of the fixes
 * in the input: these hold the settings of each part. See doc/pair_sph_artvisc_tenscorr.md. */
#ifndef SD_PAIR_SPH_ARTVISC_TENSCORR_H
#define SD_PAIR_SPH_ARTVISC_TENSCORR_H

#include "moved_box.h"
#include "neighbours.h"
#include "own_fix.h"
#include "pair.h"
#include "sph_checks.h"
#include "sph_forces.h"
#include "sph_walls.h"

#include "atom.h"

#include <utility>
#include <vector>

namespace StokesDyn {

class PairSph : public GhostRows<LAMMPS_NS::Pair>, public SphCoefficients {
 public:
  static constexpr const char *STYLE = Sph::PAIR_STYLE;
  /* of the fix that calls rub_implicitly(), fix_sph_friction.h */
  static constexpr const char *FRICTION_STYLE = "SPH/FRICTION";

  /* That of the scene; fails without one. The same, as a run has prepared it: require_prepared() */
  static PairSph *of(const Voice &voice);
  static PairSph *prepared(const Voice &voice);

  PairSph(LAMMPS_NS::LAMMPS *);
  ~PairSph() override;
  void settings(int, char **) override;
  void coeff(int, char **) override;
  void init_style() override;
  void setup() override;
  double init_one(int, int) override;
  void compute(int, int) override;
  double single(int, int, int, int, double, double, double, double &) override;
  void *extract(const char *, int &) override;
  double memory_usage() override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_restart_settings(FILE *) override;
  void read_restart_settings(FILE *) override;

  /* Fails unless the last run that LAMMPS prepared was one of this style, with all fixes that took part
   * still there: for everybody who asks something below, and may be asked himself between runs, or after
   * 'run ... pre no', before which LAMMPS prepares nothing. */
  void require_prepared() const { roles.require_prepared(); }

  /* At the end of a step, when all forces are known: their friction, that of the estimated velocities,
   * becomes that of the velocities a time tau later (sd_sph_implicit.h). */
  void rub_implicitly(double tau);

  /* For the SPH fixes. Pressures are those of the latest force. */
  double pressure(int i) const { return rows.P[i]; }
  /* What of them acts: pressures less this one. */
  double reference_pressure() const { return sd_sph_reference(&model, roles.background()); }
  /* Of particle i, of this rank, in the latest force; with a law of viscosity 0 for walls. */
  double viscosity(int i) const { return viscosities.of(i); }
  /* Of each owned particle: |h v.d / (r^2 + eta)|. Not inside compute. */
  void largest_approach(std::vector<double> &largest);
  /* rho0 of its equation of state; without one the density that it has. */
  double rest_density(int i) const { return roles.rest_density(i); }
  /* Of the water of owned particle i, without the air in spray; with fix sph/grains of the mixture. */
  double volume_of(int i) const { return roles.volume_of(i); }
  /* The smallest sd_sph_growth_limit of particles of these groups that are none of a wall. */
  double growth_limit(int bits) const { return checks.growth_limit(bits); }
  /* Does particle i, of this rank or a ghost, stand in the layer of a fix sph/inlet or sph/outlet? */
  bool is_held(int i) const { return roles.is_held(i); }
  /* Is particle i one of this style; one of a wall? */
  bool is_particle(int i) const { return used(atom->type[i]); }
  bool is_of_wall(int i) const { return roles.is_wall(i); }
  /* Is it at rest (nve/sph/stationary), and does its density not count those of its own kind? */
  bool rests_alone(int i) const { return roles.rests_alone(i); }
  bool has_ends() const { return roles.has_ends(); }
  /* The h of all particles of this style on all ranks; 0: there is none. Fails where types have others. */
  double one_smoothing_length(const Voice &of) const;
  /* For fix sph/tension: are there fluids of different density? */
  bool has_fluids() const { return sd_sph_of_fluids(&model) != 0; }
  /* Of particle i that is none of a wall: that of its equation of state at its density, and the
   * viscosity that shear feels, with that of artVisc: rho alpha c h/(2 (D+2)). */
  double speed_of_sound(int i) const { return roles.speed_of_sound(i); }
  double all_viscosity(int i) const { return viscosities.all_of(i); }
  /* With shift or delta: the neighbours of each particle of this rank in the latest force, those nearer
   * than 2 h and some more. */
  sd_sph_both neighbours_of_each() { return rows.near.both(atom->nlocal); }
  /* For fix sph/tension: is the support of particle i, of this rank or a ghost, whole? In the middle of the
   * latest step. */
  bool is_whole(int i) const { return middle.is_whole(i); }
  /* [3 n] the velocity that particles are moved with beside their own; nullptr: none. */
  const double *shift() const { return roles.shift(); }
  /* [4 n] the latest force of this style on each owned particle, and what of it is friction (artVisc
   * and viscosity): x y z and a number without meaning. Kept while there is a compute sph/energy, the
   * first also with fix sph/grains. */
  const double *own_forces() const { return forces.own_forces(); }
  const double *own_friction() const { return forces.own_friction(); }
  /* [6 n] of each owned particle: sd_sph_moments. Not inside compute; false: no force has been
   * computed yet for these atoms, so there is no list of them. */
  bool moments(std::vector<double> &M);
  /* Does this run go on where the last one ended? */
  bool resumes() const { return roles.resumes(); }

 private:
  const OwnFix shift_fix, friction_fix;
  SphRoles roles;
  SphRows rows;
  SphMiddle middle;
  SphWalls walls;
  SphViscosities viscosities;
  SphForces forces;
  SphChecks checks;
  MovedBox moved_box;
  Neighbourhood neighbourhood;

  // of a run
  bool needs_velocity = false;
  // Has LAMMPS set up this run? rerun initialises, and then computes the forces of one snapshot after
  // the other.
  bool begun = false;
  LAMMPS_NS::bigint dangerous_builds = 0;
  std::pair<int, int> listed = {-1, -1};    // atoms and ghosts of the latest force
  // comm_modify vel was no
  bool asked_for_velocities = false;

  void allocate();
  void choose_scheme();
  void refuse_again();
  void check_list();
  void estimate_velocities();
  void settle_walls();
  void tally();
  /* nothing where ghosts got nothing */
  void reverse(double *rows, int width, bool keep_largest = false) override;
};

}    // namespace StokesDyn
#endif
