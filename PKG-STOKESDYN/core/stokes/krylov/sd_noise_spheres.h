/* The matrix of the noise of free spheres, for sd_noise.h: M = Omega + D^-1 of `width` numbers a sphere, from
 * the Omega of an engine that may have torques and turns where no noise turns anybody. */
#ifndef SD_NOISE_SPHERES_H
#define SD_NOISE_SPHERES_H

#include "sd_noise.h"

SD_BEGIN_C

typedef struct {
  /* spheres of this rank; numbers of each: 3, with turns 6; of a row of the engine: as many, or 6 */
  size_t n, width, engine_width;
  /* [width n] 6 pi eta a, 8 pi eta a^3; 0: the sphere takes no part */
  const double *D;
  /* Omega; NULL: nobody sees anybody */
  sd_apply *apply;
  void *ctx;
  /* [engine_width n] for the engine, zero at the beginning: forces with torques that stay 0, and
   * velocities */
  double *F, *u;
} sd_noise_spheres;

/* Of the matrix M, with the spheres as context: u = M F, both [width n]; 0 where D is. The status of
 * apply. */
sd_status sd_noise_spheres_apply(void *spheres, const double *F, double *u);

/* y [width n] += the first numbers of each row of the engine's u [engine_width n] */
void sd_noise_spheres_add(const sd_noise_spheres *s, const double *u, double *y);

SD_END_C
#endif
