#include "pair_stokes_dynamics.h"

#include "fix_stokes_dynamics.h"
#include "keywords.h"
#include "lammps_compat.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static const std::string COMMAND = "Pair style stokes_dynamics";
static const char *STATE_ID = "STOKES_DYNAMICS_STATE";

PairStokesDynamics::PairStokesDynamics(LAMMPS *lmp) :
    Pair(lmp), scene(lmp, this, COMMAND), rigid(lmp, scene, COMMAND)
{
  single_enable = 0;
  respa_enable = 0;
  manybody_flag = 1;
  one_coeff = 1;
  restartinfo = 1;
  no_virial_fdotr_compute =
      1;                // drag acts between sphere and fluid: its x.F depends on the origin
  comm_forward = 19;    // most: what rigid clumps know of an atom (RigidClumps::gather)
  nextra = 4;           // compute pair: iterations, residual, unconverged solves, dissipation
  pvector = new double[nextra];
  for (int k = 0; k < nextra; k++) pvector[k] = 0.0;
}

PairStokesDynamics::~PairStokesDynamics()
{
  if (find_state()) modify->delete_fix(STATE_ID);
  delete[] pvector;
  if (allocated) {
    memory->destroy(setflag);
    memory->destroy(cutsq);
  }
}

// --- settings ----------------------------------------------------------------------------------------------

void PairStokesDynamics::settings(int narg, char **arg)
{
  args = words(narg, arg);
  parse();
}

FixStokesDynamicsState *PairStokesDynamics::find_state() const
{
  return static_cast<FixStokesDynamicsState *>(Compat::fix(modify, STATE_ID));
}

void PairStokesDynamics::parse()
{
  update_every = 1;
  add_force = false;
  tolerance = 1e-3;
  max_iter = 100;
  algorithm = 1;
  visc = Field();
  for (auto &u : fluid_velocity) u = Field(0.0);
  for (auto &w : fluid_vorticity) w = Field(0.0);
  has_vorticity = false;
  region_id.clear();
  group_id = "all";
  scene.settings = Scene::Settings();
  scene.lists_are_stale();
  rigid.settings = RigidClumps::Settings();
  rigid.forget();
  bool has_shell = false;

  bool has_visc = false, has_cutoff = false;
  Keywords in(lmp, COMMAND, args);
  while (in.next()) {
    if (in.is("cut_off_distance")) {
      if (in.more() && in.peek() == "inf") {
        in.word();
        scene.settings.cutoff = INFINITY;
      } else
        scene.settings.cutoff = in.positive();
      has_cutoff = true;
    } else if (in.is("update_every"))
      update_every = in.integer(1);
    else if (in.is("clumps_only"))
      scene.settings.clumps_only = in.yes_no();
    else if (in.is("visc")) {
      visc = Field::parse(in);
      if (!visc.is_variable() && !(visc.number() > 0.0))
        in.refuse("'" + text(visc.number()) + "' must be > 0");
      has_visc = true;
    } else if (in.is("region"))
      region_id = in.word();
    else if (in.is("group"))
      group_id = in.word();
    else if (in.is("add_force"))
      add_force = in.yes_no();
    else if (in.is("relative_tolerance"))
      tolerance = in.positive();
    else if (in.is("max_iter"))
      max_iter = in.integer(1);
    else if (in.is("algorithm"))
      algorithm = 1 + in.choice({"1", "2"});
    else if (in.is("fluid_velocity"))
      for (auto &u : fluid_velocity) u = Field::parse(in);
    else if (in.is("fluid_vorticity")) {
      for (auto &w : fluid_vorticity) w = Field::parse(in);
      has_vorticity = true;
    } else if (in.is("rotation"))
      scene.settings.rotation = in.yes_no();
    else if (in.is("tensor"))
      scene.settings.tensor = in.choice({"rpy", "oseen"}) == 0 ? SD_TENSOR_RPY : SD_TENSOR_OSEEN;
    else if (in.is("rigid_clumps")) {
      const size_t choice = in.choice({"no", "yes", "auto"});
      rigid.settings.on = choice > 0;
      rigid.settings.auto_resolve = choice == 2;
    } else if (in.is("shell")) {
      rigid.settings.shell = in.integer(1);
      if (rigid.settings.shell > 1 && rigid.settings.shell < 12)
        in.refuse("'" + std::to_string(rigid.settings.shell) + "' must be 1 or >= 12");
      has_shell = true;
    } else if (in.is("taper") || in.is("precondition") || in.is("warm_start"))
      in.refuse("not available in this version");
    else
      in.unknown();
  }
  if (!has_visc) fail(lmp, COMMAND + ": keyword visc is required: the dynamic viscosity");
  if (!has_cutoff) {
    if (!scene.settings.clumps_only)
      fail(lmp,
           COMMAND +
               ": keyword cut_off_distance is required (a distance or inf) unless clumps_only yes");
    scene.settings.cutoff = INFINITY;
  }
  if (rigid.settings.on && !scene.settings.clumps_only)
    fail(lmp, COMMAND + ": keyword rigid_clumps requires clumps_only yes");
  if (rigid.settings.on && std::isfinite(scene.settings.cutoff))
    fail(lmp,
         COMMAND +
             ": keyword rigid_clumps: no cut_off_distance may be given, the whole of a clump is "
             "solved");
  if (has_shell && !rigid.settings.on)
    fail(lmp, COMMAND + ": keyword shell requires rigid_clumps yes");
  if (rigid.settings.on && scene.settings.tensor == SD_TENSOR_OSEEN)
    fail(lmp, COMMAND + ": keyword rigid_clumps is not available with tensor oseen");
  // Points on a surface take torques, whether rotation is asked for or not.
  if (rigid.settings.shell > 1) scene.settings.rotation = true;
  rigid.settings.rotation = scene.settings.rotation;
  if (scene.settings.rotation && scene.settings.tensor == SD_TENSOR_OSEEN)
    fail(lmp,
         COMMAND +
             ": keyword rotation: yes is not available with tensor oseen, whose point forces do "
             "not rotate");
  if (has_vorticity && !scene.settings.rotation)
    fail(lmp, COMMAND + ": keyword fluid_vorticity has no effect without rotation yes or a shell");
}

void PairStokesDynamics::coeff(int narg, char **arg)
{
  if (narg != 2 || strcmp(arg[0], "*") != 0 || strcmp(arg[1], "*") != 0)
    fail(lmp,
         COMMAND +
             ": the only form of pair_coeff is: pair_coeff * * (use the keywords group and region "
             "to select spheres)");
  if (!allocated) allocate();
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) setflag[i][j] = 1;
}

void PairStokesDynamics::allocate()
{
  allocated = 1;
  const int n = atom->ntypes;
  memory->create(setflag, n + 1, n + 1, "pair:setflag");
  memory->create(cutsq, n + 1, n + 1, "pair:cutsq");
  for (int i = 1; i <= n; i++)
    for (int j = i; j <= n; j++) setflag[i][j] = 0;
}

/* FNV-1a over all words */
static uint64_t hash(const std::vector<std::string> &words)
{
  uint64_t h = 14695981039346656037u;
  for (const auto &word : words)
    for (size_t k = 0; k <= word.size(); k++)
      h = (h ^ (unsigned char) word.c_str()[k]) * 1099511628211u;
  return h;
}

void PairStokesDynamics::init_style()
{
  if (update->whichflag == 2)
    fail(lmp,
         COMMAND +
             " cannot be minimised: a drag depends on velocities and has no energy; use "
             "'pair_style none' meanwhile");
  if (utils::strmatch(update->integrate_style, "^respa"))
    fail(lmp, COMMAND + " does not support run_style respa");
  if (force->pair_match(STYLE, 1) != this)
    fail(lmp, COMMAND + " may appear only once in a hybrid pair style");
  if (!atom->radius_flag)
    fail(lmp, COMMAND + " requires an atom style with radius, such as sphere");
  if (atom->tag_enable == 0) fail(lmp, COMMAND + " requires atom IDs");
  if (scene.settings.rotation && (!atom->omega_flag || !atom->torque_flag))
    fail(lmp,
         COMMAND +
             ": keyword rotation: yes requires an atom style with angular velocity and torque, "
             "such as sphere");
  if (scene.settings.clumps_only && !atom->molecule_flag)
    fail(lmp,
         COMMAND +
             ": keyword clumps_only: yes requires molecule IDs (atom_style hybrid sphere bond, or "
             "fix property/atom mol)");
  if (scene.all_pairs())
    for (int d = 0; d < domain->dimension; d++)
      if (domain->periodicity[d])
        fail(lmp,
             COMMAND +
                 ": keyword cut_off_distance: 'inf' requires a box that is not periodic, or "
                 "clumps_only yes");

  double largest = 0.0;
  for (int i = 0; i < atom->nlocal; i++)    // compute() complains of those that are not finite
    if (std::isfinite(atom->radius[i])) largest = std::max(largest, 2.0 * atom->radius[i]);
  MPI_Allreduce(&largest, &largest_diameter, 1, MPI_DOUBLE, MPI_MAX, world);

  region = nullptr;
  if (!region_id.empty() && !(region = Compat::region(domain, region_id)))
    fail(lmp, COMMAND + ": keyword region: region '" + region_id + "' does not exist");
  igroup = group->find(group_id);
  if (igroup < 0) fail(lmp, COMMAND + ": keyword group: group '" + group_id + "' does not exist");
  groupbit = group->bitmask[igroup];
  visc.init(lmp, COMMAND + ": keyword visc");
  for (auto &u : fluid_velocity) u.init(lmp, COMMAND + ": keyword fluid_velocity");
  for (auto &w : fluid_vorticity) w.init(lmp, COMMAND + ": keyword fluid_vorticity");

  // Here and not in the constructor: in read_restart, what the restart file holds for this fix is not known yet when the pair style is made.
  const bool rotation = scene.settings.rotation;
  if (find_state() && (find_state()->columns == FixStokesDynamicsState::WITH_ROTATION) != rotation)
    modify->delete_fix(STATE_ID);
  if (!find_state())
    modify->add_fix(std::string(STATE_ID) + " all " + FixStokesDynamicsState::STYLE +
                    (rotation ? " rotation" : ""));
  fix_state = find_state();
  fix_state->settings_are(hash(args));

  bool applied = add_force;
  for (int i = 0; i < modify->nfix; i++)
    if (strcmp(modify->fix[i]->style, FixStokesDynamics::STYLE) == 0)
      applied = applied || static_cast<FixStokesDynamics *>(modify->fix[i])->applies(add_force);
  if (!applied && !warned_nobody_applies) {
    warned_nobody_applies = true;
    if (comm->me == 0)
      error->warning(FLERR,
                     std::string(COMMAND +
                                 ": nothing applies the force: add_force is no and no fix "
                                 "stokes_dynamics applies it"));
  }
  scene.lists_are_stale();
  rigid.new_run();
  warned_unconverged = false;
}

double PairStokesDynamics::init_one(int i, int j)
{
  if (setflag[i][j] == 0) fail(lmp, COMMAND + ": pair_coeff * * is missing");
  // Without a cut-off this style needs no ghosts but those of clumps (Scene::check_clumps). A length is returned all the same, since
  // LAMMPS warns of lost atoms and stops sorting them when there is none.
  return std::isfinite(scene.settings.cutoff) ? scene.settings.cutoff : largest_diameter;
}

void *PairStokesDynamics::extract(const char *name, int &dim)
{
  dim = 0;
  if (strcmp(name, "visc") == 0 && !visc.is_variable()) return visc.address();
  return nullptr;
}

double PairStokesDynamics::memory_usage()
{
  return scene.memory_usage() +
      sizeof(double) *
      (double) (eta.capacity() + u_inf.capacity() + w_inf.capacity() + gradient.capacity() +
                slip.capacity() + drag.capacity() + spin.capacity() + solution.capacity() +
                work.capacity()) +
      rigid.memory_usage();
}

// --- a step ------------------------------------------------------------------------------------------------

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
    if (scene.settings.rotation)
      sum += atom->omega[i][0] + atom->omega[i][1] + atom->omega[i][2];
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
        for (int d = 0; d < 3; d++) state[i][State::FORCE + d] = 0.0;
        for (int d = 0; d < 3 && rotation; d++) state[i][State::TORQUE + d] = 0.0;
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

/* Forces of rigid clumps, and the v' that they stand for. Spheres of other clumps, and lone ones, are the solver's. */
void PairStokesDynamics::rigid_forces()
{
  using State = FixStokesDynamicsState;
  const int n = atom->nlocal;
  const bool rotation = scene.settings.rotation;
  const RigidClumps::Motion motion = {active,
                                      visc.is_atom_style() ? eta.data() : nullptr,
                                      visc.number(),
                                      u_varies ? u_inf.data() : nullptr,
                                      u_uniform,
                                      fluid_varies ? gradient.data() : nullptr};
  // While it is still in the cache; unless the clump may yet turn out, on another rank, to be the solver's.
  const bool add_now = add_force && !rigid.settings.auto_resolve;
  auto take = [this, rotation, add_now](int i, const double *F, const double *T) {
    double *state = fix_state->state[i], s[6];
    slip_of(i, s);
    const double k = 1.0 / drag_of(i), k_spin = rotation ? 1.0 / spin_of(i) : 0.0;
    for (int d = 0; d < 3; d++) {
      state[State::FORCE + d] = F[d];
      state[State::VPRIME + d] = F[d] * k - s[d];
      if (!rotation) continue;
      state[State::TORQUE + d] = T[d];
      state[State::WPRIME + d] = T[d] * k_spin - s[3 + d];
    }
    state[State::SOLVED] = 1.0;
    if (add_now) add(i);
  };
  rigid.forces(motion, take, solving);
  const bool lone_only = !rigid.any_loose();    // then nobody disturbs the fluid there
  for (int i = 0; i < n; i++) {
    solving[i] = solving[i] && active[i];
    if (active[i] && !(solving[i] && lone_only)) continue;
    double *state = fix_state->state[i];
    state[State::SOLVED] = active[i] ? 1.0 : 0.0;
    if (!active[i]) continue;
    for (int d = 0; d < 3; d++) state[State::VPRIME + d] = 0.0;
    for (int d = 0; d < 3 && rotation; d++) state[State::WPRIME + d] = 0.0;
  }
}

/* v' of every sphere, from the forces that solve the system for the velocities of now. */
void PairStokesDynamics::solve()
{
  const int n = atom->nlocal;
  const size_t m = width();
  const bool rotation = scene.settings.rotation;
  solution.resize(m * n + m);
  work.resize(SD_SOLVE_WORK(n, width()) + 1);
  eta.resize(n + 1);
  if (!visc.is_atom_style()) std::fill(eta.begin(), eta.end(), visc.number());
  scene.update(solving, eta);
  slip.assign(m * n + m, 0.0);
  drag.assign(n + 1, 0.0);
  if (rotation) spin.assign(n + 1, 0.0);
  for (int i = 0; i < n; i++) {
    if (!active[i]) continue;
    slip_of(i, &slip[m * i]);
    if (solving[i]) drag[i] = drag_of(i);
    if (rotation) spin[i] = spin_of(i);
  }

  sd_system system = {};
  system.n = n;
  system.drag = drag.data();
  system.spin = rotation ? spin.data() : nullptr;
  system.apply = Scene::apply;
  system.sum = Scene::sum;
  system.apply_ctx = system.sum_ctx = &scene;
  sd_solve_report report;
  auto solver = algorithm == 1 ? sd_solve_substitution : sd_solve_gradients;
  const sd_status status =
      solver(&system, slip.data(), tolerance, max_iter, solution.data(), work.data(), &report);

  FixStokesDynamicsState::Global &global = fix_state->global;
  global.solves++;
  global.iterations = report.iterations;
  global.residual = report.residual;
  if (status != SD_OK) solver_failed(status, report);

  using State = FixStokesDynamicsState;
  double **state = fix_state->state;
  for (int i = 0; i < n; i++) {
    const double *F = &solution[m * i], *si = &slip[m * i];
    if (active[i] && !solving[i]) continue;    // of a rigid clump
    state[i][State::SOLVED] = active[i] ? 1.0 : 0.0;
    for (int d = 0; d < 3; d++) {
      state[i][State::VPRIME + d] = active[i] ? F[d] / drag[i] - si[d] : 0.0;
      if (rotation) state[i][State::WPRIME + d] = active[i] ? F[3 + d] / spin[i] - si[3 + d] : 0.0;
    }
  }
}

/* Returns for a solve whose answer may still be used; ends the run otherwise. */
void PairStokesDynamics::solver_failed(sd_status status, const sd_solve_report &report)
{
  const std::string where = COMMAND + ": step " + std::to_string(update->ntimestep) +
      ": algorithm " + std::to_string(algorithm) + ": ";
  const std::string how_far =
      "residual " + text(report.residual) + " after iteration " + std::to_string(report.iterations);
  const std::string cutoff = std::isinf(scene.settings.cutoff) ? "inf"
                                                               : text(scene.settings.cutoff);
  switch (status) {
    case SD_EMAXITER:
    case SD_ESTAGNATED:
      fix_state->global.unconverged++;
      if (!warned_unconverged && comm->me == 0)
        error->warning(
            FLERR,
            std::string(
                where + sd_status_string(status) + ": " + how_far + ", relative_tolerance " +
                text(tolerance) +
                (status == SD_EMAXITER ? ", max_iter " + std::to_string(max_iter) : std::string()) +
                "; the run goes on, further ones are counted (compute pair, fix stokes_dynamics)"));
      warned_unconverged = true;
      return;
    case SD_EDIVERGED:
      fail(lmp,
           where + "diverged: " + how_far + ", growing by a factor " + text(report.growth) +
               " each; use algorithm 2");
    case SD_EINDEFINITE:
      fail(lmp,
           where + sd_status_string(status) + " with " +
               (scene.settings.tensor == SD_TENSOR_OSEEN
                    ? "tensor oseen: spheres are too close for it, use tensor rpy"
                    : "cut_off_distance " + cutoff +
                        ", so any answer would be noise: use cut_off_distance inf, or clumps_only "
                        "yes "
                        "with a cut-off larger than the clump") +
               " (" + how_far + ", curvature " + text(report.curvature) + ")");
    case SD_ESINGULAR:
      fail(lmp,
           where + sd_status_string(status) + ": spheres at one point with different velocities (" +
               how_far + ")");
    default:
      fail(lmp, where + sd_status_string(status) + " (" + how_far + ")");
  }
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

// --- restart -------------------------------------------------------------------------------------------------
// The words of the pair_style command, and the viscosity where fix adapt may have changed it.

static const int RESTART_FORMAT = 1;

void PairStokesDynamics::write_restart(FILE *fp)
{
  write_restart_settings(fp);
}

void PairStokesDynamics::read_restart(FILE *fp)
{
  read_restart_settings(fp);
  allocate();
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) setflag[i][j] = 1;
}

void PairStokesDynamics::write_restart_settings(FILE *fp)
{
  std::string all;
  for (const auto &word : args) all += word + '\n';
  const int size = all.size();
  const double eta_now = visc.number();
  fwrite(&RESTART_FORMAT, sizeof(int), 1, fp);
  fwrite(&eta_now, sizeof(double), 1, fp);
  fwrite(&size, sizeof(int), 1, fp);
  fwrite(all.data(), 1, size, fp);
}

void PairStokesDynamics::read_restart_settings(FILE *fp)
{
  int format = 0, size = 0;
  double eta_then = 0.0;
  const bool root = comm->me == 0;
  if (root) utils::sfread(FLERR, &format, sizeof(int), 1, fp, nullptr, error);
  MPI_Bcast(&format, 1, MPI_INT, 0, world);
  if (format != RESTART_FORMAT)
    fail(lmp,
         COMMAND + ": the restart file is of format " + std::to_string(format) +
             ", this version reads " + std::to_string(RESTART_FORMAT));
  if (root) {
    utils::sfread(FLERR, &eta_then, sizeof(double), 1, fp, nullptr, error);
    utils::sfread(FLERR, &size, sizeof(int), 1, fp, nullptr, error);
  }
  MPI_Bcast(&eta_then, 1, MPI_DOUBLE, 0, world);
  MPI_Bcast(&size, 1, MPI_INT, 0, world);
  std::string all(size, '\0');
  if (root && size) utils::sfread(FLERR, &all[0], 1, size, fp, nullptr, error);
  MPI_Bcast(&all[0], size, MPI_CHAR, 0, world);

  args.clear();
  for (size_t from = 0, to; (to = all.find('\n', from)) != std::string::npos; from = to + 1)
    args.push_back(all.substr(from, to - from));
  parse();
  if (!visc.is_variable()) *visc.address() = eta_then;
}
