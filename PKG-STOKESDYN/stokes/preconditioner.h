/* Which preconditioner a scene gets, and when it is made anew. All pairs: of the whole cloud,
 * shared by all ranks; clumps_only without a cut-off: of all clumps that this rank has a sphere of;
 * other lists and Ewald sums: of the parts of clumps that this rank owns, and in a periodic box
 * with the long waves. It changes the number of iterations, never the answer. */
#ifndef SD_PRECONDITIONER_H
#define SD_PRECONDITIONER_H

#include "pointers.h"
#include "scene.h"

#include "sd_choice.h"
#include "sd_precondition.h"

#include <vector>

namespace StokesDyn {

class Preconditioner : protected LAMMPS_NS::Pointers {
 public:
  enum Kind { AUTO, NONE, CLUMP, SPARSE, WAVES };
  Kind kind = AUTO;
  double tolerance = 1e-3;    // of the solves
  bool warm_start = true;     // of the solves

  Preconditioner(LAMMPS_NS::LAMMPS *lmp, Scene &scene) : Pointers(lmp), scene(scene) {}
  ~Preconditioner() { release(); }
  Preconditioner(const Preconditioner &) = delete;
  Preconditioner &operator=(const Preconditioner &) = delete;

  void forget();
  /* What is kept between solves is not in restart files. The run that writes one makes it anew in
   * its next solve, as the run that reads it must, so both go on alike; and the numbers of the
   * choice go along. */
  std::vector<double> pack() const;
  void unpack(const std::vector<double> &saved);    // others than pack() gives: as if new
  void make_anew() { place = LOST; }
  /* Before a solve, after Scene::update(): chooses, and puts what is chosen into the system. */
  void attach(sd_system &system);
  /* After it: was it worth it, is it still good? */
  void learn(const sd_solve_report &report);
  bool attached() const { return wanted != nullptr; }

 private:
  Scene &scene;
  sd_choice choice = {};
  Kind candidate = NONE;    // that the choice is about

  // of this solve
  enum { CLOUD, WHOLE_CLUMPS, OWN_PARTS } extent = CLOUD;
  sd_precondition_case seen = {};
  const sd_precondition_kind *wanted = nullptr;    // nullptr: none
  sd_cost cost = {};                               // of the kind in question; 0: there is none
  bool alone = false;                              // it says nothing of those to come

  // what is made: is it for the spheres where they stand?
  enum { LOST, ELSEWHERE, HERE } place = LOST;
  const sd_precondition_kind *made = nullptr;
  std::vector<double> state;

  std::vector<double> in, out, near;
  std::vector<long> first;
  std::vector<int> member;

  void look(const sd_system &system);
  bool group_by_molecule();
  void group_by_list();
  Kind suited();
  bool choose(Kind that, bool lost);
  /* Is what was made kept from solve to solve? */
  bool lasts() const { return extent == CLOUD || wanted == &sd_precondition_waves; }
  sd_cost cost_by_list();
  sd_cost cost_of_waves();
  void release();
  sd_status make(const sd_precondition_kind *which);
  sd_status put();
  static sd_status apply(void *ctx, const double *r, double *z);
};

}    // namespace StokesDyn
#endif
