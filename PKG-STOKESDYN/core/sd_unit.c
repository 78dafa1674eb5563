#include "sd_unit.h"

/* LAPACK: Cholesky factor of the lower triangle (column-major). */
void dpotrf_(const char *uplo, const int *n, double *A, const int *lda, int *info);

/* A += c [f I + g h h^T] of three rows and columns */
static void put_isotropic(double c, double f, double g, const double h[3], double *A, long lda)
{
  for (int q = 0; q < 3; q++)
    for (int p = 0; p < 3; p++) A[p + lda * q] = c * (g * h[p] * h[q] + (p == q ? f : 0.0));
}

/* The matrix of v -> c v x h */
static void put_cross(double c, const double h[3], double *A, long lda)
{
  for (int q = 0; q < 3; q++) {
    const int e = (q + 1) % 3, f = (q + 2) % 3;
    A[q + lda * q] = 0.0;
    A[e + lda * q] = -c * h[f];
    A[f + lda * q] = c * h[e];
  }
}

/* Block of C into A (column-major, leading dimension lda). The pair tensors of sd_tensor.h, for the roots of the diagonal:
 *   U F   1/(6 pi) times 6 pi sqrt(a_i a_j)            U T   1/(8 pi) times sqrt(6 a_i 8 a_j^3) pi = sqrt(3)/2 sqrt(a_i a_j^3)
 *   W T   1/(8 pi) times 8 pi sqrt(a_i^3 a_j^3)        W F   sqrt(3)/2 sqrt(a_i^3 a_j) */
static void unit_block(const sd_law *law, const sd_spheres *s, int i, int j, int width, double *A,
                       long lda)
{
  const double *xi = s->x + 3 * (long) i, *xj = s->x + 3 * (long) j, ai = s->a[i], aj = s->a[j];
  const double r[3] = {xi[0] - xj[0], xi[1] - xj[1], xi[2] - xj[2]};
  const double R = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]), inv = R > 0.0 ? 1.0 / R : 0.0;
  const double h[3] = {r[0] * inv, r[1] * inv, r[2] * inv};
  double f, g;
  if (law->tensor == SD_TENSOR_RPY)
    sd_rpy_radial(R, ai, aj, &f, &g);
  else
    sd_oseen_radial(R, &f, &g);
  const double c = sqrt(ai * aj) * sd_taper_factor(law, R);
  put_isotropic(c, f, g, h, A, lda);
  if (width == 3) return;
  const double half_root_3 = 0.86602540378443864676;
  sd_rpy_radial_wt(R, ai, aj, &f, &g);
  put_isotropic(c * ai * aj, f, g, h, A + 3 + 3 * lda, lda);
  put_cross(half_root_3 * c * aj * sd_rpy_radial_wf(R, aj, ai), h, A + 3 * lda, lda);
  put_cross(half_root_3 * c * ai * sd_rpy_radial_wf(R, ai, aj), h, A + 3, lda);
}

/* Lower triangle of C of the spheres member[0 ... m-1], with 1 + extra on the diagonal. */
static void fill(const sd_law *law, const sd_spheres *s, const int *member, int m, int width,
                 double extra, double *A)
{
  const long lda = width * (long) m;
  for (int j = 0; j < m; j++)
    for (int i = j; i < m; i++) {
      double *block = A + width * i + lda * (width * j);
      if (i != j) {
        unit_block(law, s, member[i], member[j], width, block, lda);
        continue;
      }
      for (int q = 0; q < width; q++)
        for (int p = 0; p < width; p++) block[p + lda * q] = p == q ? 1.0 + extra : 0.0;
    }
}

sd_status sd_unit_cholesky(const sd_law *law, const sd_spheres *s, const int *member, int m,
                           int width, double *A)
{
  static const double extra[] = {0.0, 1e-12, 1e-9, 1e-6};
  const int size = width * m;
  for (int k = 0; k < 4; k++) {
    int info;
    fill(law, s, member, m, width, extra[k], A);
    dpotrf_("L", &size, A, &size, &info);
    if (info == 0) {
      /* A NaN need not stop dpotrf; it always reaches the last pivot. */
      const double last = A[(long) size * size - 1];
      return last > 0.0 && last < INFINITY ? SD_OK : SD_ENOTFINITE;
    }
    if (!(A[(info - 1) * ((long) size + 1)] < INFINITY)) return SD_ENOTFINITE;
  }
  return SD_EINDEFINITE;
}
