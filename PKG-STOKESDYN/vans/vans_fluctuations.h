/* Velocity fluctuations of the water that grains feel: when they are renewed, and how. Numbers that grains
 * carry, and random numbers: sd_vans_random.h. */
#ifndef SD_VANS_FLUCTUATIONS_H
#define SD_VANS_FLUCTUATIONS_H

#include "vans_stream.h"

#include <functional>

namespace StokesDyn {

class VansFluctuations {
 public:
  explicit VansFluctuations(const VansStream &stream) :
      intensity(stream.set.fluctuations.intensity.number()), stream(stream), mesh(stream.mesh),
      set(stream.set.fluctuations)
  {
  }

  /* the friction velocity, if the user gives one number */
  double intensity;

  /* The numbers that a grain carries for it */
  static size_t carried(const VansSettings &set);
  /* How that of a grain is made anew: its height and ID, what it carries, u' [3] out. The random numbers
   * depend on seed, ID and the number of the renewal. */
  using Renew = std::function<void(double z, uint64_t id, double *carried, double *u)>;
  /* What is due after this time since the last call, with time steps of the walk; empty: nothing. first: all
   * grains are without */
  Renew after(double time, double step, bool first);

  /* found, or as the user says */
  double bed_elevation() const { return set.find_bed ? stream.bed_elevation() : set.bed; }

  /* The random walk of all grains at once, as restart files have it; renewals 0: it has not begun */
  struct {
    double age = 0.0, period = 0.0, renewals = 0.0;
  } eddies;

 private:
  const VansStream &stream;
  const sd_vans_mesh &mesh;
  const VansSettings::Fluctuations &set;
  /* [N] with the sign of the stress */
  std::vector<double> friction_velocities() const;
  /* [N] of the Langevin walk */
  std::vector<double> lagrangian_times(const std::vector<double> &u_star) const;
  Renew eddies_after(double time, double step, bool first);
  Renew walk_after(double time, bool first) const;
};

}    // namespace StokesDyn
#endif
