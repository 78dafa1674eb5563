#include "sd_vans.h"

#include <math.h>

/* Of the water: the highest slice is above it. */
double sd_vans_momentum(const sd_vans_mesh *mesh, double rho, const double *phi, const double *U)
{
  double sum = 0.0;
  for (int n = 0; n < mesh->ncell - 1; n++)
    sum += (1.0 - phi[n]) * U[n + 1] * sd_vans_height(mesh, n);
  return rho * sum;
}

/* In the coordinate "volume of water below" the old and the new slices are two cuts of one column,
 * in which U stays: a new slice has the mean over the pieces of old ones that it covers. Volume and
 * momentum are those of the column, so that only what passes its upper end is gained or lost. */
double sd_vans_displace(const sd_vans_mesh *from, const sd_vans_mesh *to, double rho,
                        const double *phi_old, const double *phi_new, double *U, double *scratch)
{
  const int M = from->ncell - 1, M_new = to->ncell - 1;
  double *below = scratch, *old = scratch + M + 1;
  const double surface = U[M + 1];
  below[0] = 0.0;
  for (int n = 0; n < M; n++) {
    below[n + 1] = below[n] + (1.0 - phi_old[n]) * sd_vans_height(from, n);
    old[n] = U[n + 1];
  }
  int source = 0;
  double lo = 0.0, through = 0.0;
  for (int n = 0; n < M_new; n++) {
    const double content = (1.0 - phi_new[n]) * sd_vans_height(to, n), hi = lo + content;
    double at = lo, momentum = 0.0;
    while (source < M && below[source + 1] < hi) {
      momentum += old[source] * (below[source + 1] - at);
      at = below[++source];
    }
    const double rest = hi - at, u = source < M ? old[source] : surface;
    momentum += u * rest;
    if (source == M) through += u * rest; /* water from above the surface */
    if (content > 0.0) U[n + 1] = momentum / content;
    lo = hi;
  }
  /* What no slice has taken has left through the surface. */
  for (; source < M; source++) {
    const double start = below[source] > lo ? below[source] : lo;
    through -= old[source] * (below[source + 1] - start);
  }
  return rho * through;
}

double sd_vans_volume(const sd_vans_mesh *mesh, const double *phi)
{
  double sum = 0.0;
  for (int n = 0; n < mesh->ncell - 1; n++) sum += (1.0 - phi[n]) * sd_vans_height(mesh, n);
  return sum;
}

/* Volume of water in slice n, or its height. */
static double content(const sd_vans_mesh *mesh, const double *phi, int n)
{
  return (phi ? 1.0 - phi[n] : 1.0) * sd_vans_height(mesh, n);
}

int sd_vans_fill(const sd_vans_mesh *mesh, const double *phi, double volume, double *edge)
{
  const int M = mesh->ncell - 1;
  double rest = volume;
  int top = 0;
  for (; top < M && rest > content(mesh, phi, top); top++) rest -= content(mesh, phi, top);
  /* less than a hundredth of a slice: the slice below grows instead */
  if (top > 0 && rest < 0.01 * content(mesh, phi, top < M ? top : M - 1)) {
    top--;
    rest += content(mesh, phi, top);
  }
  if (top == M) return 0;
  for (int k = 0; k <= top; k++) edge[k] = mesh->edge[k];
  edge[top + 1] = edge[top] + (phi ? rest / (1.0 - phi[top]) : rest);
  edge[top + 2] = edge[top + 1] + sd_vans_height(mesh, top);
  return top + 2;
}

double sd_vans_inflow(double volume, double comes, double passes, double reach, double T)
{
  const double speed = fmax(passes / volume, 0.0);
  return volume + T * (comes - passes) / (reach + T * speed);
}

void sd_vans_rise(const sd_vans_mesh *mesh, const double *profile, double flux, int first,
                  double *upward)
{
  const double *phi = profile, *vz = profile + (long) SD_VANS_VZ * mesh->ncell;
  for (int n = 0; n < mesh->ncell; n++)
    upward[n] = first ? (flux - phi[n] * vz[n]) / (1.0 - phi[n])
                      : flux + phi[n] * (upward[n] - vz[n]);
}

void sd_vans_borne(const sd_vans_mesh *mesh, const double *force, double *pressure)
{
  double above = 0.0;
  for (int n = mesh->ncell - 1; n >= 0; n--) {
    const double here = force[n] * sd_vans_height(mesh, n);
    pressure[n] = above + 0.5 * here;
    above += here;
  }
}
