#include "sd_bodies_noise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_bodies_alone.h"
#include "sd_linear.h"
#include "sd_room.h"

typedef struct {
  const sd_bodies *A;
  const sd_body *block;
  int shells;
  /* [rows] P where it is diagonal, 1 where it has blocks, 0 at rows that no body has */
  double *diagonal;
  /* scratch: bodies, three times, of which the last stay 0; spheres; rows; two bodies */
  double *bodies, *on_spheres, *rows, *own;
} draw;

void sd_bodies_noise_free(sd_bodies_noise *s)
{
  sd_noise_free(&s->process);
  free(s->work);
  memset(s, 0, sizeof(*s));
}

static sd_status apply(void *ctx, const double *l, double *w)
{
  const draw *d = ctx;
  const double *still = d->bodies + 12 * (long) sd_bodies_count(d->A);
  return sd_bodies_product(d->A, d->shells, l, still, d->bodies, d->on_spheres, d->rows, w);
}

/* R x or R^T x of each vector of a row */
static void turn(const double R[9], int back, int width, const double *x, double *y)
{
  for (int at = 0; at < width; at += 3) (back ? sd_multiply3t : sd_multiply3)(R, x + at, y + at);
}

/* Torques of a body of m points in rows, or angular velocities, times its length */
static void stretch(const sd_body *b, double *rows)
{
  for (int k = 0; k < b->shape->m && b->shape->width > 3; k++)
    for (int d = 3; d < 6; d++) rows[6 * (long) b->row[k] + d] *= b->shape->length;
}

/* sqrt(eta a) R root R^T of one body, in place */
static void take_root(const sd_body *b, double *own, double *rows)
{
  const sd_body_shape *shape = b->shape;
  const int w = shape->width, N = w * shape->m;
  const double scale = sqrt(b->eta * b->a);
  double *x = own, *y = own + N;
  for (int k = 0; k < shape->m; k++) turn(b->R, 1, w, rows + (long) w * b->row[k], x + w * k);
  memset(y, 0, sizeof(double) * (size_t) N);
  for (int j = 0; j < N; j++)
    for (int i = 0; i < N; i++) y[i] += scale * shape->root[(long) j * N + i] * x[j];
  for (int k = 0; k < shape->m; k++) turn(b->R, 0, w, y + w * k, rows + (long) w * b->row[k]);
}

static int has_root(const sd_body *b)
{
  return b->shape && b->shape->root;
}

/* out = P v, back: P^T v */
static sd_status multiply(const draw *d, int back, const double *v, double *out)
{
  if (out != v) memcpy(out, v, sizeof(double) * (size_t) sd_bodies_rows(d->A));
  for (int b = 0; b < d->A->shaped; b++) {
    if (!has_root(d->block + b)) continue;
    if (back) stretch(d->block + b, out);
    take_root(d->block + b, d->own, out);
    if (!back) stretch(d->block + b, out);
  }
  for (long j = 0; j < sd_bodies_rows(d->A); j++) out[j] *= d->diagonal[j];
  return SD_OK;
}

static sd_status half(void *ctx, const double *v, double *out)
{
  return multiply(ctx, 0, v, out);
}

static sd_status half_back(void *ctx, const double *v, double *out)
{
  return multiply(ctx, 1, v, out);
}

static void fill_diagonal(const draw *d)
{
  const sd_bodies *A = d->A;
  const int w = A->points.width;
  memset(d->diagonal, 0, sizeof(double) * (size_t) sd_bodies_rows(A));
  for (int e = 0; e < A->lone; e++)
    for (long j = (long) w * A->loner[e]; j < (long) w * (A->loner[e] + 1); j++)
      d->diagonal[j] = sqrt(A->D[j]);
  for (int b = 0; b < A->shaped; b++) {
    const sd_body *body = A->body + b;
    for (int k = 0; k < body->shape->m; k++)
      for (long j = (long) w * body->row[k]; j < (long) w * (body->row[k] + 1); j++)
        d->diagonal[j] = has_root(d->block + b) ? 1.0 : sqrt(A->D[j]);
  }
}

/* Numbers of the largest block, twice */
static long largest_block(const sd_bodies *A, const sd_body *block)
{
  long m = 0;
  for (int b = 0; b < A->shaped; b++)
    if (has_root(block + b) && block[b].shape->m > m) m = block[b].shape->m;
  return 2 * A->points.width * m;
}

sd_status sd_bodies_draw(sd_bodies_noise *s, const sd_bodies *A, const sd_body *block,
                         const double *w, double tolerance, double *F, sd_noise_report *report)
{
  const long rows = sd_bodies_rows(A), motions = 6 * (long) sd_bodies_count(A);
  const long all = 3 * rows + 3 * motions + 6 * (long) A->spheres.n + largest_block(A, block) + 1;
  if (!sd_reserve(&s->work, sizeof(double), (size_t) all, &s->room)) return SD_ENOMEMORY;
  double *f = s->work, *diagonal = f + rows, *bodies = diagonal + rows;
  double *on_spheres = bodies + 3 * motions, *scratch = on_spheres + 6 * (long) A->spheres.n;
  draw d = {A, block, sd_bodies_shells(A), diagonal, bodies, on_spheres, scratch, scratch + rows};
  memset(bodies + 2 * motions, 0, sizeof(double) * (size_t) motions);
  fill_diagonal(&d);
  const sd_noise_matrix M = {.n = rows,
                             .apply = apply,
                             .ctx = &d,
                             .D = diagonal,
                             .half = half,
                             .half_back = half_back,
                             .half_ctx = &d,
                             .world = A->world};
  const sd_status status = sd_noise_forces(&s->process, &M, w, tolerance, f, report);
  if (status != SD_OK) return status;
  if (A->points.whole)
    sd_rigid_collect(&A->points, f, A->spheres.n, F);
  else
    memcpy(F, f, sizeof(double) * (size_t) sd_bodies_loads(A));
  return SD_OK;
}
