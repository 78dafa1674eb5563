#include "boundary_checks.h"
#include "fix_stokes_dynamics_overdamped.h"

#include "copy.h"
#include "fix_stokes_dynamics_field.h"
#include "fixes.h"
#include "keywords.h"
#include "lammps_compat.h"
#include "checks.h"

#include "sd_linear.h"

#include "atom.h"
#include "domain.h"
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
    RowsFix(lmp, narg, arg), adapt(), noise(voice), spin(voice), directions(lmp), torques(voice),
    squirmers(voice, directions), motion(3), random(6), load(6),
    steps(lmp, held, pinned, directions, output, TURNED), before(9), output(OUTPUTS)
{
  Keywords in = keywords(narg, arg);
  in.elsewhere("visc fluid_velocity rotation multiblob lubrication rigid_clumps wall cut_off_distance",
               "pair_style stokes_dynamics");
  in.parse({
      {"scheme",
       [&] {
         const size_t which = in.choice({"ab2", "euler", "midpoint"});
         scheme = which == 0 ? AB2 : which == 1 ? EULER : MIDPOINT;
         scheme_given = true;
       }},
      {"adapt",
       [&] {
         adapt.every = in.integer(1);
         adapt.tmin = in.positive();
         adapt.tmax = in.positive();
         adapt.xmax = in.positive();
         if (adapt.tmin > adapt.tmax)
           in.refuse("tmin '" + text(adapt.tmin) + "' must not be above tmax '" +
                     text(adapt.tmax) + "'");
       }},
      {"held", [&] { held.name = in.word(); }},
      {"pin", [&] { pinned.name = in.word(); }},
      {"spin", [&] { spin.read(in); }},
      {"squirm", [&] { squirmers.read(in); }},
      {"torque", [&] { torques.read(in); }},
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
  std::vector<RowsOfAtoms *> rows = {&motion, &random, &load, &before, &spin.slipping, &output};
  if (directions.on()) rows.push_back(&directions.turning);
  keep(rows, &output, true);
}

int FixStokesDynamicsOverdamped::setmask()
{
  using namespace FixConst;
  return INITIAL_INTEGRATE | POST_INTEGRATE | FINAL_INTEGRATE | (adapt.every ? END_OF_STEP : 0);
}

void FixStokesDynamicsOverdamped::init()
{
  first = WAIT;
  find_groups();
  directions.init(moved_bits != 0);
  refuse_inertia(voice, hydrodynamics().settings);
  refuse_in_layer(voice, hydrodynamics().settings.scene.boundary,
                  held.bit ? "keyword held" : pinned.bit ? "keyword pin" : "", noise.on());
  look_at_neighbours();
  spin.init(hydrodynamics(), held.bit | pinned.bit);
  torques.init(hydrodynamics(), groupbit, held.bit);
  squirmers.init(hydrodynamics(), groupbit);
  const char *holds = held.bit ? "keyword held"
      : pinned.bit             ? "keyword pin"
      : spin.on()              ? "keyword spin"
                               : "";
  if (!scheme_given)
    scheme = noise.on() && !noise.drift(hydrodynamics(), holds).empty() ? MIDPOINT : AB2;
  if (noise.on()) noise.init(hydrodynamics(), {adapt.every > 0, scheme == MIDPOINT, holds});
  if (scheme == MIDPOINT) refuse_midpoint(hydrodynamics());
}

void FixStokesDynamicsOverdamped::find_groups()
{
  held.find(voice.of("keyword held"));
  pinned.find(voice.of("keyword pin"));
  moved_bits = 0;
  for (const Fix *fix : fixes_of(lmp, "move"))
    if (held.bit) moved_bits |= fix->groupbit;
  if (!pinned.bit) return;
  if (const tagint both = first_atom(lmp, [this](int i) {
        return steps.is_held(i) && (atom->mask[i] & pinned.bit);
      }))
    voice.fail("keyword pin: atom " + std::to_string(both) + " is in the group of keyword held as well: "
               "it must be in one of them only");
  const Hydrodynamics &hydro = hydrodynamics();
  if (hydro.settings.rigid.apart())
    voice.fail("keyword pin: it is for spheres and clumps that feel each other: use clumps_only no of "
               "pair_style stokes_dynamics");
}

/* What torques and strokes are in this step */
void FixStokesDynamicsOverdamped::find_drives(const Hydrodynamics &hydro)
{
  squirmers.find();
  torques.find(directions, [&](int i) {
    return in_clump(hydro, i) ? output[i] + TURNED : (const double *) nullptr;
  });
}

void FixStokesDynamicsOverdamped::look_at_neighbours()
{
  const Hydrodynamics &hydro = hydrodynamics();
  neighbourhood.look(voice, stokes_neighbours,
                     OVERDAMPED | fact(NOISE, noise.on()) | fact(ADAPTING, adapt.every > 0) |
                         fact(hydro.rotation() ? TURNING : UPRIGHT, true) |
                         fact(RESTING, hydro.ambient.settings.rests()),
                     [this](int i) {
                       if (!(atom->mask[i] & groupbit)) return 0u;
                       return (unsigned) (steps.is_held(i) ? HELD : FREE);
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
  if (Compat::fix(lmp->modify, Last::ID)) lmp->modify->delete_fix(Last::ID);
  if (there) lmp->modify->add_fix(std::string(Last::ID) + " all " + Last::STYLE);
  return there;
}

void FixStokesDynamicsOverdamped::set_up_early()
{
  if (first != WAIT) return;
  set_up();
  first = EARLY;
}

void FixStokesDynamicsOverdamped::after_setup()
{
  if (first != EARLY)
    set_up();
  else if (!causes_stand(hydrodynamics()))
    voice.at_step().fail("a fix took its first value of a stress before all forces of this step were known: "
                         "define it after the fixes that add forces");
  first = FOUND;
}

void FixStokesDynamicsOverdamped::set_up()
{
  Hydrodynamics &hydro = hydrodynamics();
  hydro.begin();
  find_drives(hydro);
  const bool same_run = goes_on(hydro);
  if (!same_run || !causes_stand(hydro)) {
    before.clear();
    load.clear();
  }
  hydro.new_run(same_run);
  if (same_run && from_file && adapt.every && last.next_dt > 0.0) set_step(last.next_dt);
  from_file = false;
  steps.rest();
  growth = {};
  find_velocities(hydro);
  if (!announced) announce();
  if (adapt.every && !same_run) end_of_step();
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
  if (last.atoms != atom->natoms) {    // those that are left move as they did not before
    before.clear();
    load.clear();
  }
  find_velocities(hydro);
}

/* Those that fix move moves have the velocity that it gave them, others that are held have none. */
sd_body_known FixStokesDynamicsOverdamped::given_velocity(int i, double *V) const
{
  std::fill_n(V, 6, 0.0);
  if (atom->mask[i] & pinned.bit) return SD_BODY_PINNED;
  if (!steps.is_held(i)) return spin.turns(i, V + 3) ? SD_BODY_SPUN : SD_BODY_FREE;
  if (!is_moved(i)) return SD_BODY_HELD;
  std::copy_n(dragged.empty() ? atom->v[i] : &dragged[3 * (size_t) i], 3, V);
  if (atom->omega_flag) std::copy_n(atom->omega[i], 3, V + 3);
  return SD_BODY_HELD;
}

void FixStokesDynamicsOverdamped::find_velocities(Hydrodynamics &hydro)
{
  check_selection(hydro);
  check_images(voice, hydro.ambient.jumps());
  check_strain(voice, hydro.ambient.box_motion());
  double causes[CAUSES];
  find_causes(hydro, causes);
  forget_before_change(causes);
  std::copy_n(causes, (int) CAUSES, last.causes);
  last.atoms = atom->natoms;
  const size_t width = hydro.rotation() ? 6 : 3, turns = directions.on() ? width : 3;
  const Solve::Take take = [&, width](int i, const double *v, const double *F) {
    const double *fluid = hydro.ambient.velocity(i);
    double *row = output.give(i), V[6];
    width == 6 ? copy<6>(v, V) : copy<3>(v, V);
    steps.keep_in_plane(V, width);
    for (size_t d = 0; d < 3; d++) {
      atom->v[i][d] = V[d];
      row[d] = V[d] - fluid[d];
      row[3 + d] = F[d];
      row[6 + d] = width == 6 ? F[3 + d] : 0.0;
      if (width == 6) atom->omega[i][d] = V[3 + d];
    }
    if (!in_clump(hydro, i))
      std::fill_n(row + TURNED, 4, 0.0);
    else if (row[TURNED] == 0.0 && sd_dot(row + TURNED + 1, row + TURNED + 1) == 0.0)
      row[TURNED] = 1.0;
    if (!in_clump(hydro, i)) copy<3>(V, motion.give(i));
    if (width == 3) return;
    directions.look(i, V + 3);
    if (!spin.on()) return;
    double pushed[6];
    push_on(i, pushed);
    spin.look(i, V + 3, F + 3, pushed + 3);
  };
  if (scheme == MIDPOINT && noise.on())
    find_noisy_velocities(hydro, take);
  else if (scheme == MIDPOINT)
    begin_midpoint(hydro, take);
  else
    hydro.velocities(take, given());
  if (noise.on() && scheme != MIDPOINT)
    noise.draw(hydro, turns, [this, turns](int i, const double *y) {
      std::copy_n(y, turns, random.give(i));
    });
  velocity_change = change_of_velocities();
  last.step = update->ntimestep;
}

/* Force and torque on atom i, but for noise */
void FixStokesDynamicsOverdamped::load_on(int i, double *FT) const
{
  std::fill_n(FT, 6, 0.0);
  copy<3>(atom->f[i], FT);
  if (atom->torque_flag) copy<3>(atom->torque[i], FT + 3);
  torques.add(i, FT + 3);
}

/* What pushes atom i in this step: the same, extrapolated by scheme midpoint, with the torque on those
 * that slip */
void FixStokesDynamicsOverdamped::push_on(int i, double *FT) const
{
  load_on(i, FT);
  const double part = scheme == MIDPOINT ? weight(load.has(i)) : 0.0;
  for (int d = 0; d < 6 && part > 0.0; d++) FT[d] += part * (FT[d] - load[i][d]);
  if (spin.on()) spin.push(i, FT + 3);
}

/* For a solve: what pushes, but for noise, and who is held, and how */
Given FixStokesDynamicsOverdamped::given() const
{
  Given known;
  known.loads = [this](int i, double *FT) { push_on(i, FT); };
  if (any_given())
    known.held = [this](int i, double *V) { return given_velocity(i, V); };
  if (squirmers.on())
    known.swims = [this](int i, sd_squirmer_stroke &stroke) { return squirmers.stroke(i, stroke); };
  return known;
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
 * has no row of the step before */
double FixStokesDynamicsOverdamped::weight(bool has) const
{
  return scheme != EULER && has && last.dt > 0.0 ? 0.5 * update->dt / last.dt : 0.0;
}

void FixStokesDynamicsOverdamped::initial_integrate(int /*vflag*/)
{
  if (scheme != MIDPOINT) advance();
}

/* Where those of fix move go is known by now, in whatever order the two fixes stand. */
void FixStokesDynamicsOverdamped::post_integrate()
{
  if (scheme == MIDPOINT) advance();
  if (!moved_bits || !atom->omega_flag) return;
  const Hydrodynamics &hydro = hydrodynamics();
  for (int i : hydro.ambient.who()) {
    if (!is_moved(i)) continue;
    directions.turn_moved(i, atom->omega[i], update->dt);
    if (!in_clump(hydro, i)) continue;
    double w[3], R[9];
    for (int d = 0; d < 3; d++) w[d] = update->dt * atom->omega[i][d];
    sd_rotation(w, R);
    sd_turn_quaternion(R, output.give(i) + TURNED);
  }
}

bool FixStokesDynamicsOverdamped::in_clump(const Hydrodynamics &hydro, int i) const
{
  return hydro.settings.rigid.on && atom->molecule[i] != 0;
}

void FixStokesDynamicsOverdamped::advance()
{
  Hydrodynamics &hydro = hydrodynamics();
  hydro.check_prepared();
  steps.rest();
  if (scheme != MIDPOINT && !warned_growth) watch();
  if (scheme == MIDPOINT) {
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
  spin.advance();
}

/* The next step as long as the fastest sphere allows; what must be told of it, as by fix dt/reset.
 */
void FixStokesDynamicsOverdamped::end_of_step()
{
  const double dt = sd_next_step(update->dt, fastest(), adapt.tmin, adapt.tmax, adapt.xmax);
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
