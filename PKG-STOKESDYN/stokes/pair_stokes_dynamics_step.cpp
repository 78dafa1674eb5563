/* A step of pair_style stokes_dynamics: who takes part, is a solve due, the forces. */
#include "pair_stokes_dynamics.h"

#include "keywords.h"
#include "lammps_compat.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static const std::string COMMAND = PairStokesDynamics::COMMAND_NAME;

bool PairStokesDynamics::selected(int i) const
{
  const double *x = atom->x[i];
  return (atom->mask[i] & groupbit) && (!region || region->match(x[0], x[1], x[2]));
}

enum Fault { NONE, POSITION, VELOCITY, RADIUS, VISCOSITY, FLUID_VELOCITY, FLUID_VORTICITY };

static bool finite(const double *v)
{
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

int PairStokesDynamics::faulty(int i) const
{
  // 0 times a number is 0 unless it is infinite or not a number: nearly always this one test is enough.
  const double *x = atom->x[i], *v = atom->v[i], *u = fluid_at(i);
  double sum = x[0] + x[1] + x[2] + atom->radius[i];
  if (active[i]) {
    sum += v[0] + v[1] + v[2] + viscosity(i) + u[0] + u[1] + u[2];
    if (scene.settings.rotation) sum += atom->omega[i][0] + atom->omega[i][1] + atom->omega[i][2];
    if (fluid_varies)
      sum += w_inf[3 * (size_t) i] + w_inf[3 * (size_t) i + 1] + w_inf[3 * (size_t) i + 2];
  }
  if (0.0 * sum == 0.0 && (!active[i] || (atom->radius[i] > 0.0 && viscosity(i) > 0.0)))
    return NONE;

  // Velocity first: it spoils the position in the same step.
  if (active[i] && (!finite(atom->v[i]) || (scene.settings.rotation && !finite(atom->omega[i]))))
    return VELOCITY;
  if (!finite(atom->x[i])) return POSITION;
  if (!active[i]) return NONE;
  if (!(atom->radius[i] > 0.0) || !std::isfinite(atom->radius[i])) return RADIUS;
  if (!(viscosity(i) > 0.0) || !std::isfinite(viscosity(i))) return VISCOSITY;
  if (!finite(fluid_at(i))) return FLUID_VELOCITY;
  if (fluid_varies && !finite(&w_inf[3 * (size_t) i])) return FLUID_VORTICITY;
  return NONE;
}

/* One rank has found a faulty atom; all ranks end the run with the name of the first. */
void PairStokesDynamics::complain()
{
  const bigint none = MAXBIGINT;
  bigint mine = none, first;
  for (int i = 0; i < atom->nlocal; i++)
    if (const int fault = faulty(i)) mine = std::min(mine, (bigint) atom->tag[i] * 8 + fault);
  MPI_Allreduce(&mine, &first, 1, MPI_LMP_BIGINT, MPI_MIN, world);
  double value = 0.0, sum;
  if (mine == first)
    for (int i = 0; i < atom->nlocal; i++)
      if (atom->tag[i] == first / 8) switch (first % 8) {
          case RADIUS:
            value = atom->radius[i];
            break;
          case VISCOSITY:
            value = viscosity(i);
            break;
        }
  MPI_Allreduce(&value, &sum, 1, MPI_DOUBLE, MPI_SUM, world);
  const std::string who = COMMAND + ": step " + std::to_string(update->ntimestep) + ", atom " +
      std::to_string(first / 8) + ": ";
  switch (first % 8) {
    case POSITION:
      fail(lmp, who + "its position is not a finite number");
    case VELOCITY:
      fail(lmp, who + "its velocity is not a finite number");
    case RADIUS:
      fail(lmp,
           who + "its radius " + text(sum) + " must be > 0 (keyword group selects the spheres)");
    case VISCOSITY:
      fail(lmp, who + "keyword visc: its viscosity " + text(sum) + " must be > 0");
    case FLUID_VORTICITY:
      fail(lmp,
           who +
               "keyword fluid_vorticity: the vorticity of the fluid there is not a finite number");
    default:
      fail(lmp, who + "keyword fluid_velocity: the fluid velocity there is not a finite number");
  }
}

bool PairStokesDynamics::numbers_only() const
{
  if (visc.is_variable()) return false;
  for (int d = 0; d < 3; d++)
    if (fluid_velocity[d].is_variable() || fluid_vorticity[d].is_variable()) return false;
  return true;
}

/* Gradient of the fluid velocity from its formulas, its rotation replaced by fluid_vorticity where that is given; and half the
 * vorticity. */
void PairStokesDynamics::fluid_gradient()
{
  const int n = atom->nlocal;
  fluid_varies = u_varies || has_vorticity;
  if (!fluid_varies) return;
  w_inf.assign(3 * (size_t) n + 3, 0.0);
  gradient.assign(9 * (size_t) n + 9, 0.0);
  if (u_varies) velocity_gradient(lmp, fluid_velocity, igroup, gradient.data());
  if (has_vorticity)
    for (int d = 0; d < 3; d++) fluid_vorticity[d].evaluate(lmp, igroup, w_inf.data() + d, 3);
  for (int i = 0; i < n; i++)
    for (int d = 0; d < 3; d++) {
      const int e = (d + 1) % 3, f = (d + 2) % 3;    // w_d = (d u_f / d x_e - d u_e / d x_f) / 2
      double *G = &gradient[9 * (size_t) i], *w = &w_inf[3 * (size_t) i + d];
      if (has_vorticity) {
        const double strain = 0.5 * (G[3 * f + e] + G[3 * e + f]);
        G[3 * f + e] = strain + 0.5 * *w;
        G[3 * e + f] = strain - 0.5 * *w;
      }
      *w = 0.5 * (G[3 * f + e] - G[3 * e + f]);
    }
}

double PairStokesDynamics::drag_of(int i) const
{
  return 6.0 * SD_PI * viscosity(i) * atom->radius[i];
}

double PairStokesDynamics::spin_of(int i) const
{
  const double a = atom->radius[i];
  return 8.0 * SD_PI * viscosity(i) * a * a * a;
}

/* Fluid less sphere: velocity, and with rotation angular velocity. */
void PairStokesDynamics::slip_of(int i, double *s) const
{
  const double *u = fluid_at(i), *v = atom->v[i];
  for (int d = 0; d < 3; d++) s[d] = u[d] - v[d];
  if (!scene.settings.rotation) return;
  const double *w = atom->omega[i];
  for (int d = 0; d < 3; d++) s[3 + d] = (fluid_varies ? w_inf[3 * (size_t) i + d] : 0.0) - w[d];
}

/* Who takes part, viscosity, fluid velocity. */
void PairStokesDynamics::state_of_the_step()
{
  const int n = atom->nlocal;
  active.resize(n);
  u_varies = false;
  for (const auto &u : fluid_velocity) u_varies = u_varies || u.is_atom_style();

  if (!numbers_only()) modify->clearstep_compute();
  if (visc.is_atom_style()) eta.resize(n + 1);
  visc.evaluate(lmp, igroup, visc.is_atom_style() ? eta.data() : nullptr, 1);
  if (u_varies) u_inf.resize(3 * (size_t) n + 3);
  for (int d = 0; d < 3; d++) {
    fluid_velocity[d].evaluate(lmp, igroup, u_varies ? u_inf.data() + d : nullptr, 3);
    u_uniform[d] = fluid_velocity[d].number();
  }
  fluid_varies = false;
  if (scene.settings.rotation || rigid.settings.on) fluid_gradient();
  if (!numbers_only()) modify->addstep_compute(update->ntimestep + 1);

  if (region) region->prematch();
  for (int i = 0; i < n; i++) active[i] = selected(i);
}

void PairStokesDynamics::compute(int eflag, int vflag)
{
  using State = FixStokesDynamicsState;
  ev_init(eflag, vflag);
  if (neighbor->ago == 0) scene.lists_are_stale();
  state_of_the_step();

  const int n = atom->nlocal;
  const bool rotation = scene.settings.rotation;
  double **state = fix_state->state;
  State::Global &global = fix_state->global;
  const double step = update->ntimestep;

  // A run that begins where and as the last one ended goes on with the force of that step.
  const bool continued = update->setupflag && step == global.last_step;
  bool same_numbers = numbers_only() && visc.number() == global.eta;
  for (int d = 0; d < 3; d++)
    same_numbers = same_numbers && fluid_velocity[d].number() == global.u_inf[d] &&
        fluid_vorticity[d].number() == global.vorticity[d];

  // spheres, newcomers, faults; since the last run: displaced, pushed
  double count[5] = {0.0, 0.0, 0.0, 0.0, 0.0};
  if (continued && !fix_state->box_left_as_is()) count[3]++;
  for (int i = 0; i < n; i++) {
    if (faulty(i) != NONE) count[2]++;
    if (!active[i]) continue;
    count[0]++;
    if (state[i][State::SOLVED] == 0.0) count[1]++;
    if (continued && !fix_state->placed_as_left(i)) count[3]++;
    if (continued && !fix_state->moving_as_left(i)) count[4]++;
  }
  MPI_Allreduce(MPI_IN_PLACE, count, 5, MPI_DOUBLE, MPI_SUM, world);
  if (count[2] > 0.0) complain();
  const bool same_spheres = count[1] == 0.0 && count[0] == global.spheres;
  const bool displaced = count[3] > 0.0, pushed = count[4] > 0.0;

  const bool stands = continued && same_numbers && same_spheres && !displaced && !pushed;
  if (!stands) {
    // v' is due every update_every steps, and at once when the spheres are not those of the last solve: none lacks a v', none has
    // gone, and nobody has displaced or changed them between two runs.
    const bool due = !same_spheres || displaced || fmod(step, update_every) == 0.0 ||
        step < global.last_solve ||
        floor(step / update_every) != floor(global.last_solve / update_every);
    if (rigid.settings.on)
      rigid_forces();
    else
      solving = active;
    if (due) {
      if (!rigid.settings.on || rigid.any_loose()) solve();
      global.last_solve = step;
      global.spheres = count[0];
    }
    for (int i = 0; i < n; i++) {
      if (rigid.settings.on && !solving[i] && active[i]) continue;
      if (!active[i]) {
        for (int d = 0; d < 3; d++) state[i][State::FORCE + d] = state[i][State::VPRIME + d] = 0.0;
        for (int d = 0; d < 3 && rotation; d++)
          state[i][State::TORQUE + d] = state[i][State::WPRIME + d] = 0.0;
        continue;
      }
      double s[6];
      slip_of(i, s);
      const double k = drag_of(i), k_spin = rotation ? spin_of(i) : 0.0;
      for (int d = 0; d < 3; d++) {
        state[i][State::FORCE + d] = k * (s[d] + state[i][State::VPRIME + d]);
        if (rotation)
          state[i][State::TORQUE + d] = k_spin * (s[3 + d] + state[i][State::WPRIME + d]);
      }
    }
  }
  global.last_step = step;
  global.eta = visc.number();
  for (int d = 0; d < 3; d++) {
    global.u_inf[d] = fluid_velocity[d].number();
    global.vorticity[d] = fluid_vorticity[d].number();
  }

  // rigid_forces() adds its own
  const bool added = rigid.settings.on && !rigid.settings.auto_resolve;
  if (add_force)
    for (int i = 0; i < n; i++)
      if (stands || !added || solving[i]) add(i);

  // compute pair sums this over the ranks
  const bool root = comm->me == 0;
  pvector[0] = root ? global.iterations : 0.0;
  pvector[1] = root ? global.residual : 0.0;
  pvector[2] = root ? global.unconverged : 0.0;
  pvector[3] = 0.0;
  if (eflag_global)    // else nobody asks in this step
    for (int i = 0; i < n; i++) pvector[3] += dissipation(i);
}

double PairStokesDynamics::dissipation(int i) const
{
  if (!active[i]) return 0.0;
  const double *F = drag_force(i), *T = drag_torque(i);
  double s[6];
  slip_of(i, s);
  double power = F[0] * s[0] + F[1] * s[1] + F[2] * s[2];
  if (T) power += T[0] * s[3] + T[1] * s[4] + T[2] * s[5];
  return power;
}

void PairStokesDynamics::add(int i)
{
  using State = FixStokesDynamicsState;
  const double *state = fix_state->state[i];
  for (int d = 0; d < 3; d++) atom->f[i][d] += state[State::FORCE + d];
  if (!scene.settings.rotation) return;
  for (int d = 0; d < 3; d++) atom->torque[i][d] += state[State::TORQUE + d];
}

int PairStokesDynamics::pack_forward_comm(int n, int *list, double *buf, int /*pbc_flag*/,
                                          int * /*pbc*/)
{
  return scene.pack_forward_comm(n, list, buf);
}

void PairStokesDynamics::unpack_forward_comm(int n, int first, double *buf)
{
  scene.unpack_forward_comm(n, first, buf);
}
