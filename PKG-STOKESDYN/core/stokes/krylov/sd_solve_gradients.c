/* Algorithm 2 of sd_solve.h
 *
 * The loop of sd_cg.h on M x = s. Its residual goes up and down. Minimal residual smoothing
 * (Schoenauer 1987; Zhou & Walker, SIAM J. Sci. Comput. 15, 297 (1994)) keeps F with the scaled
 * residual y beside x and z = D r, and moves both towards them, y' = y + theta (z - y), by the theta
 * that makes <y',y'> smallest, <a,b> = sum of D_F/D a b:
 *
 *   theta = <y,y - z> / <y - z,y - z>,   <y - z,y - z> = <y,y> - 2 <y,z> + <z,z>
 *   <y',y'> = (<y,y> <z,z> - <y,z>^2) / <y - z,y - z>
 *
 * in which, unlike in <y,y> less what theta takes off, no digits are lost where z << y. */
#include "sd_cg.h"
#include "sd_linear.h"
#include "sd_solve_internal.h"

#include <math.h>
#include <string.h>

/* Slip along a singular direction, relative to all slip: below this it is rounding, and nobody has
 * asked for it. */
static const double asked_for = 1e-9;
/* Recurrences drift from the residual that they stand for by rounding, and a fresh start takes
 * that out. One that does not even halve the true residual works on its rounding, and so would all
 * others. */
static const double worth_a_restart = 0.5;

/* Step lengths alpha_k and beta_k, from direction k to k + 1, of the first iterations. Beyond KEPT of
 * them the extreme Ritz values hardly change. */
enum { KEPT = 128 };
typedef struct {
  int count;
  double alpha[KEPT], beta[KEPT];
} steps;

/* Conjugate gradients are Lanczos's process on the same vectors: the matrix, seen from the span of
 * the first residuals normalised, is tridiagonal (Golub & Van Loan, Matrix Computations),
 *
 *   T_kk = 1/alpha_k + beta_(k-1)/alpha_(k-1),   T_k,k+1 = sqrt(beta_k)/alpha_k
 *
 * and its eigenvalues are the Ritz values. All are positive: 1e-14 of the largest is rounding. */
static void find_ritz_values(const steps *s, sd_solve_report *report)
{
  const int n = s->count;
  double d[KEPT], e[KEPT];
  for (int k = 0; k < n; k++) {
    d[k] = 1.0 / s->alpha[k] + (k > 0 ? s->beta[k - 1] / s->alpha[k - 1] : 0.0);
    e[k] = sqrt(s->beta[k]) / s->alpha[k];
  }
  if (n == 0 || sd_tridiagonal_eigen(n, d, e, NULL, NULL) != SD_OK) return;
  report->ritz_smallest = fmax(d[0], 1e-14 * d[n - 1]);
  report->ritz_largest = d[n - 1];
}

typedef struct {
  /* its preconditioner may be dropped on the way */
  sd_system A;
  const double *slip;
  double tolerance;
  int max_iter;
  sd_cg_vectors v;
  /* the smoothed iterate, which is the answer, and its scaled residual */
  double *F, *y;
  /* squares of D s, and of y computed from its definition */
  sd_solve_squares rhs, start;
  /* iterations before this run of the loop; the last direction could not be moved along, and nobody
   * had asked for it */
  int before, stuck;
  /* of the first run of the loop; NULL later */
  steps *steps;
  sd_solve_report *report;
} gradients;

static long solve_size_of(const gradients *g)
{
  return (long) sd_solve_width(&g->A) * g->A.n;
}

/* w = M p = Omega p + D^-1 p; 0 in the rows of spheres that take no part */
static sd_status solve_apply(void *ctx, const double *p, double *w)
{
  gradients *g = ctx;
  const int m = sd_solve_width(&g->A);
  g->report->products++;
  const sd_status status = g->A.apply(g->A.apply_ctx, p, w);
  for (long i = 0; i < g->A.n && status == SD_OK; i++)
    for (int k = 0; k < m; k++) {
      const long j = m * i + k;
      w[j] = g->A.drag[i] == 0.0 ? 0.0 : w[j] + p[j] / sd_solve_diagonal(&g->A, i, k);
    }
  return status;
}

/* z = P r; without preconditioner P is D. */
static sd_status solve_precondition(void *ctx, const double *r, double *z)
{
  const sd_system *A = &((gradients *) ctx)->A;
  if (A->precondition) return A->precondition(A->precondition_ctx, r, z);
  const int m = sd_solve_width(A);
  for (long i = 0; i < A->n; i++)
    for (int k = 0; k < m; k++) z[m * i + k] = sd_solve_diagonal(A, i, k) * r[m * i + k];
  return SD_OK;
}

/* p.D^-1 p: p.w / p.p is then a Rayleigh quotient of the mobility scaled to unit diagonal */
static double solve_square(void *ctx, const double *p)
{
  const sd_system *A = &((gradients *) ctx)->A;
  const int m = sd_solve_width(A);
  double sum = 0.0;
  for (long i = 0; i < A->n; i++)
    for (int k = 0; k < m && A->drag[i] != 0.0; k++)
      sum += p[m * i + k] * p[m * i + k] / sd_solve_diagonal(A, i, k);
  return sum;
}

enum { ZZ, YZ, YY };

static void solve_measure(void *ctx, const sd_cg_vectors *v, double own[SD_CG_OWN])
{
  const gradients *g = ctx;
  const int m = sd_solve_width(&g->A);
  for (long i = 0; i < g->A.n; i++)
    for (int k = 0; k < m && g->A.drag[i] != 0.0; k++) {
      const long j = m * i + k;
      const double D = sd_solve_diagonal(&g->A, i, k), force = g->A.drag[i] / D, y = g->y[j];
      own[ZZ] += force * D * v->r[j] * D * v->r[j];
      own[YZ] += force * y * D * v->r[j];
      own[YY] += force * y * y;
    }
}

/* F and y move towards x and D r; the residual reported is the one that y then has. */
static void smooth(gradients *g, const double own[SD_CG_OWN])
{
  const int m = sd_solve_width(&g->A);
  const double yy = own[YY], yz = own[YZ], zz = own[ZZ], apart = yy - 2.0 * yz + zz;
  const double theta = apart > 0.0 ? (yy - yz) / apart : 1.0;
  const double of_y = apart > 0.0 ? (yy * zz - yz * yz) / apart : zz;
  for (long i = 0; i < g->A.n; i++)
    for (int k = 0; k < m && g->A.drag[i] != 0.0; k++) {
      const long j = m * i + k;
      g->y[j] += theta * (sd_solve_diagonal(&g->A, i, k) * g->v.r[j] - g->y[j]);
      g->F[j] += theta * (g->v.x[j] - g->F[j]);
    }
  g->report->residual = sqrt(fmax(of_y, 0.0) / g->rhs.plain);
}

static sd_status solve_judge(void *ctx, const sd_cg_state *now, int *done)
{
  gradients *g = ctx;
  sd_solve_report *report = g->report;
  if (now->steps > 0) {
    report->curvature = fmin(report->curvature, now->pw / now->pp);
    if (g->steps && g->steps->count < KEPT) {
      g->steps->alpha[g->steps->count] = now->alpha;
      g->steps->beta[g->steps->count++] = fmax(now->beta, 0.0);
    }
    smooth(g, now->own);
    report->iterations = g->before + now->steps;
  }
  *done = report->residual <= g->tolerance || !(now->rz > 0.0) || report->iterations >= g->max_iter;
  return SD_OK;
}

/* y and the residual reported: those of F, from the definition, by one product */
static sd_status verify(gradients *g)
{
  sd_status status = g->A.apply(g->A.apply_ctx, g->F, g->y);
  if (status != SD_OK) return status;
  g->report->products++;
  if ((status = sd_solve_residual(&g->A, g->slip, g->F, g->y, &g->start)) != SD_OK) return status;
  g->report->residual = sqrt(g->start.plain / g->rhs.plain);
  return SD_OK;
}

/* The first y: of the guess; or of F = 0, whose Omega F is 0, where that is nearer to the
 * answer. */
static sd_status solve_begin(gradients *g)
{
  const size_t bytes = sizeof(double) * (size_t) solve_size_of(g);
  if (g->A.warm) {
    const sd_status status = verify(g);
    if (status != SD_OK) return status;
    if (g->report->residual <= g->tolerance || g->start.plain < g->rhs.plain) return SD_OK;
    memset(g->F, 0, bytes);
  }
  memset(g->y, 0, bytes);
  g->report->residual = 1.0;
  return sd_solve_residual(&g->A, g->slip, g->F, g->y, &g->start);
}

/* The loop from where the smoothed iterate is, until the residual of the recurrences is below the
 * tolerance, nothing is left of that of conjugate gradients, they are stuck, or all iterations are
 * used up. No force along p moves anything: slip along p has no answer then; where there is none, p
 * is rounding that the inverse of a nearly singular matrix, the preconditioner, has blown up. */
static sd_status solve_iterate(gradients *g)
{
  const int m = sd_solve_width(&g->A);
  const sd_cg cg = {.size = solve_size_of(g),
                    .paired = solve_size_of(g),
                    .ctx = g,
                    .apply = solve_apply,
                    .precondition = solve_precondition,
                    .measure = solve_measure,
                    .judge = solve_judge,
                    .square = solve_square,
                    .world = &g->A.world};
  sd_cg_state state;
  memcpy(g->v.x, g->F, sizeof(double) * (size_t) solve_size_of(g));
  for (long i = 0; i < g->A.n; i++)
    for (int k = 0; k < m; k++) {
      const long j = m * i + k;
      g->v.r[j] = g->A.drag[i] == 0.0 ? 0.0 : g->y[j] / sd_solve_diagonal(&g->A, i, k);
    }
  g->before = g->report->iterations;
  g->stuck = 0;
  const sd_status status = sd_cg_run(&cg, &g->v, &state);
  if (status != SD_EINDEFINITE && status != SD_ESINGULAR) return status;
  g->report->curvature = fmin(g->report->curvature, state.pw / state.pp);
  g->stuck = 1;
  if (status == SD_EINDEFINITE) return status;
  const int asked = state.rp * state.rp > asked_for * asked_for * state.pp * g->rhs.natural;
  return asked ? SD_ESINGULAR : SD_OK;
}

/* Until the residual by its definition is small, or there is no hope of it */
static sd_status repeat(gradients *g)
{
  sd_solve_report *report = g->report;
  double verified = INFINITY;
  for (;; g->steps = NULL) {
    sd_status status = solve_iterate(g);
    if (status == SD_OK) status = verify(g);
    if (status == SD_OK && !isfinite(report->residual)) status = SD_ENOTFINITE;
    if (status != SD_OK || report->residual <= g->tolerance) return status;
    if (report->iterations >= g->max_iter) return SD_EMAXITER;
    if (g->stuck && g->A.precondition)
      g->A.precondition = NULL;
    else if (g->stuck || report->residual > worth_a_restart * verified)
      return SD_ESTAGNATED;
    verified = report->residual;
  }
}

sd_status sd_solve_gradients(const sd_system *A, const double *slip, double tolerance, int max_iter,
                             double *F, double *work, sd_solve_report *report)
{
  const long size = (long) sd_solve_width(A) * A->n;
  const size_t bytes = sizeof(double) * (size_t) size;
  steps first = {.count = 0};
  gradients g = {.A = *A,
                 .slip = slip,
                 .tolerance = tolerance,
                 .max_iter = max_iter,
                 .v = {work, work + size, work + 2 * size, work + 3 * size, work + 4 * size},
                 .F = F,
                 .y = work + 5 * size,
                 .steps = &first,
                 .report = report};
  *report = (sd_solve_report){.curvature = 1.0};
  if (!A->warm) memset(F, 0, bytes);
  sd_status status = sd_solve_free_draining(A, slip, g.y, &g.rhs);
  if (status != SD_OK) return status;
  if (!isfinite(g.rhs.plain)) return SD_ENOTFINITE;
  if (g.rhs.plain == 0.0) {
    memset(F, 0, bytes);
    return SD_OK;
  }
  status = solve_begin(&g);
  if (status != SD_OK || report->residual <= tolerance) return status;
  status = repeat(&g);
  find_ritz_values(&first, report);
  return status;
}
