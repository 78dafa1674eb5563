#include "hydrodynamics.h"

#include "boundary_checks.h"
#include "callback.h"
#include "checks.h"
#include "keywords.h"
#include "scene_at_boundary.h"

#include "atom.h"
#include "force.h"
#include "neighbor.h"
#include "pair.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

using State = FixStokesDynamicsState;

Hydrodynamics::Hydrodynamics(LAMMPS *lmp) :
    Pointers(lmp), voice(lmp, StokesSettings::COMMAND), ambient(voice, epochs, settings.ambient),
    scene(voice, epochs, ambient, settings.scene), shells(voice, settings.shells), engine(voice, scene, shells),
    rigid(voice, scene.whole, epochs, settings.rigid), lubrication(voice, settings.lubrication, shells),
    clump_poses(lmp, scene.whole, epochs, ambient, rigid, given),
    bodies(voice, scene, engine, shells, ambient, clump_poses, lubrication),
    solver(lmp, scene, engine, bodies, shells, settings),
    random(voice, scene, engine, bodies, shells, settings), guard(voice)
{
}

Hydrodynamics *Hydrodynamics::of(LAMMPS *lmp)
{
  Pair *pair = lmp->force->pair ? lmp->force->pair_match("stokes_dynamics", 1) : nullptr;
  int dim;
  return pair ? static_cast<Hydrodynamics *>(pair->extract("hydrodynamics", dim)) : nullptr;
}

void Hydrodynamics::set(const std::vector<std::string> &words)
{
  settings = StokesSettings(lmp, words);
  if (shells.on()) check_room_of_blas(voice);
  shells.make();
  advance();
  rigid.forget();
  solver.preconditioner.forget();
}

void Hydrodynamics::init()
{
  ambient.init();
  engine.far_field.positive = 0.0;
  given.clear();    // it asks a fix that may be gone
  advance();
  prepared.set(epochs.run);
  find_boundary(voice, settings);
}

/* Other settings, or a run that LAMMPS prepares */
void Hydrodynamics::advance()
{
  for (Epoch *epoch : {&epochs.run, &epochs.lists, &epochs.groups}) epoch->advance();
}

void Hydrodynamics::check_prepared() const
{
  if (!prepared.is(epochs.run))
    voice.fail("the command has been given again since the last run, which must be prepared for: leave "
               "out 'pre no' of the run command");
}

void Hydrodynamics::begin(Moment moment)
{
  check_prepared();
  solver.guess.memory = memory = State::find(lmp);
  if (!memory)
    voice.fail("its internal fix " + std::string(State::ID) + " has been deleted; a run without "
               "'pre no' creates it again");
  epochs.step.advance();
  if (moment == STEP) {
    if (neighbor->ago == 0) epochs.lists.advance();
    if (neighbor->ago == 0 || began != update->firststep) epochs.groups.advance();
    began = update->firststep;
    ambient.select();
  }
  given.clear();
  given.velocities = !overdamped;
  const Ambient::Derivatives wanted = shells.on() ? Ambient::SECOND
      : settings.rigid.on                                  ? Ambient::FIRST
                                                           : Ambient::NO_DERIVATIVES;
  ambient.read(rotation(), wanted, memory->time(), moment == HALF_LATER ? 0.5 : 0.0);
  if (scene.settings.whole) scene.whole.find();
  if (!cleared.first_in(epochs.selection)) return;
  for (int i = 0; i < atom->nlocal; i++)
    if (!ambient.active()[i]) memory->erase(i);
}

/* The rows of this step's spheres where they stand now, and their shells with them */
void Hydrodynamics::stand()
{
  scene.stand(solved_atoms());
  rows_stand.set(epochs.step);
  if (!shells.on()) return;
  fit_shells();
  shells.free_rows(scene.size(), scene.local().a);
  bodies.orient();
}

/* Which shells the spheres have: as the run began, or the one that a restart file goes on with. */
void Hydrodynamics::fit_shells()
{
  Shells::Classes &kept = memory->global.shells;
  if (shells.classes.smallest == 0.0) shells.classes = kept;
  if (scene.largest() > 0.0 && shells.choose(scene.smallest(), scene.largest(), epochs.run))
    rigid.shapes.forget_points();
  kept = shells.classes;
}

void Hydrodynamics::look_ahead()
{
  ambient.look_ahead(memory->time());
}

void Hydrodynamics::new_run(bool as_left)
{
  if (as_left)
    rigid.set_loose(memory->global.loose);
  else
    rigid.new_run();
  rigid.set_members(memory->global.members);
  memory->global.members.clear();
}

/* Forces of rigid clumps, and the v' that they stand for. Spheres of other clumps, and lone ones,
 * are left to the solver. */
void Hydrodynamics::clumps()
{
  if (!settings.rigid.each_alone()) {
    if (settings.rigid.on) clump_poses.find();    // are they whole and rigid?
    return;
  }
  const bool wants_perturbation = reports_perturbation || settings.rigid.auto_resolve;
  const size_t m = scene.width();
  const auto take = [this, wants_perturbation, m](int i, const double *F) {
    double *row = memory->rows.writable(i), s[6];
    for (size_t d = 0; d < m; d++) row[State::at(State::FORCE, d)] = F[d];
    if (!wants_perturbation) return;
    ambient.slip(i, s);
    for (size_t d = 0; d < m; d++)
      row[State::at(State::VPRIME, d)] = F[d] / ambient.resistance(i, d) - s[d];
  };
  std::vector<char> others;
  clump_poses.find();
  clump_poses.drag(take, others);
  memory->global.loose = rigid.loose();
  left_over.clear();
  for (int i : ambient.who())
    if (others[i]) left_over.push_back(i);
  if (rigid.any_loose()) return;
  for (int i : left_over) {    // lone spheres: nobody disturbs the fluid there
    double *row = memory->rows.writable(i);
    for (size_t d = 0; d < m; d++) row[State::at(State::VPRIME, d)] = 0.0;
  }
}

/* F = 6 pi eta a (u_inf + v' - v), and likewise the torque, of all spheres but those of rigid
 * clumps; and lubrication. */
void Hydrodynamics::drag()
{
  const size_t m = scene.width();
  for (int i : solved_atoms()) {
    const double k[2] = {ambient.drag(i), ambient.spin(i)};
    double *row = memory->rows.writable(i), s[6];
    ambient.slip(i, s);
    for (size_t d = 0; d < m; d++)
      row[State::at(State::FORCE, d)] = k[d >= 3] * (s[d] + row[State::at(State::VPRIME, d)]);
  }
  if (settings.lubrication.on) lubricate();
}

/* v' of every sphere that is the solver's, from the forces that solve the system for the velocities
 * of now. Where nobody sees anybody there is nothing to solve. */
void Hydrodynamics::solve()
{
  if (settings.rigid.each_alone() && !rigid.any_loose()) return;
  place();
  bodies.place();
  sd_solve_report report = {};
  const sd_status status = engine.anybody_sees() ? find_forces(report) : SD_OK;
  account_for(status, report);
  solver.keep(Guess::FORCES);
}

void Hydrodynamics::velocities(const Solve::ToAtom &take, const Given &known, double drawn)
{
  State::Global &global = memory->global;
  sd_solve_report report = {};
  sd_status status = SD_OK;
  given = known;
  if (settings.rigid.each_alone()) {
    clump_poses.find();
    clump_poses.velocities(take);
  } else
    status = find_motions(take, drawn, report);
  if (given_rows.first_in(epochs.selection))    // those that have a row are known to have moved here
    for (int i : ambient.who()) memory->rows.writable(i);
  // v' is none of this.
  global.last_step = update->ntimestep;
  global.last_solve = -1;
  global.reported = 0;
  account_for(status, report);
}

void Hydrodynamics::look_at_wall()
{
  if (!settings.scene.boundary.walled()) return;
  const double cut = spheres_cut_by_wall(voice, scene);
  if (cut == 0.0 || !warned_cut.first_in(epochs.run)) return;
  voice.warn("keyword wall: " + text(cut) + " spheres cut the wall " +
             scene.settings.boundary.wall_names() +
             ": they move as if they touched it");
}

/* The spheres of this solve, and what may be wrong with how they stand. */
void Hydrodynamics::place()
{
  const SceneSettings &how = settings.scene;
  FarField &far_field = engine.far_field;
  far_field.set_open_box(memory->global.open_box);
  stand();
  engine.place(solver.idle());
  look_at_wall();
  memory->global.open_box = far_field.open_box();
  const bool first = looked.first_in(epochs.run);
  if (engine.view() == SD_VIEW_NEAR && first) warn_of_misfit(voice, ambient.misfit());
  if (first) check_stream_at_walls(voice, how.boundary, ambient, settings.lubrication.on);
  if (settings.lubrication.on && !shells.on() && first)
    warn_of_shared_films(voice, sum_of_all(world, (double) scene.size()));
  if (settings.lubrication.on && !settings.rigid.on && first) warn_of_one_molecule(voice, scene);
  if (how.tensor == SD_TENSOR_OSEEN) refuse_close_oseen(voice, scene, engine);
  if (first && how.clumps_only && std::isfinite(how.cutoff) && how.taper == SD_TAPER_NONE)
    warn_of_short_cutoff(voice, scene, engine);
}

Voice Hydrodynamics::where(int algorithm) const
{
  return voice.at_step().of(overdamped ? "velocities from forces"
                                       : "algorithm " + std::to_string(algorithm));
}

static std::string how_far(const sd_solve_report &report)
{
  return "residual " + text(report.residual) + " after iteration " +
      std::to_string(report.iterations);
}

/* Algorithm 1 converges for pairs and small clumps only. Where it cannot, or is too slow, 2 goes on, in
 * this solve and from now on: a run is not stranded by its default. */
sd_status Hydrodynamics::find_forces(sd_solve_report &report)
{
  const Solve::How how = {Guess::FORCES, settings.tolerance, settings.max_iter};
  if (!bodies.joined() && algorithm() == StokesSettings::SUBSTITUTION) {
    const sd_status status = solver.substitution(how, report);
    fail_if_alone(where(StokesSettings::SUBSTITUTION), status);
    const bool slow = status == SD_EMAXITER && settings.max_iter >= StokesSettings::ENOUGH_SUBSTITUTIONS;
    if ((status != SD_EDIVERGED && !slow) || settings.strict) {
      if (settings.scene.boundary.walled()) look_at_step(report, false);
      return status;
    }
    memory->global.diverged = 1;
    where(StokesSettings::SUBSTITUTION)
        .warn((slow ? "too slow: " : "diverged: ") + how_far(report) + "; the run goes on with algorithm 2 " +
              (slow ? "('algorithm 1 strict' does not)" : "('algorithm 1 strict' stops)"));
  }
  if (bodies.joined()) bodies.assemble();
  const sd_status status = bodies.joined() ? solver.run(how, report) : solver.gradients(how, report);
  fail_if_alone(where(StokesSettings::GRADIENTS), status);
  if (!shells.on() || status == SD_OK)
    look_at_step(report, bodies.joined() || solver.preconditioner.attached());
  return status;
}

/* In one loop, with lubrication in it */
sd_status Hydrodynamics::find_motions(const Solve::ToAtom &take, double drawn, sd_solve_report &report)
{
  const bool noisy = drawn > 0.0;
  assemble(noisy ? BodyScene::STANDING_FILMS : BodyScene::FILMS);
  if (noisy)
    random.push();
  else
    random.forget();
  const Guess::Question asked = noisy ? Guess::NOISY_MOTIONS : Guess::MOTIONS;
  const sd_status status =
      solver.run({asked, std::max(settings.tolerance, drawn), settings.max_iter}, report);
  clump_poses.moves(&solver.V[6 * bodies.first_clump()]);
  solver.hand_out(take);
  films_power.clear();
  if (settings.lubrication.on && status == SD_OK) {
    read_motion();
    find_films_power();
  }
  solver.keep(asked);
  return status;
}

void Hydrodynamics::look_at_step(const sd_solve_report &report, bool preconditioned)
{
  const sd_system system = solver.system();
  guard.state = memory->global.guard;
  const auto resist = [this](const double *v, double *Rv) {
    return solver.resist(v, settings.max_iter, Rv);
  };
  if (shells.on())
    guard.look_at_shells(system, resist, scene, memory->global.solves);
  else
    guard.look(system, report, scene, preconditioned, memory->global.solves);
  memory->global.guard = guard.state;
}

void Hydrodynamics::account_for(sd_status status, const sd_solve_report &report)
{
  State::Global &global = memory->global;
  global.solves++;
  global.iterations = report.iterations;
  global.residual = report.residual;
  if (status == SD_EMAXITER || status == SD_ESTAGNATED)
    unconverged(status, report);
  else if (status != SD_OK)
    failed(status, report);
}

/* An answer that may still be used, if not what was asked for. */
void Hydrodynamics::unconverged(sd_status status, const sd_solve_report &report)
{
  memory->global.unconverged++;
  if (warned_unconverged.first_in(epochs.run))
    where(algorithm())
        .warn(sd_status_string(status) + (": " + how_far(report)) + ", relative_tolerance " +
              text(settings.tolerance) +
              (status == SD_EMAXITER ? ", max_iter " + std::to_string(settings.max_iter) : "") +
              "; the run goes on, and counts further solves like this one (compute pair, fix "
              "stokes_dynamics)");
}

/* Ends the run. */
void Hydrodynamics::failed(sd_status status, const sd_solve_report &report) const
{
  const SceneSettings &how = settings.scene;
  std::string why = sd_status_string(status), numbers = how_far(report);
  if (status == SD_EDIVERGED)
    why = "diverged, the residual growing by a factor " + text(report.growth) +
        " each iteration; use algorithm 2";
  if (status == SD_EINDEFINITE) numbers += ", curvature " + text(report.curvature);
  if (how.tensor == SD_TENSOR_OSEEN && (status == SD_EINDEFINITE || status == SD_ESINGULAR))
    why += " with tensor oseen: spheres are too close for it, use tensor rpy";
  else if (status == SD_EINDEFINITE && shells.on() && shells.settings.one_body)
    why += " with the one-body addition of multiblob: use one_body no";
  else if (status == SD_ESINGULAR)
    why += ": equal spheres at one point with different velocities";
  else if (status == SD_EINDEFINITE && std::isinf(how.cutoff))
    why += " within the accuracy of the sums: use a larger relative_tolerance, or with Ewald sums "
           "a smaller far_field_tolerance";
  else if (status == SD_EINDEFINITE)
    why += " with cut_off_distance " + text(how.cutoff) +
        ", so there is no physical solution: use cut_off_distance inf, or a taper, or clumps_only yes "
        "with a cut-off larger than the clump";
  fail_by(where(algorithm()), status, why + " (" + numbers + ")");
}

double Hydrodynamics::dissipation(int i) const
{
  if (!ambient.active()[i]) return 0.0;
  const double *F = force(i), *T = torque(i);
  double s[6] = {0.0};
  ambient.slip(i, s);
  double power = F[0] * s[0] + F[1] * s[1] + F[2] * s[2];
  if (T) power += T[0] * s[3] + T[1] * s[4] + T[2] * s[5];
  return power + strain_power(i);
}

double Hydrodynamics::memory_usage() const
{
  const double films = films_v.capacity() + films_power.capacity();
  return ambient.memory_usage() + scene.memory_usage() + engine.memory_usage() + shells.memory_usage() +
      rigid.memory_usage() + lubrication.memory_usage() + clump_poses.memory_usage() +
      bodies.memory_usage() + solver.memory_usage() + random.memory_usage() + sizeof(double) * films;
}

}    // namespace StokesDyn
