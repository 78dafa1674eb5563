/* fix sph/tension: surface tension of water with a free surface, and its contact angle on walls: its
 * settings, and the scenes that it is made for. A step of it is free_surface.h. See
 * doc/fix_sph_tension.md. */
#ifndef SD_FIX_SPH_TENSION_H
#define SD_FIX_SPH_TENSION_H

#include "free_surface.h"

#include <set>
#include <string>

namespace StokesDyn {

class FixSphTension : public SphFix {
 public:
  static constexpr const char *STYLE = "sph/tension";

  FixSphTension(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup(int vflag) override;
  void post_force(int) override;
  double compute_scalar() override;
  double compute_vector(int) override;
  double memory_usage() override;

  /* of the latest force */
  const FreeSurface &surface() const { return film; }
  double tension() const { return how.sigma; }

 private:
  // settings
  SurfaceTension how;
  bool forced = false;
  void parse_contact(Keywords &in);

  // of a run
  bool is_set_up = false;
  double spacing = 0.0;
  // lines of the log and warnings that have been said
  std::set<std::string> told;
  bool is_fluid(int i) const;
  void check_particles();
  void check_contacts();
  void check_range();

  AtomArray shown;
  FreeSurface film;
  double whole_area() const;
};

}    // namespace StokesDyn
#endif
