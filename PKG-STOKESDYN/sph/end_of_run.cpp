#include "end_of_run.h"

#include "ranks.h"
#include "sph.h"

#include "sd_hash.h"

#include "atom.h"
#include "domain.h"
#include "update.h"

#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

void EndOfRun::record(int groupbit)
{
  uint64_t hashes = 0;
  double mine[2] = {0.0, 0.0};
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const uint64_t tag = (uint64_t) atom->tag[i];
    double where[5] = {0.0, 0.0, 0.0, atom->radius ? atom->radius[i] : 0.0, Sph::mass(lmp, i)};
    domain->unmap(atom->x[i], atom->image[i], where);
    uint64_t hash = tag;
    for (int d = 0; d < 3; d++) {
      uint64_t bits;
      memcpy(&bits, &atom->v[i][d], sizeof(bits));
      hash = sd_hash_mix((hash ^ bits) * SD_HASH_STEP);
    }
    hashes += hash;
    sd_hash_add_row(tag, where, 5, mine);
  }
  velocities = 0;
  for (const uint64_t part : from_all<uint64_t>(world, {hashes})) velocities += part;
  places = sum_of_all(world, mine[0]);
  size = sum_of_all(world, mine[1]);
}

bool EndOfRun::still_stands(int groupbit) const
{
  EndOfRun now(lmp);
  now.record(groupbit);
  return size >= 0.0 && velocities == now.velocities && std::fabs(places - now.places) <= 1e-13 * size;
}

void EndOfRun::write(int groupbit, NamedState &state)
{
  if (update->whichflag == 1) record(groupbit);
  state.put("places", places);
  state.put("size", size);
  state.put_bits("velocities", velocities);
}

void EndOfRun::read(const NamedState &state)
{
  places = state.get("places", 0.0);
  size = state.get("size", -1.0);
  velocities = state.get_bits("velocities", 0);
}
