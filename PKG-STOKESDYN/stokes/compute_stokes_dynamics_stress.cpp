#include "compute_stokes_dynamics_stress.h"

#include "fix_stokes_dynamics_overdamped.h"
#include "fixes.h"
#include "hydrodynamics.h"
#include "keywords.h"

#include "angle.h"
#include "atom.h"
#include "bond.h"
#include "comm.h"
#include "dihedral.h"
#include "domain.h"
#include "fix.h"
#include "force.h"
#include "improper.h"
#include "kspace.h"
#include "modify.h"
#include "pair.h"
#include "update.h"
#include "utils.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace StokesDyn;

ComputeStokesDynamicsStress::ComputeStokesDynamicsStress(LAMMPS *lmp, int narg, char **arg) :
    Compute(lmp, narg, arg), voice(lmp, "Compute stokes_dynamics/stress")
{
  Keywords in(lmp, voice.command, words(narg, arg), 3);
  in.parse({{"variance", [&] { low_variance = in.choice({"raw", "low"}) == 1; }}});
  vector_flag = 1;
  size_vector = VALUES;
  extvector = 0;
  vector = sums;
  peratom_flag = 1;
  size_peratom_cols = COLUMNS;
  // virials of pairs, bonds and fixes are wanted in the steps in which this is asked for
  pressflag = timeflag = 1;
}

Hydrodynamics &ComputeStokesDynamicsStress::hydrodynamics() const
{
  Hydrodynamics *hydro = Hydrodynamics::of(lmp);
  if (!hydro || !hydro->settings.shells.on())
    voice.fail("it requires pair_style stokes_dynamics with multiblob");
  return *hydro;
}

bool ComputeStokesDynamicsStress::wants_low(LAMMPS *lmp)
{
  const Modify *modify = lmp->modify;
  for (int k = 0; k < modify->ncompute; k++) {
    auto *stress = dynamic_cast<ComputeStokesDynamicsStress *>(modify->compute[k]);
    if (stress && stress->low_variance &&
        (lmp->update->setupflag || stress->matchstep(lmp->update->ntimestep)))
      return true;
  }
  return false;
}

void ComputeStokesDynamicsStress::init()
{
  hydrodynamics();
}

void ComputeStokesDynamicsStress::find_moments()
{
  Hydrodynamics &hydro = hydrodynamics();
  if (update->setupflag)
    for (FixStokesDynamicsOverdamped *mover : fixes_of<FixStokesDynamicsOverdamped>(lmp)) mover->set_up_early();
  if (!hydro.computed_in((double) update->ntimestep))
    voice.at_step().fail("the forces of this step have not been computed; use this compute in a "
                         "run");
  hydro.stress(moments);
  if (low_variance) take_off_noise();
  for (int i = 0; i < atom->nlocal; i++)
    if (!(atom->mask[i] & groupbit))
      std::fill_n(&moments[COLUMNS * (size_t) i], (int) COLUMNS, 0.0);
}

void ComputeStokesDynamicsStress::take_off_noise()
{
  for (const FixStokesDynamicsOverdamped *mover : fixes_of<FixStokesDynamicsOverdamped>(lmp)) {
    if (!mover->has_noise_in_solve()) return;
    const std::vector<double> *of_noise = mover->stress_of_noise();
    if (!of_noise)
      voice.of("keyword variance").at_step().fail("the stress of the noise was not computed for this step; "
                                                  "name this compute in thermo_style, fix ave/time or a dump");
    for (size_t k = 0; k < COLUMNS * (size_t) atom->nlocal; k++) moments[k] -= (*of_noise)[k];
  }
}

/* Half of torques T, or minus that, on the virial's xy, xz, yz */
static void add_half(const double *T, double half, double *virial)
{
  virial[3] += half * T[2];
  virial[4] -= half * T[1];
  virial[5] += half * T[0];
}

/* LAMMPS's rigid bodies sum the virial x F_y, not (x F_y + y F_x)/2, of the forces that hold their
 * atoms. The moment of these forces, the sum of x F_y - y F_x, is the torque T_z on the atoms, but for
 * the inertia of their spins: half of it is what the sum has too much. */
static void symmetrise(const Atom *atom, Fix *rigid, double *virial)
{
  int dim = 0;
  const int *body = (const int *) rigid->extract("body", dim);
  if (!body || dim != 1 || !atom->torque_flag) return;
  for (int i = 0; i < atom->nlocal; i++) {
    if (body[i] < 0) continue;
    add_half(atom->torque[i], -0.5, virial);
  }
}

/* Pair styles sum x F_y as well. Two spheres are torque-free together: the moment of their forces, the sum
 * of x F_y - y F_x, is minus the torques T_z that friction, dipoles and bonds put on them. Those of the
 * fluid, where the pair style adds them, have no virial. */
void ComputeStokesDynamicsStress::symmetrise_pairs(double *virial) const
{
  const Hydrodynamics &hydro = hydrodynamics();
  add_half(hydro.memory->torque_of_pairs(), 0.5, virial);
  for (int i : hydro.ambient.who())
    if (hydro.settings.add_force) add_half(hydro.torque(i), -0.5, virial);
}

/* Virials of all other forces, as compute pressure sums them: of this rank, but for that of kspace,
 * which every rank has whole */
void ComputeStokesDynamicsStress::add_others(double *virial) const
{
  const auto add = [virial](const double *of) {
    for (int k = 0; k < 6; k++) virial[k] += of[k];
  };
  if (force->pair) add(force->pair->virial);
  symmetrise_pairs(virial);
  if (force->bond) add(force->bond->virial);
  if (force->angle) add(force->angle->virial);
  if (force->dihedral) add(force->dihedral->virial);
  if (force->improper) add(force->improper->virial);
  if (force->kspace && comm->me == 0) add(force->kspace->virial);
  for (int k = 0; k < modify->nfix; k++) {
    Fix *fix = modify->fix[k];
    if (!fix->virial_global_flag || !fix->thermo_virial) continue;
    add(fix->virial);
    if (utils::strmatch(fix->style, "^rigid")) symmetrise(atom, fix, virial);
  }
}

void ComputeStokesDynamicsStress::compute_vector()
{
  invoked_vector = update->ntimestep;
  if (!domain->xperiodic || !domain->yperiodic || !domain->zperiodic)
    voice.fail("its vector is an average over a periodic box, and this box is not periodic; the "
               "per-atom array needs no periodic box");
  if (update->vflag_global != invoked_vector)
    voice.fail("the virials of other forces were not computed in this step; name this compute in "
               "thermo_style");
  find_moments();
  double mine[VALUES] = {0.0};
  for (int i = 0; i < atom->nlocal; i++)
    for (int k = 0; k < COLUMNS; k++) mine[k] += moments[COLUMNS * (size_t) i + k];
  add_others(mine + OTHERS);
  for (const FixStokesDynamicsOverdamped *mover : fixes_of<FixStokesDynamicsOverdamped>(lmp))
    mine[PRESSURE] += mover->ideal_pressure();
  for (int d = 0; d < 3; d++) mine[PRESSURE] += mine[OTHERS + d] / 3.0;
  MPI_Allreduce(mine, sums, VALUES, MPI_DOUBLE, MPI_SUM, world);
  const double unit = force->nktv2p / (domain->xprd * domain->yprd * domain->zprd);
  for (double &value : sums) value *= unit;
}

void ComputeStokesDynamicsStress::compute_peratom()
{
  invoked_peratom = update->ntimestep;
  find_moments();
  rows.resize(atom->nlocal + 1);
  for (int i = 0; i < atom->nlocal; i++) rows[i] = &moments[COLUMNS * (size_t) i];
  array_atom = rows.data();
}

double ComputeStokesDynamicsStress::memory_usage()
{
  return sizeof(double) * (double) (moments.capacity() + rows.capacity());
}
