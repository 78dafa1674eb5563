/* Internal fix of pair_style stokes_dynamics: what must follow its atom through migration, sorting and restart.
 *
 * Per atom: F and v' of the last step and solve, and what F depends on as a run or a restart file left it: position, velocity, radius,
 * molecule. The latter tell whether a run begins exactly where the last one ended; then the force of that step still stands
 * (velocity Verlet computed it from the velocity at half step, which is gone), and the run goes on as if it had never been broken. */
#ifndef SD_FIX_STOKES_DYNAMICS_STATE_H
#define SD_FIX_STOKES_DYNAMICS_STATE_H

#include "fix.h"

#include "preconditioner.h"

#include <cstdint>

namespace StokesDyn {

class FixStokesDynamicsState : public LAMMPS_NS::Fix {
 public:
  static constexpr const char *STYLE = "STOKES_DYNAMICS/STATE";

  FixStokesDynamicsState(LAMMPS_NS::LAMMPS *, int, char **);
  ~FixStokesDynamicsState() override;
  int setmask() override { return 0; }
  void post_run() override;

  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override { return columns + 1; }
  int maxsize_restart() override { return columns + 1; }
  void write_restart(FILE *) override;
  void restart(char *) override;
  double memory_usage() override;

  enum { FORCE = 0, VPRIME = 3, SOLVED = 6, LEFT_X = 7, LEFT_V = 10, LEFT_RADIUS = 13 };
  enum { LEFT_MOLECULE = 14, TRANSLATION_ONLY = 15 };
  enum { TORQUE = 15, WPRIME = 18, LEFT_OMEGA = 21, WITH_ROTATION = 24 };
  double **state = nullptr;    // [atom][columns]
  int columns;
  int history;    // first of the columns for the last two solutions; == columns: none are kept
  bool rotation;

  /* The same on all ranks, in one block for the restart file. A step of -1: never. */
  struct Global {
    uint64_t size = sizeof(Global);            // tells restart files of other versions
    double last_step = -1, last_solve = -1;    // time step of the forces, of v'
    double spheres = 0;                        // that took part then
    double eta = 0, u_inf[3] = {0, 0, 0},
           vorticity[3] = {0, 0, 0};    // of the last step, if numbers
    double solves = 0, unconverged = 0;
    double solutions = 0;    // kept in the history: 0, 1, 2
    Preconditioner::Numbers preconditioner;
    double lambda_min =
        0;    // smallest eigenvalue met, of the mobility scaled to unit diagonal; 0: unknown
    double guard_due = 0;    // count of solves when lambda_min is to be computed again
    double dt_limit = 0;     // of explicit time steps of free spheres; 0: unknown
    double iterations = 0, residual = 0;    // of the last solve
    double box[6] = {0, 0, 0, 0, 0, 0};     // periodic lengths and tilts as the last run left them
    uint64_t settings = 0;                  // hash of the words of the pair_style command
  } global;

  bool restart_written = false;        // since the last solve
  void settings_are(uint64_t hash);    // if they are new: nothing of the past stands
  bool box_left_as_is() const;
  bool placed_as_left(int i) const;    // atom i: place, radius, molecule
  bool moving_as_left(int i) const;    // velocity and angular velocity

 private:
  void forget();
  void record(int i);
  void present_box(double *box) const;
};

}    // namespace StokesDyn
#endif
