#include "sd_sph_pressure.h"

#include <math.h>

/* x^gamma; the exponent of water, 7, and other small integers by multiplication. */
static double pressure_power(double x, double gamma)
{
  const int n = (int) gamma;
  if (n != gamma || n < 1 || n > 16) return pow(x, gamma);
  double p = 1.0, square = x;
  for (int k = n; k; k >>= 1, square *= square)
    if (k & 1) p *= square;
  return p;
}

double sd_sph_pressure(const sd_sph_state *s, double rho)
{
  if (s->no_tension && rho < s->rho0) return s->P0;
  switch (s->kind) {
    case SD_SPH_ABSOLUT:
      return s->B * s->B * rho;
    case SD_SPH_RELATIV:
      return s->B * (rho - s->rho0) + s->P0;
    default:
      return s->B * (pressure_power(rho / s->rho0, s->gamma) - 1.0) + s->P0;
  }
}

/* Solved for rho: rho0 (1 + (P - P0) / B)^(1/gamma) for Tait. The bracket is rho^gamma and must be
 * positive: no density pulls harder than P0 - B. */
double sd_sph_density_of(const sd_sph_state *s, double P)
{
  double rho;
  if (s->no_tension && P < s->P0) return s->rho0;
  switch (s->kind) {
    case SD_SPH_ABSOLUT:
      rho = P / (s->B * s->B);
      break;
    case SD_SPH_RELATIV:
      rho = s->rho0 + (P - s->P0) / s->B;
      break;
    default: {
      const double base = 1.0 + (P - s->P0) / s->B;
      rho = base > 0.0 ? s->rho0 * pow(base, 1.0 / s->gamma) : 0.0;
    }
  }
  return rho > 0.0 ? rho : 0.0;
}

double sd_sph_speed_of_sound(const sd_sph_state *s, double rho)
{
  switch (s->kind) {
    case SD_SPH_ABSOLUT:
      return s->B;
    case SD_SPH_RELATIV:
      return sqrt(s->B);
    default:
      return sqrt(s->B * s->gamma / s->rho0 * pressure_power(rho / s->rho0, s->gamma) * s->rho0 / rho);
  }
}

/* All three grow with rho, so the bound is the value at rho = 0. */
double sd_sph_least_pressure(const sd_sph_state *s)
{
  return sd_sph_pressure(s, 0.0);
}

void sd_sph_keep_size(const sd_sph_state *state, int n, double *rho, const int *mask, int bit)
{
  if (!state->no_tension) return;
  const double least = SD_SPH_THINNEST * state->rho0;
  for (int i = 0; i < n; i++)
    if ((mask[i] & bit) && rho[i] < least) rho[i] = least;
}

double sd_sph_density_of_water(const sd_sph_state *s, double rho)
{
  return s->no_tension && rho < s->rho0 ? s->rho0 : rho;
}

void sd_sph_pressures(const sd_sph_state *state, int n, const double *rho, const int *mask, int bit,
                      double *P)
{
  /* A copy that nobody else can change: the kind is then tested once and not for each particle. */
  const sd_sph_state s = *state;
  for (int i = 0; i < n; i++)
    if (mask[i] & bit) P[i] = sd_sph_pressure(&s, rho[i]);
}
