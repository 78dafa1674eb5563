/* How the surface of a sphere of points moves in the mean, from the velocities of its points: as a
 * uniform motion and a strain, which say with what velocity it faces another sphere.
 *
 *   (v, e) = G^T u      v [3] velocity, e [6] symmetric traceless, xx yy zz xy xz yz, times the radius:
 *                       the face at the unit vector d moves along d with d.v + d.e d
 *   G = M_b^-1 (1, x) R^-1                    of the lone sphere of radius 1, so it is the motion
 *                                             whose power in its fluid is nearest to that of u
 *   G^T K V = (U, 0):                         a rigid motion has no strain, and turns no face
 *
 * Points of a sphere are rows one after the other, n for each sphere or as many as its shell has; spheres
 * that lack points have no faces, and are left alone. */
#ifndef SD_FACES_H
#define SD_FACES_H

#include <stdint.h>

#include "sd_extern_c.h"

SD_BEGIN_C

enum { SD_FACES_WIDTH = 9, SD_FACES_MOST = 642 };

/* Of a shell: its points, at most SD_FACES_MOST, and [SD_FACES_WIDTH][3 n] G^T of a sphere of any radius, in
 * the axes of these */
typedef struct {
  int n;
  const double *G;
} sd_faces_pattern;

typedef struct {
  /* of the shells that there are */
  const sd_faces_pattern *pattern;
  /* [9 spheres] how these stand in space, row-major; NULL: all as they are. [spheres] 0: has no
   * faces; NULL: all have, on every rank */
  const double *turn;
  const char *whole;
  /* [spheres] which shell each has, NULL: the first; [spheres + 1] where its rows begin, NULL: all have as
   * many */
  const int *kind, *first;
} sd_faces;

/* v [9 spheres] = G^T u, u [3 rows] */
void sd_faces_read(const sd_faces *faces, int spheres, const double *u, double *v);
/* l [3 rows] += G f, f [9 spheres]: force, and the moments that go with e (d.e d: dx dx, dy dy,
 * dz dz, 2 dx dy, 2 dx dz, 2 dy dz) */
void sd_faces_push(const sd_faces *faces, int spheres, const double *f, double *l);

SD_END_C
#endif
