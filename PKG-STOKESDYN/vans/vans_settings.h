/* The keywords of fix hydro/vans and the files they name. */
#ifndef SD_VANS_SETTINGS_H
#define SD_VANS_SETTINGS_H

#include "field.h"
#include "sd_vans.h"

#include <string>
#include <vector>

namespace StokesDyn {

struct VansSettings {
  /* args: all words of the fix command */
  VansSettings(LAMMPS_NS::LAMMPS *lmp, const std::vector<std::string> &args);
  VansSettings(const VansSettings &) = delete;

  const Voice voice;

  /* steps between couplings */
  int every = 1;
  /* above z_ref */
  std::vector<double> edge;
  sd_vans_mesh mesh = {};
  /* what the core wants to know, radii apart */
  sd_vans_fluid fluid = {};
  sd_vans_force_law law = {};
  /* by the keyword, and not by default */
  bool drag_given = false;
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
  Field u_top, dpdx, gravity[3];
  /* of water and grains, up through a horizontal plane; with upflow only */
  Field flux;
  bool upflow = false;
  /* volume of water that passes per width and time; with fluid.held what drives the stream follows
   * from it, with a reach the depth: water that comes in and does not pass stays in this length */
  Field discharge;
  double reach = 0.0;
  /* above z_ref where the surface begins, if it moves; 0: it stays at the top of the mesh */
  double surface = 0.0;
  /* 0: mean of the grains */
  double radius = 0.0;
  bool classes = false;
  /* of equal ratio; 0: a class for each radius, as long as these are few */
  int bins = 0;
  /* empty: those of the grains */
  std::vector<double> class_radii;
  bool point = false;
  struct Fluctuations {
    enum Kind { NONE, CORRELATED, UNCORRELATED, DEPTH, LANGEVIN } kind = NONE;
    uint64_t seed = 0;
    /* elevation of the bed: that of the grains, or given */
    bool find_bed = false;
    double bed = 0.0;
    /* 0: depth over mean velocity above the bed */
    double renewal = 0.0;
    /* turbulent Schmidt number of langevin: eddy viscosity over what spreads the grains */
    double schmidt = 1.0;
    /* the friction velocity of the grain's slice: from the stress of the stream, or given, one number
     * or [N] */
    bool intensity_given = false;
    Field intensity;
    std::vector<double> intensities;
  } fluctuations;
  /* phi profiles in the mean that marks the bed (ni_capart) */
  int bed_average = 1;
  bool conserve = true;
  bool overlap_once = false, overlap_given = false;
  std::string region, average = "all";

  /* gx gy gz, each a number or a variable */
  void take_gravity(Keywords &in);
  int ncell() const { return mesh.ncell; }
  bool follows() const { return surface > 0.0; }
  bool yade() const { return law.rules == SD_VANS_YADE; }
  bool has_grains() const { return couple != FLUID; }
  bool solves() const { return couple == TWO || couple == FLUID; }
  bool averages() const { return couple == ONE || couple == TWO; }
  /* Errors, unless a solve over T in steps of dt may be done. what: the keyword that asks for it. */
  void check_solve(const Voice &what, double T, double step) const;
  bool fluctuates() const { return fluctuations.kind != Fluctuations::NONE; }
  bool wants_pores() const
  {
    return fluid.turbulence == SD_VANS_PORE || fluid.turbulence == SD_VANS_ROUSSEAU ||
        fluid.turbulence == SD_VANS_NI_CAPART || fluid.bed_mixing > 0.0;
  }

 private:
  std::string mesh_file, profile_file, given_file, convective_file, intensity_file;
  void read(Keywords &in);
  void take_mesh(Keywords &in);
  void take_classes(Keywords &in);
  void take_class_radii(Keywords &in);
  void take_fluctuation(Keywords &in);
  void take_intensity(Keywords &in);
  void take_fluid(Keywords &in);
  void take_drag(Keywords &in);
  void take_hindrance(Keywords &in);
  void take_surface(Keywords &in);
  void take_sidewall(Keywords &in);
  void check(const Keywords &in) const;
  void check_yade(const Keywords &in) const;
  void read_files();
};

}    // namespace StokesDyn
#endif
