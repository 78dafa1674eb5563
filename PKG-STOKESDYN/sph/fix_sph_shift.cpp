#include "fix_sph_shift.h"

#include "own_fix.h"

#include "atom.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static constexpr int DU = 3, WHOLE = 1, REST = 9;    // columns

FixSphShift *FixSphShift::provide(const OwnFix &own, bool wanted, bool matrices)
{
  auto *fix = static_cast<FixSphShift *>(own.find());
  if (wanted && fix && fix->matrices == matrices) return fix;
  own.take_away();
  return wanted ? static_cast<FixSphShift *>(own.make(matrices ? "matrices" : "")) : nullptr;
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
  for (int k = 0; k < n; k++) std::copy_n(buf + DU * k, DU, shifts.writable(first + k));
  return DU * n;
}

void FixSphShift::keep_rows(int n, const double *du, const double *B, const double *kick)
{
  for (int i = 0; i < n; i++) std::copy_n(du + 4 * (size_t) i, DU, shifts.writable(i));
  for (int i = 0; i < atom->nlocal; i++) *wholes.writable(i) = du[4 * (size_t) i + 3];
  has_rows = 1.0;
  if (!matrices) return;
  for (int i = 0; i < atom->nlocal; i++) {
    double *row = rest.writable(i);
    std::copy_n(B + 8 * (size_t) i, 6, row);
    std::copy_n(kick + 3 * (size_t) i, 3, row + 6);
  }
}

void FixSphShift::put_back(double *du, double *B, double *kick) const
{
  for (int i = 0; i < atom->nlocal; i++) {
    std::copy_n(shifts[i], DU, du + 4 * (size_t) i);
    du[4 * (size_t) i + 3] = *wholes[i];
    if (!matrices || !rest.has(i)) continue;    // a new atom: B and kick of this moment
    std::copy_n(rest[i], 6, B + 8 * (size_t) i);
    std::copy_n(rest[i] + 6, 3, kick + 3 * (size_t) i);
  }
}
