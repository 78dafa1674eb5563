#include "time_step_guard.h"

#include "callback.h"
#include "keywords.h"
#include "scene.h"
#include "scene_at_boundary.h"

#include "atom.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

#include "sd_hash.h"
#include "sd_rate.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

// A solve costs tens of products. So it is made only where the limit may be as near as the free
// estimates were ever off (30 times), and again after so many solves. At this residual the smallest
// eigenvalue is good to a few per cent.
static const double RESIDUAL = 1e-5, NEAR = 40.0, PERIOD = 2000.0;
static const int PRODUCTS = 200, SOLVES = 12;
// Spheres in the rigid bodies of LAMMPS are not free. Their bodies weigh as much as many of them:
// nearly held, they take part in the motion of the others without a limit of their own.
static const double HEAVIER = 100.0;

std::vector<char> TimeStepGuard::held_atoms() const
{
  std::vector<char> held(atom->nlocal + 1, 0);
  for (int f = 0; f < modify->nfix; f++)
    if (utils::strmatch(modify->fix[f]->style, "^rigid")) {
      int dim;
      if (const int *body = (const int *) modify->fix[f]->extract("body", dim))
        for (int i = 0; i < atom->nlocal; i++) held[i] = held[i] || body[i] >= 0;
    }
  return held;
}

/* In the units of this LAMMPS */
std::vector<double> TimeStepGuard::inertia(const Scene &scene) const
{
  const std::vector<char> held = held_atoms();
  return scene.rows(3, [&](int i, double *out) {
    const double mass = atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]];
    out[0] = mass / force->ftm2v * (held[i] ? HEAVIER : 1.0);
    out[1] = out[0] * 0.4 * atom->radius[i] * atom->radius[i];
    out[2] = held[i];
  });
}

TimeStepGuard::Times TimeStepGuard::weigh(const sd_system &A, const Scene &scene,
                                          std::vector<double> *weight)
{
  const std::vector<double> W = inertia(scene);
  const size_t m = A.spin ? 6 : 3;
  double most[3] = {-INFINITY, -INFINITY, 0.0};    // -shortest, -of_velocity, longest
  if (weight) weight->assign(m * A.n + 1, 1.0);
  for (size_t k = 0; k < (size_t) A.n; k++) {
    if (A.drag[k] == 0.0) continue;
    const bool held = W[3 * k + 2] != 0.0;
    for (size_t d = 0; d < m; d++) {
      const double w = W[3 * k + (d < 3 ? 0 : 1)];
      const double time = w / (d < 3 ? A.drag[k] : A.spin[k]);
      if (!held) most[0] = std::max(most[0], -time);
      if (!held && d < 3) most[1] = std::max(most[1], -time);
      most[2] = std::max(most[2], time);
      if (weight) (*weight)[m * k + d] = w;
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, most, 3, MPI_DOUBLE, MPI_MAX, world);
  if (weight)
    for (double &w : *weight) w /= -most[0];
  return {-most[0], -most[1], most[2]};
}

/* z = W r */
static sd_status weighed(void *ctx, const double *r, double *z)
{
  const std::vector<double> &weight = *static_cast<std::vector<double> *>(ctx);
  for (size_t j = 0; j + 1 < weight.size(); j++) z[j] = weight[j] * r[j];
  return SD_OK;
}

/* Component d of the sphere of row k: a random number that depends on the sphere alone */
static double random_number(const Scene &scene, size_t k, size_t d)
{
  const uint64_t tag = scene.tag((int) k);
  return sd_hash_unit(sd_hash_mix((8 * tag + d) * SD_HASH_STEP)) - 0.5;
}

/* mu in units of the shortest time; INFINITY: it could not be had. Conjugate gradients that are
 * preconditioned by W have the eigenvalues of W M as their Ritz values, and a slip of random
 * numbers, with a share of every eigenvector, shows the smallest. The numbers depend on the sphere
 * alone, so that the ranks do not matter. */
double TimeStepGuard::compute(const sd_system &A, const Scene &scene)
{
  const size_t m = A.spin ? 6 : 3;
  std::vector<double> weight;
  weigh(A, scene, &weight);
  std::vector<double> slip(m * A.n + 1), F(m * A.n + 1), work(SD_SOLVE_WORK(A.n, m) + 1);
  for (size_t j = 0; j < m * A.n; j++)
    slip[j] = random_number(scene, j / m, j % m) / std::sqrt(weight[j]);
  sd_system system = A;
  system.precondition = weighed;
  system.precondition_ctx = &weight;
  system.warm = 0;
  sd_solve_report report;
  const sd_status status = sd_solve_gradients(&system, slip.data(), RESIDUAL, PRODUCTS, F.data(),
                                              work.data(), &report);
  if (status == SD_ENOMEMORY || status == SD_ECALLBACK)
    fail_by(voice.of("limit of the time step"), status);
  const bool sound = status == SD_OK || status == SD_EMAXITER || status == SD_ESTAGNATED;
  return sound && report.ritz_smallest > 0.0 ? report.ritz_smallest : INFINITY;
}

void TimeStepGuard::compare(double of_velocity)
{
  if (warned || !(state.limit > 0.0 && update->dt > state.limit)) return;
  warned = true;
  voice.warn("the time step " + text(update->dt) + " is above " + text(state.limit) +
             ", the limit 2 m lambda/(6 pi eta a) of explicit steps of free spheres under this "
             "drag (smallest m/(6 pi eta a) " + text(of_velocity) + ", lambda " +
             text(state.lambda_min) + ")");
}

/* Two bounds of mu from above cost nothing: the shortest time of a sphere alone, and that by the
 * Rayleigh quotients lambda = p.Mp / p.D^-1 p of conjugate gradients (Ritz values are such too,
 * but only without preconditioner), p.Mp / p.W^-1 p being at most lambda times the longest time.
 * Both may be many times too large, as a smooth right-hand side, a loose tolerance or a
 * preconditioner hides the smallest eigenvalue. So they are the limit only where it is far; where
 * it may be near it is computed. */
void TimeStepGuard::look(const sd_system &system, const sd_solve_report &report, const Scene &scene,
                         bool preconditioned, double solves)
{
  if (report.iterations == 0) return;
  double lambda = report.curvature;
  if (!preconditioned && report.ritz_smallest > 0.0)
    lambda = std::min(lambda, report.ritz_smallest);
  if (scene.settings.boundary.walled())
    lambda = std::min(lambda > 0.0 ? lambda : 1.0, smallest_of_all(world, least_lone_mobility(scene)));
  if (!(lambda > 0.0)) return;
  if (solves < state.due && state.limit > 0.0 && lambda >= state.lambda_min) return;
  conclude(system, scene, lambda, solves, [&] { return compute(system, scene); });
}

/* By the bounds from lambda, and mu in units of the shortest time where it may be near */
void TimeStepGuard::conclude(const sd_system &system, const Scene &scene, double lambda, double solves,
                             const std::function<double()> &compute_mu)
{
  const Times tau = weigh(system, scene, nullptr);
  if (std::isinf(tau.shortest)) {
    state.limit = 0.0;
    return;
  }
  double mu = std::min(tau.shortest, lambda * tau.longest);
  const bool computed = solves >= state.due && NEAR * update->dt > 2.0 * lambda * tau.shortest;
  if (computed) {
    mu = std::min(mu, tau.shortest * compute_mu());
    state.due = solves + PERIOD;
  }
  // one that was computed replaces the last one, a bound only a larger one
  if (computed || state.limit == 0.0 || 2.0 * mu < state.limit) state.limit = 2.0 * mu;
  state.lambda_min = 0.5 * state.limit / tau.of_velocity;
  compare(tau.of_velocity);
}

/* R v by a solve, which may end a little early */
static sd_status resisted(void *ctx, const double *v, double *Rv)
{
  const sd_status status = (*static_cast<const TimeStepGuard::Resist *>(ctx))(v, Rv);
  return status == SD_EMAXITER ? SD_OK : status;
}

/* 1/mu is the fastest rate, from random numbers. */
double TimeStepGuard::compute_of_shells(const sd_system &A, const Resist &resist, const Scene &scene)
{
  const size_t m = 6 * (size_t) A.n;
  std::vector<double> weight, v(m + 6), Rv(m + 6);
  weigh(A, scene, &weight);
  for (size_t j = 0; j < m; j++) v[j] = random_number(scene, j / 6, j % 6);
  const sd_decay decay = {(long) m, weight.data(), resisted, const_cast<Resist *>(&resist), &A.world};
  double rate;
  const sd_status status = sd_rate(&decay, SOLVES, v.data(), Rv.data(), &rate);
  if (status == SD_ENOMEMORY || status == SD_ECALLBACK)
    fail_by(voice.of("limit of the time step"), status);
  return status == SD_OK && rate > 0.0 ? 1.0 / rate : INFINITY;
}

void TimeStepGuard::look_at_shells(const sd_system &system, const Resist &resist, const Scene &scene,
                                   double solves)
{
  if (solves < state.due && state.limit > 0.0) return;
  conclude(system, scene, 1.0, solves, [&] { return compute_of_shells(system, resist, scene); });
}

/* Beside films the drag is nothing, so that the limit is 2 over their fastest rate. */
void TimeStepGuard::look_at_films(sd_lubrication &near, const Scene &scene)
{
  const std::vector<double> of_rows = inertia(scene);
  std::vector<double> W(6 * (size_t) near.n + 6), v(W.size()), work(W.size());
  for (size_t j = 0; j < 6 * (size_t) near.n; j++) {
    W[j] = of_rows[3 * (j / 6) + (j % 6 < 3 ? 0 : 1)];
    v[j] = random_number(scene, j / 6, j % 6);
  }
  double rate;
  const sd_status status = sd_lubrication_rate(&near, W.data(), v.data(), work.data(), &rate);
  if (status != SD_OK && status != SD_ENOTFINITE)
    fail_by(voice.of("limit of the time step"), status);
  if (status != SD_OK || !(rate > 0.0)) return;
  const double films = 2.0 / rate;
  if (update->setupflag)
    voice.tell("keyword lubrication: with the present gaps, explicit time steps of free spheres "
               "are stable up to " + text(films) + "; smaller gaps need shorter steps, and fix "
               "stokes_dynamics/overdamped has no such limit");
  if (warned_of_films || update->dt <= films) return;
  warned_of_films = true;
  voice.warn("keyword lubrication: the time step " + text(update->dt) + " is above " + text(films) +
             ", the limit of explicit steps of free spheres with films between them: use fix "
             "stokes_dynamics/overdamped, or a larger lubrication_gap");
}

}    // namespace StokesDyn
