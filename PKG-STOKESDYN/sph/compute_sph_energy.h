/* compute sph/energy: where the energy of a fluid is and where it goes. See
 * doc/compute_sph_energy.md. */
#ifndef SD_COMPUTE_SPH_ENERGY_H
#define SD_COMPUTE_SPH_ENERGY_H

#include "own_fix.h"
#include "sph.h"

#include "compute.h"

#include "sd_sph_energy.h"

#include <vector>

namespace StokesDyn {

class FixSphPressure;
class FixSphTension;

/* Internal fix: its memory, what the forces of the pair style have done since it was made. It follows
 * the run through restart files. */
class FixSphEnergy : public SphFix {
 public:
  static constexpr const char *STYLE = "SPH/ENERGY";

  FixSphEnergy(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override;
  void setup(int) override;
  void initial_integrate(int) override;
  void end_of_step() override;
  void post_run() override;

  enum Value { KINETIC, POTENTIAL, ELASTIC, DISSIPATED, FRICTION, WORK, BROUGHT, SURFACE, PULL, VALUES };
  /* All of the moment, the same on all ranks. */
  void values(double *out);

 private:
  /* Of this rank: power of the pair style's forces on the group, of friction among them and on
   * others (the sum is what it dissipates), of all forces on others, of gravity along the shift, of fix
   * sph/tension on the group. */
  enum { ON_GROUP, RUBS, ON_OTHERS, SHIFTED, PULLED, POWERS };
  double power[POWERS] = {}, done[POWERS] = {}, dt = 0.0;
  /* of the group, at the end of the last run or in its restart file; what happened in between is
   * nobody's work and goes to `jumps` */
  double elastic_then = 0.0, jumps = 0.0;
  double has_run = 0.0;
  std::vector<double> masses;
  std::vector<FixSphPressure *> states;
  std::vector<LAMMPS_NS::Fix *> gravities;
  std::vector<FixSphTension *> tensions;

  /* With open ends the flow alone counts: particles in the layers push it from outside, and those
   * that come and go bring their energy and take it along. Of a particle of the flow after the last
   * step: all of its energy, the elastic part, the power of the pair style's force on it; the sums of
   * all of this rank, and what has come in since the beginning, less what has gone. */
  enum { ENERGY, STORED, POWER, COLUMNS };
  AtomRows flow;
  double in_flow[COLUMNS] = {}, brought[2] = {};
  std::vector<int> masks;

  std::vector<SavedNumbers> saved() override;
  void write_state(NamedState &) override;
  /* and the fixes of this moment */
  sd_sph_members group();
  double elastic_of(sd_sph_members, const double *rho) const;
  double along_gravity(sd_sph_members, const double *y) const;
  double elastic();
  double surface(const sd_sph_members &) const;
  std::vector<double> places() const;
  void measure(double *);
  void of_particles(const sd_sph_members &, std::vector<double> &rows) const;
  void look_at_ends(bool counts);
};

class ComputeSphEnergy : public LAMMPS_NS::Compute {
 public:
  static constexpr const char *STYLE = "sph/energy";

  ComputeSphEnergy(LAMMPS_NS::LAMMPS *, int, char **);
  ~ComputeSphEnergy() override;
  void init() override;
  double compute_scalar() override;
  void compute_vector() override;

 private:
  const Voice voice;
  double of_moment[FixSphEnergy::VALUES] = {0.0};
  /* the fix that follows the run */
  const OwnFix own_fix;
};

}    // namespace StokesDyn
#endif
