#include "fix_nve_sph.h"

#include "pair_sph_artvisc_tenscorr.h"
#include "sph.h"

#include "atom.h"
#include "update.h"

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixNveSph::FixNveSph(LAMMPS *lmp, int narg, char **arg) : SphFix(lmp, narg, arg), end(lmp)
{
  keywords(narg, arg).parse({});
  time_integrate = 1;
  dynamic_group_allow = 1;
  restart_global = 1;
}

int FixNveSph::setmask()
{
  return FixConst::PRE_EXCHANGE | FixConst::INITIAL_INTEGRATE | FixConst::PRE_FORCE |
      FixConst::FINAL_INTEGRATE | FixConst::POST_RUN;
}

/* The estimate that the last run left, if nobody has changed a velocity since: that of the unbroken
 * run. Otherwise v. Not for write_data, which calls this too, and which no force follows. */
void FixNveSph::setup_pre_exchange()
{
  if (!update->setupflag) return;
  goes_on = end.still_stands(groupbit);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    for (int d = 0; d < 3; d++)
      atom->vest[i][d] = goes_on ? atom->vest[i][d] - atom->v[i][d] : 0.0;
  }
  relative = true;
}

/* Leapfrog: the velocity of the half step moves position and, in the pair style, density. Friction
 * needs the velocity at the end of the step before the force is known, vest = v + dt/2 F/m with the
 * last force. Until the force it is only the second term: fix deform with remap v has LAMMPS shift
 * v, and only v, of what crosses a face that glides, and of ghosts beyond it. With shift yes
 * particles move with v + du, du of the middle of the last step. Those that stand in an open end are
 * not pushed by forces. */
void FixNveSph::initial_integrate(int /*vflag*/)
{
  pair = PairSph::prepared(voice);
  double **x = atom->x, **v = atom->v, **f = atom->f, **vest = atom->vest;
  const double *du = pair->shift(), dt = update->dt;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double kick = pair->is_held(i) ? 0.0 : 0.5 * dt / Sph::mass(lmp, i);
    for (int d = 0; d < 3; d++) {
      vest[i][d] = kick * f[i][d];
      v[i][d] += vest[i][d];
      x[i][d] += dt * (du ? v[i][d] + du[3 * (size_t) i + d] : v[i][d]);
    }
  }
  relative = true;
}

void FixNveSph::pre_force(int /*vflag*/)
{
  if (!relative) return;    // run pre no: the estimates of the last step stand
  relative = false;
  for (int i = 0; i < atom->nlocal + atom->nghost; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    for (int d = 0; d < 3; d++) atom->vest[i][d] += atom->v[i][d];
  }
}

void FixNveSph::final_integrate()
{
  double **v = atom->v, **f = atom->f;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double kick = pair->is_held(i) ? 0.0 : 0.5 * update->dt / Sph::mass(lmp, i);
    for (int d = 0; d < 3; d++) v[i][d] += kick * f[i][d];
  }
}

void FixNveSph::post_run()
{
  end.record(groupbit);
}

void FixNveSph::write_state(NamedState &state)
{
  end.write(groupbit, state);
}

void FixNveSph::read_state(const NamedState &state)
{
  end.read(state);
}

FixNveSphStationary::FixNveSphStationary(LAMMPS *lmp, int narg, char **arg) :
    SphFix(lmp, narg, arg)
{
  keywords(narg, arg).parse({});
  time_integrate = 1;
  dynamic_group_allow = 1;
}
