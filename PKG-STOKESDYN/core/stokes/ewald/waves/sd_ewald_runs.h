/* Runs of points that stand side by side on the grid, for kernels that spread and interpolate them together:
 * such as follow each other here and among the spheres, as those of a shell do, and whose windows reach few
 * points of the grid. */
#ifndef SD_EWALD_RUNS_H
#define SD_EWALD_RUNS_H

#include "sd_ewald_kernels.h"
#include "sd_status.h"

SD_BEGIN_C

/* Zero-initialise; sd_ewald_runs_free in the end. */
typedef struct {
  int n;
  sd_spread_run *run;
  size_t room;
} sd_ewald_runs;

/* Of n spheres sphere[], whose windows of so many points begin at corner[]. SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_runs_find(sd_ewald_runs *r, int n, const int *sphere, const int (*corner)[3], int points);

void sd_ewald_runs_free(sd_ewald_runs *r);

SD_END_C
#endif
