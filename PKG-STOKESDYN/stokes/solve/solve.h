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

#include "body_scene.h"
#include "films_factor.h"
#include "guess.h"
#include "pointers.h"
#include "preconditioner.h"
#include "scene.h"

#include "sd_solve.h"

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

  /* The rows of spheres that are points, for the solvers of these; of shells their drags alone count */
  sd_system system();

  /* Room of a solve, which others may use between two of them */
  std::vector<double> &idle() { return work; }

  double memory_usage() const;

 private:
  const Scene &scene;
  Engine &engine;
  BodyScene &bodies;
  FilmsFactor factor;
  Stamp found;

  /* by spheres: what system() points to; scratch of sd_bodies */
  std::vector<double> drag, spin, work;
  /* scratch of sd_solve, not filled: parts that it does not need take no memory */
  std::unique_ptr<double[]> scratch;
  size_t room = 0;

  sd_status solve_bodies(const How &how, Guess::Start start, sd_solve_report &report);
  double *make_room();
  void turn_forces();
};

}    // namespace StokesDyn
#endif
