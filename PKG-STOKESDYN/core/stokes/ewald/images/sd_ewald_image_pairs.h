/* The near part of images in a wall: what sd_wall.h says of a pair less its smooth part
 * (sd_image_wave.h), of spheres and images up to the range, i with its own among them. */
#ifndef SD_EWALD_IMAGE_PAIRS_H
#define SD_EWALD_IMAGE_PAIRS_H

#include "sd_cells.h"
#include "sd_ewald.h"
#include "sd_product.h"
#include "sd_status.h"

SD_BEGIN_C

/* The other of a pair, and c1 ... c5 */
typedef struct {
  int other;
  double c[5];
} sd_image_pair;

/* Where a sphere stands along the wall, for the order in which they are kept */
typedef struct {
  double strip, along;
  int sphere;
} sd_near_image;

/* Zero-initialise; sd_ewald_image_pairs_free in the end. */
typedef struct {
  sd_ewald ewald;
  sd_spheres spheres;
  /* spheres that are near the wall, ours and ghosts: ours first, [near] which; in the axes of the
   * wall [3 near], w F [3 near], sums [3 near] */
  int near, ours, *sphere;
  double *x, *F, *u;
  sd_near_image *order;
  size_t near_room, order_room, x_room;
  /* each pair once, by one of ours: [ours + 1] first */
  long *first;
  sd_image_pair *pair;
  size_t first_room, room;
  sd_cells cells;
} sd_ewald_image_pairs;

/* The spheres s, n of ours and the ghosts after them, heights at least the radii. SD_OK or
 * SD_ENOMEMORY. */
sd_status sd_ewald_image_pairs_place(sd_ewald_image_pairs *p, const sd_ewald *e,
                                     const sd_spheres *s, int n, int n_all);

/* u [3n] += M F of these pairs, F [3n] of ours and ghosts [3 (n_all - n)] */
void sd_ewald_image_pairs_apply(sd_ewald_image_pairs *p, int n, const double *F,
                                const double *ghosts, double *u);

void sd_ewald_image_pairs_free(sd_ewald_image_pairs *p);

SD_END_C
#endif
