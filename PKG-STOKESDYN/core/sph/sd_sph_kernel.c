#include "sd_sph_kernel.h"

#include "sd_constants.h"

/* N = 1 / integral of K over the support: 4 pi integral of K q^2 dq in three dimensions, 2 pi
 * integral of K q dq in two. Exact fractions; the compiler divides. */
double sd_sph_norm(sd_sph_kernel kernel, int dimension)
{
  if (kernel == SD_SPH_CUBICSPLINE)
    return dimension == 3 ? 1.0 / (4.0 * SD_PI) : 5.0 / (14.0 * SD_PI);
  return dimension == 3 ? 21.0 / (16.0 * SD_PI) : 7.0 / (4.0 * SD_PI);
}

double sd_sph_K(sd_sph_kernel kernel, double q)
{
  if (q >= 2.0) return 0.0;
  if (kernel == SD_SPH_CUBICSPLINE) {
    const double outer = 2.0 - q, inner = q < 1.0 ? 1.0 - q : 0.0;
    return outer * outer * outer - 4.0 * inner * inner * inner;
  }
  const double t = 1.0 - 0.5 * q;
  return t * t * t * t * (2.0 * q + 1.0);
}

/* G = K'(q) / q. Wendland: K' = -5 q (1-q/2)^3. Cubic spline, q < 1: K' = -3 (2-q)^2 + 12 (1-q)^2 =
 * 9 q^2 - 12 q; so neither divides by q where q may be 0. */
double sd_sph_G(sd_sph_kernel kernel, double q)
{
  if (q >= 2.0) return 0.0;
  if (kernel == SD_SPH_CUBICSPLINE)
    return q < 1.0 ? 9.0 * q - 12.0 : -3.0 * (2.0 - q) * (2.0 - q) / q;
  const double t = 1.0 - 0.5 * q;
  return -5.0 * t * t * t;
}

/* h^n for n = 2 .. 5 */
static double kernel_power(double h, int n)
{
  double p = 1.0;
  while (n-- > 0) p *= h;
  return p;
}

double sd_sph_W(sd_sph_kernel kernel, int dimension, double r, double h)
{
  return sd_sph_norm(kernel, dimension) / kernel_power(h, dimension) * sd_sph_K(kernel, r / h);
}

double sd_sph_dW_over_r(sd_sph_kernel kernel, int dimension, double r, double h)
{
  return sd_sph_norm(kernel, dimension) / kernel_power(h, dimension + 2) * sd_sph_G(kernel, r / h);
}
