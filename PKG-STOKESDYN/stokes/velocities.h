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
#include "pointers.h"
#include "rigid_clumps.h"
#include "scene.h"

#include "sd_bodies.h"

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

  Velocities(LAMMPS_NS::LAMMPS *lmp, Scene &scene, Ambient &ambient, RigidClumps &rigid);

  /* Errors, on all ranks: those of RigidClumps; a clump that is not rigid, or not all selected. */
  void find();

  /* Of rows, which are the atoms that take part: forces on the fluid, l [width n], a guess in if
   * there is one (warm), and velocities, v [width n]. */
  struct Rows {
    int width;
    std::vector<double> l, v;
  };
  /* scene: has been updated. SD_OK or the core's. */
  sd_status together(Rows &rows, bool warm, double tolerance, int max_iter,
                     sd_bodies_report &report);
  void apart(Rows &rows);

  double memory_usage() const;

 private:
  Scene &scene;
  Ambient &ambient;
  RigidClumps &rigid;

  /* [nlocal] row of an atom, -1: takes no part */
  std::vector<int> row_of;
  /* does a clump cross ranks, anywhere? */
  bool across = false;
  /* of ghosts, columns: eta (0: takes no part), force and torque, fluid velocity and its gradient
   */
  std::vector<double> ghosts;
  int columns = 1;

  /* for the core, by rows, by clumps, by spheres of clumps */
  std::vector<double> F, u, drag, spin, work;
  std::vector<double> R, eta, V, gradient;
  std::vector<int> first, member, loner;
  std::vector<const sd_body_shape *> shape;

  void gather_ghosts();
  const double *ghost(int j) const { return &ghosts[(size_t) columns * (j - atom->nlocal)]; }
  void place(int width);
  void arrange();
  void flow_over(const Clump &clump, double u[3], double G[9]);
  void load_on(const Clump &clump, double load[6]) const;
  sd_bodies bodies(int width);
};

}    // namespace StokesDyn
#endif
