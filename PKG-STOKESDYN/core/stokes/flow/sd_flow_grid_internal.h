/* Between sd_flow_grid.c and the look-up of each instruction set. */
#ifndef SD_FLOW_GRID_INTERNAL_H
#define SD_FLOW_GRID_INTERNAL_H

#include "sd_flow_grid.h"
#include "sd_isa.h"

/* Where a coordinate lies on an axis: between node `cell` and the next one. */
typedef struct {
  int cell;
  /* of the next node; what a length is in units of the cell. Both 0 on an axis of one node. */
  double weight, per_length;
} sd_grid_cell;

/* SD_OK; SD_ENOTFINITE; SD_EOUTSIDE */
sd_status sd_grid_cell_of(const sd_grid_axis *axis, double x, sd_grid_cell *p);

struct sd_flow_grid_kernels {
  /* sd_flow_grid_at */
  void (*at)(const sd_flow_grid *grid, const sd_flow_frame *frame, int n, const double *x,
             double *value, double *gradient);
};

SD_KERNEL_TABLES(struct sd_flow_grid_kernels, sd_flow_grid);

#endif
