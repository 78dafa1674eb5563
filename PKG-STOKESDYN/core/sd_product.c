#include "sd_product.h"

/* u += 1/(6 pi) w_i w_j [ f F + g rhat (rhat.F) ]; the factor w_i/(6 pi) is applied once per target. */
static inline void add_pair(sd_tensor kind, const double *xi, double ai, const double *xj,
                            double aj, double wj, const double *F, double u[3])
{
  const double dx = xi[0] - xj[0], dy = xi[1] - xj[1], dz = xi[2] - xj[2];
  const double R = sqrt(dx * dx + dy * dy + dz * dz);
  double f, g;
  if (kind == SD_TENSOR_RPY)
    sd_rpy_radial(R, ai, aj, &f, &g);
  else
    sd_oseen_radial(R, &f, &g);
  const double inv = R > 0.0 ? 1.0 / R : 0.0;
  const double ex = dx * inv, ey = dy * inv, ez = dz * inv;
  const double c = wj * g * (ex * F[0] + ey * F[1] + ez * F[2]);
  f *= wj;
  u[0] += f * F[0] + c * ex;
  u[1] += f * F[1] + c * ey;
  u[2] += f * F[2] + c * ez;
}

static inline void store(double w, const double sum[3], double *u)
{
  const double scale = w / (6.0 * SD_PI);
  u[0] = scale * sum[0];
  u[1] = scale * sum[1];
  u[2] = scale * sum[2];
}

void sd_product_list(sd_tensor kind, const sd_spheres *s, const sd_pairs *pairs, const double *F,
                     double *u)
{
  for (int i = 0; i < pairs->n; i++) {
    double sum[3] = {0.0, 0.0, 0.0};
    for (long k = pairs->first[i]; k < pairs->first[i + 1]; k++) {
      const int j = pairs->neighbor[k];
      add_pair(kind, s->x + 3 * (long) i, s->a[i], s->x + 3 * (long) j, s->a[j], s->w[j],
               F + 3 * (long) j, sum);
    }
    store(s->w[i], sum, u + 3 * (long) i);
  }
}

void sd_product_all(sd_tensor kind, const sd_spheres *s, int n_all, int begin, int n,
                    const double *F, double *u)
{
  for (int t = 0; t < n; t++) {
    const int i = begin + t;
    double sum[3] = {0.0, 0.0, 0.0};
    if (s->a[i] > 0.0)
      for (int j = 0; j < n_all; j++)
        if (j != i && s->a[j] > 0.0)
          add_pair(kind, s->x + 3 * (long) i, s->a[i], s->x + 3 * (long) j, s->a[j], s->w[j],
                   F + 3 * (long) j, sum);
    store(s->w[i], sum, u + 3 * (long) t);
  }
}

void sd_pairs_within(const sd_pairs *candidates, const sd_spheres *s, double cutoff, long *first,
                     int *neighbor)
{
  const double cutsq = cutoff * cutoff;
  long count = 0;
  for (int i = 0; i < candidates->n; i++) {
    first[i] = count;
    if (!(s->a[i] > 0.0)) continue;
    const double *xi = s->x + 3 * (long) i;
    for (long k = candidates->first[i]; k < candidates->first[i + 1]; k++) {
      const int j = candidates->neighbor[k];
      const double *xj = s->x + 3 * (long) j;
      const double dx = xi[0] - xj[0], dy = xi[1] - xj[1], dz = xi[2] - xj[2];
      if (s->a[j] > 0.0 && dx * dx + dy * dy + dz * dz <= cutsq) neighbor[count++] = j;
    }
  }
  first[candidates->n] = count;
}
