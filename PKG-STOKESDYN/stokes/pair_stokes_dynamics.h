/* pair_style stokes_dynamics: Stokes drag with hydrodynamic interactions. See
 * doc/pair_stokes_dynamics.md. */
#ifndef SD_PAIR_STOKES_DYNAMICS_H
#define SD_PAIR_STOKES_DYNAMICS_H

#include "pair.h"

#include "checks.h"
#include "hydrodynamics.h"
#include "neighbours_stokes.h"

#include <string>
#include <vector>

namespace StokesDyn {

class PairStokesDynamics : public LAMMPS_NS::Pair {
 public:
  static constexpr const char *STYLE = "stokes_dynamics";

  PairStokesDynamics(LAMMPS_NS::LAMMPS *);
  ~PairStokesDynamics() override;
  void compute(int, int) override;
  double single(int, int, int, int, double, double, double, double &) override;
  void settings(int, char **) override;
  void coeff(int, char **) override;
  void init_style() override;
  double init_one(int, int) override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_restart_settings(FILE *) override;
  void read_restart_settings(FILE *) override;
  /* "visc": the viscosity, for fix adapt. "hydrodynamics": the Hydrodynamics, for fixes. */
  void *extract(const char *, int &) override;
  double memory_usage() override;

 private:
  std::vector<std::string> args;
  Hydrodynamics hydro;
  const Voice &voice = hydro.voice;
  SortingBins sorting_bins;
  double largest_diameter = 0.0;
  /* for compute pair: iterations, residual, unconverged solves, dissipation */
  double reported[4] = {0.0};
  bool warned_nobody_applies = false, warned_undragged = false, warned_no_clump = false;
  /* by whom forces were last found: the step, the lists that LAMMPS had made in this run, the run */
  struct {
    LAMMPS_NS::bigint step, builds;
  } asked = {-1, -1};
  Stamp asked_in;
  Neighbourhood neighbourhood;
  void look_at_neighbours();
  void warn_of_undragged(const std::vector<char> &chosen, int dragged);

  /* What the force of a step needs. */
  enum Verdict {
    STANDS,              // nothing: that of the last step, as a run goes on where one has ended
    OLD_PERTURBATION,    // the velocities of now, with the v' of the last solve
    SOLVE
  };
  bool asked_again() const;
  Verdict what_is_due();
  void add();
  void report();

  void accept_all_types();
  std::vector<std::string> words_of_now() const;
  void require_atoms();
  void warn_of_no_clump();
  void look_for_fixes();
  double range() const;    // what LAMMPS is told
};

}    // namespace StokesDyn
#endif
