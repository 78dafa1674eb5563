/* The resistance of a pair of spheres as matrices in space. */
#ifndef PAIR_BLOCKS_H
#define PAIR_BLOCKS_H

#include "sd_pair_resistance.h"

/* block = along dd + across (1 - dd), a 3x3 part of a 6x6 */
static inline void put_symmetric(double along, double across, const double d[3], double *block)
{
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++)
      block[6 * p + q] = (along - across) * d[p] * d[q] + (p == q ? across : 0.0);
}

/* block = s [d]x, the matrix of s d x v */
static inline void put_cross(double s, const double d[3], double *block)
{
  block[0] = block[7] = block[14] = 0.0;
  block[1] = -(block[6] = s * d[2]);
  block[12] = -(block[2] = s * d[1]);
  block[8] = -(block[13] = s * d[0]);
}

/* The 6x6 blocks of two spheres, row-major: rows F T, columns U W, d [3] a unit vector from 1 to 2. Block 21 is the
 * transpose of 12. */
static inline void pair_blocks(const sd_pair_resistance *R, const double d[3], double B11[36], double B12[36],
                               double B22[36])
{
  static const int row[3] = {0, 0, 1}, column[3] = {0, 1, 1};
  double *const blocks[3] = {B11, B12, B22};
  for (int b = 0; b < 3; b++) {
    double *B = blocks[b];
    put_symmetric(R->XA[b], R->YA[b], d, B);
    put_symmetric(R->XC[b], R->YC[b], d, B + 21);
    put_cross(R->YB[2 * column[b] + row[b]], d, B + 3);
    put_cross(-R->YB[2 * row[b] + column[b]], d, B + 18); /* U x d = -d x U */
  }
}

#endif
