/* Mass and coefficients of particles, of one class or of many; pairs one after the other. */
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

/* Two particles of a half list within the support: d = x_i - x_j. */
typedef struct {
  int i, j;
  double d[3], r2;
  const sd_sph_coefficients *pair;
} sd_sph_two;
typedef void sd_sph_meet(const sd_sph_model *model, const sd_sph_particles *p, const sd_sph_two *two,
                         double *out);

/* For what is asked once in many steps. x4 must be packed. */
void sd_sph_each_pair(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                      sd_sph_meet *meet, double *out);

#endif
