/* Rigid clumps: which shape each clump of a scene has, and whether it still stands as that says.
 *
 * A clump keeps the shape that it was given when it was first seen, whatever rank it moves to,
 * until a run begins anew or it is not rigid any more (auto: it is loose then, the solver's, until
 * a run begins anew). Shapes are numbered alike on all ranks; in order of molecule ID, a clump that
 * has none of the shapes before it is the first of a new one. Each is solved on one rank and sent to
 * all. A clump is evaluated by the rank that owns it (whole_clumps.h). */
#ifndef SD_RIGID_CLUMPS_H
#define SD_RIGID_CLUMPS_H

#include "clump_shapes.h"
#include "pointers.h"
#include "whole_clumps.h"

#include <limits>
#include <map>
#include <set>
#include <vector>

namespace StokesDyn {

class RigidClumps : protected LAMMPS_NS::Pointers {
 public:
  struct Settings : ClumpModel {
    /* rigid_clumps yes | auto */
    bool on = false, auto_resolve = false;
    /* clumps_only: no clump feels another, and each has a table of its own forces */
    bool clumps_only = false;
    bool each_alone() const { return on && clumps_only; }
  };
  const Settings &settings;

  ClumpShapes shapes;

  RigidClumps(const Voice &voice, WholeClumps &whole, const Epochs &epochs, const Settings &settings);

  /* Other settings: no shape stands. */
  void forget();
  /* A run begins otherwise than the last one ended: every clump is looked at again, nobody is
   * loose. */
  void new_run();

  /* Molecule IDs of the clumps that are loose, two numbers each, for restart files; the same on all
   * ranks. */
  std::vector<double> loose() const;
  void set_loose(const std::vector<double> &ids);
  /* Of a restart file, if there is anything: all its atoms, and then molecule IDs, two numbers each, and
   * their atoms */
  void set_members(const std::vector<double> &numbers);
  bool any_loose() const { return !loose_molecules.empty(); }

  /* A clump of this rank's; its spheres, in the order of the shape, are begin ... begin + n - 1 of
   * members(), which are members of whole. atom: the one of them with the lowest tag, which is here */
  struct OwnClump {
    const ClumpShape *shape;
    int64_t molecule;
    int begin, n, atom;
  };
  /* All of them, looked at anew if LAMMPS has re-neighboured. Errors: one that is not rigid (yes). */
  const std::vector<OwnClump> &find();
  /* One of them, by its place there, until they are looked at anew or forgotten */
  const OwnClump &own_clump(int number) const { return bodies[number]; }
  const std::vector<int> &members() const { return member; }
  /* and back: which of members() is a member of whole, -1: it is in none of the bodies */
  const std::vector<int> &places() const { return place; }
  /* Do the spheres of a body, with these radii at x [3 n], stand as its shape says? pose [12] out */
  bool fits(const OwnClump &body, const double *radii, const double *x, double *pose) const;
  /* Molecule IDs of a clump of which not all spheres are selected, NOBODY: there is none, and of
   * those that do not fit. Returns whether these are loose now, and the bodies others; otherwise
   * errors. On all ranks together. */
  static constexpr int64_t NOBODY = std::numeric_limits<int64_t>::max();
  bool loosen(int64_t split, const std::vector<int64_t> &bent);

  double memory_usage() const;

 private:
  WholeClumps &whole;
  const Voice voice;
  const Epochs &epochs;

  struct Known {
    const ClumpShape *shape = nullptr;
    uint64_t atoms = 0;       // hash of the IDs
    std::vector<int> perm;    // sphere k of the shape is sphere perm[k] in order of ID
  };
  std::map<int64_t, Known> known;    // by molecule ID: clumps that this rank owns
  std::set<int64_t> loose_molecules;
  /* in a restart file, until clumps have been looked at: all atoms, and those of each molecule */
  LAMMPS_NS::bigint atoms_in_file = 0;
  std::map<int64_t, int> members_in_file;
  /* the members for which they have been (Epochs::members) */
  Stamp recognised;

  /* since the last re-neighbouring */
  std::vector<OwnClump> bodies;
  std::vector<int> member, place;

  std::vector<double> radius;    // by members

  void recognise();
  uint64_t atoms_of(const WholeClumps::Clump &clump) const;
  ClumpGeometry geometry(const WholeClumps::Clump &clump) const;
  void take_over(std::vector<size_t> &unknown);
  std::vector<int64_t> smaller_than_in_file();
  void find_shapes(std::vector<size_t> unknown);
  void accept(const std::vector<double> &candidates);
  void drop_unused();
  void arrange();
  void loosen(const std::vector<int64_t> &molecules);
  void let_go(const std::vector<int64_t> &mine, void (RigidClumps::*tell)(int64_t) const);
  [[noreturn]] void not_rigid(int64_t molecule) const;
  [[noreturn]] void other_atoms(int64_t molecule) const;
  bool must_stay_rigid() const;
};

}    // namespace StokesDyn
#endif
