/* What a solve begins from, and what it leaves for the next one: rows of the memory, which follow their
 * atoms through migration and restarts. Three kinds of numbers,
 *
 *   loads     forces of the points on the fluid; of shells those of their points, in the axes of the
 *             shell, so that they turn with it
 *   motions   where velocities are given what others add to the drag, v' = F/D - s; where loads are,
 *             with films, the velocities that were found
 *   line      the same of the solve before the last one, where the line through both is a better guess
 *
 * and one rule of how long they stand: l is of the solve of a step while Epochs::step is that of
 * keep(), by its rows; later only the memory is. */
#ifndef SD_GUESS_H
#define SD_GUESS_H

#include "body_scene.h"
#include "fix_stokes_dynamics_state.h"
#include "pointers.h"
#include "settings.h"

#include <vector>

namespace StokesDyn {

class Guess : protected LAMMPS_NS::Pointers {
 public:
  Guess(LAMMPS_NS::LAMMPS *lmp, Scene &, const BodyScene &, const Given &, const Shells &,
        const StokesSettings &);
  /* that of the step: Hydrodynamics::begin */
  FixStokesDynamicsState *memory = nullptr;

  /* By rows, as the core has them (sd_bodies_motion): forces of the points on the fluid, and with films
   * velocities of the spheres. In: a guess; out: what was found. */
  std::vector<double> l, v;

  /* Before a solve: from the memory. Returns whether there is anything to begin from. */
  bool recall();
  /* After it: to the memory. exerted [width spheres]: forces of the spheres on the fluid */
  void keep(const std::vector<double> &exerted);
  /* A sphere turns with its clump by the rotation matrix R, and so does what the next solve begins
   * from. */
  void turn(int i, const double R[9]);

  /* With shells: is l that of this step's solve? The forces of the points, of it or the last one */
  bool found_now() const { return found.is(epochs.step); }
  /* In a step that is solved elsewhere too: so it is now, though nothing is kept of it. */
  void found_in_passing() { found.take(epochs.step); }
  std::vector<double> points_now() const { return found_now() ? l : recall_points(0.0); }

 private:
  Scene &scene;
  const BodyScene &bodies;
  const Given &given;
  const Shells &shells;
  const StokesSettings &settings;
  const Epochs &epochs;
  Since found;

  size_t width() const { return settings.scene.rotation ? 6 : 3; }
  void recall_forces();
  void recall_motions();
  std::vector<double> recall_points(double line) const;
  void keep_perturbation(const std::vector<double> &exerted);
  void keep_motions();
  void keep_points();
  void turn_points(std::vector<double> &l, bool back) const;
};

}    // namespace StokesDyn
#endif
