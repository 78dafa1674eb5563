/* fix stokes_dynamics/overdamped: motion without inertia of spheres and rigid clumps. See
 * doc/fix_stokes_dynamics_overdamped.md.
 *
 *   initial_integrate   positions of the next step, from the velocities of this one and the last
 *   (post_integrate     scheme midpoint: when fix move has moved its spheres)
 *   [lists, ghosts, forces of all styles and fixes]
 *   final_integrate     velocities, of the positions just reached; likewise in setup, last of all */
#ifndef SD_FIX_STOKES_DYNAMICS_OVERDAMPED_H
#define SD_FIX_STOKES_DYNAMICS_OVERDAMPED_H

#include "body_steps.h"
#include "causes.h"
#include "drives.h"
#include "hydrodynamics.h"
#include "neighbours_stokes.h"
#include "noise.h"
#include "rows_fix.h"

#include "sd_pose.h"

namespace StokesDyn {

class FixStokesDynamicsOverdamped : public RowsFix {
 public:
  static constexpr const char *STYLE = "stokes_dynamics/overdamped";

  /* Before a run: is there such a fix? Then it will find the velocities after the setup of all
   * others. */
  static bool prepare(LAMMPS_NS::LAMMPS *lmp);

  FixStokesDynamicsOverdamped(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void after_setup();
  /* The same before other fixes' setup, when one of those takes a value that follows from it */
  void set_up_early();
  void initial_integrate(int) override;
  void post_integrate() override;
  void final_integrate() override;
  void end_of_step() override;
  void post_run() override;

  /* For compute stokes_dynamics/stress: does the last solve have noise, and what did the same noise alone
   * make where the step begins, as Hydrodynamics::stress? nullptr: nobody asked for it in time */
  bool has_noise_in_solve() const { return noise.on() && scheme == MIDPOINT; }
  const std::vector<double> *stress_of_noise() const;
  /* kT times the bodies of this rank that noise moves */
  double ideal_pressure() const;

  double compute_scalar() override;
  double compute_vector(int) override;

 private:
  /* not given: by whether the mobility has a drift that noise needs */
  enum { AB2, EULER, MIDPOINT } scheme = AB2;
  bool scheme_given = false;
  struct {
    int every = 0;    // 0: the step is the user's
    double tmin, tmax, xmax;
  } adapt;

  Noise noise;
  Directions directions;
  Drives drives;

  /* [3] velocity of a free sphere that is in no clump, by which the next step goes: LAMMPS's v is output,
   * and others may write to it */
  AtomRows lone_velocity;
  /* [6] schemes ab2 and euler: y of a free sphere (noise.h), of its turn only where it has a direction */
  AtomRows random;
  BodySteps steps;
  /* [9] U, of a clump and W, of the step before, and where the sphere, or the centroid of the clump,
   * was put by it; U is that of the point by which the clump is moved. When LAMMPS has made an image
   * of it since, v_old is that of the image. A clump has the row at its atom of lowest tag, which is
   * always on the rank that moves the clump. */
  AtomRows before;
  /* v less that of the fluid, force, torque; of a sphere of a rigid clump the quaternion by which that has
   * turned since the fix was given: these four are state in restart files */
  enum { TURNED = 9, OUTPUTS = 13 };
  AtomArray output;
  /* [4] and from step to step: where bodies go it turns, and nothing else of the output is touched */
  AtomArray turned;
  /* also in restart files: the step of the velocities (-1: never), its length; the length that
   * adapt wants next; atoms there are */
  struct {
    double step = -1, dt = 0.0, next_dt = 0.0, atoms = 0.0;
  } last;
  Causes causes;
  Stamp turns_begun;
  bool from_file = false;

  /* change_of_velocities() in the last step, of this rank */
  double velocity_change = 0.0;
  sd_growth growth = {};    // of error_figure() of all
  bool warned_growth = false, announced = false;
  /* velocities of the first step of a run */
  enum { WAIT, EARLY, FOUND } first = FOUND;

  double pressure_gradient(int d) const;
  bool restored() const override { return last.step >= 0; }
  std::vector<SavedNumbers> saved() override;
  void write_state(NamedState &) override;
  void read_state(const NamedState &) override { from_file = true; }
  const HydrodynamicsOf hydrodynamics{
      voice, "there is no pair_style stokes_dynamics with the settings of the fluid"};
  bool goes_on(const Hydrodynamics &) const;
  void forget_before();
  void set_step(double dt);
  void set_up();
  void announce();
  const double *tracked(const ClumpShape &shape) const;
  void tracked_velocity(const ClumpPoses::Clump &clump, const ClumpShape &shape, double V[6]) const;
  void find_velocities(Hydrodynamics &);
  void check_selection(const Hydrodynamics &) const;
  Neighbourhood neighbourhood;
  void look_at_neighbours();
  void begin_turns(const Hydrodynamics &);
  void find_drives(const Hydrodynamics &);
  bool in_clump(const Hydrodynamics &, int i) const;
  double weight(bool has) const;
  sd_step step_of(bool has) const;
  double change_of_loads() const { return scheme == MIDPOINT ? weight(true) : 0.0; }
  void advance();
  void at_image(const Hydrodynamics &, const double *row, const double *place, double *old) const;
  void move_free(const Hydrodynamics &, int i);
  void move_clumps(Hydrodynamics &);
  void refuse_midpoint(const Hydrodynamics &) const;
  Given given() const { return drives.given(change_of_loads()); }

  // --- scheme midpoint (fix_stokes_dynamics_overdamped_midpoint.cpp)

  Moves found(const Hydrodynamics &) const;
  void begin_midpoint(Hydrodynamics &, const Solve::ToAtom &take);
  void move_by_midpoint(Hydrodynamics &);
  void make_step(Hydrodynamics &, const Moves &V);

  // --- the same with noise (fix_stokes_dynamics_overdamped_noise.cpp)

  /* first moments of the noise alone, [12 nlocal], and of which step */
  std::vector<double> moments_of_noise;
  LAMMPS_NS::bigint moments_step = -1;
  void find_noisy_velocities(Hydrodynamics &, const Solve::ToAtom &take);

  // --- what is told of a step

  /* of this rank, as the last run has left them */
  struct Left {
    double dissipation = 0.0, fastest = 0.0;
  } left;
  void note_left();
  void watch();
  double dissipation() const;
  double fastest() const;
  double fastest_of_all() const;
  double change_of_velocities() const;
  double error_figure() const;
  double smallest_gap() const;
};

/* Internal: in setup, fixes add their forces one after the other as they were defined, and
 * velocities must wait for all. This one is always the last. */
class FixStokesDynamicsLast : public LAMMPS_NS::Fix {
 public:
  static constexpr const char *STYLE = "STOKES_DYNAMICS/LAST";
  static constexpr const char *ID = "STOKES_DYNAMICS_LAST";

  FixStokesDynamicsLast(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg) {}
  int setmask() override { return 0; }
  void setup(int) override;
};

}    // namespace StokesDyn
#endif
