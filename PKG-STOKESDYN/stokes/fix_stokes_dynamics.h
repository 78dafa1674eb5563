/* fix stokes_dynamics: adds the force of pair_style stokes_dynamics where the pair style does not,
 * and reports it.
 * See doc/fix_stokes_dynamics.md. */
#ifndef SD_FIX_STOKES_DYNAMICS_H
#define SD_FIX_STOKES_DYNAMICS_H

#include "hydrodynamics.h"
#include "rows_fix.h"

namespace StokesDyn {

class FixStokesDynamics : public RowsFix {
 public:
  static constexpr const char *STYLE = "stokes_dynamics";

  FixStokesDynamics(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup(int) override;
  void post_force(int) override;
  double compute_scalar() override;
  double compute_vector(int) override;
  /* Does this fix add the force, as things stand now? */
  bool applies() const;

 private:
  /* Error: a fix that reads forces before this one adds the drag */
  void check_order() const;
  enum { NO, YES, UNSAID } apply = UNSAID;
  /* Fx Fy Fz v'x v'y v'z Tx Ty Tz of the spheres that are in the group and take part */
  AtomArray rows;
  /* others than those of the pair style have zeros (Epochs::selection) */
  Stamp cleared;
  /* of the global vector: the total force is a sum over the spheres */
  int extensive[9] = {1, 1, 1, 0, 0, 0, 0, 0, 0};
  /* F and dissipation of the group, this rank */
  double total[4];

  const HydrodynamicsOf hydrodynamics{
      voice, "there is no pair_style stokes_dynamics whose force it could apply or report"};
};

}    // namespace StokesDyn
#endif
