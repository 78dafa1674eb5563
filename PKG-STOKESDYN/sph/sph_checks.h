/* What is easily taken wrong when a scene of pair_style sph/artVisc/tensCorr is made, looked for when a run
 * begins. */
#ifndef SD_SPH_CHECKS_H
#define SD_SPH_CHECKS_H

#include "sph_part.h"

namespace StokesDyn {

class SphChecks : public SphPart {
 public:
  using SphPart::SphPart;

  /* Before any sum; and of bodies, after the first force, which has made the pressures */
  void look_at_beginning();
  void look_at_bodies();
  /* The smallest sd_sph_growth_limit of particles of these groups that are none of a wall. */
  double growth_limit(int bits) const;

 private:
  void look_at_sound();
  void look_at_widths();
  void look_at_plane();
  void look_at_idlers();
  void look_at_fluids();
  void look_at_step();
  void look_at_walls();
  void tell_of_belts();
  void look_at_bodies_of(const LAMMPS_NS::Fix *rigid, const int *body, const double *mass);

  // sph_checks_filling.cpp: how the particles fill space
  void look_at_scene();
  bool fills_space();
  void look_at_rest();
  void look_at_thickness();
};

}    // namespace StokesDyn
#endif
