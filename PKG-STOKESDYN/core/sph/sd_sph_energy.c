#include "sd_sph_energy.h"

#include "sd_linear.h"

#include <math.h>
#include <stddef.h>

/* int_0^s e^(k t) dt. expm1 keeps the small strains of a fluid that is hardly compressed. */
static double integral(double k, double s)
{
  return k == 0.0 ? s : expm1(k * s) / k;
}

/* de = P / rho^2 drho = P / rho ds, and 1 / rho = e^-s / rho0. */
double sd_sph_elastic(const sd_sph_state *state, double rho)
{
  if (state->kind == SD_SPH_ABSOLUT) return state->B * state->B * log(rho);
  const double s = log(rho / state->rho0), inverse = integral(-1.0, s) / state->rho0;
  if (state->no_tension && s < 0.0) return state->P0 * inverse;
  if (state->kind == SD_SPH_RELATIV)
    return state->B * (s - state->rho0 * inverse) + state->P0 * inverse;
  return state->B * (integral(state->gamma - 1.0, s) / state->rho0 - inverse) + state->P0 * inverse;
}

static int member(const sd_sph_members *g, int i)
{
  return (g->mask[i] & g->members) == g->members;
}

double sd_sph_kinetic_energy(const sd_sph_members *g)
{
  double sum = 0.0;
  for (int i = 0; i < g->n; i++)
    if (member(g, i)) sum += 0.5 * g->m[i] * sd_dot(g->v + 3 * (size_t) i, g->v + 3 * (size_t) i);
  return sum;
}

double sd_sph_elastic_energy(const sd_sph_members *g, const sd_sph_state *state, const double *rho)
{
  double sum = 0.0;
  for (int i = 0; i < g->n; i++)
    if (member(g, i)) sum += g->m[i] * sd_sph_elastic(state, rho[i]);
  return sum;
}

double sd_sph_power(const sd_sph_members *g, int columns, const double *F, double *others)
{
  double sum = 0.0;
  *others = 0.0;
  for (int i = 0; i < g->n; i++)
    *(member(g, i) ? &sum : others) += sd_dot(F + columns * (size_t) i, g->v + 3 * (size_t) i);
  return sum;
}

double sd_sph_sum(const sd_sph_members *g, const double *a)
{
  double sum = 0.0;
  for (int i = 0; i < g->n; i++)
    if (member(g, i)) sum += a[i];
  return sum;
}

double sd_sph_along(const sd_sph_members *g, const double b[3], const double *y)
{
  double sum = 0.0;
  for (int i = 0; i < g->n; i++)
    if (member(g, i)) sum += g->m[i] * sd_dot(b, y + 3 * (size_t) i);
  return sum;
}
