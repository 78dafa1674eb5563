#include "sd_ewald_runs.h"

#include <stdlib.h>

#include "sd_room.h"

/* Fewer points are as soon done one by one. */
enum { FEWEST = 4 };

void sd_ewald_runs_free(sd_ewald_runs *r)
{
  free(r->run);
  *r = (sd_ewald_runs){0};
}

/* Does the run still fit with one more point? Then it has that. */
static int takes(sd_spread_run *run, const int corner[3], int points)
{
  sd_spread_run with = *run;
  for (int d = 0; d < 3; d++) {
    const int at = corner[d], end = run->at[d] + run->size[d];
    if (at < with.at[d]) with.at[d] = at;
    with.size[d] = (at + points > end ? at + points : end) - with.at[d];
    if (with.size[d] > SD_RUN_WIDE) return 0;
  }
  with.many++;
  *run = with;
  return 1;
}

/* The run that begins with this point */
static sd_spread_run run_from(int first, int n, const int *sphere, const int (*corner)[3], int points)
{
  const int *at = corner[first];
  sd_spread_run run = {first, 0, {at[0], at[1], at[2]}, {points, points, points}};
  for (int i = first; i < n && run.many < SD_GROUP_POINTS; i++)
    if ((i > first && sphere[i] != sphere[i - 1] + 1) || !takes(&run, corner[i], points)) break;
  return run;
}

sd_status sd_ewald_runs_find(sd_ewald_runs *r, int n, const int *sphere, const int (*corner)[3], int points)
{
  r->n = 0;
  for (int i = 0; i < n;) {
    const sd_spread_run run = run_from(i, n, sphere, corner, points);
    i += run.many > 0 ? run.many : 1;
    if (run.many < FEWEST) continue;
    if (!sd_extend(&r->run, sizeof(run), (size_t) r->n + 1, &r->room)) return SD_ENOMEMORY;
    r->run[r->n++] = run;
  }
  return SD_OK;
}
