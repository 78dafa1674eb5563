/* What spheres as shells of points are to the loop of sd_bodies.h: bodies of a shape each, and the
 * mobility of their points.
 *
 * A free sphere is a body of a shape, the same for all, scaled by its radius; a clump has its own.
 * Points are rows as in sd_multiblob_points.h, those that are left out among them. */
#ifndef SD_MULTIBLOB_SHAPE_H
#define SD_MULTIBLOB_SHAPE_H

#include "sd_body_shape.h"
#include "sd_faces.h"
#include "sd_multiblob_points.h"

SD_BEGIN_C

typedef struct {
  /* [spheres] */
  int spheres;
  sd_multiblob_mask *mask;
  /* [9] how the shells of a clump stand in its own axes; unity for a free sphere. rank: of the clump, 0 1 2
   * (sd_shape.h); line: its direction, of rank 1 */
  double turn[9], line[3];
  int rank;
  /* [points.m] row of each point among those of the spheres of the body, which begin at
   * first [spheres + 1] */
  int *row, *first;
  sd_body_shape points;
  /* [SD_FACES_WIDTH][3 n] of the lone sphere, for sd_faces.h; NULL: of a clump */
  double *faces;
} sd_multiblob_shape;

/* The lone sphere of radius 1 (clump NULL), or a rigid clump in the axes and the order of its
 * shape, whose members have models m[kind[k]] (kind NULL: the first): with the one-body addition where
 * sd_multiblob_masks says so. The owner frees. SD_OK; SD_ENOMEMORY; SD_ESINGULAR: not positive
 * definite. */
sd_status sd_multiblob_shape_create(const sd_multiblob *m, const sd_shape *clump, const int *kind,
                                    sd_multiblob_shape *out);
/* The shape, in axes of space, of the points that there are of spheres s in space, above a wall
 * (sd_body_shape.h); their order is that of the body's own shape. The owner frees. Status as above. */
sd_status sd_multiblob_wall_shape(const sd_multiblob *m, const sd_wall *wall,
                                  const sd_multiblob_spheres *s, const double centre[3],
                                  sd_body_shape *out);
void sd_multiblob_shape_free(sd_multiblob_shape *s);

/* A clump that stands with R (sd_shape_pose): pose [9] of the body, and turn [9] of its shells in
 * space. Both are the same whatever clump of its kind the shape was made from. On a line R has any
 * azimuth: the shells get one that only the line's direction says, and the pose with them. */
void sd_multiblob_shape_stand(const sd_multiblob_shape *s, const double R[9], double pose[9],
                              double turn[9]);

SD_END_C
#endif
