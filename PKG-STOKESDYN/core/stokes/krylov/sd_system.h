/* Rows of the system of sd_solve.h, for those who iterate on it. */
#ifndef SD_SYSTEM_H
#define SD_SYSTEM_H

#include "sd_solve.h"

/* Unknowns of a sphere */
static inline int sd_system_width(const sd_system *A)
{
  return A->spin ? 6 : 3;
}

/* D in row k of sphere i; 0: the sphere takes no part */
static inline double sd_system_diagonal(const sd_system *A, long i, int k)
{
  return k < 3 ? A->drag[i] : A->spin[i];
}

static inline sd_status sd_system_sum(const sd_system *A, double *values, int count)
{
  return sd_world_sum(&A->world, values, count);
}

/* q = M p = Omega p + D^-1 p; 0 in the rows of spheres that take no part. */
static inline sd_status sd_system_apply(const sd_system *A, const double *p, double *q)
{
  const sd_status status = A->apply(A->apply_ctx, p, q);
  if (status != SD_OK) return status;
  const int m = sd_system_width(A);
  for (long i = 0; i < A->n; i++)
    for (int k = 0; k < m; k++) {
      const long j = m * i + k;
      q[j] = A->drag[i] == 0.0 ? 0.0 : q[j] + p[j] / sd_system_diagonal(A, i, k);
    }
  return SD_OK;
}

/* out = P r, r a velocity in all rows; without preconditioner P is D. */
static inline sd_status sd_system_precondition(const sd_system *A, const double *r, double *out)
{
  if (A->precondition) return A->precondition(A->precondition_ctx, r, out);
  const int m = sd_system_width(A);
  for (long i = 0; i < A->n; i++)
    for (int k = 0; k < m; k++) out[m * i + k] = sd_system_diagonal(A, i, k) * r[m * i + k];
  return SD_OK;
}

#endif
