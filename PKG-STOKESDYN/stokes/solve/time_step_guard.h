/* Watches the time step: explicit steps of free spheres under this drag are stable up to a limit.
 *
 * Spheres that are let go obey W dU/dt = -R U, with the inertia W (mass, and 2/5 m a^2 for spin)
 * and the resistance R = M^-1. Velocity Verlet computes the drag from the velocity at half step,
 * so that
 *
 *   U(t + dt/2) = (1 - dt W^-1 R) U(t - dt/2):   stable for dt < 2 mu,   M F = mu W^-1 F
 *
 * with the smallest eigenvalue mu, which is no larger than any m/(6 pi eta a), nor, with rotation,
 * than three tenths of it, the time in which a sphere alone loses its spin. It is told as the
 * factor lambda in
 *
 *   limit = 2 mu = 2 lambda m/(6 pi eta a),   the smallest m/(6 pi eta a) of all free spheres
 *
 * For equal spheres without rotation that is the smallest eigenvalue of the mobility scaled to unit
 * diagonal.
 *
 * It is computed by solves and products of its own. What a solve has for nothing (the times of lone
 * spheres, curvatures and Ritz values of conjugate gradients) bounds it from above alone: in
 * test_time_step_guard.py that is 1.5 to 35 times too large, and steps in which velocities grow 1e5 to
 * 1e7 times in 40 steps would go without a warning. */
#ifndef SD_TIME_STEP_GUARD_H
#define SD_TIME_STEP_GUARD_H

#include "keywords.h"
#include "pointers.h"

#include "sd_lubrication.h"
#include "sd_solve.h"

#include <functional>
#include <vector>

namespace StokesDyn {

class Scene;

class TimeStepGuard : protected LAMMPS_NS::Pointers {
 public:
  explicit TimeStepGuard(const Voice &voice) : Pointers(voice.lmp), voice(voice) {}

  /* Kept from run to run, the same on all ranks. */
  struct State {
    /* lambda of the limit; 0: unknown */
    double lambda_min = 0;
    /* count of solves when the limit is to be computed again */
    double due = 0;
    /* 2 mu where the time step is near it, else an upper bound of that; 0: unknown, or nobody is
     * free */
    double limit = 0;
  } state;

  /* After solve number `solves`, of conjugate gradients, by the rows of the scene: looks at the time
   * step, and warns once if it is too long. */
  void look(const sd_system &system, const sd_solve_report &report, const Scene &scene,
            bool preconditioned, double solves);

  /* R v of spheres whose resistance is a solve of its own, [6 n] in and out: shells of points */
  using Resist = std::function<sd_status(const double *v, double *Rv)>;
  /* The same of those; system: the drags of spheres alone */
  void look_at_shells(const sd_system &system, const Resist &resist, const Scene &scene, double solves);

  /* Lubrication has a limit of its own, told once a run: the spheres where they stand now, rows as
   * in look(). Warns once if the time step is above it. */
  void look_at_films(sd_lubrication &near, const Scene &scene);

 private:
  const Voice voice;
  bool warned = false, warned_of_films = false;

  /* W D^-1, the times in which spheres alone lose their velocity or spin: the shortest and the
   * shortest of velocities of those that are free (INFINITY: nobody is), and the longest of all.
   * weight, if wanted: [width n] inertia of each row over the shortest of them, which makes it a
   * drag */
  struct Times {
    double shortest, of_velocity, longest;
  };
  Times weigh(const sd_system &system, const Scene &scene, std::vector<double> *weight);
  std::vector<char> held_atoms() const;
  /* by rows, three each: force over acceleration of velocity and of spin, is it held? */
  std::vector<double> inertia(const Scene &scene) const;
  double compute(const sd_system &system, const Scene &scene);
  double compute_of_shells(const sd_system &system, const Resist &resist, const Scene &scene);
  void conclude(const sd_system &system, const Scene &scene, double lambda, double solves,
                const std::function<double()> &compute_mu);
  void compare(double of_velocity);
};

}    // namespace StokesDyn
#endif
