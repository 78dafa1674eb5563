/* Mass and coefficients of particles, of one class or of many. */
#ifndef SD_SPH_CLASS_H
#define SD_SPH_CLASS_H

#include "sd_sph_pair.h"

static inline double sd_sph_mass(const sd_sph_model *model, const sd_sph_particles *p, int i)
{
  return model->nclasses > 1 ? p->m[i] : p->mass;
}

static inline const sd_sph_coefficients *
sd_sph_of_pair(const sd_sph_model *model, const sd_sph_particles *p, int i, int j)
{
  return model->pair +
      (model->nclasses > 1 ? (size_t) p->cls[i] * model->nclasses + p->cls[j] : 0);
}

#endif
