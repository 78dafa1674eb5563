/* How fast the stiffest motion decays: the largest eigenvalue of W^-1 R, for velocities v that obey
 *
 *   W dv/dt = -R v       R symmetric, v.R v >= 0: a resistance;  W > 0, diagonal: an inertia
 *
 * By power iteration, v := W^-1 R v, whose Rayleigh quotient v.R v / v.W v is never too large, and a few per
 * cent low at most where one motion is stiffer than all others. */
#ifndef SD_RATE_H
#define SD_RATE_H

#include "sd_world.h"

SD_BEGIN_C

typedef struct {
  /* [n] numbers of this rank */
  long n;
  const double *W;
  /* Rv = R v. SD_OK or why it failed */
  sd_status (*apply)(void *ctx, const double *v, double *Rv);
  void *ctx;
  const sd_world *world;
} sd_decay;

/* In so many products from v [n], which has a share of every motion, and is another then. work [n]. *rate
 * out, 0 where R v = 0. On all ranks together. SD_OK; SD_ENOTFINITE; that of apply, of the world's sum. */
sd_status sd_rate(const sd_decay *of, int products, double *v, double *work, double *rate);

SD_END_C
#endif
