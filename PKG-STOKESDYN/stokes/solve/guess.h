/* What a solve begins from, and what it leaves for the next one: rows of the memory, which follow their
 * atoms through migration and restarts. What is kept depends on what a solve was asked,
 *
 *   FORCES    what others add to the drag, v' = F/D - s, of the last two solves
 *   MOTIONS   with films the velocities that were found, less those of the fluid; where spheres are points,
 *             their forces; of the last two solves
 *   of both   where spheres are shells the forces of their points on the fluid, of the last two solves, in
 *             the axes of the shell, so that they turn with it
 *
 * and stands for as long as one number does, that of all that it follows from: number(). */
#ifndef SD_GUESS_H
#define SD_GUESS_H

#include "body_scene.h"
#include "fix_stokes_dynamics_state.h"
#include "pointers.h"
#include "settings.h"

#include "sd_guess.h"

#include <cstdint>
#include <vector>

namespace StokesDyn {

class Guess : protected LAMMPS_NS::Pointers {
 public:
  /* Of all spheres forces, from their velocities; motions, from loads; or these with new random numbers,
   * which leave nothing to begin from and are no guess of anything */
  enum Question { FORCES, MOTIONS, NOISY_MOTIONS };

  /* l: forces of the points on the fluid, v: with films velocities of the spheres, else empty; both by rows,
   * as the core has them (sd_bodies_answer); zeros unless the solve is to begin from them, warm */
  struct Start {
    bool warm;
    std::vector<double> l, v;
  };

  /* l and v of the answer, and forces of the spheres on the fluid with films, by rows */
  struct Found {
    const std::vector<double> &l, &v, &exerted;
  };

  Guess(LAMMPS_NS::LAMMPS *lmp, const Scene &, const Engine &, const BodyScene &, const Shells &,
        const StokesSettings &);
  /* that of the step: Hydrodynamics::begin */
  FixStokesDynamicsState *memory = nullptr;

  /* Before a solve: from the memory, if it stands. room: of an l that nobody needs any more */
  Start recall(Question asked, std::vector<double> room = {}) const;
  /* Nothing to begin from */
  Start none(std::vector<double> room = {}) const;
  /* After it: to the memory */
  void keep(Question asked, const Found &);
  /* A sphere turns with its clump by the rotation matrix R, and so does what the next solve begins
   * from. */
  void turn(int i, const double R[9]);

  /* Of shells, forces of the points as the last solve left them, whatever it was asked */
  std::vector<double> points_of_last_solve() const { return recall_points(0.0); }

 private:
  const Scene &scene;
  const Engine &engine;
  const BodyScene &bodies;
  const Shells &shells;
  const StokesSettings &settings;

  /* Are guesses of motions on lines through two answers? */
  bool lines() const { return memory->lines || memory->shell_points > 0; }
  sd_guess_answers answers(double kept) const;
  void choose(const sd_guess_answers &found, double kept);
  /* 1: the next guess is on it; 0: it is the last answer */
  double line() const;
  size_t width() const { return scene.width(); }
  uint64_t number(Question asked) const;
  double solves_kept(Question asked) const;
  std::vector<double> recall_forces() const;
  std::vector<double> recall_motions() const;
  std::vector<double> recall_points(double line, std::vector<double> room = {}) const;
  void keep_perturbation(const std::vector<double> &exerted);
  void keep_motions(const std::vector<double> &v, double kept);
  std::vector<double> recall_spheres(double line) const;
  void keep_spheres(const std::vector<double> &l, double kept);
  void keep_points(const std::vector<double> &l, double kept);
  void turn_points(size_t k, int n, bool back, double *l) const;
};

}    // namespace StokesDyn
#endif
