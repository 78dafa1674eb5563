/* The free surface of a fluid in a step: curvatures, and the forces of surface tension. All arithmetic is
 * core/sph/sd_sph_tension.h; here stand its rows and the messages between ranks. */
#ifndef SD_FREE_SURFACE_H
#define SD_FREE_SURFACE_H

#include "drops.h"
#include "sd_sph_tension.h"
#include "sph.h"

#include <map>
#include <utility>
#include <vector>

namespace StokesDyn {

/* What a run has: tension, density of the fluid, what a plane hides of it, are there walls, and cos and sin
 * of contact angles by type of wall */
struct SurfaceTension {
  double sigma = 0.0, rho0 = 0.0;
  sd_sph_surface surface = {};
  bool walls = false;
  std::map<int, std::pair<double, double>> contacts;
};

class FreeSurface : protected LAMMPS_NS::Pointers {
 public:
  /* shown: of particles at the surface or below it the curvature, w and the normal */
  enum { SHOWN = 5 };
  FreeSurface(const Voice &voice, const SurfaceTension &how, AtomArray &shown, GhostExchange &ghosts);

  /* Finds the forces, with the lists of this step, and adds them to those of LAMMPS. */
  void pull(PairSph *pair);

  /* Of the latest force, rows of particles of this rank: [3 n] the force, [n] the area; are there so many? */
  bool has_rows(int n) const { return (int) area.size() == n + 1; }
  const double *forces() const { return F.data(); }
  const std::vector<double> &areas() const { return area; }
  const Drops &bodies() const { return drops; }
  double bytes() const;

 private:
  const Voice &voice;
  const SurfaceTension &how;
  AtomArray &shown;
  GhostExchange &ghosts;
  PairSph *pair = nullptr;
  Drops drops;

  // rows of particles of this rank, of their ghosts too, and of the far-away particle
  sd_sph_both list = {};
  sd_sph_film film = {};
  sd_sph_film_rows rows = {};
  sd_sph_skin skin = {};
  Rows x4, v4, at_surface, contact, whole, at_wall, sums, beside, turns, own;
  std::vector<int> wall, near, who, count, pool;
  std::vector<const int *> neighbor;
  std::vector<size_t> first;
  std::vector<uint64_t> cells;
  std::vector<char> held;
  std::vector<double> kappa, once, twice, wet, pressure, weight, F, area;
  void place();
  void make_rows();
  void find_normals();
  void wet_walls();
  void look_at_walls() const;
  void find_curvatures();
  void find_forces();
  const char *who_is_held();
  void show(bool normals);
};

}    // namespace StokesDyn
#endif
