#include "sd_vans_random.h"

#include "sd_random.h"

#include <float.h>
#include <math.h>

void sd_vans_normal3(uint64_t seed, uint64_t id, uint64_t count, double out[3])
{
  const sd_random_key key = {(uint32_t) seed, SD_RANDOM_EDDY, count};
  sd_random_normals(&key, id, 3, out);
}

void sd_vans_friction_velocities(const sd_vans_fluid *fluid, int n, const double *stress, double *u_star)
{
  for (int k = 0; k < n; k++) {
    const double size = fluid->rules == SD_VANS_YADE ? fmax(stress[k], 0.0) : fabs(stress[k]);
    u_star[k] = copysign(sqrt(size / fluid->rho), stress[k]);
  }
}

void sd_vans_fluctuation(const double normal[3], double u_star, int correlated, double u[3])
{
  /* -a in u'x with a in u'z: fast water comes from above, <u'x u'z> = -u_star^2 */
  u[0] = (correlated ? normal[2] - normal[0] : normal[2]) * u_star;
  u[1] = normal[1] * fabs(u_star);
  u[2] = normal[0] * fabs(u_star);
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
  const double drive = fabs(sd_vans_drive(fluid)) * H;
  const double u_star = sqrt(fmax(drive, fabs(sd_vans_largest_stress(mesh, stress)) / fluid->rho));
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
  eddy->life = sd_vans_eddy_life(height, nu, fabs(u_star), walk->longest, walk->dt);
}

void sd_vans_lagrangian_times(const sd_vans_mesh *mesh, double schmidt, const double *nut,
                              const double *u_star, double *life)
{
  /* next to the surface both may be next to nothing: a square that is 0, a quotient that is none */
  for (int n = 0; n < mesh->ncell; n++) {
    const double square = schmidt * u_star[n] * u_star[n];
    life[n] = square > 0.0 ? fmin(nut[n] / square, DBL_MAX) : 0.0;
  }
}

/* d |u_star|/dz in slice p, between the middles of its neighbours. */
static double slope_of(const sd_vans_mesh *mesh, const double *u_star, int p)
{
  const int low = p > 0 ? p - 1 : p, high = p < mesh->ncell - 1 ? p + 1 : p;
  const double *edge = mesh->edge;
  return (fabs(u_star[high]) - fabs(u_star[low])) /
      (0.5 * (edge[high] + edge[high + 1]) - 0.5 * (edge[low] + edge[low + 1]));
}

void sd_vans_langevin_step(const sd_vans_mesh *mesh, const sd_vans_langevin *walk, double z,
                           uint64_t id, sd_vans_wander *wander, double u[3])
{
  const int slice = sd_vans_slice_of(mesh, z), above = walk->water > 0 && slice >= walk->water,
            p = above ? walk->water - 1 : slice;
  const int here = p >= 0 && p < mesh->ncell && z - mesh->z_ref > walk->bed;
  const double u_star = here ? walk->u_star[p] : 0.0, T = here ? walk->life[p] : 0.0;
  /* over the step dt, with T as it is: y decays, the noise makes up for it, the slope adds up */
  const double kept = T > 0.0 ? exp(-walk->dt / T) : 0.0, noise = sqrt(1.0 - kept * kept);
  double *y = wander->normal, normal[3];
  sd_vans_normal3(walk->seed, id, (uint64_t) wander->count, normal);
  for (int d = 0; d < 3; d++) y[d] = kept * y[d] + noise * normal[d];
  if (T > 0.0 && kept > 0.0)
    y[0] -= slope_of(mesh, walk->u_star, p) * T * expm1(-walk->dt / T);
  if (above) y[0] = -fabs(y[0]);
  sd_vans_fluctuation(y, u_star, 1, u);
  wander->count += 1.0;
}
