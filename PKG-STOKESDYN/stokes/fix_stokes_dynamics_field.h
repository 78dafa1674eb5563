/* fix stokes_dynamics/field: the velocity of the fluid on a grid, as files for ParaView. See
 * doc/fix_stokes_dynamics_field.md. */
#ifndef SD_FIX_STOKES_DYNAMICS_FIELD_H
#define SD_FIX_STOKES_DYNAMICS_FIELD_H

#include "callback.h"
#include "flow_in_slab.h"
#include "hydrodynamics.h"
#include "rows_fix.h"

#include "sd_field.h"

#include <string>
#include <vector>

namespace StokesDyn {

class FixStokesDynamicsField : public RowsFix {
 public:
  static constexpr const char *STYLE = "stokes_dynamics/field";

  FixStokesDynamicsField(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup(int) override;
  void end_of_step() override;
  double memory_usage() override;

 private:
  std::string file;
  int points[3];
  /* corners of the grid, where they are given; else those of the box */
  bool has_lo = false, has_hi = false;
  double lo[3], hi[3];
  Owned<sd_field, sd_field_free> tables;
  FlowInSlab in_slab;

  const HydrodynamicsOf hydrodynamics{
      voice, "there is no pair_style stokes_dynamics whose flow it could write"};
  sd_field_grid grid() const;
  int end_of_share(int planes, int p) const;
  Lattice images() const;
  Halo near_planes(const sd_field_grid &, double reach, const std::vector<double> &x) const;
  void add_flow(Hydrodynamics &, const sd_field_grid &, double *u);
  void add_sums(Hydrodynamics &, const FlowSources &, const sd_field_grid &, double *u);
  sd_status add_all_pairs(const FlowSources &, const sd_field_grid &, double *u);
  sd_status add_split(Hydrodynamics &, const FlowSources &, double range, const sd_field_grid &, double *u);
  std::vector<unsigned char> put_spheres(const Hydrodynamics &, const sd_field_grid &,
                                         double *u) const;
  void write(const sd_field_grid &, const std::vector<double> &u,
             const std::vector<unsigned char> &inside) const;
};

}    // namespace StokesDyn
#endif
