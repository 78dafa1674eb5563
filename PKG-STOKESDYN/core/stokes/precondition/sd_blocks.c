#include "sd_blocks.h"

#include <stdlib.h>
#include <string.h>

#include "sd_linear.h"
#include "sd_unit.h"

static const double UNITY[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

/* Of its size: a clump that has changed more gets a new block. A small one is cheaper to factor
 * than to keep, and gets one for more than rounding: what is kept is not in restart files, so a run
 * that goes on from one would differ from the run unbroken. */
static const double BENT = 0.02, ROUNDING = 1e-9;
enum { SMALL = 64 };

void sd_blocks_free(sd_blocks *b)
{
  for (int k = 0; k < b->blocks && b->shape; k++) sd_shape_free(&b->shape[k]);
  free(b->shape);
  sd_sparse_free(&b->far);
  free(b->first);
  free(b->member);
  free(b->lone);
  free(b->start);
  free(b->inverse);
  free(b->turn);
  free(b->root);
  free(b->rigid);
  free(b->mobility);
  free(b->scratch);
  memset(b, 0, sizeof(*b));
}

/* Who is in which block: those that take part. Blocks have (width m)^2 numbers, one after the
 * other. Returns the spheres of the largest one. */
static long fill_blocks(sd_blocks *b, const sd_precondition_case *c)
{
  long count = 0, largest = 0;
  for (long i = 0; i < b->n; i++) b->lone[i] = c->spheres.a[i] > 0.0;
  b->start[0] = 0;
  for (int k = 0; k < b->blocks; k++) {
    b->first[k] = count;
    for (long l = c->first[k]; l < c->first[k + 1]; l++) {
      const int i = c->member[l];
      if (!b->lone[i]) continue;
      b->member[count++] = i;
      b->lone[i] = 0;
    }
    const long m = count - b->first[k], size = b->width * m;
    if (m > largest) largest = m;
    b->start[k + 1] = b->start[k] + size * size;
  }
  b->first[b->blocks] = count;
  return largest;
}

/* Two steps: what is known from the number of clumps, then what follows from who is in them. */
static sd_status allocate(sd_blocks *b, const sd_precondition_case *c)
{
  const size_t blocks = (size_t) c->clumps, n = (size_t) c->n;
  b->n = c->n;
  b->width = c->width;
  b->part = c->part;
  b->parts = c->parts;
  b->blocks = c->clumps;
  b->first = malloc(sizeof(long) * (blocks + 1));
  b->start = malloc(sizeof(long) * (blocks + 1));
  b->member = malloc(sizeof(int) * ((size_t) c->first[blocks] + 1));
  b->lone = malloc(n + 1);
  b->turn = calloc(blocks + 1, sizeof(double) * 9);
  b->mobility = calloc(blocks + 1, sizeof(double) * 9);
  b->root = malloc(sizeof(double) * (2 * n + 1));
  if (c->rho > 0.0) b->shape = calloc(blocks + 1, sizeof(sd_shape));
  if (!b->first || !b->start || !b->member || !b->lone || !b->turn || !b->mobility || !b->root ||
      (c->rho > 0.0 && !b->shape))
    return SD_ENOMEMORY;
  const long largest = fill_blocks(b, c);
  b->inverse = malloc(sizeof(double) * (size_t) (b->start[blocks] + 1));
  b->rigid = calloc((size_t) (3 * b->width * b->first[blocks] + 1), sizeof(double));
  b->scratch = malloc(sizeof(double) * (2 * (size_t) (b->width * largest) + 9 * blocks + 1));
  return b->inverse && b->rigid && b->scratch ? SD_OK : SD_ENOMEMORY;
}

/* Root of the diagonal in row p of a sphere */
static double root(const sd_blocks *b, int sphere, int p)
{
  return b->root[2 * (long) sphere + (p >= 3)];
}

/* Inverse of a symmetric positive definite 3x3 matrix: its cofactors over its determinant. */
static void inverse3(const double *S, double *T)
{
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      const int a = (q + 1) % 3, b = (q + 2) % 3, c = (p + 1) % 3, d = (p + 2) % 3;
      T[3 * p + q] = S[3 * a + c] * S[3 * b + d] - S[3 * a + d] * S[3 * b + c];
    }
  const double det = S[0] * T[0] + S[1] * T[3] + S[2] * T[6];
  for (int p = 0; p < 9; p++) T[p] /= det;
}

/* rigid = B W and its friction S = W^T B W. A rigid translation is one velocity for all spheres and
 * no rotation, so column q of B W is the sum of columns q of all spheres of B = D^1/2 C^-1 D^1/2,
 * and S is the sum of its rows of forces. */
static void rigid_translations(sd_blocks *b, int k, double S[9])
{
  const int *member = b->member + b->first[k], width = b->width;
  const int m = (int) (b->first[k + 1] - b->first[k]);
  const long size = (long) width * m;
  const double *A = b->inverse + b->start[k];
  double *BW = b->rigid + 3 * width * b->first[k];
  memset(BW, 0, sizeof(double) * 3 * (size_t) size);
  for (int j = 0; j < m; j++)
    for (int q = 0; q < 3; q++)
      for (long i = 0; i < size; i++)
        BW[3 * i + q] += A[i + size * (width * (long) j + q)] * root(b, member[j], q);
  for (int p = 0; p < 9; p++) S[p] = 0.0;
  for (int i = 0; i < m; i++)
    for (int p = 0; p < width; p++)
      for (int q = 0; q < 3; q++) {
        BW[3 * (width * (long) i + p) + q] *= root(b, member[i], p);
        if (p < 3) S[3 * p + q] += BW[3 * (width * (long) i + p) + q];
      }
}

/* A clump without spheres that take part has nothing to invert. */
sd_status sd_blocks_renew(sd_blocks *b, const sd_precondition_case *c, int k)
{
  const int m = (int) (b->first[k + 1] - b->first[k]), size = b->width * m;
  double *A = b->inverse + b->start[k], S[9];
  sd_blocks_turn(b, k, UNITY);
  if (m == 0) return SD_OK;
  const sd_status status =
      sd_unit_cholesky(&c->law, &c->spheres, b->member + b->first[k], m, b->width, A);
  if (status != SD_OK) return status;
  if (sd_cholesky_inverse(size, A) != SD_OK) return SD_EINDEFINITE;
  rigid_translations(b, k, S);
  inverse3(S, b->mobility + 9 * (long) k);
  return SD_OK;
}

/* x [3m] of the spheres of block k */
static int places(const sd_blocks *b, const sd_spheres *s, int k, double *x)
{
  const int m = (int) (b->first[k + 1] - b->first[k]);
  for (int l = 0; l < m; l++)
    memcpy(x + 3 * l, s->x + 3 * (long) b->member[b->first[k] + l], 3 * sizeof(double));
  return m;
}

/* The shape that block k has now */
static sd_status shape(sd_blocks *b, const sd_spheres *s, int k)
{
  double *x = b->scratch;
  const int m = places(b, s, k, x);
  if (m == 0) return SD_OK;
  double *a = x + 3 * (long) m;
  for (int l = 0; l < m; l++) a[l] = s->a[b->member[b->first[k] + l]];
  sd_shape_free(&b->shape[k]);
  return sd_shape_create(m, x, a, &b->shape[k]);
}

/* What couples the blocks is known where they were made: to all parts. */
static sd_status share(sd_blocks *b, const sd_precondition_case *c)
{
  if (b->parts == 1) return SD_OK;
  for (int k = 0; k < b->blocks; k++) {
    if (k % b->parts == b->part) continue;
    const size_t spheres = (size_t) (b->first[k + 1] - b->first[k]);
    memset(b->rigid + 3 * b->width * b->first[k], 0, sizeof(double) * 3 * b->width * spheres);
    memset(b->mobility + 9 * (long) k, 0, sizeof(double) * 9);
  }
  const int numbers = 3 * b->width * (int) b->first[b->blocks];
  const sd_status status = c->sum(c->sum_ctx, b->rigid, numbers);
  return status == SD_OK ? c->sum(c->sum_ctx, b->mobility, 9 * b->blocks) : status;
}

/* Uncoupled blocks are a preconditioner as well, if they are so in all parts. */
static sd_status couple_or_not(sd_blocks *b, const sd_precondition_case *c)
{
  if (c->rho == 0.0 || b->blocks == 0) return SD_OK;
  const sd_status coupled = sd_precondition_agree(c, sd_blocks_couple(b, c));
  if (coupled != SD_OK) sd_sparse_free(&b->far);
  return SD_OK;
}

sd_status sd_blocks_make(sd_blocks *b, const sd_precondition_case *c)
{
  sd_status status = allocate(b, c);
  if (status == SD_OK) sd_unit_roots(&c->spheres, c->n, b->root);
  for (int k = 0; k < b->blocks && status == SD_OK; k++) {
    sd_blocks_turn(b, k, UNITY);
    if (b->shape) status = shape(b, &c->spheres, k);
    if (status == SD_OK && k % b->parts == b->part) status = sd_blocks_renew(b, c, k);
  }
  status = sd_precondition_agree(c, status);
  if (status == SD_OK) status = share(b, c);
  if (status == SD_OK) status = couple_or_not(b, c);
  if (status != SD_OK) sd_blocks_free(b);
  return status;
}

/* A rigid motion leaves a clump's C as it is but for the axes: B in new axes is R B R^T, and only R
 * is kept. The tables of clumps that have bent are made anew where they are, and shared. */
sd_status sd_blocks_move(sd_blocks *b, const sd_precondition_case *c)
{
  sd_status status = SD_OK;
  int bent = 0;
  for (int k = 0; k < b->blocks && status == SD_OK; k++) {
    double R[9], centre[3];
    if (places(b, &c->spheres, k, b->scratch) == 0) continue;
    const sd_shape *before = &b->shape[k];
    const double limit = (before->n <= SMALL ? ROUNDING : BENT) * before->size;
    if (sd_shape_pose(before, b->scratch, R, centre) <= limit)
      sd_blocks_turn(b, k, R);
    else {
      bent = 1;
      sd_blocks_turn(b, k, UNITY);
      status = shape(b, &c->spheres, k);
      if (status == SD_OK && k % b->parts == b->part) status = sd_blocks_renew(b, c, k);
    }
  }
  status = sd_precondition_agree(c, status);
  if (status == SD_OK && bent) status = share(b, c);
  return status == SD_OK ? couple_or_not(b, c) : status;
}

/* From the axes at set-up, not from those of the last turn: rounding does not pile up. */
void sd_blocks_turn(sd_blocks *b, int block, const double *R)
{
  memcpy(b->turn + 9 * (long) block, R, 9 * sizeof(double));
}

/* A sphere of radius a and viscosity eta has the friction f = 6 pi eta a. That of clump k: in the
 * middle of its spheres (weights: their radii), eta = sum(eta_i a_i)/sum(a_i), f = tr S/3. */
static void as_one_sphere(const sd_blocks *b, const sd_spheres *s, int k, double x[3], double *a,
                          double *w)
{
  double sum = 0.0, radii = 0.0, S[9];
  *a = *w = x[0] = x[1] = x[2] = 0.0;
  for (long l = b->first[k]; l < b->first[k + 1]; l++) {
    const int i = b->member[l];
    for (int d = 0; d < 3; d++) x[d] += s->a[i] * s->x[3 * (long) i + d];
    radii += s->a[i];
    sum += s->a[i] / (s->w[i] * s->w[i]);
  }
  if (radii == 0.0) return;
  for (int d = 0; d < 3; d++) x[d] /= radii;
  inverse3(b->mobility + 9 * (long) k, S);
  *a = (S[0] + S[4] + S[8]) / 3.0 * radii / (6.0 * SD_PI * sum);
  *w = sqrt(radii / sum);
}

/* Q is the factor of a cloud of bodies, made anew where they are now; blocks stay as they are. */
sd_status sd_blocks_couple(sd_blocks *b, const sd_precondition_case *c)
{
  const size_t blocks = (size_t) b->blocks;
  sd_sparse_free(&b->far);
  double *x = malloc(sizeof(double) * 5 * (blocks + 1));
  if (!x) return SD_ENOMEMORY;
  double *a = x + 3 * blocks, *w = a + blocks;
  for (int k = 0; k < b->blocks; k++) as_one_sphere(b, &c->spheres, k, x + 3 * k, a + k, w + k);
  const sd_spheres bodies = {x, a, w};
  const sd_status status =
      sd_sparse_create(&b->far, &c->law, &bodies, b->blocks, 3, c->rho, b->part, b->parts);
  free(x);
  return status;
}

/* out = R v, and R^T v, of each of the vectors of a sphere */
static void turned(const double *R, const double *v, int width, double *out)
{
  for (int k = 0; k < width; k += 3) sd_multiply3(R, v + k, out + k);
}

static void turned_back(const double *R, const double *v, int width, double *out)
{
  for (int k = 0; k < width; k += 3) sd_multiply3t(R, v + k, out + k);
}

/* z += (B W S^-1 Q S^-1 W^T B - B W S^-1 W^T B) r, from right to left; the second term is of this
 * part's blocks. Blocks stand in their axes at set-up, Q in those of now. */
static void couple(const sd_blocks *b, const double *r, double *z)
{
  const int width = b->width;
  double *own = b->scratch, *velocity = own + 3 * (long) b->blocks,
         *coupled = velocity + 3 * (long) b->blocks;
  for (int k = 0; k < b->blocks; k++) { /* own = S^-1 W^T B r */
    const double *R = b->turn + 9 * (long) k;
    double force[3] = {0.0, 0.0, 0.0};
    for (long l = b->first[k]; l < b->first[k + 1]; l++) {
      double v[6];
      turned_back(R, r + width * (long) b->member[l], width, v);
      for (int p = 0; p < width; p++)
        for (int q = 0; q < 3; q++) force[q] += b->rigid[3 * (width * l + p) + q] * v[p];
    }
    turned(b->mobility + 9 * (long) k, force, 3, own + 3 * (long) k);
    turned(R, own + 3 * (long) k, 3, velocity + 3 * (long) k);
  }
  sd_sparse_apply((void *) &b->far, velocity, coupled);
  for (int k = 0; k < b->blocks; k++) { /* z += B W (S^-1 Q own - own) */
    const double *R = b->turn + 9 * (long) k;
    double force[3], e[3];
    turned_back(R, coupled + 3 * (long) k, 3, force);
    turned(b->mobility + 9 * (long) k, force, 3, e);
    if (k % b->parts == b->part)
      for (int q = 0; q < 3; q++) e[q] -= own[3 * (long) k + q];
    for (long l = b->first[k]; l < b->first[k + 1]; l++) {
      double f[6] = {0.0}, v[6];
      for (int p = 0; p < width; p++)
        for (int q = 0; q < 3; q++) f[p] += b->rigid[3 * (width * l + p) + q] * e[q];
      turned(R, f, width, v);
      for (int p = 0; p < width; p++) z[width * (long) b->member[l] + p] += v[p];
    }
  }
}

/* z = B r in the rows of block k, B = R D^1/2 C^-1 D^1/2 R^T from right to left: into the axes at
 * set-up, through the stored inverse column by column, and back. */
static void apply_block(const sd_blocks *b, int k, const double *r, double *z)
{
  const int *member = b->member + b->first[k], width = b->width;
  const int m = (int) (b->first[k + 1] - b->first[k]), size = width * m;
  const double *A = b->inverse + b->start[k], *R = b->turn + 9 * (long) k;
  double *in = b->scratch, *out = in + size;
  for (int l = 0; l < m; l++) {
    turned_back(R, r + width * (long) member[l], width, in + width * l);
    for (int p = 0; p < width; p++) in[width * l + p] *= root(b, member[l], p);
  }
  memset(out, 0, sizeof(double) * (size_t) size);
  for (int q = 0; q < size; q++) {
    const double *column = A + (long) size * q, v = in[q];
    for (int p = 0; p < size; p++) out[p] += column[p] * v;
  }
  for (int l = 0; l < m; l++) {
    for (int p = 0; p < width; p++) out[width * l + p] *= root(b, member[l], p);
    turned(R, out + width * l, width, z + width * (long) member[l]);
  }
}

/* B = D^1/2 C^-1 D^1/2, many columns at once: a number of B is made once for all of them. */
void sd_blocks_multiply(const sd_blocks *b, int k, int count, const double *in, double *out)
{
  const int *member = b->member + b->first[k], width = b->width;
  const long size = width * (b->first[k + 1] - b->first[k]);
  const double *A = b->inverse + b->start[k];
  memset(out, 0, sizeof(double) * (size_t) (count * size));
  for (long p = 0; p < size; p++)
    for (long q = 0; q < size; q++) {
      const double c = root(b, member[p / width], (int) (p % width)) * A[p + size * q] *
          root(b, member[q / width], (int) (q % width));
      for (int l = 0; l < count; l++) out[count * p + l] += c * in[count * q + l];
    }
}

/* Spheres by themselves, which every part knows, are the first part's. */
sd_status sd_blocks_apply(void *ctx, const double *r, double *z)
{
  const sd_blocks *b = ctx;
  const long width = b->width;
  memset(z, 0, sizeof(double) * (size_t) (width * b->n));
  for (int i = 0; i < b->n && b->part == 0; i++)
    for (int p = 0; p < width && b->lone[i]; p++)
      z[width * i + p] = root(b, i, p) * root(b, i, p) * r[width * i + p];
  for (int k = b->part; k < b->blocks; k += b->parts) apply_block(b, k, r, z);
  if (b->far.n > 0) couple(b, r, z);
  return SD_OK;
}
