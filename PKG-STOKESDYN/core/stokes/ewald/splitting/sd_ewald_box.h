/* The box of an Ewald sum. */
#ifndef SD_EWALD_BOX_H
#define SD_EWALD_BOX_H

#include "sd_extern_c.h"

SD_BEGIN_C

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

/* Length of edge d of the box, since a grid spans the edges and not the widths; and the smallest distance
 * between opposite faces */
double sd_ewald_edge_length(const sd_ewald_box *b, int d);
double sd_ewald_narrowest(const sd_ewald_box *b);

/* An open box for spheres with centres within lo [3] ... hi [3] (of all ranks): the present one if
 * it can hold them and no edge is more than 1.5 times what they need, else one with a twentieth of
 * their extent to spare on each side, so that it lasts while they move. It stands around their
 * middle and goes along with them, but not along the direction `still`, that of a wall (-1: there is
 * none). A box with edge[0] = 0 is none. Returns 1 if the edges are new ones. */
int sd_ewald_box_around(sd_ewald_box *box, int still, const double *lo, const double *hi,
                        double largest);

/* The next even number whose only prime factors are 2, 3, 5 and 7, and that has neither 63 nor 81 among its
 * factors: fast to transform. */
int sd_ewald_transformable(double at_least);

SD_END_C
#endif
