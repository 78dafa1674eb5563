#include "sd_blocks.h"

#include <stdlib.h>
#include <string.h>

#include "sd_unit.h"

/* LAPACK: inverse from the Cholesky factor in the lower triangle (column-major). */
void dpotri_(const char *uplo, const int *n, double *A, const int *lda, int *info);

static void uncouple(sd_blocks *b)
{
  free(b->rigid);
  free(b->mobility);
  free(b->total);
  free(b->friction);
  b->rigid = b->mobility = b->total = b->friction = NULL;
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
  free(b->scratch);
  memset(b, 0, sizeof(*b));
}

static sd_status blocks_allocate(sd_blocks *b, const sd_spheres *s, int n, int blocks,
                                 const long *first, const int *member)
{
  b->n = n;
  b->blocks = blocks;
  b->first = malloc(sizeof(long) * (size_t) (blocks + 1));
  b->start = malloc(sizeof(long) * (size_t) (blocks + 1));
  b->member = malloc(sizeof(int) * (size_t) (first[blocks] + 1));
  b->turn = calloc((size_t) blocks + 1, sizeof(double) * 9);
  b->root = calloc((size_t) n + 1, sizeof(double));
  if (!b->first || !b->start || !b->member || !b->turn || !b->root) return SD_ENOMEMORY;
  long count = 0, largest = 0;
  b->start[0] = 0;
  for (int k = 0; k < blocks; k++) {
    b->first[k] = count;
    for (long l = first[k]; l < first[k + 1]; l++) {
      const int i = member[l];
      if (!(s->a[i] > 0.0)) continue;
      b->member[count++] = i;
      b->root[i] = sqrt(6.0 * SD_PI * s->a[i]) / s->w[i];
    }
    const long m = count - b->first[k];
    if (m > largest) largest = m;
    b->start[k + 1] = b->start[k] + 9 * m * m;
    for (int d = 0; d < 3; d++) b->turn[9 * (long) k + 4 * d] = 1.0;
  }
  b->first[blocks] = count;
  b->inverse = malloc(sizeof(double) * (size_t) (b->start[blocks] + 1));
  b->scratch = malloc(sizeof(double) * (size_t) (6 * largest + 1));
  return b->inverse && b->scratch ? SD_OK : SD_ENOMEMORY;
}

sd_status sd_blocks_create(sd_blocks *b, const sd_law *law, const sd_spheres *s, int n, int blocks,
                           const long *first, const int *member)
{
  memset(b, 0, sizeof(*b));
  sd_status status = blocks_allocate(b, s, n, blocks, first, member);
  for (int k = 0; k < blocks && status == SD_OK; k++) {
    const int m = (int) (b->first[k + 1] - b->first[k]), size = 3 * m;
    double *A = b->inverse + b->start[k];
    if (m == 0) continue;
    status = sd_unit_cholesky(law, s, b->member + b->first[k], m, A);
    if (status != SD_OK) break;
    int info;
    dpotri_("L", &size, A, &size, &info);
    if (info != 0) status = SD_EINDEFINITE;
    for (long q = 0; q < size; q++) /* the other triangle */
      for (long p = 0; p < q; p++) A[p + size * q] = A[q + size * p];
  }
  if (status != SD_OK) sd_blocks_free(b);
  return status;
}

void sd_blocks_turn(sd_blocks *b, int block, const double *R)
{
  memcpy(b->turn + 9 * (long) block, R, 9 * sizeof(double));
}

/* out = R v, and R^T v */
static void turned(const double *R, const double *v, double *out)
{
  for (int d = 0; d < 3; d++) out[d] = R[3 * d] * v[0] + R[3 * d + 1] * v[1] + R[3 * d + 2] * v[2];
}

static void turned_back(const double *R, const double *v, double *out)
{
  for (int d = 0; d < 3; d++) out[d] = R[d] * v[0] + R[3 + d] * v[1] + R[6 + d] * v[2];
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

/* rigid = B W, mobility = S^-1; returns the mean friction trace(S)/3. */
static double rigid_translations(sd_blocks *b, int k)
{
  const int *member = b->member + b->first[k];
  const int m = (int) (b->first[k + 1] - b->first[k]), size = 3 * m;
  const double *A = b->inverse + b->start[k];
  double *BW = b->rigid + 9 * b->first[k], S[9] = {0};
  memset(BW, 0, sizeof(double) * 9 * (size_t) m);
  for (int j = 0; j < m; j++)
    for (int i = 0; i < m; i++) {
      const double roots = b->root[member[i]] * b->root[member[j]];
      for (int p = 0; p < 3; p++)
        for (int q = 0; q < 3; q++)
          BW[9 * i + 3 * p + q] += roots * A[3 * i + p + (long) size * (3 * j + q)];
    }
  for (int i = 0; i < m; i++)
    for (int p = 0; p < 9; p++) S[p] += BW[9 * i + p];
  inverse3(S, b->mobility + 9 * (long) k);
  return (S[0] + S[4] + S[8]) / 3.0;
}

sd_status sd_blocks_couple(sd_blocks *b, const sd_law *law, const sd_spheres *s, double rho)
{
  const size_t K = (size_t) b->blocks;
  double *x = malloc(sizeof(double) * 5 * (K + 1)), *a = x + 3 * K, *w = a + K;
  uncouple(b);
  b->rigid = malloc(sizeof(double) * (size_t) (9 * b->first[K] + 1));
  b->mobility = calloc(9 * K + 1, sizeof(double));
  b->total = calloc(9 * K + 1, sizeof(double));
  b->friction = calloc(K + 1, sizeof(double));
  sd_status status = SD_ENOMEMORY;
  if (x && b->rigid && b->mobility && b->total && b->friction) {
    for (size_t k = 0; k < K; k++) {
      /* In the middle, with the mean viscosity of the clump */
      double sum = 0.0, radii = 0.0;
      a[k] = w[k] = x[3 * k] = x[3 * k + 1] = x[3 * k + 2] = 0.0;
      for (long l = b->first[k]; l < b->first[k + 1]; l++) {
        const int i = b->member[l];
        for (int d = 0; d < 3; d++) x[3 * k + d] += s->a[i] * s->x[3 * (long) i + d];
        radii += s->a[i];
        sum += s->a[i] / (s->w[i] * s->w[i]);
      }
      if (radii == 0.0) continue;
      for (int d = 0; d < 3; d++) x[3 * k + d] /= radii;
      b->friction[k] = rigid_translations(b, (int) k);
      a[k] = b->friction[k] * radii / (6.0 * SD_PI * sum);
      w[k] = sqrt(radii / sum);
    }
    const sd_spheres bodies = {x, a, w};
    status = sd_sparse_create(&b->far, law, &bodies, b->blocks, rho, 0, 1);
  }
  free(x);
  if (status != SD_OK) {
    uncouple(b);
    return status;
  }
  b->far.width = 3;
  b->far.drag = b->friction;
  return SD_OK;
}

/* z += B W S^-1 (Q S^-1 - 1) W^T z, given z = B r */
static void couple(const sd_blocks *b, double *z, long w)
{
  double *force = b->total, *velocity = force + 3 * (long) b->blocks,
         *coupled = velocity + 3 * (long) b->blocks;
  for (int k = 0; k < b->blocks; k++) {
    double *c = force + 3 * (long) k, own[3], v[3];
    c[0] = c[1] = c[2] = 0.0;
    for (long l = b->first[k]; l < b->first[k + 1]; l++)
      for (int d = 0; d < 3; d++) c[d] += z[w * b->member[l] + d];
    turned_back(b->turn + 9 * (long) k, c, own);
    turned(b->mobility + 9 * (long) k, own, v);
    turned(b->turn + 9 * (long) k, v, velocity + 3 * (long) k);
  }
  sd_sparse_apply((void *) &b->far, velocity, coupled);
  for (int k = 0; k < b->blocks; k++) {
    const double *R = b->turn + 9 * (long) k;
    double *c = force + 3 * (long) k, own[3], e[3], f[3], z_own[3];
    for (int d = 0; d < 3; d++) c[d] = coupled[3 * (long) k + d] - c[d];
    turned_back(R, c, own);
    turned(b->mobility + 9 * (long) k, own, e);
    for (long l = b->first[k]; l < b->first[k + 1]; l++) {
      turned(b->rigid + 9 * l, e, z_own);
      turned(R, z_own, f);
      for (int d = 0; d < 3; d++) z[w * b->member[l] + d] += f[d];
    }
  }
}

void sd_blocks_apply(void *ctx, const double *r, double *z)
{
  const sd_blocks *b = ctx;
  const long w = b->width;
  for (int i = 0; i < b->n; i++)
    if (b->root[i] == 0.0)
      for (int d = 0; d < 3; d++) z[w * i + d] = b->drag[i] * r[w * i + d];
  for (int k = 0; k < b->blocks; k++) {
    const int *member = b->member + b->first[k];
    const int m = (int) (b->first[k + 1] - b->first[k]), size = 3 * m;
    const double *A = b->inverse + b->start[k], *R = b->turn + 9 * (long) k;
    double *in = b->scratch, *out = in + size;
    for (int l = 0; l < m; l++) {
      turned_back(R, r + w * member[l], in + 3 * l);
      for (int d = 0; d < 3; d++) {
        in[3 * l + d] *= b->root[member[l]];
        out[3 * l + d] = 0.0;
      }
    }
    for (int q = 0; q < size; q++) {
      const double *column = A + (long) size * q, v = in[q];
      for (int p = 0; p < size; p++) out[p] += column[p] * v;
    }
    for (int l = 0; l < m; l++) {
      double *f = out + 3 * l;
      for (int d = 0; d < 3; d++) f[d] *= b->root[member[l]];
      turned(R, f, z + w * member[l]);
    }
  }
  if (b->rigid) couple(b, z, w);
  sd_torques(b->width, b->drag, b->spin, b->n, r, z);
}
