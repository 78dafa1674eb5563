/* What SPH says of a place: the pressure at a point, the free surface over it, and how far a
 * particle is inside the fluid. */
#ifndef SD_SPH_PROBE_H
#define SD_SPH_PROBE_H

#include "sd_sph_pair.h"

SD_BEGIN_C

/* A particle of volume V, as it is around itself: V W(r) */
typedef struct {
  sd_sph_kernel kernel;
  int dimension;
  double h, V;
} sd_sph_spread;

/* Pressure at a point, Shepard's mean P = sum V P W / sum V W over the particles in reach: adds one at the
 * distance r to the two sums. */
void sd_sph_probe_add(const sd_sph_spread *of, double r, double P, double sums[2]);

/* Of the sums of all; 0 where nobody is in reach. */
double sd_sph_probe_pressure(const double sums[2]);

/* Free surface over a point: the fraction of space that is filled, sum V W, is 1 in the fluid and
 * 1/2 at a plane surface. Adds a particle at the height z over the point and the distance across from
 * the line upwards to the fraction of a stretch of this line. */
typedef struct {
  /* heights (first + k) step, k < count; first is a whole number */
  double first, step;
  int count;
} sd_sph_stretch;
void sd_sph_gauge_add(const sd_sph_spread *of, double across, double z, const sd_sph_stretch *at,
                      double *fraction);

/* The uppermost height of the stretch at which the fraction [at->count] falls through 1/2, linear
 * between samples; 0: there is none. */
double sd_sph_gauge_height(const sd_sph_stretch *at, const double *fraction);

/* Adds to M [6 n + 6], rows xx yy zz xy xz yz of - sum V_b g d d^T, the unit matrix in the bulk. x4
 * holds volumes as sd_sph_pack_volumes makes them. */
void sd_sph_moments(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                    double *M);

/* The smallest eigenvalue of such a row: 1 in the bulk, about 1/2 at a free surface, 0 of a
 * particle alone. With Wendland, h of 2 spacings: 0.50, 0.70, 0.94 in the first three rows under a plane
 * surface; the first is below SD_SPH_SURFACE. */
static const double SD_SPH_SURFACE = 0.65;
double sd_sph_least_eigenvalue(int dimension, const double M[6]);

SD_END_C
#endif
