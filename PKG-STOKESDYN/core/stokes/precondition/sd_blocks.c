#include "sd_blocks.h"

#include <stdlib.h>
#include <string.h>

#include "sd_linear.h"
#include "sd_unit.h"

static const double UNITY[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

static void uncouple(sd_blocks *b)
{
  free(b->friction);
  b->friction = NULL;
  sd_sparse_free(&b->far);
}

void sd_blocks_free(sd_blocks *b)
{
  uncouple(b);
  free(b->first);
  free(b->member);
  free(b->start);
  free(b->inverse);
  free(b->turn);
  free(b->root);
  free(b->rigid);
  free(b->mobility);
  free(b->scratch);
  memset(b, 0, sizeof(*b));
}

static sd_status allocate(sd_blocks *b, const sd_spheres *s, int n, int width, int blocks,
                          const long *first, const int *member)
{
  b->n = n;
  b->width = width;
  b->parts = 1;
  b->blocks = blocks;
  b->first = malloc(sizeof(long) * (size_t) (blocks + 1));
  b->start = malloc(sizeof(long) * (size_t) (blocks + 1));
  b->member = malloc(sizeof(int) * (size_t) (first[blocks] + 1));
  b->turn = calloc((size_t) blocks + 1, sizeof(double) * 9);
  b->mobility = calloc((size_t) blocks + 1, sizeof(double) * 9);
  b->root = calloc(2 * (size_t) n + 1, sizeof(double));
  if (!b->first || !b->start || !b->member || !b->turn || !b->mobility || !b->root)
    return SD_ENOMEMORY;
  long count = 0, largest = 0;
  b->start[0] = 0;
  for (int k = 0; k < blocks; k++) {
    b->first[k] = count;
    for (long l = first[k]; l < first[k + 1]; l++) {
      const int i = member[l];
      if (!(s->a[i] > 0.0)) continue;
      b->member[count++] = i;
      b->root[2 * (long) i] = sqrt(6.0 * SD_PI * s->a[i]) / s->w[i];
      b->root[2 * (long) i + 1] = sqrt(8.0 * SD_PI * s->a[i]) * s->a[i] / s->w[i];
    }
    const long m = count - b->first[k];
    if (m > largest) largest = m;
    b->start[k + 1] = b->start[k] + width * width * m * m;
  }
  b->first[blocks] = count;
  b->inverse = malloc(sizeof(double) * (size_t) (b->start[blocks] + 1));
  b->rigid = calloc((size_t) (3 * width * count + 1), sizeof(double));
  b->scratch = malloc(sizeof(double) * (size_t) (2 * width * largest + 9 * (long) blocks + 1));
  return b->inverse && b->rigid && b->scratch ? SD_OK : SD_ENOMEMORY;
}

/* Root of the diagonal in row p of a sphere */
static double root(const sd_blocks *b, int sphere, int p)
{
  return b->root[2 * (long) sphere + (p >= 3)];
}

/* Inverse of a symmetric positive definite 3x3 matrix. */
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

/* rigid = B W and its friction S = W^T B W */
static void rigid_translations(sd_blocks *b, int k, double S[9])
{
  const int *member = b->member + b->first[k], w = b->width;
  const int m = (int) (b->first[k + 1] - b->first[k]);
  const long size = (long) w * m;
  const double *A = b->inverse + b->start[k];
  double *BW = b->rigid + 3 * w * b->first[k];
  memset(BW, 0, sizeof(double) * 3 * (size_t) size);
  for (int j = 0; j < m; j++)
    for (int q = 0; q < 3; q++)
      for (long i = 0; i < size; i++)
        BW[3 * i + q] += A[i + size * (w * (long) j + q)] * root(b, member[j], q);
  for (int p = 0; p < 9; p++) S[p] = 0.0;
  for (int i = 0; i < m; i++)
    for (int p = 0; p < w; p++)
      for (int q = 0; q < 3; q++) {
        BW[3 * (w * (long) i + p) + q] *= root(b, member[i], p);
        if (p < 3) S[3 * p + q] += BW[3 * (w * (long) i + p) + q];
      }
}

sd_status sd_blocks_renew(sd_blocks *b, const sd_law *law, const sd_spheres *s, int k)
{
  const int m = (int) (b->first[k + 1] - b->first[k]), size = b->width * m;
  double *A = b->inverse + b->start[k], S[9];
  sd_blocks_turn(b, k, UNITY);
  if (m == 0) return SD_OK;
  const sd_status status = sd_unit_cholesky(law, s, b->member + b->first[k], m, b->width, A);
  if (status != SD_OK) return status;
  if (sd_cholesky_inverse(size, A) != SD_OK) return SD_EINDEFINITE;
  rigid_translations(b, k, S);
  inverse3(S, b->mobility + 9 * (long) k);
  return SD_OK;
}

sd_status sd_blocks_create_part(sd_blocks *b, const sd_law *law, const sd_spheres *s, int n,
                                int width, int blocks, const long *first, const int *member,
                                int part, int parts)
{
  memset(b, 0, sizeof(*b));
  sd_status status = allocate(b, s, n, width, blocks, first, member);
  b->part = part;
  b->parts = parts;
  for (int k = part; k < blocks && status == SD_OK; k += parts)
    status = sd_blocks_renew(b, law, s, k);
  for (int k = 0; k < blocks && status == SD_OK; k++) sd_blocks_turn(b, k, UNITY);
  if (status != SD_OK) sd_blocks_free(b);
  return status;
}

sd_status sd_blocks_create(sd_blocks *b, const sd_law *law, const sd_spheres *s, int n, int width,
                           int blocks, const long *first, const int *member)
{
  return sd_blocks_create_part(b, law, s, n, width, blocks, first, member, 0, 1);
}

void sd_blocks_turn(sd_blocks *b, int block, const double *R)
{
  memcpy(b->turn + 9 * (long) block, R, 9 * sizeof(double));
}

sd_status sd_blocks_couple(sd_blocks *b, const sd_law *law, const sd_spheres *s, double rho)
{
  const size_t K = (size_t) b->blocks;
  uncouple(b);
  double *x = malloc(sizeof(double) * 5 * (K + 1));
  b->friction = calloc(K + 1, sizeof(double));
  if (!x || !b->friction) {
    free(x);
    return SD_ENOMEMORY;
  }
  double *a = x + 3 * K, *w = a + K;
  for (size_t k = 0; k < K; k++) {
    /* In the middle, with the mean friction and the mean viscosity of the clump */
    double sum = 0.0, radii = 0.0, S[9];
    a[k] = w[k] = x[3 * k] = x[3 * k + 1] = x[3 * k + 2] = 0.0;
    for (long l = b->first[k]; l < b->first[k + 1]; l++) {
      const int i = b->member[l];
      for (int d = 0; d < 3; d++) x[3 * k + d] += s->a[i] * s->x[3 * (long) i + d];
      radii += s->a[i];
      sum += s->a[i] / (s->w[i] * s->w[i]);
    }
    if (radii == 0.0) continue;
    for (int d = 0; d < 3; d++) x[3 * k + d] /= radii;
    inverse3(b->mobility + 9 * k, S);
    b->friction[k] = (S[0] + S[4] + S[8]) / 3.0;
    a[k] = b->friction[k] * radii / (6.0 * SD_PI * sum);
    w[k] = sqrt(radii / sum);
  }
  const sd_spheres bodies = {x, a, w};
  const sd_status status =
      sd_sparse_create(&b->far, law, &bodies, b->blocks, 3, rho, b->part, b->parts);
  free(x);
  if (status != SD_OK) uncouple(b);
  b->far.drag = b->friction;
  return status;
}

/* out = R v, and R^T v, of each of the vectors of a sphere */
static void turned(const double *R, const double *v, int width, double *out)
{
  for (; width > 0; width -= 3, v += 3, out += 3)
    for (int d = 0; d < 3; d++)
      out[d] = R[3 * d] * v[0] + R[3 * d + 1] * v[1] + R[3 * d + 2] * v[2];
}

static void turned_back(const double *R, const double *v, int width, double *out)
{
  for (; width > 0; width -= 3, v += 3, out += 3)
    for (int d = 0; d < 3; d++) out[d] = R[d] * v[0] + R[3 + d] * v[1] + R[6 + d] * v[2];
}

/* z += (B W S^-1 Q S^-1 W^T B - B W S^-1 W^T B) r, the last term of this part's blocks */
static sd_status couple(const sd_blocks *b, const double *r, double *z)
{
  const int w = b->width;
  double *own = b->scratch, *velocity = own + 3 * (long) b->blocks,
         *coupled = velocity + 3 * (long) b->blocks;
  for (int k = 0; k < b->blocks; k++) {
    const double *R = b->turn + 9 * (long) k;
    double force[3] = {0.0, 0.0, 0.0};
    for (long l = b->first[k]; l < b->first[k + 1]; l++) {
      double v[6];
      turned_back(R, r + w * (long) b->member[l], w, v);
      for (int p = 0; p < w; p++)
        for (int q = 0; q < 3; q++) force[q] += b->rigid[3 * (w * l + p) + q] * v[p];
    }
    turned(b->mobility + 9 * (long) k, force, 3, own + 3 * (long) k);
    turned(R, own + 3 * (long) k, 3, velocity + 3 * (long) k);
  }
  const sd_status status = sd_sparse_apply((void *) &b->far, velocity, coupled);
  for (int k = 0; k < b->blocks; k++) {
    const double *R = b->turn + 9 * (long) k;
    double c[3], e[3];
    turned_back(R, coupled + 3 * (long) k, 3, c);
    turned(b->mobility + 9 * (long) k, c, 3, e);
    if (k % b->parts == b->part)
      for (int q = 0; q < 3; q++) e[q] -= own[3 * (long) k + q];
    for (long l = b->first[k]; l < b->first[k + 1]; l++) {
      double f[6] = {0.0}, v[6];
      for (int p = 0; p < w; p++)
        for (int q = 0; q < 3; q++) f[p] += b->rigid[3 * (w * l + p) + q] * e[q];
      turned(R, f, w, v);
      for (int p = 0; p < w; p++) z[w * (long) b->member[l] + p] += v[p];
    }
  }
  return status;
}

/* z = B r in the rows of block k */
static void apply_block(const sd_blocks *b, int k, const double *r, double *z)
{
  const int *member = b->member + b->first[k], w = b->width;
  const int m = (int) (b->first[k + 1] - b->first[k]), size = w * m;
  const double *A = b->inverse + b->start[k], *R = b->turn + 9 * (long) k;
  double *in = b->scratch, *out = in + size;
  for (int l = 0; l < m; l++) {
    turned_back(R, r + w * (long) member[l], w, in + w * l);
    for (int p = 0; p < w; p++) in[w * l + p] *= root(b, member[l], p);
  }
  memset(out, 0, sizeof(double) * (size_t) size);
  for (int q = 0; q < size; q++) {
    const double *column = A + (long) size * q, v = in[q];
    for (int p = 0; p < size; p++) out[p] += column[p] * v;
  }
  for (int l = 0; l < m; l++) {
    for (int p = 0; p < w; p++) out[w * l + p] *= root(b, member[l], p);
    turned(R, out + w * l, w, z + w * (long) member[l]);
  }
}

sd_status sd_blocks_apply(void *ctx, const double *r, double *z)
{
  const sd_blocks *b = ctx;
  const long w = b->width;
  memset(z, 0, sizeof(double) * (size_t) (w * b->n));
  if (b->part == 0)
    for (long i = 0; i < b->n; i++)
      if (b->root[2 * i] == 0.0)
        for (int d = 0; d < w; d++)
          z[w * i + d] = b->drag[i] == 0.0 ? 0.0 : (d < 3 ? b->drag[i] : b->spin[i]) * r[w * i + d];
  for (int k = b->part; k < b->blocks; k += b->parts) apply_block(b, k, r, z);
  return b->friction ? couple(b, r, z) : SD_OK;
}
