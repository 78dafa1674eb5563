/* What noise adds to the solve of a step: a slip of the points and forces of films, drawn where the step
 * begins and kept until its solve, with what is left of the drift (sd_bodies_noise.h, sd_drifter.h). */
#ifndef SD_SOLVE_NOISE_H
#define SD_SOLVE_NOISE_H

#include "body_noise.h"
#include "body_scene.h"
#include "pointers.h"
#include "settings.h"

#include "sd_bodies_noise.h"
#include "sd_drifter.h"
#include "sd_random.h"

#include <functional>
#include <vector>

namespace StokesDyn {

class SolveNoise : protected LAMMPS_NS::Pointers {
 public:
  SolveNoise(const Voice &voice, const Scene &, Engine &, BodyScene &, const Shells &,
             const StokesSettings &);

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
   * forget(): nothing was drawn in this step. */
  void push();
  void push_alone();
  void forget();
  /* By rows: random forces of the films; empty: there is no noise */
  const std::vector<double> &forces() const { return pushed; }
  /* [6 rows], or empty: what the mean of first moments lacks */
  std::vector<double> moments_left;

  double memory_usage() const;

 private:
  const Voice voice;
  const Scene &scene;
  Engine &engine;
  BodyScene &bodies;
  const Shells &shells;
  const StokesSettings &settings;

  /* what was drawn: by rows, by spheres; what is left of the drift, likewise; A W by rows, e and kT of it */
  BodyNoise shapes;
  std::vector<double> slip, pushed, slip_left, load_left, of_moves;
  std::vector<const sd_body_follow *> follow;
  bool differs = false;
  double reach = 0.0, kT = 0.0;

  std::vector<double> numbers(const sd_random_key &of_spheres) const;
  std::vector<double> numbers_of_bodies(const sd_random_key &) const;
  void draw_slip(const Draw &draw);
  void find_followers();
  sd_drifter drifter() const { return {bodies.in_open_space().data(), follow.data()}; }
};

}    // namespace StokesDyn
#endif
