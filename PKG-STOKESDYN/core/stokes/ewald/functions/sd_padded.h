/* A smooth function of space, known at every offset, as what the transform of a padded grid is
 * multiplied with.
 *
 * It is sampled at the offsets of the grid, beyond which a taper takes it to 0; its transform is
 * freed of the windows (w^ twice); and of the result the offsets within the box are kept. The grid
 * around them is wider than the box by a fixed number of points: long boxes need no more than others.
 * The error is below the window's, down to 1e-13.
 * Source: our own; the usual way, a kernel cut off at a sphere around the box (Vico, Greengard &
 * Ferrando 2016), takes a cube of the box's longest edge. */
#ifndef SD_PADDED_H
#define SD_PADDED_H

#include <math.h>

#include "sd_ewald.h"
#include "sd_status.h"

SD_BEGIN_C

/* The most numbers that the kernels of an offset are made from */
enum { SD_PADDED_NUMBERS = 4 };

/* Several kernels of an offset R, each even or odd in each direction. */
typedef struct {
  const sd_ewald *ewald;
  /* the wave beyond which there are only rounding errors, 1/length */
  double last;
  int kernels;
  /* what the kernels share at a distance, even and as smooth as they are: number [SD_PADDED_NUMBERS] */
  void (*numbers)(const sd_ewald *e, double distance, double *number);
  /* one of them; with a minus if it is odd in two directions, which two sine transforms bring */
  double (*value)(const sd_ewald *e, int kernel, const double *number, const double *R);
  /* [kernels] */
  const int (*odd)[3];
  /* across: the first direction is neither even nor odd, and begins with the offset `start`; else both
   * are 0 */
  int across;
  double start;
} sd_padded;

/* exp(-37) = 1e-16 */
static inline double sd_padded_last_of(double xi)
{
  return 2.0 * xi * sqrt(37.0);
}

/* size [3]: points of the transform each way, even; y, z [2]: first and end of the waves >= 0 that
 * are wanted of the last two; table [y][size 0/2 + 1][kernels][z], out; across: [kernels][re, im][z].
 * SD_OK or SD_ENOMEMORY. */
sd_status sd_padded_table(const sd_padded *k, const int *size, const int *y, const int *z,
                          double *table);

SD_END_C
#endif
