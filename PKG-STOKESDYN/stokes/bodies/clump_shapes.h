/* The shapes of rigid clumps, each with its resistance: one catalogue, the same on all ranks. Shapes
 * are numbered from 1 on, as they come. */
#ifndef SD_CLUMP_SHAPES_H
#define SD_CLUMP_SHAPES_H

#include "callback.h"
#include "keywords.h"
#include "pointers.h"

#include "sd_body_shape.h"
#include "sd_clump.h"
#include "sd_clump_noise.h"
#include "sd_multiblob_shape.h"

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <vector>

namespace StokesDyn {

class Shells;

/* How the spheres of a clump are modelled */
struct ClumpModel {
  int shell = 1;
  /* torques and angular velocities: rotation yes, or shells */
  bool rotation = false;
};

struct ClumpShape {
  int number;
  int64_t molecule;    // of the first of its kind
  Owned<sd_shape, sd_shape_free> shape;
  Owned<sd_clump, sd_clump_free> clump;
  sd_clump_noise noise = {};
  /* made by ClumpShapes::blocks() */
  mutable Owned<sd_body_shape, sd_body_shape_free> body;
  /* made by ClumpShapes::points() */
  mutable Owned<sd_multiblob_shape, sd_multiblob_shape_free> points;
  ClumpShape(int number, int64_t molecule) : number(number), molecule(molecule) {}
};

/* Centres [3n] and radii [n] of the spheres of a clump, in order of ID */
struct ClumpGeometry {
  std::vector<double> x, a;
  int n() const { return (int) a.size(); }
};

class ClumpShapes : protected LAMMPS_NS::Pointers {
 public:
  explicit ClumpShapes(const Voice &voice) : Pointers(voice.lmp), voice(voice) {}

  void clear();
  /* What is left of a solve that ended in an error, perhaps not on all ranks. */
  void drop_unsolved();
  /* All but these numbers */
  void keep(const std::set<int> &used);

  size_t count() const { return shapes.size(); }
  const ClumpShape *at(int number) const { return shapes.at(number).get(); }
  /* The first of the shapes that spheres have, nullptr if there is none. perm: sphere k of the
   * shape is sphere perm[k] of the clump. */
  const ClumpShape *find(const ClumpGeometry &spheres, std::vector<int> &perm) const;
  static bool fits(const sd_shape &shape, const ClumpGeometry &spheres, std::vector<int> &perm);

  /* One more, of the clump of this molecule; not solved yet. Status of sd_shape_create. */
  sd_status add(int64_t molecule, const ClumpGeometry &spheres);
  /* Resistances of those that have none, shared out among the ranks and told. Errors, on all ranks:
   * one that cannot be solved. */
  void solve(const ClumpModel &model);
  [[noreturn]] void cannot_be_solved(int64_t molecule, int spheres, const ClumpModel &model,
                                     sd_status status, double need = 0.0) const;
  /* A shape in a cloud with others. Error: memory. */
  const sd_body_shape &blocks(const ClumpShape &shape, const ClumpModel &model) const;
  /* The same where all spheres are shells of points; until the shells are others than before */
  const sd_multiblob_shape &points(const ClumpShape &shape, const Shells &of) const;
  void forget_points();

  double memory_usage() const;

 private:
  const Voice voice;
  std::map<int, std::unique_ptr<ClumpShape>> shapes;    // by number
  std::multimap<double, const ClumpShape *> by_size;
  int solved = 0;    // shapes up to this number have been
  Owned<sd_shells, sd_shells_free> shells;

  void announce(const ClumpShape &s, double seconds) const;
};

}    // namespace StokesDyn
#endif
