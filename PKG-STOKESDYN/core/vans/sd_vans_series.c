#include "sd_vans_internal.h"

enum { ORDER = SD_VANS_FRICTION_TERMS };

const double sd_vans_log_series[ORDER] = {0.0, 1.0, -1.0 / 2.0, 1.0 / 3.0};

double sd_vans_lower_terms(int n, const double *q, const double *r)
{
  double sum = 0.0;
  for (int k = 1; k < n; k++) sum += k * q[k] * r[n - k];
  return sum / n;
}

/* n f_n = -2 sum k q_k f_(n-k). The next term is about (K s)^4 f_0 with K from f_2 = K^2 f_0 or
 * f_3 = K^3 f_0. */
void sd_vans_inverse_square(const double *r, const double *q, sd_vans_friction *near)
{
  double *f = near->f;
  f[0] = 1.0 / (r[0] * r[0]);
  for (int n = 1; n < ORDER; n++) {
    f[n] = 0.0;
    for (int k = 1; k <= n; k++) f[n] -= 2.0 * k / n * q[k] * f[n - k];
  }
  const double K = fmax(sqrt(fabs(f[2]) / f[0]), cbrt(fabs(f[3]) / f[0]));
  near->reach = fmin(near->reach, 3e-4 / K);
}
