/* The solve of a step: finds loads and motions of bodies with their films, by an engine and a preconditioner,
 * from what the memory holds of the last one.
 *
 *   run             bodies, and what is known of each: its load, its velocity, or of one that is spun some
 *                   of both (sd_bodies.h)
 *   substitution    algorithm 1 of the page, of points whose velocities are given (sd_solve.h)
 *   gradients       algorithm 2 of the same. Bodies that are all held have the same forces, but take 1.04 to
 *                   2.5 times the products to the residual that the page promises
 *                   (unittest/bench/bench_resting.c), and no preconditioner but their own */
#ifndef SD_STOKES_SOLVE_H
#define SD_STOKES_SOLVE_H

#include "body_noise.h"
#include "body_scene.h"
#include "films_factor.h"
#include "guess.h"
#include "pointers.h"
#include "preconditioner.h"
#include "scene.h"

#include "sd_bodies_noise.h"
#include "sd_drifter.h"
#include "sd_random.h"
#include "sd_solve.h"

#include <functional>
#include <memory>
#include <vector>

namespace StokesDyn {

class Solve : protected LAMMPS_NS::Pointers {
 public:
  Solve(LAMMPS_NS::LAMMPS *lmp, const Scene &, Engine &, BodyScene &, const Shells &, const StokesSettings &);
  Preconditioner preconditioner;
  Guess guess;

  struct How {
    /* the guess is of that */
    Guess::Question asked;
    double tolerance;
    int max_iter;
  };
  /* The bodies have been placed; for run() assembled too. SD_OK or the core's. */
  sd_status run(const How &how, sd_solve_report &report);
  sd_status substitution(const How &how, sd_solve_report &report);
  sd_status gradients(const How &how, sd_solve_report &report);
  /* What was found to the memory */
  void keep(Guess::Question asked) { guess.keep(asked, {l, v_with_l, exerted}); }
  /* [width spheres] forces on spheres that move so in a fluid at rest, within 1 %. What the last solve has
   * found stays. */
  sd_status resist(const double *motions, int max_iter, double *forces);

  /* What was found: [width spheres] forces on the fluid, films included; velocities of the spheres (of
   * the images that the rows stand for), and [6 bodies] */
  std::vector<double> exerted, v, V;
  /* Of run(): forces of the points on the fluid, and with films the velocities of the spheres that go with
   * them in a guess */
  std::vector<double> l, v_with_l;
  /* Are they of this step? With shells: forces of the points, of this step or of the last solve */
  bool found_now() const { return found.is(scene.all_epochs().step); }
  std::vector<double> points_now() const { return found_now() ? l : guess.points_of_last_solve(); }
  /* What becomes of atom i: velocity, with torques angular velocity, and force of the fluid on it,
   * with torque: v and F [width] */
  using ToAtom = ClumpPoses::ToAtom;
  void hand_out(const ToAtom &take) const;

  // --- noise: a slip of the points and forces of films, as they are kept for the solve of a step

  struct Draw {
    sd_bodies_noise *noise;
    /* numbers of the points, of films, of waves, of differences */
    sd_random_key of_spheres, of_films, of_waves, of_differences;
    /* that of the root; sqrt(2 kT/dt); kT; over the drag of a sphere, how far differences go */
    double tolerance, scale, kT;
    /* the process ends so, and of which matrix the root is; a failure must not come back */
    std::function<void(sd_status status, const sd_noise_report &report, bool divided)> report;
    /* the near part is not positive, and the root is that of the whole matrix */
    std::function<void()> not_positive;
  };
  /* Random slip y of covariance 2 kT/dt M' (sd_bodies_noise.h) and forces of films, where the bodies stand
   * and are tied; and the half steps of sd_drifter.h: velocities [6 bodies]. On all ranks together. */
  void draw(const Draw &draw);
  std::vector<double> of_points, of_films;
  /* After draw(): is there a part of the drift that the mean of one solve lacks? The same on all ranks. It is
   *   slip    kT sum_k (d_k M') A_k  =  <[M'(x + e W) - M'(x - e W)] A W> kT/(2 e)
   *   torque -kT sum_k (d_k K)^T A_k    likewise,      W [6 bodies] random, of variance 1 or e
   * random_moves() gives e W. difference(sign) adds what bodies show that have been assembled at
   * x + sign e W. forces_of_moves() is A W [points] and part() is kT/(2 e), for the stress, which lacks
   * something as well. */
  bool needs_differences() const { return differs; }
  std::vector<double> random_moves(const Draw &draw);
  void difference(double sign);
  const std::vector<double> &forces_of_moves() const { return of_moves; }
  double part() const { return kT / (2.0 * reach); }
  /* When the bodies have been assembled for the solve. push(): what was drawn, and the rest of the drift, is
   * added to their flow and loads; push_alone(): it takes the place of these, in a fluid at rest;
   * forget_noise(): nothing was drawn in this step. */
  void push();
  void push_alone();
  void forget_noise() { pushed.clear(); }
  /* [width spheres] random forces of the films; empty: there is no noise */
  const std::vector<double> &random_forces() const { return pushed; }

  /* The rows of spheres that are points, for the solvers of these; of shells their drags alone count */
  sd_system system();

  /* Room of a solve, which others may use between two of them */
  std::vector<double> &idle() { return work; }

  double memory_usage() const;

 private:
  const Scene &scene;
  Engine &engine;
  BodyScene &bodies;
  const Shells &shells;
  const StokesSettings &settings;
  FilmsFactor factor;
  Stamp found;

  /* by spheres: what system() points to; scratch of sd_bodies */
  std::vector<double> drag, spin, work;
  /* what was drawn: by rows, by spheres; what is left of the drift, likewise; A W by rows, e and kT of it */
  BodyNoise shapes;
  std::vector<double> slip, pushed, slip_left, load_left, of_moves;
  std::vector<const sd_body_follow *> follow;
  bool differs = false;
  double reach = 0.0, kT = 0.0;
  /* scratch of sd_solve, not filled: parts that it does not need take no memory */
  std::unique_ptr<double[]> scratch;
  size_t room = 0;

  sd_status solve_bodies(const How &how, Guess::Start start, sd_solve_report &report);
  double *make_room();
  void turn_forces();
  std::vector<double> numbers(const sd_random_key &of_spheres) const;
  std::vector<double> numbers_of_bodies(const sd_random_key &) const;
  void draw_slip(const Draw &draw);
  void find_followers();
  sd_drifter drifter() const { return {bodies.in_open_space().data(), follow.data()}; }
};

}    // namespace StokesDyn
#endif
