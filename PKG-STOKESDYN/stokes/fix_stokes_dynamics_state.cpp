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
  const bool has_rotation = narg > 3 && strcmp(arg[3], "rotation") == 0;
  const bool has_history = strcmp(arg[narg - 1], "history") == 0;
  rotation = has_rotation;
  history = TRANSLATION_ONLY;
  if (has_rotation) history = WITH_ROTATION;
  columns = history + (has_history ? (has_rotation ? 12 : 6) : 0);
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

void FixStokesDynamicsState::settings_are(uint64_t hash)
{
  if (hash != global.settings) forget();
  global.settings = hash;
}

void FixStokesDynamicsState::present_box(double *box) const
{
  const double tilt[3] = {domain->yz, domain->xz, domain->xy};
  for (int d = 0; d < 3; d++) {
    box[d] = domain->periodicity[d] ? domain->prd[d] : 0.0;
    box[3 + d] = domain->triclinic ? tilt[d] : 0.0;
  }
}

bool FixStokesDynamicsState::box_left_as_is() const
{
  double box[6];
  present_box(box);
  return memcmp(box, global.box, sizeof(box)) == 0;
}

void FixStokesDynamicsState::record(int i)
{
  state[i][LEFT_RADIUS] = atom->radius[i];
  state[i][LEFT_MOLECULE] = atom->molecule ? atom->molecule[i] : 0;
  domain->unmap(atom->x[i], atom->image[i], state[i] + LEFT_X);
  memcpy(state[i] + LEFT_V, atom->v[i], 3 * sizeof(double));
  if (rotation) memcpy(state[i] + LEFT_OMEGA, atom->omega[i], 3 * sizeof(double));
}

void FixStokesDynamicsState::post_run()
{
  for (int i = 0; i < atom->nlocal; i++) record(i);
  present_box(global.box);
}

/* Within rounding: rigid bodies set the velocities of their atoms anew. */
static bool same_vector(const double *now, const double *then)
{
  double difference = 0.0, size = 0.0;
  for (int k = 0; k < 3; k++) {
    difference = fmax(difference, fabs(now[k] - then[k]));
    size = fmax(size, fabs(now[k]));
  }
  return difference <= 1e-12 * size;
}

bool FixStokesDynamicsState::placed_as_left(int i) const
{
  double x[3];
  domain->unmap(atom->x[i], atom->image[i], x);
  for (int k = 0; k < 3; k++)    // wrapping into the box leaves rounding
    if (!(fabs(x[k] - state[i][LEFT_X + k]) <= 1e-9 * atom->radius[i])) return false;
  return atom->radius[i] == state[i][LEFT_RADIUS] &&
      (!atom->molecule || atom->molecule[i] == state[i][LEFT_MOLECULE]);
}

bool FixStokesDynamicsState::moving_as_left(int i) const
{
  return same_vector(atom->v[i], state[i] + LEFT_V) &&
      (!rotation || same_vector(atom->omega[i], state[i] + LEFT_OMEGA));
}

void FixStokesDynamicsState::grow_arrays(int nmax)
{
  memory->grow(state, nmax, columns, "stokes_dynamics:state");
}

void FixStokesDynamicsState::copy_arrays(int i, int j, int /*delflag*/)
{
  memcpy(state[j], state[i], columns * sizeof(double));
}

void FixStokesDynamicsState::set_arrays(int i)
{
  memset(state[i], 0, columns * sizeof(double));
}

int FixStokesDynamicsState::pack_exchange(int i, double *buf)
{
  memcpy(buf, state[i], columns * sizeof(double));
  return columns;
}

int FixStokesDynamicsState::unpack_exchange(int nlocal, double *buf)
{
  memcpy(state[nlocal], buf, columns * sizeof(double));
  return columns;
}

int FixStokesDynamicsState::pack_restart(int i, double *buf)
{
  record(i);
  buf[0] = columns + 1;
  memcpy(buf + 1, state[i], columns * sizeof(double));
  return columns + 1;
}

void FixStokesDynamicsState::unpack_restart(int nlocal, int nth)
{
  double *extra = atom->extra[nlocal];
  int m = 0;
  for (int i = 0; i < nth; i++) m += static_cast<int>(extra[m]);
  // Another number of columns: the pair style has been given with or without rotation since. Nothing of the past stands then.
  if (static_cast<int>(extra[m]) == columns + 1)
    memcpy(state[nlocal], extra + m + 1, columns * sizeof(double));
  else
    set_arrays(nlocal);
}

void FixStokesDynamicsState::write_restart(FILE *fp)
{
  present_box(global.box);
  restart_written = true;
  if (comm->me != 0) return;
  int size = sizeof(Global);
  fwrite(&size, sizeof(int), 1, fp);
  fwrite(&global, sizeof(Global), 1, fp);
}

void FixStokesDynamicsState::restart(char *buf)
{
  uint64_t size;
  memcpy(&size, buf, sizeof(size));
  if (size == sizeof(Global)) memcpy(&global, buf, sizeof(Global));
}

double FixStokesDynamicsState::memory_usage()
{
  return (double) atom->nmax * columns * sizeof(double);
}
