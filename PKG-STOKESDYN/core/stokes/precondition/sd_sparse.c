#include "sd_sparse.h"

#include <stdlib.h>
#include <string.h>

#include "sd_precondition_internal.h"

void sd_sparse_free(void *factor)
{
  sd_sparse *f = factor;
  sd_rows_free(&f->rows);
  free(f->value);
  free(f->root);
  free(f->scratch);
  memset(f, 0, sizeof(*f));
}

/* Sums of products, each lane apart: the same order on every processor. */
enum { LANES = 8 };
static inline float sp_dot(const float *x, const float *y, int n)
{
  float lane[LANES] = {0.0f}, sum = 0.0f;
  int p = 0;
  for (; p + LANES <= n; p += LANES)
    for (int l = 0; l < LANES; l++) lane[l] += x[p + l] * y[p + l];
  for (; p < n; p++) sum += x[p] * y[p];
  for (int l = 0; l < LANES; l++) sum += lane[l];
  return sum;
}

/* The column of L that belongs to sphere i. Of all columns with rows in the set s of spheres, i
 * last in it, the nearest one to the inverse is C_ss^-1 e_i / (e_i . C_ss^-1 e_i)^1/2 (Schaefer et
 * al., Theorem 2.1; with blocks, e_i are `width` unit vectors). With C_ss = R R^T, R lower, this is
 * R^-T e_i: as i comes last, R^-1 e_i = e_i / R_ii and R_ii^2 = 1/(e_i . C_ss^-1 e_i).
 * So X [width][size], these columns, solves R^T X = E from the bottom up, R column-major. */
static void last_columns(const float *R, int size, int width, float *X)
{
  for (int k = size - 1; k >= 0; k--) {
    const float *column = R + (long) size * k;
    for (int q = 0; q < width; q++) {
      float *x = X + (long) size * q;
      const float unit = k - (size - width) == q ? 1.0f : 0.0f;
      x[k] = (unit - sp_dot(column + k + 1, x + k + 1, size - 1 - k)) / column[k];
    }
  }
}

/* The column of blocks of m spheres, its own last in X and first in value. */
static void sp_store(const float *X, int m, int width, float *value)
{
  const int size = sd_sparse_floats(width), lda = width == 3 ? 4 : 6;
  memset(value, 0, sizeof(float) * (size_t) (size * m));
  for (int l = 0; l < m; l++)
    for (int q = 0; q < width; q++)
      for (int p = 0; p < width; p++)
        value[size * l + lda * q + p] = X[width * (m * (long) q + m - 1 - l) + p];
}

/* R of these spheres, in single precision where that will do. most: of any column, for memory that is
 * seldom needed. */
static sd_status local_factor(const sd_unit_submatrix *c, int most, float *A, double **in_double)
{
  const sd_status status = sd_unit_cholesky_single(c, A);
  if (status != SD_ESINGULAR) return status;
  const size_t largest = (size_t) c->width * (size_t) most, size = (size_t) c->width * (size_t) c->m;
  if (!*in_double) *in_double = malloc(sizeof(double) * largest * largest);
  if (!*in_double) return SD_ENOMEMORY;
  const sd_status second = sd_unit_cholesky(c, *in_double);
  for (size_t p = 0; p < size * size && second == SD_OK; p++) A[p] = (float) (*in_double)[p];
  return second;
}

/* Each column from the C of the spheres that it sees, its own last. */
static sd_status sp_fill(sd_sparse *f, const sd_law *law, const sd_spheres *s)
{
  const sd_rows *rows = &f->rows;
  const size_t blocks = (size_t) rows->first[rows->columns], most = (size_t) rows->largest;
  const size_t size = (size_t) f->width * most, floats = (size_t) sd_sparse_floats(f->width);
  f->value = malloc(sizeof(float) * (floats * blocks + 2));
  int *member = malloc(sizeof(int) * (most + 1));
  float *A = malloc(sizeof(float) * (size * size + 1)),
        *X = malloc(sizeof(float) * ((size_t) f->width * size + 1));
  double *in_double = NULL;
  sd_status status = f->value && member && A && X ? SD_OK : SD_ENOMEMORY;
  if (f->value) memset(f->value + floats * blocks, 0, 2 * sizeof(float));
  for (int k = 0; k < rows->columns && status == SD_OK; k++) {
    const int *row = rows->row + rows->first[k];
    const int m = (int) (rows->first[k + 1] - rows->first[k]);
    for (int l = 0; l < m; l++) member[l] = row[m - 1 - l];
    const sd_unit_submatrix seen = {law, s, member, m, f->width};
    status = local_factor(&seen, rows->largest, A, &in_double);
    if (status != SD_OK) break;
    last_columns(A, f->width * m, f->width, X);
    sp_store(X, m, f->width, f->value + floats * (size_t) rows->first[k]);
  }
  free(member);
  free(A);
  free(X);
  free(in_double);
  return status;
}

sd_status sd_sparse_create(sd_sparse *f, const sd_precondition_case *c, double rho)
{
  const sd_spheres *s = &c->spheres;
  const int n = c->n;
  memset(f, 0, sizeof(*f));
  for (int i = 0; i < n; i++)
    for (int d = 0; d < 3; d++)
      if (s->a[i] > 0.0 && !isfinite(s->x[3 * (long) i + d])) return SD_ENOTFINITE;
  f->n = n;
  f->width = c->width;
  f->part = c->part;
  f->parts = c->parts;
  f->root = malloc(sizeof(double) * (2 * (size_t) n + 1));
  f->scratch = malloc(sizeof(double) * (16 * (size_t) n + 1));
  sd_status status = f->root && f->scratch ? SD_OK : SD_ENOMEMORY;
  if (status == SD_OK) status = sd_rows_find(&f->rows, s, n, rho, c->part, c->parts);
  if (status == SD_OK) status = sp_fill(f, &c->law, s);
  if (status == SD_OK) sd_unit_roots(s, n, f->root);
  if (status != SD_OK) sd_sparse_free(f);
  return status;
}

/* z = D^1/2 L L^T D^1/2 r: scaled into vectors that the kernels can load whole, and back. */
sd_status sd_sparse_apply(void *ctx, const double *r, double *z)
{
  const sd_sparse *f = ctx;
  const long width = f->width, step = width == 3 ? 4 : 8;
  double *in = f->scratch, *out = in + step * f->n;
  for (long i = 0; i < f->n; i++)
    for (int d = 0; d < step; d++)
      in[step * i + d] = d < width ? f->root[2 * i + (d >= 3)] * r[width * i + d] : 0.0;
  memset(out, 0, sizeof(double) * (size_t) (step * f->n));
  const struct sd_sparse_kernels *kernels =
      SD_KERNELS_OF(sd_sparse, plain, sd_isa_of(SD_ISA_BEST));
  sd_sparse_product *product = width == 3 ? kernels->three : kernels->six;
  product(f->rows.columns, f->rows.first, f->rows.row, f->value, in, out);
  for (long i = 0; i < f->n; i++)
    for (int d = 0; d < width; d++)
      z[width * i + d] = f->root[2 * i + (d >= 3)] * out[step * i + d];
  return SD_OK;
}

/* Reach of the kind: 42 blocks per sphere in a compact cloud */
static const double RHO = 3.0;

static sd_status make(void *f, const sd_precondition_case *c)
{
  const sd_status status = sd_sparse_create(f, c, RHO);
  const sd_status agreed = sd_world_agree(&c->world, status);
  if (agreed != SD_OK) sd_sparse_free(f);
  return agreed;
}

const sd_precondition_kind sd_precondition_sparse = {sizeof(sd_sparse), make, sd_sparse_apply,
                                                     sd_sparse_free};
