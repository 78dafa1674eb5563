/* Numbers in the precision of a source: double, or float where it defines SD_SINGLE before, so that one
 * file is compiled for both. Memory of either is a pointer to void for who does not know which, and
 * is told how many bytes a number has. For sources only. */
#ifndef SD_REAL_H
#define SD_REAL_H

#include <stddef.h>

#ifdef SD_SINGLE
typedef float real;
#else
typedef double real;
#endif

/* Number k of memory whose numbers have so many bytes */
static inline double sd_number(const void *numbers, size_t bytes, long k)
{
  return bytes == sizeof(float) ? (double) ((const float *) numbers)[k] : ((const double *) numbers)[k];
}

static inline void sd_put_number(void *numbers, size_t bytes, long k, double value)
{
  if (bytes == sizeof(float))
    ((float *) numbers)[k] = (float) value;
  else
    ((double *) numbers)[k] = value;
}

/* Its place */
static inline void *sd_at_number(void *numbers, size_t bytes, long k)
{
  return (char *) numbers + (long) bytes * k;
}

#endif
