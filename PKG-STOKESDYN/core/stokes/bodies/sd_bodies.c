#include "sd_bodies.h"
#include "sd_tie.h"

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

/* What the loop goes by: r.z, and what of it is rounding; the power spent as it stands now; what
 * the bodies would spend alone, and the power of slips that are rounding */
typedef struct {
  double rz, noise, spent, alone, floor;
} powers;

typedef struct {
  const sd_bodies *A;
  /* of the problem, by rows; and what is to be borne, with L V_inf */
  const double *u, *given;
  loads F;
  /* (l, V); pre(r, 0); (p, q) */
  state x, z, along;
  double *r, *w;
  /* rows of the ghosts; of the largest clump, slip and force in the axes of the shape */
  double *ghosts, *slip, *force;
  /* velocities without and with the tie and what is borne, by bodies; its share, by rows */
  double *tied, tie_tolerance;
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
  const long tied = A->tie ? 18 * ((long) A->lone + A->clumps) + 12 * (long) A->n : 0;
  return (long) A->width * (6 * (long) A->n + A->ghosts) + 18 * (long) A->clumps +
      12 * largest_clump(A) + tied + 1;
}

/* --- the preconditioner --- */

/* pre(r, f) of clump b; r NULL: no slip, f [6] NULL: no load. In the axes of the shape, where all
 * matrices are constant: eta B for M_b'^-1 and eta G for M_b'^-1 K, with B and G of viscosity 1, so
 *   V = N (f - eta G^T y) / eta,   z = eta (B y + G V),   y = r
 * G^T y is K^T B y without a second product, since B is symmetric. V is returned; z is added to the
 * rows of l. */
static void respond(loop *c, int b, const double *r, const double *f, double *l, double V[6])
{
  const sd_bodies *A = c->A;
  const sd_body_shape *s = A->shape[b];
  const double *R = A->pose + 9 * (long) b, eta = A->eta[b];
  const int N = 6 * s->m;
  double *y = c->slip, *z = c->force, load[6] = {0.0};
  if (f) sd_bodies_to_shape(R, f, load);
  memset(z, 0, sizeof(double) * (size_t) N);
  if (r) {
    for (int k = 0; k < s->m; k++)
      sd_bodies_to_shape(R, sd_bodies_row(A, r, c->ghosts, b, k), y + 6 * k);
    for (int i = 0; i < N; i++) {
      const double *row = s->inverse + (long) i * N, *rigid = s->rigid + 6 * (long) i;
      double sum = 0.0;
      for (int j = 0; j < N; j++) sum += row[j] * y[j];
      z[i] = sum;
      for (int p = 0; p < 6; p++) load[p] -= eta * rigid[p] * y[i];
    }
  }
  sd_bodies_multiply6(s->mobility, load, V);
  for (int p = 0; p < 6; p++) V[p] /= eta;
  for (int i = 0; i < N; i++) {
    for (int p = 0; p < 6; p++) z[i] += s->rigid[6 * (long) i + p] * V[p];
    z[i] *= eta;
  }
  for (int k = 0; k < s->m; k++) {
    const int j = A->member[A->first[b] + k];
    if (j >= A->n) continue;
    double space[6];
    sd_bodies_to_space(R, z + 6 * k, space);
    for (int d = 0; d < 6; d++) l[6 * (long) j + d] += space[d];
  }
}

/* V of clump b, in the axes of its shape */
static void set_motion(const sd_bodies *A, int b, const double V[6], const state *out)
{
  sd_bodies_clear(A, b, out->v);
  sd_bodies_add_rigid(A, b, V, out->v);
  sd_bodies_to_space(A->pose + 9 * (long) b, V, out->V + 6 * (long) b);
}

/* The same of all bodies, each for itself: (l, V) = out. A free sphere has l = f and V = D^-1 f -
 * r, since z = D r drops out of l. */
static sd_status pre_alone(loop *c, const double *r, const loads *f, const state *out)
{
  const sd_bodies *A = c->A;
  for (int e = 0; e < A->lone; e++)
    for (int d = 0; d < A->width; d++) {
      const long j = (long) A->width * A->loner[e] + d;
      const double load = f ? f->rows[j] : 0.0;
      out->l[j] = load;
      out->v[j] = load / sd_bodies_drag(A, A->loner[e], d) - (r ? r[j] : 0.0);
    }
  if (r) {
    const sd_status status = sd_bodies_refresh(A, r, c->ghosts);
    if (status != SD_OK) return status;
  }
  for (int b = 0; b < A->clumps; b++) {
    double V[6];
    sd_bodies_clear(A, b, out->l);
    respond(c, b, r, f ? f->clumps + 6 * (long) b : NULL, out->l, V);
    set_motion(A, b, V, out);
  }
  return SD_OK;
}

/* Bodies for themselves would have V_0; tied they have V. By the second line they bear L V less,
 * whatever digits V has, of which X (r + K V) is with the spheres that feel it. */
static sd_status tie_together(loop *c, const double *r, const state *out)
{
  const sd_bodies *A = c->A;
  const long size = 6 * ((long) A->lone + A->clumps), clumps = 6 * (long) A->lone;
  double *V_0 = c->tied, *V = V_0 + size, *borne = V + size, *share = borne + size;
  for (int e = 0; e < A->lone; e++)
    memcpy(V_0 + 6 * (long) e, out->v + 6 * (long) A->loner[e], 6 * sizeof(double));
  memcpy(V_0 + clumps, out->V, sizeof(double) * 6 * (size_t) A->clumps);
  const sd_status status = sd_tie_solve(A, V_0, r, c->tie_tolerance, V, borne, share);
  if (status != SD_OK) return status;
  for (int e = 0; e < A->lone; e++)
    for (int d = 0; d < 6; d++) {
      out->l[6 * (long) A->loner[e] + d] -= borne[6 * (long) e + d];
      out->v[6 * (long) A->loner[e] + d] = V[6 * (long) e + d];
    }
  for (int b = 0; b < A->clumps; b++) {
    const long at = clumps + 6 * (long) b;
    double less[6], moves[6];
    for (int d = 0; d < 6; d++) less[d] = -borne[at + d];
    respond(c, b, NULL, less, out->l, moves);
    sd_bodies_to_shape(A->pose + 9 * (long) b, V + at, moves);
    set_motion(A, b, moves, out);
  }
  for (long j = 0; j < 6 * (long) A->n; j++) out->l[j] += share[j];
  return SD_OK;
}

static sd_status pre(loop *c, const double *r, const loads *f, const state *out)
{
  const sd_status status = pre_alone(c, r, f, out);
  return status == SD_OK && c->A->tie ? tie_together(c, r, out) : status;
}

/* --- the loop --- */

/* Slips of this part of the velocities are rounding, whatever the tolerance. */
static const double rounding = 1e-14;
/* How well the sparse system in the preconditioner is solved: what is left, of what there was. What
 * the first direction lacks must be made up by directions of its own, but what later ones lack is
 * as small as they are. So it is the first of these parts of sqrt(spent), at most the second of
 * what there is. That takes at most one product in ten more than exact solutions, to 1e-8 as well,
 * and half to three quarters of the products with L that 0.01 all the way takes.
 * Source: van den Eshof & Sleijpen, SIAM J. Matrix Anal. Appl. 26, 125 (2004). */
static const double tie_accuracy = 0.003, tie_loosest = 0.2;
/* And that of a guess, whose error the loop takes up */
static const double tie_guess = 0.3;

/* a.b, the sum over all rows of all ranks */
static sd_status dot(const sd_bodies *A, const double *a, const double *b, double *sum)
{
  *sum = 0.0;
  for (long j = 0; j < (long) A->width * A->n; j++) *sum += a[j] * b[j];
  return A->sum ? A->sum(A->sum_ctx, sum, 1) : SD_OK;
}

/* For pre(r, 0) where r.z is about so much */
static double tie_tolerance(const loop *c, double power)
{
  const double part = tie_accuracy * sqrt(c->power.spent / power);
  return fmax(tie_accuracy, fmin(tie_loosest, part));
}

/* r.z and its noise: z is what pre leaves of r, whose rigid part it cancels. The power spent. Also,
 * with w, w.z. */
static sd_status weigh(loop *c, const double *w, double *wz)
{
  const sd_bodies *A = c->A;
  const state *x = &c->x, *z = &c->z;
  double s[5] = {0.0};
  for (long i = 0; i < A->n; i++)
    for (int d = 0; d < A->width; d++) {
      const long j = A->width * i + d;
      s[0] += c->r[j] * z->l[j];
      s[1] += sd_bodies_drag(A, i, d) * c->r[j] * c->r[j];
      s[2] += x->l[j] * (x->v[j] - c->u[j]);
      s[3] += c->given[j] * (x->v[j] + z->v[j] - c->u[j]);
      if (w) s[4] += w[j] * z->l[j];
    }
  const sd_status status = A->sum ? A->sum(A->sum_ctx, s, 5) : SD_OK;
  c->power.rz = s[0];
  c->power.noise = rounding * s[1];
  c->power.spent = fmax(fabs(s[2]), s[3]);
  if (w) *wz = s[4];
  return status;
}

/* out = L (v - V_inf) */
static sd_status resist(loop *c, const double *v, double *out)
{
  const sd_lubrication *L = c->A->tie->L;
  const sd_status status = sd_lubrication_apply(c->A->tie->L, v, out);
  for (long j = 0; j < (long) c->A->width * c->A->n; j++) out[j] -= L->carried[j];
  return status;
}

/* out = (D^-1 + Omega) l; of shells all but what K^T l = F gives once for all, which without a tie
 * is all that they give */
static sd_status multiply(loop *c, const double *l, double *out)
{
  const sd_bodies *A = c->A;
  sd_status status = A->apply(A->apply_ctx, l, out);
  c->report->products++;
  for (long i = 0; i < A->n; i++)
    for (int d = 0; d < A->width; d++)
      out[A->width * i + d] += l[A->width * i + d] / sd_bodies_drag(A, i, d);
  if (!A->tie || status != SD_OK) return status;
  status = sd_bodies_onto_clumps(A, l, c->ghosts, c->tied);
  if (status == SD_OK) sd_bodies_shells(A, c->tied, 1.0, out);
  return status;
}

/* The accuracy of the first pre(r, 0): r.z is at most r.D r */
static sd_status expect(loop *c)
{
  const sd_bodies *A = c->A;
  double s[2] = {0.0, 0.0};
  if (!A->tie) return SD_OK;
  for (long i = 0; i < A->n; i++)
    for (int d = 0; d < A->width; d++) {
      const long j = A->width * i + d;
      s[0] += sd_bodies_drag(A, i, d) * c->r[j] * c->r[j];
      s[1] += c->given[j] * (c->x.v[j] - c->u[j]);
    }
  const sd_status status = A->sum ? A->sum(A->sum_ctx, s, 2) : SD_OK;
  c->power.spent = fmax(c->power.alone, s[1]);
  c->tie_tolerance = tie_tolerance(c, s[0]);
  return status;
}

/* r = K V - u - M' l of x, which obeys the second line; z = pre(r, 0) */
static sd_status residual(loop *c)
{
  const sd_bodies *A = c->A;
  sd_status status = multiply(c, c->x.l, c->r);
  if (status != SD_OK) return status;
  for (long j = 0; j < (long) A->width * A->n; j++) c->r[j] = c->x.v[j] - c->u[j] - c->r[j];
  if (!A->tie) sd_bodies_shells(A, c->F.clumps, -1.0, c->r);
  if ((status = expect(c)) == SD_OK) status = pre(c, c->r, NULL, &c->z);
  return status == SD_OK ? weigh(c, NULL, NULL) : status;
}

/* x = pre(-u, F) of bodies for themselves, and their power */
static sd_status start_alone(loop *c)
{
  const sd_bodies *A = c->A;
  double s[2] = {0.0, 0.0};
  for (long j = 0; j < (long) A->width * A->n; j++) c->r[j] = -c->u[j];
  sd_status status = pre_alone(c, c->r, &c->F, &c->x);
  for (long i = 0; i < A->n; i++)
    for (int d = 0; d < A->width; d++) {
      const long j = A->width * i + d;
      const double u = c->u[j], v = c->x.v[j];
      s[0] += c->x.l[j] * (v - u);
      s[1] += sd_bodies_drag(A, i, d) * (u * u + v * v);
    }
  if (status == SD_OK && A->sum) status = A->sum(A->sum_ctx, s, 2);
  c->power.alone = fabs(s[0]);
  c->power.floor = rounding * rounding * s[1];
  return status;
}

/* From x = pre(-u, F) */
static sd_status start_cold(loop *c)
{
  sd_status status = start_alone(c);
  c->tie_tolerance = tie_accuracy;
  if (status == SD_OK && c->A->tie) status = tie_together(c, c->r, &c->x);
  return status == SD_OK ? residual(c) : status;
}

/* guess += what it lacks of the second line, by pre(0, F - K^T (l + L K V)) */
static sd_status repair(loop *c, const state *guess)
{
  const sd_bodies *A = c->A;
  const long size = (long) A->width * A->n;
  const loads lacks = {c->r, c->w};
  sd_status status = SD_OK;
  if (A->tie) status = sd_lubrication_apply(A->tie->L, guess->v, c->r);
  for (long j = 0; j < size; j++) c->r[j] = guess->l[j] + (A->tie ? c->r[j] : 0.0);
  if (status == SD_OK) status = sd_bodies_onto_clumps(A, c->r, c->ghosts, lacks.clumps);
  if (status != SD_OK) return status;
  c->tie_tolerance = tie_guess;
  for (int j = 0; j < 6 * A->clumps; j++) lacks.clumps[j] = c->F.clumps[j] - lacks.clumps[j];
  for (long j = 0; j < size; j++) c->r[j] = c->F.rows[j] - c->r[j];
  status = pre(c, NULL, &lacks, &c->z);
  for (long j = 0; j < size; j++) guess->l[j] += c->z.l[j];
  for (long j = 0; A->tie && j < size; j++) guess->v[j] += c->z.v[j];
  for (int j = 0; A->tie && j < 6 * A->clumps; j++) guess->V[j] += c->z.V[j];
  return status;
}

/* The motion that a guess goes with, by rows and by clumps: that of each clump's first sphere. */
static sd_status guess_motion(loop *c, const double *before, const state *guess)
{
  const sd_bodies *A = c->A;
  memcpy(guess->v, before, sizeof(double) * 6 * (size_t) A->n);
  const sd_status status = sd_bodies_refresh(A, before, c->ghosts);
  for (int b = 0; b < A->clumps && status == SD_OK; b++) {
    double V[6], turning[3];
    sd_bodies_to_shape(A->pose + 9 * (long) b, sd_bodies_row(A, before, c->ghosts, b, 0), V);
    sd_cross(V + 3, A->shape[b]->x, turning);
    for (int d = 0; d < 3; d++) V[d] -= turning[d];
    set_motion(A, b, V, guess);
  }
  return status;
}

/* V takes what it lacks. */
static void take_motion(loop *c)
{
  for (long j = 0; j < (long) c->A->width * c->A->n; j++) c->x.v[j] += c->z.v[j];
  for (long j = 0; j < 6 * (long) c->A->clumps; j++) c->x.V[j] += c->z.V[j];
}

/* V takes what it lacks at once, and r loses it: for a guess so good that r is K times what
 * neighbours add to V, and r.z close to its noise. Not with a tie, where l goes with V. */
static sd_status settle(loop *c)
{
  take_motion(c);
  for (long j = 0; j < (long) c->A->width * c->A->n; j++) c->r[j] += c->z.v[j];
  const sd_status status = pre(c, c->r, NULL, &c->z);
  return status == SD_OK ? weigh(c, NULL, NULL) : status;
}

/* x, r and z at the start of the loop. Warm: l is a guess, with a tie (l, V), dropped when it
 * leaves more than bodies would spend alone. */
static sd_status start(loop *c, const double *before, int warm)
{
  const size_t bytes = sizeof(double) * (size_t) c->A->width * (size_t) c->A->n;
  const state *guess = &c->along;
  if (!warm) return start_cold(c);
  memcpy(guess->l, c->x.l, bytes);
  sd_status status = c->A->tie ? guess_motion(c, before, guess) : SD_OK;
  if (status == SD_OK) status = repair(c, guess);
  if (status == SD_OK) status = start_alone(c);
  memcpy(c->x.l, guess->l, bytes);
  if (c->A->tie) {
    memcpy(c->x.v, guess->v, bytes);
    memcpy(c->x.V, guess->V, sizeof(double) * 6 * (size_t) c->A->clumps);
  }
  if (status == SD_OK) status = residual(c);
  if (status == SD_OK && !c->A->tie && c->power.rz < 1e4 * c->power.noise) status = settle(c);
  return status == SD_OK && c->power.rz > c->power.alone ? start_cold(c) : status;
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

/* From x along (p, q) to where the power is least, and z = pre(r, 0) there. Without a tie K^T p =
 * 0, so p.K q = 0 and the curvature is p.M p, with one -p.K q is q.L q; K q stays in w all the
 * same, where it keeps the digits of r. */
static sd_status step(loop *c, double *beta)
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
  c->tie_tolerance = tie_tolerance(c, c->power.rz);
  status = pre(c, c->r, NULL, &c->z);
  if (status != SD_OK) return status;
  double wz = 0.0;
  status = weigh(c, c->w, &wz);
  *beta = -wz / curvature;
  return status;
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
  for (double beta = 0.0;;) {
    const double before = power->rz;
    if (!isfinite(before + power->spent)) return SD_ENOTFINITE;
    if (before < -fmax(power->floor, power->noise)) return SD_EINDEFINITE;
    c->report->residual = power->spent > 0.0 ? sqrt(fmax(before, 0.0) / power->spent) : 0.0;
    if (before <= power->floor) return SD_OK;
    if (c->report->residual < tolerance) return SD_OK;
    if (c->report->products >= max_iter) return SD_EMAXITER;
    turn_along(c, beta);
    const sd_status status = step(c, &beta);
    if (status != SD_OK) return status;
  }
}

/* K^T l + K^T L K V = F + K^T L V_inf */
static sd_status take_loads(loop *c, const double *F, double *rows, double *clumps)
{
  const sd_bodies *A = c->A;
  for (long j = 0; A->tie && j < (long) A->width * A->n; j++)
    rows[j] = F[j] + A->tie->L->carried[j];
  c->F = (loads){A->tie ? rows : F, clumps};
  return sd_bodies_onto_clumps(A, c->F.rows, c->ghosts, clumps);
}

/* The last pre(r, 0) is free, and without it free spheres would have their lone velocities. */
static sd_status finish(loop *c, const sd_bodies_motion *motion)
{
  const sd_bodies *A = c->A;
  const long size = (long) A->width * A->n;
  if (A->tie) memcpy(motion->before, motion->v, sizeof(double) * (size_t) size);
  take_motion(c);
  if (!A->tie) return SD_OK;
  const sd_status status = resist(c, motion->v, motion->near);
  for (long j = 0; j < size; j++) motion->near[j] += c->z.l[j];
  return status;
}

sd_status sd_bodies_velocities(const sd_bodies *A, const sd_bodies_problem *problem,
                               const sd_bodies_motion *motion, double *work,
                               sd_bodies_report *report)
{
  const long size = (long) A->width * A->n, motions = 6 * (long) A->clumps;
  double *rows = work, *clumps = rows + 6 * size, *ghosts = clumps + 3 * motions;
  double *large = ghosts + (long) A->width * A->ghosts, *tied = large + 12 * largest_clump(A);
  loop c = {
      .A = A,
      .u = problem->u,
      .given = problem->F,
      .x = {motion->l, motion->v, motion->V},
      .z = {rows, rows + size, clumps + motions},
      .along = {rows + 2 * size, rows + 3 * size, clumps + 2 * motions},
      .r = rows + 4 * size,
      .w = rows + 5 * size,
      .ghosts = ghosts,
      .slip = large,
      .force = large + 6 * largest_clump(A),
      .tied = tied,
      .report = report,
  };
  *report = (sd_bodies_report){0};
  sd_status status = A->tie ? sd_tie_make(A) : SD_OK;
  if (status == SD_OK)
    status = take_loads(&c, problem->F, tied + 18 * ((long) A->lone + A->clumps) + size, clumps);
  if (status == SD_OK) status = start(&c, motion->before, problem->warm);
  if (status == SD_OK) status = iterate(&c, problem->tolerance, problem->max_iter);
  if (status != SD_OK && status != SD_EMAXITER) return status;
  const sd_status last = finish(&c, motion);
  return last == SD_OK ? status : last;
}
