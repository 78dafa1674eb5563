/* How the sum over all spheres and all their periodic images is split: the numbers that the engine
 * `ewald` (sd_mobility.h) works with, chosen from the tolerance by a rule, without a search and
 * without a clock, so that they are the same on every rank and after a restart.
 *
 *   M_ij = wave part + sum over images [ RPY_ij(r) - D_ij(r) ]
 *   wave part = 1/V sum_{k != 0} exp(ik.r) H(k)/(eta k^2) (I - kk/k^2) g_i g_j
 *   H = (1 + x - a_ref^2 k^2/3) exp(-x),   x = k^2/(4 xi^2),   g_i = 1 - (a_i^2 - a_ref^2) k^2/6
 *
 * Without a wall x grows faster than that, so that H ends at a wave (sd_radial.h), which
 * needs less than half of the grid. H is >= 0 with either, and draws noise; and the larger x is, the
 * more positive is the near part.
 *
 * D is the wave part of one pair in open space, so near pairs keep the Rotne-Prager-Yamakawa tensor
 * as it is: any radii, any overlap, also of a sphere with its own image. The wave part goes by FFT
 * on a grid. Torques: (i/2) k x instead of g.
 *
 * The periodic sum leaves k = 0 out: velocities are those against zero flux of the mixture.
 * Source: Hasimoto 1959; Lindbo & Tornberg 2010; the radius a_ref in H is our own. */
#ifndef SD_EWALD_H
#define SD_EWALD_H

#include "sd_status.h"
#include "sd_wall.h"

SD_BEGIN_C

/* --- what is chosen --- */

/* The box with edges (lx 0 0), (xy ly 0), (xz yz lz). Spheres may stand outside of a periodic one;
 * an open one holds the centres of all and has no tilt: nothing is beyond it but fluid.
 *   edge [3]   lx ly lz      length, > 0
 *   tilt [3]   xy xz yz      length */
typedef struct {
  int periodic;
  double origin[3], edge[3], tilt[3];
} sd_ewald_box;

/* length^3 */
static inline double sd_ewald_volume(const sd_ewald_box *box)
{
  return box->edge[0] * box->edge[1] * box->edge[2];
}

/* 2 pi times the reciprocal edges, 1/length: row d is across the other two edges and has 2 pi along
 * edge d, so that the wave of numbers n has k = n_1 k[0] + n_2 k[1] + n_3 k[2]. */
void sd_ewald_reciprocal(const sd_ewald_box *box, double k[3][3]);

/* Images in a plane wall, of an open box: they have a smooth part of their own on the same grid
 * (sd_image_wave.h), and what it leaves of a pair ends at a range, from a sphere to an image. */
typedef struct {
  /* sign 0: there is no wall */
  sd_wall wall;
  double xi, range;
  /* 0: the filters are those of a Gaussian; else their waves end here, 1/length (sd_image_wave.h) */
  double band;
} sd_ewald_images;

/* A box that is periodic in two directions alone (sd_slab.h), as a periodic one that is taller: the
 * direction that is not, and how many planes of the grid across it hold something; 0: all, and there is
 * no such direction */
typedef struct {
  int across, planes;
} sd_ewald_slab;

/* What an engine is made from. Ready after sd_ewald_choose; all lengths as given. */
typedef struct {
  sd_ewald_box box;
  /* no spheres: 0, and the rest is not read */
  double count;
  /* splitting, 1/length; its reference radius; where the near part ends, centre to centre; the
   * largest sphere */
  double xi, a_ref, range, largest;
  /* 0: H is a Gaussian's; else waves end here, 1/length (sd_radial.h), and velocities are wanted of spheres
   * (sized) or at points, where a_ref is of the sources alone */
  double band;
  int sized;
  /* near pairs, windows, grid and its transforms are of floats (SD_EWALD_SINGLE) */
  int single;
  /* how far ghosts must reach: range, or that of images */
  double reach;
  /* grid points of the box each way; those of an open box are an eighth of the grid, which is
   * twice as large; no spacing is larger than this one, which an open box has */
  int grid[3];
  double spacing;
  /* the window: so many grid points each way, and its parameter (Kaiser-Bessel) */
  int points;
  double beta;
  /* what was asked for: rms error of U over rms of F/(6 pi eta a) */
  double tolerance;
  /* xi of a smoother splitting, whose waves these spheres have too: this one's are less by them
   * (sd_ewald_levels.h). 0: there is none */
  double taken;
  /* both parts are positive: xi times the largest radius is at most this. 0: nobody asked for that */
  double positive;
  sd_ewald_images images;
  sd_ewald_slab slab;
} sd_ewald;

/* --- the choice --- */

/* See sd_ewald_choose_positive: of spheres, and of points of shells with the one-body addition
 * (sd_multiblob.h) */
#define SD_EWALD_POSITIVE 0.6
#define SD_EWALD_POSITIVE_ADDITION 0.5

/* From this tolerance on sums that have no walls and draw no noise are of floats, whose own error is
 * below a tenth of it; unless the range is a thousand radii, which few spheres in a huge box have. */
#define SD_EWALD_SINGLE 1e-5

/* The widest window; classes of radii */
enum { SD_EWALD_MOST_POINTS = 20, SD_EWALD_OCTAVES = 10 };

/* The spheres that take part, of all ranks: how many, sums of a^2 and a^4, the largest a; length.
 * The rule reads them rounded to six digits, since sums over ranks differ in the last ones. */
typedef struct {
  double count, squares, fourths, largest;
} sd_ewald_class;

/* All of them; and by octaves, which only sd_ewald_levels.h reads: k has those from
 * largest/2^(k + 1) to largest/2^k, that one not included except in octave 0, and the last all that
 * are smaller. */
typedef struct {
  sd_ewald_class all, octave[SD_EWALD_OCTAVES];
} sd_ewald_sizes;

/* One more sphere; all.largest is known already. */
void sd_ewald_count(sd_ewald_sizes *s, double a);

/* The rule, for a box and its spheres.
 *   width       3, or 6 with torques
 *   tolerance   1e-13 ... 1e-1; outside of it the nearest of these is taken
 * Waves end at a band at 1e-10 and looser tolerances.
 * SD_OK, SD_ENOTFINITE for a box without volume, numbers that are not finite or a tolerance that
 * is not > 0, SD_ENOMEMORY for a grid of more than 2^31 points. */
sd_status sd_ewald_choose(const sd_ewald_box *box, const sd_ewald_sizes *sizes, int width,
                          double tolerance, sd_ewald *out);

/* The same for random numbers whose covariance is the sum: xi times the largest radius is at most
 * `bound`. With SD_EWALD_POSITIVE wave part and near part are each positive definite in every
 * scene that was tried, overlaps too (at 0.7 some were not). The addition of shells is negative and
 * belongs to the near part: with SD_EWALD_POSITIVE_ADDITION that is positive in suspensions up to a
 * volume fraction of 0.5 (at 0.6 it is not at 0.45). */
sd_status sd_ewald_choose_positive(const sd_ewald_box *box, const sd_ewald_sizes *sizes, int width,
                                   double tolerance, double bound, sd_ewald *out);

/* The same for spheres in an open box above a wall, with their images (sd_image_kernel.h); forces
 * alone. */
sd_status sd_ewald_choose_at_wall(const sd_ewald_box *box, const sd_wall *wall,
                                  const sd_ewald_sizes *sizes, double tolerance, sd_ewald *out);

/* The same for spheres in a box that is not periodic in the direction `across`, where their centres span
 * so much: a periodic box is made of it whose edge there has room for them, for windows at both ends and
 * for the range beside them. Forces alone, one level, and no tilt.
 *   box    origin and edges along the other two directions
 *   gap    between two walls, their distance and twice the smallest radius; INFINITY: there are no two
 * out->images has the splitting of images in a wall, and no wall. */
sd_status sd_ewald_choose_in_slab(const sd_ewald_box *box, int across, double span, double gap,
                                  const sd_ewald_sizes *sizes, double tolerance, sd_ewald *out);

/* The flow at points of a periodic box, which have no size: waves end at `band`, for a shorter range on
 * a coarser grid. points: how many; only `all` of the sizes is read, and all radii may be 0. */
sd_status sd_ewald_choose_at_points(const sd_ewald_box *box, const sd_ewald_sizes *sizes, int width,
                                    double points, double tolerance, sd_ewald *out);

/* An open box for spheres with centres within lo [3] ... hi [3] (of all ranks): the present one if
 * it can hold them and no edge is more than 1.5 times what they need, else one with a twentieth of
 * their extent to spare on each side, so that it lasts while they move. It stands around their
 * middle and goes along with them, but not along the direction `still`, that of a wall (-1: there is
 * none). A box with edge[0] = 0 is none. Returns 1 if the edges are new ones. */
int sd_ewald_box_around(sd_ewald_box *box, int still, const double *lo, const double *hi,
                        double largest);

/* Do tables made for one splitting serve the other? An open box may stand elsewhere, but not nearer
 * to a wall. */
int sd_ewald_same_tables(const sd_ewald *made, const sd_ewald *wanted);

/* The next number whose only prime factors are 2, 3, 5 and 7: fast to transform */
int sd_ewald_transformable(double at_least);

SD_END_C
#endif
