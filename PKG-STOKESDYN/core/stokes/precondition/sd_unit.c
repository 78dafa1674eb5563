#include "sd_precondition_internal.h"

#include <string.h>

#include "sd_linear.h"

void sd_unit_roots(const sd_spheres *s, int n, double *root)
{
  for (long i = 0; i < n; i++) {
    const double a = s->a[i];
    root[2 * i] = a > 0.0 ? sqrt(6.0 * SD_PI * a) / s->w[i] : 0.0;
    root[2 * i + 1] = a > 0.0 ? sqrt(8.0 * SD_PI * a) * a / s->w[i] : 0.0;
  }
}

/* B [width width], row-major, of M becomes that of C, times the taper: the roots of the diagonal are
 * (6 pi a)^1/2, and in rows of torques (8 pi a^3)^1/2 = (6 pi a)^1/2 a sqrt(4/3). */
static inline void scale(double ai, double aj, double taper, int width, double *B)
{
  const double force = 6.0 * SD_PI * sqrt(ai * aj) * taper, torque = 1.15470053837925152902;
  const double of_i[2] = {force, force * torque * ai}, of_j[2] = {1.0, torque * aj};
  for (int p = 0; p < width; p++)
    for (int q = 0; q < width; q++) B[width * p + q] *= of_i[p / 3] * of_j[q / 3];
}

/* Block of C of two spheres */
static inline void unit_block(const sd_law *law, const sd_spheres *s, int i, int j, int width,
                              double *B)
{
  const double ai = s->a[i], aj = s->a[j];
  double xi[3], xj[3], r[3], image[36];
  sd_wall_keep_off(&law->wall, s->x + 3 * (long) i, ai, xi);
  sd_wall_keep_off(&law->wall, s->x + 3 * (long) j, aj, xj);
  sd_minus(xi, xj, r);
  if (width == 6)
    sd_tensor_grand(r, ai, aj, 1.0, B);
  else
    sd_tensor_uf(law->tensor, r, ai, aj, 1.0, B);
  if (law->wall.sign) {
    sd_wall_block(&law->wall, width, xi, ai, xj, aj, 1.0, image);
    for (int e = 0; e < width * width; e++) B[e] += image[e];
  }
  const int tapered = law->taper != SD_TAPER_NONE;
  scale(ai, aj, tapered ? sd_taper_factor(law, sqrt(sd_dot(r, r))) : 1.0, width, B);
}

/* That of a sphere with itself, and a little on the diagonal */
static inline void own_block(const sd_law *law, const sd_spheres *s, int i, int width, double extra,
                             double *B)
{
  const double *x = s->x + 3 * (long) i, a = s->a[i];
  memset(B, 0, 36 * sizeof(double));
  if (law->wall.sign) {
    sd_wall_block(&law->wall, width, x, a, x, a, 1.0, B);
    scale(a, a, 1.0, width, B);
  }
  for (int p = 0; p < width; p++) B[(width + 1) * p] += 1.0 + extra;
}

/* Lower triangle of C of the spheres member[0 ... m-1], with 1 + extra on the diagonal; into one of
 * A, A_single. */
static inline void fill(const sd_law *law, const sd_spheres *s, const int *member, int m, int width,
                        double extra, double *A, float *A_single)
{
  const long lda = width * (long) m;
  double B[36];
  for (int j = 0; j < m; j++)
    for (int i = j; i < m; i++) {
      const long at = width * i + lda * (width * j);
      if (i == j)
        own_block(law, s, member[i], width, extra, B);
      else
        unit_block(law, s, member[i], member[j], width, B);
      for (int q = 0; q < width; q++)
        for (int p = 0; p < width; p++)
          if (A)
            A[at + p + lda * q] = B[width * p + q];
          else
            A_single[at + p + lda * q] = (float) B[width * p + q];
    }
}

/* The diagonal that is added is first none, then what rounding may have taken off an eigenvalue of
 * a large block; more than that is a matrix that is not definite by itself. Of width 3 and 6 the
 * compiler makes a copy each. */
sd_status sd_unit_cholesky(const sd_law *law, const sd_spheres *s, const int *member, int m,
                           int width, double *A)
{
  static const double extra[] = {0.0, 1e-12, 1e-9, 1e-6};
  /* Pivots below this are rounding, as those of equal spheres at one point are. */
  const double lost = 1e-7;
  const long size = width * (long) m;
  for (int k = 0; k < 4; k++) {
    if (width == 3)
      fill(law, s, member, m, 3, extra[k], A, 0);
    else
      fill(law, s, member, m, 6, extra[k], A, 0);
    sd_status status = sd_cholesky((int) size, A);
    for (long p = 0; p < size && status == SD_OK; p++)
      if (!(A[p * (size + 1)] > lost)) status = SD_ESINGULAR;
    if (status != SD_ESINGULAR) return status;
  }
  return SD_EINDEFINITE;
}

sd_status sd_unit_cholesky_single(const sd_law *law, const sd_spheres *s, const int *member, int m,
                                  int width, float *A)
{
  /* Pivots below this have lost most of their digits. */
  const float lost = 0.003f;
  const long size = width * (long) m;
  if (width == 3)
    fill(law, s, member, m, 3, 0.0, 0, A);
  else
    fill(law, s, member, m, 6, 0.0, 0, A);
  const sd_status status = sd_cholesky_single((int) size, A);
  for (long p = 0; p < size && status == SD_OK; p++)
    if (!(A[p * (size + 1)] > lost)) return SD_ESINGULAR;
  return status;
}
