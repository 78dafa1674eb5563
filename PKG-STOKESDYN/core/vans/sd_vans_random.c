#include "sd_vans.h"

#include "sd_constants.h"
#include "sd_hash.h"

#include <math.h>

static double uniform(uint64_t key, uint64_t k) /* in (0, 1) */
{
  return sd_hash_unit(sd_hash_mix(key + (k + 1) * SD_HASH_STEP)) + 0x1p-54;
}

void sd_vans_normal3(uint64_t seed, uint64_t id, uint64_t count, double out[3])
{
  const uint64_t key = sd_hash_mix(sd_hash_mix(sd_hash_mix(seed + SD_HASH_STEP) ^ id) +
                                   count * UINT64_C(0xd1342543de82ef95));
  /* Box & Muller: two pairs, of which one number is not used. */
  const double r1 = sqrt(-2.0 * log(uniform(key, 0))), r2 = sqrt(-2.0 * log(uniform(key, 2)));
  const double t1 = 2.0 * SD_PI * uniform(key, 1), t2 = 2.0 * SD_PI * uniform(key, 3);
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

double sd_vans_eddy_life(double z_above_bed, double nu, double u_star, double longest, double dt)
{
  if (!(u_star > 0.0)) return 10.0 * dt;
  return fmin(0.33 * 0.41 * fmax(z_above_bed, 11.6 * nu / u_star) / u_star, longest);
}
