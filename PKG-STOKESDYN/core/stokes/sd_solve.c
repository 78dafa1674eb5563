#include "sd_solve.h"

#include <math.h>
#include <string.h>

/* Rayleigh quotients of the unit-diagonal matrix below this are rounding (its entries are at most 1). */
static const double singular_below = 1e-13;
/* Substitution whose residual falls by less than this, relative, never gets there: the ratio of two residuals can only grow. */
static const double hardly_falls = 1e-9;
/* Residuals of this size are rounding, whatever the tolerance. */
static const double rounding_level = 1e-13;
/* Slip along a singular direction, relative to all slip: below this it is rounding, and nobody has asked for it. */
static const double asked_for = 1e-9;

static sd_status sum(const sd_system *A, double *values, int count)
{
  return A->sum ? A->sum(A->sum_ctx, values, count) : SD_OK;
}

static int width(const sd_system *A)
{
  return A->spin ? 6 : 3;
}

/* v.D^-1 w of sphere i: of scaled residuals, which are forces and torques. Times D of its force: in forces alone. */
static double natural_product(const sd_system *A, int i, const double *v, const double *w)
{
  double s = (v[0] * w[0] + v[1] * w[1] + v[2] * w[2]) / A->drag[i];
  if (A->spin) s += (v[3] * w[3] + v[4] * w[4] + v[5] * w[5]) / A->spin[i];
  return s;
}

/* Row k of sphere i: its entry of D */
static double scale(const sd_system *A, int i, int k)
{
  return k < 3 ? A->drag[i] : A->spin[i];
}

/* out = D (slip - M F), given Omega F in out: D slip - F - D Omega F. Squares: plain in forces, natural over D. */
static sd_status scaled_residual(const sd_system *A, const double *slip, const double *F,
                                 double *out, double *plain, double *natural)
{
  const int m = width(A);
  double v[2] = {0.0, 0.0};
  for (int i = 0; i < A->n; i++) {
    double *o = out + (long) m * i;
    for (int k = 0; k < m; k++)
      o[k] = A->drag[i] == 0.0
          ? 0.0
          : scale(A, i, k) * (slip[(long) m * i + k] - o[k]) - F[(long) m * i + k];
    if (A->drag[i] == 0.0) continue;
    const double nat = natural_product(A, i, o, o);
    v[0] += A->drag[i] * nat;
    v[1] += nat;
  }
  const sd_status status = sum(A, v, 2);
  *plain = v[0];
  *natural = v[1];
  return status;
}

/* F = D slip, the drag of spheres that do not see each other. Squares of D slip: plain in forces, natural over D. */
static sd_status free_draining(const sd_system *A, const double *slip, double *F, double *plain,
                               double *natural)
{
  const int m = width(A);
  double v[2] = {0.0, 0.0};
  for (int i = 0; i < A->n; i++) {
    double *f = F + (long) m * i;
    for (int k = 0; k < m; k++)
      f[k] = A->drag[i] == 0.0 ? 0.0 : scale(A, i, k) * slip[(long) m * i + k];
    if (A->drag[i] == 0.0) continue;
    const double nat = natural_product(A, i, f, f);
    v[0] += A->drag[i] * nat;
    v[1] += nat;
  }
  const sd_status status = sum(A, v, 2);
  *plain = v[0];
  *natural = v[1];
  return status;
}

sd_status sd_solve_substitution(const sd_system *A, const double *slip, double tolerance,
                                int max_iter, double *F, double *work, sd_solve_report *report)
{
  double *res = work, last = INFINITY, rhs, all_slip;
  const long size = (long) width(A) * A->n;
  *report = (sd_solve_report){0};
  sd_status status = free_draining(A, slip, F, &rhs, &all_slip);
  if (status != SD_OK) return status;
  if (!isfinite(rhs)) return SD_ENOTFINITE;
  if (rhs == 0.0) return SD_OK;

  for (int k = 0;; k++) {
    double plain, natural;
    if ((status = A->apply(A->apply_ctx, F, res)) != SD_OK) return status;
    if ((status = scaled_residual(A, slip, F, res, &plain, &natural)) != SD_OK) return status;
    report->iterations = k;
    report->residual = sqrt(plain / rhs);
    report->growth = k > 0 && last > 0.0 ? sqrt(natural / last) : 0.0;
    if (!isfinite(plain)) return SD_ENOTFINITE;
    if (report->residual <= tolerance) return SD_OK;
    if (report->growth > 1.0 - hardly_falls)
      return report->residual < rounding_level ? SD_ESTAGNATED : SD_EDIVERGED;
    if (k == max_iter) return SD_EMAXITER;
    for (long j = 0; j < size; j++)
      F[j] += res[j]; /* F^(k+1) - F^k is the scaled residual itself */
    last = natural;
  }
}

/* Coefficients of the iteration, for the Ritz values. Beyond KEPT the extreme ones hardly change. */
enum { KEPT = 128 };
typedef struct {
  int count;
  double alpha[KEPT], beta[KEPT]; /* beta[k]: from direction k to k + 1 */
} coefficients;

/* How many eigenvalues of the Lanczos matrix are below value (Sturm): pivots of T - value that are negative. Its diagonal is
 * 1/alpha_k + beta_(k-1)/alpha_(k-1), beside it sqrt(beta_k)/alpha_k. */
static int below(const coefficients *c, double value)
{
  int count = 0;
  double pivot = 1.0;
  for (int k = 0; k < c->count; k++) {
    double d = 1.0 / c->alpha[k] - value;
    if (k > 0) {
      const double last = 1.0 / c->alpha[k - 1], b = c->beta[k - 1];
      d += b * last - b * last * last / pivot;
    }
    if (d == 0.0) d = -1e-300;
    count += d < 0.0;
    pivot = d;
  }
  return count;
}

/* Smallest value with more than `under` eigenvalues below it, to six digits. All lie between 0 and `highest`. */
static double bisect(const coefficients *c, int under, double highest)
{
  double low = 0.0, high = highest;
  while (high - low > 1e-6 * high && high > 1e-14 * highest) {
    const double middle = 0.5 * (low + high);
    if (below(c, middle) > under)
      high = middle;
    else
      low = middle;
  }
  return high;
}

static void ritz_values(const coefficients *c, sd_solve_report *report)
{
  double highest = 0.0;
  if (c->count == 0) return;
  for (int k = 0; k < c->count; k++) {
    double disc = 1.0 / c->alpha[k];
    if (k > 0) disc += (c->beta[k - 1] + sqrt(c->beta[k - 1])) / c->alpha[k - 1];
    if (k + 1 < c->count) disc += sqrt(c->beta[k]) / c->alpha[k];
    highest = fmax(highest, disc);
  }
  if (!isfinite(highest)) return;
  report->ritz_smallest = bisect(c, 0, highest * (1.0 + 1e-12));
  report->ritz_largest = bisect(c, c->count - 1, highest * (1.0 + 1e-12));
}

/* q += D^-1 p: the diagonal of M. Rows of spheres that take no part become 0. */
static void add_own(const sd_system *A, const double *p, double *q)
{
  const int m = width(A);
  for (int i = 0; i < A->n; i++)
    for (int k = 0; k < m; k++) {
      const long j = (long) m * i + k;
      q[j] = A->drag[i] == 0.0 ? 0.0 : q[j] + p[j] / scale(A, i, k);
    }
}

/* out = P D^-1 z for a scaled residual (force) z */
static sd_status precondition_force(const sd_system *A, const double *z, double *velocity,
                                    double *out)
{
  const int m = width(A);
  for (int i = 0; i < A->n; i++)
    for (int k = 0; k < m; k++) {
      const long j = (long) m * i + k;
      velocity[j] = A->drag[i] == 0.0 ? 0.0 : z[j] / scale(A, i, k);
    }
  return A->precondition(A->precondition_ctx, velocity, out);
}

/* Inner products of an iteration, r = D^-1 z the residual, t = D q. */
enum { RU, RP, PQ, PP, QV, QU, ZZ, ZT, TT, YZ, YT, YY, PRODUCTS };

/* natural: r.u r.p p.Mp p.D^-1p q.v q.u; in forces: z.z z.t t.t y.z y.t y.y */
static sd_status inner_products(const sd_system *A, const double *z, const double *u,
                                const double *p, const double *q, const double *v, const double *y,
                                double *s)
{
  const int m = width(A);
  for (int k = 0; k < PRODUCTS; k++) s[k] = 0.0;
  for (int i = 0; i < A->n; i++) {
    if (A->drag[i] == 0.0) continue;
    for (int k = 0; k < m; k++) {
      const long j = (long) m * i + k;
      const double D = scale(A, i, k), inverse = 1.0 / D, force = A->drag[i] * inverse;
      const double r = z[j] * inverse, t = D * q[j];
      s[RU] += r * u[j];
      s[RP] += r * p[j];
      s[PQ] += p[j] * q[j];
      s[PP] += p[j] * p[j] * inverse;
      s[QV] += q[j] * v[j];
      s[QU] += q[j] * u[j];
      s[ZZ] += force * z[j] * z[j];
      s[ZT] += force * z[j] * t;
      s[TT] += force * t * t;
      s[YZ] += force * y[j] * z[j];
      s[YT] += force * y[j] * t;
      s[YY] += force * y[j] * y[j];
    }
  }
  return sum(A, s, PRODUCTS);
}

/* r.u, z.z, y.z themselves */
static sd_status residual_products(const sd_system *A, const double *z, const double *u,
                                   const double *y, double s[3])
{
  const int m = width(A);
  s[0] = s[1] = s[2] = 0.0;
  for (int i = 0; i < A->n; i++) {
    if (A->drag[i] == 0.0) continue;
    for (int k = 0; k < m; k++) {
      const long j = (long) m * i + k;
      const double inverse = 1.0 / scale(A, i, k), force = A->drag[i] * inverse;
      s[0] += z[j] * inverse * u[j];
      s[1] += force * z[j] * z[j];
      s[2] += force * y[j] * z[j];
    }
  }
  return sum(A, s, 3);
}

/* Digits that may cancel before a product is computed itself. */
static const double cancelled = 1e-10;

sd_status sd_solve_gradients(const sd_system *A, const double *slip, double tolerance, int max_iter,
                             double *F, double *work, sd_solve_report *report)
{
  /* x, z: iterate and scaled residual D (s - M x) of conjugate gradients; F, y: the same after smoothing. u = P D^-1 z, v = P q;
   * without preconditioner u is z and v is D q, and neither is stored. */
  const int m = width(A);
  const long size = (long) m * A->n;
  const size_t bytes = sizeof(double) * (size_t) size;
  double *x = work, *z = x + size, *y = z + size, *p = y + size, *q = p + size;
  double *u = A->precondition ? q + size : z, *v = q + 2 * size;
  double plain, natural, rhs, all_slip, verified = INFINITY;
  coefficients lanczos = {.count = 0};
  int first_run = 1, singular = 0;
  sd_system unpreconditioned = *A;
  unpreconditioned.precondition = NULL;
  *report = (sd_solve_report){.curvature = 1.0};
  if (!A->warm) memset(F, 0, bytes);
  sd_status status = free_draining(A, slip, y, &rhs, &all_slip);
  if (status != SD_OK) return status;
  if (!isfinite(rhs)) return SD_ENOTFINITE;
  if (rhs == 0.0) memset(F, 0, bytes);
  if (rhs == 0.0) return SD_OK;
  if (A->warm) {
    if ((status = A->apply(A->apply_ctx, F, y)) != SD_OK) return status;
    report->products++;
    if ((status = scaled_residual(A, slip, F, y, &plain, &natural)) != SD_OK) return status;
    report->residual = sqrt(plain / rhs);
    if (report->residual <= tolerance) return SD_OK;
    if (!(plain < rhs)) memset(F, 0, bytes);
  }
  if (!A->warm || !(plain < rhs)) {
    memset(y, 0, bytes); /* Omega F for F = 0 */
    if ((status = scaled_residual(A, slip, F, y, &plain, &natural)) != SD_OK) return status;
  }

  for (;;) {
    memcpy(x, F, bytes);
    memcpy(z, y, bytes);
    memset(p, 0, bytes);
    if (A->precondition && (status = precondition_force(A, z, q, u)) != SD_OK) break;
    double beta = 0.0, remains = natural;
    report->residual = sqrt(plain / rhs);
    while (report->residual > tolerance && remains > 0.0 && report->iterations < max_iter) {
      double s[PRODUCTS];
      for (long j = 0; j < size; j++) p[j] = u[j] + beta * p[j];
      if ((status = A->apply(A->apply_ctx, p, q)) != SD_OK) break;
      report->products++;
      add_own(A, p, q);
      if (A->precondition)
        status = A->precondition(A->precondition_ctx, q, v);
      else
        for (int i = 0; i < A->n; i++)
          for (int k = 0; k < m; k++) v[(long) m * i + k] = scale(A, i, k) * q[(long) m * i + k];
      if (status != SD_OK || (status = inner_products(A, z, u, p, q, v, y, s)) != SD_OK) break;
      if (!isfinite(s[PQ]) || !isfinite(s[QV])) {
        status = SD_ENOTFINITE;
        break;
      }
      report->curvature = fmin(report->curvature, s[PQ] / s[PP]);
      if (s[PQ] <= singular_below * s[PP]) {
        /* No force along p moves anything. Slip along p has no answer; if there is none, p is rounding that the inverse of a
         * nearly singular matrix, the preconditioner, has blown up. */
        singular = 1;
        if (s[PQ] < -singular_below * s[PP])
          status = SD_EINDEFINITE;
        else if (s[RP] * s[RP] > asked_for * asked_for * s[PP] * all_slip)
          status = SD_ESINGULAR;
        break;
      }
      report->iterations++;

      const double alpha = s[RP] / s[PQ];
      for (int i = 0; i < A->n; i++) {
        if (A->drag[i] == 0.0) continue;
        for (int k = 0; k < m; k++) {
          const long j = (long) m * i + k;
          x[j] += alpha * p[j];
          z[j] -= alpha * scale(A, i, k) * q[j];
          if (A->precondition) u[j] -= alpha * v[j];
        }
      }
      double next = s[RU] - 2.0 * alpha * s[QU] + alpha * alpha * s[QV];
      double zz = s[ZZ] - 2.0 * alpha * s[ZT] + alpha * alpha * s[TT];
      double yz = s[YZ] - alpha * s[YT];
      if (next < cancelled * s[RU] || zz < cancelled * s[ZZ]) {
        double itself[3];
        if ((status = residual_products(A, z, u, y, itself)) != SD_OK) break;
        next = itself[0];
        zz = itself[1];
        yz = itself[2];
      }
      beta = fmax(next, 0.0) / s[RU];
      remains = next;
      if (first_run && lanczos.count < KEPT) {
        lanczos.alpha[lanczos.count] = alpha;
        lanczos.beta[lanczos.count++] = beta;
      }

      const double ee = s[YY] - 2.0 * yz + zz; /* |y - z|^2 */
      const double theta = ee > 0.0 ? (s[YY] - yz) / ee : 1.0;
      /* |y + theta (z - y)|^2, without loss when z << y */
      plain = ee > 0.0 ? (s[YY] * zz - yz * yz) / ee : zz;
      for (long j = 0; j < size; j++) {
        y[j] += theta * (z[j] - y[j]);
        F[j] += theta * (x[j] - F[j]);
      }
      report->residual = sqrt(fmax(plain, 0.0) / rhs);
    }
    first_run = 0;
    if (status != SD_OK) break;
    if ((status = A->apply(A->apply_ctx, F, y)) != SD_OK) break;
    report->products++;
    if ((status = scaled_residual(A, slip, F, y, &plain, &natural)) != SD_OK) break;
    report->residual = sqrt(plain / rhs);
    if (!isfinite(plain))
      status = SD_ENOTFINITE;
    else if (report->residual <= tolerance)
      break;
    else if (report->iterations >= max_iter)
      status = SD_EMAXITER;
    else if (singular && A->precondition) {
      A = &unpreconditioned;
      u = z;
      singular = 0;
    } else if (singular || report->residual > 0.5 * verified)
      status = SD_ESTAGNATED;
    if (status != SD_OK) break;
    verified = report->residual;
  }
  ritz_values(&lanczos, report);
  return status;
}
