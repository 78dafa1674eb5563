/* pair_style stokes_dynamics: Stokes drag with hydrodynamic interactions. See doc/pair_stokes_dynamics.md. */
#ifndef SD_PAIR_STOKES_DYNAMICS_H
#define SD_PAIR_STOKES_DYNAMICS_H

#include "pair.h"

#include "checks.h"
#include "field.h"
#include "fix_stokes_dynamics_state.h"
#include "preconditioner.h"
#include "rigid_clumps.h"
#include "scene.h"

#include "sd_solve.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {
class Region;
}

namespace StokesDyn {

class PairStokesDynamics : public LAMMPS_NS::Pair {
 public:
  static constexpr const char *STYLE = "stokes_dynamics";
  static constexpr const char *COMMAND_NAME = "Pair style stokes_dynamics";

  PairStokesDynamics(LAMMPS_NS::LAMMPS *);
  ~PairStokesDynamics() override;
  void compute(int, int) override;
  void settings(int, char **) override;
  void coeff(int, char **) override;
  void init_style() override;
  double init_one(int, int) override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_restart_settings(FILE *) override;
  void read_restart_settings(FILE *) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  void *extract(const char *, int &) override;
  double memory_usage() override;

  /* For fix stokes_dynamics. After compute() of a step: per atom of this rank, in order of LAMMPS. */
  bool adds_force() const { return add_force; }
  const double *drag_force(int i) const
  {
    return fix_state->state[i] + FixStokesDynamicsState::FORCE;
  }
  const double *drag_torque(int i) const    // nullptr without rotation
  {
    return scene.settings.rotation ? fix_state->state[i] + FixStokesDynamicsState::TORQUE : nullptr;
  }
  const double *perturbation(int i) const
  {
    return fix_state->state[i] + FixStokesDynamicsState::VPRIME;
  }
  double dissipation(int i) const;    // -F.(v - u_inf) of one sphere, >= 0 in the sum over all
  bool computed_in(double step) const { return fix_state && fix_state->global.last_step == step; }
  const FixStokesDynamicsState::Global &numbers() const { return fix_state->global; }

 private:
  // settings
  std::vector<std::string> args;
  int update_every;
  bool add_force;
  double tolerance;
  int max_iter, algorithm;
  Field visc, fluid_velocity[3], fluid_vorticity[3];
  bool has_vorticity;
  std::string region_id, group_id;
  Scene scene;
  RigidClumps rigid;
  Preconditioner preconditioner;
  SortingBins sorting_bins;
  bool warm_start;

  // looked up in init_style
  LAMMPS_NS::Region *region = nullptr;
  int igroup = 0, groupbit = 0;
  double largest_diameter = 0.0;
  FixStokesDynamicsState *fix_state = nullptr;
  bool warned_unconverged = false, warned_nobody_applies = false, warned_time_step = false;
  bool looked_at_clumps = false;

  // of this step, per atom of this rank
  std::vector<char> active, solving;    // takes part; is the solver's
  bool u_varies = false;                // is the fluid velocity stored per atom?
  bool fluid_varies = false;            // is there a gradient of the fluid velocity?
  // What is the same everywhere is not stored per atom: each pass over this memory costs as much as the arithmetic.
  std::vector<double> eta, u_inf, w_inf, gradient;
  double u_uniform[3] = {0.0, 0.0, 0.0};
  std::vector<double> slip, drag, spin, solution, work;    // of a solve

  double viscosity(int i) const { return visc.is_atom_style() ? eta[i] : visc.number(); }
  const double *fluid_at(int i) const { return u_varies ? &u_inf[3 * (size_t) i] : u_uniform; }
  double drag_of(int i) const;
  double spin_of(int i) const;
  void slip_of(int i, double *s) const;    // [width()]

  FixStokesDynamicsState *find_state() const;    // nullptr before the first run
  void parse();
  void allocate();
  double range() const;    // what LAMMPS is told
  void state_of_the_step();
  int width() const { return scene.settings.rotation ? 6 : 3; }    // unknowns of a sphere
  void fluid_gradient();
  void rigid_forces();
  void add(int i);
  bool selected(int i) const;
  int faulty(int i) const;
  void complain();
  bool numbers_only() const;
  void solve();
  void guess();
  void remember();
  double relaxation_time();
  double smallest_eigenvalue(const sd_system &system);
  void time_step_guard(const sd_system &system, const sd_solve_report &report);
  void solver_failed(sd_status status, const sd_solve_report &report);
};

}    // namespace StokesDyn
#endif
