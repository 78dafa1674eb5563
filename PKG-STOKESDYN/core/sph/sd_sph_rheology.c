#include "sd_sph_rheology.h"

#include <math.h>

double sd_sph_mu(const sd_sph_rheology *f, double G)
{
  if (f->law == SD_SPH_NEWTON) return f->mu;
  if (f->law == SD_SPH_CARREAU)
    return f->mu + (f->mu_max - f->mu) * pow(1.0 + f->lambda * f->lambda * G * G, 0.5 * (f->n - 1.0));
  /* At rest tau/G and, for n < 1, G^(n-1) are infinite, or no number: mu_max then. */
  if (!(G > 0.0)) return f->tau > 0.0 || f->n < 1.0 ? f->mu_max : f->n > 1.0 ? 0.0 : fmin(f->mu, f->mu_max);
  const double free = f->mu * (f->n == 1.0 ? 1.0 : pow(G, f->n - 1.0)) + f->tau / G;
  return fmin(f->mu_max, free);
}

/* Thinning fluids have it at rest; a fluid that thickens has no other bound than mu_max. */
double sd_sph_largest_mu(const sd_sph_rheology *f)
{
  return f->law == SD_SPH_HERSCHEL_BULKLEY && f->n > 1.0 ? f->mu_max : sd_sph_mu(f, 0.0);
}
