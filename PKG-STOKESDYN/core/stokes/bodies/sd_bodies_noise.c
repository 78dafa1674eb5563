#include "sd_bodies_noise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_bodies_alone.h"
#include "sd_linear.h"
#include "sd_room.h"

typedef struct {
  const sd_bodies *A;
  const sd_bodies_blocks *blocks;
  int shells;
  /* [rows] P where it is diagonal, 1 where it has blocks, 0 at rows that no body has */
  double *diagonal;
  /* scratch: bodies, three times, of which the last stay 0; spheres; two bodies */
  double *bodies, *on_spheres, *own;
} draw;

/* P, its transpose, and the inverse of that */
typedef enum { HALF, HALF_BACK, HALF_INVERSE } half_of;

void sd_bodies_noise_free(sd_bodies_noise *s)
{
  sd_noise_free(&s->process);
  free(s->work);
  memset(s, 0, sizeof(*s));
}

static sd_status bodies_noise_apply(void *ctx, const double *l, double *w)
{
  const draw *d = ctx;
  const double *still = d->bodies + 12 * (long) sd_bodies_count(d->A);
  return sd_bodies_product(d->A, d->shells, l, still, d->bodies, d->on_spheres, w);
}

static const sd_body_root *noise_root_of(const sd_bodies_blocks *blocks, int b)
{
  const sd_body_root *root = blocks->body[b].shape ? blocks->root[b] : NULL;
  return root && root->n > 0 ? root : NULL;
}

/* Torques of a body in rows, or angular velocities, times a length */
static void stretch(const sd_body *b, double length, double *rows)
{
  for (int k = 0; k < b->shape->m && b->shape->width > 3; k++)
    for (int d = 3; d < 6; d++) rows[6 * (long) b->row[k] + d] *= length;
}

/* R x or R^T x of each vector of a row */
static void turn(const double R[9], int back, int width, const double *x, double *y)
{
  for (int at = 0; at < width; at += 3) (back ? sd_multiply3t : sd_multiply3)(R, x + at, y + at);
}

/* scale R B R^T of one body, B [n n] symmetric, in place */
static void noise_take_block(const sd_body *b, double scale, const double *B, double *own, double *rows)
{
  const int w = b->shape->width, n = w * b->shape->m;
  double *x = own, *y = own + n;
  for (int k = 0; k < b->shape->m; k++) turn(b->R, 1, w, rows + (long) w * b->row[k], x + w * k);
  memset(y, 0, sizeof(double) * (size_t) n);
  for (int j = 0; j < n; j++) {
    const double at = scale * x[j], *row = B + (long) j * n;
    for (int i = 0; i < n; i++) y[i] += row[i] * at;
  }
  for (int k = 0; k < b->shape->m; k++) turn(b->R, 0, w, y + w * k, rows + (long) w * b->row[k]);
}

/* P = S C^-1 sqrt(eta a), S: torques times the length, so P^T = C^-1 S and P^-T = S^-1 C */
static void noise_multiply(const draw *d, half_of which, const double *v, double *out)
{
  if (out != v) memcpy(out, v, sizeof(double) * (size_t) sd_bodies_unknowns(d->A));
  for (int b = 0; b < d->A->shaped; b++) {
    const sd_body *body = d->blocks->body + b;
    const sd_body_root *root = noise_root_of(d->blocks, b);
    if (!root) continue;
    const double scale = sqrt(body->eta * body->a);
    if (which == HALF_BACK) stretch(body, root->length, out);
    if (which == HALF_INVERSE)
      noise_take_block(body, 1.0 / scale, root->root, d->own, out);
    else
      noise_take_block(body, scale, root->inverse, d->own, out);
    if (which == HALF) stretch(body, root->length, out);
    if (which == HALF_INVERSE) stretch(body, 1.0 / root->length, out);
  }
  for (long j = 0; j < sd_bodies_unknowns(d->A); j++)
    out[j] = d->diagonal[j] > 0.0
        ? (which == HALF_INVERSE ? out[j] / d->diagonal[j] : out[j] * d->diagonal[j])
        : 0.0;
}

static sd_status half(void *ctx, const double *v, double *out)
{
  noise_multiply(ctx, HALF, v, out);
  return SD_OK;
}

static sd_status half_back(void *ctx, const double *v, double *out)
{
  noise_multiply(ctx, HALF_BACK, v, out);
  return SD_OK;
}

static sd_status half_inverse(void *ctx, const double *v, double *out)
{
  noise_multiply(ctx, HALF_INVERSE, v, out);
  return SD_OK;
}

static void fill_diagonal(const draw *d)
{
  const sd_bodies *A = d->A;
  const int w = A->points.width;
  memset(d->diagonal, 0, sizeof(double) * (size_t) sd_bodies_unknowns(A));
  for (int e = 0; e < A->lone; e++)
    for (long j = (long) w * A->loner[e]; j < (long) w * (A->loner[e] + 1); j++)
      d->diagonal[j] = sqrt(A->D[j]);
  for (int b = 0; b < A->shaped; b++) {
    const sd_body *body = A->body + b;
    for (int k = 0; k < body->shape->m; k++)
      for (long j = (long) w * body->row[k]; j < (long) w * (body->row[k] + 1); j++)
        d->diagonal[j] = noise_root_of(d->blocks, b) ? 1.0 : sqrt(A->D[j]);
  }
}

/* Numbers of the largest block, twice */
static long largest_block(const sd_bodies *A, const sd_bodies_blocks *blocks)
{
  long n = 0;
  for (int b = 0; b < A->shaped; b++)
    if (noise_root_of(blocks, b) && blocks->root[b]->n > n) n = blocks->root[b]->n;
  return 2 * n;
}

sd_status sd_bodies_draw(sd_bodies_noise *s, const sd_bodies *A, const sd_bodies_blocks *blocks,
                         const double *w, double tolerance, double *y, sd_noise_report *report)
{
  const long rows = sd_bodies_unknowns(A), motions = 6 * (long) sd_bodies_count(A);
  const long all = rows + 3 * motions + 6 * (long) A->spheres.n + largest_block(A, blocks) + 1;
  if (!sd_reserve(&s->work, sizeof(double), (size_t) all, &s->room)) return SD_ENOMEMORY;
  double *diagonal = s->work, *bodies = diagonal + rows, *on_spheres = bodies + 3 * motions;
  double *own = on_spheres + 6 * (long) A->spheres.n;
  draw d = {A, blocks, sd_bodies_shells(A), diagonal, bodies, on_spheres, own};
  memset(bodies + 2 * motions, 0, sizeof(double) * (size_t) motions);
  fill_diagonal(&d);
  const sd_noise_matrix M = {.n = rows,
                             .apply = bodies_noise_apply,
                             .ctx = &d,
                             .D = diagonal,
                             .half = half,
                             .half_back = half_back,
                             .half_inverse = half_inverse,
                             .half_ctx = &d,
                             .world = A->world};
  return sd_noise_velocities(&s->process, &M, w, tolerance, y, report);
}
