#include "pair_stokes_dynamics.h"

#include "boundary_checks.h"
#include "deform_checks.h"
#include "fix_stokes_dynamics.h"
#include "fix_stokes_dynamics_overdamped.h"
#include "fixes.h"
#include "keywords.h"
#include "restart.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "force.h"
#include "memory.h"
#include "neighbor.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

using State = FixStokesDynamicsState;

PairStokesDynamics::PairStokesDynamics(LAMMPS *lmp) : Pair(lmp), hydro(lmp), sorting_bins(lmp)
{
  single_enable = 1;
  respa_enable = 0;
  manybody_flag = 1;
  restartinfo = 1;
  no_virial_fdotr_compute = 1;    // drag is between sphere and fluid: its x.F depends on the origin
  nextra = 4;
  pvector = reported;
}

PairStokesDynamics::~PairStokesDynamics()
{
  State::take_away(lmp);
  if (allocated) {
    memory->destroy(setflag);
    memory->destroy(cutsq);
  }
}

// --- a step ------------------------------------------------------------------------------------------------------

void PairStokesDynamics::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);
  if (hydro.overdamped) return;
  if (asked_again()) {
    if (hydro.settings.add_force) add();
    return;
  }
  // LAMMPS has printed the first step by now: does the user ask for the pressure?
  if (update->ntimestep == update->firststep + 1) look_at_neighbours();
  hydro.begin();
  check_images(voice, hydro.ambient.jumps());
  const Verdict verdict = what_is_due();
  if (verdict != STANDS) {
    hydro.clumps();
    if (verdict == SOLVE) hydro.solve();
    hydro.drag();
  } else
    hydro.keep_forces();
  if (hydro.settings.add_force) add();
  report();
  asked = {update->ntimestep, neighbor->ncalls};
  asked_in.set(hydro.epochs.run);
}

/* Some commands try what forces and energies would be if atoms stood elsewhere (fix numdiff, compute
 * born/matrix numdiff), or look at them at the end of a step, when velocities are others. The forces of
 * this step stand all the while: the next run may go on with them. Fixes that create or swap atoms try
 * before LAMMPS re-neighbours for the step. */
bool PairStokesDynamics::asked_again() const
{
  return asked_in.is(hydro.epochs.run) && asked.step == update->ntimestep &&
      asked.builds == neighbor->ncalls && hydro.computed_in(update->ntimestep);
}

/* For compute pair/local and its like below a hybrid, which ask all styles of it: drag is no force of a
 * pair, so its share is 0. Alone it has no answer: computes see that (init_style), pair_write asks before. */
double PairStokesDynamics::single(int, int, int, int, double, double, double, double &fforce)
{
  if (force->pair == this) voice.fail("a drag is no force between two atoms: pair_write has nothing to write");
  fforce = 0.0;
  return 0.0;
}

/* v' is due every update_every steps, and at once when the spheres are not those of the last solve:
 * none lacks a v', none has gone, and nobody has displaced them between two runs. Whether they were is
 * known of a run that begins in the step in which the last one ended: others solve. */
PairStokesDynamics::Verdict PairStokesDynamics::what_is_due()
{
  const State *memory = hydro.memory;
  State::Global &global = hydro.memory->global;
  const double step = update->ntimestep, period = hydro.settings.update_every;
  const bool continued = update->setupflag && step == global.last_step &&
      global.reported >= (double) hydro.reports_perturbation;
  global.reported = hydro.reports_perturbation;

  enum { SPHERES, NEWCOMERS, DISPLACED, PUSHED, COUNTS };
  double count[COUNTS] = {(double) hydro.ambient.who().size(), 0.0, 0.0, 0.0};
  for (int i : hydro.ambient.who()) {
    if (!memory->rows.has(i)) count[NEWCOMERS]++;
    if (continued && !memory->placed_as_left(i)) count[DISPLACED]++;
    if (continued && !memory->moving_as_left(i)) count[PUSHED]++;
  }
  if (continued && !memory->box_left_as_is()) count[DISPLACED]++;
  MPI_Allreduce(MPI_IN_PLACE, count, COUNTS, MPI_DOUBLE, MPI_SUM, world);

  double numbers[Ambient::NUMBERS];
  hydro.ambient.numbers(numbers);
  const bool same_spheres = count[NEWCOMERS] == 0.0 && count[SPHERES] == global.spheres;
  const bool same_fluid = hydro.ambient.numbers_only() &&
      std::equal(numbers, numbers + Ambient::NUMBERS, global.numbers);
  std::copy(numbers, numbers + Ambient::NUMBERS, global.numbers);
  if (update->setupflag) hydro.new_run(continued && same_spheres && count[DISPLACED] == 0.0);
  global.last_step = step;
  if (continued && same_fluid && same_spheres && count[DISPLACED] + count[PUSHED] == 0.0)
    return STANDS;
  const bool known = continued || !update->setupflag;
  if (known && same_spheres && count[DISPLACED] == 0.0 && std::fmod(step, period) != 0.0 &&
      step >= global.last_solve &&
      std::floor(step / period) == std::floor(global.last_solve / period))
    return OLD_PERTURBATION;
  global.last_solve = step;
  global.spheres = count[SPHERES];
  return SOLVE;
}

/* The one place where the force is added, but for fix stokes_dynamics, which is another's. */
void PairStokesDynamics::add()
{
  for (int i : hydro.ambient.who()) {
    const double *F = hydro.force(i), *T = hydro.torque(i);
    for (int d = 0; d < 3; d++) atom->f[i][d] += F[d];
    for (int d = 0; d < 3 && T; d++) atom->torque[i][d] += T[d];
  }
}

/* For compute pair, which sums over the ranks. */
void PairStokesDynamics::report()
{
  const State::Global &global = hydro.memory->global;
  const bool root = comm->me == 0;
  pvector[0] = root ? global.iterations : 0.0;
  pvector[1] = root ? global.residual : 0.0;
  pvector[2] = root ? global.unconverged : 0.0;
  pvector[3] = 0.0;
  if (eflag_global)    // else nobody asks in this step
    for (int i : hydro.ambient.who()) pvector[3] += hydro.dissipation(i);
}

// --- settings ----------------------------------------------------------------------------------------------------

void PairStokesDynamics::settings(int narg, char **arg)
{
  args = words(narg, arg);
  hydro.set(args);
}

void PairStokesDynamics::coeff(int narg, char **arg)
{
  if (narg != 2 || strcmp(arg[0], "*") != 0 || strcmp(arg[1], "*") != 0)
    voice.fail("the only form of pair_coeff is: pair_coeff * * (use the keywords group and region "
               "to select spheres)");
  accept_all_types();
}

void PairStokesDynamics::accept_all_types()
{
  const int n = atom->ntypes;
  if (!allocated) {
    memory->create(setflag, n + 1, n + 1, "pair:setflag");
    memory->create(cutsq, n + 1, n + 1, "pair:cutsq");
  }
  allocated = 1;
  for (int i = 1; i <= n; i++)
    for (int j = i; j <= n; j++) setflag[i][j] = 1;
}

void PairStokesDynamics::init_style()
{
  if (update->whichflag == 2)
    fail(lmp,
         voice.command +
             " cannot be minimised: a drag depends on velocities and has no energy; define the pair "
             "styles without it meanwhile ('pair_style none' if there are no others)");
  if (utils::strmatch(update->integrate_style, "^respa"))
    fail(lmp, voice.command + " does not support run_style respa");
  if (force->pair_match(STYLE, 1) != this)
    fail(lmp, voice.command + " may appear only once in a hybrid pair style");
  require_atoms();
  single_enable = force->pair != this;    // alone it would say that there are no forces
  const SceneSettings &scene = hydro.settings.scene;
  if (hydro.settings.precondition == StokesSettings::WAVES &&
      !(domain->xperiodic && domain->yperiodic && domain->zperiodic))
    voice.fail("keyword precondition: 'waves' requires a periodic box");
  const bool may_precondition = hydro.settings.algorithm == StokesSettings::GRADIENTS &&
      hydro.settings.precondition != StokesSettings::NONE;
  if (hydro.settings.rigid.on || may_precondition) check_room_of_blas(voice);

  double largest = 0.0;
  for (int i = 0; i < atom->nlocal; i++)    // compute() complains of those that are not finite
    if (std::isfinite(atom->radius[i])) largest = std::max(largest, 2.0 * atom->radius[i]);
  largest_diameter = largest_of_all(world, largest);

  hydro.init();
  // Here and not in the constructor: in read_restart, what the file holds for this fix is not known yet.
  State *state = State::provide(lmp, hydro.settings);
  state->settings_are(words_of_now());
  state->rigid = hydro.settings.rigid.on;
  look_for_fixes();
  check_layer(voice, hydro.settings, hydro.overdamped);
  refuse_moving_box(voice, scene.boundary);
  check_deform(voice, !hydro.overdamped, hydro.ambient.varies(), hydro.settings.rigid.on);
  refuse_wide_skin(voice, range(), largest_diameter);
  sorting_bins.limit(range());
  if (!hydro.overdamped) look_at_neighbours();    // the fix does so that moves them
}

/* Spheres of a fix stokes_dynamics that applies the force, or all that are selected */
void PairStokesDynamics::look_at_neighbours()
{
  int bits = hydro.settings.add_force ? ~0 : 0;
  for (const auto *fix : fixes_of<FixStokesDynamics>(lmp))
    if (fix->applies()) bits |= fix->groupbit;
  const std::vector<char> chosen = hydro.ambient.chosen_now();
  neighbourhood.look(voice, stokes_neighbours,
                     fact(FORCE, bits != 0) | fact(APPLIED, bits != 0 && !hydro.settings.add_force) |
                         fact(ADDED, hydro.settings.add_force) |
                         fact(TURNING, hydro.rotation()) |
                         fact(RESTING, hydro.ambient.settings.rests()),
                     [&](int i) { return chosen[i] && (atom->mask[i] & bits) ? FREE : 0u; });
  if (bits != 0 && bits != ~0) warn_of_undragged(chosen, bits);
}

/* Does a fix integrate spheres that take part, but to which no fix stokes_dynamics adds the force? Those of
 * fix move have a given velocity, and others may be held. */
void PairStokesDynamics::warn_of_undragged(const std::vector<char> &chosen, int dragged)
{
  if (warned_undragged) return;
  const tagint first = first_moved(lmp, "move setforce freeze",
                                   [&](int i) { return chosen[i] && !(atom->mask[i] & dragged); });
  if (!first) return;
  warned_undragged = true;
  voice.warn("atom " + std::to_string(first) + " takes part and is moved, but no fix stokes_dynamics applies its "
             "force: others feel it, and it feels no fluid; give that fix all spheres that take part, or keyword "
             "group only those of its group");
}

/* Those of the command, and where walls at sides of the box stand: that may have changed */
std::vector<std::string> PairStokesDynamics::words_of_now() const
{
  std::vector<std::string> now = args;
  for (const std::string &at : hydro.scene.settings.boundary.edges()) now.push_back(at);
  return now;
}

void PairStokesDynamics::require_atoms()
{
  const StokesSettings &settings = hydro.settings;
  if (!atom->radius_flag)
    fail(lmp, voice.command + " requires an atom style with radius, such as sphere");
  if (atom->tag_enable == 0) fail(lmp, voice.command + " requires atom IDs");
  if (settings.scene.rotation && (!atom->omega_flag || !atom->torque_flag))
    voice.fail("keyword rotation: yes requires an atom style with angular velocity and torque, "
               "such as sphere");
  if (atom->molecule_flag) return warn_of_no_clump();
  const std::string ways = " (atom_style hybrid sphere bond, or fix property/atom mol)";
  if (settings.precondition == StokesSettings::CLUMP)
    voice.fail("keyword precondition: 'clump' requires molecule IDs");
  if (settings.scene.clumps_only)
    voice.fail("keyword clumps_only: yes requires molecule IDs" + ways);
  if (settings.rigid.on) voice.fail("keyword rigid_clumps requires molecule IDs" + ways);
}

/* A forgotten molecule ID makes a clump into free spheres, without a word. */
void PairStokesDynamics::warn_of_no_clump()
{
  const auto in_clump = [this](int i) { return atom->molecule[i] != 0; };
  if (warned_no_clump || !hydro.settings.rigid.on || atom->natoms == 0 || first_atom(lmp, in_clump)) return;
  warned_no_clump = true;
  voice.warn("keyword rigid_clumps: all atoms have the molecule ID 0, so that each sphere is free and there is no "
             "clump: give the spheres of a clump an ID of their own");
}

void PairStokesDynamics::look_for_fixes()
{
  const auto fixes = fixes_of<FixStokesDynamics>(lmp);
  bool applied = hydro.settings.add_force;
  for (const auto *fix : fixes) applied = applied || fix->applies();
  hydro.reports_perturbation = !fixes.empty();
  hydro.overdamped = FixStokesDynamicsOverdamped::prepare(lmp);
  if (applied || hydro.overdamped || warned_nobody_applies) return;
  warned_nobody_applies = true;
  voice.warn("nothing applies the force: add_force is no and no fix stokes_dynamics applies it");
}

/* This style needs no ghosts (halo.h). A length is given to LAMMPS all the same, since it warns of
 * lost atoms and stops sorting them when there is none; no ghosts of ghosts for a giant in a small
 * box. */
double PairStokesDynamics::range() const
{
  double length = largest_diameter;
  for (int d = 0; d < 3; d++)
    if (domain->periodicity[d]) length = std::min(length, 0.5 * domain->prd[d]);
  return length;
}

double PairStokesDynamics::init_one(int i, int j)
{
  if (setflag[i][j] == 0) voice.fail("pair_coeff * * is missing");
  return range();
}

void *PairStokesDynamics::extract(const char *name, int &dim)
{
  dim = 0;
  Field &visc = hydro.ambient.settings.visc;
  const bool is_number = !visc.is_variable() && !hydro.ambient.settings.grid_has_visc;
  if (strcmp(name, "visc") == 0 && is_number) return visc.address();
  if (strcmp(name, "hydrodynamics") == 0) return &hydro;
  return nullptr;
}

double PairStokesDynamics::memory_usage()
{
  return hydro.memory_usage();
}

// --- restart -------------------------------------------------------------------------------------------------
// The words of the pair_style command, and the viscosity where fix adapt may have changed it.

void PairStokesDynamics::write_restart(FILE *fp)
{
  write_restart_settings(fp);
}

void PairStokesDynamics::read_restart(FILE *fp)
{
  read_restart_settings(fp);
  accept_all_types();
}

void PairStokesDynamics::write_restart_settings(FILE *fp)
{
  write_words(fp, args);
  const double eta_now = hydro.ambient.settings.visc.number();
  fwrite(&eta_now, sizeof(double), 1, fp);
}

void PairStokesDynamics::read_restart_settings(FILE *fp)
{
  args = read_words(lmp, fp, voice.command);
  double eta_then = 0.0;
  if (comm->me == 0) utils::sfread(FLERR, &eta_then, sizeof(double), 1, fp, nullptr, error);
  MPI_Bcast(&eta_then, 1, MPI_DOUBLE, 0, world);
  hydro.set(args);
  Field &visc = hydro.ambient.settings.visc;
  if (!visc.is_variable()) *visc.address() = eta_then;
}
