/* The near part of the second level of an Ewald sum (sd_ewald_levels.h): pairs of which at least one
 * sphere is large.
 *
 * Large spheres are few: every rank knows those of all, so that ghosts need not reach as far as
 * they do. A rank takes the pairs of its own spheres with large ones and their images, and what its
 * small ones do to large ones is summed over the ranks. Each pair is kept as its tensor,
 *
 *   U_i = f F_j + h r (r.F_j) + cji T_j x r,   W_i = cij F_j x r + k T_j + e r (r.T_j)
 *
 * less the wave part of the pair in open space (sd_radial.h); viscosity 1. */
#ifndef SD_EWALD_LARGE_PAIRS_H
#define SD_EWALD_LARGE_PAIRS_H

#include "sd_cells.h"
#include "sd_ewald_levels.h"
#include "sd_product.h"
#include "sd_radial.h"
#include "sd_status.h"
#include "sd_world.h"

SD_BEGIN_C

/* r, f, h, and with torques cij, cji, k, e */
enum { SD_LARGE_PAIR = 5, SD_LARGE_PAIR_TORQUES = 9 };

/* A large sphere of any rank, and where one of its images stands */
typedef struct {
  double x[3], a, w;
} sd_large_sphere;

/* Zero-initialise; sd_ewald_large_pairs_free in the end. */
typedef struct {
  /* the second level, and from which radius on spheres belong to it */
  sd_ewald ewald;
  double from;
  int width, degree;
  double coefficient[SD_RADIALS][SD_RADIAL_TERMS], origin[SD_RADIALS];
  /* [larges] of all ranks; ours from `first` on, [ours] which spheres; their rows of 6 numbers */
  int larges, first, ours, *sphere;
  sd_large_sphere *large;
  double *F, *u;
  size_t sphere_room, large_room, F_room;
  /* images within range of our spheres, they themselves among them: [3 images] where, [images] of
   * which */
  int images, *image_of;
  double *image;
  size_t image_room, image_of_room;
  sd_cells cells;
  /* pairs of our spheres in their order: [n + 1] first, [pairs] the other, [pairs] tensors */
  int n;
  long pairs, *begin;
  int *other;
  double *tensor;
  size_t begin_room, other_room, tensor_room;
} sd_ewald_large_pairs;

/* Polynomials for a second level */
void sd_ewald_large_pairs_create(sd_ewald_large_pairs *p, const sd_ewald_level *second, int width);

/* The spheres s, of which list [n] are ours and have a radius. On all ranks together. SD_OK,
 * SD_ENOMEMORY or what a sum said. */
sd_status sd_ewald_large_pairs_place(sd_ewald_large_pairs *p, const sd_spheres *s, const int *list,
                                     int n, const sd_world *world);

/* u += M F of these pairs, and -D(0) F of the large ones themselves; list as it was placed. */
sd_status sd_ewald_large_pairs_apply(sd_ewald_large_pairs *p, const sd_spheres *s, const int *list,
                                     const sd_world *world, const double *F, double *u);

void sd_ewald_large_pairs_free(sd_ewald_large_pairs *p);

SD_END_C
#endif
