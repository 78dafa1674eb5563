/* Velocities of spheres and rigid clumps without inertia, from the forces and torques on them: the
 * atoms of a step to the core's bodies (sd_bodies.h) and back.
 *
 *   find()                     the clumps, where they stand now
 *   together() or apart()      velocities of all: each other's, or each clump alone in the flow
 *
 * A clump is moved by the rank that owns it (whole_clumps.h). */
#ifndef SD_VELOCITIES_H
#define SD_VELOCITIES_H

#include "ambient.h"
#include "lubrication.h"
#include "pointers.h"
#include "rigid_clumps.h"
#include "scene.h"

#include "sd_bodies.h"
#include "sd_bodies_noise.h"
#include "sd_clump_motion.h"
#include "sd_random.h"
#include "sd_tie.h"

#include <deque>
#include <functional>
#include <vector>

namespace StokesDyn {

class Velocities : protected LAMMPS_NS::Pointers {
 public:
  struct Clump {
    /* which body of rigid: nobody keeps where that is, as other settings free it */
    int number;
    /* R and the centroid c, of images side by side: x = c + R X */
    double pose[12];
    double eta;
    /* U of the centroid, W */
    double V[6];
    /* is V given, and the force on it unknown? */
    bool held;
  };
  /* That this rank owns, and atoms that are free spheres. They are those of the last find(), and none
   * as soon as Epochs::lists is another one: settings are new, a run begins, atoms have other indices */
  const std::vector<Clump> &clumps() const { return stands() ? all_clumps : no_clumps; }
  const std::vector<int> &lone() const { return stands() ? all_lone : nobody_lone; }
  bool stands() const { return found.is(scene.since().lists); }
  const RigidClumps::Body &body(const Clump &clump) const { return rigid.body(clump.number); }
  const ClumpShape &shape(const Clump &clump) const { return *body(clump).shape; }
  /* Sphere k of a clump, in the order of its shape: its number among the members of whole */
  size_t member_of(const Clump &clump, int k) const
  {
    return rigid.members()[body(clump).begin + k];
  }

  struct Parts {
    Scene &scene;
    Ambient &ambient;
    RigidClumps &rigid;
    Lubrication &lubrication;
  };
  Velocities(LAMMPS_NS::LAMMPS *lmp, const Parts &parts);

  /* Who is held, or spun: what is known of atom i, and that of its velocity and angular velocity [6].
   * Empty: nobody is. A clump is held when all its spheres are. */
  using Held = std::function<sd_body_known(int i, double *V)>;
  Held held;
  /* [6 nlocal] force and torque on each atom, from which velocities follow; empty: all are 0 */
  std::vector<double> loads;

  /* Errors, on all ranks: those of RigidClumps; a clump held in part; a clump that is not rigid, or
   * not all selected. moving: drag() is to follow, not velocities. */
  void find(bool moving = false);

  /* With shells of points: those of clumps turn with them. The rows of the scene stand. */
  void orient();

  /* What becomes of atom i: velocity, with torques angular velocity, and force of the fluid on it,
   * with torque: v and F [width] */
  using Take = std::function<void(int i, const double *v, const double *F)>;
  /* Each clump alone in the flow, and the free spheres */
  void apart(int width, const Take &take);
  /* The other way round, of clumps that move as their spheres do: calls take(i, F) for every sphere i
   * of this rank that is in one that takes part: force, with rotation torque.
   * loose[i] = 1: atom i belongs to a loose clump, or to none (molecule 0), and is the solver's.
   * Finds them itself, with the errors of find(). */
  using Drag = std::function<void(int i, const double *F)>;
  void drag(const Drag &take, std::vector<char> &loose);
  /* Random forces of covariance R, the resistance of all bodies with their films
   * (sd_bodies_noise.h), times `scale`, and what becomes of them: forces and torques F [width] on
   * atom i */
  struct Draw {
    sd_bodies_noise *noise;
    sd_random_key of_spheres, of_films;
    double tolerance, scale;
    std::function<void(int i, const double *F)> take;
    /* the process ends so; a failure must not come back */
    std::function<void(sd_status status, const sd_noise_report &report)> report;
  };
  /* Where the next solve may begin: by rows, which are the atoms that take part, [width n] forces
   * on the fluid, with shells those of their points, and, with lubrication, the velocities that go
   * with them */
  struct Guess {
    std::vector<double> l, v;
  };
  /* All together, from a guess if there is one (warm). scene has been updated. SD_OK or the core's.
   */
  struct How {
    int width;
    bool warm;
    double tolerance;
    int max_iter;
    /* with shells: a fluid that does not strain, whatever the ambient one does */
    bool unstrained = false;
    /* random forces beside the loads; nullptr: none */
    const Draw *draw = nullptr;
  };
  sd_status together(const How &how, Guess &guess, const Take &take, sd_bodies_report &report);

  /* The same bodies where velocities are given: forces F [width n] of the fluid on the spheres that
   * take part, from their slip [width n]; warm: F holds a guess, with shells guess.l */
  sd_status resist(const How &how, const std::vector<double> &slip, Guess &guess,
                   std::vector<double> &F, sd_bodies_report &report);

  /* With shells, after velocities were found: S [6 rows] += first moments of what keeps the spheres
   * of clumps together; velocities of the rows, those of the images that they stand for */
  void add_constraints(double *S) const;
  const double *last_velocities() const { return moved_with.data(); }

  double memory_usage() const;

 private:
  Scene &scene;
  Ambient &ambient;
  RigidClumps &rigid;
  Lubrication &lubrication;
  Owned<sd_tie, sd_tie_free> tie;

  Since found;
  std::vector<Clump> all_clumps;
  std::vector<int> all_lone;
  const std::vector<Clump> no_clumps;
  const std::vector<int> nobody_lone;

  /* of the spheres of one clump after the other, in the order of its shape: eta (0: takes no part),
   * radius, place, force and torque or velocity and angular velocity, fluid velocity and its
   * gradient (empty: uniform) */
  struct {
    std::vector<double> eta, radius, x, motion, turning, flow, gradient;
  } spheres;

  /* for the core, by rows, by clumps, by spheres of clumps */
  std::vector<double> F, u, v, exerted, D, arm, V, work, gradient;
  std::vector<int> member, whole, loner;
  /* with shells, by points: sphere, from its centre; by spheres: gradient of the flow, and its
   * second derivatives or nothing */
  std::vector<int> sphere;
  std::vector<double> r, slope, bend, moved_with;
  sd_multiblob_mobility of_points = {};
  sd_faces faces = {};
  std::vector<char> whole_shells;
  /* [bodies] of the solve: sd_body_known */
  std::vector<char> is_held;
  std::vector<sd_body> shaped;
  /* the same in open space, whatever wall they stand at */
  std::vector<sd_body> in_open_space;
  /* where nobody sees anybody */
  sd_mobility_scene alone = {};

  double load(int i, size_t d) const { return loads.empty() ? 0.0 : loads[6 * (size_t) i + d]; }
  void gather(bool moving);
  void find_held();
  std::vector<double> given_velocities();
  void place(int width);
  void arrange();
  sd_clump_motion look_at(const Clump &clump) const;
  sd_bodies bodies(int width);
  sd_bodies assemble(int width);
  void place_shells();
  void slip_at_points(const double *slip);
  /* near a wall: blocks of the bodies where they stand */
  std::deque<Owned<sd_body_shape, sd_body_shape_free>> standing;
  void stand_at_wall();
  sd_status stand_at_wall(sd_body &body, double bodies);
  std::vector<int> spheres_of(const sd_body &body) const;
  sd_bodies bodies_of_shells();
  void flow_at_points(const double *velocity, int stride, double *out) const;
  void carry(const sd_bodies &A, double *flow);
  void draw_forces(const sd_bodies &A, int width, const Draw &draw);
  sd_status solve(const sd_bodies &A, const sd_bodies_problem &problem, Guess &guess,
                  sd_bodies_report &report);
};

}    // namespace StokesDyn
#endif
