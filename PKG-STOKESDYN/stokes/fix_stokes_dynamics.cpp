#include "fix_stokes_dynamics.h"

#include "keywords.h"
#include "pair_stokes_dynamics.h"

#include "atom.h"
#include "force.h"
#include "memory.h"
#include "modify.h"
#include "update.h"

#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixStokesDynamics::FixStokesDynamics(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), total()
{
  Keywords in(lmp, "Fix " + std::string(STYLE), words(narg, arg), 3);
  while (in.next()) {
    if (in.is("apply"))
      apply = in.yes_no() ? YES : NO;
    else
      in.unknown();
  }
  peratom_flag = 1;
  size_peratom_cols = NCOLUMNS;
  peratom_freq = 1;
  scalar_flag = 1;
  vector_flag = 1;
  size_vector = 9;
  global_freq = 1;
  extscalar = 1;
  extvector = -1;
  extlist = new int[size_vector]{1, 1, 1, 0, 0, 0, 0, 0, 0};
  grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  for (int i = 0; i < atom->nlocal; i++) set_arrays(i);
}

FixStokesDynamics::~FixStokesDynamics()
{
  atom->delete_callback(id, Atom::GROW);
  memory->destroy(array_atom);
  delete[] extlist;
}

int FixStokesDynamics::setmask()
{
  return FixConst::POST_FORCE;
}

PairStokesDynamics *FixStokesDynamics::find_pair()
{
  return force->pair
      ? static_cast<PairStokesDynamics *>(force->pair_match(PairStokesDynamics::STYLE, 1))
      : nullptr;
}

void FixStokesDynamics::init()
{
  pair = find_pair();
  if (!pair)
    fail(lmp,
         "Fix stokes_dynamics: there is no pair_style stokes_dynamics whose force it could apply "
         "or report");
  if (apply == YES && pair->adds_force())
    fail(lmp,
         "Fix stokes_dynamics: keyword apply: 'yes' together with add_force yes of pair_style "
         "stokes_dynamics would count the force twice");
  if (!applies(pair->adds_force())) return;
  for (int i = 0; i < modify->nfix; i++) {
    Fix *other = modify->fix[i];
    if (other != this && strcmp(other->style, STYLE) == 0 &&
        static_cast<FixStokesDynamics *>(other)->applies(pair->adds_force()))
      fail(lmp,
           "Fix stokes_dynamics: keyword apply: the fixes " + std::string(id) + " and " +
               other->id +
               " both apply the force, which would count twice; give one of them apply no");
  }
}

void FixStokesDynamics::setup(int vflag)
{
  post_force(vflag);
}

void FixStokesDynamics::post_force(int /*vflag*/)
{
  if (!pair->computed_in(update->ntimestep))
    fail(lmp,
         "Fix stokes_dynamics: the pair style was not computed in this step (pair_modify compute "
         "no?)");
  const bool add = applies(pair->adds_force());
  for (double &t : total) t = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    double *row = array_atom[i];
    if (!(atom->mask[i] & groupbit)) {
      memset(row, 0, NCOLUMNS * sizeof(double));
      continue;
    }
    memcpy(row, pair->drag_force(i), 3 * sizeof(double));
    memcpy(row + 3, pair->perturbation(i), 3 * sizeof(double));
    if (const double *torque = pair->drag_torque(i)) {
      memcpy(row + 6, torque, 3 * sizeof(double));
      if (add)
        for (int d = 0; d < 3; d++) atom->torque[i][d] += torque[d];
    } else
      memset(row + 6, 0, 3 * sizeof(double));
    for (int d = 0; d < 3; d++) {
      total[d] += row[d];
      if (add) atom->f[i][d] += row[d];
    }
    total[3] += pair->dissipation(i);
  }
}

/* Dissipation rate: the power that the spheres of the group lose to the fluid. */
double FixStokesDynamics::compute_scalar()
{
  double all;
  MPI_Allreduce(&total[3], &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

/* Total force x y z; iterations and residual of the last solve, solves, unconverged solves; smallest eigenvalue met, time step limit. */
double FixStokesDynamics::compute_vector(int k)
{
  if (k < 3) {
    double all;
    MPI_Allreduce(&total[k], &all, 1, MPI_DOUBLE, MPI_SUM, world);
    return all;
  }
  if (!pair) return 0.0;
  const auto &g = pair->numbers();
  const double values[] = {g.iterations,  g.residual,   g.solves,
                           g.unconverged, g.lambda_min, g.dt_limit};
  return values[k - 3];
}

void FixStokesDynamics::grow_arrays(int nmax)
{
  memory->grow(array_atom, nmax, NCOLUMNS, "stokes_dynamics:array_atom");
}

void FixStokesDynamics::copy_arrays(int i, int j, int /*delflag*/)
{
  memcpy(array_atom[j], array_atom[i], NCOLUMNS * sizeof(double));
}

void FixStokesDynamics::set_arrays(int i)
{
  memset(array_atom[i], 0, NCOLUMNS * sizeof(double));
}

double FixStokesDynamics::memory_usage()
{
  return (double) atom->nmax * NCOLUMNS * sizeof(double);
}
