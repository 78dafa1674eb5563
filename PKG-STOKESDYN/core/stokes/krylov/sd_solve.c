#include "sd_ritz.h"
#include "sd_system.h"

#include <math.h>
#include <string.h>

/* Two norms of a scaled residual z = D (s - M F), whose rows are forces and torques:
 *   plain     sum of D_F/D z^2, D_F the drag of the row's sphere: 1 for a force, and a torque is
 *             made a force by the length sqrt(4/3) a. The tolerance is about this one.
 *   natural   z.D^-1 z, the power that z dissipates. Conjugate gradients and the factor by which
 *             substitution converges are about this one. */
typedef struct {
  double plain, natural;
} squares;

/* Adds those of row group i, f [width], of a scaled residual; what is written is squared while it
 * is at hand, since for spheres that hardly see each other the passes over memory are the work. */
static inline void add_squares(const sd_system *A, long i, const double *f, squares *of)
{
  double natural = (f[0] * f[0] + f[1] * f[1] + f[2] * f[2]) / A->drag[i];
  if (A->spin) natural += (f[3] * f[3] + f[4] * f[4] + f[5] * f[5]) / A->spin[i];
  of->plain += A->drag[i] * natural;
  of->natural += natural;
}

static sd_status sum_squares(const sd_system *A, squares mine, squares *of)
{
  double s[2] = {mine.plain, mine.natural};
  const sd_status status = sd_system_sum(A, s, 2);
  *of = (squares){s[0], s[1]};
  return status;
}

/* F = D slip, the drag of spheres that do not see each other, and its squares */
static sd_status free_draining(const sd_system *A, const double *slip, double *F, squares *of)
{
  const int m = sd_system_width(A);
  squares mine = {0.0, 0.0};
  for (long i = 0; i < A->n; i++) {
    for (int k = 0; k < m; k++)
      F[m * i + k] = A->drag[i] == 0.0 ? 0.0 : sd_system_diagonal(A, i, k) * slip[m * i + k];
    if (A->drag[i] != 0.0) add_squares(A, i, F + m * i, &mine);
  }
  return sum_squares(A, mine, of);
}

/* out = D (slip - M F) = D (slip - Omega F) - F, given Omega F in out, and its squares */
static sd_status scaled_residual(const sd_system *A, const double *slip, const double *F,
                                 double *out, squares *of)
{
  const int m = sd_system_width(A);
  squares mine = {0.0, 0.0};
  for (long i = 0; i < A->n; i++) {
    for (int k = 0; k < m; k++) {
      const long j = m * i + k;
      out[j] = A->drag[i] == 0.0 ? 0.0
                                 : sd_system_diagonal(A, i, k) * (slip[j] - out[j]) - F[j];
    }
    if (A->drag[i] != 0.0) add_squares(A, i, out + m * i, &mine);
  }
  return sum_squares(A, mine, of);
}

/* --- algorithm 1 --- */

/* A residual that falls by less than this, relative, never gets there: the ratio of two successive
 * ones can only grow. */
static const double hardly_falls = 1e-9;
/* Residuals of this size are rounding, whatever the tolerance. */
static const double rounding_level = 1e-13;

/* F^(k+1) - F^k = D (s - Omega F^k) - F^k = D (s - M F^k): the correction is the scaled residual
 * itself, and its next value is -D Omega times this one. */
sd_status sd_solve_substitution(const sd_system *A, const double *slip, double tolerance,
                                int max_iter, double *F, double *work, sd_solve_report *report)
{
  const long size = (long) sd_system_width(A) * A->n;
  double *residual = work, last = INFINITY;
  squares rhs, now;
  *report = (sd_solve_report){0};
  sd_status status = free_draining(A, slip, F, &rhs);
  if (status != SD_OK) return status;
  if (!isfinite(rhs.plain)) return SD_ENOTFINITE;
  if (rhs.plain == 0.0) return SD_OK;

  for (int k = 0;; k++) {
    if ((status = A->apply(A->apply_ctx, F, residual)) != SD_OK) return status;
    report->products++;
    if ((status = scaled_residual(A, slip, F, residual, &now)) != SD_OK) return status;
    report->iterations = k;
    report->residual = sqrt(now.plain / rhs.plain);
    report->growth = k > 0 && last > 0.0 ? sqrt(now.natural / last) : 0.0;
    if (!isfinite(now.plain)) return SD_ENOTFINITE;
    if (report->residual <= tolerance) return SD_OK;
    if (report->growth > 1.0 - hardly_falls)
      return report->residual < rounding_level ? SD_ESTAGNATED : SD_EDIVERGED;
    if (k == max_iter) return SD_EMAXITER;
    for (long j = 0; j < size; j++) F[j] += residual[j];
    last = now.natural;
  }
}

/* --- algorithm 2 ---
 *
 * Conjugate gradients on M x = s with the preconditioner P (Golub & Van Loan, Matrix Computations).
 * Residuals are kept as forces, z = D r of r = s - M x, so that without preconditioner P r is z
 * itself. With q = M p, v = P q and u = P r, one iteration is
 *
 *   p = u + beta p,   alpha = r.p / p.q,
 *   x' = x + alpha p,   r' = r - alpha q   (z' = z - alpha D q),   u' = u - alpha v,
 *   beta' = r'.u' / r.u
 *
 * A textbook sums over the ranks twice an iteration, since r'.u' needs alpha. But r' and u' are
 * linear in alpha, and r.v = r.P q = u.q, so before the step, with t = D q and <a,b> = sum of
 * D_F/D a b,
 *
 *   r'.u'   = r.u   - 2 alpha q.u   + alpha^2 q.v
 *   <z',z'> = <z,z> - 2 alpha <z,t> + alpha^2 <t,t>
 *   <y,z'>  = <y,z> -   alpha <y,t>
 *
 * all follow from products of what is known, in one sum. They are computed anew in the next
 * iteration, so their rounding does not pile up.
 *
 * The residual of conjugate gradients goes up and down. Minimal residual smoothing (Schoenauer
 * 1987; Zhou & Walker, SIAM J. Sci. Comput. 15, 297 (1994)) keeps F with the scaled residual y
 * beside x and moves both towards it, y' = y + theta (z' - y), by the theta that makes <y',y'>
 * smallest:
 *
 *   theta = <y,y - z'> / <y - z',y - z'>,   <y - z',y - z'> = <y,y> - 2 <y,z'> + <z',z'>
 *   <y',y'> = (<y,y> <z',z'> - <y,z'>^2) / <y - z',y - z'>
 *
 * in which, unlike in <y,y> less what theta takes off, no digits are lost where z' << y. */

/* Rayleigh quotients of the mobility scaled to unit diagonal below this are rounding. */
static const double singular_below = 1e-13;
/* Slip along a singular direction, relative to all slip: below this it is rounding, and nobody has
 * asked for it. */
static const double asked_for = 1e-9;
/* Digits that may cancel before a product is computed itself. */
static const double cancelled = 1e-10;
/* Recurrences drift from the residual that they stand for by rounding, and a fresh start takes
 * that out. One that does not even halve the true residual works on its rounding, and so would all
 * others. */
static const double worth_a_restart = 0.5;

typedef struct {
  /* its preconditioner may be dropped on the way */
  sd_system A;
  const double *slip;
  double tolerance;
  int max_iter;
  /* iterate of conjugate gradients and its scaled residual; the smoothed ones, of which F is the
   * answer */
  double *x, *z, *F, *y;
  /* direction, q = M p; u = P r and v = P q, without preconditioner z itself and nothing */
  double *p, *q, *u, *v;
  /* squares of D s, and of y computed from its definition */
  squares rhs, start;
  double beta;
  /* the last direction could not be moved along, and nobody had asked for it */
  int stuck;
  sd_solve_report *report;
} gradients;

static size_t bytes(const gradients *g)
{
  return sizeof(double) * (size_t) sd_system_width(&g->A) * (size_t) g->A.n;
}

/* y and the residual reported: those of F, from the definition, by one product */
static sd_status verify(gradients *g)
{
  sd_status status = g->A.apply(g->A.apply_ctx, g->F, g->y);
  if (status != SD_OK) return status;
  g->report->products++;
  if ((status = scaled_residual(&g->A, g->slip, g->F, g->y, &g->start)) != SD_OK) return status;
  g->report->residual = sqrt(g->start.plain / g->rhs.plain);
  return SD_OK;
}

/* The first y: of the guess; or of F = 0, whose Omega F is 0, where that is nearer to the
 * answer. */
static sd_status begin(gradients *g)
{
  if (g->A.warm) {
    const sd_status status = verify(g);
    if (status != SD_OK) return status;
    if (g->report->residual <= g->tolerance || g->start.plain < g->rhs.plain) return SD_OK;
    memset(g->F, 0, bytes(g));
  }
  memset(g->y, 0, bytes(g));
  g->report->residual = 1.0;
  return scaled_residual(&g->A, g->slip, g->F, g->y, &g->start);
}

/* Conjugate gradients start where the smoothed iterate is. */
static sd_status restart(gradients *g)
{
  memcpy(g->x, g->F, bytes(g));
  memcpy(g->z, g->y, bytes(g));
  memset(g->p, 0, bytes(g));
  g->beta = 0.0;
  g->stuck = 0;
  if (!g->A.precondition) return SD_OK;
  const int m = sd_system_width(&g->A);
  for (long i = 0; i < g->A.n; i++)
    for (int k = 0; k < m; k++) {
      const long j = m * i + k;
      g->q[j] = g->A.drag[i] == 0.0 ? 0.0 : g->z[j] / sd_system_diagonal(&g->A, i, k);
    }
  return sd_system_precondition(&g->A, g->q, g->u);
}

/* P becomes D: then u = D r is z. */
static void drop_preconditioner(gradients *g)
{
  g->A.precondition = NULL;
  g->u = g->z;
}

/* The next p, q and v: one product with M, one with P. */
static sd_status next_direction(gradients *g)
{
  const long size = (long) sd_system_width(&g->A) * g->A.n;
  const double *u = g->u, beta = g->beta;
  double *p = g->p;
  for (long j = 0; j < size; j++) p[j] = u[j] + beta * p[j];
  const sd_status status = sd_system_apply(&g->A, g->p, g->q);
  if (status != SD_OK) return status;
  g->report->products++;
  return g->A.precondition ? sd_system_precondition(&g->A, g->q, g->v) : SD_OK;
}

/* r.u r.p p.q p.D^-1p q.v q.u; then those of forces, <z,z> <z,t> <t,t> <y,z> <y,t> <y,y> */
enum { RU, RP, PQ, PP, QV, QU, ZZ, ZT, TT, YZ, YT, YY, PRODUCTS };

static sd_status inner_products(const gradients *g, double s[PRODUCTS])
{
  const int m = sd_system_width(&g->A);
  const double *z = g->z, *u = g->u, *p = g->p, *q = g->q, *y = g->y;
  const double *preconditioned = g->A.precondition ? g->v : NULL;
  for (int k = 0; k < PRODUCTS; k++) s[k] = 0.0;
  for (long i = 0; i < g->A.n; i++) {
    if (g->A.drag[i] == 0.0) continue;
    for (int k = 0; k < m; k++) {
      const long j = m * i + k;
      const double D = sd_system_diagonal(&g->A, i, k), inverse = 1.0 / D;
      const double force = g->A.drag[i] * inverse, r = z[j] * inverse, t = D * q[j];
      const double v = preconditioned ? preconditioned[j] : t;
      s[RU] += r * u[j];
      s[RP] += r * p[j];
      s[PQ] += p[j] * q[j];
      s[PP] += p[j] * p[j] * inverse;
      s[QV] += q[j] * v;
      s[QU] += q[j] * u[j];
      s[ZZ] += force * z[j] * z[j];
      s[ZT] += force * z[j] * t;
      s[TT] += force * t * t;
      s[YZ] += force * y[j] * z[j];
      s[YT] += force * y[j] * t;
      s[YY] += force * y[j] * y[j];
    }
  }
  return sd_system_sum(&g->A, s, PRODUCTS);
}

/* p.q <= 0: no force along p moves anything, or M is not positive definite. Slip along p has no
 * answer then; where there is none, p is rounding that the inverse of a nearly singular matrix,
 * the preconditioner, has blown up. */
static sd_status judge_curvature(gradients *g, const double s[PRODUCTS])
{
  if (!isfinite(s[PQ]) || !isfinite(s[QV])) return SD_ENOTFINITE;
  g->report->curvature = fmin(g->report->curvature, s[PQ] / s[PP]);
  if (s[PQ] > singular_below * s[PP]) return SD_OK;
  g->stuck = 1;
  if (s[PQ] < -singular_below * s[PP]) return SD_EINDEFINITE;
  const int asked = s[RP] * s[RP] > asked_for * asked_for * s[PP] * g->rhs.natural;
  return asked ? SD_ESINGULAR : SD_OK;
}

/* x, z and u after a step of length alpha */
static void cg_step(gradients *g, double alpha)
{
  const int m = sd_system_width(&g->A);
  const double *p = g->p, *q = g->q, *v = g->v;
  double *x = g->x, *z = g->z, *u = g->u;
  for (long i = 0; i < g->A.n; i++) {
    if (g->A.drag[i] == 0.0) continue;
    for (int k = 0; k < m; k++) {
      const long j = m * i + k;
      x[j] += alpha * p[j];
      z[j] -= alpha * sd_system_diagonal(&g->A, i, k) * q[j];
      if (g->A.precondition) u[j] -= alpha * v[j];
    }
  }
}

/* Products of the residual after the step */
typedef struct {
  double ru, zz, yz;
} stepped;

/* By the recurrences; where too many digits cancel in them, from the vectors, in a second sum. */
static sd_status products_after(const gradients *g, const double s[PRODUCTS], double alpha,
                                stepped *next)
{
  next->ru = s[RU] - 2.0 * alpha * s[QU] + alpha * alpha * s[QV];
  next->zz = s[ZZ] - 2.0 * alpha * s[ZT] + alpha * alpha * s[TT];
  next->yz = s[YZ] - alpha * s[YT];
  if (!(next->ru < cancelled * s[RU]) && !(next->zz < cancelled * s[ZZ])) return SD_OK;

  const int m = sd_system_width(&g->A);
  double itself[3] = {0.0, 0.0, 0.0};
  for (long i = 0; i < g->A.n; i++) {
    if (g->A.drag[i] == 0.0) continue;
    for (int k = 0; k < m; k++) {
      const long j = m * i + k;
      const double inverse = 1.0 / sd_system_diagonal(&g->A, i, k), force = g->A.drag[i] * inverse;
      itself[0] += g->z[j] * inverse * g->u[j];
      itself[1] += force * g->z[j] * g->z[j];
      itself[2] += force * g->y[j] * g->z[j];
    }
  }
  const sd_status status = sd_system_sum(&g->A, itself, 3);
  *next = (stepped){itself[0], itself[1], itself[2]};
  return status;
}

/* F and y move towards x and z; the residual reported is the one that y then has. */
static void smooth(gradients *g, double yy, const stepped *next)
{
  const long size = (long) sd_system_width(&g->A) * g->A.n;
  const double apart = yy - 2.0 * next->yz + next->zz;
  const double theta = apart > 0.0 ? (yy - next->yz) / apart : 1.0;
  const double square = apart > 0.0 ? (yy * next->zz - next->yz * next->yz) / apart : next->zz;
  const double *x = g->x, *z = g->z;
  double *F = g->F, *y = g->y;
  for (long j = 0; j < size; j++) {
    y[j] += theta * (z[j] - y[j]);
    F[j] += theta * (x[j] - F[j]);
  }
  g->report->residual = sqrt(fmax(square, 0.0) / g->rhs.plain);
}

/* Iterations until the residual of the recurrences is below the tolerance, nothing is left of that
 * of conjugate gradients, they are stuck, or all iterations are used up. ritz: NULL, or gets the
 * steps. */
static sd_status iterate(gradients *g, sd_ritz *ritz)
{
  stepped next = {.ru = g->start.natural};
  sd_status status = restart(g);
  while (status == SD_OK && g->report->residual > g->tolerance && next.ru > 0.0 &&
         g->report->iterations < g->max_iter) {
    double s[PRODUCTS];
    if ((status = next_direction(g)) != SD_OK) return status;
    if ((status = inner_products(g, s)) != SD_OK) return status;
    if ((status = judge_curvature(g, s)) != SD_OK || g->stuck) return status;
    const double alpha = s[RP] / s[PQ];
    cg_step(g, alpha);
    if ((status = products_after(g, s, alpha, &next)) != SD_OK) return status;
    g->beta = fmax(next.ru, 0.0) / s[RU];
    if (ritz) sd_ritz_add(ritz, alpha, g->beta);
    smooth(g, s[YY], &next);
    g->report->iterations++;
  }
  return status;
}

sd_status sd_solve_gradients(const sd_system *A, const double *slip, double tolerance, int max_iter,
                             double *F, double *work, sd_solve_report *report)
{
  const long size = (long) sd_system_width(A) * A->n;
  gradients g = {.A = *A,
                 .slip = slip,
                 .tolerance = tolerance,
                 .max_iter = max_iter,
                 .F = F,
                 .x = work,
                 .z = work + size,
                 .y = work + 2 * size,
                 .p = work + 3 * size,
                 .q = work + 4 * size,
                 .u = A->precondition ? work + 5 * size : work + size,
                 .v = work + 6 * size,
                 .report = report};
  sd_ritz ritz = {.count = 0};
  double verified = INFINITY;
  *report = (sd_solve_report){.curvature = 1.0};
  if (!A->warm) memset(F, 0, bytes(&g));
  sd_status status = free_draining(A, slip, g.y, &g.rhs);
  if (status != SD_OK) return status;
  if (!isfinite(g.rhs.plain)) return SD_ENOTFINITE;
  if (g.rhs.plain == 0.0) {
    memset(F, 0, bytes(&g));
    return SD_OK;
  }
  status = begin(&g);
  if (status != SD_OK || report->residual <= tolerance) return status;

  for (int first = 1;; first = 0) {
    status = iterate(&g, first ? &ritz : NULL);
    if (status == SD_OK) status = verify(&g);
    if (status == SD_OK && !isfinite(report->residual)) status = SD_ENOTFINITE;
    if (status != SD_OK || report->residual <= tolerance) break;
    if (report->iterations >= max_iter) {
      status = SD_EMAXITER;
      break;
    }
    if (g.stuck && g.A.precondition)
      drop_preconditioner(&g);
    else if (g.stuck || report->residual > worth_a_restart * verified) {
      status = SD_ESTAGNATED;
      break;
    }
    verified = report->residual;
  }
  sd_ritz_extremes(&ritz, &report->ritz_smallest, &report->ritz_largest);
  return status;
}
