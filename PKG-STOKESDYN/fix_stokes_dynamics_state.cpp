#include "fix_stokes_dynamics_state.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "memory.h"

#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixStokesDynamicsState::FixStokesDynamicsState(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg)
{
  restart_peratom = 1;
  restart_global = 1;
  create_attribute = 1;
  grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
  for (int i = 0; i < atom->nlocal; i++) set_arrays(i);
}

FixStokesDynamicsState::~FixStokesDynamicsState()
{
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
  memory->destroy(state);
}

void FixStokesDynamicsState::forget()
{
  const Global old = global;
  global = Global();
  global.solves = old.solves;
  global.unconverged = old.unconverged;
  for (int i = 0; i < atom->nlocal; i++) set_arrays(i);
}

void FixStokesDynamicsState::record(int i)
{
  domain->unmap(atom->x[i], atom->image[i], state[i] + LEFT_X);
  memcpy(state[i] + LEFT_V, atom->v[i], 3 * sizeof(double));
}

void FixStokesDynamicsState::post_run()
{
  for (int i = 0; i < atom->nlocal; i++) record(i);
}

bool FixStokesDynamicsState::left_as_is(int i) const
{
  double x[3], dx = 0.0, dv = 0.0, v = 0.0;
  domain->unmap(atom->x[i], atom->image[i], x);
  for (int k = 0; k < 3; k++) {
    dx = fmax(dx, fabs(x[k] - state[i][LEFT_X + k]));
    dv = fmax(dv, fabs(atom->v[i][k] - state[i][LEFT_V + k]));
    v = fmax(v, fabs(atom->v[i][k]));
  }
  // Wrapping into the box and rigid bodies, which set velocities anew, leave rounding.
  return state[i][SOLVED] != 0.0 && dx <= 1e-9 * atom->radius[i] && dv <= 1e-12 * v;
}

void FixStokesDynamicsState::grow_arrays(int nmax)
{
  memory->grow(state, nmax, NCOLUMNS, "stokes_dynamics:state");
}

void FixStokesDynamicsState::copy_arrays(int i, int j, int /*delflag*/)
{
  memcpy(state[j], state[i], NCOLUMNS * sizeof(double));
}

void FixStokesDynamicsState::set_arrays(int i)
{
  memset(state[i], 0, NCOLUMNS * sizeof(double));
}

int FixStokesDynamicsState::pack_exchange(int i, double *buf)
{
  memcpy(buf, state[i], NCOLUMNS * sizeof(double));
  return NCOLUMNS;
}

int FixStokesDynamicsState::unpack_exchange(int nlocal, double *buf)
{
  memcpy(state[nlocal], buf, NCOLUMNS * sizeof(double));
  return NCOLUMNS;
}

int FixStokesDynamicsState::pack_restart(int i, double *buf)
{
  record(i);
  buf[0] = NCOLUMNS + 1;
  memcpy(buf + 1, state[i], NCOLUMNS * sizeof(double));
  return NCOLUMNS + 1;
}

void FixStokesDynamicsState::unpack_restart(int nlocal, int nth)
{
  double *extra = atom->extra[nlocal];
  int m = 0;
  for (int i = 0; i < nth; i++) m += static_cast<int>(extra[m]);
  memcpy(state[nlocal], extra + m + 1, NCOLUMNS * sizeof(double));
}

void FixStokesDynamicsState::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  int size = sizeof(Global);
  fwrite(&size, sizeof(int), 1, fp);
  fwrite(&global, sizeof(Global), 1, fp);
}

void FixStokesDynamicsState::restart(char *buf)
{
  memcpy(&global, buf, sizeof(Global));
}

double FixStokesDynamicsState::memory_usage()
{
  return (double) atom->nmax * NCOLUMNS * sizeof(double);
}
