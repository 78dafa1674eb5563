/* fix sph/grains: grains smaller than h in the water of SPH. Of a step the pair style asks it for
 * the volume fraction of grains, which the water's state needs, and it puts drag and the water's
 * stress on the grains when the force of SPH is known. See doc/fix_sph_grains.md. */
#ifndef SD_FIX_SPH_GRAINS_H
#define SD_FIX_SPH_GRAINS_H

#include "end_of_run.h"
#include "sd_sph_grains.h"
#include "sph.h"
#include "water_around.h"

#include <vector>

namespace StokesDyn {

class FixSphGrains : public SphFix {
 public:
  static constexpr const char *STYLE = "sph/grains";

  FixSphGrains(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup_pre_exchange() override;
  void setup(int vflag) override;
  void post_force(int) override;
  void post_run() override;
  double compute_vector(int) override;

  // --- for the pair style; arrays of particles are of this rank and its ghosts -------------------
  /* phi of the water where particles are now; in the first setup of the life of the fix water
   * loses what the grains displace. */
  void find_fractions();
  const double *fractions() const { return phi.data(); }
  /* of owned atom i as the last step has left it */
  double fraction(int i) const { return rows[i][0]; }
  /* [3 n] the velocity of the mixture, of that of particles, v [3 n]: what the rate of the density
   * goes by */
  const double *mixture(const double *v);
  /* Rates of the density [nlocal] of that velocity become those of the water itself. */
  void divide_rates(const double *slope, const double *du, double *rate);

 protected:
  bool restored() const override { return filled != 0.0; }
  std::vector<SavedNumbers> saved() override { return {{"filled", &filled}}; }
  void write_state(NamedState &) override;
  void read_state(const NamedState &) override;

 private:
  // settings
  double viscosity = 0.0;
  bool fills = true, own_flow = true;
  sd_sph_grain_law law = {};
  sd_sph_wake wake = {};
  void parse_hindrance(Keywords &in);

  // groups of integrators, of what holds grains, of rigid bodies
  int free_bits = 0, held_bits = 0, body_bits = 0;

  // kept with atoms: phi; phi, force of the water on grains or of grains on water
  AtomArray rows, shown;
  double filled = 0.0;
  EndOfRun end;
  /* by which law and time step the last run found its forces */
  std::vector<double> law_of_end;
  std::vector<double> law_of_now() const;
  /* neither the grains nor this law have changed since the last run */
  bool same_forces = false;
  bool resumes() const;

  // a step
  WaterAround around;
  std::vector<double> phi, mean_phi, moved, volume, wet, own;
  // radius, volume, mass: HUGE_VAL of those that forces do not move
  std::vector<double> a, V, M;
  double total[3] = {0.0, 0.0, 0.0}, largest = 0.0;
  sd_sph_grains are_grains() const { return {a.data(), V.data(), wet.data()}; }
  /* [3 grains]: rows of one of LAMMPS's arrays of vectors */
  std::vector<double> rows_of_grains(double **vectors) const;
  void check_scene();
  void look_at_strangers();
  bool is_too_large(double diameter) const;
  std::string says_too_large(double diameter) const;
  void find_held();
  void recall();
  void weigh();
  void sum_fractions();
  void displace();
  void check_fractions();
  void check_bodies(const std::vector<double> &k);
  void stresses(std::vector<double> &F);
  /* velocities [3 grains] */
  struct Slip {
    std::vector<double> water, grains;
  };
  Slip slip_of_now();
  Slip slip_without_drag(const std::vector<double> &F);
  std::vector<double> drag_factors();
  void drags(const std::vector<double> &F, std::vector<double> &D);
  void give_back(const std::vector<double> &D);
};

}    // namespace StokesDyn
#endif
