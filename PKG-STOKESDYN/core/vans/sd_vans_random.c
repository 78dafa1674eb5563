#include "sd_vans.h"

#include <math.h>

/* Finaliser of SplitMix64 (Steele, Lea & Flood 2014): a bijection of 64 bits in which every input bit reaches every output
 * bit. */
static uint64_t mix(uint64_t x)
{
  x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
  return x ^ (x >> 31);
}

static double uniform(uint64_t key, uint64_t k) /* in (0, 1) */
{
  return ((double) (mix(key + (k + 1) * UINT64_C(0x9e3779b97f4a7c15)) >> 11) + 0.5) * 0x1p-53;
}

void sd_vans_normal3(uint64_t seed, uint64_t id, uint64_t count, double out[3])
{
  const uint64_t key = mix(mix(mix(seed + UINT64_C(0x9e3779b97f4a7c15)) ^ id) +
                           count * UINT64_C(0xd1342543de82ef95));
  /* Box & Muller: two pairs, of which one number is not used. */
  const double r1 = sqrt(-2.0 * log(uniform(key, 0))), r2 = sqrt(-2.0 * log(uniform(key, 2)));
  const double t1 = 2.0 * 3.14159265358979323846 * uniform(key, 1),
               t2 = 2.0 * 3.14159265358979323846 * uniform(key, 3);
  out[0] = r1 * cos(t1);
  out[1] = r1 * sin(t1);
  out[2] = r2 * cos(t2);
}

void sd_vans_fluctuation(const double normal[3], double u_star, int correlated, double u[3])
{
  u[0] = (correlated ? normal[2] - normal[0] : normal[2]) * u_star;
  u[1] = normal[1] * u_star;
  u[2] = normal[0] * u_star;
}

double sd_vans_eddy_life(double z_above_bed, double nu, double u_star, double dt)
{
  if (!(u_star > 0.0)) return 10.0 * dt;
  return fmin(0.33 * 0.41 * fmax(z_above_bed, 11.6 * nu / u_star) / u_star, 10.0);
}
