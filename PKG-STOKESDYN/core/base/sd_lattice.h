/* Images of a periodic box, with the edges (h0 0 0), (h5 h1 0), (h4 h3 h2): h in the order of LAMMPS, xx
 * yy zz yz xz xy. */
#ifndef SD_LATTICE_H
#define SD_LATTICE_H

#include "sd_extern_c.h"

SD_BEGIN_C

/* Makes the separation d the shortest of its images in a box of which the edges with periodic = 1
 * repeat. In a skew box this need not be LAMMPS's minimum image. Whatever d is, 1e300 or not a
 * number, it comes back at once. */
void sd_closest_image(const double h[6], const int periodic[3], double d[3]);

/* Moves x to its image that is closest to `to`; steps: by how many edges, 0 where that is no number
 * below 1e9. */
void sd_bring_close(const double h[6], const int periodic[3], const double to[3], double x[3],
                    int steps[3]);

/* x += steps edges; h: those of another time, or their rates */
static inline void sd_add_edges(const double h[6], const int steps[3], double x[3])
{
  x[0] += steps[0] * h[0] + steps[1] * h[5] + steps[2] * h[4];
  x[1] += steps[1] * h[1] + steps[2] * h[3];
  x[2] += steps[2] * h[2];
}

/* A vector in units of the edges, so that faces are planes of equal coordinates */
static inline void sd_in_edges(const double h[6], const double r[3], double f[3])
{
  f[2] = r[2] / h[2];
  f[1] = (r[1] - h[3] * f[2]) / h[1];
  f[0] = (r[0] - h[5] * f[1] - h[4] * f[2]) / h[0];
}

/* A box: its lower corner and its edges */
typedef struct {
  double lo[3], h[6];
} sd_box;

/* A move of a point that a box carries along, from where it stands in the box `start` to the box `to`: in
 * units of the edges, which do not change where the box carries all,
 *   x <- lo_to + H_to [ H_start^-1 (x - lo_start) + H_at^-1 move ],
 * move [3]: in space, as it is in the box `at`. For a simple shear, with `at` half a step before `to`, this
 * is S(dt) x + S(dt/2) move: the shear carries a random displacement for the half step that is left. A
 * point and its images make moves that differ by what the edges have grown, to rounding. */
void sd_box_step(const sd_box *start, const sd_box *at, const sd_box *to, const double move[3],
                 double x[3]);

/* A length across the faces of edge d, which are volume / (their area) apart, in units of that */
double sd_across_faces(const double h[6], int d, double length);

SD_END_C
#endif
