#include "vans_fluctuations.h"

#include "sd_vans_random.h"

#include <cmath>

namespace StokesDyn {

size_t VansFluctuations::carried(const VansSettings &set)
{
  return (set.fluctuation == VansSettings::LANGEVIN ? sizeof(sd_vans_wander) : sizeof(sd_vans_eddy)) / sizeof(double);
}

VansFluctuations::Renew VansFluctuations::after(double time, double step, bool first)
{
  const Renew renew =
      set.fluctuation == VansSettings::LANGEVIN ? walk_after(time, first) : eddies_after(time, step, first);
  if (renew) eddies.renewals += 1.0;
  return renew;
}

/* New ones when their time is over: for all grains at once, but with depth for each by itself */
VansFluctuations::Renew VansFluctuations::eddies_after(double time, double step, bool first)
{
  const double bed = stream.bed_elevation();
  bool all = first;
  if (set.fluctuation != VansSettings::DEPTH) {
    eddies.age += time;
    if (!first && eddies.age < eddies.period * (1.0 - 1e-9)) return nullptr;
    all = true;
    eddies.age = 0.0;
    eddies.period =
        set.renewal > 0.0 ? set.renewal : sd_vans_depth_over_velocity(&stream.wet, stream.U.data(), bed);
  }
  const double longest = sd_vans_longest_life(&stream.wet, &stream.fluid, stream.stress.data());
  return [=, u_star = stream.friction_velocities()](double z, uint64_t id, double *carried, double *u) {
    const sd_vans_walk walk = {
        set.seed, set.fluctuation != VansSettings::UNCORRELATED, bed, u_star.data(), longest, step};
    sd_vans_eddy *eddy = (sd_vans_eddy *) carried;
    eddy->life -= time;
    if (all || !(eddy->life > 1e-9 * time))
      sd_vans_new_eddy(&set.mesh, set.fluid.eta / set.fluid.rho, &walk, z, id, eddy, u);
  };
}

/* A step of the Langevin walk of every grain */
VansFluctuations::Renew VansFluctuations::walk_after(double time, bool first) const
{
  const std::vector<double> u_star = stream.friction_velocities(), life = stream.lagrangian_times(u_star);
  return [=, bed = stream.bed_elevation(), water = stream.wet.ncell - 1](double z, uint64_t id, double *carried,
                                                                        double *u) {
    const sd_vans_langevin walk = {set.seed, bed, u_star.data(), life.data(), first ? HUGE_VAL : time, water};
    sd_vans_langevin_step(&set.mesh, &walk, z, id, (sd_vans_wander *) carried, u);
  };
}

}    // namespace StokesDyn
