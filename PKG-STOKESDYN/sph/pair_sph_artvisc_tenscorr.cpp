#include "pair_sph_artvisc_tenscorr.h"

#include "fix_sph_shift.h"

#include "sd_lattice.h"
#include "sd_sph_wall.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "neighbor.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

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

/* pair_style hybrid copies all of this when it has read its own line, before init_style: rows of every
 * scheme have to fit, and the virial is summed pair by pair, as shift and correction put no force on
 * ghosts. */
PairSph::PairSph(LAMMPS *lmp) :
    GhostRows(lmp), SphCoefficients(Voice(lmp, "Pair style " + std::string(STYLE))),
    shift_fix(voice, "SPH_SHIFT_STATE", FixSphShift::STYLE), friction_fix(voice, "SPH_FRICTION", FRICTION_STYLE),
    roles(*this), rows(*this, roles), middle(*this, roles, rows, *this), walls(*this, roles, rows, *this),
    viscosities(*this, roles, rows, *this), forces(*this, roles, rows, middle, viscosities, *this),
    checks(*this, roles, rows, *this), moved_box(lmp)
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
}

// --- settings -----------------------------------------------------------------------------------

void PairSph::settings(int narg, char **arg)
{
  args = words(narg, arg);
  roles.forget();    // other settings want a run that is prepared
  parse();
}

void PairSph::allocate()
{
  allocated = 1;
  const int n = atom->ntypes + 1;
  memory->create(setflag, n, n, "pair:setflag");
  memory->create(cutsq, n, n, "pair:cutsq");
  for (int i = 0; i < n; i++) std::fill_n(setflag[i], n, 0);
  SphCoefficients::allocate_tables(atom->ntypes, setflag);
}

void PairSph::coeff(int narg, char **arg)
{
  const Voice of_coeff(lmp, "Pair_coeff of " + std::string(STYLE));
  if (narg < 2) of_coeff.fail("the two atom types are missing");
  if (!allocated) allocate();
  int ilo, ihi, jlo, jhi;
  utils::bounds(FLERR, arg[0], 1, atom->ntypes, ilo, ihi, error);
  utils::bounds(FLERR, arg[1], 1, atom->ntypes, jlo, jhi, error);

  Keywords in(lmp, of_coeff.command, words(narg, arg), 2);
  const Values values = read_values(in, ihi < jlo);

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
  const double support = mix(i, j);
  refuse_endless_ghosts(lmp, voice.command + ": types " + std::to_string(i) + " and " + std::to_string(j) +
                        ": the support 2 h = " + text(support), support);
  return support;
}

void PairSph::reverse(double *of, int width, bool keep_largest)
{
  if (rows.shared && force->newton_pair) GhostRows::reverse(of, width, keep_largest);
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

double PairSph::memory_usage()
{
  return rows.bytes() + middle.bytes() + walls.bytes() + viscosities.bytes() + forces.bytes();
}
