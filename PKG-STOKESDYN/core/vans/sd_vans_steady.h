/* Has a run come to its steady state, and what are its means? A series of samples in blocks, of two
 * numbers at a time (transport and stress).
 *
 * Samples are kept as means over blocks of equal length. When there are SD_VANS_BLOCKS of them two
 * and two become one, and blocks are twice as long: a series of any length in the same room.
 *
 * The start is cut off where the mean of the rest has the smallest error as if blocks were
 * independent (the marginal standard error rule, White 1997). The error of that mean is the largest
 * of: the standard errors from blocks, from pairs and from fours of them (what is correlated looks
 * better than it is in blocks that are too short), and half the difference between the means of
 * both halves (a drift). Fewer than 16 blocks, or a cut in the second half: it is not steady, and
 * the error is the range of the blocks or the mean, whichever is larger. */
#ifndef SD_VANS_STEADY_H
#define SD_VANS_STEADY_H

#include "sd_extern_c.h"

SD_BEGIN_C

enum { SD_VANS_BLOCKS = 128, SD_VANS_SERIES = 2 };

/* Numbers only, so that it can be written and read as one array. Zeros: no samples. */
typedef struct {
  /* blocks that are full; samples in a block, 0: one; samples in the block that is not full */
  double blocks, length, filled;
  double sum[SD_VANS_SERIES];
  double block[SD_VANS_SERIES][SD_VANS_BLOCKS];
} sd_vans_series;

void sd_vans_series_add(sd_vans_series *series, const double sample[SD_VANS_SERIES]);

/* Of one of the numbers; returns whether it is steady. No full block: 0 and 0. */
int sd_vans_series_mean(const sd_vans_series *series, int which, double *mean, double *error);

SD_END_C
#endif
