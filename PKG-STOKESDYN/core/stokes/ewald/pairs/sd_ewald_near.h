/* What the files of the near part share (sd_ewald_pairs.h): its rows, and who is near whom. */
#ifndef SD_EWALD_NEAR_H
#define SD_EWALD_NEAR_H

#include "sd_ewald_cells.h"
#include "sd_ewald_kernels.h"
#include "sd_status.h"
#include "sd_world.h"

SD_BEGIN_C

/* Points in groups (sd_ewald_groups.h) */
typedef struct {
  /* of the groups: those that take part, in order of cells, and where their middles are now */
  sd_ewald_cells cells;
  /* [7 groups + SD_FULL] middles, of the kept lists those of their making [3][rows of cells]; how many points
   * each has; and what the cells need */
  double *middle;
  /* lists that are kept while no group moves far in the frame (sd_skin.h), as all do when the frame turns: of
   * how many groups, points and points of ours; within which reach, 0: none is kept; later groups within
   * reach and skin; [rows of cells + 1] where those of each begin */
  int groups, points, ours, *candidate;
  double reach;
  long *from;
  size_t candidate_room, from_room;
  /* [rows of cells + 1] first row of each; [..] groups near one; [2 ..] their rows */
  int *first, *near, *range;
  size_t middle_room, first_room, near_room, range_room;
  /* how far a point is from its middle at most */
  double farthest;
  /* where kernels take whole groups: [rows of cells + 1] where the pairs of each begin, and these */
  long *begin;
  sd_near_group *pair;
  size_t begin_room, pair_room;
  /* groups of ours that have a form: [own] first sphere, which, and how many targets there are up to its end;
   * [forms][3 SD_GROUP_POINTS][SD_GROUP_ROW] the blocks, for w = 1 */
  int own, *sphere, *form, *end;
  double *block;
  size_t sphere_room, form_room, end_room, block_room;
} sd_ewald_groups;

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
  /* of the frame of cells and centres */
  int turn;
  /* of the spheres with radius, ours and ghosts, in order of cells: their number, [rows] which */
  int rows, *sphere;
  /* all radii are a_ref */
  int equal;
  /* our own among them: [n] rows in order of cells */
  int n, *target;
  /* each pair once, by the row that comes first: rows in bunches of up to so many [bunches + 1], and
   * [bunches + 1] neighbours of one (sd_near_part); or by groups, and then not here */
  int by_groups, most, bunches, *begin;
  long *first;
  int *neighbor;
  /* lists are filled up to a multiple of so many, whole vectors of every set */
  int full;
  /* sd_near_part's, in one block, `bytes` a number, and of waves [width rows]; u and they hold the centres
   * [3][rows] before, doubles, or the points of groups (sd_ewald_groups_arms) */
  size_t bytes;
  void *row, *torque_row, *u, *waves;
  double *memory;
  size_t room, sphere_room, target_room, begin_room, first_room, neighbor_room;
  /* rows are found by these: one by one, or where they stand in groups, by groups */
  sd_ewald_cells cells;
  sd_ewald_groups groups;
} sd_ewald_pairs;

/* Sums over spheres: of w F [3], b w F [3], w T [3], and of the sizes of all these numbers */
enum { SD_EWALD_SIZES = 9, SD_EWALD_SUMS };

/* [3][rows] while rows are placed */
static inline double *sd_ewald_centres(const sd_ewald_pairs *p)
{
  return p->u;
}

/* Of floats: how many of the whole numbers that are coordinates make a length; 2^32 are four ranges. */
static inline double sd_ewald_pairs_steps(const sd_ewald_pairs *p)
{
  return 0x1p30 / p->ewald.range;
}

/* Neighbours of a bunch, rows up to `end`, among so many ranges of rows, behind the first `many` of all;
 * returns how many there are then. And the kernels' table: lengths scaled, and times 8 pi. */
long sd_ewald_pairs_near(sd_ewald_pairs *p, int row, int end, int ranges, const int *range, long many);
sd_near_part sd_ewald_pairs_part(const sd_ewald_pairs *p);

SD_END_C
#endif
