#include "sd_vans_yade.h"
#include "sd_vans_internal.h"

#include <math.h>
#include <string.h>

enum { ORDER = SD_VANS_FRICTION_TERMS };

sd_vans_reach sd_vans_yade_slices(const sd_vans_mesh *mesh, double z, double a, double *V)
{
  const double height = z - mesh->z_ref, dz = mesh->dz;
  const double centre = floor(height / dz), offset = height - centre * dz;
  const double lowest = fmax(floor((height - a) / dz), 0.0),
               highest = fmin(floor((height + a) / dz), mesh->ncell - 1.0);
  if (!(lowest <= highest)) return (sd_vans_reach){0, 0, V};
  const int count = (int) (highest - lowest) + 1;
  for (int k = 0; k < count; k++) {
    const double above = lowest + k - centre;
    double s0 = (above - 1.0) * dz + offset, s1 = above * dz + offset;
    if (s0 < -a) s0 = -a;
    if (s1 > a) s1 = a;
    V[k] = SD_PI * (a * a * (s1 - s0) - (s1 * s1 * s1 - s0 * s0 * s0) / 3.0);
  }
  return (sd_vans_reach){(int) lowest, count, V};
}

void sd_vans_yade_add_slices(double *sums, const sd_vans_reach *reach, const double *v, const double *drag,
                             double *centre)
{
  const double *V = reach->V;
  for (int k = 0; k < reach->count; k++) {
    double *here = sums + (long) (reach->first + k) * SD_VANS_ROWS;
    here[SD_VANS_PHI] += V[k];
    here[SD_VANS_DRAG] += V[k] * drag[k];
    if (!centre) continue;
    for (int d = 0; d < 3; d++) centre[SD_VANS_VX + d] += V[k] * v[d];
  }
}

int64_t sd_vans_yade_steps(double T, double dt)
{
  int64_t n = 0;
  for (double t = 0.0; t < T; t += dt) n++;
  return n;
}

double sd_vans_yade_coefficient(const sd_vans_fluid *fluid, int n, double drag, double slip)
{
  return n == 0 ? 0.0 : drag / fmax(fabs(slip), fluid->least_slip) / fluid->rho;
}

/* How far in s a step of the substitution, by which ln f of slope `before` becomes one of `slope`,
 * surely ends as it does here: with |change| on this side of 1 %, a factor of 2 to spare. */
static double reach_of_end(double change, double slope, double before)
{
  return 0.5 * fabs(fabs(change) - 1e-2) / fabs((1.0 + change) * (slope - before));
}

/* In the arithmetic of the original step by step: for Re of 0.6 to 5 the substitution wanders, and
 * another rounding may be another answer. The series holds as far as every step ends as it does at
 * Re, and nowhere where r is near 0. */
void sd_vans_yade_friction(double Re, sd_vans_friction *near)
{
  double f = 1.0 / (SD_VANS_SMOOTH * SD_VANS_SMOOTH), r[ORDER] = {SD_VANS_SMOOTH}, q[ORDER] = {0};
  near->reach = 1e-3;
  for (int m = 1; m <= 100; m++) {
    const double before = q[1];
    r[0] = 2.0 * log(Re * sqrt(f)) + SD_VANS_SMOOTH;
    const double next = 1.0 / (r[0] * r[0]), change = (next - f) / f;
    for (int n = 1; n < ORDER; n++) r[n] = 2.0 * (sd_vans_log_series[n] - q[n]);
    for (int n = 1; n < ORDER; n++) q[n] = (r[n] - sd_vans_lower_terms(n, q, r)) / r[0];
    near->reach = fmin(near->reach, reach_of_end(change, -2.0 * q[1], -2.0 * before));
    if (fabs(r[0]) < 0.5) near->reach = 0.0;
    f = next;
    if (fabs(change) >= 1e-2) continue;
    sd_vans_inverse_square(r, q, near);
    near->f[0] = f;
    return;
  }
  memset(near->f, 0, sizeof near->f);
}
