/* The near part of an Ewald sum: pairs up to the range, the tensor of a pair less its wave part in
 * open space (sd_radial.h), and what that wave part is at no distance, for the sphere itself.
 *
 *   u_i = sum_j [ RPY_ij(r) - D_ij(r) ] F_j - D_ii(0) F_i         all spheres j within range of i,
 *                                                                images among them */
#ifndef SD_EWALD_PAIRS_H
#define SD_EWALD_PAIRS_H

#include "sd_ewald_cells.h"
#include "sd_ewald_groups.h"
#include "sd_ewald_internal.h"
#include "sd_status.h"
#include "sd_world.h"

SD_BEGIN_C

struct sd_ewald_rows;

/* Zero-initialise; sd_ewald_pairs_free in the end. */
typedef struct sd_ewald_pairs {
  const struct sd_ewald_kernels *kernels;
  /* those of doubles, for what has no other */
  const struct sd_ewald_kernels *doubles;
  const struct sd_ewald_rows *numbers;
  sd_ewald ewald;
  int width, degree;
  double coefficient[SD_RADIALS][SD_RADIAL_TERMS], origin[SD_RADIALS], scale;
  /* forces in rows are times this: 1, or a power of two where floats would not hold them */
  double unit;
  sd_spheres spheres;
  /* of the spheres with radius, ours and ghosts, in order of cells: their number, [rows] which */
  int rows, *sphere;
  /* all radii are a_ref */
  int equal;
  /* our own among them: [n] rows in order of cells */
  int n, *target;
  /* each pair once, by the row that comes first, and no two ghosts: [rows + 1] neighbours of a row */
  long *first;
  int *neighbor;
  /* lists are filled up to a multiple of so many, whole vectors of every set */
  int full;
  /* sd_near_part's, in one block, `bytes` a number, and of waves [width rows]; u and they hold the centres
   * [3][rows] before, doubles */
  size_t bytes;
  void *row, *torque_row, *u, *waves;
  double *memory;
  size_t room, sphere_room, target_room, first_room, neighbor_room;
  /* rows are found by these: one by one, or where they stand in groups, by groups */
  sd_ewald_cells cells;
  sd_ewald_groups groups;
} sd_ewald_pairs;

/* Polynomials for a splitting. */
void sd_ewald_pairs_create(sd_ewald_pairs *p, const sd_ewald *e,
                           const struct sd_ewald_kernels *kernels, int width);

/* n spheres of ours and the ghosts after them, n_all together, in groups or not. SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_pairs_place(sd_ewald_pairs *p, const sd_spheres *s, const sd_groups *groups, int n,
                               int n_all);

/* Sums over spheres: of w F [3], b w F [3], w T [3], and of the sizes of all these numbers */
enum { SD_EWALD_SIZES = 9, SD_EWALD_SUMS };

/* A product, in four steps. The first takes F [width n] of ours and ghosts [width (n_all - n)], on all
 * ranks together; sums [SD_EWALD_SUMS], out, of all ranks; NULL, of doubles alone: not wanted. SD_OK or
 * what the sum over ranks said. */
sd_status sd_ewald_pairs_load(sd_ewald_pairs *p, int n, const double *F, const double *ghosts,
                              const sd_world *world, double *sums);

/* What is near */
void sd_ewald_pairs_apply(sd_ewald_pairs *p);

/* Rows [width] for each target, unit w F, which may become what waves do to it: in memory that lasts
 * until the next product */
void *sd_ewald_pairs_rows(sd_ewald_pairs *p);

/* u [width n] = w (what is near; rows of velocities, NULL: none; and what is beyond the range of a periodic
 * box, as a mean: the tail of sd_radial.h, and the sums of all ranks, NULL: none); 0 for spheres without
 * radius. */
void sd_ewald_pairs_take(const sd_ewald_pairs *p, int n, const double *F, const void *rows,
                         const double *tail, const double *sums, double *u);

/* For sd_ewald_groups: neighbours of a row among so many ranges of rows, behind the first `many` of all;
 * returns how many there are then. And the kernels' table. */
long sd_ewald_pairs_near(sd_ewald_pairs *p, int row, int ranges, const int *range, long many);
sd_near_part sd_ewald_pairs_part(const sd_ewald_pairs *p);

void sd_ewald_pairs_free(sd_ewald_pairs *p);

SD_END_C
#endif
