/* Mobility times vector, the pair part only: u_i = sum_{j != i} Omega_ij F_j. The diagonal 1/(6 pi
 * eta_i a_i) is the solver's. With a wall Omega_ij has the image of j, and there is an Omega_ii,
 * the image of the sphere itself (sd_wall.h).
 *
 * Local viscosity: Omega_ij is taken with sqrt(eta_i eta_j). Then the matrix is E^-1/2 M_1 E^-1/2
 * with M_1 the matrix of unit viscosity and E = diag(eta): symmetric and positive definite whenever
 * M_1 is.
 * Blocks are computed afresh in every product; they are never stored (72 bytes a pair would be
 * slower to read). */
#ifndef SD_PRODUCT_H
#define SD_PRODUCT_H

#include <stddef.h>

#include "sd_isa.h"
#include "sd_status.h"
#include "sd_tensor.h"
#include "sd_wall.h"

SD_BEGIN_C

/* Taper: a factor t(q), q = R/range, on every pair's block, 0 for q >= 1.
 *   wendland   (1-q)^4 (1+4q)          spherical   1 - 3q/2 + q^3/2
 * Both are positive definite functions of space and 1 at R = 0, so the tapered matrix stays
 * positive definite (Schur's product theorem), which a plain cut-off does not. It is another model:
 * the far field is screened. */
typedef enum { SD_TAPER_NONE, SD_TAPER_WENDLAND, SD_TAPER_SPHERICAL } sd_taper;

/* How two spheres interact. range: of the taper, > 0; not read without taper. wall: not with
 * Oseen's tensor; a taper is of the distance of the spheres for their images too. */
typedef struct {
  sd_tensor tensor;
  sd_taper taper;
  double range;
  sd_wall wall;
} sd_law;

/* t(R/range); 1 without taper */
double sd_taper_factor(const sd_law *law, double R);

/* Spheres that a product reads.
 *   x [3n]  centres        length
 *   a [n]   radii; 0: the sphere takes no part, neither as target nor as source
 *   w [n]   1/sqrt(eta) */
typedef struct {
  const double *x, *a, *w;
} sd_spheres;

/* Spheres that stand close together, as the points of one shell do: group g is spheres first[g] ...
 * first[g + 1] - 1, first [n + 1], and n groups are all that there are. Those of equal form, from 0 to
 * SD_GROUP_FORMS - 1, have the same spheres at the same places from each other, all with a radius, and one
 * viscosity each; form -1: it is like no other. form NULL: none is. first NULL: there are no groups. */
enum { SD_GROUP_FORMS = 16 };
typedef struct {
  int n;
  const int *first, *form;
} sd_groups;

/* Pairs as rows: targets 0 ... n-1 are the first n spheres; their sources are neighbor[first[i]]
 * ... neighbor[first[i+1]-1]. Every directed pair once. A source may be a ghost (index >= n) and
 * may be the image of any sphere, also of i itself. */
typedef struct {
  int n;
  const long *first;
  const int *neighbor;
} sd_pairs;

/* --- the product ---------------------------------------------------------------------------------
 * Kernels on a copy of the spheres in the order that they read, made once per solve; the best that
 * the processor has are taken at run time (sd_isa.h). SD_ISA_PLAIN is for lengths beyond the range of
 * vectors, whose roots begin in single precision.
 * Relative error of a pair's block: 1e-15. The order of summation is fixed: same input, same
 * instruction set, same bits.
 *
 * Vectors have `width` numbers per sphere: 3, force and velocity; or 6, force and torque, velocity
 * and angular velocity:
 *
 *   (U_i W_i) = sum_{j != i} M_ij (F_j T_j)
 *
 * M_ij: the 6x6 block of sd_tensor_grand; the tensor is RPY there, whatever the law. A wall adds to
 * both widths sum_j of sd_wall_block, j = i as well. */
struct sd_kernel;

/* Zero-initialise; sd_packed_free in the end. Members are the kernels' own. */
typedef struct {
  int width;
  /* images: NULL without wall */
  const struct sd_kernel *kernel, *images;
  /* as given; they must outlive the products */
  sd_spheres spheres;
  sd_law law;
  int n;
  /* spheres with a > 0, gathered to the front of the columns; rounded up to whole vectors */
  int active, padded;
  /* lengths below are times this power of two, so that radii are about 1, or so that a step is where
   * floats have forces alone; of floats, a step of places (sd_steps.h) in that length, and the power of
   * two that forces are taken times, so that floats hold them */
  double scale, step, unit;
  /* numbers 0 ... 5 of a sphere in the axes below, which are those of the wall: which of F or u
   * they are, and with which sign */
  int from[6];
  double sign[6];
  /* [padded] sphere of each column */
  int *index;
  /* columns [padded], of double or float; f = w F; then those of the torques */
  void *x, *y, *z, *a, *f[6];
  /* sums, of double */
  double *u[6];
  /* rows [8 (n+1)] x y z a, then w F, and [4 (n+1)] w T; the last takes the place of missing
   * neighbours */
  double *row, *torque_row;
  double *memory;
  size_t room;
} sd_packed;

void sd_packed_free(sd_packed *p);

/* Copy n spheres for products of all pairs, or for products by list (ghosts included). Memory grows
 * and is kept. SD_OK or SD_ENOMEMORY. */
sd_status sd_packed_all(sd_packed *p, sd_isa isa, const sd_law *law, const sd_spheres *s, int n,
                        int width);
/* The same for products that need no error below SD_PRODUCT_SINGLE, over the rms of w^2 F/(6 pi a): blocks
 * are of floats, sums over spheres of doubles. Both spheres of a pair have the same block. In doubles with a
 * wall, and where spheres stand farther apart than SD_PRODUCT_MOST_ACROSS of the smallest radius, or one is
 * so large. */
#define SD_PRODUCT_SINGLE 1e-5
#define SD_PRODUCT_MOST_ACROSS 4096.0
sd_status sd_packed_all_single(sd_packed *p, sd_isa isa, const sd_law *law, const sd_spheres *s, int n,
                               int width);
sd_status sd_packed_list(sd_packed *p, sd_isa isa, const sd_law *law, const sd_spheres *s, int n,
                         int width);

/* Packed for all pairs: F [width n] -> u [width n], part `part` of `parts`, whose sum over all parts
 * is the product. Each pair belongs to one part and is computed once for both its spheres; shares
 * take equal time wherever the spheres are. */
void sd_packed_share(sd_packed *p, int part, int parts, const double *F, double *u);

/* Packed for lists: F [width pairs->n] of the targets and ghosts [width (n - pairs->n)] of the
 * spheres after them, NULL if there are none -> u [width pairs->n]. */
void sd_packed_pairs(sd_packed *p, const sd_pairs *pairs, const double *F, const double *ghosts,
                     double *u);

/* Keep the pairs that interact now: centre distance up to cutoff (INFINITY: all), both radii > 0.
 *   candidates, s    in
 *   first [n+1], neighbor [candidates->first[n]]   out, caller's */
void sd_pairs_within(const sd_pairs *candidates, const sd_spheres *s, double cutoff, long *first,
                     int *neighbor);

SD_END_C
#endif
