/* The next neighbours of a particle, a vector of pairs at a time. How the loops are written:
 *
 * Rows of four numbers are loaded whole, since neighbours lie anywhere in memory, and transposed:
 * then lane k of every vector is the pair of i with j[k]. What belongs to i stays in registers
 * until its neighbours are through. A half list gives each pair to one of its two particles; what
 * the other one, j, gets is added to its row in memory at once. A list both ways gives it to both:
 * twice the arithmetic, but no j is written to, which for long rows is most of the work.
 *
 * Lanes of neighbours that are too far, and of the filler, carry zeros, because G or K are 0
 * there: a test for each lane would cost more. So nothing in a lane may be infinite or undefined,
 * were it multiplied by 0 or not.
 *
 * The order of the sums depends on the list, and so on the number of ranks, to rounding. */
#ifndef SD_SPH_NEIGHBOURS_H
#define SD_SPH_NEIGHBOURS_H

#include "sd_sph_lanes.h"
#include "sd_sph_internal.h"

/* Coefficient NAME of the pairs of i with j, and masses of j. */
#define PAIR_NAME(k, NAME) row[p->cls[j[k]]].NAME
#define MASS_OF(k, p) (p)->m[j[k]]
#define COEFFICIENT(NAME) (many ? (vec) LANEWISE(PAIR_NAME, NAME) : all(row->NAME))
#define MASSES (many ? (vec) LANEWISE(MASS_OF, p) : mi)
#define ROW_OF(i) (model->pair + (many ? (size_t) p->cls[i] * model->nclasses : 0))

/* The next of `left` neighbours; the last ones are filled up with the far-away particle. They stand in the
 * list or, where that has not got them as they are, in room. */
INLINE const int *next(const int *neighbor, int left, int mask, int filler, int room[LANES])
{
  if (left >= LANES && mask == ~0) return neighbor;
  for (int k = 0; k < LANES; k++) room[k] = k < left ? neighbor[k] & mask : filler;
  return room;
}

/* Of the next of `left` neighbours: those that are none of these fillers, as bits. */
INLINE unsigned neighbours_of(int left)
{
  return left < LANES ? (1u << left) - 1u : ~0u;
}

/* From the neighbours j to the row x4 of i: d, its square, and their last column. */
typedef struct {
  vec d[3], r2, last;
} places;
INLINE places from(const double *x4, const int j[LANES], row4 xi)
{
  places at = {.r2 = all(0.0)};
  vec b[4];
  gather(x4, 4, j, b);
  for (int c = 0; c < 3; c++) {
    at.d[c] = xi[c] - b[c];
    at.r2 += at.d[c] * at.d[c];
  }
  at.last = b[3];
  return at;
}

INLINE void add4(double *row, row4 more)
{
  store4(row, load4(row) + more);
}

#define PHASE_OF(k, phase) phase[j[k]]
INLINE yes_no phases(const int *phase, const int j[LANES])
{
  return (yes_no) LANEWISE(PHASE_OF, phase);
}

#endif
