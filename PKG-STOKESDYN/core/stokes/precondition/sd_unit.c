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

/* B [6 x 6], column-major: c [f I + g h h^T] in three rows and columns from B on */
static inline void put_isotropic(double c, double f, double g, const double h[3], double *B)
{
  for (int q = 0; q < 3; q++)
    for (int p = 0; p < 3; p++) B[p + 6 * q] = c * (g * h[p] * h[q] + (p == q ? f : 0.0));
}

/* The matrix of v -> c v x h */
static inline void put_cross(double c, const double h[3], double *B)
{
  for (int q = 0; q < 3; q++) {
    const int e = (q + 1) % 3, f = (q + 2) % 3;
    B[q + 6 * q] = 0.0;
    B[e + 6 * q] = -c * h[f];
    B[f + 6 * q] = c * h[e];
  }
}

/* A sphere, kept off a wall */
typedef struct {
  double x[3], a;
} standing;

static inline standing standing_at(const sd_law *law, const sd_spheres *s, int i)
{
  standing at = {.a = s->a[i]};
  sd_wall_keep_off(&law->wall, s->x + 3 * (long) i, at.a, at.x);
  return at;
}

/* The roots of its D */
static void roots_of(double a, double root[2])
{
  root[0] = sqrt(6.0 * SD_PI * a);
  root[1] = sqrt(8.0 * SD_PI * a) * a;
}

/* What a wall adds to the block of two spheres */
static void un_add_image(const sd_wall *wall, const standing *i, const standing *j, double taper, int width,
                         double B[36])
{
  double M[36], root_i[2], root_j[2];
  roots_of(i->a, root_i);
  roots_of(j->a, root_j);
  sd_wall_block(wall, width, i->x, i->a, j->x, j->a, M);
  for (int p = 0; p < width; p++)
    for (int q = 0; q < width; q++)
      B[p + 6 * q] += taper * root_i[p / 3] * root_j[q / 3] * M[width * p + q];
}

/* Block of C into B [6 x 6], column-major, of which width 3 uses a corner. The pair tensors of
 * sd_tensor.h, times the roots of the diagonal:
 *   U F   1/(6 pi) times 6 pi sqrt(a_i a_j)
 *   U T   1/(8 pi) times sqrt(6 a_i 8 a_j^3) pi = sqrt(3)/2 sqrt(a_i a_j^3);  W F  sqrt(3)/2 sqrt(a_i^3 a_j)
 *   W T   1/(8 pi) times 8 pi sqrt(a_i^3 a_j^3) */
static inline void unit_block(const sd_law *law, const sd_spheres *s, int i, int j, int width,
                              double B[36])
{
  const standing one = standing_at(law, s, i), other = standing_at(law, s, j);
  const double ai = one.a, aj = other.a;
  double r[3];
  sd_minus(one.x, other.x, r);
  const double R = sqrt(sd_dot(r, r)), inv = R > 0.0 ? 1.0 / R : 0.0;
  const double h[3] = {r[0] * inv, r[1] * inv, r[2] * inv};
  double f, g;
  sd_tensor_radial(law->tensor, R, ai, aj, &f, &g);
  const double taper = law->taper == SD_TAPER_NONE ? 1.0 : sd_taper_factor(law, R);
  const double c = sqrt(ai * aj) * taper;
  put_isotropic(c, f, g, h, B);
  if (width == 6) {
    const double half_root_3 = 0.86602540378443864676;
    sd_rpy_radial_wt(R, ai, aj, &f, &g);
    put_isotropic(c * ai * aj, f, g, h, B + 3 + 6 * 3);
    put_cross(half_root_3 * c * aj * sd_rpy_radial_wf(R, aj, ai), h, B + 6 * 3);
    put_cross(half_root_3 * c * ai * sd_rpy_radial_wf(R, ai, aj), h, B + 3);
  }
  if (law->wall.sign) un_add_image(&law->wall, &one, &other, taper, width, B);
}

/* That of a sphere with itself, and a little on the diagonal */
static inline void un_own_block(const sd_law *law, const sd_spheres *s, int i, int width, double extra,
                                double B[36])
{
  memset(B, 0, 36 * sizeof(double));
  for (int p = 0; p < width; p++) B[7 * p] = 1.0 + extra;
  if (!law->wall.sign) return;
  const standing own = standing_at(law, s, i);
  un_add_image(&law->wall, &own, &own, 1.0, width, B);
}

/* Its lower triangle, with 1 + extra on the diagonal; into one of A, A_single. width: that of c, by which
 * the compiler makes a copy each. */
static inline void un_fill(const sd_unit_submatrix *c, int width, double extra, double *A, float *A_single)
{
  const sd_law *law = c->law;
  const sd_spheres *s = c->spheres;
  const int *member = c->member, m = c->m;
  const long lda = width * (long) m;
  double B[36];
  for (int j = 0; j < m; j++)
    for (int i = j; i < m; i++) {
      const long at = width * i + lda * (width * j);
      if (i == j)
        un_own_block(law, s, member[i], width, extra, B);
      else
        unit_block(law, s, member[i], member[j], width, B);
      for (int q = 0; q < width; q++)
        for (int p = 0; p < width; p++)
          if (A)
            A[at + p + lda * q] = B[p + 6 * q];
          else
            A_single[at + p + lda * q] = (float) B[p + 6 * q];
    }
}

/* The diagonal that is added is first none, then what rounding may have taken off an eigenvalue of
 * a large block; more than that is a matrix that is not definite by itself. */
sd_status sd_unit_cholesky(const sd_unit_submatrix *c, double *A)
{
  static const double extra[] = {0.0, 1e-12, 1e-9, 1e-6};
  for (int k = 0; k < 4; k++) {
    if (c->width == 3)
      un_fill(c, 3, extra[k], A, 0);
    else
      un_fill(c, 6, extra[k], A, 0);
    const sd_status status = sd_cholesky(c->width * c->m, A);
    if (status != SD_ESINGULAR) return status;
  }
  return SD_EINDEFINITE;
}

sd_status sd_unit_cholesky_single(const sd_unit_submatrix *c, float *A)
{
  /* Pivots below this have lost most of their digits. */
  const float lost = 0.003f;
  const long size = c->width * (long) c->m;
  if (c->width == 3)
    un_fill(c, 3, 0.0, 0, A);
  else
    un_fill(c, 6, 0.0, 0, A);
  const sd_status status = sd_cholesky_single((int) size, A);
  for (long p = 0; p < size && status == SD_OK; p++)
    if (!(A[p * (size + 1)] > lost)) return SD_ESINGULAR;
  return status;
}
