/* Between the columns of a slab and their kernels, of which each instruction set has its own
 * build. */
#ifndef SD_COLUMNS_INTERNAL_H
#define SD_COLUMNS_INTERNAL_H

#include "sd_isa.h"
#include "sd_slab_wave.h"

/* So many waves at once: loops over them become vectors. */
enum { SD_COLUMN_WAVES = 16 };

/* What a wave needs to know: its direction along the slab; e^-k spacing, t1 on the lowest plane,
 * t3 on the highest, k and c; S0 and S1 of copies; sd_slab_stops, or of a floor even11 = 1
 * alone; what velocities are multiplied with. */
enum {
  SD_COLUMN_L1,
  SD_COLUMN_L2,
  SD_COLUMN_STEP,
  SD_COLUMN_T1,
  SD_COLUMN_T3,
  SD_COLUMN_K,
  SD_COLUMN_SHIFT,
  SD_COLUMN_S0,
  SD_COLUMN_S1,
  SD_COLUMN_EVEN,
  SD_COLUMN_ODD = SD_COLUMN_EVEN + 3,
  SD_COLUMN_E = SD_COLUMN_ODD + 3,
  SD_COLUMN_T,
  SD_COLUMN_UNIT,
  SD_COLUMN_NUMBERS
};

/* A group of waves: n columns. field [3]: across, and both along the slab; complex numbers side
 * by side, `plane` doubles from plane to plane of growing height. sign -1: heights grow against
 * the grid */
typedef struct {
  int n, planes, walls;
  double *field[3];
  long plane;
  double sign, first, spacing, top;
  const double *numbers, *corner;
  int corner_planes, corner_sums;
  /* [12 planes SD_COLUMN_WAVES] */
  double *work;
} sd_column_group;

struct sd_columns_kernels {
  void (*group)(const sd_column_group *g);
};

SD_KERNEL_TABLES(struct sd_columns_kernels, sd_columns);

#endif
