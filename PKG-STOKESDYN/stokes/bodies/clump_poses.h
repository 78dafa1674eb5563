/* Rigid clumps as they stand in a step, and who is free: poses, what is given of the clumps and the
 * fluid at their spheres; and how each moves by itself, alone in the flow.
 *
 * A clump is moved by the rank that owns it (whole_clumps.h). */
#ifndef SD_CLUMP_POSES_H
#define SD_CLUMP_POSES_H

#include "pointers.h"
#include "rigid_clumps.h"
#include "whole_clumps.h"

#include "sd_body.h"
#include "sd_clump_motion.h"
#include "sd_squirmer.h"

#include <algorithm>
#include <functional>
#include <vector>

namespace StokesDyn {

/* What is known of the spheres of a step, and so what is asked: of all spheres the velocity, which
 * atoms have, and forces are asked; or the load, of some the velocity (held, pinned, spun), and motions
 * are. */
struct Given {
  bool velocities = false;
  /* Force and torque FT [6] on atom i. Empty: all are 0 */
  using Loads = std::function<void(int i, double *FT)>;
  Loads loads;
  /* Who is held, pinned or spun: what is known of atom i, and that of its velocity and angular
   * velocity [6]. Empty: nobody is. A clump is held, or pinned at its centroid, when all its spheres
   * are. */
  using Known = std::function<sd_body_known(int i, double *V)>;
  Known known;
  /* With shells of points, where loads are given: does atom i swim by a slip of its surface, and how?
   * Empty: nobody does */
  using Swims = std::function<bool(int i, sd_squirmer_stroke &stroke)>;
  Swims swims;

  void clear()
  {
    loads = nullptr;
    known = nullptr;
    swims = nullptr;
  }
  void load(int i, double *FT) const
  {
    if (loads)
      loads(i, FT);
    else
      std::fill_n(FT, 6, 0.0);
  }
};

class Ambient;

class ClumpPoses : protected LAMMPS_NS::Pointers {
 public:
  struct Clump {
    /* which body of rigid: nobody keeps where that is, as other settings free it */
    int number;
    /* R and the centroid c, of images side by side: x = c + R X */
    double pose[12];
    double eta;
    /* U of the centroid, W */
    double V[6];
    /* what is given: V, U alone, or neither */
    sd_body_known known;
  };

  ClumpPoses(LAMMPS_NS::LAMMPS *lmp, const WholeClumps &, const Epochs &, const Ambient &, RigidClumps &,
             const Given &);
  RigidClumps &rigid;
  const Given &given;

  /* Those of this step, by what is given. Errors, on all ranks: those of RigidClumps; a clump held
   * or pinned in part; a clump that is not rigid, or not all selected. */
  void find();
  /* That this rank owns, and atoms that are free spheres, the latter where loads are given. They are
   * those of the last find(), and none as soon as Epochs::lists is another one: settings are new, a run
   * begins, atoms have other indices */
  const std::vector<Clump> &clumps() const { return standing(all_clumps); }
  const std::vector<int> &lone() const { return standing(all_lone); }
  const RigidClumps::OwnClump &own_clump(const Clump &clump) const { return rigid.own_clump(clump.number); }
  const ClumpShape &shape(const Clump &clump) const { return *own_clump(clump).shape; }
  /* Sphere k of a clump, in the order of its shape: its number among the members of whole */
  size_t member_of(const Clump &clump, int k) const
  {
    return rigid.members()[own_clump(clump).begin + k];
  }
  sd_clump_placed placed(const Clump &clump) const
  {
    return {&shape(clump).shape, &shape(clump).clump, clump.pose, clump.eta};
  }
  /* What the spheres of a clump and the fluid at them do */
  sd_clump_motion look_at(const Clump &clump) const;
  /* [6 clumps] velocities that a solve has found */
  void moves(const double *V);

  // --- each clump by itself, by the tables of its shape

  /* From loads, what becomes of atom i, of clumps and of free spheres: velocity, and force of the
   * fluid on it, 3 numbers each, with torques 6 */
  using ToAtom = std::function<void(int i, const double *v, const double *F)>;
  void velocities(const ToAtom &take);
  /* From velocities, of clumps that move as their spheres do: calls take(i, F) for every sphere i of
   * this rank that is in one that takes part: force, with rotation torque. left_over[i] = 1: atom i belongs
   * to a loose clump, or to none (molecule 0), and is the solver's. */
  using Drag = std::function<void(int i, const double *F)>;
  void drag(const Drag &take, std::vector<char> &left_over);

  double memory_usage() const { return 24.0 * sizeof(double) * (double) spheres.eta.capacity(); }

 private:
  const WholeClumps &whole;
  const Epochs &epochs;
  const Ambient &ambient;

  Stamp found;
  std::vector<Clump> all_clumps;
  /* of who takes part (Epochs::selection) */
  std::vector<int> all_lone;
  Stamp lone_found;
  template <class T> const std::vector<T> &standing(const std::vector<T> &those) const
  {
    static const std::vector<T> nobody;
    return found.is(epochs.lists) ? those : nobody;
  }

  /* of the spheres of one clump after the other, in the order of its shape: eta (0: takes no part),
   * radius, place, velocity and angular velocity (empty: not given), fluid velocity and its gradient
   * (empty: uniform) */
  struct {
    std::vector<double> eta, radius, x, v, omega, flow, gradient;
  } spheres;
  /* [6] of each body, where loads are given: about its sphere 0 */
  std::vector<double> loads;

  /* columns of a row from an atom: of its velocities or, where loads are given, of its load, which are six as
   * well; the last two kinds where the fluid is not uniform */
  enum { ETA, RADIUS, VELOCITY, OMEGA = VELOCITY + 3, LOAD = VELOCITY, FLOW = LOAD + 6, GRADIENT = FLOW + 3,
         COLUMNS = GRADIENT + 9 };
  template <int WIDTH> void gather(const std::vector<RigidClumps::OwnClump> &all);
  void find_lone();
  void find_held();
};

}    // namespace StokesDyn
#endif
