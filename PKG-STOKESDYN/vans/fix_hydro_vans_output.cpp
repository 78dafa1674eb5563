#include "fix_hydro_vans.h"

#include "atom.h"
#include "comm.h"
#include "memory.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static const std::string COMMAND = VansSettings::COMMAND;

/* ---- output -------------------------------------------------------------------------------------------------------------- */

void FixHydroVans::sum_up()
{
  if (summed_step == update->ntimestep) return;
  MPI_Allreduce(local, global, 5, MPI_DOUBLE, MPI_SUM, world);
  summed_step = update->ntimestep;
}

double FixHydroVans::compute_vector(int k)
{
  const double A = area();
  switch (k) {
    case FORCE_X:
    case FORCE_Y:
    case FORCE_Z:
      sum_up();
      return global[k - FORCE_X];
    case TOTAL_DRAG:
      sum_up();
      return global[3];
    case OUTSIDE:
      sum_up();
      return global[4];
    case TRANSPORT:
      return stream->transport();
    case FRICTION_VELOCITY:
      return std::sqrt(std::max(stream->largest_stress(), 0.0) / set.rho);
    case LARGEST_STRESS:
      return stream->largest_stress();
    case SHIELDS: {
      const double size =
          std::sqrt(set.g[0] * set.g[0] + set.g[1] * set.g[1] + set.g[2] * set.g[2]);
      const double scale = (mean_density - set.rho) * size * 2.0 * mean_radius;
      return scale > 0.0 ? stream->largest_stress() / scale : 0.0;
    }
    case BED:
      return stream->bed_elevation();
    case MOMENTUM:
      return stream->momentum(A);
    case TRANSIT:
      return stream->ledger.transit;
    case DRIVING:
      return stream->ledger.driving;
    case BOTTOM:
      return stream->ledger.bottom;
    case WALLS:
      return stream->ledger.walls;
    case SURFACE:
      return stream->ledger.surface;
    case OTHERS:
      return stream->ledger.others;
  }
  return 0.0;
}

double FixHydroVans::compute_array(int n, int k)
{
  const int N = stream->ncell();
  switch (k) {
    case Z:
      return set.z_ref + 0.5 * (stream->mesh.edge[n] + stream->mesh.edge[n + 1]);
    case VELOCITY:
      return stream->U[n + 1];
    case PHI:
    case GRAIN_X:
    case GRAIN_Y:
    case GRAIN_Z:
    case DRAG_PER_GRAIN:
      return stream->grain[(size_t) (k - PHI) * N + n];
    case EXCHANGE:
      return stream->b[n];
    case EDDY_VISCOSITY:
      return stream->nut[n];
    case STRESS:
      return stream->stress[n];
  }
  k -= ARRAY_COLUMNS;
  return k >= 0 && (size_t) k < 5 * stream->class_radii.size()
      ? stream->class_grain[(size_t) k * N + n]
      : 0.0;
}

/* fix_modify ID profile file NAME | profile values U_0 ... U_N */
int FixHydroVans::modify_param(int narg, char **arg)
{
  if (strcmp(arg[0], "profile") != 0) return 0;
  const std::string what = "fix_modify " + std::string(id) + ": keyword profile";
  if (narg < 2) fail(lmp, what + ": file NAME or values U_0 ... U_N are needed");
  const int needed = stream->ncell() + 1;
  if (strcmp(arg[1], "file") == 0 && narg >= 3) {
    stream->U = read_profile(lmp, what, arg[2], stream->ncell());
    narg = 3;
  } else if (strcmp(arg[1], "values") == 0) {
    if (narg != needed + 2)
      fail(lmp,
           what + ": " + std::to_string(narg - 2) +
               " values, ncell + 1 = " + std::to_string(needed) + " are needed");
    Keywords in(lmp, "fix_modify " + std::string(id), words(narg, arg), 1);
    in.next();
    for (double &value : stream->U) value = in.number();
  } else
    fail(lmp, what + ": '" + arg[1] + "' is none of: file, values");
  stream->profile_changed();
  last_step = -1;    // the forces of the last step do not stand any more
  return narg;
}

/* "velocity" [ncell+1], "phi", "stress" [ncell]; scalars "density", "viscosity", "ncell" is the number of rows of the array. */
void *FixHydroVans::extract(const char *name, int &dim)
{
  dim = 1;
  if (strcmp(name, "velocity") == 0) return stream->U.data();
  if (strcmp(name, "phi") == 0) return stream->phi();
  if (strcmp(name, "stress") == 0) return stream->stress.data();
  dim = 0;
  if (strcmp(name, "density") == 0) return &set.rho;
  if (strcmp(name, "viscosity") == 0) return &set.eta;
  return nullptr;
}

double FixHydroVans::memory_usage()
{
  return (double) atom->nmax * (OUTPUTS + columns) * sizeof(double) +
      (double) (40 + 5 * stream->class_radii.size()) * stream->ncell() * sizeof(double);
}

/* ---- what follows the atoms ------------------------------------------------------------------------------------------------ */

void FixHydroVans::grow_arrays(int nmax)
{
  memory->grow(array_atom, nmax, OUTPUTS, "hydro/vans:array_atom");
  memory->grow(memo, nmax, columns, "hydro/vans:memo");
}

void FixHydroVans::copy_arrays(int i, int j, int /*delflag*/)
{
  memcpy(array_atom[j], array_atom[i], OUTPUTS * sizeof(double));
  memcpy(memo[j], memo[i], columns * sizeof(double));
}

void FixHydroVans::set_arrays(int i)
{
  memset(array_atom[i], 0, OUTPUTS * sizeof(double));
  memset(memo[i], 0, columns * sizeof(double));
  if (weight_column >= 0) memo[i][weight_column] = 1.0;
}

int FixHydroVans::pack_exchange(int i, double *buf)
{
  memcpy(buf, array_atom[i], OUTPUTS * sizeof(double));
  memcpy(buf + OUTPUTS, memo[i], columns * sizeof(double));
  return OUTPUTS + columns;
}

int FixHydroVans::unpack_exchange(int nlocal, double *buf)
{
  memcpy(array_atom[nlocal], buf, OUTPUTS * sizeof(double));
  memcpy(memo[nlocal], buf + OUTPUTS, columns * sizeof(double));
  return OUTPUTS + columns;
}

int FixHydroVans::pack_restart(int i, double *buf)
{
  record(i);
  buf[0] = OUTPUTS + columns + 1;
  pack_exchange(i, buf + 1);
  return OUTPUTS + columns + 1;
}

void FixHydroVans::unpack_restart(int nlocal, int nth)
{
  double *extra = atom->extra[nlocal];
  int m = 0;
  for (int i = 0; i < nth; i++) m += static_cast<int>(extra[m]);
  if (static_cast<int>(extra[m]) == OUTPUTS + columns + 1)
    unpack_exchange(nlocal, extra + m + 1);
  else
    set_arrays(
        nlocal);    // other keywords than those of the restart file: nothing of the past fits
}

void FixHydroVans::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  std::vector<double> out = {(double) last_step, elapsed,     eddy_age,    eddy_period,
                             renewals,           mean_radius, mean_density};
  const auto profiles = stream->pack();
  out.insert(out.end(), profiles.begin(), profiles.end());
  const int size = (int) ((out.size() + 1) * sizeof(double));
  const double count = (double) out.size();
  fwrite(&size, sizeof(int), 1, fp);
  fwrite(&count, sizeof(double), 1, fp);
  fwrite(out.data(), sizeof(double), out.size(), fp);
}

void FixHydroVans::restart(char *buf)
{
  double count;
  memcpy(&count, buf, sizeof(double));
  std::vector<double> in((size_t) count);
  memcpy(in.data(), buf + sizeof(double), in.size() * sizeof(double));
  last_step = (bigint) in[0];
  elapsed = in[1];
  eddy_age = in[2];
  eddy_period = in[3];
  renewals = in[4];
  mean_radius = in[5];
  mean_density = in[6];
  stream->unpack(std::vector<double>(in.begin() + 7, in.end()));
}
