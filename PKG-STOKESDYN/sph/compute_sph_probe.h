/* compute sph/probe and sph/surface/atom: pressures at points, heights of the free surface, and
 * who is at it. See doc/compute_sph_probe.md. */
#ifndef SD_COMPUTE_SPH_PROBE_H
#define SD_COMPUTE_SPH_PROBE_H

#include "keywords.h"

#include "compute.h"

#include <vector>

namespace StokesDyn {

class PairSph;

class ComputeSphProbe : public LAMMPS_NS::Compute {
 public:
  static constexpr const char *STYLE = "sph/probe";

  ComputeSphProbe(LAMMPS_NS::LAMMPS *, int, char **);
  void init() override;
  void compute_vector() override;

 private:
  struct Probe {
    /* 0 1 2: the height of the surface along it; -1: pressure */
    int axis;
    double x[3];
  };
  /* a particle as the line upwards from a probe passes it */
  struct Near {
    int i;
    double across, z, h;
  };
  const Voice voice;
  std::vector<Probe> probes;
  std::vector<double> values;
  PairSph *pair = nullptr;

  double pressure(const Probe &) const;
  double height(const Probe &) const;
  std::vector<Near> along(const Probe &) const;
  double volume(int i) const;
  /* use(d) with d from the probe to particle i and to those of its images that may be within 2 h;
   * along `axis` there are none */
  template <class Use> void each_image(const Probe &, int i, const Use &use) const;
};

class ComputeSphSurface : public LAMMPS_NS::Compute {
 public:
  static constexpr const char *STYLE = "sph/surface/atom";

  ComputeSphSurface(LAMMPS_NS::LAMMPS *, int, char **);
  void init() override;
  void compute_peratom() override;
  double memory_usage() override;

 private:
  const Voice voice;
  PairSph *pair = nullptr;
  std::vector<double> moments, values;
  /* LAMMPS reads rows through these */
  std::vector<double *> rows;
};

}    // namespace StokesDyn
#endif
