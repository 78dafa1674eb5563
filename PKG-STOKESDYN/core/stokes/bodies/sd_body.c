#include "sd_body.h"
#include "sd_bodies_alone.h"

#include <string.h>

#include "sd_linear.h"

/* --- K --- */

void sd_bodies_move(const sd_bodies *A, const double *V, double *on_spheres, double *rows)
{
  if (A->points.whole)
    sd_rigid_move(&A->points, sd_rigid_moved(&A->spheres, V, on_spheres), rows);
  else
    sd_rigid_move(&A->spheres, V, rows);
}

const double *sd_bodies_move_spheres(const sd_bodies *A, const double *V, double *on_spheres)
{
  return A->points.whole ? sd_rigid_moved(&A->spheres, V, on_spheres) : V;
}

int sd_bodies_next(const sd_bodies *A, const double *moved, sd_bodies_part *part)
{
  const sd_rigid *K = A->points.whole ? &A->points : &A->spheres;
  const long first = part->end / K->width;
  if (first >= K->n) return 0;
  const int many = K->n - first < SD_BODIES_PART ? (int) (K->n - first) : SD_BODIES_PART;
  const sd_rigid some = {many, K->width, K->whole ? K->whole + first : NULL, K->arm ? K->arm + 3 * first : NULL};
  part->begin = K->width * first;
  part->end = part->begin + (long) K->width * many;
  sd_rigid_move(&some, K->whole ? moved : moved + 6 * first, part->v);
  return 1;
}

void sd_bodies_collect(const sd_bodies *A, const double *rows, double *on_spheres, double *f)
{
  const int through = A->points.whole != NULL;
  if (through) sd_rigid_collect(&A->points, rows, A->spheres.n, on_spheres);
  sd_rigid_collect(&A->spheres, through ? on_spheres : rows, sd_bodies_count(A), f);
}

/* --- a body alone --- */

/* (velocity, angular velocity) of a point or body, `width` numbers, to the axes and lengths of its
 * shape: T^-1 R^T; and with `scale` 1/a instead of a likewise (force, torque): T R^T */
static void to_shape(const double R[9], int width, double scale, const double *space, double *shape)
{
  sd_multiply3t(R, space, shape);
  if (width < 6) return;
  sd_multiply3t(R, space + 3, shape + 3);
  for (int d = 3; d < 6; d++) shape[d] *= scale;
}

/* And back: scale 1/a for velocities, a for forces */
static void to_space(const double R[9], int width, double scale, const double *shape, double *space)
{
  sd_multiply3(R, shape, space);
  if (width < 6) return;
  sd_multiply3(R, shape + 3, space + 3);
  for (int d = 3; d < 6; d++) space[d] *= scale;
}

static int is_turned(const double R[9])
{
  for (int e = 0; e < 9; e++)
    if (R[e] != (e % 4 == 0)) return 1;
  return 0;
}

static void multiply6(const double A[36], double scale, const double x[6], double y[6])
{
  for (int p = 0; p < 6; p++) {
    double sum = 0.0;
    for (int q = 0; q < 6; q++) sum += A[6 * p + q] * x[q];
    y[p] = scale * sum;
  }
}

/* out = R T A T R^T x, times `factor`, for N: T on both sides; out = R T^-1 A T^-1 R^T for N^-1 */
static void turned6(const sd_body *b, const double A[36], double scale, double factor,
                    const double x[6], double out[6])
{
  double in[6], y[6];
  if (!is_turned(b->R)) {    /* lone shells, in every product of films */
    for (int d = 0; d < 6; d++) in[d] = d < 3 ? x[d] : scale * x[d];
    multiply6(A, factor, in, y);
    for (int d = 0; d < 6; d++) out[d] = d < 3 ? y[d] : scale * y[d];
    return;
  }
  to_shape(b->R, 6, scale, x, in);
  multiply6(A, factor, in, y);
  to_space(b->R, 6, scale, y, out);
}

/* f = N^-1 V */
static void body_resist(const sd_body *b, const double V[6], double f[6])
{
  turned6(b, b->shape->resistance, b->a, b->eta * b->a, V, f);
}

void sd_body_resistance_block(const sd_body *b, double B[36])
{
  const double a = b->a, s = b->eta * a, t[6] = {1.0, 1.0, 1.0, a, a, a};
  const int turned = is_turned(b->R);
  for (int e = 0; e < 36 && !turned; e++) B[e] = s * t[e / 6] * t[e % 6] * b->shape->resistance[e];
  for (int q = 0; q < 6 && turned; q++) {
    double unit[6] = {0.0}, column[6];
    unit[q] = 1.0;
    body_resist(b, unit, column);
    for (int p = 0; p < 6; p++) B[6 * p + q] = column[p];
  }
}

/* K^T M_b'^-1 y of a body, as load in its axes and lengths, times a number; every second row in sums of its own,
 * which do not wait for the others */
static void add_rigid(const sd_body_shape *s, const double *y, double times, double load[6])
{
  const long N = (long) s->width * s->m;
  double even[6] = {0.0}, odd[6] = {0.0};
  for (long i = 0; i < N; i += 2)
    for (int p = 0; p < 6; p++) even[p] += s->rigid[6 * i + p] * y[i];
  for (long i = 1; i < N; i += 2)
    for (int p = 0; p < 6; p++) odd[p] += s->rigid[6 * i + p] * y[i];
  for (int p = 0; p < 6; p++) load[p] += times * (even[p] + odd[p]);
}

/* y += K V */
static void add_body_motion(const sd_body_shape *s, const double V[6], double *y)
{
  for (int k = 0; k < s->m; k++, y += s->width) {
    double turning[3];
    sd_cross(V + 3, s->x + 3 * (long) k, turning);
    for (int d = 0; d < 3; d++) y[d] += V[d] + turning[d];
    for (int d = 3; d < s->width; d++) y[d] += V[d];
  }
}

/* Rows of a body in the axes and lengths of its shape, or back to rows: vectors are as they are where it is not
 * turned and has width 3. */
static void read_rows(const sd_body *b, const double *rows, double *y)
{
  const int w = b->shape->width, plain = w == 3 && !is_turned(b->R);
  for (int k = 0; k < b->shape->m; k++) {
    const double *row = rows + (long) w * b->row[k];
    if (plain) memcpy(y + 3 * k, row, 3 * sizeof(double));
    else to_shape(b->R, w, b->a, row, y + w * k);
  }
}

static void write_rows(const sd_body *b, const double *z, double *rows)
{
  const int w = b->shape->width, plain = w == 3 && !is_turned(b->R);
  for (int k = 0; k < b->shape->m; k++) {
    double *row = rows + (long) w * b->row[k];
    if (plain) memcpy(row, z + 3 * k, 3 * sizeof(double));
    else to_space(b->R, w, b->a, z + w * k, row);
  }
}

/* U of a body whose W is given (at = 0), or W of one whose U is (at = 3), both in motion, in the axes
 * and lengths of its shape for eta = 1 and scaled likewise: (R V)_F = load_F or (R V)_T = load_T, R =
 * N^-1 */
static void move_in_part(const sd_body_shape *s, int at, const double load[6], double motion[6])
{
  double R[9];
  for (int p = 0; p < 3; p++) {
    const double *row = s->resistance + 6 * (at + p);
    motion[at + p] = load[at + p];
    for (int q = 0; q < 3; q++) {
      R[3 * p + q] = row[at + q];
      motion[at + p] -= row[3 - at + q] * motion[3 - at + q];
    }
  }
  sd_cholesky_solve(3, R, 1, motion + at); /* a block of a matrix that has been inverted */
}

/* pre(r, f) of body b, of which bears and f [6] are. In the axes and lengths of the shape all matrices
 * are constant: with s = eta a, s B for M_b'^-1, V = N (f - K^T s B y) / s, z = s B (y + K V), y = r. What is
 * rigid in r goes before the product, and leaves no rounding there. */
static void body_respond(const sd_body *b, sd_body_known known, const sd_bodies_left *left, double *scratch, double *l,
                         double V[6])
{
  const sd_body_shape *shape = b->shape;
  const double s = b->eta * b->a;
  const int N = shape->width * shape->m;
  const double *r = left->r, *bears = left->bears, *f = left->f;
  double *y = scratch, *z = scratch + N, own[6] = {0.0}, load[6] = {0.0}, motion[6];
  for (int d = 0; d < 6; d++) own[d] = (f ? f[d] : 0.0) - (bears ? bears[d] : 0.0);
  to_shape(b->R, 6, 1.0 / b->a, own, load);
  if (r) read_rows(b, r, y);
  else memset(y, 0, sizeof(double) * (size_t) N);
  if (r && !bears) add_rigid(shape, y, -s, load);
  if (known == SD_BODY_FREE) {
    multiply6(shape->mobility, 1.0 / s, load, motion);
    to_space(b->R, 6, 1.0 / b->a, motion, V);
  } else
    to_shape(b->R, 6, b->a, V, motion);
  if (known == SD_BODY_SPUN || known == SD_BODY_PINNED) {
    const int at = known == SD_BODY_SPUN ? 0 : 3;
    for (int d = 0; d < 6; d++) load[d] /= s;
    move_in_part(shape, at, load, motion);
    sd_multiply3(b->R, motion + at, V + at);
    for (int d = at; d < 6 && at == 3; d++) V[d] /= b->a;
  }
  add_body_motion(shape, motion, y);
  sd_body_shape_answer(shape, y, z);
  for (int i = 0; i < N; i++) z[i] *= s;
  write_rows(b, z, l);
}

void sd_bodies_alone(const sd_bodies *A, const sd_bodies_left *left, double *scratch, double *l, double *V)
{
  const int w = A->points.width;
  const double *r = left->r, *bears = left->bears, *f = left->f;
  for (int e = 0; e < A->lone; e++)
    for (int d = 0; d < w; d++) {
      const long j = (long) w * A->loner[e] + d, of = 6 * (long) e + d;
      const double slip = r ? r[j] : 0.0, load = f ? f[of] : 0.0;
      const int known = sd_bodies_velocity_known(A, e, d);
      l[j] = known ? A->D[j] * (slip + V[of]) : load;
      if (!known) V[of] = load / A->D[j] - slip;
    }
  for (int b = 0; b < A->shaped; b++) {
    const long of = 6 * (long) (A->lone + b);
    const sd_bodies_left own = {r, bears ? bears + of : NULL, f ? f + of : NULL};
    body_respond(A->body + b, sd_bodies_known(A, A->lone + b), &own, scratch, l, V + of);
  }
}

void sd_bodies_alone_bear(const sd_bodies *A, const double *r, double *scratch, double *f)
{
  const int w = A->points.width;
  for (int e = 0; e < A->lone; e++)
    for (int d = 0; d < 6; d++) {
      const long j = (long) w * A->loner[e] + d;
      f[6 * (long) e + d] = d < w ? A->D[j] * r[j] : 0.0;
    }
  for (int b = 0; b < A->shaped; b++) {
    const sd_body *body = A->body + b;
    double load[6] = {0.0};
    read_rows(body, r, scratch);
    add_rigid(body->shape, scratch, body->eta * body->a, load);
    to_space(body->R, 6, body->a, load, f + 6 * (long) (A->lone + b));
  }
}

void sd_bodies_alone_resist(const sd_bodies *A, const double *V, double *f)
{
  const int w = A->points.width;
  for (int e = 0; e < A->lone; e++)
    for (int d = 0; d < 6; d++) {
      const long of = 6 * (long) e + d;
      f[of] = d < w ? A->D[(long) w * A->loner[e] + d] * V[of] : 0.0;
    }
  for (int b = 0; b < A->shaped; b++)
    body_resist(A->body + b, V + 6 * (long) (A->lone + b), f + 6 * (long) (A->lone + b));
}

void sd_bodies_alone_move(const sd_bodies *A, const double *f, double *V)
{
  const int w = A->points.width;
  for (int e = 0; e < A->lone; e++)
    for (int d = 0; d < 6; d++) {
      const long of = 6 * (long) e + d;
      V[of] = d < w ? f[of] / A->D[(long) w * A->loner[e] + d] : 0.0;
    }
  for (int b = 0; b < A->shaped; b++) {
    const sd_body *body = A->body + b;
    const long of = 6 * (long) (A->lone + b);
    turned6(body, body->shape->mobility, 1.0 / body->a, 1.0 / (body->eta * body->a), f + of, V + of);
  }
}

/* --- shells --- */

/* V -= dN f */
static void take_off_shells(const sd_bodies *A, const double *f, double *V)
{
  for (int b = 0; b < A->shaped; b++) {
    const sd_body *body = A->body + b;
    const long of = 6 * (long) (A->lone + b);
    double moves[6];
    turned6(body, body->shape->shell, 1.0 / body->a, 1.0 / (body->eta * body->a), f + of, moves);
    for (int d = 0; d < 6; d++) V[of + d] -= moves[d];
  }
}

int sd_bodies_shells(const sd_bodies *A)
{
  for (int b = 0; b < A->shaped; b++)
    for (int e = 0; e < 36; e++)
      if (A->body[b].shape->shell[e] != 0.0) return 1;
  return 0;
}

/* What the model adds for spheres whose rows begin before `end`, from sphere `first` on; returns the next one. */
static int add_spheres(const sd_bodies *A, int first, long end, const double *l, double *w)
{
  const int next = sd_rigid_whole(&A->points, (int) (end / A->points.width) - 1) + 1;
  A->add(A->add_ctx, first, next, l, w);
  return next;
}

sd_status sd_bodies_product(const sd_bodies *A, int shells, const double *l, const double *V,
                            double *bodies, double *on_spheres, double *w)
{
  const size_t motions = 6 * (size_t) sd_bodies_count(A);
  double *f = bodies, *less = f + motions;
  const sd_status status = A->apply(A->apply_ctx, l, w);
  if (status != SD_OK) return status;
  if (shells) {
    memcpy(less, V, sizeof(double) * motions);
    sd_bodies_collect(A, l, on_spheres, f);
    take_off_shells(A, f, less);
    V = less;
  }
  const double *moved = sd_bodies_move_spheres(A, V, on_spheres);
  int added = 0;
  for (sd_bodies_part part = {0}; sd_bodies_next(A, moved, &part);) {
    if (A->add) added = add_spheres(A, added, part.end, l, w);
    for (long j = part.begin; j < part.end; j++) w[j] += l[j] / A->D[j] - part.v[j - part.begin];
  }
  return SD_OK;
}

/* Both in E and in the velocities lengths are those of the shape, a times as large: (U, W) in its
 * lengths is dE E a. */
void sd_bodies_carry(const sd_bodies *A, const double *gradient, double *work, double *u)
{
  double *V = work, *on_spheres = V + 6 * (long) sd_bodies_count(A);
  double *rows = on_spheres + 6 * (long) A->spheres.n;
  memset(V, 0, sizeof(double) * 6 * (size_t) sd_bodies_count(A));
  for (int b = 0; b < A->shaped; b++) {
    const sd_body *body = A->body + b;
    double W[3], E[6], moves[6];
    sd_clump_split_gradient(body->R, gradient + 9 * (long) b, W, E);
    multiply6(body->shape->carried, body->a, E, moves);
    to_space(body->R, 6, 1.0 / body->a, moves, V + 6 * (long) (A->lone + b));
  }
  sd_bodies_move(A, V, on_spheres, rows);
  for (long j = 0; j < sd_bodies_unknowns(A); j++) u[j] += rows[j];
}
