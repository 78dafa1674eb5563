#include "pair_sph_artvisc_tenscorr.h"

#include "fix_sph_settings.h"
#include "fix_sph_shift.h"
#include "fixes.h"

#include "sd_lattice.h"
#include "sd_sph_wall.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

const char *const PairSph::PARAMETER[NPARAMETERS] = {"h",    "c",      "alpha",
                                                       "beta", "deltap", "mu", "tau",
                                                       "n",    "mumax",  "lambda"};

PairSph *PairSph::of(const Voice &voice)
{
  return static_cast<PairSph *>(Sph::require_pair(voice));
}

PairSph *PairSph::prepared(const Voice &voice)
{
  PairSph *pair = of(voice);
  pair->require_prepared();
  return pair;
}

bool PairSph::may_vanish(int parameter)
{
  return parameter == ALPHA || parameter == BETA || parameter == TAU;
}

/* pair_style hybrid copies all of this when it has read its own line, before init_style: rows of every
 * scheme have to fit, and the virial is summed pair by pair, as shift and correction put no force on
 * ghosts. */
PairSph::PairSph(LAMMPS *lmp) :
    GhostRows(lmp), voice(lmp, "Pair style " + std::string(STYLE)),
    shift_fix(voice, "SPH_SHIFT_STATE", FixSphShift::STYLE), friction_fix(voice, "SPH_FRICTION", FRICTION_STYLE),
    moved_box(lmp)
{
  single_enable = 1;
  respa_enable = 0;
  restartinfo = 1;
  no_virial_fdotr_compute = 1;
  comm_forward = 16;    // slope4, du4 and B8
  comm_reverse = SD_SPH_MOTION;
}

PairSph::~PairSph()
{
  if (asked_for_velocities) comm->ghost_velocity = 0;    // as it was
  shift_fix.take_away();
  friction_fix.take_away();
  if (!allocated) return;
  memory->destroy(setflag);
  memory->destroy(cutsq);
  for (int k = 0; k < NPARAMETERS; k++) {
    memory->destroy(given[k]);
    memory->destroy(table[k]);
  }
}

// --- settings -----------------------------------------------------------------------------------

void PairSph::settings(int narg, char **arg)
{
  args = words(narg, arg);
  members.clear();    // other settings want a run that is prepared
  parse();
}

void PairSph::parse()
{
  for (double &value : defaults) value = NAN;
  model = sd_sph_model();
  shifts = pliant = corrects = implicit = false;
  law = SD_SPH_NEWTON;
  Keywords in(lmp, voice.command, args);
  if (!in.next()) voice.fail("the kernel is missing: give cubicspline or wendland, then the smoothing length h");
  const bool flat = in.is("cubicspline2d") || in.is("wendland2d");
  model.dimension = flat ? 2 : domain->dimension;
  if (in.is("cubicspline") || in.is("cubicspline2d"))
    model.kernel = SD_SPH_CUBICSPLINE;
  else if (in.is("wendland") || in.is("wendland2d"))
    model.kernel = SD_SPH_WENDLAND;
  else
    voice.fail("unknown kernel '" + args[0] +
               "': it must be one of cubicspline, wendland, cubicspline2d, wendland2d");
  defaults[H] = in.positive();
  in.parse({
      {"artVisc",
       [&] {
         model.artvisc = 1;
         defaults[ALPHA] = in.not_negative();
         defaults[BETA] = in.not_negative();
         model.eta = in.not_negative();
       }},
      {"tensCorr",
       [&] {
         model.tenscorr = 1;
         model.epsilon = in.not_negative();
         defaults[DELTAP] = in.positive();
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
void PairSph::read_law(Keywords &in)
{
  enum { POWER_LAW, BINGHAM, HERSCHEL_BULKLEY, CARREAU };
  const size_t kind = in.choice({"power_law", "bingham", "herschel_bulkley", "carreau"});
  law = kind == CARREAU ? SD_SPH_CARREAU : SD_SPH_HERSCHEL_BULKLEY;
  defaults[TAU] = kind == BINGHAM || kind == HERSCHEL_BULKLEY ? in.not_negative() : 0.0;
  defaults[LAMBDA] = kind == CARREAU ? in.positive() : 1.0;
  defaults[N] = kind == BINGHAM ? 1.0 : in.positive();
  defaults[MU_MAX] = in.positive();
}

sd_sph_rheology PairSph::rheology(int t) const
{
  return {law, table[MU][t][t], table[TAU][t][t], table[N][t][t], table[MU_MAX][t][t], table[LAMBDA][t][t]};
}

/* What the commands have not seen together, and what fix adapt sets. */
void PairSph::check_law(int t) const
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

void PairSph::allocate()
{
  allocated = 1;
  const int n = atom->ntypes + 1;
  memory->create(setflag, n, n, "pair:setflag");
  memory->create(cutsq, n, n, "pair:cutsq");
  for (int k = 0; k < NPARAMETERS; k++) {
    memory->create(given[k], n, n, "pair:given");
    memory->create(table[k], n, n, "pair:table");
  }
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      setflag[i][j] = 0;
      for (int k = 0; k < NPARAMETERS; k++) given[k][i][j] = table[k][i][j] = NAN;
    }
}

void PairSph::coeff(int narg, char **arg)
{
  const Voice of_coeff(lmp, "Pair_coeff of " + std::string(STYLE));
  if (narg < 2) of_coeff.fail("the two atom types are missing");
  if (!allocated) allocate();
  int ilo, ihi, jlo, jhi;
  utils::bounds(FLERR, arg[0], 1, atom->ntypes, ilo, ihi, error);
  utils::bounds(FLERR, arg[1], 1, atom->ntypes, jlo, jhi, error);

  double values[NPARAMETERS];
  for (double &value : values) value = NAN;
  Keywords in(lmp, of_coeff.command, words(narg, arg), 2);
  while (in.next()) {
    int k = 0;
    while (k < NPARAMETERS && !in.is(PARAMETER[k])) k++;
    if (k == NPARAMETERS) in.unknown({PARAMETER, PARAMETER + NPARAMETERS});
    if ((k == ALPHA || k == BETA) && !model.artvisc) in.refuse("the pair_style has no artVisc");
    if (k == DELTAP && !model.tenscorr && !shifts) in.refuse("the pair_style has no tensCorr");
    if (k == MU && !model.friction) in.refuse("the pair_style has no viscosity");
    if (k > MU && law == SD_SPH_NEWTON) in.refuse("the pair_style has no rheology");
    if (k >= MU && has_own_viscosities() && ihi < jlo)
      in.refuse("with rheology and with implicit each particle has the viscosity of its own type, and a pair "
                "their harmonic mean: give it by pair_coeff I I");
    values[k] = may_vanish(k) ? in.not_negative() : in.positive();
  }

  int count = 0;
  for (int i = ilo; i <= ihi; i++)
    for (int j = std::max(jlo, i); j <= jhi; j++) {
      setflag[i][j] = 1;
      for (int k = 0; k < NPARAMETERS; k++)
        if (!std::isnan(values[k])) given[k][i][j] = values[k];
      count++;
    }
  if (count == 0)
    of_coeff.fail(std::string("there is no pair of types '") + arg[0] + " " + arg[1] +
                  "': the first type must not be larger than the second");
}

double PairSph::mixed(int k, int i, int j) const
{
  if (!std::isnan(given[k][i][j])) return given[k][i][j];
  if (i == j) {
    for (const auto *fix : fixes_of<FixPropertyGlobal>(lmp))
      if (k == (fix->property == "sl" ? H : C)) return fix->of_type[i - 1];
    return k == DELTAP && shifts && !model.tenscorr ? spacing(i) : defaults[k];
  }
  const double a = mixed(k, i, i), b = mixed(k, j, j);
  // the stress is continuous between two viscosities, as that of two layers in series
  return k == MU ? 2.0 * a * b / (a + b) : 0.5 * (a + b);
}

/* The distance of particles that W is compared with for shift. */
double PairSph::spacing(int itype) const
{
  const double rho0 = pressures.size() == 1 ? pressures[0]->state.rho0 : 0.0;
  if (!(rho0 > 0.0) || atom->rmass)
    voice.fail("shift needs the initial distance of particles: give it by pair_coeff " +
               std::to_string(itype) + " " + std::to_string(itype) +
               " deltap VALUE; the style itself computes it, as (mass/rho0)^(1/dimension), only where "
               "there is one fix sph/pressure with a rho0 and one mass per type");
  return pow(atom->mass[itype] / rho0, 1.0 / model.dimension);
}

/* A cut-off (the skin is added) for which LAMMPS would make ghosts without end: no counter of its own
 * may overflow, and where the length is more than ten periodic boxes ten million atoms in all images
 * are enough. */
static void refuse_endless_ghosts(LAMMPS *lmp, const std::string &what, double length)
{
  const Domain *domain = lmp->domain;
  const double cut = length + lmp->neighbor->skin;
  double boxes = 0.0, periodic_boxes = 0.0, atoms = lmp->atom->natoms, swaps = 0.0;
  for (int d = 0; d < domain->dimension; d++) {
    const double across = sd_across_faces(domain->h, d, cut);
    boxes = std::max(boxes, across);
    swaps = std::max(swaps, across * lmp->comm->procgrid[d]);
    if (!domain->periodicity[d]) continue;
    atoms *= 2.0 * across + 1.0;
    periodic_boxes = std::max(periodic_boxes, across);
  }
  const double most = periodic_boxes > 10.0 ? 1e7 : (double) MAXSMALLINT;
  if (atoms < most && swaps < MAXSMALLINT) return;
  fail(lmp,
       what + " is " + text(boxes) +
           " times the box, which is more than LAMMPS can make ghost atoms for: is it in other units?");
}

double PairSph::init_one(int i, int j)
{
  const std::string types = "types " + std::to_string(i) + " and " + std::to_string(j);
  const Voice of = voice.of(types);
  for (int k = 0; k < NPARAMETERS; k++) table[k][i][j] = table[k][j][i] = mixed(k, i, j);
  // the commands have seen to this; fix adapt has not
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
  const double support = 2.0 * table[H][i][j];
  refuse_endless_ghosts(lmp, of.command + ": the support 2 h = " + text(support), support);
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

double PairSph::viscosity(int i) const
{
  if (law != SD_SPH_NEWTON) return is_wall(i) ? 0.0 : viscosities[i];
  const int t = atom->type[i];
  return model.friction ? table[MU][t][t] : 0.0;
}

bool PairSph::has_sound_speed(int itype) const
{
  return !std::isnan(table[C][itype][itype]);
}

void PairSph::reverse(double *rows, int width, bool keep_largest)
{
  if (shared && force->newton_pair) GhostRows::reverse(rows, width, keep_largest);
}

void *PairSph::extract(const char *name, int &dim)
{
  dim = 0;
  if (strcmp(name, "viscosity") == 0) return &defaults[MU];
  if (strcmp(name, "eta") == 0) return &model.eta;
  if (strcmp(name, "epsilon") == 0) return &model.epsilon;
  dim = 2;
  for (int k = 0; k < NPARAMETERS; k++)
    if (strcmp(name, PARAMETER[k]) == 0) return given[k];    // fix adapt then has init_one called
  return nullptr;
}

void PairSph::Neighbours::resize(int particles, size_t entries)
{
  if (pool.size() < entries) pool.resize(entries + entries / 8);
  if ((int) own.size() >= particles) return;
  for (auto *v : {&own, &count}) v->resize(particles);
  neighbor.resize(particles);
}

double PairSph::Neighbours::bytes() const
{
  return sizeof(int) * (pool.capacity() + own.capacity() + count.capacity()) +
      sizeof(int *) * neighbor.capacity();
}

double PairSph::memory_usage()
{
  double bytes = near.bytes() + around.bytes() + of_flow.bytes();
  for (const auto *v : {&x4, &v4, &f4, &sums, &weights, &slope4, &du4, &B8, &own, &rubs, &scratch})
    bytes += v->capacity() * sizeof(double);
  for (const auto *v : {&P, &masses, &rate, &each, &kick, &wall_rows, &displacing, &viscosities, &inertia})
    bytes += v->capacity() * sizeof(double);
  for (const auto *v : {&classes, &phases})
    bytes += v->capacity() * sizeof(int);
  return bytes;
}

bool PairSph::used(int itype) const
{
  for (int j = 1; j <= atom->ntypes; j++)
    if (setflag[std::min(itype, j)][std::max(itype, j)]) return true;
  return false;
}
