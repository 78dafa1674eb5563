#include "moved_box.h"

#include "deform_settings.h"
#include "ranks.h"

#include "atom.h"
#include "domain.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* Without the edges that LAMMPS shrinks around the particles: those move nobody. */
double MovedBox::present_volume() const
{
  double V = 1.0;
  for (int d = 0; d < 3; d++)
    if (domain->boundary[d][0] < 2 && domain->boundary[d][1] < 2) V *= domain->prd[d];
  return V;
}

/* Bits of the groups whose particles the fixes of this run move with the box. Barostats move all,
 * unless they are told 'dilate', which the documentation of this pair style forbids. */
int MovedBox::moved_by_fixes() const
{
  int bits = 0;
  for (int i = 0; i < modify->nfix; i++) {
    Fix *fix = modify->fix[i];
    if (!(fix->box_change & (Fix::BOX_CHANGE_SIZE | Fix::BOX_CHANGE_SHAPE))) continue;
    if (strncmp(fix->style, "deform", 6) != 0)
      bits |= 1;
    else if (DeformSettings::remap(fix) == Domain::X_REMAP)
      bits |= fix->groupbit;
  }
  return bits;
}

void MovedBox::remember()
{
  volume = present_volume();
  witness = {};
  if (atom->nlocal == 0) return;
  witness.tag = atom->tag[0];
  std::copy_n(atom->x[0], 3, witness.x);
  domain->x2lamda(witness.x, witness.lamda);
}

/* Is the particle at x where it was in units of the box, but for whole periods? */
bool MovedBox::agrees(const double *x, const double *lamda) const
{
  double now[3];
  domain->x2lamda(const_cast<double *>(x), now);
  for (int d = 0; d < domain->dimension; d++) {
    const double difference = now[d] - lamda[d];
    if (std::fabs(difference - std::round(difference)) > 1e-9) return false;
  }
  return true;
}

MovedBox::Change MovedBox::between_runs() const
{
  int may_have[2] = {1, 1};    // moved with the box, stayed
  for (const Witness &was : from_all(world, std::vector<Witness>{witness})) {
    const tagint *end = atom->tag + atom->nlocal, *found = std::find<const tagint *>(atom->tag, end, was.tag);
    if (was.tag == 0 || found == end) continue;
    const double *x = atom->x[found - atom->tag];
    double as_before[3];
    domain->x2lamda(const_cast<double *>(was.x), as_before);
    may_have[0] = may_have[0] && agrees(x, was.lamda);
    may_have[1] = may_have[1] && agrees(x, as_before);
  }
  MPI_Allreduce(MPI_IN_PLACE, may_have, 2, MPI_INT, MPI_MIN, world);
  return may_have[0] ? MOVED : may_have[1] ? STAYED : NEITHER;
}

bool MovedBox::follow(double *rho)
{
  const double V = present_volume(), before = volume;
  Change change = MOVED;
  int bits = 1;
  if (before > 0.0 && V != before) {
    if (update->setupflag)
      change = between_runs();
    else
      bits = moved_by_fixes();
    for (int i = 0; change == MOVED && bits && i < atom->nlocal + atom->nghost; i++)
      if (atom->mask[i] & bits) rho[i] *= before / V;
  }
  remember();
  return change != NEITHER;
}

}    // namespace StokesDyn
