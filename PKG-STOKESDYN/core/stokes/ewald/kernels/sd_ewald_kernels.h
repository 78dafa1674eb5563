/* Between the engine and its kernels, of which each instruction set has its own build; and each of those
 * one for doubles and one for floats (sd_ewald.single), whose numbers are behind pointers to void. */
#ifndef SD_EWALD_KERNELS_H
#define SD_EWALD_KERNELS_H

#include <stdint.h>

#include "sd_image_kernel.h"
#include "sd_image_wave.h"
#include "sd_product.h"
#include "sd_radial.h"
#include "sd_window.h"

/* Behind the rows: no force, and far from everything */
enum { SD_EMPTY_ROWS = 16 };

/* Rows that have one list of neighbours, at most */
enum { SD_BUNCH = 4 };

/* Near part: each pair once, for both its spheres; lengths scaled as in sd_packed. Sums times 8 pi
 * and without w of the sphere, its own D(0) not among them. Rows stand in bunches, of one row each or, where
 * kernels take more, of several that are close: what is near one of them is near most others, and is read and
 * written once for all. */
typedef struct {
  int bunches, width;
  /* all radii a_ref: b = 0 */
  int equal;
  /* [bunches + 1] first row of each; and where its neighbours begin, which are rows behind its first, those
   * of its own before all others, and filled up to whole vectors of any set. Of one row they are within the
   * range, of a bunch within that of one of its rows at least. */
  const int *begin;
  const long *first;
  const int *neighbor;
  /* [8 (rows + SD_EMPTY_ROWS)] x y z a, w F; the first empty one takes the place of missing neighbours, and
   * groups are read in whole vectors. [4 (rows + SD_EMPTY_ROWS)] w T.
   * Among floats x y z are whole numbers of 32 bits, times `unit`: a difference of two is taken
   * modulo 2^32, more than twice the range, and is exact wherever the pair is */
  const void *row, *torque_row;
  double unit;
  /* [4 (rows + SD_EMPTY_ROWS)] U, with torques [8 ..] U, W, each and one number more; 0 before */
  void *u;
  /* range^2, a_ref^2, and the polynomials of sd_radial.h times 8 pi; degree: one of the kernels' */
  double range2, ref2;
  int degree;
  double coefficient[SD_RADIALS][SD_RADIAL_TERMS];
} sd_near_part;

/* The same where points stand in groups that each fit into a vector: group k has the rows first[k] ...
 * first[k + 1] - 1, and its pairs with groups are near[begin[k]] ... near[begin[k + 1] - 1], each pair once.
 * Of a pair, the number of the other group, which may be this one; and a bit for each point of the other
 * that may be within the range of one of this group. */
typedef struct {
  int other;
  unsigned points;
} sd_near_group;

typedef struct {
  int groups;
  const int *first;
  const long *begin;
  const sd_near_group *near;
} sd_near_groups;

/* Groups as they are looked at: [groups][3][SD_GROUP_LANES] floats, their points from the middle, SD_NOWHERE
 * where there is none; [3][stride] the middles */
enum { SD_GROUP_LANES = 16 };

typedef struct {
  const float *arm;
  const double *middle;
  long stride;
} sd_group_places;

/* Degrees that there are kernels for, of floats and of doubles: the polynomial is filled up with zeros. */
#define SD_NEAR_SINGLE_DEGREES(_) _(6) _(7) _(8) _(11) _(14) _(17) _(20)
#define SD_NEAR_DEGREES(_) SD_NEAR_SINGLE_DEGREES(_) _(24) _(29) _(39)

/* The first of them that is enough */
static inline int sd_near_degree(int least)
{
  int degree = 0;
#define OF_DEGREE(d) \
  if (degree < least) degree = d;
  SD_NEAR_DEGREES(OF_DEGREE)
#undef OF_DEGREE
  return degree;
}

/* Near images: each pair of a sphere and an image once, for both its spheres, in the axes of the wall,
 * lengths scaled. Sums times 8 pi and without w of the sphere. */
typedef struct {
  /* spheres near the wall, those of ours first */
  int rows, targets;
  /* all radii are alike */
  int equal;
  /* [targets + 1] as above */
  const long *first;
  const int *neighbor;
  /* [8 (rows + 1)] x y z a, w F, and which row it is, since that one is its own neighbour */
  const double *row;
  /* [4 (rows + 1)] U, and one number more; 0 before */
  double *u;
  /* range^2, a_ref^2, and the polynomials of sd_image_wave.h; degree: one of the kernels' */
  double range2, ref2;
  int degree;
  double coefficient[SD_IMAGE_FUNCTIONS][3][SD_RADIAL_TERMS];
} sd_image_part;

/* Groups: most points; and of their blocks the numbers of a row, filled up with zeros to whole vectors of
 * every set */
enum { SD_GROUP_POINTS = 12, SD_GROUP_ROW = 40 };

/* Points that stand side by side: `many` of them, from `first` on, whose windows reach size[3] points of the
 * grid from at[3] on, at most SD_RUN_WIDE each way. */
enum { SD_RUN_WIDE = 10 };

typedef struct {
  int first, many, at[3], size[3];
} sd_spread_run;

/* Spreading and interpolation. A sphere adds to the row along z at its points p, q of x and y
 *
 *   sum_t m_t(p, q) V_t,   m = phi_x phi_y,
 *                              g_xx phi_x'' phi_y + g_yy phi_x phi_y'' + 2 g_xy phi_x' phi_y',
 *                              phi_x' phi_y,  phi_x phi_y'
 *
 * V_t [points of z][3]; one term for equal radii, with torques three (all but the second); two for any
 * radii in an orthogonal box, all four with torques or in a triclinic one. g_de are products of the
 * gradients of grid coordinates. */
typedef struct {
  int n, width, terms;
  const sd_window *window;
  /* row d: gradient of grid coordinate d, 1/length; its metric xx yy zz xy xz yz */
  double gradient[3][3], metric[6];
  /* what windows need of a sphere: [n][3] its first point on the grid; [4 n] v of sd_window.h each way, and
   * b of sd_radial.h, which has no use where there is one term or three */
  const int (*corner)[3];
  const void *place;
  /* one after the other, of equal radii without torques: kernels may take these as a whole */
  int runs;
  const sd_spread_run *run;
  /* [width n] w F in the same order; or the velocities that come out */
  void *F;
  /* its first point on the grid; numbers from row to row and from layer to layer */
  void *brick;
  int lo[3];
  long row, layer;
} sd_spreading;

/* Spheres that find their place on the grid, up to so many at a time, in its frame: their coordinates, from
 * half a window before the first point on, are shift + G (x - origin). Not there are those that are not from
 * lo to hi, or as far away as that many points. */
enum { SD_STAND_MANY = 32, SD_NOT_THERE = 1000000000 };

typedef struct {
  double origin[3], gradient[3][3], shift, lo[3], hi[3], a_ref;
  double x[3][SD_STAND_MANY], a[SD_STAND_MANY];
  /* of all so far: are their radii a_ref? First and last of their corners, which is beyond SD_NOT_THERE where
   * one is not there, and their sum */
  int equal, first[3], last[3];
  int64_t sum[3];
} sd_standing;

/* Above a wall: rows along z at one wave across it, and at the opposite one; the same row twice if
 * there is no other. */
typedef struct {
  int depth;
  /* [2][6]: three fields, and three times the height */
  double *row[2][6];
  /* K of open_row, [SD_IMAGE_KERNELS][2][depth] and gamma of the first; sign of the wave along y */
  const double *K, *images;
  double gamma, sy;
} sd_image_rows;

/* Rows in so many ranges, begin and end of each [count][2]; centre: x of all rows there are, then y and z,
 * each so many numbers behind the last */
typedef struct {
  const double *centre;
  long stride;
  const int *range;
  int count;
} sd_near_ranges;

/* Which of these rows are within a distance of one of so many places [3]? Their numbers to list, which has
 * room for 8 more than there are; returns how many. */
typedef long sd_near_search(const sd_near_ranges *rows, const double *x, int places, double distance2,
                            int *list);

struct sd_ewald_kernels {
  /* of a number */
  size_t bytes;
  void (*near_part)(const sd_near_part *p);
  /* how many rows a bunch may have, of forces alone, and of unlike radii; with torques one */
  int bunch, bunch_unlike;
  /* forces alone, p->first and p->neighbor not read; NULL: vectors do not hold a group */
  void (*near_groups)(const sd_near_part *p, const sd_near_groups *g);
  /* and who is near whom: of so many groups those that have points within a distance of the middle of group
   * k, to near, which has room for all; returns how many */
  long (*groups_near)(const sd_group_places *g, int k, const int *group, long many, double distance,
                      sd_near_group *near);
  /* corners [many] and places [4 many] of sd_spreading */
  void (*stand)(sd_standing *s, int many, int (*corner)[3], void *place);
  void (*spread)(const sd_spreading *s);
  void (*interpolate)(const sd_spreading *s);
  /* one row along z of the three transforms, u = B (f - k (k.f)/k^2): B [half], k [3] at its
   * start, dkz */
  void (*periodic_row)(void *const *f, const void *B, const double *k, double dkz, int half);
  /* u = K f: K [6][half] xx yy zz xy xz yz, signs of kx and ky */
  void (*open_row)(void *const *f, const void *K, double sx, double sy, int half);
  /* Of doubles alone, NULL of floats: who is near; u [36] += scale B F [36] of a symmetric block
   * B [36][SD_GROUP_ROW]; near images; rows above a wall, u and u' of sd_image_kernel.h */
  sd_near_search *search;
  void (*own_block)(const double *B, double scale, const double *F, double *u);
  void (*image_part)(const sd_image_part *p);
  void (*image_rows)(const sd_image_rows *r);
};

SD_KERNEL_TABLES(struct sd_ewald_kernels, sd_ewald);
SD_KERNEL_TABLES(struct sd_ewald_kernels, sd_ewald_single);

/* The kernels of a splitting, of the best instruction set there is */
static inline const struct sd_ewald_kernels *sd_ewald_kernels_for(const sd_ewald *e)
{
  const sd_isa isa = sd_isa_of(SD_ISA_BEST);
  return e->single ? SD_KERNELS_OF(sd_ewald_single, plain, isa) : SD_KERNELS_OF(sd_ewald, plain, isa);
}

#endif
