/* A body above a wall (sd_wall.h), alone: its matrix has the images of its points, and depends on
 * where it stands. Its blocks are made anew where it has moved, for sd_bodies.h: beside the wall
 * those of open space are up to seven times too mobile, and the loop would take twice as many
 * products. */
#ifndef SD_BODY_WALL_H
#define SD_BODY_WALL_H

#include "sd_body_shape.h"
#include "sd_wall.h"

#ifdef __cplusplus
extern "C" {
#endif

/* M [(width m)^2] as of sd_body_shape_matrix, in axes of space: points x [3m] with heights of at
 * least their radii a [m], and images */
void sd_body_wall_matrix(const sd_wall *wall, int m, int width, const double *x, const double *a,
                         double *M);
/* The shape, in axes of space, of points x [3m] of a body whose centre is there. The owner frees.
 * Status of sd_body_shape_of. */
sd_status sd_body_wall_shape(const sd_wall *wall, int m, int width, const double *x,
                             const double *a, const double centre[3], sd_body_shape *out);

/* Is it worth a body's own blocks? Making them costs about as much as 2 m^3 pairs of points, so that
 * a body of m points wants about m/3 of `bodies`, and one of at most SD_BODY_WALL_SMALL none. From a
 * height of ten times its extent on the wall is worth a tenth of its mobility. */
enum { SD_BODY_WALL_SMALL = 42 };
int sd_body_wall_pays(int m, int bodies, double height, double extent);

#ifdef __cplusplus
}
#endif
#endif
