/* What a preconditioner (sd_precondition.h) is made of, and how its ranks agree. */
#ifndef SD_PRECONDITION_CASE_H
#define SD_PRECONDITION_CASE_H

#include "sd_ewald.h"
#include "sd_product.h"
#include "sd_solve.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  sd_law law;
  /* [n] those with radius 0 take no part */
  sd_spheres spheres;
  /* Unknowns of a sphere, width: 3 (force), with rotation 6 (force and torque) */
  int n, width;
  /* Clump k is of the spheres member[first[k]] ... member[first[k + 1] - 1]; no sphere is in
   * two. */
  int clumps;
  const long *first;
  const int *member;
  /* The periodic box, of the long waves (sd_waves.h) alone. NULL: open space */
  const sd_ewald_box *box;
  /* P is the sum of `parts` terms, and this is term `part`: what apply returns is to be summed. */
  int part, parts;
  /* Over all ranks, parts or not, so that they agree on failures; NULL: one rank, one part. */
  sd_sum *sum;
  void *sum_ctx;
} sd_precondition_case;

/* The status of this rank, or another failure if another rank has failed. */
sd_status sd_precondition_agree(const sd_precondition_case *c, sd_status mine);

#ifdef __cplusplus
}
#endif
#endif
