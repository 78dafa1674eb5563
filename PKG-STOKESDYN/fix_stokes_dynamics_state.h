/* Internal fix of pair_style stokes_dynamics: what must follow its atom through migration, sorting and restart.
 *
 * Per atom: F and v' of the last step and solve, and, as a run or a restart file left them, position and velocity. The latter tell
 * whether a run begins exactly where the last one ended; then the force of that step still stands (velocity Verlet computed it from the
 * velocity at half step, which is gone), and the run goes on as if it had never been broken. */
#ifndef SD_FIX_STOKES_DYNAMICS_STATE_H
#define SD_FIX_STOKES_DYNAMICS_STATE_H

#include "fix.h"

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

  enum { FORCE = 0, VPRIME = 3, SOLVED = 6, LEFT_X = 7, LEFT_V = 10, TRANSLATION_ONLY = 13 };
  enum { TORQUE = 13, WPRIME = 16, LEFT_OMEGA = 19, WITH_ROTATION = 22 };
  double **state = nullptr;    // [atom][columns]
  int columns;

  /* The same on all ranks, in one block for the restart file. A step of -1: never. */
  struct Global {
    double last_step = -1, last_solve = -1;    // time step of the forces, of v'
    double spheres = 0;                        // that took part then
    double eta = 0, u_inf[3] = {0, 0, 0},
           vorticity[3] = {0, 0, 0};    // of the last step, if numbers
    double solves = 0, unconverged = 0;
    double iterations = 0, residual = 0;    // of the last solve
  } global;

  void forget();                   // new settings: nothing of the past stands
  bool left_as_is(int i) const;    // is atom i where, and as fast as, the last run left it?

 private:
  void record(int i);
};

}    // namespace StokesDyn
#endif
