#include "sph_coefficients.h"

#include "fix_sph_settings.h"
#include "fixes.h"

#include "atom.h"
#include "domain.h"
#include "memory.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

const char *const SphCoefficients::PARAMETER[NPARAMETERS] = {"h",  "c",   "alpha", "beta",  "deltap",
                                                             "mu", "tau", "n",     "mumax", "lambda"};

bool SphCoefficients::may_vanish(int parameter)
{
  return parameter == ALPHA || parameter == BETA || parameter == TAU;
}

SphCoefficients::~SphCoefficients()
{
  for (int k = 0; k < NPARAMETERS; k++) {
    voice.lmp->memory->destroy(given[k]);
    voice.lmp->memory->destroy(table[k]);
  }
}

// --- pair_style ---------------------------------------------------------------------------------

void SphCoefficients::parse()
{
  for (double &value : defaults) value = NAN;
  model = sd_sph_model();
  shifts = pliant = corrects = implicit = false;
  law = SD_SPH_NEWTON;
  Keywords in(voice.lmp, voice.command, args);
  if (!in.next()) voice.fail("the kernel is missing: give cubicspline or wendland, then the smoothing length h");
  const bool flat = in.is("cubicspline2d") || in.is("wendland2d");
  model.dimension = flat ? 2 : voice.lmp->domain->dimension;
  if (in.is("cubicspline") || in.is("cubicspline2d"))
    model.kernel = SD_SPH_CUBICSPLINE;
  else if (in.is("wendland") || in.is("wendland2d"))
    model.kernel = SD_SPH_WENDLAND;
  else
    voice.fail("unknown kernel '" + args[0] +
               "': it must be one of cubicspline, wendland, cubicspline2d, wendland2d");
  defaults[H] = in.value("h").positive();
  in.parse({
      {"artVisc",
       [&] {
         model.artvisc = 1;
         defaults[ALPHA] = in.value("alpha").not_negative();
         defaults[BETA] = in.value("beta").not_negative();
         model.eta = in.value("eta").not_negative();
       }},
      {"tensCorr",
       [&] {
         model.tenscorr = 1;
         model.epsilon = in.value("epsilon").not_negative();
         defaults[DELTAP] = in.value("deltap").positive();
       }},
      {"viscosity",
       [&] {
         defaults[MU] = in.positive();
         model.friction = in.take("central") ? SD_SPH_CENTRAL : SD_SPH_LAPLACIAN;
         if (model.friction == SD_SPH_LAPLACIAN) in.take("laplacian");
       }},
      {"rheology", [&] { read_law(in); }},
      {"shift",
       [&] {
         // no word that is the name of a pair style: hybrid takes it for the next one
         enum { NO, YES, PLIANT };
         const size_t how = in.choice({"no", "yes", "pliant"});
         shifts = how != NO;
         pliant = how == PLIANT;
       }},
      {"correction", [&] { corrects = in.yes_no(); }},
      {"implicit", [&] { implicit = in.yes_no(); }},
  });
  in.require(shifts || !corrects || !in.given("shift"),
             "correction yes switches shift on: leave shift no out");
  in.require(!pliant || !corrects,
             "correction yes has a shift of its own, which has nothing that resists: leave shift pliant out");
  shifts = shifts || corrects;
  in.require(law == SD_SPH_NEWTON || model.friction,
             "keyword rheology needs keyword viscosity, whose number is mu of the law");
  in.require(!implicit || model.friction, "keyword implicit needs keyword viscosity, whose friction it makes implicit");
}

/* A law of viscosity. What it does not ask for has the value with which it does nothing. */
void SphCoefficients::read_law(Keywords &in)
{
  enum { POWER_LAW, BINGHAM, HERSCHEL_BULKLEY, CARREAU };
  const size_t kind = in.choice({"power_law", "bingham", "herschel_bulkley", "carreau"});
  law = kind == CARREAU ? SD_SPH_CARREAU : SD_SPH_HERSCHEL_BULKLEY;
  defaults[TAU] = kind == BINGHAM || kind == HERSCHEL_BULKLEY ? in.not_negative() : 0.0;
  defaults[LAMBDA] = kind == CARREAU ? in.positive() : 1.0;
  defaults[N] = kind == BINGHAM ? 1.0 : in.positive();
  defaults[MU_MAX] = in.value("mumax").positive();
}

// --- pair_coeff ---------------------------------------------------------------------------------

void SphCoefficients::allocate_tables(int types, int **setflag)
{
  set = setflag;
  const int n = types + 1;
  for (int k = 0; k < NPARAMETERS; k++) {
    voice.lmp->memory->create(given[k], n, n, "pair:given");
    voice.lmp->memory->create(table[k], n, n, "pair:table");
    for (int i = 0; i < n; i++)
      for (int j = 0; j < n; j++) given[k][i][j] = table[k][i][j] = NAN;
  }
}

SphCoefficients::Values SphCoefficients::read_values(Keywords &in, bool unlike) const
{
  Values values;
  values.fill(NAN);
  while (in.next()) {
    int k = 0;
    while (k < NPARAMETERS && !in.is(PARAMETER[k])) k++;
    if (k == NPARAMETERS) in.unknown({PARAMETER, PARAMETER + NPARAMETERS});
    if ((k == ALPHA || k == BETA) && !model.artvisc) in.refuse("the pair_style has no artVisc");
    if (k == DELTAP && !model.tenscorr && !shifts) in.refuse("the pair_style has no tensCorr");
    if (k == MU && !model.friction) in.refuse("the pair_style has no viscosity");
    if (k > MU && law == SD_SPH_NEWTON) in.refuse("the pair_style has no rheology");
    if (k >= MU && has_own_viscosities() && unlike)
      in.refuse("with rheology and with implicit each particle has the viscosity of its own type, and a pair "
                "their harmonic mean: give it by pair_coeff I I");
    values[k] = may_vanish(k) ? in.not_negative() : in.positive();
  }
  return values;
}

// --- a run --------------------------------------------------------------------------------------

double SphCoefficients::mixed(int k, int i, int j) const
{
  if (!std::isnan(given[k][i][j])) return given[k][i][j];
  if (i == j) {
    for (const auto *fix : fixes_of<FixPropertyGlobal>(voice.lmp))
      if (k == (fix->property == "sl" ? H : C)) return fix->of_type[i - 1];
    return k == DELTAP && shifts && !model.tenscorr ? spacing(i) : defaults[k];
  }
  const double a = mixed(k, i, i), b = mixed(k, j, j);
  // the stress is continuous between two viscosities, as that of two layers in series
  return k == MU ? 2.0 * a * b / (a + b) : 0.5 * (a + b);
}

/* The distance of particles that W is compared with for shift. */
double SphCoefficients::spacing(int itype) const
{
  const Atom *atom = voice.lmp->atom;
  if (!(rho0 > 0.0) || atom->rmass)
    voice.fail("shift needs the initial distance of particles: give it by pair_coeff " +
               std::to_string(itype) + " " + std::to_string(itype) +
               " deltap VALUE; the style itself computes it, as (mass/rho0)^(1/dimension), only where "
               "there is one fix sph/pressure with a rho0 and one mass per type");
  return pow(atom->mass[itype] / rho0, 1.0 / model.dimension);
}

bool SphCoefficients::used(int itype) const
{
  for (int j = 1; j <= voice.lmp->atom->ntypes; j++)
    if (set[std::min(itype, j)][std::max(itype, j)]) return true;
  return false;
}

sd_sph_parameters SphCoefficients::parameters(int i, int j) const
{
  return {table[H][i][j],    table[C][i][j],      table[ALPHA][i][j],
          table[BETA][i][j], table[DELTAP][i][j], table[MU][i][j]};
}

sd_sph_rheology SphCoefficients::rheology(int t) const
{
  return {law, table[MU][t][t], table[TAU][t][t], table[N][t][t], table[MU_MAX][t][t], table[LAMBDA][t][t]};
}

/* What the commands have not seen together, and what fix adapt sets. */
void SphCoefficients::check_law(int t) const
{
  const sd_sph_rheology fluid = rheology(t);
  const Voice of = voice.of("keyword rheology: type " + std::to_string(t));
  if (fluid.law == SD_SPH_CARREAU && fluid.n > 1.0)
    of.fail("n = " + text(fluid.n) + " must be at most 1 with carreau");
  if ((fluid.law == SD_SPH_CARREAU || fluid.n == 1.0) && fluid.mu_max < fluid.mu)
    of.fail("mumax = " + text(fluid.mu_max) + " must not be smaller than mu = " + text(fluid.mu) +
            ", the viscosity in fast shear: pair_coeff " + std::to_string(t) + " " + std::to_string(t) +
            " mumax VALUE");
}

/* The commands have seen to this; fix adapt has not. */
void SphCoefficients::check_values(const Voice &of, int i, int j) const
{
  auto require = [&](bool holds, const Voice &who, const std::string &what, double value,
                     const char *rule) {
    if (!holds) who.fail("keyword " + what + "'" + text(value) + "' must be " + rule);
  };
  if (model.artvisc) require(model.eta >= 0.0, voice, "artVisc: eta ", model.eta, ">= 0");
  if (model.tenscorr)
    require(model.epsilon >= 0.0, voice, "tensCorr: epsilon ", model.epsilon, ">= 0");
  if (model.friction) require(defaults[MU] > 0.0, voice, "viscosity: ", defaults[MU], "> 0");
  for (int k = 0; k < NPARAMETERS; k++) {
    const double value = table[k][i][j];
    require(std::isnan(value) || value > 0.0 || (may_vanish(k) && value == 0.0), of,
            std::string(PARAMETER[k]) + ": ", value, may_vanish(k) ? ">= 0" : "> 0");
  }
  if (law != SD_SPH_NEWTON && i == j) check_law(i);
}

double SphCoefficients::mix(int i, int j)
{
  for (int k = 0; k < NPARAMETERS; k++) table[k][i][j] = table[k][j][i] = mixed(k, i, j);
  const Voice of = voice.of("types " + std::to_string(i) + " and " + std::to_string(j));
  check_values(of, i, j);
  const double support = 2.0 * table[H][i][j];
  const std::string cure = std::to_string(i) + " " + std::to_string(i) + " c VALUE";
  if (model.artvisc && std::isnan(table[C][i][j]))
    of.fail("keyword artVisc needs the speed of sound: pair_coeff " + cure);
  if (model.delta > 0.0 && std::isnan(table[C][i][j]))
    of.fail("delta of fix sph/density/continuity needs the speed of sound: pair_coeff " + cure);
  if ((model.tenscorr || shifts) && !(table[DELTAP][i][j] < support))
    of.fail("deltap " + text(table[DELTAP][i][j]) +
            " must be smaller than the support 2 h = " + text(support));
  return support;
}

bool SphCoefficients::has_sound_speed(int itype) const
{
  return !std::isnan(table[C][itype][itype]);
}

double SphCoefficients::dW_dr(int itype, double r) const
{
  return r * sd_sph_dW_over_r(model.kernel, model.dimension, r, table[H][itype][itype]);
}
