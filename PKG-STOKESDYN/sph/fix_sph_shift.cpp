#include "fix_sph_shift.h"

#include "keywords.h"
#include "lammps_compat.h"
#include "named_state.h"

#include "atom.h"
#include "comm.h"
#include "modify.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static const char *const ID = "SPH_SHIFT_STATE";
static constexpr int DU = 3, REST = 9;    // columns

FixSphShift *FixSphShift::provide(LAMMPS *lmp, bool wanted, bool correction)
{
  Fix *fix = Compat::fix(lmp->modify, ID);
  if (fix && strcmp(fix->style, STYLE) != 0)
    fail(lmp,
         "Pair style sph/artVisc/tensCorr: the fix ID " + std::string(ID) +
             " is taken; give that fix another ID");
  auto *found = static_cast<FixSphShift *>(fix);
  if (found && (!wanted || found->correction != correction)) {
    lmp->modify->delete_fix(ID);
    found = nullptr;
  }
  if (found || !wanted) return found;
  lmp->modify->add_fix(std::string(ID) + " all " + STYLE + (correction ? " correction" : ""));
  return static_cast<FixSphShift *>(Compat::fix(lmp->modify, ID));
}

FixSphShift::FixSphShift(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), correction(narg > 3)
{
  restart_peratom = restart_global = create_attribute = 1;
  comm_border = DU;
  maxexchange = correction ? DU + REST : DU;
  grow_arrays(atom->nmax);
  for (int what : {Atom::GROW, Atom::RESTART, Atom::BORDER}) atom->add_callback(what);
}

FixSphShift::~FixSphShift()
{
  for (int what : {Atom::GROW, Atom::RESTART, Atom::BORDER}) atom->delete_callback(id, what);
}

void FixSphShift::grow_arrays(int nmax)
{
  shifts.resize(DU * (size_t) nmax);
  if (correction) rest.resize(REST * (size_t) nmax);
}

void FixSphShift::copy_arrays(int i, int j, int /*delflag*/)
{
  std::copy_n(&shifts[DU * (size_t) i], DU, &shifts[DU * (size_t) j]);
  if (correction) std::copy_n(&rest[REST * (size_t) i], REST, &rest[REST * (size_t) j]);
}

/* A new atom: not shifted before its first step, and its B is none. */
void FixSphShift::set_arrays(int i)
{
  std::fill_n(&shifts[DU * (size_t) i], DU, 0.0);
  if (!correction) return;
  std::fill_n(&rest[REST * (size_t) i], REST, 0.0);
  std::fill_n(&rest[REST * (size_t) i], 3, 1.0);
}

int FixSphShift::pack_exchange(int i, double *buf)
{
  std::copy_n(&shifts[DU * (size_t) i], DU, buf);
  if (correction) std::copy_n(&rest[REST * (size_t) i], REST, buf + DU);
  return maxexchange;
}

int FixSphShift::unpack_exchange(int i, double *buf)
{
  std::copy_n(buf, DU, &shifts[DU * (size_t) i]);
  if (correction) std::copy_n(buf + DU, REST, &rest[REST * (size_t) i]);
  return maxexchange;
}

int FixSphShift::pack_border(int n, int *list, double *buf)
{
  for (int k = 0; k < n; k++) std::copy_n(&shifts[DU * (size_t) list[k]], DU, buf + DU * k);
  return DU * n;
}

int FixSphShift::unpack_border(int n, int first, double *buf)
{
  std::copy_n(buf, DU * n, &shifts[DU * (size_t) first]);
  return DU * n;
}

int FixSphShift::pack_restart(int i, double *buf)
{
  buf[0] = 1 + maxexchange;
  return 1 + pack_exchange(i, buf + 1);
}

void FixSphShift::unpack_restart(int i, int nth)
{
  double *extra = atom->extra[i];
  int m = 0;
  for (int k = 0; k < nth; k++) m += (int) extra[m];
  if (has_rows)
    unpack_exchange(i, extra + m + 1);
  else
    set_arrays(i);
}

void FixSphShift::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  NamedState state(STYLE);
  state.put("columns", has_rows ? maxexchange : 0);
  state.write(fp);
}

void FixSphShift::restart(char *buf)
{
  NamedState state(STYLE);
  has_rows = state.read(lmp, buf) && state.get("columns", 0.0) == maxexchange;
}

void FixSphShift::keep(int n, const double *order, const double *kick)
{
  const size_t columns = correction ? 16 : 8;
  for (int i = 0; i < n; i++) std::copy_n(order + columns * i + 4, DU, &shifts[DU * (size_t) i]);
  has_rows = true;
  if (!correction) return;
  for (int i = 0; i < atom->nlocal; i++) {
    double *row = &rest[REST * (size_t) i];
    std::copy_n(order + columns * i + 8, 6, row);
    std::copy_n(kick + 3 * (size_t) i, 3, row + 6);
  }
}

void FixSphShift::put_back(double *order, double *kick) const
{
  const size_t columns = correction ? 16 : 8;
  for (int i = 0; i < atom->nlocal; i++) {
    std::copy_n(&shifts[DU * (size_t) i], DU, order + columns * i + 4);
    if (!correction) continue;
    const double *row = &rest[REST * (size_t) i];
    std::copy_n(row, 6, order + columns * i + 8);
    std::copy_n(row + 6, 3, kick + 3 * (size_t) i);
  }
}
