/* Places in numbers of 32 bits that lose no digits: a coordinate is a whole number of steps, and where the
 * sources are of floats (SD_SINGLE) the memory of a float holds it. Differences up to half of all steps are
 * exact before they become floats, wherever the places are. In doubles a coordinate is a coordinate. For
 * sources only. */
#ifndef SD_STEPS_H
#define SD_STEPS_H

#include <stdint.h>

#include "sd_lanes.h"

/* Coordinate a less b, in steps */
#ifndef SD_SINGLE
INLINE vec steps_between(vec a, vec b)
{
  return a - b;
}
#elif LANES == 1
INLINE vec steps_between(vec a, vec b)
{
  uint32_t m, n;
  memcpy(&m, &a, sizeof(m));
  memcpy(&n, &b, sizeof(n));
  return (float) (int32_t) (m - n);
}
#else
typedef uint32_t whole_numbers __attribute__((vector_size(VEC_BYTES)));

INLINE vec steps_between(vec a, vec b)
{
  return __builtin_convertvector((yes_no) ((whole_numbers) a - (whole_numbers) b), vec);
}
#endif

/* The same times the length of a step, which doubles have not got */
INLINE vec length_between(vec a, vec b, vec step)
{
  return sizeof(real) == sizeof(float) ? steps_between(a, b) * step : steps_between(a, b);
}

#endif
