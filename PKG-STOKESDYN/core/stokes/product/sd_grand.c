#include "sd_grand.h"

/* u [6] += w_j times the block, over 24 pi: translation needs 4 of that (6 pi), rotation 3 (8 pi). */
static inline void add_pair(const sd_law *law, const double *xi, double ai, const double *xj,
                            double aj, double wj, const double *F, double u[6])
{
  const double dx = xi[0] - xj[0], dy = xi[1] - xj[1], dz = xi[2] - xj[2];
  const double R = sqrt(dx * dx + dy * dy + dz * dz), inv = R > 0.0 ? 1.0 / R : 0.0;
  const double hx = dx * inv, hy = dy * inv, hz = dz * inv;
  const double *T = F + 3;
  double f, g, fw, gw;
  if (law->taper != SD_TAPER_NONE) wj *= sd_taper_factor(law, R);
  sd_rpy_radial(R, ai, aj, &f, &g);
  sd_rpy_radial_wt(R, ai, aj, &fw, &gw);
  f *= 4.0 * wj;
  fw *= 3.0 * wj;
  const double cij = 3.0 * wj * sd_rpy_radial_wf(R, ai, aj),
               cji = 3.0 * wj * sd_rpy_radial_wf(R, aj, ai);
  const double along = 4.0 * wj * g * (hx * F[0] + hy * F[1] + hz * F[2]);
  const double twist = 3.0 * wj * gw * (hx * T[0] + hy * T[1] + hz * T[2]);
  u[0] += f * F[0] + along * hx + cji * (T[1] * hz - T[2] * hy);
  u[1] += f * F[1] + along * hy + cji * (T[2] * hx - T[0] * hz);
  u[2] += f * F[2] + along * hz + cji * (T[0] * hy - T[1] * hx);
  u[3] += fw * T[0] + twist * hx + cij * (F[1] * hz - F[2] * hy);
  u[4] += fw * T[1] + twist * hy + cij * (F[2] * hx - F[0] * hz);
  u[5] += fw * T[2] + twist * hz + cij * (F[0] * hy - F[1] * hx);
}

static inline void store(double w, const double sum[6], double *u)
{
  for (int k = 0; k < 6; k++) u[k] = w / (24.0 * SD_PI) * sum[k];
}

void sd_product_grand_list(const sd_law *law, const sd_spheres *s, const sd_pairs *pairs,
                           const double *F, double *u)
{
  for (int i = 0; i < pairs->n; i++) {
    double sum[6] = {0.0};
    if (s->a[i] > 0.0)
      for (long k = pairs->first[i]; k < pairs->first[i + 1]; k++) {
        const long j = pairs->neighbor[k];
        if (s->a[j] > 0.0)
          add_pair(law, s->x + 3 * (long) i, s->a[i], s->x + 3 * j, s->a[j], s->w[j], F + 6 * j,
                   sum);
      }
    store(s->w[i], sum, u + 6 * (long) i);
  }
}

void sd_product_grand_all(const sd_law *law, const sd_spheres *s, int n_all, int begin, int n,
                          const double *F, double *u)
{
  for (int t = 0; t < n; t++) {
    const long i = begin + t;
    double sum[6] = {0.0};
    if (s->a[i] > 0.0)
      for (long j = 0; j < n_all; j++)
        if (j != i && s->a[j] > 0.0)
          add_pair(law, s->x + 3 * i, s->a[i], s->x + 3 * j, s->a[j], s->w[j], F + 6 * j, sum);
    store(s->w[i], sum, u + 6 * (long) t);
  }
}
