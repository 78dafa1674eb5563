#include "sd_flow_grid_internal.h"

#include "sd_interval.h"

#include <math.h>

/* Nodes count as even when none is off its place by more than this part of a cell: the weight of a
 * node is then off by as much, which is rounding in the coordinates that a file gives. */
#define EVEN 1e-12

int sd_grid_axis_init(sd_grid_axis *axis, int n, const double *at, sd_outside outside)
{
  for (int k = 1; k < n; k++)
    if (!(at[k] > at[k - 1])) return k;

  const double density = n > 1 ? (n - 1) / (at[n - 1] - at[0]) : 0.0;
  int even = n > 1;
  for (int k = 1; k < n && even; k++) even = fabs((at[k] - at[0]) * density - k) <= EVEN;
  *axis = (sd_grid_axis){n, at, outside, even ? density : 0.0};
  return 0;
}

/* The last node at or below x, but for the last of all: a point on the last node belongs to the cell
 * before it, with weight 1, and nothing beyond value[] is read. Even axes, which nearly all are, need
 * no search. */
static inline int cell_of(const sd_grid_axis *axis, double x)
{
  if (axis->density > 0.0) {
    const int cell = (int) ((x - axis->at[0]) * axis->density);
    return cell < axis->n - 1 ? cell : axis->n - 2;
  }
  return sd_interval(axis->at, axis->n - 1, x);
}

/* Puts x where the axis has it. held: it is beyond an end whose value is held. */
static sd_status move_inside(const sd_grid_axis *axis, double *x, int *held)
{
  const double first = axis->at[0], last = axis->at[axis->n - 1];
  if (!isfinite(*x)) return SD_ENOTFINITE;
  if (axis->outside == SD_OUTSIDE_NONE) return SD_EOUTSIDE;
  *held = axis->outside == SD_OUTSIDE_CLAMP;
  if (!*held) *x -= (last - first) * floor((*x - first) / (last - first));
  // Moved by periods, x may miss the interval by its rounding.
  *x = *x < first ? first : *x > last ? last : *x;
  return SD_OK;
}

sd_status sd_grid_cell_of(const sd_grid_axis *axis, double x, sd_grid_cell *p)
{
  *p = (sd_grid_cell){0, 0.0, 0.0};
  if (axis->n == 1) return isfinite(x) ? SD_OK : SD_ENOTFINITE;

  int held = 0;
  if (!(x >= axis->at[0] && x <= axis->at[axis->n - 1])) {
    const sd_status status = move_inside(axis, &x, &held);
    if (status != SD_OK) return status;
  }
  p->cell = cell_of(axis, x);
  if (axis->density > 0.0) {
    p->per_length = axis->density;
    p->weight = (x - axis->at[0]) * axis->density - p->cell;
  } else {
    p->per_length = 1.0 / (axis->at[p->cell + 1] - axis->at[p->cell]);
    p->weight = (x - axis->at[p->cell]) * p->per_length;
  }
  // Beyond the end the value is held, so its slope is none.
  if (held) p->per_length = 0.0;
  return SD_OK;
}

size_t sd_flow_grid_size(const sd_flow_grid *grid)
{
  size_t size = grid->columns;
  for (int d = 0; d < SD_GRID_AXES; d++) size *= grid->axis[d].n;
  return size;
}

/* As the first of all faults, in the order of the file: the caller tells its row. */
size_t sd_flow_grid_fault(const sd_flow_grid *grid)
{
  const size_t size = sd_flow_grid_size(grid);
  for (size_t k = 0; k < size; k++) {
    const int is_viscosity = k % grid->columns == 3;
    if (!isfinite(grid->value[k]) || (is_viscosity && !(grid->value[k] > 0.0))) return k;
  }
  return size;
}

/* Two passes: what a jump is large against is known only at the end. Velocity and viscosity have
 * units of their own, and so each its own scale. */
double sd_flow_grid_seam(const sd_flow_grid *grid, int axis)
{
  const int n = grid->axis[axis].n;
  if (grid->axis[axis].outside != SD_OUTSIDE_PERIODIC || n == 1) return 0.0;

  // Numbers that are neighbours along the axis stand `stride` apart; `whole` holds the axis once.
  size_t stride = grid->columns;
  for (int d = 0; d < axis; d++) stride *= grid->axis[d].n;
  const size_t size = sd_flow_grid_size(grid), whole = stride * n, last = stride * (n - 1);

  // of the velocity, and of the viscosity
  double jump[2] = {0.0, 0.0}, scale[2] = {0.0, 0.0};
  for (size_t begin = 0; begin < size; begin += whole)
    for (size_t k = begin; k < begin + stride; k++) {
      const double difference = fabs(grid->value[k + last] - grid->value[k]);
      const int kind = k % grid->columns == 3;
      jump[kind] = fmax(jump[kind], difference);
    }
  for (size_t k = 0; k < size; k++) {
    const int kind = k % grid->columns == 3;
    scale[kind] = fmax(scale[kind], fabs(grid->value[k]));
  }
  double largest = 0.0;
  for (int kind = 0; kind < 2; kind++)
    if (jump[kind] > 0.0) largest = fmax(largest, jump[kind] / scale[kind]);
  return largest;
}

/* Time is the fourth axis. What the weights of its two frames are is the same for every point, so it
 * is settled once a step. */
sd_status sd_flow_grid_frame(const sd_flow_grid *grid, double time, sd_flow_frame *frame)
{
  const sd_grid_axis *axis = &grid->axis[SD_GRID_TIME];
  const size_t stride = sd_flow_grid_size(grid) / axis->n;
  sd_grid_cell p;
  const sd_status status = sd_grid_cell_of(axis, time, &p);
  if (status != SD_OK) return status;
  // On a frame the other one is not looked at: half the work, and all of it in a steady flow.
  frame->now = grid->value + stride * p.cell;
  frame->next = p.weight > 0.0 ? frame->now + stride : NULL;
  frame->weight = p.weight;
  return SD_OK;
}

void sd_flow_grid_at(const sd_flow_grid *grid, const sd_flow_frame *frame, int n, const double *x,
                     double *value, double *gradient)
{
  SD_KERNELS_OF(sd_flow_grid, plain, sd_isa_of(SD_ISA_BEST))->at(grid, frame, n, x, value, gradient);
}
