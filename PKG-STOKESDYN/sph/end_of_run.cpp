#include "end_of_run.h"

#include "ranks.h"

#include "atom.h"
#include "update.h"

#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

void EndOfRun::record(int groupbit)
{
  uint64_t mine = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    uint64_t hash = (uint64_t) atom->tag[i];
    for (int d = 0; d < 3; d++) {
      uint64_t bits;
      memcpy(&bits, &atom->v[i][d], sizeof(bits));
      hash = (hash ^ bits) * 0x9E3779B97F4A7C15u;
      hash ^= hash >> 29;
    }
    mine += hash;
  }
  velocities = 0;
  for (const uint64_t part : from_all<uint64_t>(world, {mine})) velocities += part;
  step = (double) update->ntimestep;
}

bool EndOfRun::still_stands(int groupbit) const
{
  EndOfRun now(lmp);
  now.record(groupbit);
  return step == now.step && velocities == now.velocities;
}

void EndOfRun::write(int groupbit, NamedState &state)
{
  if (update->whichflag == 1) record(groupbit);
  state.put("step", step);
  state.put_bits("velocities", velocities);
}

void EndOfRun::read(const NamedState &state)
{
  step = state.get("step", -1.0);
  velocities = state.get_bits("velocities", 0);
}
