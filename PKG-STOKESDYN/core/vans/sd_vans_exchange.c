#include "sd_sphere.h"
#include "sd_vans_yade.h"

#include <math.h>

/* n<f> of slice n: force per volume of mixture. Without the sum over grains phi / V of a grain
 * times the mean drag on a grain, which is right for grains of one size. */
static double drag_density(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid,
                           const sd_vans_means *grains, int n)
{
  const long N = mesh->ncell;
  const double *profile = grains->profile;
  if (grains->density) return grains->density[n];
  if (!grains->classes) return profile[n] / sd_sphere_volume(fluid->radius) * profile[SD_VANS_DRAG * N + n];
  double sum = 0.0;
  for (int c = 0; c < fluid->nclass; c++) {
    const double *of_class = grains->classes + c * SD_VANS_ROWS * N;
    sum += of_class[n] / sd_sphere_volume(fluid->class_radius[c]) * of_class[SD_VANS_DRAG * N + n];
  }
  return sum;
}

void sd_vans_exchange(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, double dt,
                      const double *U, const sd_vans_means *grains, double *b, double cut[2])
{
  const int N = mesh->ncell;
  const double *vx = grains->profile + (long) SD_VANS_VX * N, cap = 0.1 / dt;
  cut[0] = cut[1] = 0.0;
  for (int n = 0; n < N; n++) {
    const double drag = drag_density(mesh, fluid, grains, n), slip = U[n + 1] - vx[n];
    /* drag against the slip, or none: b would drive the water away from the grains. At most a tenth
     * of the slip goes in one step. */
    const double value = fluid->rules == SD_VANS_YADE
        ? sd_vans_yade_coefficient(fluid, n, drag, slip)
        : drag / slip / fluid->rho;
    b[n] = !(value > 0.0) ? 0.0 : value > cap ? cap : value;
    if (n == N - 1 || !isfinite(drag)) continue;
    cut[1] += fabs(drag) * sd_vans_height(mesh, n);
    if (b[n] > 0.0)
      cut[0] += (fabs(drag) - fluid->rho * b[n] * fabs(slip)) * sd_vans_height(mesh, n);
  }
}

/* n f/w over rho: the drag on one grain of slip w is f = factor w, there are phi/V grains in a
 * volume. */
static double rate_of(const sd_vans_fluid *fluid, double a, double phi, double slip,
                      double hindrance)
{
  const double factor =
      sd_drag_factor(fluid->drag, fluid->rho, fluid->eta, a, hindrance, fabs(slip));
  return phi / sd_sphere_volume(a) * factor / fluid->rho;
}

double sd_vans_drag_rate(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const double *U,
                         const double *hindrance, const double *profile, int *slice)
{
  const double *vx = profile + (long) SD_VANS_VX * mesh->ncell;
  double largest = 0.0;
  for (int n = 0; n < mesh->ncell - 1; n++) {
    const double rate = rate_of(fluid, fluid->radius, profile[n], U[n + 1] - vx[n], hindrance[n]);
    if (rate > largest) {
      largest = rate;
      *slice = n;
    }
  }
  return largest;
}

void sd_vans_exchange_by_law(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const double *U,
                             const double *hindrance, const sd_vans_means *grains, double *b,
                             double *rest)
{
  const long N = mesh->ncell;
  const double *profile = grains->profile, *classes = grains->classes;
  const double *vx = profile + SD_VANS_VX * N;
  for (int n = 0; n < N; n++) {
    const double slip = U[n + 1] - vx[n];
    b[n] = classes ? 0.0 : rate_of(fluid, fluid->radius, profile[n], slip, hindrance[n]);
    for (int c = 0; classes && c < fluid->nclass; c++) {
      const double phi = classes[c * SD_VANS_ROWS * N + n];
      b[n] += rate_of(fluid, fluid->class_radius[c], phi, slip, hindrance[n]);
    }
    rest[n] = b[n] * slip - drag_density(mesh, fluid, grains, n) / fluid->rho;
  }
}
