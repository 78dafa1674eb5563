/* The stream of fix hydro/vans: its profiles and what moves them on, the same on every rank. Knows no atoms: the fix
 * brings sums over all of them. */
#ifndef SD_VANS_STREAM_H
#define SD_VANS_STREAM_H

#include "vans_settings.h"

#include <deque>
#include <vector>

namespace StokesDyn {

class VansStream {
 public:
  VansStream(LAMMPS_NS::LAMMPS *lmp, const VansSettings &settings);
  ~VansStream();
  VansStream(const VansStream &) = delete;
  VansStream &operator=(const VansStream &) = delete;

  const VansSettings &set;
  sd_vans_mesh mesh;
  sd_vans_force_law law;
  sd_vans_fluid fluid;
  std::vector<double> U;              // [N+1]
  std::vector<double> grain;          // [5][N]: phi, vx, vy, vz, drag
  std::vector<double> class_grain;    // [nclass][5][N]
  std::vector<double> class_radii;
  std::vector<double> hindrance, b, length, nut, stress;    // [N]
  std::vector<double> shear_density;    // [N] force of the viscous stress per volume of grains
  std::vector<double>
      foreseen_density;    // [N] impulse of the drag per volume of grains that the last solve took from the water
  bool averaged = false;    // are there averages?

  /* Numbers that grow: momentum along x, from the first step on. */
  struct Ledger {
    double transit = 0;    // the water has given it, the grains have not got it yet
    double driving = 0, bottom = 0, walls = 0, surface = 0;    // the water got it from outside
    double others = 0;    // spheres that are averaged but not in the group got it
  } ledger;

  int ncell() const { return mesh.ncell; }
  double *phi() { return grain.data(); }
  double *vx() { return grain.data() + mesh.ncell; }
  double *drag() { return grain.data() + 4 * (size_t) mesh.ncell; }
  double height(int n) const { return mesh.edge[n + 1] - mesh.edge[n]; }
  void set_classes(const std::vector<double> &radii);
  void
  profile_changed();    // U or phi set from outside: hindrance, eddy viscosity and stress follow

  /* New averages from sums over all grains. */
  void take_averages(double area, const std::vector<double> &sums,
                     const std::vector<double> &class_sums);
  /* Since the last solve, impulses along x. */
  struct Given {
    std::vector<double>
        back;    // [N] what the drag foreseen then was more than the true one; empty: momentum is not accounted for
    double all = 0.0,
           others = 0.0;    // what the grains got from the water; spheres outside the group of it
  };
  void solve(double area, double T, const Given &given);

  double momentum(double area) const;    // of the water, along x
  double transport() const;              // sum of phi vx dz
  double largest_stress() const;
  double bed_elevation()
      const;    // of the first maximum of phi above 0.5 from the top, or as the user says
  double depth_over_velocity(double bed) const;

  std::vector<double> pack() const;    // for the restart file
  void unpack(const std::vector<double> &values);

 private:
  LAMMPS_NS::LAMMPS *lmp;
  sd_vans_solver *solver;
  std::vector<double> outstanding;    // [N] momentum per area that is to go back to the water
  std::deque<std::vector<double>> phi_history;    // ni_capart: the last profiles
  std::vector<double> scratch;
  std::vector<double> class_columns(int k) const;    // column k of every class, [nclass][N]
  void mixing_length();
};

}    // namespace StokesDyn
#endif
