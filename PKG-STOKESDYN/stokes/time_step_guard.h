/* Explicit steps of free spheres under this drag are stable up to a limit; this warns above it. */
#ifndef SD_TIME_STEP_GUARD_H
#define SD_TIME_STEP_GUARD_H

#include "pointers.h"

#include "sd_solve.h"

#include <string>
#include <vector>

namespace StokesDyn {

class TimeStepGuard : protected LAMMPS_NS::Pointers {
 public:
  TimeStepGuard(LAMMPS_NS::LAMMPS *lmp, const std::string &command) :
      Pointers(lmp), command(command)
  {
  }

  struct State {
    double lambda_min = 0;    // smallest eigenvalue met, of the mobility scaled to unit diagonal; 0: unknown
    double due = 0;           // count of solves when it is to be computed again
    double limit = 0;         // of explicit time steps of free spheres; 0: unknown
  } state;

  /* After a solve, which was number `solves`; solving: as in Hydrodynamics. */
  void look(const sd_system &system, const sd_solve_report &report, const std::vector<char> &solving,
            bool preconditioned, double solves);

 private:
  std::string command;
  bool warned = false;
  double relaxation_time(const sd_system &A, const std::vector<char> &solving) const;
  double smallest_eigenvalue(const sd_system &system) const;
};

}    // namespace StokesDyn
#endif
