#include "sd_bodies.h"

#include "sd_clump_motion.h"
#include "sd_linear.h"

#include <math.h>
#include <string.h>

/* What acts: on free spheres by rows [width n], on clumps by clump [6 clumps] about the centroid */
typedef struct {
  const double *rows;
  double *clumps;
} loads;

/* A pair (l, V) of the system, with K V by rows */
typedef struct {
  double *l, *v, *V;
} state;

/* What the loop goes by: r.z; the power l.(K V - u) of the start; and that of slips that are
 * rounding */
typedef struct {
  double rz, spent, floor;
} powers;

typedef struct {
  const sd_bodies *A;
  const double *u;
  loads F;
  /* (l, V); pre(r, 0); (p, q) */
  state x, z, along;
  double *r, *w;
  /* rows of the ghosts; of the largest clump, slip and force in the axes of the shape */
  double *ghosts, *slip, *force;
  powers power;
  sd_bodies_report *report;
} loop;

static long largest_clump(const sd_bodies *A)
{
  long m = 0;
  for (int b = 0; b < A->clumps; b++)
    if (A->first[b + 1] - A->first[b] > m) m = A->first[b + 1] - A->first[b];
  return m;
}

long sd_bodies_work(const sd_bodies *A)
{
  return (long) A->width * (6 * (long) A->n + A->ghosts) + 18 * (long) A->clumps +
      12 * largest_clump(A) + 1;
}

/* --- between a clump's axes and space --- */

static void to_shape(const double R[9], const double space[6], double shape[6])
{
  sd_multiply3t(R, space, shape);
  sd_multiply3t(R, space + 3, shape + 3);
}

static void to_space(const double R[9], const double shape[6], double space[6])
{
  sd_multiply3(R, shape, space);
  sd_multiply3(R, shape + 3, space + 3);
}

static void multiply6(const double A[36], const double x[6], double y[6])
{
  for (int p = 0; p < 6; p++) {
    y[p] = 0.0;
    for (int q = 0; q < 6; q++) y[p] += A[6 * p + q] * x[q];
  }
}

/* The row of sphere k of clump b, of whatever rank it is */
static const double *row_of(const loop *c, const double *rows, int b, int k)
{
  const int j = c->A->member[c->A->first[b] + k], n = c->A->n;
  return j < n ? rows + 6 * (long) j : c->ghosts + 6 * (long) (j - n);
}

/* out += K V, V in the axes of the shape, in the rows of this rank's spheres of clump b; those of
 * other ranks are written there, by the same arithmetic */
static void add_rigid(const sd_bodies *A, int b, const double V[6], double *out)
{
  const sd_body_shape *s = A->shape[b];
  for (int k = 0; k < s->m; k++) {
    const int j = A->member[A->first[b] + k];
    if (j >= A->n) continue;
    double v[6], space[6];
    sd_cross(V + 3, s->x + 3 * k, v);
    for (int d = 0; d < 3; d++) {
      v[d] += V[d];
      v[3 + d] = V[3 + d];
    }
    to_space(A->pose + 9 * (long) b, v, space);
    for (int d = 0; d < 6; d++) out[6 * (long) j + d] += space[d];
  }
}

static sd_status refresh(loop *c, const double *rows)
{
  const sd_bodies *A = c->A;
  return A->refresh ? A->refresh(A->refresh_ctx, rows, c->ghosts, A->width) : SD_OK;
}

/* f [6 clumps] = K^T rows */
static sd_status onto_clumps(loop *c, const double *rows, double *f)
{
  const sd_bodies *A = c->A;
  const sd_status status = refresh(c, rows);
  if (status != SD_OK) return status;
  for (int b = 0; b < A->clumps; b++) {
    const double *R = A->pose + 9 * (long) b;
    double sum[6] = {0.0};
    for (int k = 0; k < A->shape[b]->m; k++) {
      double F[6], couple[3];
      to_shape(R, row_of(c, rows, b, k), F);
      sd_cross(A->shape[b]->x + 3 * k, F, couple);
      for (int d = 0; d < 3; d++) {
        sum[d] += F[d];
        sum[3 + d] += F[3 + d] + couple[d];
      }
    }
    to_space(R, sum, f + 6 * (long) b);
  }
  return SD_OK;
}

void sd_bodies_carry(const sd_bodies *A, const double *gradient, double *u)
{
  for (int b = 0; b < A->clumps; b++) {
    double W[3], E[6], V[6];
    sd_clump_split_gradient(A->pose + 9 * (long) b, gradient + 9 * (long) b, W, E);
    multiply6(A->shape[b]->carried, E, V);
    add_rigid(A, b, V, u);
  }
}

/* out += sign K dN f, f [6 clumps] */
static void add_shells(const sd_bodies *A, const double *f, double sign, double *out)
{
  for (int b = 0; b < A->clumps; b++) {
    double load[6], V[6];
    to_shape(A->pose + 9 * (long) b, f + 6 * (long) b, load);
    multiply6(A->shape[b]->shell, load, V);
    for (int p = 0; p < 6; p++) V[p] *= sign / A->eta[b];
    add_rigid(A, b, V, out);
  }
}

sd_status sd_bodies_add_shells(const sd_bodies *A, const double *l, double *work, double *out)
{
  double *f = work;
  loop c = {.A = A, .ghosts = work + 6 * (long) A->clumps};
  const sd_status status = onto_clumps(&c, l, f);
  if (status == SD_OK) add_shells(A, f, 1.0, out);
  return status;
}

/* --- the preconditioner --- */

/* pre(r, f) of clump b; r NULL: no slip, f NULL: no load. In the axes of the shape, where all
 * matrices are constant: eta B for M_b'^-1 and eta G for M_b'^-1 K, with B and G of viscosity 1, so
 *   V = N (f - eta G^T y) / eta,   z = eta (B y + G V),   y = r
 * G^T y is K^T B y without a second product, since B is symmetric. */
static void pre_clump(loop *c, int b, const double *r, const double *f, const state *out)
{
  const sd_bodies *A = c->A;
  const sd_body_shape *s = A->shape[b];
  const double *R = A->pose + 9 * (long) b, eta = A->eta[b];
  const int N = 6 * s->m;
  double *y = c->slip, *z = c->force, load[6] = {0.0}, V[6];
  if (f) to_shape(R, f + 6 * (long) b, load);
  memset(z, 0, sizeof(double) * (size_t) N);
  if (r) {
    for (int k = 0; k < s->m; k++) to_shape(R, row_of(c, r, b, k), y + 6 * k);
    for (int i = 0; i < N; i++) {
      const double *row = s->inverse + (long) i * N, *rigid = s->rigid + 6 * (long) i;
      double sum = 0.0;
      for (int j = 0; j < N; j++) sum += row[j] * y[j];
      z[i] = sum;
      for (int p = 0; p < 6; p++) load[p] -= eta * rigid[p] * y[i];
    }
  }
  multiply6(s->mobility, load, V);
  for (int p = 0; p < 6; p++) V[p] /= eta;
  for (int i = 0; i < N; i++) {
    for (int p = 0; p < 6; p++) z[i] += s->rigid[6 * (long) i + p] * V[p];
    z[i] *= eta;
  }
  for (int k = 0; k < s->m; k++) {
    const int j = A->member[A->first[b] + k];
    if (j >= A->n) continue;
    to_space(R, z + 6 * k, out->l + 6 * (long) j);
    memset(out->v + 6 * (long) j, 0, 6 * sizeof(double));
  }
  add_rigid(A, b, V, out->v);
  to_space(R, V, out->V + 6 * (long) b);
}

/* The same of all bodies: (l, V) = out. A free sphere has l = f and V = D^-1 f - r, since z = D r
 * drops out of l. */
static sd_status pre(loop *c, const double *r, const loads *f, const state *out)
{
  const sd_bodies *A = c->A;
  for (int e = 0; e < A->lone; e++)
    for (int d = 0; d < A->width; d++) {
      const long j = (long) A->width * A->loner[e] + d;
      const double load = f ? f->rows[j] : 0.0;
      out->l[j] = load;
      out->v[j] = load / (d < 3 ? A->drag : A->spin)[A->loner[e]] - (r ? r[j] : 0.0);
    }
  if (r) {
    const sd_status status = refresh(c, r);
    if (status != SD_OK) return status;
  }
  for (int b = 0; b < A->clumps; b++) pre_clump(c, b, r, f ? f->clumps : NULL, out);
  return SD_OK;
}

/* --- the loop --- */

/* Slips of this part of the velocities are rounding, whatever the tolerance. */
static const double rounding = 1e-14;

static double drag_of(const sd_bodies *A, long i, int d)
{
  return (d < 3 ? A->drag : A->spin)[i];
}

/* a.b, the sum over all rows of all ranks */
static sd_status dot(const sd_bodies *A, const double *a, const double *b, double *sum)
{
  *sum = 0.0;
  for (long j = 0; j < (long) A->width * A->n; j++) *sum += a[j] * b[j];
  return A->sum ? A->sum(A->sum_ctx, sum, 1) : SD_OK;
}

/* Of the start x */
static sd_status find_power(loop *c)
{
  const sd_bodies *A = c->A;
  double s[2] = {0.0, 0.0};
  for (long i = 0; i < A->n; i++)
    for (int d = 0; d < A->width; d++) {
      const long j = A->width * i + d;
      const double u = c->u[j], v = c->x.v[j];
      s[0] += c->x.l[j] * (v - u);
      s[1] += drag_of(A, i, d) * (u * u + v * v);
    }
  const sd_status status = A->sum ? A->sum(A->sum_ctx, s, 2) : SD_OK;
  c->power.spent = fabs(s[0]);
  c->power.floor = rounding * rounding * s[1];
  return status;
}

/* out = (D^-1 + Omega) l */
static sd_status multiply(loop *c, const double *l, double *out)
{
  const sd_bodies *A = c->A;
  const sd_status status = A->apply(A->apply_ctx, l, out);
  c->report->products++;
  for (long i = 0; i < A->n; i++)
    for (int d = 0; d < A->width; d++)
      out[A->width * i + d] += l[A->width * i + d] / drag_of(A, i, d);
  return status;
}

/* r = K V - u - M' l of x, where K^T l = F; z = pre(r, 0) */
static sd_status residual(loop *c)
{
  const sd_bodies *A = c->A;
  sd_status status = multiply(c, c->x.l, c->r);
  if (status != SD_OK) return status;
  for (long j = 0; j < (long) A->width * A->n; j++) c->r[j] = c->x.v[j] - c->u[j] - c->r[j];
  add_shells(A, c->F.clumps, -1.0, c->r);
  status = pre(c, c->r, NULL, &c->z);
  return status == SD_OK ? dot(A, c->r, c->z.l, &c->power.rz) : status;
}

/* x = pre(-u, F) and its power */
static sd_status start_cold(loop *c)
{
  for (long j = 0; j < (long) c->A->width * c->A->n; j++) c->r[j] = -c->u[j];
  const sd_status status = pre(c, c->r, &c->F, &c->x);
  return status == SD_OK ? find_power(c) : status;
}

/* guess += what it lacks of K^T l = F, by pre(0, F - K^T l) */
static sd_status repair(loop *c, double *guess)
{
  const long size = (long) c->A->width * c->A->n;
  const loads lacks = {c->r, c->along.V};
  sd_status status = onto_clumps(c, guess, lacks.clumps);
  if (status != SD_OK) return status;
  for (int j = 0; j < 6 * c->A->clumps; j++) lacks.clumps[j] = c->F.clumps[j] - lacks.clumps[j];
  for (long j = 0; j < size; j++) c->r[j] = c->F.rows[j] - guess[j];
  status = pre(c, NULL, &lacks, &c->z);
  for (long j = 0; j < size; j++) guess[j] += c->z.l[j];
  return status;
}

/* x, r and z at the start of the loop. Warm: l is a guess, dropped when it leaves more than the
 * power itself. V needs none: pre(r, 0) finds what V lacks, whatever it is. */
static sd_status start(loop *c, int warm)
{
  const size_t bytes = sizeof(double) * (size_t) c->A->width * (size_t) c->A->n;
  double *other = c->along.l;
  sd_status status = SD_OK;
  if (warm) {
    memcpy(other, c->x.l, bytes);
    status = repair(c, other);
  }
  if (status == SD_OK) status = start_cold(c);
  if (status != SD_OK || !warm) return status == SD_OK ? residual(c) : status;
  memcpy(c->w, c->x.l, bytes);
  memcpy(c->x.l, other, bytes);
  status = residual(c);
  if (status != SD_OK || c->power.rz <= c->power.spent) return status;
  memcpy(c->x.l, c->w, bytes);
  return residual(c);
}

/* (p, q) = (z, dV) + beta (p, q): conjugate to all before, since each lies within the constraint */
static void turn_along(loop *c, double beta)
{
  for (long j = 0; j < (long) c->A->width * c->A->n; j++) {
    c->along.l[j] = c->z.l[j] + beta * c->along.l[j];
    c->along.v[j] = c->z.v[j] + beta * c->along.v[j];
  }
  for (long j = 0; j < 6 * (long) c->A->clumps; j++)
    c->along.V[j] = c->z.V[j] + beta * c->along.V[j];
}

/* From x along (p, q) to where the power is least, and z = pre(r, 0) there. K^T p = 0, so p.K q = 0
 * and the curvature is p.M p; K q stays in w all the same, where it keeps the digits of r. */
static sd_status step(loop *c)
{
  const sd_bodies *A = c->A;
  const state *x = &c->x, *along = &c->along;
  const long size = (long) A->width * A->n;
  double curvature;
  sd_status status = multiply(c, along->l, c->w);
  if (status != SD_OK) return status;
  for (long j = 0; j < size; j++) c->w[j] -= along->v[j];
  if ((status = dot(A, along->l, c->w, &curvature)) != SD_OK) return status;
  if (!isfinite(curvature)) return SD_ENOTFINITE;
  if (!(curvature > 0.0)) return SD_EINDEFINITE;
  const double alpha = c->power.rz / curvature;
  for (long j = 0; j < size; j++) {
    x->l[j] += alpha * along->l[j];
    x->v[j] += alpha * along->v[j];
    c->r[j] -= alpha * c->w[j];
  }
  for (int j = 0; j < 6 * A->clumps; j++) x->V[j] += alpha * along->V[j];
  status = pre(c, c->r, NULL, &c->z);
  return status == SD_OK ? dot(A, c->r, c->z.l, &c->power.rz) : status;
}

/* Until sqrt(r.z / spent) < tolerance. r.z is the power of what is still wrong, by the blocks of
 * the bodies: below the floor it is rounding of velocities that are the stream's own. */
static sd_status iterate(loop *c, double tolerance, int max_iter)
{
  const powers *power = &c->power;
  const size_t rows = (size_t) c->A->width * (size_t) c->A->n, motions = 6 * (size_t) c->A->clumps;
  memset(c->along.l, 0, sizeof(double) * rows);
  memset(c->along.v, 0, sizeof(double) * rows);
  memset(c->along.V, 0, sizeof(double) * motions);
  turn_along(c, 0.0);
  for (;;) {
    const double before = power->rz;
    if (!isfinite(before) || !isfinite(power->spent)) return SD_ENOTFINITE;
    if (before <= power->floor) return SD_OK;
    c->report->residual = sqrt(before / power->spent);
    if (c->report->residual < tolerance) return SD_OK;
    if (c->report->products >= max_iter) return SD_EMAXITER;
    const sd_status status = step(c);
    if (status != SD_OK) return status;
    turn_along(c, power->rz / before);
  }
}

sd_status sd_bodies_velocities(const sd_bodies *A, const sd_bodies_problem *problem,
                               const sd_bodies_motion *motion, double *work,
                               sd_bodies_report *report)
{
  const long size = (long) A->width * A->n, motions = 6 * (long) A->clumps;
  double *rows = work, *clumps = rows + 6 * size, *ghosts = clumps + 3 * motions;
  double *large = ghosts + (long) A->width * A->ghosts;
  loop c = {
      .A = A,
      .u = problem->u,
      .F = {problem->F, clumps},
      .x = {motion->l, motion->v, motion->V},
      .z = {rows, rows + size, clumps + motions},
      .along = {rows + 2 * size, rows + 3 * size, clumps + 2 * motions},
      .r = rows + 4 * size,
      .w = rows + 5 * size,
      .ghosts = ghosts,
      .slip = large,
      .force = large + 6 * largest_clump(A),
      .report = report,
  };
  *report = (sd_bodies_report){0};
  sd_status status = onto_clumps(&c, problem->F, clumps);
  if (status == SD_OK) status = start(&c, problem->warm);
  if (status == SD_OK) status = iterate(&c, problem->tolerance, problem->max_iter);
  if (status != SD_OK && status != SD_EMAXITER) return status;
  /* The last pre(r, 0) is free, and without it free spheres would have their lone velocities. */
  for (long j = 0; j < size; j++) motion->v[j] += c.z.v[j];
  for (long j = 0; j < motions; j++) motion->V[j] += c.z.V[j];
  return status;
}
