/* The solves of pair_style stokes_dynamics: rigid clumps, the linear system, what became of it. */
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

#include "sd_smallest.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static const std::string COMMAND = PairStokesDynamics::COMMAND_NAME;

// Of the time-step guard: its eigenvalue is off by a few per cent and costs tens of products, so it is computed only where the limit
// is nearer than any of the free estimates was off (30 times), and again after so many solves.
static const double GUARD_ACCURACY = 0.2, GUARD_NEAR = 40.0, GUARD_PERIOD = 2000.0;
static const int GUARD_PRODUCTS = 200;

/* Forces of rigid clumps, and the v' that they stand for. Spheres of other clumps, and lone ones, are the solver's. */
void PairStokesDynamics::rigid_forces()
{
  using State = FixStokesDynamicsState;
  const int n = atom->nlocal;
  const bool rotation = scene.settings.rotation;
  const RigidClumps::Motion motion = {active,        visc.is_atom_style() ? eta.data() : nullptr,
                                      visc.number(), u_varies ? u_inf.data() : nullptr,
                                      u_uniform,     fluid_varies ? gradient.data() : nullptr};
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
  if (scene.settings.tensor == SD_TENSOR_OSEEN) refuse_close_oseen(lmp, COMMAND, scene);
  if (scene.settings.clumps_only && std::isfinite(scene.settings.cutoff) &&
      scene.settings.taper == SD_TAPER_NONE && !looked_at_clumps) {
    looked_at_clumps = true;
    warn_of_short_cutoff(lmp, COMMAND, scene, solving);
  }
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
  sd_solve_report report = {};
  sd_status status;
  if (algorithm == 1)
    status = sd_solve_substitution(&system, slip.data(), tolerance, max_iter, solution.data(),
                                   work.data(), &report);
  else {
    system.warm = warm_start && fix_state->global.solutions > 0;
    if (system.warm) guess();
    if (fix_state->restart_written) preconditioner.make_anew();
    fix_state->restart_written = false;
    preconditioner.tolerance = tolerance;
    preconditioner.warm_start = warm_start;
    preconditioner.attach(system);
    status = sd_solve_gradients(&system, slip.data(), tolerance, max_iter, solution.data(),
                                work.data(), &report);
    preconditioner.learn(report);
    fix_state->global.preconditioner = preconditioner.numbers;
    if (warm_start) remember();
    time_step_guard(system, report);
  }

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

/* The last solution, or the line through the last two. */
void PairStokesDynamics::guess()
{
  const size_t m = width();
  const bool line = fix_state->global.solutions > 1;
  for (int i = 0; i < atom->nlocal; i++) {
    const double *last = fix_state->state[i] + fix_state->history, *before = last + m;
    for (size_t d = 0; d < m; d++)
      solution[m * i + d] = !solving[i] ? 0.0 : line ? 2.0 * last[d] - before[d] : last[d];
  }
}

void PairStokesDynamics::remember()
{
  const size_t m = width();
  for (int i = 0; i < atom->nlocal; i++) {
    double *last = fix_state->state[i] + fix_state->history, *before = last + m;
    for (size_t d = 0; d < m; d++) {
      before[d] = last[d];
      last[d] = solution[m * i + d];
    }
  }
  fix_state->global.solutions = std::min(2.0, fix_state->global.solutions + 1.0);
}

/* Shortest relaxation time of a sphere that moves by itself, m/(6 pi eta a); that of its spin, 2/5 m a^2/(8 pi eta a^3), is shorter.
 * INFINITY: there is none. */
double PairStokesDynamics::relaxation_time()
{
  // Spheres in the rigid bodies of LAMMPS are not free: their bodies are heavier than that.
  std::vector<char> in_body(atom->nlocal, 0);
  for (int f = 0; f < modify->nfix; f++)
    if (utils::strmatch(modify->fix[f]->style, "^rigid")) {
      int dim;
      if (const int *body = (const int *) modify->fix[f]->extract("body", dim))
        for (int i = 0; i < atom->nlocal; i++) in_body[i] = in_body[i] || body[i] >= 0;
    }
  double shortest = INFINITY, all;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!solving[i] || in_body[i]) continue;
    const double mass = atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]];
    shortest = std::min(shortest, mass / drag[i]);
    if (scene.settings.rotation)
      shortest = std::min(shortest, 0.4 * mass * atom->radius[i] * atom->radius[i] / spin[i]);
  }
  MPI_Allreduce(&shortest, &all, 1, MPI_DOUBLE, MPI_MIN, world);
  return all;
}

/* -1/2 ... 1/2, without likeness to its neighbours' (splitmix64) */
static double scattered(uint64_t k)
{
  k *= 0x9e3779b97f4a7c15u;
  k = (k ^ (k >> 30)) * 0xbf58476d1ce4e5b9u;
  k = (k ^ (k >> 27)) * 0x94d049bb133111ebu;
  return ((k ^ (k >> 31)) >> 11) * 0x1p-53 - 0.5;
}

/* Smallest eigenvalue of the mobility scaled to unit diagonal, by a few products. It starts from numbers that depend on the sphere
 * alone, so that the ranks do not matter. */
double PairStokesDynamics::smallest_eigenvalue(const sd_system &system)
{
  const int n = atom->nlocal, m = width();
  std::vector<double> v(m * (size_t) n + 1);
  for (int i = 0; i < n; i++)
    for (int d = 0; d < m; d++) {
      v[m * (size_t) i + d] =
          scattered(8 * (uint64_t) atom->tag[i] + d) * std::sqrt(d < 3 ? drag[i] : spin[i]);
    }
  double lambda = 0.0;
  int products;
  const sd_status status = sd_smallest_eigenvalue(&system, GUARD_ACCURACY, GUARD_PRODUCTS, v.data(),
                                                  work.data(), &lambda, &products);
  return status == SD_ENOTFINITE ? 0.0 : lambda;
}

/* Explicit steps of free spheres are stable for dt < 2 m lambda_min / (6 pi eta a), with the smallest eigenvalue of the mobility scaled
 * to unit diagonal. Conjugate gradients give an estimate of it from above at no cost; it may be many times too large, as a smooth
 * right-hand side or a preconditioner hides the smallest eigenvalue from them. Where the time step comes near that limit, it is
 * computed, now and then. The smallest seen is kept. */
void PairStokesDynamics::time_step_guard(const sd_system &system, const sd_solve_report &report)
{
  FixStokesDynamicsState::Global &global = fix_state->global;
  if (report.iterations == 0) return;
  double lambda = report.curvature;
  if (!preconditioner.attached() && report.ritz_smallest > 0.0)
    lambda = std::min(lambda, report.ritz_smallest);
  const bool lower = lambda > 0.0 && (global.lambda_min == 0.0 || lambda < global.lambda_min);
  if (!lower && global.lambda_min == 0.0) return;
  if (lower) global.lambda_min = lambda;
  const bool due = global.solves >= global.guard_due;
  if (!lower && !due && global.dt_limit > 0.0) return;

  const double shortest = relaxation_time();
  const bool free = std::isfinite(shortest);
  if (free && due && GUARD_NEAR * update->dt > 2.0 * global.lambda_min * shortest) {
    lambda = smallest_eigenvalue(system);
    if (lambda > 0.0) global.lambda_min = std::min(global.lambda_min, lambda);
    global.guard_due = global.solves + GUARD_PERIOD;
  }
  global.dt_limit = free ? 2.0 * global.lambda_min * shortest : 0.0;
  if (global.dt_limit > 0.0 && update->dt > global.dt_limit && !warned_time_step) {
    warned_time_step = true;
    if (comm->me == 0)
      error->warning(FLERR,
                     std::string(COMMAND + ": the time step " + text(update->dt) + " is above " +
                                 text(global.dt_limit) +
                                 ", the limit 2 m lambda/(6 pi eta a) of explicit steps of free "
                                 "spheres under this drag (smallest m/(6 pi eta a)" +
                                 (scene.settings.rotation ? ", of spins m/(20 pi eta a), " : " ") +
                                 text(shortest) + ", lambda " + text(global.lambda_min) + ")"));
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
                        ", so any answer would be noise: use cut_off_distance inf, or a taper, or "
                        "clumps_only yes "
                        "with a cut-off larger than the clump") +
               " (" + how_far + ", curvature " + text(report.curvature) + ")");
    case SD_ESINGULAR:
      fail(lmp,
           where + sd_status_string(status) +
               (scene.settings.tensor == SD_TENSOR_OSEEN
                    ? " with tensor oseen: spheres are too close for it, use tensor rpy ("
                    : ": equal spheres at one point with different velocities (") +
               how_far + ")");
    case SD_ENOMEMORY:
    case SD_ECALLBACK:
      fail_one(lmp, where + sd_status_string(status) + " (" + how_far + ")");
    default:
      fail(lmp, where + sd_status_string(status) + " (" + how_far + ")");
  }
}
