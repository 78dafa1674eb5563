/* The near part of images in a wall: what sd_wall.h says of a pair less its smooth part
 * (sd_image_wave.h), of spheres and images up to the range, i with its own among them. */
#ifndef SD_EWALD_IMAGE_PAIRS_H
#define SD_EWALD_IMAGE_PAIRS_H

#include "sd_ewald_kernels.h"
#include "sd_status.h"

SD_BEGIN_C

/* Where a sphere stands along the wall, for the order in which they are kept: strips half a range wide,
 * and along a strip */
typedef struct {
  double strip, along;
  int sphere;
} sd_near_image;

/* The spheres of a strip, in order; of these those that are not too far along it from the one whose
 * neighbours are sought */
typedef struct {
  double strip;
  int first, end, lo, hi;
} sd_near_strip;

/* Zero-initialise; sd_ewald_image_pairs_free in the end. */
typedef struct {
  const struct sd_ewald_kernels *kernels;
  sd_ewald ewald;
  sd_wall wall;
  sd_spheres spheres;
  double scale;
  /* what the kernel reads */
  sd_image_part part;
  /* spheres that are near the wall, ours and ghosts: ours first, [rows] which */
  int *sphere;
  sd_near_image *order;
  /* strips of ours, then of ghosts */
  sd_near_strip *strip;
  int strips, own_strips;
  /* sd_image_part's, in one block; before the products u holds the centres [3][rows] */
  double *row, *memory;
  long *first;
  int *neighbor;
  size_t sphere_room, order_room, strip_room, room, first_room, neighbor_room;
} sd_ewald_image_pairs;

/* Polynomials for a splitting of images. */
void sd_ewald_image_pairs_create(sd_ewald_image_pairs *p, const sd_ewald *e,
                                 const struct sd_ewald_kernels *kernels);

/* The spheres s, n of ours and the ghosts after them, heights above the wall at least the radii. SD_OK or
 * SD_ENOMEMORY. */
sd_status sd_ewald_image_pairs_place(sd_ewald_image_pairs *p, const sd_wall *wall,
                                     const sd_spheres *s, int n, int n_all);

/* u [3n] += M F of these pairs, F [3n] of ours and ghosts [3 (n_all - n)] */
void sd_ewald_image_pairs_apply(sd_ewald_image_pairs *p, int n, const double *F,
                                const double *ghosts, double *u);

void sd_ewald_image_pairs_free(sd_ewald_image_pairs *p);

SD_END_C
#endif
