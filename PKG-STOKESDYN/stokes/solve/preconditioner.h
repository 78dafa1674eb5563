/* Which preconditioner a scene gets, by a rule: the long waves in a periodic box with Ewald sums;
 * where the sum goes over all pairs the sparse factor, or, of few spheres, the inverse itself, or
 * nothing where solves are easy; blocks of molecules for other sums. It changes the number of
 * iterations, never the answer.
 *
 * It is made at positions that are rows of the memory, and those are taken anew where spheres have
 * moved too far since (sd_preconditioner.h), where one has none yet, and where waves are those of
 * another box. So the same preconditioner is there after a restart and on other ranks.
 *
 * All pairs: of the whole cloud, shared by all ranks; else of this rank's rows, which hold whole
 * clumps where clumps must be whole, and otherwise parts. */
#ifndef SD_PRECONDITIONER_GLUE_H
#define SD_PRECONDITIONER_GLUE_H

#include "engine.h"
#include "fix_stokes_dynamics_state.h"
#include "pointers.h"
#include "scene.h"
#include "settings.h"

#include "sd_preconditioner.h"

#include <vector>

namespace StokesDyn {

class Preconditioner : protected LAMMPS_NS::Pointers {
 public:
  Preconditioner(LAMMPS_NS::LAMMPS *lmp, const Scene &scene, Engine &engine, const StokesSettings &settings) :
      Pointers(lmp), scene(scene), engine(engine), settings(settings)
  {
  }

  void forget() { sd_preconditioner_free(&made); }
  /* Before a solve, after Engine::place(): puts the one that suits the scene into the system. It is
   * made at its first use, since a warm start often needs none at all. */
  void attach(sd_system &system, FixStokesDynamicsState &memory);
  bool attached() const { return wanted != nullptr; }
  double memory_usage() const;

 private:
  const Scene &scene;
  Engine &engine;
  const StokesSettings &settings;
  const sd_precondition_kind *wanted = nullptr;    // nullptr: none
  Owned<sd_preconditioner, sd_preconditioner_free> made;

  // of this solve
  Stamp put_in;
  FixStokesDynamicsState *memory = nullptr;

  std::vector<double> x, in, out;
  std::vector<long> first;
  std::vector<int> member;

  const sd_precondition_kind *suited() const;
  /* so few spheres that the inverse of the whole cloud's matrix is made, one block? */
  bool few() const;
  /* is it of the spheres of all ranks? how many it is of, and these */
  bool of_all() const { return engine.view() == SD_VIEW_ALL; }
  int count() const { return of_all() ? engine.cloud.size() : scene.size(); }
  sd_spheres spheres() const { return of_all() ? engine.cloud.spheres() : scene.local(); }
  void refresh_places();
  void find_positions();
  void group();
  void group_by_molecule();
  void add_lone();
  void put_side_by_side();
  sd_status put();
  static sd_status apply(void *ctx, const double *r, double *z);
};

}    // namespace StokesDyn
#endif
