/* Brownian forces on the bodies of sd_bodies.h: random forces whose covariance is the resistance of
 * all bodies, so that the velocities that follow from them have that of the mobility.
 *
 *   f of covariance M'^-1 on the points,  K^T f of covariance K^T M'^-1 K = R
 *   V = R^-1 K^T f sqrt(2 kT/dt) then has the covariance 2 kT/dt R^-1
 *
 * by Lanczos's process (sd_noise.h) on P^T M' P, where P is made of roots of M_b'^-1, in which every
 * body is for itself: what is stiff within bodies is no part of the process. Any P will do for the
 * covariance, so that blocks of open space serve above a wall. P is symmetric, but for the length that
 * makes torques comparable to forces (sd_body_shape.h), and turns with the body: numbers of points in
 * axes of space give the same forces in whatever axes the shape is kept.
 *
 * With a tie the films' own random forces (sd_lubrication_noise.h) come on top: R + K^T L K.
 * Source: reference of the project, brownian.md 2; the blocks are our own choice. */
#ifndef SD_BODIES_NOISE_H
#define SD_BODIES_NOISE_H

#include "sd_body.h"
#include "sd_noise.h"

SD_BEGIN_C

/* Keeps its memory from one draw to the next. Zero-initialise; sd_bodies_noise_free in the end. */
typedef struct {
  sd_noise process;
  double *work;
  size_t room;
} sd_bodies_noise;

/* F [spheres] of the bodies where they stand, from independent standard normal numbers w [points],
 * which are not read at rows that no body has. block [A->shaped]: the bodies that P is made of,
 * those of A or as they are in open space; one whose shape is NULL, or has no root
 * (sd_body_shape.h), counts by its diagonal. At width 6 their a = 1. e < tolerance as in
 * sd_noise.h, whose reports and failures these are; and SD_ENOMEMORY. */
sd_status sd_bodies_draw(sd_bodies_noise *s, const sd_bodies *A, const sd_body *block,
                         const double *w, double tolerance, double *F, sd_noise_report *report);

void sd_bodies_noise_free(sd_bodies_noise *s);

SD_END_C
#endif
