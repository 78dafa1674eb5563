/* Which preconditioner a scene gets, and when it is made anew. All pairs: of the whole cloud, on every rank; lists: of the clumps that
 * this rank owns whole or in part. A preconditioner changes the number of iterations, never the answer. */
#ifndef SD_PRECONDITIONER_H
#define SD_PRECONDITIONER_H

#include "pointers.h"
#include "scene.h"

#include "sd_precondition.h"
#include "sd_shape.h"
#include "sd_solve.h"

#include <vector>

namespace StokesDyn {

class Preconditioner : protected LAMMPS_NS::Pointers {
 public:
  enum Kind { AUTO, NONE, CLUMP, SPARSE };
  Kind kind = AUTO;

  Preconditioner(LAMMPS_NS::LAMMPS *lmp, Scene &scene) :
      Pointers(lmp), scene(scene), sparse(), blocks()
  {
  }
  ~Preconditioner() { forget(); }
  Preconditioner(const Preconditioner &) = delete;
  Preconditioner &operator=(const Preconditioner &) = delete;

  void forget();
  /* What is kept between solves is not in restart files. The run that writes one makes it anew in its next solve, as the run that
   * reads it must, so both go on alike; and these counts go along. */
  void make_anew() { worn = true; }
  void save(double spent[3]) const;
  void restore(const double spent[3]);
  /* Before a solve, after Scene::update(): makes or turns what is wanted and puts it into the system. */
  void attach(sd_system &system);
  /* After it: was it worth it, is it still good? */
  void learn(const sd_solve_report &report);
  bool attached() const { return present != NONE; }

 private:
  Scene &scene;
  Kind present = NONE;           // in this solve
  bool wanted_sparse = false;    // auto: enough iterations have been spent to pay for a factor
  long iterations_spent = 0, solves = 0;
  int first_iterations = -1;    // of the first solve after a set-up
  bool worn = true;             // make it anew
  bool small = true;            // are the clumps small?
  bool pending = false;         // blocks: to be made or turned at their first use in this solve
  bool usable = false;          // blocks: could they be made?
  const double *drag = nullptr, *spin = nullptr;    // of what apply() sees

  sd_sparse sparse;
  sd_blocks blocks;
  std::vector<sd_shape> shapes;    // of the blocks at set-up
  std::vector<double> cloud_drag, cloud_spin, in, out, whole;
  std::vector<long> first;
  std::vector<int> member;
  int n = 0, width = 3;

  bool group_by_molecule(const std::vector<int64_t> &molecule, const double *a);
  void cloud_diagonal();
  bool make_sparse();
  bool make_blocks();
  bool turn_blocks();
  void free_shapes();
  void apply_blocks(const double *r, double *z);
  static void apply(void *ctx, const double *r, double *z);
  static void apply_own(void *ctx, const double *r, double *z);
};

}    // namespace StokesDyn
#endif
