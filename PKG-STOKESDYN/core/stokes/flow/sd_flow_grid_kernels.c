/* The look-up in a grid: loops that the compiler makes vectors of. */
#include "sd_flow_grid_internal.h"
#include "sd_lanes.h"

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

/* Points at a time: what is known of them stays in the first cache, and their prefetches are under
 * way for as long as the second cache takes. */
enum { BLOCK = 32 };

/* The cells that a block of points lies in. */
typedef struct {
  /* of the lowest node in value[] */
  size_t corner[BLOCK];
  /* as in sd_grid_cell; NaN where there is no cell, and so is all that is made of them */
  double weight[3][BLOCK], per_length[3][BLOCK];
} cells;

/* On an even axis, and for points between its ends, arithmetic will do, for several points at once.
 * x [count]. Returns 0 where a point is not between them: what comes out is then of no use. */
static int place_evenly(const sd_grid_axis *axis, int count, const double *x, int *node,
                        double *weight, double *per_length)
{
  const double first = axis->at[0], last = axis->at[axis->n - 1], density = axis->density;
  const double highest = axis->n - 2;
  // as wide as what is compared, or there are no vectors
  long long beyond = 0;
  for (int k = 0; k < count; k++) {
    const double t = (x[k] - first) * density, above = t > 0.0 ? t : 0.0;
    beyond |= x[k] >= first && x[k] <= last ? 0 : 1;
    node[k] = (int) (above < highest ? above : highest);
    weight[k] = t - node[k];
    per_length[k] = density;
  }
  return !beyond;
}

static void place_one_by_one(const sd_grid_axis *axis, int count, const double *x, int *node,
                             double *weight, double *per_length)
{
  for (int k = 0; k < count; k++) {
    sd_grid_cell p;
    const int found = sd_grid_cell_of(axis, x[k], &p) == SD_OK;
    node[k] = p.cell;
    weight[k] = found ? p.weight : NAN;
    per_length[k] = found ? p.per_length : NAN;
  }
}

static void find_cells(const sd_flow_grid *grid, const strides *s, int count, const double *x,
                       cells *c)
{
  int node[3][BLOCK];
  double along[3][BLOCK];
  for (int k = 0; k < count; k++)
    for (int d = 0; d < 3; d++) along[d][k] = x[3 * k + d];
  for (int d = 0; d < 3; d++) {
    const sd_grid_axis *axis = &grid->axis[d];
    if (!(axis->density > 0.0 &&
          place_evenly(axis, count, along[d], node[d], c->weight[d], c->per_length[d])))
      place_one_by_one(axis, count, along[d], node[d], c->weight[d], c->per_length[d]);
  }
  for (int k = 0; k < count; k++)
    c->corner[k] = s->next[0] * node[0][k] + s->next[1] * node[1][k] + s->next[2] * node[2][k];
}

/* A grid is larger than caches are, and its cells are met in no order: what a point needs is asked
 * for while others are worked on. */
INLINE void prefetch(const double *v, const strides *s)
{
  for (int row = 0; row < 4; row++) {
    const double *at = v + (row & 1) * s->next[1] + (row >> 1) * s->next[2];
    sd_fetch(at);
    sd_fetch(at + s->next[0]);
  }
}

/* value[p] = the trilinear mean of the eight corners: of the four edges along x, weighted by y and
 * z, then along x. The two nodes of an edge are neighbours in memory, so that one loop takes the
 * columns of both; `nodes` is 1 on an axis of one node. It and columns are constants where this is
 * called, so that the loops unroll. */
INLINE void mean_of_corners(const double *v, const strides *s, const cells *c, int k,
                                   int columns, int nodes, double *value)
{
  const double wx = c->weight[0][k], wy = c->weight[1][k], wz = c->weight[2][k];
  const double w11 = wy * wz, w10 = wy - w11, w01 = wz - w11, w00 = 1.0 - wy - w01;
  const double *v10 = v + s->next[1], *v01 = v + s->next[2], *v11 = v10 + s->next[2];
  double mean[8];
  for (int p = 0; p < nodes * columns; p++)
    mean[p] = w00 * v[p] + w10 * v10[p] + (w01 * v01[p] + w11 * v11[p]);
  const double *next = mean + (nodes - 1) * columns;
  for (int p = 0; p < columns; p++) value[p] = mean[p] + wx * (next[p] - mean[p]);
}

/* slope[q] = the derivative along axis q of one column: of the four edges along x, then of what
 * they give along y, then along z. */
INLINE void slope_of_corners(const double *v, const strides *s, const cells *c, int k,
                                    double slope[3])
{
  const double wx = c->weight[0][k], wy = c->weight[1][k], wz = c->weight[2][k];
  double face[2], face_x[2], face_y[2];
  for (int z = 0; z < 2; z++) {
    const double *low = v + z * s->next[2], *high = low + s->next[1];
    const double low_x = low[s->next[0]] - low[0], high_x = high[s->next[0]] - high[0];
    const double low_0 = low[0] + wx * low_x, high_0 = high[0] + wx * high_x;
    face[z] = low_0 + wy * (high_0 - low_0);
    face_x[z] = low_x + wy * (high_x - low_x);
    face_y[z] = high_0 - low_0;
  }
  slope[0] = (face_x[0] + wz * (face_x[1] - face_x[0])) * c->per_length[0][k];
  slope[1] = (face_y[0] + wz * (face_y[1] - face_y[0])) * c->per_length[1][k];
  slope[2] = (face[1] - face[0]) * c->per_length[2][k];
}

INLINE void values_of(const double *v, const strides *s, const cells *c, int count,
                             int columns, int nodes, double *value)
{
  for (int k = 0; k < count; k++)
    mean_of_corners(v + c->corner[k], s, c, k, columns, nodes, value + columns * k);
}

static void values_at(const double *v, const strides *s, const cells *c, int count, int columns,
                      double *value)
{
  if (s->next[0] == 0)
    values_of(v, s, c, count, columns, 1, value);
  else if (columns == 3)
    values_of(v, s, c, count, 3, 2, value);
  else
    values_of(v, s, c, count, 4, 2, value);
}

static void gradients_at(const double *v, const strides *s, const cells *c, int count,
                         double *gradient)
{
  for (int k = 0; k < count; k++)
    for (int p = 0; p < 3; p++)
      slope_of_corners(v + c->corner[k] + p, s, c, k, gradient + 9 * k + 3 * p);
}

/* f + weight (later - f), which is f itself where the two are equal. */
static void between_frames(double weight, int n, const double *later, double *f)
{
  for (int k = 0; k < n; k++) f[k] += weight * (later[k] - f[k]);
}

static void flow_of_block(const sd_flow_frame *frame, const strides *s, const cells *c, int count,
                          int columns, double *value, double *gradient)
{
  values_at(frame->now, s, c, count, columns, value);
  if (gradient) gradients_at(frame->now, s, c, count, gradient);
  if (!frame->next) return;

  double later[9 * BLOCK];
  values_at(frame->next, s, c, count, columns, later);
  between_frames(frame->weight, columns * count, later, value);
  if (!gradient) return;
  gradients_at(frame->next, s, c, count, later);
  between_frames(frame->weight, 9 * count, later, gradient);
}

static void at(const sd_flow_grid *grid, const sd_flow_frame *frame, int n, const double *x,
               double *value, double *gradient)
{
  const strides s = strides_of(grid);
  cells c;
  for (int begin = 0; begin < n; begin += BLOCK) {
    const int count = n - begin < BLOCK ? n - begin : BLOCK;
    const size_t first = begin;
    find_cells(grid, &s, count, x + 3 * first, &c);
    for (int k = 0; k < count; k++) {
      prefetch(frame->now + c.corner[k], &s);
      if (frame->next) prefetch(frame->next + c.corner[k], &s);
    }
    flow_of_block(frame, &s, &c, count, grid->columns, value + grid->columns * first,
                  gradient ? gradient + 9 * first : NULL);
  }
}

const struct sd_flow_grid_kernels SD_KERNELS(sd_flow_grid) = {at};
