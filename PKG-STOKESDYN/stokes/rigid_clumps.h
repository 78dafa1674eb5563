/* Rigid clumps: the shapes of a scene, each with its resistance, and the forces of every step from pose and slip motion.
 *
 * Shapes are numbered alike on all ranks, the first of a kind being the one of lowest molecule ID; each is solved on one rank and sent
 * to all. A clump that crosses ranks is evaluated by every rank that owns one of its spheres, from the same numbers. */
#ifndef SD_RIGID_CLUMPS_H
#define SD_RIGID_CLUMPS_H

#include "pointers.h"
#include "scene.h"

#include "sd_clump.h"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace StokesDyn {

class RigidClumps : protected LAMMPS_NS::Pointers {
 public:
  struct Settings {
    bool on = false, auto_resolve = false;    // rigid_clumps yes | auto
    int shell = 1;
    bool rotation = false;    // torques and angular velocities: rotation yes, or shells
  } settings;

  RigidClumps(LAMMPS_NS::LAMMPS *lmp, Scene &scene, const std::string &command);
  ~RigidClumps();
  RigidClumps(const RigidClumps &) = delete;
  RigidClumps &operator=(const RigidClumps &) = delete;

  void forget();     // other settings: no shape stands
  void new_run();    // clumps may have changed: look at each again; shapes stay

  /* What a step knows of the atoms of this rank. */
  struct Motion {
    const std::vector<char> &active;
    const double *eta;          // [n], or nullptr:
    double eta_uniform;         // the same everywhere
    const double *u_inf;        // [3n], or nullptr:
    const double *u_uniform;    // [3]
    const double *gradient;     // [9n] of the fluid velocity; nullptr: it is uniform
  };

  /* Calls take(i, F, T) for every owned sphere i of a rigid clump that takes part: force [3], torque [3] (nullptr without rotation).
   * loose[i] = 1: atom i belongs to a clump that is not rigid (auto) and is left to the solver. Lone spheres (molecule 0): left to
   * the solver likewise. Errors: a clump whose spheres are not all selected; one that is not rigid (yes). */
  template <class Take>
  void forces(const Motion &motion, const Take &take, std::vector<char> &loose)
  {
    begin_step(motion, loose);
    for (size_t number = 0; number < scene.clumps.size(); number++) {
      if (!evaluate(number, motion, loose)) continue;
      const int begin = scene.clumps[number].begin, n = scene.clumps[number].end - begin;
      const int *perm = of_clump[number]->perm.data();
      for (int k = 0; k < n; k++) {
        const int i = scene.owned[begin + perm[k]];
        if (i >= 0) take(i, &F[3 * (size_t) k], settings.rotation ? &T[3 * (size_t) k] : nullptr);
      }
    }
    end_step(loose);
  }

  bool any_loose() const { return !loose_molecules.empty(); }    // on any rank
  double memory_usage() const;

 private:
  Scene &scene;
  std::string command;

  struct Shape {
    sd_shape shape;
    sd_clump clump;
    double spin_inverse[9];    // of sum (x^2 I - x x), in the frame of the shape: pseudo-inverse
    double gradient_inverse[9];    // of sum x x
    double axis[3];                // of centres on a line
    int64_t molecule;              // of the first of its kind
  };
  std::vector<Shape> shapes;
  sd_shells shells;

  struct Known {
    int shape;                   // -1: loose
    std::vector<int64_t> tag;    // in order
    std::vector<int> perm;       // sphere k of the shape is sphere perm[k] in order of tag
  };
  std::map<int64_t, Known> known;    // by molecule ID: clumps that this rank owns a part of
  std::vector<const Known *> of_clump;
  std::set<int64_t> loose_molecules;

  struct Solved {
    int root;
    double status, need, seconds;
  };
  std::vector<Solved> solved;

  struct {
    int eta, v, omega, u, gradient, end;
  } column = {};
  std::vector<double> radius;    // per atom, ghosts included
  std::vector<double> ghosts;    // what a step knows of ghosts, in columns
  int64_t worst = 0;             // of this step: 4 molecule + fault
  std::vector<double> bent;

  struct Sphere {
    const double *v, *omega, *u, *gradient;
  };
  std::vector<Sphere> spheres;    // of one clump, in order of its shape
  std::vector<double> x, F, T;

  static constexpr double RIGID_TO = 1e-4;    // of its size: more is not the same shape any more

  /* The numbers of all ranks, one rank after the other. */
  static std::vector<double> from_all_ranks(const std::vector<double> &mine, MPI_Comm world);
  void recognise();
  void geometry(const Scene::Clump &clump, std::vector<double> &centres,
                std::vector<double> &radii) const;
  void add_shapes(const std::vector<size_t> &unknown);
  void prepare(Shape &shape);
  void solve(size_t first);
  void announce(size_t number, double seconds);
  void match(const std::vector<size_t> &unknown);
  void gather(const Motion &motion);
  void begin_step(const Motion &motion, std::vector<char> &loose);
  bool evaluate(size_t number, const Motion &motion,
                std::vector<char> &loose);    // F and T of a clump, if it has any
  void end_step(std::vector<char> &loose);
  void slip(const Shape &s, const double R[9], const double c[3], const Motion &m, double s0[3],
            double W[3], double A[9]) const;
};

}    // namespace StokesDyn
#endif
