/* fix sph/tension: surface tension of water with a free surface, and its contact angle on walls. All of it is
 * core/sph/sd_sph_tension.h; here stand the messages between ranks. See doc/fix_sph_tension.md. */
#ifndef SD_FIX_SPH_TENSION_H
#define SD_FIX_SPH_TENSION_H

#include "drops.h"
#include "sd_sph_tension.h"
#include "sph.h"

#include <map>
#include <set>
#include <string>
#include <vector>

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

  /* Of the latest force, rows of particles of this rank: [3 n] the force, [n] the area; are there so many? */
  bool has_rows(int n) const { return (int) area.size() == n + 1; }
  const double *forces() const { return F.data(); }
  const double *areas() const { return area.data(); }
  double tension() const { return sigma; }

 private:
  // settings
  double sigma = 0.0;
  bool forced = false;
  // cos and sin by type of wall
  std::map<int, std::pair<double, double>> contacts;
  void parse_contact(Keywords &in);

  // of a run
  bool is_set_up = false;
  sd_sph_surface surface = {};
  double rho0 = 0.0, spacing = 0.0;
  bool walls = false;
  // lines of the log and warnings that have been said
  std::set<std::string> told;
  // curvature, w, normal
  AtomArray shown;
  void check_particles();
  void check_contacts();
  void check_range();
  void look_at_walls() const;

  // a step; rows of particles of this rank, of their ghosts too, and of the far-away particle
  sd_sph_both list = {};
  sd_sph_film film = {};
  sd_sph_film_rows rows = {};
  Rows x4, v4, at_surface, contact, whole, at_wall, sums, beside, turns;
  std::vector<int> wall, skin, near;
  std::vector<size_t> first;
  std::vector<char> inside, marked, cells, shows;
  std::vector<double> one, kappa, once, twice, weights, F, area, mass, held;
  Drops drops;
  void look_at_particles();
  void make_rows();
  void find_near();
  void find_normals();
  void find_curvatures();
  const double *spread(const std::vector<double> &k);
  void find_forces();
  void add_forces();
  void show();
  double whole_area() const;
};

}    // namespace StokesDyn
#endif
