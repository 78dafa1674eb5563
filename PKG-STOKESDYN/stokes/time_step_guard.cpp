#include "time_step_guard.h"

#include "keywords.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

#include "sd_smallest.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

using namespace LAMMPS_NS;

namespace StokesDyn {

// Of the time-step guard: its eigenvalue is off by a few per cent and costs tens of products, so it is computed only where the limit
// is nearer than any of the free estimates was off (30 times), and again after so many solves.
static const double GUARD_ACCURACY = 0.2, GUARD_NEAR = 40.0, GUARD_PERIOD = 2000.0;
static const int GUARD_PRODUCTS = 200;

/* Shortest relaxation time of a sphere that moves by itself, m/(6 pi eta a); that of its spin, 2/5 m a^2/(8 pi eta a^3), is shorter.
 * INFINITY: there is none. */
double TimeStepGuard::relaxation_time(const sd_system &A, const std::vector<char> &solving) const
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
    shortest = std::min(shortest, mass / (force->ftm2v * A.drag[i]));
    if (A.spin)
      shortest = std::min(shortest, 0.4 * mass * atom->radius[i] * atom->radius[i] / (force->ftm2v * A.spin[i]));
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
double TimeStepGuard::smallest_eigenvalue(const sd_system &system) const
{
  const int n = atom->nlocal, m = system.spin ? 6 : 3;
  std::vector<double> v(m * (size_t) n + 1), work(SD_SOLVE_WORK(n, m) + 1);
  for (int i = 0; i < n; i++)
    for (int d = 0; d < m; d++) {
      v[m * (size_t) i + d] =
          scattered(8 * (uint64_t) atom->tag[i] + d) * std::sqrt(d < 3 ? system.drag[i] : system.spin[i]);
    }
  double lambda = 0.0;
  int products;
  const sd_status status = sd_smallest_eigenvalue(&system, nullptr, GUARD_ACCURACY, GUARD_PRODUCTS, v.data(),
                                                  work.data(), &lambda, &products);
  return status == SD_ENOTFINITE ? 0.0 : lambda;
}

/* Explicit steps of free spheres are stable for dt < 2 m lambda_min / (6 pi eta a), with the smallest eigenvalue of the mobility scaled
 * to unit diagonal. Conjugate gradients give an estimate of it from above at no cost; it may be many times too large, as a smooth
 * right-hand side or a preconditioner hides the smallest eigenvalue from them. Where the time step comes near that limit, it is
 * computed, now and then. The smallest seen is kept. */
void TimeStepGuard::look(const sd_system &system, const sd_solve_report &report,
                         const std::vector<char> &solving, bool preconditioned, double solves)
{
  if (report.iterations == 0) return;
  double lambda = report.curvature;
  if (!preconditioned && report.ritz_smallest > 0.0)
    lambda = std::min(lambda, report.ritz_smallest);
  const bool lower = lambda > 0.0 && (state.lambda_min == 0.0 || lambda < state.lambda_min);
  if (!lower && state.lambda_min == 0.0) return;
  if (lower) state.lambda_min = lambda;
  const bool due = solves >= state.due;
  if (!lower && !due && state.limit > 0.0) return;

  const double shortest = relaxation_time(system, solving);
  const bool free = std::isfinite(shortest);
  if (free && due && GUARD_NEAR * update->dt > 2.0 * state.lambda_min * shortest) {
    lambda = smallest_eigenvalue(system);
    if (lambda > 0.0) state.lambda_min = std::min(state.lambda_min, lambda);
    state.due = solves + GUARD_PERIOD;
  }
  state.limit = free ? 2.0 * state.lambda_min * shortest : 0.0;
  if (state.limit > 0.0 && update->dt > state.limit && !warned) {
    warned = true;
    if (comm->me == 0)
      error->warning(FLERR,
                     std::string(command + ": the time step " + text(update->dt) + " is above " +
                                 text(state.limit) +
                                 ", the limit 2 m lambda/(6 pi eta a) of explicit steps of free "
                                 "spheres under this drag (smallest m/(6 pi eta a)" +
                                 (system.spin ? ", of spins m/(20 pi eta a), " : " ") +
                                 text(shortest) + ", lambda " + text(state.lambda_min) + ")"));
  }
}

}    // namespace StokesDyn
