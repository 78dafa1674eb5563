/* Neighbour lists of our own: which spheres see which.
 *
 * LAMMPS's lists leave out what contacts do not need (neigh_modify exclude molecule/intra,
 * special_bonds), and those are the very pairs that hydrodynamics needs. So the pairs are found
 * here, from the same owned and ghost atoms, once per re-neighbouring. */
#ifndef SD_NEIGHBOR_H
#define SD_NEIGHBOR_H

#include <stdint.h>

#include "sd_product.h"
#include "sd_status.h"

SD_BEGIN_C

/* Pairs with their memory; zero-initialise, sd_neighbors_free in the end. */
typedef struct {
  sd_pairs pairs;
  long *first;
  int *neighbor;
  size_t first_room, room;
} sd_neighbors;

void sd_neighbors_free(sd_neighbors *list);

/* Room for rows targets and count pairs; contents are kept. SD_OK or SD_ENOMEMORY. */
sd_status sd_neighbors_reserve(sd_neighbors *list, int rows, long count);

/* All directed pairs closer than cutoff: targets 0 ... n-1, sources 0 ... n_all-1, a target is no
 * source of its own.
 *   x [3 n_all], cutoff finite > 0. By cells of side cutoff: O(n_all + pairs).
 * SD_OK or SD_ENOMEMORY. */
sd_status sd_neighbors_cutoff(sd_neighbors *list, const double *x, int n, int n_all, double cutoff);

/* The smallest gap between spheres that are not of one body:
 * xi = 2 (R - a_i - a_j) / (a_i + a_j), the least over i < n and j < n_all whose centres are within
 * reach; negative for spheres that overlap, INFINITY: there are none so near.
 *   x [3 n_all], a [n_all]; body [n_all]: spheres of one body, not 0, have no gap. NULL: all free
 * SD_OK or SD_ENOMEMORY. */
sd_status sd_smallest_gap(const double *x, const double *a, const int64_t *body, int n, int n_all,
                          double reach, double *gap);

/* The close pairs, for lubrication: those with R <= reach (a_i + a_j)/2, each once: in row i < n its
 * partners j > i among spheres 0 ... n_all - 1, the n of this rank and their ghosts. reach is in
 * units of the mean radius of the pair, 2 at contact, and lubrication up to a gap of xi mean radii
 * wants 2 + xi. Radius 0: takes no part. O(n_all + pairs) for each power of two between the smallest
 * and the largest radius. SD_OK or SD_ENOMEMORY. */
sd_status sd_near_once(sd_neighbors *list, const sd_spheres *s, int n, int n_all, double reach);

/* The same list, kept from call to call; zero-initialise, sd_near_free in the end. */
typedef struct {
  /* pairs within the reach, and others with a skin (sd_skin.h) that are not */
  sd_neighbors list;
  /* when it was made: its n, n_all and reach, and [4 n_all] where spheres stood and their radii */
  int n, n_all;
  double reach, *stood;
  size_t stood_room;
} sd_near;

/* near->list: made anew, or as it is while it holds. Its order is that of its making. As sd_near_once. */
sd_status sd_near_keep(sd_near *near, const sd_spheres *s, int n, int n_all, double reach);
void sd_near_free(sd_near *near);

/* Spheres and who they are: x [3 n_all], tag [n_all], molecule [n_all] */
typedef struct {
  const double *x;
  const int64_t *tag, *molecule;
} sd_named;

/* All directed pairs of one clump: equal molecule ID, not 0. Each partner once, as the image
 * closest to the target (ghosts of one sphere share its tag; the first in order of index wins a
 * tie), and closer than cutoff (INFINITY: the whole clump).
 *   order [n_all]   scratch;  on return sorted by molecule, tag, index */
sd_status sd_neighbors_clump(sd_neighbors *list, const sd_named *s, int n, int n_all, double cutoff,
                             int *order);

/* Tensor oseen knows no size of the spheres: the largest entry that any pair has along its axis in
 * the matrix scaled to unit diagonal, t 3 sqrt(ai aj)/(2R) with the taper t. From 1 on the matrix
 * is not positive definite, whoever else is there.
 * Targets begin ... begin + n - 1, sources 0 ... n_all - 1 up to law->range (INFINITY: no cut-off)
 * away.
 *   pairs      who sees whom; NULL: everybody. That goes by cells of 1.6 times the largest radius,
 *              in O(n_all) unless the radii are very different, and pairs farther apart than that
 *              may be left out.
 *   coupling   out; 0 without pairs, INFINITY for spheres at one point. Radius 0: takes no part.
 * SD_OK or SD_ENOMEMORY. */
sd_status sd_oseen_coupling(const sd_law *law, const sd_spheres *s, const sd_pairs *pairs,
                            int n_all, int begin, int n, double *coupling);

SD_END_C
#endif
