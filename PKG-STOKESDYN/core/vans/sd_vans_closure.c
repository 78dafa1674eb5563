#include "sd_constants.h"
#include "sd_sphere.h"
#include "sd_vans.h"

#include <math.h>
#include <stddef.h>

/* Volume and surface of many grains */
typedef struct {
  double V, S;
} bulk;

static void add_grains(double number, double a, bulk *sum)
{
  sum->V += number * sd_sphere_volume(a);
  sum->S += number * 4.0 * SD_PI * a * a;
}

/* Of all grains in slice n over the volume of the slice: phi_c/V_c grains of class c. For one class the ratio is the
 * same whatever their number. */
static bulk bulk_of_slice(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const sd_vans_mixture *now, int n)
{
  const long profile = (long) SD_VANS_ROWS * mesh->ncell;
  bulk sum = {0.0, 0.0};
  for (int c = 0; c < (now->classes ? fluid->nclass : 1); c++) {
    const double a = now->classes ? fluid->class_radius[c] : fluid->radius,
                 share = now->classes ? now->classes[c * profile + n] : now->phi[n];
    /* Yade takes phi for the number of grains, which is so for one size alone. */
    add_grains(fluid->rules == SD_VANS_YADE ? share : share / sd_sphere_volume(a), a, &sum);
  }
  return sum;
}

/* Pore length of every slice and, for D not NULL, the mean diameter 6 V/S. */
static void pore_length(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const sd_vans_mixture *now,
                        double *pore, double *D)
{
  const double *phi = now->phi;
  for (int n = 0; n < mesh->ncell; n++) {
    const bulk grains = bulk_of_slice(mesh, fluid, now, n);
    /* volume of pores over surface of grains; phi below 1e-3 is clear water; no bound without grains */
    pore[n] = grains.S > 0.0 ? (1.0 - phi[n]) / fmax(phi[n], 1e-3) * (grains.V / grains.S) : HUGE_VAL;
    if (D) D[n] = grains.S > 0.0 ? 6.0 * grains.V / grains.S : 0.0;
  }
}

/* The mixing length grows with the room for eddies, dl/dz = kappa (1 - phi/phi_max): kappa z over a
 * bed that lets none through, slower in a layer of moving grains. Below the highest packed slice
 * it stays 0, however loose it is there. */
static void li_sawamoto(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const double *phi,
                        double *length)
{
  /* Yade: a slice that exceeds phi_max takes length away */
  const double most = fluid->rules == SD_VANS_YADE ? HUGE_VAL : fluid->phi_max;
  int packed = mesh->ncell - 1; /* the highest slice that reaches phi_max; -1: none */
  while (packed >= 0 && phi[packed] < fluid->phi_max) packed--;
  length[0] = 0.0;
  for (int j = 1; j < mesh->ncell; j++) {
    const double p = j - 1 < packed ? fluid->phi_max : fmin(phi[j - 1], most);
    length[j] = length[j - 1] +
        fluid->kappa * sd_vans_height(mesh, j - 1) * (fluid->phi_max - p) / fluid->phi_max;
  }
}

/* Height of the top of the bed: lower edge of the highest slice with phi above phi_bed; 0 if there
 * is none. What lies below that slice is bed. */
static double top_of_bed(const sd_vans_mesh *mesh, const double *phi, double phi_bed)
{
  int n = mesh->ncell - 1;
  while (n > 0 && !(phi[n] > phi_bed)) n--;
  return mesh->edge[n];
}

/* Van Driest: l = kappa zv (1 - exp(-zv+/26)) with zv the height that is left to the water, and
 * a length of pores that stays in the bed. zv+ = sqrt(zv U/nu) has the U of the slice below the
 * node in place of u_star. The pore length is that of all classes in equal numbers, or in their
 * volumes, packed to phi_max. */
static void rousseau(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const double *U,
                     const double *phi, double *length)
{
  const double nu = fluid->eta / fluid->rho;
  bulk bed = {0.0, 0.0};
  for (int c = 0; c < (fluid->nclass ? fluid->nclass : 1); c++) {
    const double a = fluid->nclass ? fluid->class_radius[c] : fluid->radius;
    add_grains(fluid->class_volume ? fluid->class_volume[c] / sd_sphere_volume(a) : 1.0, a, &bed);
  }
  /* 0: there are no grains */
  const double pore = bed.S > 0.0 ? (1.0 - fluid->phi_max) / fluid->phi_max * bed.V / bed.S : 0.0;
  double zv = 0.0;
  length[0] = 0.0;
  for (int j = 1; j < mesh->ncell; j++) {
    zv += sd_vans_height(mesh, j - 1) *
        sqrt((fluid->phi_max - fmin(phi[j - 1], fluid->phi_max)) / fluid->phi_max);
    length[j] = fluid->kappa * zv * (1.0 - exp(-sqrt(fabs(zv * U[j]) / nu) / 26.0)) + 0.5 * pore;
  }
}

/* kappa times the way down from a node until it is longer than the eddies that fit there */
static void down_to_pores(const sd_vans_mesh *mesh, double kappa, const double *pore, double *length)
{
  const double *z = mesh->edge;
  for (int j = 0; j < mesh->ncell; j++) {
    double limit = 0.5 * pore[j], value = 0.0;
    for (int m = j - 1; m > 0 && limit > value; m--) {
      limit = 0.5 * pore[m];
      value = kappa * (z[j] - z[m]);
    }
    length[j] = value;
  }
}

static void unlimited_length(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const sd_vans_mixture *now,
                             double *length, double *scratch)
{
  const int N = mesh->ncell;
  const double *z = mesh->edge, H = z[N - 1], kappa = fluid->kappa;
  double *pore = scratch, *D = scratch + N;
  switch (fluid->turbulence) {
    case SD_VANS_LAMINAR:
      for (int j = 0; j < N; j++) length[j] = 0.0;
      break;
    case SD_VANS_KZ:
      for (int j = 0; j < N; j++) length[j] = kappa * z[j];
      break;
    case SD_VANS_PARABOLIC:
      for (int j = 0; j < N - 1; j++) length[j] = kappa * z[j] * sqrt(1.0 - z[j] / H);
      length[N - 1] = 0.0;
      break;
    case SD_VANS_LI_SAWAMOTO:
      li_sawamoto(mesh, fluid, now->phi, length);
      break;
    case SD_VANS_PIPE:
      li_sawamoto(mesh, fluid, now->phi, length);
      for (int j = 0; j < N; j++) length[j] = fmin(length[j], kappa * (H - z[j]));
      break;
    case SD_VANS_PORE:
      pore_length(mesh, fluid, now, pore, NULL);
      down_to_pores(mesh, kappa, pore, length);
      break;
    case SD_VANS_ROUSSEAU:
      rousseau(mesh, fluid, now->U, now->phi, length);
      break;
    case SD_VANS_NI_CAPART: {
      pore_length(mesh, fluid, now, pore, D);
      /* in the bed the pores set the length, above it the distance from its top */
      const double bed = top_of_bed(mesh, now->bed, fluid->phi_bed);
      for (int j = 0; j < N; j++)
        length[j] = fmax(fmin(0.5 * pore[j], 0.2 * D[j]), kappa * (z[j] - bed));
      break;
    }
  }
}

/* Eddies between grains that move: where a stream shears the grains themselves its mixing length was
 * measured to be about half a diameter, at any phi (Revil-Baudard et al. 2015). */
static void among_grains(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const sd_vans_mixture *now,
                         double *length, double *scratch)
{
  double *pore = scratch, *D = scratch + mesh->ncell;
  pore_length(mesh, fluid, now, pore, D);
  for (int j = 1; j < mesh->ncell; j++)
    length[j] = fmax(length[j], fluid->bed_mixing * fmax(D[j - 1], D[j]));
}

void sd_vans_mixing_length(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const sd_vans_mixture *now,
                           double *length, double *scratch)
{
  unlimited_length(mesh, fluid, now, length, scratch);
  if (fluid->bed_mixing > 0.0) among_grains(mesh, fluid, now, length, scratch);
  if (!fluid->narrow) return;
  const double most = 0.5 * fluid->kappa * fluid->width;
  for (int j = 0; j < mesh->ncell; j++) length[j] = fmin(length[j], most);
}

double sd_vans_effective_viscosity(const sd_vans_fluid *fluid, double phi, int bottom)
{
  const double nu = fluid->eta / fluid->rho;
  if (fluid->viscosity == SD_VANS_CONSTANT) return nu;
  /* Yade leaves the bottom node to Einstein's law. */
  if (fluid->viscosity == SD_VANS_EINSTEIN || (bottom && fluid->rules == SD_VANS_YADE))
    return nu * (1.0 + 2.5 * phi);
  return nu * pow(1.0 - phi, -2.8); /* Krieger & Dougherty's form, [eta] phi_m = 2.8, phi_m = 1 */
}
