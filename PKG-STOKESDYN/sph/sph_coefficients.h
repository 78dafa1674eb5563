/* What pair_style sph/artVisc/tensCorr and its pair_coeff say: the terms of the model, and numbers for each
 * pair of types. Those that are not given follow from the numbers of both types, from fix property/global
 * and from the pair_style. See doc/pair_sph_artvisc_tenscorr.md. */
#ifndef SD_SPH_COEFFICIENTS_H
#define SD_SPH_COEFFICIENTS_H

#include "keywords.h"
#include "sd_sph_rheology.h"
#include "sd_sph_sums.h"

#include <array>
#include <string>
#include <vector>

namespace StokesDyn {

class SphCoefficients {
 public:
  double smoothing_length(int itype) const { return table[H][itype][itype]; }
  double sound_speed(int itype) const { return table[C][itype][itype]; }
  bool has_sound_speed(int itype) const;
  bool takes(int itype) const { return table[H][itype][itype] > 0.0; }
  bool is_newtonian() const { return law == SD_SPH_NEWTON; }
  sd_sph_friction explicit_friction() const { return implicit ? SD_SPH_INVISCID : model.friction; }
  bool has_laplacian() const { return model.friction == SD_SPH_LAPLACIAN; }
  /* for fix sph/tension: do particles keep apart by shift, without correction? */
  bool finds_surface() const { return shifts && !corrects; }
  /* the kernel, for any place; W' for two particles of this type */
  sd_sph_kernel kernel() const { return model.kernel; }
  int dimension() const { return model.dimension; }
  double dW_dr(int itype, double r) const;
  /* Has a pair with this type coefficients? What is in use of a pair, and the law of viscosity of a type */
  bool used(int itype) const;
  sd_sph_parameters parameters(int itype, int jtype) const;
  sd_sph_rheology rheology(int itype) const;
  /* Has each particle a viscosity, of its type and perhaps of its shear rate, in place of pairs of types? */
  bool has_own_viscosities() const { return implicit || law != SD_SPH_NEWTON; }

  const Voice voice;
  /* its scheme and delta are set by who knows the fixes that take part */
  sd_sph_model model = {};
  bool shifts = false, pliant = false, corrects = false, implicit = false;

 protected:
  enum Parameter { H, C, ALPHA, BETA, DELTAP, MU, TAU, N, MU_MAX, LAMBDA, NPARAMETERS };
  static const char *const PARAMETER[NPARAMETERS];
  using Values = std::array<double, NPARAMETERS>;

  explicit SphCoefficients(const Voice &voice) : voice(voice) {}
  ~SphCoefficients();
  SphCoefficients(const SphCoefficients &) = delete;
  SphCoefficients &operator=(const SphCoefficients &) = delete;

  // --- pair_style

  std::vector<std::string> args;    // for restart files
  sd_sph_law law = SD_SPH_NEWTON;
  double defaults[NPARAMETERS];
  void parse();

  // --- pair_coeff: NaN: not given; and what is in use

  double **given[NPARAMETERS] = {}, **table[NPARAMETERS] = {};
  /* set: setflag of the pair style */
  void allocate_tables(int types, int **set);
  /* unlike: of no type with itself */
  Values read_values(Keywords &in, bool unlike) const;

  // --- a run

  /* that of the only equation of state; 0: there are several, or it has none */
  double rho0 = 0.0;
  /* The numbers in use of a pair of types, with all that they must hold. Returns the support. */
  double mix(int i, int j);

 private:
  int **set = nullptr;
  void read_law(Keywords &in);
  static bool may_vanish(int parameter);
  double mixed(int parameter, int i, int j) const;
  double spacing(int itype) const;
  void check_values(const Voice &of, int i, int j) const;
  void check_law(int itype) const;
};

}    // namespace StokesDyn
#endif
