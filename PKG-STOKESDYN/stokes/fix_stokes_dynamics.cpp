#include "fix_stokes_dynamics.h"

#include "fixes.h"
#include "keywords.h"
#include "ranks.h"

#include "atom.h"
#include "modify.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixStokesDynamics::FixStokesDynamics(LAMMPS *lmp, int narg, char **arg) :
    RowsFix(lmp, narg, arg), rows(9), total()
{
  Keywords in = keywords(narg, arg);
  in.parse({{"apply", [&] { apply = in.yes_no() ? YES : NO; }}});
  scalar_flag = 1;
  vector_flag = 1;
  size_vector = 9;
  global_freq = 1;
  extscalar = 1;
  extvector = -1;
  extlist = extensive;
  keep({&rows}, &rows, false);
}

int FixStokesDynamics::setmask()
{
  return FixConst::POST_FORCE;
}

bool FixStokesDynamics::applies() const
{
  return apply == YES || (apply == UNSAID && !hydrodynamics().settings.add_force);
}

void FixStokesDynamics::init()
{
  const Hydrodynamics &hydro = hydrodynamics();
  if (apply == YES && hydro.settings.add_force)
    voice.fail("keyword apply: 'yes' together with add_force yes of pair_style stokes_dynamics "
               "would count the force twice");
  if (!applies()) return;
  check_order();
  for (const auto *other : fixes_of<FixStokesDynamics>(lmp))
    if (other != this && other->applies())
      voice.fail("keyword apply: the fixes " + std::string(id) + " and " + other->id +
                 " both apply the force, which would count twice; give one of them apply no");
}

/* These read forces in their setup (rigid bodies) or in every step (constraints) at their own place in
 * the order of the input. */
void FixStokesDynamics::check_order() const
{
  const int *mask = atom->mask;
  for (int k = 0; k < modify->nfix && modify->fix[k] != this; k++) {
    const Fix *other = modify->fix[k];
    bool reads = false;
    for (const char *style : {"^rigid", "^poems", "^shake", "^rattle"})
      reads = reads || utils::strmatch(other->style, style);
    const int both[2] = {groupbit, other->groupbit};
    if (reads && first_atom(lmp, [&](int i) { return (mask[i] & both[0]) && (mask[i] & both[1]); }))
      voice.fail(name_of(other) + " stands before this fix in the input, so it reads the forces before "
                 "the drag is added, and every run begins with a kick: define fix " + std::string(id) +
                 " first");
  }
}

void FixStokesDynamics::setup(int vflag)
{
  post_force(vflag);
}

void FixStokesDynamics::post_force(int /*vflag*/)
{
  const Hydrodynamics &hydro = hydrodynamics();
  if (!hydro.computed_in(update->ntimestep))
    voice.fail("the pair style was not computed in this step (pair_modify compute no?)");
  const bool adds = applies();
  for (double &t : total) t = 0.0;
  const Ambient &ambient = hydro.ambient;
  if (cleared.first_in(hydro.epochs.selection))
    for (int i = 0; i < atom->nlocal; i++)
      if (!ambient.active()[i]) rows.erase(i);
  for (int i : ambient.who()) {
    if (!(atom->mask[i] & groupbit)) {
      rows.erase(i);
      continue;
    }
    double *row = rows.writable(i);
    const double *F = hydro.force(i), *torque = hydro.torque(i);
    std::copy_n(F, 6, row);
    for (int d = 0; d < 3; d++) row[6 + d] = torque ? torque[d] : 0.0;
    for (int d = 0; d < 3; d++) {
      total[d] += F[d];
      if (adds) atom->f[i][d] += F[d];
      if (adds && torque) atom->torque[i][d] += torque[d];
    }
    total[3] += hydro.dissipation(i);
  }
}

/* Dissipation rate: the power that the spheres of the group lose to the fluid. */
double FixStokesDynamics::compute_scalar()
{
  return sum_of_all(world, total[3]);
}

/* Total force x y z; iterations and residual of the last solve, solves, unconverged solves;
 * smallest eigenvalue met, time step limit. */
double FixStokesDynamics::compute_vector(int k)
{
  if (k < 3) return sum_of_all(world, total[k]);
  hydrodynamics();    // an error if there is none
  const FixStokesDynamicsState *memory = FixStokesDynamicsState::find(lmp);
  if (!memory) return 0.0;
  const auto &g = memory->global;
  const double values[] = {g.iterations,  g.residual,         g.solves,
                           g.unconverged, g.guard.lambda_min, g.guard.limit};
  return values[k - 3];
}
