#include "sd_sph_pair.h"

sd_sph_coefficients sd_sph_coefficients_of(sd_sph_kernel kernel, int dimension,
                                           const sd_sph_parameters *p, double mu)
{
  const double h = p->h, volume = dimension == 3 ? h * h * h : h * h,
               N = sd_sph_norm(kernel, dimension);
  const double K = sd_sph_K(kernel, p->deltap / h);
  return (sd_sph_coefficients){.inv_h = 1.0 / h,
                               .grad = N / (volume * h * h),
                               .weight = N / volume,
                               .a1 = 2.0 * p->alpha * p->c * h,
                               .b1 = 2.0 * p->beta * h * h,
                               .tens = K > 0.0 ? 1.0 / K : 0.0,
                               .visc = 2.0 * mu,
                               .support = 2.0 * h,
                               .ch = p->c > 0.0 ? p->c * h : 0.0};
}

/* Far enough that every kernel is 0, near enough that the square of the distance is finite. */
static const double FAR = 1e100;

void sd_sph_pack_x(int n, const double *x, const double *v, double shift, double *x4)
{
  if (shift != 0.0)
    for (int i = 0; i < n; i++)
      for (int d = 0; d < 3; d++)
        x4[4 * (size_t) i + d] = x[3 * (size_t) i + d] + shift * v[3 * (size_t) i + d];
  else
    for (int i = 0; i < n; i++)
      for (int d = 0; d < 3; d++) x4[4 * (size_t) i + d] = x[3 * (size_t) i + d];
  for (int d = 0; d < 3; d++) x4[4 * (size_t) n + d] = FAR;
  x4[4 * (size_t) n + 3] = 0.0;
}

void sd_sph_pack_v(int n, const double *v, const double *rho, double *v4)
{
  for (int i = 0; i < n; i++) {
    for (int d = 0; d < 3; d++) v4[4 * (size_t) i + d] = v[3 * (size_t) i + d];
    v4[4 * (size_t) i + 3] = rho[i];
  }
  for (int d = 0; d < 3; d++) v4[4 * (size_t) n + d] = 0.0;
  v4[4 * (size_t) n + 3] = 1.0;
}

static const sd_sph_loops *loops(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return &sd_sph_loops_avx2;
#endif
  return &sd_sph_loops_any;
}

double sd_sph_forces(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                     int rates, double *f4, double *each)
{
  return loops()->forces(model, list, p, rates, f4, each);
}

void sd_sph_rates(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                  double *rate, const sd_sph_near *near)
{
  loops()->rates(model, list, p, rate, near);
}
