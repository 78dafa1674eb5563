#include "fix_sph_shift.h"

#include "keywords.h"
#include "lammps_compat.h"

#include "atom.h"
#include "modify.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static const char *const ID = "SPH_SHIFT_STATE";
static constexpr int DU = 3, WHOLE = 1, REST = 9;    // columns

void FixSphShift::take_away(LAMMPS *lmp)
{
  const Fix *fix = lmp->modify->nfix > 0 ? Compat::fix(lmp->modify, ID) : nullptr;
  if (fix && strcmp(fix->style, STYLE) == 0) lmp->modify->delete_fix(ID);
}

FixSphShift *FixSphShift::provide(LAMMPS *lmp, bool wanted, bool matrices)
{
  const Fix *fix = Compat::fix(lmp->modify, ID);
  if (fix && strcmp(fix->style, STYLE) != 0)
    fail(lmp,
         "Pair style sph/artVisc/tensCorr: the fix ID " + std::string(ID) +
             " is taken; give that fix another ID");
  if (!wanted || (fix && static_cast<const FixSphShift *>(fix)->matrices != matrices))
    take_away(lmp);
  if (!wanted) return nullptr;
  if (!Compat::fix(lmp->modify, ID))
    lmp->modify->add_fix(std::string(ID) + " all " + STYLE + (matrices ? " matrices" : ""));
  return static_cast<FixSphShift *>(Compat::fix(lmp->modify, ID));
}

FixSphShift::FixSphShift(LAMMPS *lmp, int narg, char **arg) :
    RowsFix(lmp, narg, arg), matrices(narg > 3), shifts(DU), wholes(WHOLE), rest(REST)
{
  restart_global = 1;
  comm_border = DU;
  std::vector<RowsOfAtoms *> all = {&shifts, &wholes};
  if (matrices) all.push_back(&rest);
  keep(all, nullptr, true, WITH_BORDERS);
}

int FixSphShift::pack_border(int n, int *list, double *buf)
{
  for (int k = 0; k < n; k++) std::copy_n(shifts[list[k]], DU, buf + DU * k);
  return DU * n;
}

int FixSphShift::unpack_border(int n, int first, double *buf)
{
  for (int k = 0; k < n; k++) std::copy_n(buf + DU * k, DU, shifts.give(first + k));
  return DU * n;
}

void FixSphShift::keep_rows(int n, const double *order, const double *kick)
{
  const size_t columns = matrices ? 16 : 8;
  for (int i = 0; i < n; i++) std::copy_n(order + columns * i + 4, DU, shifts.give(i));
  for (int i = 0; i < atom->nlocal; i++) *wholes.give(i) = order[columns * i + 7];
  has_rows = 1.0;
  if (!matrices) return;
  for (int i = 0; i < atom->nlocal; i++) {
    double *row = rest.give(i);
    std::copy_n(order + columns * i + 8, 6, row);
    std::copy_n(kick + 3 * (size_t) i, 3, row + 6);
  }
}

void FixSphShift::put_back(double *order, double *kick) const
{
  const size_t columns = matrices ? 16 : 8;
  for (int i = 0; i < atom->nlocal; i++) {
    std::copy_n(shifts[i], DU, order + columns * i + 4);
    order[columns * i + 7] = *wholes[i];
    if (!matrices || !rest.has(i)) continue;    // a new atom: B and kick of this moment
    std::copy_n(rest[i], 6, order + columns * i + 8);
    std::copy_n(rest[i] + 6, 3, kick + 3 * (size_t) i);
  }
}
