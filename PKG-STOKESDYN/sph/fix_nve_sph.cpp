#include "fix_nve_sph.h"

#include "keywords.h"
#include "sph.h"

#include "atom.h"
#include "comm.h"
#include "force.h"
#include "update.h"

#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixNveSph::FixNveSph(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  const std::string command = "Fix " + std::string(STYLE);
  if (narg > 3) fail(lmp, command + ": unknown keyword '" + arg[3] + "'");
  Sph::require_scene(lmp, command);
  time_integrate = 1;
  dynamic_group_allow = 1;
  restart_global = 1;
}

int FixNveSph::setmask()
{
  return FixConst::INITIAL_INTEGRATE | FixConst::FINAL_INTEGRATE | FixConst::POST_RUN;
}

void FixNveSph::init()
{
  Sph::require_pair(lmp, "Fix " + std::string(STYLE));
  if (strncmp(update->integrate_style, "respa", 5) == 0)
    fail(lmp, "Fix " + std::string(STYLE) + " cannot be used with run_style respa");
  reset_dt();
}

void FixNveSph::reset_dt()
{
  dtv = update->dt;
  dtf = 0.5 * update->dt * force->ftm2v;
}

/* Leapfrog: the velocity of the half step moves position and, in the pair style, density. vest is the
 * velocity at the end of the step,
 * which friction needs before the force is known. */
void FixNveSph::initial_integrate(int /*vflag*/)
{
  double **x = atom->x, **v = atom->v, **f = atom->f, **vest = atom->vest;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double kick = dtf / Sph::mass(lmp, i);
    for (int d = 0; d < 3; d++) {
      v[i][d] += kick * f[i][d];
      vest[i][d] = v[i][d] + kick * f[i][d];
      x[i][d] += dtv * v[i][d];
    }
  }
}

void FixNveSph::final_integrate()
{
  double **v = atom->v, **f = atom->f;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double kick = dtf / Sph::mass(lmp, i);
    for (int d = 0; d < 3; d++) v[i][d] += kick * f[i][d];
  }
}

void FixNveSph::post_run()
{
  left = state_now();
}

/* The sum of a hash of each velocity: the same for any order and any number of ranks. */
FixNveSph::State FixNveSph::state_now() const
{
  uint64_t mine = 0, sum = 0;
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
  MPI_Allreduce(&mine, &sum, 1, MPI_UINT64_T, MPI_SUM, world);
  return {1.0, (double) update->ntimestep, sum};
}

bool FixNveSph::resumes() const
{
  const State now = state_now();
  return left.step == now.step && left.velocities == now.velocities;
}

void FixNveSph::write_restart(FILE *fp)
{
  // In mid-run, or after a run, the state is one that a run can go on from; before any run it is not.
  const State state = update->whichflag == 1 ? state_now() : left;
  if (comm->me != 0) return;
  const int size = sizeof(State);
  fwrite(&size, sizeof(int), 1, fp);
  fwrite(&state, sizeof(State), 1, fp);
}

void FixNveSph::restart(char *buf)
{
  memcpy(&left, buf, sizeof(State));
  if (left.format != 1.0) left = {1.0, -1.0, 0};
}

FixNveSphStationary::FixNveSphStationary(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  const std::string command = "Fix " + std::string(STYLE);
  if (narg > 3) fail(lmp, command + ": unknown keyword '" + arg[3] + "'");
  Sph::require_scene(lmp, command);
  time_integrate = 1;
  dynamic_group_allow = 1;
}

void FixNveSphStationary::init()
{
  Sph::require_pair(lmp, "Fix " + std::string(STYLE));
}
