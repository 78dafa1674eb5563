#include "sd_vans.h"

#include <math.h>

/* Middle of slice n above z_ref. */
static double middle(const sd_vans_mesh *mesh, int n)
{
  return 0.5 * (mesh->edge[n] + mesh->edge[n + 1]);
}

double sd_vans_transport(const sd_vans_mesh *mesh, const double *profile)
{
  const double *phi = profile, *vx = profile + (long) SD_VANS_VX * mesh->ncell;
  double q = 0.0;
  for (int n = 0; n < mesh->ncell; n++) q += phi[n] * vx[n] * sd_vans_height(mesh, n);
  return q;
}

double sd_vans_largest_stress(const sd_vans_mesh *mesh, const double *stress)
{
  double largest = stress[0]; /* may be negative: a stream that flows the other way */
  for (int n = 1; n < mesh->ncell; n++) largest = fmax(largest, stress[n]);
  return largest;
}

/* Layers of grains are maxima of phi; the topmost layer that is dense is the bed. The highest slice
 * is above the surface and the lowest has no neighbour below, so that neither counts. */
double sd_vans_bed_elevation(const sd_vans_mesh *mesh, const double *phi)
{
  for (int n = mesh->ncell - 2; n > 0; n--)
    if (phi[n] > 0.5 && phi[n] >= phi[n + 1] && phi[n] >= phi[n - 1]) return middle(mesh, n);
  return 0.0;
}

/* depth / (flux / depth) */
double sd_vans_depth_over_velocity(const sd_vans_mesh *mesh, const double *U, double bed)
{
  double flux = 0.0, depth = 0.0;
  for (int n = 0; n < mesh->ncell - 1; n++) {
    if (middle(mesh, n) <= bed) continue;
    flux += U[n + 1] * sd_vans_height(mesh, n);
    depth += sd_vans_height(mesh, n);
  }
  return flux > 0.0 ? depth * depth / flux : 0.0;
}
