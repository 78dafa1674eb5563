/* Random velocities at the points of the bodies of sd_bodies.h, whose covariance is the matrix of the
 * points: as a slip of one solve they make all bodies move at random, by their common mobility.
 *
 *   y of covariance M',   M' l - K V = -(u + y),  K^T l + L V = F + f_L
 *   cov(V) = N (K^T M'^-1 M' M'^-1 K + L) N = N        f_L of covariance L (sd_lubrication_noise.h)
 *
 * by Lanczos's process (sd_noise.h) on P^T M' P, where P is made of roots of the bodies' own matrices
 * (sd_body_root.h). Any P will do for the covariance, so that blocks of open space serve above a wall. P is
 * symmetric, but for the length of torques, and turns with the body: numbers of points in axes of space
 * give the same velocities in whatever axes the shape is kept. The matrix may also be a part of M', the near
 * one of a sum that is split; what draws the other part is the caller's.
 * Source: own derivation; parts that are both positive: Fiore et al. 2017. */
#ifndef SD_BODIES_NOISE_H
#define SD_BODIES_NOISE_H

#include "sd_body.h"
#include "sd_body_root.h"
#include "sd_noise.h"

SD_BEGIN_C

/* Keeps its memory from one draw to the next. Zero-initialise; sd_bodies_noise_free in the end. */
typedef struct {
  sd_noise process;
  double *work;
  size_t room;
} sd_bodies_noise;

/* What P is made of: [A->shaped] how the bodies stand, those of A or as they are in open space, and their
 * roots; one whose shape is NULL, or whose root is NULL or has n = 0, counts by its diagonal. At width 6
 * their a = 1. */
typedef struct {
  const sd_body *body;
  const sd_body_root *const *root;
} sd_bodies_blocks;

/* y [points] from independent standard normal numbers w [points], which are not read at rows that no body
 * has; y is 0 there. e < tolerance as in sd_noise.h, whose reports and failures these are; and
 * SD_ENOMEMORY. */
sd_status sd_bodies_draw(sd_bodies_noise *s, const sd_bodies *A, const sd_bodies_blocks *blocks,
                         const double *w, double tolerance, double *y, sd_noise_report *report);

void sd_bodies_noise_free(sd_bodies_noise *s);

SD_END_C
#endif
