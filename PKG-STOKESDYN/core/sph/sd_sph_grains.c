#include "sd_sph_grains.h"

#include "sd_constants.h"
#include "sd_linear.h"
#include "sd_sphere.h"

#include <math.h>
#include <string.h>

// --- the flow that a grain makes itself ----------------------------------------------------------

/* 1 - sin(x)/x, or 1/3 - j1(x)/x: what friction along a wave, mean of all directions, has of 1 -
 * cos. */
static double rubs(int laplacian, double x)
{
  const double x2 = x * x;
  if (x < 0.05) return laplacian ? x2 / 6.0 * (1.0 - x2 / 20.0) : x2 / 30.0 * (1.0 - x2 / 28.0);
  return laplacian ? 1.0 - sin(x) / x : 1.0 / 3.0 - (sin(x) / x - cos(x)) / x2;
}

/* W(k) and S of h = 1 by Simpson's rule over the support; W' = r G(r) N. */
static double transformed(sd_sph_kernel kernel, int laplacian, double k, double *S)
{
  enum { PARTS = 64 };
  const double step = 2.0 / PARTS;
  double W = 0.0;
  *S = 0.0;
  for (int i = 1; i < PARTS; i++) {
    const double r = step * i, kr = k * r, part = (i % 2 ? 4.0 : 2.0) * step / 3.0;
    W += part * 4.0 * SD_PI * r * r * sd_sph_W(kernel, 3, r, 1.0) *
        (kr > 1e-3 ? sin(kr) / kr : 1.0 - kr * kr / 6.0);
    *S -= part * (laplacian ? 8.0 : 40.0) * SD_PI * r * r * sd_sph_dW_over_r(kernel, 3, r, 1.0) *
        rubs(laplacian, kr) / (k * k);
  }
  return W;
}

/* A(s), by its series where it cancels. */
static double mean_of_directions(double s)
{
  const double s2 = s * s;
  if (s < 0.1) return 2.0 / 3.0 - s2 * (2.0 / 15.0 - s2 * (2.0 / 35.0 - s2 * (2.0 / 63.0)));
  return (1.0 + 1.0 / s2) * atan(s) / s - 1.0 / s2;
}

/* k = e^y: small k matter at large Re, where A falls off as 1/s. */
void sd_sph_wake_make(sd_sph_kernel kernel, int laplacian, sd_sph_wake *wake)
{
  enum { PARTS = 240 };
  const double lowest = log(1e-7), highest = log(15.0), step = (highest - lowest) / PARTS;
  memset(wake, 0, sizeof(*wake));
  for (int i = 0; i <= PARTS; i++) {
    double S;
    const double k = exp(lowest + step * i), W = transformed(kernel, laplacian, k, &S),
                 part = (i == 0 || i == PARTS ? 0.5 : 1.0) * step * k * W * W / S;
    wake->T_2 += 2.0 / SD_PI * part * k * k;
    for (int n = 0; n < SD_SPH_WAKES; n++)
      wake->T[n] += 3.0 / SD_PI * part * mean_of_directions(0.5 * expm1(0.2 * n) / (k * S));
  }
}

double sd_sph_wake_of(const sd_sph_wake *wake, double Re_h, double K)
{
  const double at = fmin(log1p(2.0 * Re_h) / 0.2, SD_SPH_WAKES - 1.001), slowest = wake->T[0];
  const int n = (int) at;
  return (wake->T[n] + (at - n) * (wake->T[n + 1] - wake->T[n])) /
      (1.0 + K / slowest + K * K * slowest / wake->T_2);
}

double sd_sph_structure(double phi)
{
  const double e = 1.0 - phi, two = 1.0 + 2.0 * phi;
  return e * e * e * e / (two * two + phi * phi * phi * (phi - 4.0));
}

// --- who is around, and with what weight ---------------------------------------------------------

static double square_of_distance(const double *x, const double *y, double d[3])
{
  for (int c = 0; c < 3; c++) d[c] = x[c] - y[c];
  return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

void sd_sph_look_around(const sd_cells *cells, const double *points, int n, const double *x,
                        double reach, int *first, int *particle)
{
  int count = 0;
  double d[3];
  for (int j = 0; j < n; j++) {
    const double *at = x + 3 * (size_t) j;
    first[j] = count;
    for (sd_cells_walk w = sd_cells_near(cells, at, reach); sd_cells_step(cells, &w);)
      for (int a = w.first; a >= 0; a = cells->next[a]) {
        if (!(square_of_distance(at, points + 3 * (size_t) a, d) < reach * reach)) continue;
        if (particle) particle[count] = a;
        count++;
      }
  }
  first[n] = count;
}

void sd_sph_grain_weights(sd_sph_kernel kernel, double h, const sd_sph_around *list,
                          const double *x, const sd_sph_points *points, double *wet)
{
  const double scale = sd_sph_W(kernel, 3, 0.0, h) / sd_sph_K(kernel, 0.0);
  double d[3], *weight = list->weight;
  for (int j = 0; j < list->n; j++) {
    double of_water = 0.0, of_walls = 0.0;
    for (int p = list->first[j]; p < list->first[j + 1]; p++) {
      const int a = list->particle[p];
      const double r2 = square_of_distance(x + 3 * (size_t) j, points->x + 3 * (size_t) a, d);
      const double VW = r2 < 4.0 * h * h ? points->volume[a] * scale * sd_sph_K(kernel, sqrt(r2) / h) : 0.0;
      weight[p] = points->wall[a] ? 0.0 : VW;
      if (points->wall[a])
        of_walls += VW;
      else
        of_water += VW;
    }
    wet[j] = fmin(1.0, of_water / fmax(1.0 - of_walls, 0.02));
    for (int p = list->first[j]; of_water > 0.0 && p < list->first[j + 1]; p++)
      weight[p] /= of_water;
  }
}

void sd_sph_grain_volumes(int m, const int *row, const double *mass, const double *rho, const double *phi,
                          double *volume)
{
  for (int a = 0; a < m; a++) volume[a] = mass[row[a]] / (rho[row[a]] * (1.0 - phi[row[a]]));
}

void sd_sph_grain_displace(int m, const int *row, const double *phi, double *mass)
{
  for (int a = 0; a < m; a++) mass[row[a]] *= 1.0 - phi[row[a]];
}

void sd_sph_grain_fractions(const sd_sph_around *list, const sd_sph_grains *grains,
                            const double *volume, double *phi)
{
  const double *weight = list->weight;
  for (int j = 0; j < list->n; j++)
    for (int p = list->first[j]; p < list->first[j + 1]; p++)
      if (weight[p] > 0.0)
        phi[list->particle[p]] += grains->wet[j] * grains->V[j] * weight[p] / volume[list->particle[p]];
}

void sd_sph_grain_flux(const sd_sph_around *list, const sd_sph_grains *grains,
                       const double *volume, const double *v, double *flux)
{
  const double *weight = list->weight;
  for (int j = 0; j < list->n; j++)
    for (int p = list->first[j]; p < list->first[j + 1]; p++) {
      if (!(weight[p] > 0.0)) continue;
      const size_t a = list->particle[p];
      const double share = grains->wet[j] * grains->V[j] * weight[p] / volume[a];
      for (int c = 0; c < 3; c++) flux[3 * a + c] += share * v[3 * (size_t) j + c];
    }
}

void sd_sph_grain_water_flux(int n, const double *phi, const double *v, double *flux)
{
  for (size_t k = 0; k < 3 * (size_t) n; k++) flux[k] += (1.0 - phi[k / 3]) * v[k];
}

/* Sums that stay in registers: this is most of what grains cost. */
void sd_sph_grain_vector_means(const sd_sph_around *list, const double *vectors, double *means)
{
  const double *weight = list->weight;
  for (int j = 0; j < list->n; j++) {
    double x = 0.0, y = 0.0, z = 0.0;
    for (int p = list->first[j]; p < list->first[j + 1]; p++) {
      const double *u = vectors + 3 * (size_t) list->particle[p], w = weight[p];
      x += w * u[0];
      y += w * u[1];
      z += w * u[2];
    }
    means[3 * (size_t) j] = x;
    means[3 * (size_t) j + 1] = y;
    means[3 * (size_t) j + 2] = z;
  }
}

void sd_sph_grain_means(const sd_sph_around *list, const double *numbers, double *means)
{
  for (int j = 0; j < list->n; j++) {
    double sum = 0.0;
    for (int p = list->first[j]; p < list->first[j + 1]; p++)
      sum += list->weight[p] * numbers[list->particle[p]];
    means[j] = sum;
  }
}

void sd_sph_grain_shares(const sd_sph_around *list, const sd_sph_grains *grains,
                         const double *volume, double *own)
{
  const double *weight = list->weight;
  for (int j = 0; j < list->n; j++) {
    double sum = 0.0;
    for (int p = list->first[j]; p < list->first[j + 1]; p++)
      if (weight[p] > 0.0) sum += weight[p] * weight[p] / volume[list->particle[p]];
    own[j] = grains->wet[j] * grains->V[j] * sum;
  }
}

// --- forces --------------------------------------------------------------------------------------

/* By iteration from above: s falls by 8 phi for small phi, so that each round leaves 8 own of an
 * error. */
void sd_sph_grain_phi(int n, const double *mean, const double *own, double *phi)
{
  enum { MOST = 50 };
  for (int j = 0; j < n; j++) {
    double before = HUGE_VAL;
    phi[j] = mean[j];
    for (int round = 0; round < MOST && fabs(phi[j] - before) > 1e-9; round++) {
      before = phi[j];
      phi[j] = fmax(0.0, mean[j] - sd_sph_structure(before) * own[j]);
    }
  }
}

void sd_sph_grain_stresses(const sd_sph_around *list, const sd_sph_grains *grains, int m,
                           const double *volume, double *forces, double *F)
{
  for (size_t k = 0; k < 3 * (size_t) m; k++) forces[k] /= volume[k / 3];
  sd_sph_grain_vector_means(list, forces, F);
  for (size_t k = 0; k < 3 * (size_t) list->n; k++) F[k] = grains->wet[k / 3] * grains->V[k / 3] * F[k];
}

void sd_sph_grain_push(int n, double dt, const double *f, const double *F, const double *M, double *v)
{
  for (size_t k = 0; k < 3 * (size_t) n; k++) v[k] += dt * (F ? f[k] + F[k] : f[k]) / M[k / 3];
}

/* D/w for the slip w without the own flow, and what of it that flow takes: w = seen/(1 - taken). */
static double drag_of(const sd_sph_grain_law *law, double rho, double a, double phi,
                      double hindrance, double slip, double *taken)
{
  const double k = (1.0 - phi) * sd_drag_factor(law->drag, rho, law->eta, a, hindrance, slip);
  *taken = 0.0;
  if (!law->wake) return k;
  const double h = law->h, crowd = phi / sd_sphere_volume(a) * k * h * h / law->eta,
               T = sd_sph_wake_of(law->wake, rho * h * slip / law->eta, sqrt(crowd));
  *taken = fmin(0.5, sd_sph_structure(phi) * T * k / (6.0 * SD_PI * law->eta * h));
  return k;
}

/* The slip by iteration: a step of it changes `taken`, at most a half, by little. */
void sd_sph_grain_drag(const sd_sph_grain_law *law, int n, const sd_sph_grains *grains,
                       const sd_sph_slip *slip, const double *rho, const double *phi, double *k)
{
  enum { MOST = 20 };
  for (int j = 0; j < n; j++) {
    k[j] = 0.0;
    if (!(grains->wet[j] > 0.0)) continue;
    double d[3], hindrance, taken = 0.0, factor = 0.0;
    const double seen = sqrt(square_of_distance(slip->u + 3 * (size_t) j, slip->v + 3 * (size_t) j, d));
    sd_hindrance_of(law->drag, 1, phi + j, law->exponent, &hindrance);
    for (int round = 0; round < MOST; round++) {
      const double before = taken;
      factor = drag_of(law, rho[j], grains->a[j], phi[j], hindrance, seen / (1.0 - before), &taken);
      if (fabs(taken - before) < 1e-6) break;
    }
    k[j] = grains->wet[j] * factor / (1.0 - taken);
  }
}

void sd_sph_grain_load(const sd_sph_around *list, const double *k, double *total)
{
  for (int j = 0; j < list->n; j++)
    for (int p = list->first[j]; p < list->first[j + 1]; p++)
      total[list->particle[p]] += list->weight[p] * k[j];
}

void sd_sph_grain_drags(const sd_sph_around *list, double dt, const sd_sph_slip *slip,
                        const double *M, const double *k, const double *slowed, double *D)
{
  for (int j = 0; j < list->n; j++) {
    double rate = k[j] / M[j];
    for (int p = list->first[j]; p < list->first[j + 1]; p++)
      rate += list->weight[p] * slowed[list->particle[p]];
    for (int c = 0; c < 3; c++) {
      const size_t at = 3 * (size_t) j + c;
      D[at] = k[j] * (slip->u[at] - slip->v[at]) / (1.0 + dt * rate);
    }
  }
}

void sd_sph_grain_reactions(const sd_sph_around *list, const double *F, double *reaction)
{
  for (int j = 0; j < list->n; j++)
    for (int p = list->first[j]; p < list->first[j + 1]; p++)
      for (int c = 0; c < 3; c++)
        reaction[3 * (size_t) list->particle[p] + c] -= list->weight[p] * F[3 * (size_t) j + c];
}

void sd_sph_grain_rates(int n, const double *phi, const double *slope, const double *du, double *rate)
{
  for (int i = 0; i < n; i++) {
    const double found = du ? sd_dot(du + 4 * (size_t) i, slope + 4 * (size_t) i) : 0.0;
    rate[i] = (rate[i] - found) / (1.0 - phi[i]) + found;
  }
}
