/* For the sums that are not worth four pairs at a time: walks through the pairs inside the support.
 *   sd_sph_visitor v;
 *   SD_SPH_VISIT(model, list, p, v) { ... v.i, v.j, v.d ... } */
#ifndef SD_SPH_VISIT_H
#define SD_SPH_VISIT_H

#include "sd_sph_pair.h"

#include <math.h>

static inline double sd_sph_mass(const sd_sph_model *model, const sd_sph_particles *p, int i)
{
  return model->nclasses > 1 ? p->m[i] : p->mass;
}

static inline size_t sd_sph_class_pair(const sd_sph_model *model, const sd_sph_particles *p, int i,
                                       int j)
{
  return model->nclasses > 1 ? (size_t) p->cls[i] * model->nclasses + p->cls[j] : 0;
}

typedef struct {
  int i, j;
  double d[3], r2, q; /* x_i - x_j, its square, r / h */
  const sd_sph_coefficients *k;
} sd_sph_visitor;

static inline int sd_sph_visit(const sd_sph_model *model, const sd_sph_particles *p, int i, int j,
                               sd_sph_visitor *v)
{
  v->i = i;
  v->j = j;
  v->k = model->pair + sd_sph_class_pair(model, p, i, j);
  v->r2 = 0.0;
  for (int c = 0; c < 3; c++) {
    v->d[c] = p->x4[4 * (size_t) i + c] - p->x4[4 * (size_t) j + c];
    v->r2 += v->d[c] * v->d[c];
  }
  if (!(v->r2 < v->k->support * v->k->support)) return 0;
  v->q = sqrt(v->r2) * v->k->inv_h;
  return 1;
}

#define SD_SPH_VISIT(model, list, p, v)                                        \
  for (int ii_ = 0; ii_ < (list)->n; ii_++)                                    \
    for (int i_ = (list)->first[ii_], jj_ = 0; jj_ < (list)->count[i_]; jj_++) \
      if (sd_sph_visit(model, p, i_, (list)->neighbor[i_][jj_] & (list)->mask, &(v)))

#endif
