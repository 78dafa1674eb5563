#include "sd_sphere.h"
#include "sd_vans_internal.h"

#include <math.h>

/* Drag on grain i slice by slice. What lies outside the mesh sees the values of its ends. */
static void drag_by_volume(const sd_vans_ambient *stream, const sd_vans_grains *grains, int i, double F[3])
{
  const sd_vans_mesh *mesh = stream->mesh;
  const double a = grains->a[i], z = grains->x[3 * (long) i + 2], whole = 2.0 * primitive(a * a, a);
  sd_vans_part part = sd_vans_lowest_part(mesh, z, a);
  while (sd_vans_next_part(mesh, a, &part))
    sd_vans_add_drag(stream->law, grains, i, sd_vans_water_in(stream, part.n), part.V / whole, F);
}

/* Drag on grain i, centre in slice p. */
static void drag_on(const sd_vans_ambient *stream, const sd_vans_grains *grains, int i, int p, double F[3])
{
  F[0] = F[1] = F[2] = 0.0;
  if (stream->law->felt_by_volume)
    drag_by_volume(stream, grains, i, F);
  else
    sd_vans_add_drag(stream->law, grains, i, sd_vans_water_in(stream, p), 1.0, F);
}

/* Shear lift: dynamic pressure over the grain less that under it, with the water one radius above
 * and below its centre; nothing where one of the two is outside the water. */
static double lift_force(const sd_vans_ambient *stream, int p, double a, double vx)
{
  const sd_vans_mesh *mesh = stream->mesh;
  const sd_vans_force_law *law = stream->law;
  int upper, lower;
  /* a radius of a whole number of slices must not fall short of it by rounding */
  const double reach = law->rules == SD_VANS_YADE ? a : a * (1.0 + 1e-9);
  if (mesh->dz > 0.0) {
    const double k = floor(reach / mesh->dz);
    if (k > mesh->ncell) return 0.0;
    upper = p + (int) k;
    lower = p - (int) k;
  } else {
    upper = sd_vans_slice_of(mesh, mesh->z_ref + mesh->edge[p] + reach);
    lower = sd_vans_slice_of(mesh, mesh->z_ref + mesh->edge[p + 1] - reach);
  }
  if (upper >= mesh->ncell || lower <= 0) return 0.0;
  const double over = stream->U[upper + 1] - vx, under = stream->U[lower + 1] - vx;
  return 0.5 * law->rho * SD_PI * a * a * law->lift * (over * over - under * under);
}

double sd_vans_volume_of_grains(const sd_vans_grains *grains)
{
  double sum = 0.0;
  for (int i = 0; i < grains->n; i++)
    if (!grains->take || grains->take[i])
      sum += (grains->weight ? grains->weight[i] : 1.0) * sd_sphere_volume(grains->a[i]);
  return sum;
}

int sd_vans_forces(const sd_vans_ambient *stream, const sd_vans_grains *grains, double *F, double *drag_x)
{
  const sd_vans_mesh *mesh = stream->mesh;
  const sd_vans_force_law *law = stream->law;
  const unsigned char *take = grains->take;
  /* In a steady stream down a slope the pressure falls straight away from the bed: what gravity has
   * along x is carried by the stress, and grains have no buoyancy that way. */
  const double g[3] = {law->rest ? law->g[0] : 0.0, law->g[1], law->g[2]};
  int outside = 0;
  for (int i = 0; i < grains->n; i++) {
    double *Fi = F + 3 * (long) i;
    Fi[0] = Fi[1] = Fi[2] = 0.0; /* also of those that take no part */
    if (drag_x) drag_x[i] = 0.0;
    if (take && !take[i]) continue;
    const int p = sd_vans_slice_of(mesh, grains->x[3 * (long) i + 2]),
              inside = p >= 0 && p < mesh->ncell;
    if (!inside) outside++;
    if (!inside && law->rules == SD_VANS_YADE) continue;
    const double a = grains->a[i], displaced = sd_sphere_volume(a) * law->rho,
                 share = grains->weight ? grains->weight[i] : 1.0;
    drag_on(stream, grains, i, p, Fi);
    if (grains->acceleration)
      for (int d = 0; d < 3; d++)
        Fi[d] -= law->added_mass * displaced * grains->acceleration[3 * (long) i + d];
    if (law->rate)
      Fi[0] += law->added_mass * displaced * law->rate[p < 0 ? 0 : (inside ? p : mesh->ncell - 1) + 1];
    if (drag_x) drag_x[i] = share * Fi[0];
    for (int d = 0; d < 3; d++) Fi[d] -= displaced * g[d];
    Fi[0] -= displaced / law->rho * law->dpdx;
    if (inside && law->lift != 0.0)
      Fi[2] += lift_force(stream, p, a, grains->v[3 * (long) i]);
    if (inside && law->convective) Fi[0] -= law->convective[p];
    for (int d = 0; d < 3; d++) Fi[d] *= share;
  }
  return outside;
}

double sd_vans_stiffest(const sd_vans_ambient *stream, const sd_vans_grains *grains, const double *mass,
                        int *stiffest)
{
  const sd_vans_force_law *law = stream->law;
  double largest = 0.0;
  for (int i = 0; i < grains->n; i++) {
    if (grains->take && !grains->take[i]) continue;
    const int p = sd_vans_slice_of(stream->mesh, grains->x[3 * (long) i + 2]);
    const sd_vans_water water = sd_vans_water_in(stream, p);
    double w[3];
    const double speed = velocity_past(grains, i, water, w),
                 share = grains->weight ? grains->weight[i] : 1.0;
    const double slope = share * sd_drag_slope(law->drag, law->rho, law->eta, grains->a[i], water.hindrance, speed);
    const double left = mass[i] - share * law->added_mass * law->rho * sd_sphere_volume(grains->a[i]),
                 rate = left > 0.0 ? slope / left : HUGE_VAL;
    if (rate > largest) {
      largest = rate;
      *stiffest = i;
    }
  }
  return largest;
}
