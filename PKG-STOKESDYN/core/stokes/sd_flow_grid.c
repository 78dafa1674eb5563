#include "sd_flow_grid.h"

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

/* Where a coordinate lies on an axis: between node `cell` and the next one. */
typedef struct {
  int cell;
  /* of the next node; what a length is in units of the cell. Both 0 on an axis of one node. */
  double weight, per_length;
} place;

/* The last node at or below x, but for the last of all: a point on the last node belongs to the cell
 * before it, with weight 1, and nothing beyond value[] is read. Even axes, which nearly all are, need
 * no search. */
static inline int cell_of(const sd_grid_axis *axis, double x)
{
  if (axis->density > 0.0) {
    const int cell = (int) ((x - axis->at[0]) * axis->density);
    return cell < axis->n - 1 ? cell : axis->n - 2;
  }
  int low = 0, high = axis->n - 1;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    if (axis->at[middle] <= x)
      low = middle;
    else
      high = middle;
  }
  return low;
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

static inline sd_status find_place(const sd_grid_axis *axis, double x, place *p)
{
  *p = (place){0, 0.0, 0.0};
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
  place p;
  const sd_status status = find_place(axis, time, &p);
  if (status != SD_OK) return status;
  // On a frame the other one is not looked at: half the work, and all of it in a steady flow.
  frame->now = grid->value + stride * p.cell;
  frame->next = p.weight > 0.0 ? frame->now + stride : NULL;
  frame->weight = p.weight;
  return SD_OK;
}

/* How far the next node is along each axis, in numbers of value[]; 0 on an axis of one node. */
typedef struct {
  size_t next[3];
} strides;

static strides strides_of(const sd_flow_grid *grid)
{
  strides s;
  size_t stride = grid->columns;
  for (int d = 0; d < 3; d++) {
    s.next[d] = grid->axis[d].n > 1 ? stride : 0;
    stride *= grid->axis[d].n;
  }
  return s;
}

/* The cell that a point lies in. */
typedef struct {
  sd_status status;
  /* of its lowest node in value[] */
  size_t corner;
  place at[3];
} cell;

static void find_cell(const sd_flow_grid *grid, const strides *s, const double x[3], cell *c)
{
  c->status = SD_OK;
  c->corner = 0;
  for (int d = 0; d < 3; d++) {
    const sd_status status = find_place(&grid->axis[d], x[d], &c->at[d]);
    if (status != SD_OK) c->status = status;
    c->corner += s->next[d] * c->at[d].cell;
  }
}

/* A grid is larger than caches are, and its cells are met in no order: what a point needs is asked
 * for while others are worked on. */
static void prefetch(const double *v, const strides *s)
{
#ifdef __GNUC__
  for (int row = 0; row < 4; row++) {
    const double *at = v + (row & 1) * s->next[1] + (row >> 1) * s->next[2];
    __builtin_prefetch(at);
    __builtin_prefetch(at + s->next[0]);
  }
#else
  (void) v;
  (void) s;
#endif
}

/* value[p] = the trilinear mean of the eight corners: along x on four edges, whose weights are those
 * of y and z. columns is a constant where this is called, so that the loop unrolls. */
static inline void mean_of_corners(const double *v, const strides *s, const cell *c, int columns,
                                   double *value)
{
  const double wx = c->at[0].weight, wy = c->at[1].weight, wz = c->at[2].weight;
  const double *edge[4] = {v, v + s->next[1], v + s->next[2], v + s->next[1] + s->next[2]};
  const double w[4] = {(1.0 - wy) * (1.0 - wz), wy * (1.0 - wz), (1.0 - wy) * wz, wy * wz};
  const size_t next = s->next[0];
  for (int p = 0; p < columns; p++) {
    double sum = 0.0;
    for (int e = 0; e < 4; e++)
      sum += w[e] * (edge[e][p] + wx * (edge[e][next + p] - edge[e][p]));
    value[p] = sum;
  }
}

/* slope[q] = the derivative along axis q of one column: of the four edges along x, then of what
 * they give along y, then along z. */
static void slope_of_corners(const double *v, const strides *s, const cell *c, double slope[3])
{
  const double wx = c->at[0].weight, wy = c->at[1].weight, wz = c->at[2].weight;
  double face[2], face_x[2], face_y[2];
  for (int z = 0; z < 2; z++) {
    const double *low = v + z * s->next[2], *high = low + s->next[1];
    const double low_x = low[s->next[0]] - low[0], high_x = high[s->next[0]] - high[0];
    const double low_0 = low[0] + wx * low_x, high_0 = high[0] + wx * high_x;
    face[z] = low_0 + wy * (high_0 - low_0);
    face_x[z] = low_x + wy * (high_x - low_x);
    face_y[z] = high_0 - low_0;
  }
  slope[0] = (face_x[0] + wz * (face_x[1] - face_x[0])) * c->at[0].per_length;
  slope[1] = (face_y[0] + wz * (face_y[1] - face_y[0])) * c->at[1].per_length;
  slope[2] = (face[1] - face[0]) * c->at[2].per_length;
}

/* With the number of columns a constant the compiler keeps the sums in registers. */
static void values_at(const double *v, const strides *s, const cell *c, int columns, double *value)
{
  if (columns == 3)
    mean_of_corners(v, s, c, 3, value);
  else
    mean_of_corners(v, s, c, 4, value);
}

static void gradient_at(const double *v, const strides *s, const cell *c, double *gradient)
{
  for (int p = 0; p < 3; p++) slope_of_corners(v + p, s, c, gradient + 3 * p);
}

/* Linear in time between two frames, value and gradient alike: f + weight (later - f), which is f
 * itself where the two are equal. */
static void flow_in(const sd_flow_grid *grid, const sd_flow_frame *frame, const strides *s,
                    const cell *c, double *value, double *gradient)
{
  values_at(frame->now + c->corner, s, c, grid->columns, value);
  if (gradient) gradient_at(frame->now + c->corner, s, c, gradient);
  if (!frame->next) return;

  double later[4], later_gradient[9];
  values_at(frame->next + c->corner, s, c, grid->columns, later);
  for (int p = 0; p < grid->columns; p++) value[p] += frame->weight * (later[p] - value[p]);
  if (!gradient) return;
  gradient_at(frame->next + c->corner, s, c, later_gradient);
  for (int k = 0; k < 9; k++) gradient[k] += frame->weight * (later_gradient[k] - gradient[k]);
}

void sd_flow_grid_at(const sd_flow_grid *grid, const sd_flow_frame *frame, int n, const double *x,
                     double *value, double *gradient)
{
  // a block's cells stay in the first cache, and its prefetches within what a core can have under way
  enum { BLOCK = 16 };
  const strides s = strides_of(grid);
  cell cells[BLOCK];
  for (int begin = 0; begin < n; begin += BLOCK) {
    const int count = n - begin < BLOCK ? n - begin : BLOCK;
    for (int k = 0; k < count; k++) {
      find_cell(grid, &s, x + 3 * (size_t) (begin + k), &cells[k]);
      if (cells[k].status != SD_OK) continue;
      prefetch(frame->now + cells[k].corner, &s);
      if (frame->next) prefetch(frame->next + cells[k].corner, &s);
    }
    for (int k = 0; k < count; k++) {
      const size_t point = begin + k;
      double *u = value + grid->columns * point, *G = gradient ? gradient + 9 * point : NULL;
      if (cells[k].status == SD_OK) {
        flow_in(grid, frame, &s, &cells[k], u, G);
        continue;
      }
      for (int p = 0; p < grid->columns; p++) u[p] = NAN;
      for (int p = 0; p < 9 && G; p++) G[p] = NAN;
    }
  }
}
