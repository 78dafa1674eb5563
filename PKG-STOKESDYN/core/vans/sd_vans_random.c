#include "sd_vans_random.h"

#include "sd_constants.h"
#include "sd_hash.h"

#include <math.h>

static double uniform(uint64_t key, uint64_t k) /* in (0, 1) */
{
  return sd_hash_unit(sd_hash_mix(key + (k + 1) * SD_HASH_STEP)) + 0x1p-54;
}

/* The three keys are mixed one into the other, so that neighbours in any of them share nothing; no
 * state is kept, and a grain has the same numbers wherever it is and whoever asks. */
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
  /* -a in u'x with a in u'z: fast water comes from above, <u'x u'z> = -u_star^2 */
  u[0] = (correlated ? normal[2] - normal[0] : normal[2]) * u_star;
  u[1] = normal[1] * u_star;
  u[2] = normal[0] * u_star;
}

double sd_vans_eddy_life(double z_above_bed, double nu, double u_star, double longest, double dt)
{
  if (!(u_star > 0.0)) return 10.0 * dt; /* nothing moves: look again later */
  /* Lagrangian time 0.33 l/u_star of an eddy l = 0.41 z; in the viscous sublayer its edge */
  return fmin(0.33 * 0.41 * fmax(z_above_bed, 11.6 * nu / u_star) / u_star, longest);
}

double sd_vans_longest_life(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid,
                            const double *stress)
{
  if (fluid->rules == SD_VANS_YADE) return fluid->longest_life;
  const double H = mesh->edge[mesh->ncell - 1];
  const double drive = fabs(fluid->gx - fluid->dpdx / fluid->rho) * H;
  const double u_star = sqrt(fmax(drive, sd_vans_largest_stress(mesh, stress) / fluid->rho));
  return u_star > 0.0 ? 30.0 * H / u_star : HUGE_VAL;
}

void sd_vans_new_eddy(const sd_vans_mesh *mesh, double nu, const sd_vans_walk *walk, double z,
                      uint64_t id, sd_vans_eddy *eddy, double u[3])
{
  const int p = sd_vans_slice_of(mesh, z), inside = p >= 0 && p < mesh->ncell;
  const double height = z - mesh->z_ref - walk->bed,
               u_star = inside && height > 0.0 ? walk->u_star[p] : 0.0;
  double normal[3];
  sd_vans_normal3(walk->seed, id, (uint64_t) eddy->count, normal);
  sd_vans_fluctuation(normal, u_star, walk->correlated, u);
  eddy->count += 1.0;
  eddy->life = sd_vans_eddy_life(height, nu, u_star, walk->longest, walk->dt);
}
