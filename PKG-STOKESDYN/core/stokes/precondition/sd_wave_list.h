/* The longest waves of a periodic box, those that a preconditioner takes exactly (sd_waves.h). */
#ifndef SD_WAVE_LIST_H
#define SD_WAVE_LIST_H

#include "sd_ewald.h"

enum { SD_WAVES_MOST = 61, SD_WAVES_PADDED = 64, SD_WAVES_COLUMNS = 4 * SD_WAVES_PADDED };

/* A pair of waves each; those that only fill the arrays up have no strength. */
typedef struct {
  /* k = 2 pi times n times the reciprocal edges */
  int n[3][SD_WAVES_PADDED];
  /* |k|; unit vectors across it, (e k) right-handed; E */
  double k[SD_WAVES_PADDED], e[2][3][SD_WAVES_PADDED], strength[SD_WAVES_PADDED];
} sd_wave_list;

/* The longest waves of a box, |k| rising; none in an open one. Returns the largest |n_d|, at most
 * SD_WAVES_MOST; -1: out of memory. */
int sd_wave_list_of(const sd_ewald_box *box, sd_wave_list *list);

#endif
