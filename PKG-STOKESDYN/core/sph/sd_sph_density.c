#include "sd_sph_density.h"

#include "sd_sph_class.h"

#include <string.h>

void sd_sph_pack_masses(const sd_sph_model *model, const sd_sph_particles *p, const double *rho,
                        double *q)
{
  /* Two columns of four are used: a vector costs the same, and ranks exchange it whole. */
  memset(q, 0, 4 * sizeof(double) * (size_t) (p->n + 1));
  for (int i = 0; i < p->n; i++) {
    q[4 * (size_t) i] = sd_sph_mass(model, p, i);
    q[4 * (size_t) i + 1] = q[4 * (size_t) i] / rho[i];
  }
}

void sd_sph_sum_densities(const sd_sph_model *model, const sd_sph_particles *p,
                          const sd_sph_densities *how, double *rho)
{
  for (int i = 0; i < how->n; i++) {
    if (!(how->mask[i] & how->bit)) continue;
    /* what a particle adds to its own sum: m W(0, h) */
    const double own = sd_sph_mass(model, p, i) *
        sd_sph_of_pair(model, p, i, i)->weight * sd_sph_K(model->kernel, 0.0);
    const double *s = how->sums + 4 * (size_t) i;
    rho[i] = how->shepard ? (s[0] + own) / (s[1] + own / rho[i]) : s[0] + own;
  }
}
