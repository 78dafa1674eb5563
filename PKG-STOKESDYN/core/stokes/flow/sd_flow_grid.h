/* A flow given at the nodes of a grid: velocity and, if wanted, viscosity, steady or as a series of
 * frames in time. Between nodes, and between frames, every value is linear in each direction:
 *
 *   u(x, t) = sum_abcd  X_a(x) Y_b(y) Z_c(z) T_d(t) u_abcd,   X_a(x) = 1 - |x - x_a|/h by node a
 *
 * so that a flow linear in x, y, z and t comes out exactly, and any other with an error of
 * h^2 |u''|/8 in space and tau^2 |u_tt|/8 in time. The gradient is that of this formula: of first
 * order, and it jumps from cell to cell.
 *
 * An axis may be uneven, and one of a single node says that nothing varies along it. Arrays belong
 * to the caller and are only read. */
#ifndef SD_FLOW_GRID_H
#define SD_FLOW_GRID_H

#include "sd_status.h"

#include <stddef.h>

SD_BEGIN_C

/* Beyond the first and the last node: there is no value; that of the end; or all over again, with
 * the period from the first node to the last, which are one and the same place. */
typedef enum { SD_OUTSIDE_NONE, SD_OUTSIDE_CLAMP, SD_OUTSIDE_PERIODIC } sd_outside;

typedef struct {
  int n;
  /* [n] ascending */
  const double *at;
  sd_outside outside;
  /* cells per length; 0: the axis is uneven */
  double density;
} sd_grid_axis;

/* Makes an axis of n >= 1 nodes at[n], finite numbers. Returns 0, or k > 0 where at[k] is not above
 * at[k - 1]: there is no axis then. */
int sd_grid_axis_init(sd_grid_axis *axis, int n, const double *at, sd_outside outside);

enum { SD_GRID_X, SD_GRID_Y, SD_GRID_Z, SD_GRID_TIME, SD_GRID_AXES };

typedef struct {
  sd_grid_axis axis[SD_GRID_AXES];
  /* 3: velocity; 4: and viscosity */
  int columns;
  /* [nt][nz][ny][nx][columns] */
  const double *value;
} sd_flow_grid;

/* How many numbers value[] holds. */
size_t sd_flow_grid_size(const sd_flow_grid *grid);

/* The number in value[] that no flow has, one that is not finite or a viscosity <= 0: the first of
 * them, or the size of the grid where all is well. */
size_t sd_flow_grid_fault(const sd_flow_grid *grid);

/* By how much the last node of a periodic axis differs from the first, which is the same place: the
 * largest difference of a column over the largest magnitude of that column's kind (velocity or
 * viscosity). 0 on other axes. */
double sd_flow_grid_seam(const sd_flow_grid *grid, int axis);

/* A moment of the series: `next` NULL, or with the weight of the later frame. */
typedef struct {
  const double *now, *next;
  double weight;
} sd_flow_frame;

/* SD_EOUTSIDE: the series has no value at this time; SD_ENOTFINITE: the time is no number. */
sd_status sd_flow_grid_frame(const sd_flow_grid *grid, double time, sd_flow_frame *frame);

/* The flow at n points.
 *   x         [n][3]
 *   value     [n][columns]  out
 *   gradient  [n][9]        out, or NULL; gradient[3 p + q] = d u_p / d x_q as in sd_flow.h
 * Of a point outside of the grid, or one that is not finite, all that comes out is NaN. */
void sd_flow_grid_at(const sd_flow_grid *grid, const sd_flow_frame *frame, int n, const double *x,
                     double *value, double *gradient);

SD_END_C
#endif
