#include "fix_sph_outlet.h"

#include "keywords.h"
#include "lammps_compat.h"
#include "ranks.h"
#include "sph.h"

#include "atom.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixSphOutlet::FixSphOutlet(LAMMPS *lmp, int narg, char **arg) : FixSphOpening(lmp, narg, arg)
{
  Keywords in = parse_place(narg, arg);
  in.parse({{"pressure", [&] { pressure = Field::parse(in); }}});
}

/* Those that have passed the end since the last list of neighbours may be outside of the box,
 * and LAMMPS would lose them. */
void FixSphOutlet::setup_pre_exchange()
{
  FixSphOpening::setup_pre_exchange();
  pre_exchange();
}

/* All that are at one place of the section move alike, so that no gap opens in the layer and nothing piles up
 * there when the flow changes in time or eddies come; and nothing comes back. */
void FixSphOutlet::post_integrate()
{
  look_at_flow();
  for (int i = 0; i < atom->nlocal; i++) {
    if (!is_held(i)) continue;
    double *v = atom->v[i];
    const double speed = std::max(0.0, speed_before(atom->x[i], side * v[axis]));
    for (int d = 0; d < 3; d++) v[d] = d == axis ? side * speed : 0.0;
  }
  if (whole_flow() < 0.0)
    tell_of_backflow("the flow turns back at this outlet, which has no fluid to give and holds it there");
}

void FixSphOutlet::pre_exchange()
{
  bigint gone = 0;
  for (int i = atom->nlocal - 1; i >= 0; i--) {
    if (!(atom->mask[i] & groupbit) || beyond(atom->x[i]) < width) continue;
    passed += Sph::mass(lmp, i);
    atom->avec->copy(atom->nlocal - 1, i, 1);
    atom->nlocal--;
    gone++;
  }
  gone = sum_of_all(world, gone);
  atom->natoms -= gone;
  if (gone > 0 && atom->map_style != Atom::MAP_NONE) {
    atom->nghost = 0;
    atom->map_init();
    atom->map_set();
  }
}
