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

double sd_vans_mean_height(const sd_vans_mesh *mesh, const double *phi)
{
  double volume = 0.0, moment = 0.0;
  for (int n = 0; n < mesh->ncell; n++) {
    const double V = phi[n] * sd_vans_height(mesh, n);
    volume += V;
    moment += V * middle(mesh, n);
  }
  return volume > 0.0 ? moment / volume : 0.0;
}

double sd_vans_largest_stress(const sd_vans_mesh *mesh, const double *stress)
{
  double largest = stress[0]; /* negative in a stream that flows the other way */
  for (int n = 1; n < mesh->ncell; n++)
    if (fabs(stress[n]) > fabs(largest)) largest = stress[n];
  return largest;
}

double sd_vans_bottom_slice(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const double *U)
{
  return sqrt(2.0 * sd_vans_height(mesh, 0) * fabs(U[1]) * fluid->rho / fluid->eta);
}

/* Layers of grains are maxima of phi; the topmost layer that is dense is the bed. The highest slice
 * is above the surface and the lowest has no neighbour below, so that neither counts. */
double sd_vans_bed_elevation(const sd_vans_mesh *mesh, const double *phi)
{
  for (int n = mesh->ncell - 2; n > 0; n--)
    if (phi[n] > 0.5 && phi[n] >= phi[n + 1] && phi[n] >= phi[n - 1]) return middle(mesh, n);
  return 0.0;
}

double sd_vans_wall_share(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const double *phi,
                          const double *U, double drive)
{
  const int M = mesh->ncell - 1;
  double flux = 0.0, depth = 0.0;
  for (int n = M - 1; n >= 0 && phi[n] < 0.1; n--) {
    flux += (1.0 - phi[n]) * U[n + 1] * sd_vans_height(mesh, n);
    depth += (1.0 - phi[n]) * sd_vans_height(mesh, n);
  }
  if (!(fluid->width > 0.0) || !(drive * flux > 0.0)) return 0.0;
  /* R grows with f(R), which falls with R: substitution converges */
  const double mean = fabs(flux / depth);
  double R = 0.5 * fluid->width;
  for (int k = 0; k < 60; k++) {
    sd_vans_friction anew = {0};
    R = sd_vans_wall_friction(SD_VANS_CONSISTENT, mean * R * fluid->rho / fluid->eta, &anew) *
        mean * mean / (8.0 * fabs(drive));
  }
  return fmin(2.0 * R / fluid->width, 1.0);
}

/* f |U| grows with |U|. */
double sd_vans_wall_rate(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const double *U)
{
  const double length = sd_vans_wall_length(fluid);
  double fastest = 0.0;
  if (!(fluid->width > 0.0)) return 0.0;
  for (int j = 1; j < mesh->ncell; j++) fastest = fmax(fastest, fabs(U[j]));
  const double Re = fmax(fastest * length * fluid->rho / fluid->eta, SD_VANS_LEAST_RE);
  sd_vans_friction anew = {.roughness = fluid->wall_roughness / length};
  return fluid->wall_coef * sd_vans_wall_friction(fluid->rules, Re, &anew) * Re * fluid->eta /
         (4.0 * fluid->rho * length * fluid->width);
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
  return flux != 0.0 ? depth * depth / fabs(flux) : 0.0;
}
