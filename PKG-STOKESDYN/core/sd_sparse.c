#include "sd_sparse.h"

#include <stdlib.h>
#include <string.h>

#include "sd_product_internal.h"
#include "sd_unit.h"

void sd_sparse_free(sd_sparse *f)
{
  sd_rows_free(&f->rows);
  free(f->value);
  free(f->scratch);
  memset(f, 0, sizeof(*f));
}

/* Last three columns X of R^-T, R the lower Cholesky factor (size x size, column-major): R^T X = E from the bottom up. */
static void last_columns(const double *R, int size, double *X)
{
  for (int k = size - 1; k >= 0; k--) {
    const double *column = R + (long) size * k;
    double v[3] = {0.0, 0.0, 0.0};
    if (k >= size - 3) v[k - (size - 3)] = 1.0;
    for (int p = k + 1; p < size; p++)
      for (int q = 0; q < 3; q++) v[q] -= column[p] * X[3 * p + q];
    for (int q = 0; q < 3; q++) X[3 * k + q] = v[q] / column[k];
  }
}

sd_status sd_sparse_create(sd_sparse *f, const sd_law *law, const sd_spheres *s, int n, double rho,
                           int part, int parts)
{
  memset(f, 0, sizeof(*f));
  f->n = n;
  f->part = part;
  f->parts = parts;
  int count = -1;
  sd_status status = SD_ENOMEMORY;
  int *order = malloc(sizeof(int) * (size_t) (n + 1)), *member = NULL;
  double *distance = malloc(sizeof(double) * (size_t) (n + 1)), *A = NULL, *X = NULL;
  for (int i = 0; i < n; i++)
    for (int d = 0; d < 3; d++)
      if (s->a[i] > 0.0 && !isfinite(s->x[3 * (long) i + d])) {
        status = SD_ENOTFINITE;
        goto end;
      }
  if (order && distance) count = sd_farthest_first(s, n, order, distance);
  if (count < 0 || sd_rows_find(&f->rows, s, n, order, distance, count, rho, part, parts) != SD_OK)
    goto end;
  f->value = malloc(sizeof(float) * (size_t) (12 * f->rows.first[f->rows.columns] + 1));
  f->scratch = malloc(sizeof(double) * (size_t) (8 * (long) n + 1));
  member = malloc(sizeof(int) * (size_t) (f->rows.largest + 1));
  A = malloc(sizeof(double) * (size_t) (9 * (long) f->rows.largest * f->rows.largest + 1));
  X = malloc(sizeof(double) * (size_t) (9 * (long) f->rows.largest + 1));
  if (!f->value || !f->scratch || !member || !A || !X) goto end;

  status = SD_OK;
  for (int k = 0; k < f->rows.columns && status == SD_OK; k++) {
    const int *row = f->rows.row + f->rows.first[k];
    const int m = (int) (f->rows.first[k + 1] - f->rows.first[k]);
    for (int l = 0; l < m; l++) member[l] = row[m - 1 - l]; /* its own last */
    status = sd_unit_cholesky(law, s, member, m, A);
    if (status != SD_OK) break;
    last_columns(A, 3 * m, X);
    float *value = f->value + 12 * f->rows.first[k];
    for (int l = 0; l < m; l++)
      for (int q = 0; q < 3; q++) {
        for (int p = 0; p < 3; p++)
          value[12 * l + 4 * q + p] = (float) X[9 * (m - 1 - l) + 3 * p + q];
        value[12 * l + 4 * q + 3] = 0.0f;
      }
  }
end:
  free(order);
  free(distance);
  free(member);
  free(A);
  free(X);
  if (status != SD_OK) sd_sparse_free(f);
  return status;
}

/* What the kernels do, where there are none. */
static void plain_sparse(int columns, const long *first, const int *row, const float *value,
                         const double *in, double *out)
{
  for (int k = 0; k < columns; k++) {
    double t[3] = {0.0, 0.0, 0.0};
    for (long l = first[k]; l < first[k + 1]; l++) {
      const double *v = in + 4 * (long) row[l];
      for (int q = 0; q < 3; q++) {
        const float *B = value + 12 * l + 4 * q;
        t[q] += B[0] * v[0] + B[1] * v[1] + B[2] * v[2];
      }
    }
    for (long l = first[k]; l < first[k + 1]; l++) {
      double *v = out + 4 * (long) row[l];
      const float *B = value + 12 * l;
      for (int p = 0; p < 3; p++) v[p] += B[p] * t[0] + B[4 + p] * t[1] + B[8 + p] * t[2];
    }
  }
}

void sd_sparse_apply(void *ctx, const double *r, double *z)
{
  const sd_sparse *f = ctx;
  const struct sd_kernels *kernels = sd_kernels_of(sd_isa_best());
  const long w = f->width;
  double *in = f->scratch, *out = in + 4 * (long) f->n;
  for (int i = 0; i < f->n; i++) {
    const double root = sqrt(f->drag[i]);
    for (int d = 0; d < 3; d++) in[4 * (long) i + d] = root * r[w * i + d];
    in[4 * (long) i + 3] = 0.0;
  }
  memset(out, 0, 4 * sizeof(double) * (size_t) f->n);
  (kernels ? kernels->sparse : plain_sparse)(f->rows.columns, f->rows.first, f->rows.row, f->value,
                                             in, out);
  for (int i = 0; i < f->n; i++) {
    const double root = sqrt(f->drag[i]);
    for (int d = 0; d < 3; d++) z[w * i + d] = root * out[4 * (long) i + d];
  }
  if (f->part == 0)
    sd_torques(f->width, f->drag, f->spin, f->n, r, z);
  else if (w == 6)
    for (int i = 0; i < f->n; i++)
      for (int d = 3; d < 6; d++) z[6 * (long) i + d] = 0.0;
}
