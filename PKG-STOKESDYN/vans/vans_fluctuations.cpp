#include "vans_fluctuations.h"

#include "sd_vans_random.h"

#include <cmath>

namespace StokesDyn {

size_t VansFluctuations::carried(const VansSettings &set)
{
  const bool walks = set.fluctuations.kind == VansSettings::Fluctuations::LANGEVIN;
  return (walks ? sizeof(sd_vans_wander) : sizeof(sd_vans_eddy)) / sizeof(double);
}

std::vector<double> VansFluctuations::lagrangian_times(const std::vector<double> &u_star) const
{
  std::vector<double> life(mesh.ncell, set.renewal);
  if (set.renewal == 0.0)
    sd_vans_lagrangian_times(&mesh, set.schmidt, stream.nut.data(), u_star.data(), life.data());
  return life;
}

std::vector<double> VansFluctuations::friction_velocities() const
{
  if (!set.intensities.empty()) return set.intensities;
  std::vector<double> u_star(mesh.ncell, intensity);
  if (set.intensity_given) return u_star;
  sd_vans_friction_velocities(&stream.fluid, mesh.ncell, stream.stress.data(), u_star.data());
  return u_star;
}

VansFluctuations::Renew VansFluctuations::after(double time, double step, bool first)
{
  const Renew renew =
      set.kind == set.LANGEVIN ? walk_after(time, first) : eddies_after(time, step, first);
  if (renew) eddies.renewals += 1.0;
  return renew;
}

/* New ones when their time is over: for all grains at once, but with depth for each by itself */
VansFluctuations::Renew VansFluctuations::eddies_after(double time, double step, bool first)
{
  const double bed = bed_elevation();
  bool all = first;
  if (set.kind != set.DEPTH) {
    eddies.age += time;
    if (!first && eddies.age < eddies.period * (1.0 - 1e-9)) return nullptr;
    all = true;
    eddies.age = 0.0;
    eddies.period =
        set.renewal > 0.0 ? set.renewal : sd_vans_depth_over_velocity(&stream.wet, stream.U.data(), bed);
  }
  const double longest = sd_vans_longest_life(&stream.wet, &stream.fluid, stream.stress.data());
  const double nu = stream.set.fluid.eta / stream.set.fluid.rho;
  return [=, u_star = friction_velocities()](double z, uint64_t id, double *carried, double *u) {
    const sd_vans_walk walk = {
        set.seed, set.kind != set.UNCORRELATED, bed, u_star.data(), longest, step};
    sd_vans_eddy *eddy = (sd_vans_eddy *) carried;
    eddy->life -= time;
    if (all || !(eddy->life > 1e-9 * time))
      sd_vans_new_eddy(&mesh, nu, &walk, z, id, eddy, u);
  };
}

/* A step of the Langevin walk of every grain */
VansFluctuations::Renew VansFluctuations::walk_after(double time, bool first) const
{
  const std::vector<double> u_star = friction_velocities(), life = lagrangian_times(u_star);
  return [=, bed = bed_elevation(), water = stream.wet.ncell - 1](double z, uint64_t id, double *carried,
                                                                        double *u) {
    const sd_vans_langevin walk = {set.seed, bed, u_star.data(), life.data(), first ? HUGE_VAL : time, water};
    sd_vans_langevin_step(&mesh, &walk, z, id, (sd_vans_wander *) carried, u);
  };
}

}    // namespace StokesDyn
