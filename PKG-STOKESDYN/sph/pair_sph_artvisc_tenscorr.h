/* pair_style sph/artVisc/tensCorr: weakly compressible SPH. The pair style runs the whole step of
 * SPH, in its one possible order (density, walls, pressure, force), whatever the order of the fixes
 * in the input: these hold the settings of each part. See doc/pair_sph_artvisc_tenscorr.md. */
#ifndef SD_PAIR_SPH_ARTVISC_TENSCORR_H
#define SD_PAIR_SPH_ARTVISC_TENSCORR_H

#include "atom.h"
#include "moved_box.h"
#include "neighbours.h"
#include "own_fix.h"
#include "pair.h"
#include "sph.h"
#include "sph_coefficients.h"

#include <array>
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
  void require_prepared() const;

  /* At the end of a step, when all forces are known: their friction, that of the estimated velocities,
   * becomes that of the velocities a time tau later (sd_sph_implicit.h). */
  void rub_implicitly(double tau);

  /* For the SPH fixes. Pressures are those of the latest force. */
  double pressure(int i) const { return P[i]; }
  /* What of them acts: pressures less this one. */
  double reference_pressure() const { return sd_sph_reference(&model, background()); }
  /* Of particle i, of this rank, in the latest force; with a law of viscosity 0 for walls. */
  double viscosity(int i) const;
  /* Of each owned particle: |h v.d / (r^2 + eta)|. Not inside compute. */
  void largest_approach(std::vector<double> &largest);
  /* rho0 of its equation of state; without one the density that it has. */
  double rest_density(int i) const;
  /* Of the water of owned particle i, without the air in spray; with fix sph/grains of the mixture. */
  double volume_of(int i) const;
  /* The smallest sd_sph_growth_limit of particles of these groups that are none of a wall. */
  double growth_limit(int bits) const;
  /* Does particle i, of this rank or a ghost, stand in the layer of a fix sph/inlet or sph/outlet? */
  bool is_held(int i) const;
  /* Is particle i one of this style; one of a wall? */
  bool is_particle(int i) const;
  bool is_of_wall(int i) const { return is_wall(i); }
  /* Is it at rest (nve/sph/stationary), and does its density not count those of its own kind? */
  bool rests_alone(int i) const;
  bool has_ends() const { return !inlets.empty() || !outlets.empty(); }
  /* The h of all particles of this style on all ranks; 0: there is none. Fails where types have others. */
  double one_smoothing_length(const Voice &of) const;
  /* For fix sph/tension: are there fluids of different density? */
  bool has_fluids() const { return sd_sph_of_fluids(&model) != 0; }
  /* Of particle i that is none of a wall: that of its equation of state at its density, and the
   * viscosity that shear feels, with that of artVisc: rho alpha c h/(2 (D+2)). */
  double speed_of_sound(int i) const;
  double all_viscosity(int i) const;
  /* With shift or delta: the neighbours of each particle of this rank in the latest force, those nearer
   * than 2 h and some more. */
  sd_sph_both neighbours_of_each() { return near.both(atom->nlocal); }
  /* For fix sph/tension: is the support of particle i, of this rank or a ghost, whole? In the middle of the
   * latest step. */
  bool is_whole(int i) const { return du4[4 * (size_t) i + 3] > 0.0; }
  /* [3 n] the velocity that particles are moved with beside their own; nullptr: none. */
  const double *shift() const;
  /* [4 n] the latest force of this style on each owned particle, and what of it is friction (artVisc
   * and viscosity): x y z and a number without meaning. Kept while there is a compute sph/energy, the
   * first also with fix sph/grains. */
  const double *own_forces() const { return own.data(); }
  const double *own_friction() const { return rubs.data(); }
  /* [6 n] of each owned particle: sd_sph_moments. Not inside compute; false: no force has been
   * computed yet for these atoms, so there is no list of them. */
  bool moments(std::vector<double> &M);
  /* Does this run go on where the last one ended? */
  bool resumes() const;

 private:
  const OwnFix shift_fix, friction_fix;
  void allocate();

  // the fixes that take part; set in init_style
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
  // all of these, as errors name them when they are gone
  std::vector<std::pair<const LAMMPS_NS::Fix *, std::string>> members;
  // above which least eigenvalue of M a support is whole; 0: nobody asks
  double whole = 0.0;
  // The fluid fills its vessel: with correction, or with shift and P0 > 0, under which no surface is at rest.
  bool full = false;
  int pressure_bits = 0, leapfrog_bits = 0, own_vest_bits = 0, rest_bits = 0;
  // groups of all fixes that displace particles
  int displaced_bits = 0;
  bool leapfrog = false, needs_velocity = false, measured = false;
  LAMMPS_NS::bigint dangerous_builds = 0;
  // Has LAMMPS set up this run? rerun initialises, and then computes the forces of one snapshot after
  // the other.
  bool begun = false;
  Neighbourhood neighbourhood;
  // comm_modify vel was no
  bool asked_for_velocities = false;
  template <class Style> Style *only(const char *otherwise);
  void find_fixes();
  std::vector<LAMMPS_NS::Fix *> of_ours(std::vector<LAMMPS_NS::Fix *> fixes) const;
  void find_integrators();
  void remember_members();
  void check_shift(bool volume, bool planes) const;
  void check_grains(bool volume) const;
  void check_implicit() const;
  void choose_scheme();
  void check_stiffness();
  void check_groups();
  void check_openings();
  void check_layers() const;
  std::vector<FixSphOpening *> openings() const;
  LAMMPS_NS::tagint in_both(int bits, int more_bits) const;

  // Neighbours with their memory, as sd_sph_both.
  struct Neighbours {
    std::vector<int> pool, own, count;
    std::vector<int *> neighbor;
    void resize(int particles, size_t entries);
    sd_sph_both both(int n) { return {n, neighbor.data(), own.data(), count.data()}; }
    sd_sph_near room(double margin)
    {
      return {margin, pool.data(), neighbor.data(), own.data(), count.data()};
    }
    double bytes() const;
  };

  // a step
  sd_sph_list pairs = {}, raw = {};    // near ones, if a pass of the step has picked them; LAMMPS's
  // Do two ranks share their pairs? With sums that have many columns each has its own: no ghost
  // then gets anything, and nothing goes back.
  bool shared = true;
  Neighbours near, around, of_flow;
  LAMMPS_NS::bigint around_of = -1;    // the step of the list that `around` is made of
  std::pair<int, int> listed = {-1, -1};    // atoms and ghosts of the latest force
  sd_sph_particles particles = {};
  std::vector<sd_sph_coefficients> coefficients;
  MovedBox moved_box;
  Rows x4, v4, f4, sums, weights, spins, slope4, du4, B8, own, rubs, scratch;
  std::vector<double> P, masses, rate, each, kick, wall_rows, displacing, viscosities, inertia;
  int friction_steps = 0;    // of the last implicit friction
  std::vector<int> classes, phases;
  bool used(int itype) const;
  void look_at_densities(int n);
  void pack_volumes();
  void look_at_beginning();
  void look_at_scene();
  bool fills_space();
  void look_at_rest();
  void look_at_thickness();
  void look_at_walls();
  void tell_of_belts();
  void look_at_bodies();
  void look_at_bodies_of(const LAMMPS_NS::Fix *rigid, const int *body, const double *mass);
  void check_turning(const double w2_shear2[2]);
  void look_at_sound();
  void look_at_widths();
  void look_at_plane();
  void look_at_idlers();
  void look_at_fluids();
  void prepare();
  bool types_are_alike();
  void estimate_velocities();
  void settle_walls();
  bool stands(int i) const;
  bool has_velocity(int i) const;
  const double *displacement_rates();
  void find_densities();
  void density_step();
  void sum_rates(double margin);
  void sum_middle(double margin);
  void close_sums();
  void sum_densities(int bit, bool shepard);
  void wall_particles();
  void look_at_gravity() const;
  const double *spins_of_walls();
  void sums_of_other_fluids(const double *spins_of_walls);
  void wall_row(int i, const double *sums_i, double *row);
  void held_row(int i, const double *sums_i, double *row);
  [[noreturn]] void no_density(const Voice &of, int i, const std::string &asked) const;
  bool is_wall(int i) const;
  std::array<double, 3> load_of(const Rows &F, int receivers) const;
  bool has_walls() const { return wall || has_ends(); }
  const FixSphPressure *state_of(int i) const;
  double background() const;
  void pressures_of_all();
  std::vector<double> shear_rates();
  void find_viscosities();
  void look_at_step();
  void look_at_surface(int found);
  void forces(bool rates);
  double sum_forces(const sd_sph_model &of, Neighbours &both, const sd_sph_list &half, bool rates, Rows &F,
                    double *of_pairs);
  void add_kicks(Rows &F) const;
  void keep_forces();
  sd_sph_list pairs_of_flow();
  void check_list();
  [[noreturn]] void coincident();
  void tally();
  /* nothing where ghosts got nothing */
  void reverse(double *rows, int width, bool keep_largest = false);
};

}    // namespace StokesDyn
#endif
