#include "sd_unit.h"

/* LAPACK: Cholesky factor of the lower triangle (column-major). */
void dpotrf_(const char *uplo, const int *n, double *A, const int *lda, int *info);

/* Block of C, unit diagonal, into A (column-major, leading dimension lda), symmetric 3x3. */
static void unit_block(const sd_law *law, const sd_spheres *s, int i, int j, double *A, long lda)
{
  const double *xi = s->x + 3 * (long) i, *xj = s->x + 3 * (long) j;
  const double r[3] = {xi[0] - xj[0], xi[1] - xj[1], xi[2] - xj[2]};
  const double R = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
  double f, g;
  if (law->tensor == SD_TENSOR_RPY)
    sd_rpy_radial(R, s->a[i], s->a[j], &f, &g);
  else
    sd_oseen_radial(R, &f, &g);
  const double c = sqrt(s->a[i] * s->a[j]) * sd_taper_factor(law, R), inv = R > 0.0 ? 1.0 / R : 0.0;
  for (int q = 0; q < 3; q++)
    for (int p = 0; p < 3; p++)
      A[p + lda * q] = c * (g * (r[p] * inv) * (r[q] * inv) + (p == q ? f : 0.0));
}

/* Lower triangle of C of the spheres member[0 ... m-1], with 1 + extra on the diagonal. */
static void fill(const sd_law *law, const sd_spheres *s, const int *member, int m, double extra,
                 double *A)
{
  const long lda = 3 * (long) m;
  for (int j = 0; j < m; j++)
    for (int i = j; i < m; i++) {
      double *block = A + 3 * i + lda * (3 * j);
      if (i != j) {
        unit_block(law, s, member[i], member[j], block, lda);
        continue;
      }
      for (int q = 0; q < 3; q++)
        for (int p = 0; p < 3; p++) block[p + lda * q] = p == q ? 1.0 + extra : 0.0;
    }
}

sd_status sd_unit_cholesky(const sd_law *law, const sd_spheres *s, const int *member, int m,
                           double *A)
{
  static const double extra[] = {0.0, 1e-12, 1e-9, 1e-6};
  const int size = 3 * m;
  for (int k = 0; k < 4; k++) {
    int info;
    fill(law, s, member, m, extra[k], A);
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

void sd_torques(int width, const double *drag, const double *spin, int n, const double *r,
                double *z)
{
  if (width != 6) return;
  for (int i = 0; i < n; i++)
    for (int k = 3; k < 6; k++)
      z[6 * (long) i + k] = drag[i] == 0.0 ? 0.0 : spin[i] * r[6 * (long) i + k];
}
