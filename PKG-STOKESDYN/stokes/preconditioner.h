/* Which preconditioner a scene gets, and when it is made anew. All pairs: of the whole cloud, on every rank; clumps_only without a
 * cut-off: of all clumps that this rank has a sphere of; other lists: of the parts of clumps that this rank owns. A preconditioner
 * changes the number of iterations, never the answer. */
#ifndef SD_PRECONDITIONER_H
#define SD_PRECONDITIONER_H

#include "pointers.h"
#include "scene.h"

#include "sd_choice.h"
#include "sd_precondition.h"
#include "sd_shape.h"
#include "sd_solve.h"

#include <cstring>
#include <vector>

namespace StokesDyn {

class Preconditioner : protected LAMMPS_NS::Pointers {
 public:
  enum Kind { AUTO, NONE, CLUMP, SPARSE };
  Kind kind = AUTO;
  double tolerance = 1e-3;    // of the solves
  bool warm_start = true;     // of the solves

  Preconditioner(LAMMPS_NS::LAMMPS *lmp, Scene &scene) :
      Pointers(lmp), scene(scene), sparse(), blocks()
  {
  }
  ~Preconditioner() { forget(); }
  Preconditioner(const Preconditioner &) = delete;
  Preconditioner &operator=(const Preconditioner &) = delete;

  void forget();
  /* What is kept between solves is not in restart files. The run that writes one makes it anew in its next solve, as the run that
   * reads it must, so both go on alike; and these numbers go along. */
  struct Numbers {
    sd_choice choice = {};       // auto: with or without
    double candidate = 0;        // auto: the kind that this is about
    sd_wear wear = {};           // of the sparse factor
    sd_sparse_size size = {};    // of the sparse factor, when it was last counted
    double spheres = 0;          // that the cloud had then; 0: not counted
  } numbers;
  std::vector<double> pack() const
  {
    const double *first = reinterpret_cast<const double *>(&numbers);
    return std::vector<double>(first, first + sizeof(numbers) / sizeof(double));
  }
  void unpack(const std::vector<double> &v)
  {
    if (v.size() == sizeof(numbers) / sizeof(double)) memcpy((void *) &numbers, v.data(), sizeof(numbers));
  }
  void make_anew() { worn = true; }
  /* Before a solve, after Scene::update(): makes or turns what is wanted and puts it into the system. */
  void attach(sd_system &system);
  /* After it: was it worth it, is it still good? */
  void learn(const sd_solve_report &report);
  bool attached() const { return present != NONE; }

 private:
  Scene &scene;
  Kind present = NONE;          // in this solve
  sd_costs costs = {};          // of the kind in question
  int first_iterations = -1;    // blocks: of the first solve after a set-up
  bool worn = true;             // make it anew
  bool small = true;            // are the clumps small?
  bool warm = false;            // does this solve start from the last ones?
  bool pending = false;         // blocks: to be made or turned at their first use in this solve
  bool usable = false;          // blocks: could they be made?
  bool whole =
      false;    // blocks by list: with the ghosts, which are all of a clump that others own
  const double *drag = nullptr, *spin = nullptr;    // of what apply() sees

  sd_sparse sparse;
  sd_blocks blocks;
  std::vector<sd_shape> shapes;    // of the blocks at set-up
  std::vector<double> all_drag, all_spin, in, out, near;
  std::vector<long> first;
  std::vector<int> member;
  int n = 0, width = 3;

  bool group_by_molecule(const std::vector<int64_t> &molecule, const double *a);
  void group_by_list();
  void diagonal(const sd_spheres &s);
  Kind choose(bool clumps);
  Kind choose_by_list();
  void add_up(sd_sparse_size &part);
  bool make_sparse();
  bool make_blocks();
  bool turn_blocks();
  void free_shapes();
  sd_status apply_blocks(const double *r, double *z);
  static sd_status apply(void *ctx, const double *r, double *z);
  static sd_status apply_own(void *ctx, const double *r, double *z);
  static sd_status apply_whole(void *ctx, const double *r, double *z);
};

}    // namespace StokesDyn
#endif
