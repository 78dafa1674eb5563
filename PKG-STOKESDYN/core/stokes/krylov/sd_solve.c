#include "sd_solve_internal.h"

/* Adds those of row group i, f [width], of a scaled residual; what is written is squared while it
 * is at hand, since for spheres that hardly see each other the passes over memory are the work. */
static inline void add_squares(const sd_system *A, long i, const double *f, sd_solve_squares *of)
{
  double natural = (f[0] * f[0] + f[1] * f[1] + f[2] * f[2]) / A->drag[i];
  if (A->spin) natural += (f[3] * f[3] + f[4] * f[4] + f[5] * f[5]) / A->spin[i];
  of->plain += A->drag[i] * natural;
  of->natural += natural;
}

static sd_status sum_squares(const sd_system *A, sd_solve_squares mine, sd_solve_squares *of)
{
  double s[2] = {mine.plain, mine.natural};
  const sd_status status = sd_world_sum(&A->world, s, 2);
  *of = (sd_solve_squares){s[0], s[1]};
  return status;
}

sd_status sd_solve_free_draining(const sd_system *A, const double *slip, double *F, sd_solve_squares *of)
{
  const int m = sd_solve_width(A);
  sd_solve_squares mine = {0.0, 0.0};
  for (long i = 0; i < A->n; i++) {
    for (int k = 0; k < m; k++)
      F[m * i + k] = A->drag[i] == 0.0 ? 0.0 : sd_solve_diagonal(A, i, k) * slip[m * i + k];
    if (A->drag[i] != 0.0) add_squares(A, i, F + m * i, &mine);
  }
  return sum_squares(A, mine, of);
}

sd_status sd_solve_residual(const sd_system *A, const double *slip, const double *F, double *out,
                            sd_solve_squares *of)
{
  const int m = sd_solve_width(A);
  sd_solve_squares mine = {0.0, 0.0};
  for (long i = 0; i < A->n; i++) {
    for (int k = 0; k < m; k++) {
      const long j = m * i + k;
      out[j] = A->drag[i] == 0.0 ? 0.0
                                 : sd_solve_diagonal(A, i, k) * (slip[j] - out[j]) - F[j];
    }
    if (A->drag[i] != 0.0) add_squares(A, i, out + m * i, &mine);
  }
  return sum_squares(A, mine, of);
}
