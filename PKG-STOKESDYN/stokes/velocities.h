/* Velocities of spheres and rigid clumps without inertia, from the forces and torques on them: the
 * atoms of a step to the core's bodies (sd_bodies.h) and back.
 *
 *   find()                     the clumps, where they stand now
 *   together() or apart()      velocities of all: each other's, or each clump alone in the flow
 *
 * A clump that crosses ranks is moved by every rank that owns one of its spheres, from the same
 * numbers. */
#ifndef SD_VELOCITIES_H
#define SD_VELOCITIES_H

#include "ambient.h"
#include "lubrication.h"
#include "pointers.h"
#include "rigid_clumps.h"
#include "scene.h"

#include "sd_bodies.h"
#include "sd_tie.h"

#include <functional>
#include <vector>

namespace StokesDyn {

class Velocities : protected LAMMPS_NS::Pointers {
 public:
  struct Clump {
    const RigidClumps::Body *body;
    /* R and the centroid c, of images side by side: x = c + R X */
    double pose[12];
    double eta;
    /* U of the centroid, W */
    double V[6];
  };
  /* of which this rank owns a sphere, since the last find() */
  std::vector<Clump> clumps;
  /* atoms that are free spheres */
  std::vector<int> lone;
  /* as of RigidClumps */
  const std::vector<int> &members() const { return rigid.members(); }
  const std::vector<int> &owns() const { return rigid.owns(); }

  struct Parts {
    Scene &scene;
    Ambient &ambient;
    RigidClumps &rigid;
    Lubrication &lubrication;
  };
  Velocities(LAMMPS_NS::LAMMPS *lmp, const Parts &parts);
  ~Velocities();
  Velocities(const Velocities &) = delete;
  Velocities &operator=(const Velocities &) = delete;

  /* Errors, on all ranks: those of RigidClumps; a clump that is not rigid, or not all selected. */
  void find();

  /* What becomes of atom i: velocity, with torques angular velocity, and force of the fluid on it,
   * with torque: v and F [width] */
  using Take = std::function<void(int i, const double *v, const double *F)>;
  /* Each clump alone in the flow, and the free spheres */
  void apart(int width, const Take &take);
  /* Where the next solve may begin: by rows, which are the atoms that take part, [width n] forces
   * on the fluid and, with lubrication, the velocities that go with them */
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
  };
  sd_status together(const How &how, Guess &guess, const Take &take, sd_bodies_report &report);

  /* The same bodies where velocities are given: forces F [width n] of the fluid on the spheres that
   * take part, from their slip [width n]; warm: F holds a guess */
  sd_status resist(const How &how, const std::vector<double> &slip, std::vector<double> &F,
                   sd_bodies_report &report);

  double memory_usage() const;

 private:
  Scene &scene;
  Ambient &ambient;
  RigidClumps &rigid;
  Lubrication &lubrication;
  sd_tie tie = {};

  /* [nlocal] row of an atom, -1: takes no part */
  std::vector<int> row_of;
  /* does a clump cross ranks, anywhere? */
  bool across = false;
  /* for which `lone` and `across` have been found: re-neighbouring, and who is selected */
  long arranged = -1, selection = -1;
  /* of ghosts, columns: eta (0: takes no part), force and torque, fluid velocity and its gradient
   */
  std::vector<double> ghosts;
  int columns = 1;

  /* for the core, by rows, by clumps, by spheres of clumps */
  std::vector<double> F, u, v, exerted, D, arm, V, work, gradient;
  std::vector<int> member, whole, loner;
  std::vector<sd_body> shaped;
  /* where nobody sees anybody */
  sd_mobility_scene alone = {};

  void part_lone();
  void gather_ghosts();
  const double *ghost(int j) const { return &ghosts[(size_t) columns * (j - atom->nlocal)]; }
  void place(int width);
  void arrange();
  void flow_over(const Clump &clump, double u[3], double G[9]);
  void load_on(const Clump &clump, double load[6]) const;
  void drag_on(const Clump &clump, const double fluid[3], const double G[9], double *F,
               double *T) const;
  sd_bodies bodies(int width);
  void carry(const sd_bodies &A, double *flow);
  sd_status solve(const sd_bodies &A, const How &how, const sd_bodies_problem &problem,
                  Guess &guess, sd_bodies_report &report);
};

}    // namespace StokesDyn
#endif
