/* Half shells: those of spheres beside smaller ones. Their points are so large that neighbours just
 * touch, b = half the spacing (of each point to its nearest neighbour, in the mean), so that hardly any
 * flow leaks between them. R = 6 pi/T gives the sphere its drag, T the resistance of the shell of radius
 * 1 with points of b/R. What that leaves of rotation, stresslet and the two numbers of a pressure
 * gradient the one-body addition (sd_multiblob.h) makes exact, with a fifth constant:
 *
 *   u_k += rotation T x r_k/(6 pi eta a^3),   T = sum r_k x f_k,   rotation = 3/4 (1 - 1/that of the
 *                                                                  points over 8 pi eta a^3)
 *
 * Of the points alone: rotation 0.947, 0.983, 0.996, stresslet 1.026, 1.011, 1.003 with 42, 162, 642.
 * Source: our own; make_half_shells makes the numbers. */
#ifndef SD_MULTIBLOB_HALF_H
#define SD_MULTIBLOB_HALF_H

#include "sd_extern_c.h"

SD_BEGIN_C

typedef struct {
  /* points */
  int n;
  /* R and b of a sphere of radius 1 */
  double radius, point;
  /* of the addition */
  double alpha, beta, delta, strain, rotation;
} sd_multiblob_half;

/* n = 42, 162, 642; NULL: there is none */
const sd_multiblob_half *sd_multiblob_half_of(int n);

SD_END_C
#endif
