/* The keywords of fix hydro/vans and the files they name. */
#ifndef SD_VANS_SETTINGS_H
#define SD_VANS_SETTINGS_H

#include "field.h"
#include "sd_vans.h"

#include <string>
#include <vector>

namespace StokesDyn {

struct VansSettings {
  static constexpr const char *COMMAND = "Fix hydro/vans";

  void parse(LAMMPS_NS::LAMMPS *lmp, const std::vector<std::string> &args, size_t begin);
  int ncell() const { return (int) edge.size() - 1; }

  /* dz = 0: slices of any height */
  double z_ref = 0.0, dz = 0.0;
  /* above z_ref */
  std::vector<double> edge;
  double rho = 0.0, eta = 0.0, g[3] = {0, 0, 0};
  /* 0: the box */
  double area = 0.0;
  enum { NONE, ONE, TWO, FLUID } couple = TWO;
  /* [N+1]; empty: zero */
  std::vector<double> profile;
  /* columns phi, vx, drag, then phi and drag of each class; empty: averaged */
  std::vector<std::vector<double>> given;
  /* [N] or empty */
  std::vector<double> convective;
  /* of the solve; 0: N steps, a tenth of it */
  double period = 0.0, dt = 0.0;
  bool rest = false;
  double hindrance = 3.1, lift = 0.0;
  sd_vans_turbulence turbulence = SD_VANS_LI_SAWAMOTO;
  double kappa = 0.41, phi_max = 0.64, phi_bed = 0.08;
  bool sublayer = false;
  sd_vans_viscosity viscosity = SD_VANS_CONSTANT;
  bool driven = false;
  Field u_top, dpdx;
  double width = 0.0, wall_coef = 1.0;
  /* 0: mean of the grains */
  double radius = 0.0;
  bool classes = false;
  /* empty: those of the grains */
  std::vector<double> class_radii;
  bool point = false;
  enum { NO_FLUCTUATION, CORRELATED, UNCORRELATED, DEPTH } fluctuation = NO_FLUCTUATION;
  uint64_t seed = 0;
  double bed = 0.0;
  bool find_bed = false;
  /* 0: depth over mean velocity above the bed */
  double renewal = 0.0;
  sd_vans_rules rules = SD_VANS_CONSISTENT;
  /* phi profiles in the mean that marks the bed (ni_capart) */
  int bed_average = 1;
  bool conserve = true;
  bool overlap_once = false;
  std::string region, average = "all";

  bool solves() const { return couple == TWO || couple == FLUID; }
  bool averages() const { return couple == ONE || couple == TWO; }
  bool wants_pores() const
  {
    return turbulence == SD_VANS_PORE || turbulence == SD_VANS_ROUSSEAU ||
        turbulence == SD_VANS_NI_CAPART;
  }

 private:
  LAMMPS_NS::LAMMPS *lmp = nullptr;
  std::string mesh_file, profile_file, given_file, convective_file;
  void read(Keywords &in);
  void take_mesh(Keywords &in);
  void take_solve(Keywords &in);
  void take_class_radii(Keywords &in);
  void take_fluctuation(Keywords &in);
  void take_sidewall(Keywords &in);
  void check(const Keywords &in) const;
  void read_mesh();
  void read_given();
};

/* All numbers of a file, row by row, the same on every rank. '#' begins a comment, commas count as
 * blanks.
 * Ends the run with what, file and line if the file cannot be read or a word is no finite number.
 * */
std::vector<std::vector<double>> read_rows(LAMMPS_NS::LAMMPS *lmp, const std::string &what,
                                           const std::string &file);

/* ncell + 1 numbers: the velocities of the water. */
std::vector<double> read_profile(LAMMPS_NS::LAMMPS *lmp, const std::string &what,
                                 const std::string &file, int ncell);

}    // namespace StokesDyn
#endif
