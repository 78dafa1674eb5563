/* The largest whole number that is not above x, |x| < 2^63: floor(), which is a call on x86-64. */
#ifndef SD_WHOLE_H
#define SD_WHOLE_H

#include <stdint.h>

static inline int64_t sd_whole_below(double x)
{
  const int64_t k = (int64_t) x;
  return k - (x < (double) k);
}

#endif
