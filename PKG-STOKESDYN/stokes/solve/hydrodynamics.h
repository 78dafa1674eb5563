/* Forces of the spheres from their velocities, or, without inertia, velocities from forces, under
 * the settings of pair_style stokes_dynamics.
 * The pair style and the fixes that go with it stand above this and share the one object, which
 * belongs to the pair style; fixes reach it by Hydrodynamics::of().
 *
 * A step:   begin()                        the fluid, who takes part
 *           clumps(), solve(), drag()      forces, of rigid clumps and of all others
 *           velocities()                   or motions, without inertia
 * Who is a body, where it stands and what is given is in `bodies`, and `solver` finds the rest. Between
 * solves v' stands, and drag() alone gives the force for the velocity of now. Forces and v' are rows of the
 * memory. */
#ifndef SD_HYDRODYNAMICS_H
#define SD_HYDRODYNAMICS_H

#include "ambient.h"
#include "body_scene.h"
#include "clump_poses.h"
#include "fix_stokes_dynamics_state.h"
#include "lubrication.h"
#include "rigid_clumps.h"
#include "engine.h"
#include "scene.h"
#include "settings.h"
#include "solve.h"
#include "solve_noise.h"
#include "time_step_guard.h"

#include <string>
#include <vector>

namespace StokesDyn {

/* Velocities or displacements of bodies: U and W of free spheres, [6 nlocal], 0 of others; and of the clumps
 * of this rank, [6 clumps] */
struct Moves {
  std::vector<double> atoms, clumps;
};

/* What makes the flow, spheres of this rank or the points of their shells: places [3n], radii [n], 0: point
 * forces; force and torque on the fluid over its viscosity [3n]; and that [n] */
struct FlowSources {
  std::vector<double> x, a, F, T, eta;
  void reserve(size_t n);
};

class Hydrodynamics : protected LAMMPS_NS::Pointers {
 public:
  const Voice voice;
  StokesSettings settings;
  Epochs epochs;
  Ambient ambient;
  Scene scene;
  Shells shells;
  Engine engine;
  /* Does a fix report v'? For rigid clumps it is computed only then. */
  bool reports_perturbation = false;
  /* Does fix stokes_dynamics/overdamped find the velocities? Then the pair style does nothing. */
  bool overdamped = false;
  /* of this LAMMPS as it is now; nullptr before the first run */
  FixStokesDynamicsState *memory = nullptr;

  explicit Hydrodynamics(LAMMPS_NS::LAMMPS *lmp);
  /* That of the pair style, nullptr: there is no pair style stokes_dynamics. Fixes look it up whenever
   * they need it, as the pair style may be another one by then. */
  static Hydrodynamics *of(LAMMPS_NS::LAMMPS *lmp);

  void set(const std::vector<std::string> &words);
  void init();
  /* Error: other settings than those of init() ('run' with 'pre no' behind pair_style) */
  void check_prepared() const;
  /* Reads the fluid and finds the memory. STEP: and finds who takes part. MIDDLE: spheres stand elsewhere
   * than in the step, and lists stay as they are. HALF_LATER: the same, and the box moves as it will half a
   * step from now. Errors: Ambient::read; check_prepared(); a memory that has been deleted. */
  enum Moment { STEP, MIDDLE, HALF_LATER };
  void begin(Moment moment = STEP);
  /* For a step that is computed in its middle: Ambient::look_ahead */
  void look_ahead();
  /* In the first step of a run: do the spheres stand as the last run left them? */
  void new_run(bool as_left);

  void clumps();
  void solve();
  void drag();

  /* The velocities of all that takes part, from its loads, and the forces on those that are held; take() has
   * them in any order. A step without inertia is begin() and this. Where spheres interact, the memory keeps
   * the forces as the guess of the next step. drawn > 0: with the noise of draw() and the films that films()
   * has left, to this tolerance or that of the settings, whichever is larger. */
  void velocities(const Solve::ToAtom &take, const Given &known, double drawn = 0.0);

  // --- a step with noise, where spheres interact: at each place begin() and one of these, draw() first and
  // velocities() last (hydrodynamics_noise.cpp)

  void draw(const Given &known, const SolveNoise::Draw &draw);
  /* Behind draw(), at the same place: stress() of that noise alone, whose mean is 0, to this tolerance */
  void stress_of_noise(double tolerance, std::vector<double> &of_atoms);
  Moves half_step_of_points() const { return moves_of(random.of_points); }
  Moves half_step_of_films() const { return moves_of(random.of_films); }
  /* Is difference() needed, at x + W and x - W with the signs 1 and -1? */
  bool needs_differences() const { return random.needs_differences(); }
  Moves random_moves(const SolveNoise::Draw &draw) { return moves_of(random.random_moves(draw)); }
  void difference(const Given &known, double sign);
  void films(const Given &known);

  /* The rigid clumps of the last step, and which spheres are free */
  const ClumpPoses &poses() const { return clump_poses; }
  /* The sphere turns with its clump by the rotation matrix R, and so does the force on it, from
   * which the next solve begins, if there is one. */
  void turn(int i, const double R[9])
  {
    if (!settings.rigid.each_alone()) solver.guess.turn(i, R);
  }

  /* With shells, of the last step: first moments of the forces on the fluid [12 nlocal], xx yy zz xy xz yz of
   * a sphere's points, about its centre, and then of its films. Without inertia those of the points have the
   * forces that hold clumps together as well. Random forces of films are no stress: so the mean is that of
   * Bossis & Brady (compute_stokes_dynamics_stress.h). On all ranks together. */
  void stress(std::vector<double> &of_atoms);

  /* In a step that has been computed, until its end; without films, which act between two spheres and not on
   * the fluid far from them. On all ranks together. */
  FlowSources on_fluid();

  /* In a slit with flow flux: the mean pressure gradient [3] that keeps the flux at 0, in the same
   * steps; else 0. On all ranks together. */
  void pressure_gradient(double *gradient);

  bool rotation() const { return settings.scene.rotation; }
  /* Of the last step that was computed, by owned atom; zeros for those that take no part. */
  bool computed_in(double step) const
  {
    return memory && memory == FixStokesDynamicsState::find(lmp) && memory->global.last_step == step;
  }
  /* Force; behind it stand v' and the torque */
  const double *force(int i) const { return memory->rows[i] + FixStokesDynamicsState::FORCE; }
  /* nullptr without rotation */
  const double *torque(int i) const
  {
    return rotation() ? memory->rows[i] + FixStokesDynamicsState::TORQUE : nullptr;
  }
  /* -F.(v - u_inf) of one sphere, with what a strain puts into its films: >= 0 in the sum over all
   * free spheres */
  double dissipation(int i) const;
  /* That second part, of the velocities of this step */
  double strain_power(int i) const { return films_power.empty() ? 0.0 : films_power[i]; }
  /* A run goes on with the forces of the last one: finds what else outputs need. */
  void keep_forces();
  double memory_usage() const;

 private:
  Given given;
  RigidClumps rigid;
  Lubrication lubrication;
  ClumpPoses clump_poses;
  BodyScene bodies;
  Solve solver;
  SolveNoise random;
  TimeStepGuard guard;
  /* in a run: what is looked at or said once */
  Stamp prepared, looked, warned_unconverged, warned_cut;
  /* rows of those that take no part (Epochs::selection) */
  Stamp cleared;
  /* and rows of those that do, where motions are found (the same) */
  Stamp given_rows;
  /* first step of the run that the last step was of */
  LAMMPS_NS::bigint began = -1;

  /* The atoms of this rank whose forces a solve finds: all that take part, or, where rigid clumps have drags
   * each by itself, those that these have left over. The scene makes the rows of a solve of them. */
  const std::vector<int> &solved_atoms() const
  {
    return settings.rigid.each_alone() && !overdamped ? left_over : ambient.who();
  }
  std::vector<int> left_over;
  /* by rows: velocities of the spheres, as films know them */
  std::vector<double> films_v;
  /* [nlocal], or empty: of strain_power() */
  std::vector<double> films_power;

  /* do the scene's rows, and what films need around them, stand as in this step? */
  Stamp rows_stand;
  bool standing() const { return rows_stand.is(epochs.step); }

  void advance();
  void place();
  void look_at_wall();
  void stand();
  void stand_rows();
  void read_motion();
  void place_films();
  void lubricate();
  void find_films_power();
  sd_status find_forces(sd_solve_report &report);
  sd_status find_motions(const Solve::ToAtom &take, double drawn, sd_solve_report &report);
  void assemble(BodyScene::Films films = BodyScene::NO_FILMS);
  Moves moves_of(const std::vector<double> &V) const;
  void look_at_step(const sd_solve_report &report, bool preconditioned);
  void fit_shells();
  void account_for(sd_status status, const sd_solve_report &report);
  /* by rows: points of the shells as they stand now, from their centre and in space, their radii,
   * and the forces on the fluid that the last solve found */
  struct Points {
    std::vector<double> r, x, b, l;
  };
  Points points_that_stand() const;    // without forces
  Points points_of_now();
  /* S [6 rows] += first moments of forces f [3 rows] on the spheres of clumps, about the centroid */
  void add_on_members(const std::vector<double> &f, double *S) const;
  void add_moments_left(double part);
  FlowSources of_points_on_fluid();
  int algorithm() const    // of the next solve
  {
    return memory->global.diverged != 0.0 ? StokesSettings::GRADIENTS : settings.algorithm;
  }
  Voice where(int algorithm) const;
  void unconverged(sd_status status, const sd_solve_report &report);
  [[noreturn]] void failed(sd_status status, const sd_solve_report &report) const;
};

/* That of the pair style for a fix, looked up at each call, which ends the run with `lack` if there is
 * none. */
class HydrodynamicsOf {
 public:
  HydrodynamicsOf(const Voice &voice, const char *lack) : voice(voice), lack(lack) {}
  Hydrodynamics &operator()() const
  {
    Hydrodynamics *hydro = Hydrodynamics::of(voice.lmp);
    if (!hydro) voice.fail(lack);
    return *hydro;
  }

 private:
  const Voice voice;
  const char *const lack;
};

}    // namespace StokesDyn
#endif
