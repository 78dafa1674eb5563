/* Processor time, and medians of it. Define _POSIX_C_SOURCE 200809L first. */
#ifndef CPU_H
#define CPU_H

#include <stdlib.h>
#include <time.h>

/* Processor time of this process, s */
static inline double cpu(void)
{
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

static inline int ascending(const void *a, const void *b)
{
  const double x = *(const double *) a, y = *(const double *) b;
  return (x > y) - (x < y);
}

/* Of t [n], n odd; sorts it. */
static inline double median(double *t, int n)
{
  qsort(t, (size_t) n, sizeof(double), ascending);
  return t[n / 2];
}

#endif
