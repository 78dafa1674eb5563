/* Define _POSIX_C_SOURCE 200809L first. */
#ifndef CPU_H
#define CPU_H

#include <time.h>

/* Processor time of this process, s */
static double cpu(void)
{
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

#endif
