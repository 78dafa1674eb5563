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

#include "sd_ewald_chosen.h"
#include "sd_ewald_sizes.h"
#include "sd_status.h"

SD_BEGIN_C

/* See sd_ewald_choose_positive: of spheres, and of points of shells with the one-body addition
 * (sd_multiblob.h) */
#define SD_EWALD_POSITIVE 0.6
#define SD_EWALD_POSITIVE_ADDITION 0.5

/* From this tolerance on sums that have no walls and draw no noise are of floats, whose own error is
 * below a tenth of it; unless the range is a thousand radii, which few spheres in a huge box have, or
 * squares of lengths are beyond what floats hold. */
#define SD_EWALD_SINGLE 1e-5

/* The rule, for a box and its spheres.
 *   width       3, or 6 with torques
 *   tolerance   1e-13 ... 1e-1; outside of it the nearest of these is taken
 * Waves end at a band.
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

/* Do tables made for one splitting serve the other? An open box may stand elsewhere, but not nearer
 * to a wall. */
int sd_ewald_same_tables(const sd_ewald *made, const sd_ewald *wanted);

SD_END_C
#endif
