#include "fix_stokes_dynamics_overdamped.h"

#include "boundary_checks.h"
#include "checks.h"
#include "copy.h"
#include "deform_checks.h"
#include "fix_stokes_dynamics_field.h"
#include "fixes.h"
#include "keywords.h"
#include "lammps_compat.h"
#include "own_fix.h"

#include "sd_linear.h"

#include "atom.h"
#include "force.h"
#include "modify.h"
#include "output.h"
#include "pair.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixStokesDynamicsOverdamped::FixStokesDynamicsOverdamped(LAMMPS *lmp, int narg, char **arg) :
    RowsFix(lmp, narg, arg), adapt(), noise(voice), directions(lmp), drives(voice, directions), lone_velocity(3),
    random(6), steps(lmp, drives, directions, turned), before(9), output(OUTPUTS), turned(4),
    causes(lmp, drives)
{
  Keywords in = keywords(narg, arg);
  in.elsewhere("visc fluid_velocity fluid_vorticity cut_off_distance clumps_only region group rotation rigid_clumps "
               "shell multiblob multiblob_most one_body lubrication lubrication_gap lubrication_range wall flow tensor "
               "taper add_force update_every algorithm relative_tolerance max_iter precondition far_field "
               "far_field_tolerance warm_start",
               "pair_style stokes_dynamics");
  const auto drive = [&] { drives.read(in); };
  in.parse({
      {"scheme",
       [&] {
         const size_t which = in.choice({"ab2", "euler", "midpoint"});
         scheme = which == 0 ? AB2 : which == 1 ? EULER : MIDPOINT;
         scheme_given = true;
       }},
      {"adapt",
       [&] {
         adapt.every = in.value("N").integer(1);
         adapt.tmin = in.value("tmin").positive();
         adapt.tmax = in.value("tmax").positive();
         adapt.xmax = in.value("xmax").positive();
         if (adapt.tmin > adapt.tmax)
           in.refuse("tmin '" + text(adapt.tmin) + "' must not be above tmax '" +
                     text(adapt.tmax) + "'");
       }},
      {"held", drive},
      {"pin", drive},
      {"spin", drive},
      {"squirm", drive},
      {"torque", drive},
      {"temperature", [&] { noise.read_temperature(in); }},
      {"noise_tolerance", [&] { noise.read_tolerance(in); }},
  });
  in.require(in.given("temperature") || !in.given("noise_tolerance"),
             "keyword noise_tolerance requires a temperature");
  time_integrate = 1;
  dynamic_group_allow = 0;
  nevery = adapt.every ? adapt.every : 1;
  restart_global = 1;
  scalar_flag = vector_flag = 1;
  size_vector = 15;
  extscalar = 1;
  extvector = 0;
  global_freq = 1;
  std::vector<RowsOfAtoms *> rows = {&lone_velocity, &random, &drives.before, &before, &drives.overloaded(), &output};
  if (steps.turns()) rows.push_back(&directions.turning);
  keep(rows, &output, true, NO_BORDERS, {&turned});
}

int FixStokesDynamicsOverdamped::setmask()
{
  using namespace FixConst;
  return INITIAL_INTEGRATE | POST_INTEGRATE | FINAL_INTEGRATE | (adapt.every ? END_OF_STEP : 0);
}

void FixStokesDynamicsOverdamped::init()
{
  first = WAIT;
  Hydrodynamics &hydro = hydrodynamics();
  refuse_inertia(voice, hydro.settings);
  drives.init(hydro, groupbit);
  const std::string holds = drives.holds();
  refuse_in_layer(voice, hydro.settings.scene.boundary, holds, noise.on());
  look_at_neighbours();
  if (!scheme_given) scheme = noise.on() && !noise.drift(hydro, holds).empty() ? MIDPOINT : AB2;
  if (noise.on()) noise.init(hydro, {adapt.every > 0, scheme == MIDPOINT, holds});
  if (scheme == MIDPOINT) refuse_midpoint(hydro);
}

/* A sphere that has been in no clump until now has not turned with one; those of a restart file have turned as
 * their output says. */
void FixStokesDynamicsOverdamped::begin_turns(const Hydrodynamics &hydro)
{
  if (!turns_begun.first_in(hydro.epochs.lists)) return;
  for (int i : hydro.ambient.who()) {
    double *q = turned.writable(i);
    if (from_file) copy<4>(output[i] + TURNED, q);
    if (!in_clump(hydro, i))
      std::fill_n(q, 4, 0.0);
    else if (q[0] == 0.0 && sd_dot(q + 1, q + 1) == 0.0)
      q[0] = 1.0;
    copy<4>(q, output.writable(i) + TURNED);
  }
}

/* What torques and strokes are in this step */
void FixStokesDynamicsOverdamped::find_drives(const Hydrodynamics &hydro)
{
  begin_turns(hydro);
  drives.find([&](int i) {
    return in_clump(hydro, i) ? turned[i] : (const double *) nullptr;
  });
}

void FixStokesDynamicsOverdamped::look_at_neighbours()
{
  const Hydrodynamics &hydro = hydrodynamics();
  neighbourhood.look(voice, stokes_neighbours,
                     OVERDAMPED | fact(NOISE, noise.on()) | fact(ADAPTING, adapt.every > 0) |
                         fact(hydro.rotation() ? TURNING : UPRIGHT, true) | fact(MIDWAY, scheme == MIDPOINT) |
                         fact(RESTING, hydro.ambient.settings.rests()),
                     [this](int i) {
                       if (!(atom->mask[i] & groupbit)) return 0u;
                       return (unsigned) (drives.is_held(i) ? HELD : FREE);
                     }, this);
}

// --- a step ------------------------------------------------------------------------------------------------------

void FixStokesDynamicsLast::setup(int /*vflag*/)
{
  for (auto *fix : fixes_of<FixStokesDynamicsOverdamped>(lmp)) fix->after_setup();
  for (auto *fix : fixes_of<FixStokesDynamicsField>(lmp)) fix->end_of_step();
}

bool FixStokesDynamicsOverdamped::prepare(LAMMPS *lmp)
{
  using Last = FixStokesDynamicsLast;
  const bool there = !fixes_of(lmp, STYLE).empty();
  const OwnFix last(Voice(lmp, std::string("Fix ") + STYLE), Last::ID, Last::STYLE);
  last.take_away();
  if (there) last.make();
  return there;
}

void FixStokesDynamicsOverdamped::set_up_early()
{
  if (first != WAIT) return;
  set_up();
  causes.note(hydrodynamics());
  first = EARLY;
}

void FixStokesDynamicsOverdamped::after_setup()
{
  if (first != EARLY)
    set_up();
  else if (!causes.stand(hydrodynamics(), Causes::LOADS))
    voice.at_step().fail("a fix took its first value of a stress before all forces of this step were known: "
                         "define it after the fixes that add forces");
  first = FOUND;
}

void FixStokesDynamicsOverdamped::set_up()
{
  Hydrodynamics &hydro = hydrodynamics();
  hydro.begin();
  find_drives(hydro);
  noise.begin(last.step);
  const bool same_run = goes_on(hydro);
  if (!same_run || last.atoms != atom->natoms || !causes.stand(hydro)) forget_before();
  hydro.new_run(same_run);
  if (same_run && from_file && adapt.every && last.next_dt > 0.0) set_step(last.next_dt);
  from_file = false;
  steps.rest();
  growth = {};
  find_velocities(hydro);
  drives.note_start();
  if (!announced) announce();
  if (adapt.every && !same_run) end_of_step();
}

/* Does the run begin where, and as, the last one ended? Then the velocities of before still count. */
bool FixStokesDynamicsOverdamped::goes_on(const Hydrodynamics &hydro) const
{
  int moved = last.step != update->ntimestep || !hydro.memory->box_left_as_is();
  for (int i : hydro.ambient.who())
    if (!hydro.memory->placed_as_left(i)) moved = 1;
  return !largest_of_all(world, moved);
}

void FixStokesDynamicsOverdamped::forget_before()
{
  before.clear();
  drives.before.clear();
}

void FixStokesDynamicsOverdamped::announce()
{
  const Ambient &ambient = hydrodynamics().ambient;
  double least[2] = {INFINITY, INFINITY};    // drag, radius
  for (int i : ambient.who()) {
    least[0] = std::min(least[0], ambient.drag(i));
    least[1] = std::min(least[1], atom->radius[i]);
  }
  MPI_Allreduce(MPI_IN_PLACE, least, 2, MPI_DOUBLE, MPI_MIN, world);
  const auto &films = hydrodynamics().settings.lubrication;
  announce_step_limit(voice, scheme == EULER, least[0], films.on ? films.gap : 0.0);
  if (noise.on()) noise.announce(hydrodynamics(), least[1], least[0]);
  announced = true;
}

void FixStokesDynamicsOverdamped::final_integrate()
{
  Hydrodynamics &hydro = hydrodynamics();
  // LAMMPS has printed the first step by now: does the user ask for the pressure?
  if (update->ntimestep == update->firststep + 1) look_at_neighbours();
  hydro.begin();
  find_drives(hydro);
  if (last.atoms != atom->natoms) forget_before();    // those that are left move as they did not before
  find_velocities(hydro);
}

void FixStokesDynamicsOverdamped::find_velocities(Hydrodynamics &hydro)
{
  check_selection(hydro);
  drives.check_loads(hydro);
  check_images(voice, hydro.ambient.jumps());
  check_strain(voice, hydro.ambient.box_motion());
  // Another velocity than before (a dynamic group): on the line through both who is pinned would leave its place.
  if (causes.others_held(hydro)) forget_before();
  causes.due = true;
  if (has_noise_in_solve()) causes.note(hydro);    // which reads another fluid
  last.atoms = atom->natoms;
  const bool spins = hydro.rotation(), directed = steps.turns();
  const Solve::ToAtom take = [&, spins, directed](int i, const double *v, const double *F) {
    const double *fluid = hydro.ambient.velocity(i);
    double *row = output.writable(i), V[6] = {0.0}, torque[3] = {0.0};
    copy<3>(v, V);
    if (spins) {
      copy<3>(v + 3, V + 3);
      copy<3>(F + 3, torque);
    }
    steps.keep_in_plane(V);
    copy<3>(V, atom_row(atom->v, i));
    sd_minus(V, fluid, row);
    copy<3>(F, row + 3);
    copy<3>(torque, row + 6);
    if (in_clump(hydro, i))
      copy<4>(turned[i], row + TURNED);
    else
      copy<3>(V, lone_velocity.writable(i));
    if (!spins) return;
    copy<3>(V + 3, atom_row(atom->omega, i));
    if (directed) steps.note_found(i, V + 3);
    drives.note_found(i, V + 3, F + 3, change_of_loads());
  };
  if (scheme == MIDPOINT && noise.on())
    find_noisy_velocities(hydro, take);
  else if (scheme == MIDPOINT)
    begin_midpoint(hydro, take);
  else
    hydro.velocities(take, given());
  const size_t turns = directed && spins ? 6 : 3;
  if (noise.on() && scheme != MIDPOINT)
    noise.draw(hydro, turns, [this, turns](int i, const double *y) {
      std::copy_n(y, turns, random.writable(i));
    });
  velocity_change = change_of_velocities();
  last.step = update->ntimestep;
}

/* Spheres of the group that are not selected have no velocity; those selected that are not in the
 * group have none that this fix knows. */
void FixStokesDynamicsOverdamped::check_selection(const Hydrodynamics &hydro) const
{
  const std::vector<char> &active = hydro.ambient.active();
  if (const tagint wrong = first_atom(lmp, [&](int i) {
        return !(atom->mask[i] & groupbit) != !active[i];
      }))
    voice.fail("atom " + std::to_string(wrong) + " is selected either by the group of this fix or by "
               "pair_style stokes_dynamics (keywords group and region, radius > 0), but not by both: "
               "both must select the same atoms");
}

/* dt/(2 dt_old), what the change of velocities counts, of forces in scheme midpoint; 0: Euler, or it
 * has no row of the step before. What solves leave of their tolerance counts as much: a step far longer than the
 * last one, as a script may ask for, would be made of that alone. */
double FixStokesDynamicsOverdamped::weight(bool has) const
{
  constexpr double longest = 10.0;
  const bool follows = scheme != EULER && has && last.dt > 0.0 && update->dt <= longest * last.dt;
  return follows ? 0.5 * update->dt / last.dt : 0.0;
}

void FixStokesDynamicsOverdamped::initial_integrate(int /*vflag*/)
{
  if (scheme != MIDPOINT) advance();
}

/* Where those of fix move go is known by now, in whatever order the two fixes stand. */
void FixStokesDynamicsOverdamped::post_integrate()
{
  if (update->ntimestep == update->firststep + 1) drives.check_moved();
  if (scheme == MIDPOINT) advance();
  steps.follow_moved(hydrodynamics());
}

bool FixStokesDynamicsOverdamped::in_clump(const Hydrodynamics &hydro, int i) const
{
  return hydro.settings.rigid.on && atom->molecule[i] != 0;
}

void FixStokesDynamicsOverdamped::advance()
{
  Hydrodynamics &hydro = hydrodynamics();
  hydro.check_prepared();
  // who would move, and by which velocities, is forgotten by then
  if (first == WAIT)
    voice.fail("a command since the last run (write_data and write_restart are such) makes LAMMPS begin anew, "
               "so that the run must be prepared for: leave out 'pre no' of the run command");
  steps.rest();
  if (noise.on()) noise.warn_of_repeats();
  if (scheme != MIDPOINT && !warned_growth) watch();
  if (scheme == MIDPOINT) {
    steps.begin_where_put();
    if (noise.on())
      make_step(hydro, found(hydro));
    else
      move_by_midpoint(hydro);
  } else {
    bring_box_to_this_step(lmp);    // first: spheres of a clump may be images across faces that move
    for (int i : hydro.poses().lone()) move_free(hydro, i);
    if (hydro.settings.rigid.on) move_clumps(hydro);
  }
  last.dt = update->dt;
  drives.advance();
}

/* The next step as long as the fastest sphere allows; what must be told of it, as by fix dt/reset.
 */
void FixStokesDynamicsOverdamped::end_of_step()
{
  const double dt = sd_next_step(update->dt, fastest_of_all(), adapt.tmin, adapt.tmax, adapt.xmax);
  last.next_dt = dt;
  if (dt != update->dt) set_step(dt);
}

void FixStokesDynamicsOverdamped::set_step(double dt)
{
  update->update_time();
  update->dt = dt;
  update->dt_default = 0;
  if (force->pair) force->pair->reset_dt();
  for (int i = 0; i < modify->nfix; i++) modify->fix[i]->reset_dt();
  Compat::reset_dt(lmp->output);
}

/* A step that is too long for contacts shows as velocities that flip, and grow, with every step. */
void FixStokesDynamicsOverdamped::watch()
{
  const double error = largest_of_all(world, error_figure());
  if (!sd_grows(&growth, error)) return;
  warned_growth = true;
  voice.at_step().warn("the change of velocities grows from step to step, or stays large, and is " +
                       text(error) + " radii per step now: use a shorter time step");
}
