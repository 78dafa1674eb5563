#include "sd_sph_deep.h"

#include <math.h>
#include <string.h>

/* Cells of one side, around all that is marked and `layers` more on each side. Those along x are the bits of words.
 * LAYERS + 1 cells apart nobody is in reach: the side is not below reach / LAYERS. scale: 1 / side, but of z in two
 * dimensions 0. */
enum { LAYERS = 4, BITS = 64 };
typedef struct {
  double lo[3], scale[3];
  int size[3], layers[3], words;
} deep_cells;

static double cells_along(const deep_cells *c, int d, double x)
{
  return (x - c->lo[d]) * c->scale[d] + c->layers[d];
}

/* How many words they have: at most 1e15 */
static size_t size_of_grid(deep_cells *c, double side, const double hi[3])
{
  double number = 1.0;
  for (int d = 0; d < 3; d++) {
    c->scale[d] = c->layers[d] > 0 ? 1.0 / side : 0.0;
    const double along = cells_along(c, d, hi[d]) + 1.0 + c->layers[d];
    c->size[d] = along < 1e9 ? (int) along : 1000000000;
    number *= d == 0 ? c->words = (c->size[0] + BITS - 1) / BITS : along;
  }
  return number < 1e15 ? (size_t) number : (size_t) 1e15;
}

/* Of a place: its row of words, -1 outside, and its place in that row */
static long deep_row_of(const deep_cells *c, const double *x, int *along)
{
  const double at[3] = {cells_along(c, 0, x[0]), cells_along(c, 1, x[1]), cells_along(c, 2, x[2])};
  if (!(at[0] >= 0.0 && at[1] >= 0.0 && at[2] >= 0.0 && at[0] < c->size[0] && at[1] < c->size[1] &&
        at[2] < c->size[2]))
    return -1;
  *along = (int) at[0];
  return ((long) at[2] * c->size[1] + (long) at[1]) * c->words;
}

/* A place that is no number, or infinite, is that of a run that is about to end: nobody is near it. */
static int bounds_of_marked(int all, const double *x4, double lo[3], double hi[3])
{
  for (int d = 0; d < 3; d++) hi[d] = -(lo[d] = HUGE_VAL);
  for (int i = 0; i < all; i++) {
    const double *x = x4 + 4 * (size_t) i;
    if (!(x[3] > 0.0) || !isfinite(x[0]) || !isfinite(x[1]) || !isfinite(x[2])) continue;
    for (int d = 0; d < 3; d++) {
      if (x[d] < lo[d]) lo[d] = x[d];
      if (x[d] > hi[d]) hi[d] = x[d];
    }
  }
  return hi[0] >= lo[0];
}

/* The rows of a ball of cells: how far in words from the row of its middle, and how many cells to each side */
typedef struct {
  long from_middle;
  int half;
} ball_row;

static int rows_of_ball(const deep_cells *c, ball_row *rows)
{
  int count = 0;
  for (int z = -c->layers[2]; z <= c->layers[2]; z++)
    for (int y = -c->layers[1]; y <= c->layers[1]; y++) {
      const int gap_y = y < 0 ? -y - 1 : y > 0 ? y - 1 : 0, gap_z = z < 0 ? -z - 1 : z > 0 ? z - 1 : 0;
      const int left = LAYERS * LAYERS - gap_y * gap_y - gap_z * gap_z;
      int half = 0;
      while (half * half < left) half++;
      if (half > 0) rows[count++] = (ball_row){((long) z * c->size[1] + y) * c->words, half};
    }
  return count;
}

/* Adds to `near` the cells around those that are set in a word; here, before and after: what a row of the ball that
 * reaches so many cells to each side makes of them in this word, and in the one before and after it. */
static void deep_spread(uint64_t word, int rows, const ball_row *ball, uint64_t *near)
{
  uint64_t here[LAYERS + 1] = {word}, before[LAYERS + 1] = {0}, after[LAYERS + 1] = {0};
  for (int s = 1; s <= LAYERS; s++) {
    here[s] = here[s - 1] | word << s | word >> s;
    before[s] = before[s - 1] | word << (BITS - s);
    after[s] = after[s - 1] | word >> (BITS - s);
  }
  for (int k = 0; k < rows; k++) near[ball[k].from_middle] |= here[ball[k].half];
  for (int k = 0; k < rows && before[LAYERS]; k++) near[ball[k].from_middle - 1] |= before[ball[k].half];
  for (int k = 0; k < rows && after[LAYERS]; k++) near[ball[k].from_middle + 1] |= after[ball[k].half];
}

int sd_sph_find_near(int dimension, int all, int n, const double *x4, double reach, uint64_t *scratch, int *near)
{
  deep_cells c = {.layers = {LAYERS, LAYERS, dimension == 3 ? LAYERS : 0}};
  ball_row ball[(2 * LAYERS + 1) * (2 * LAYERS + 1)];
  double hi[3], side = reach / LAYERS * (1.0 + 1e-9);
  size_t words;
  int along, count = 0;
  if (!bounds_of_marked(all, x4, c.lo, hi)) return 0;
  while ((words = size_of_grid(&c, side, hi)) > SD_SPH_DEEP_SCRATCH(all) / 2) side *= 1.2;
  uint64_t *marked = scratch, *around = scratch + words;
  memset(scratch, 0, 2 * words * sizeof(uint64_t));
  for (int i = 0; i < all; i++) {
    const long row = x4[4 * (size_t) i + 3] > 0.0 ? deep_row_of(&c, x4 + 4 * (size_t) i, &along) : -1;
    if (row >= 0) marked[row + along / BITS] |= (uint64_t) 1 << along % BITS;
  }
  const int rows = rows_of_ball(&c, ball);
  for (size_t k = 0; k < words; k++)
    if (marked[k]) deep_spread(marked[k], rows, ball, around + k);
  for (int i = 0; i < n; i++) {
    const long row = deep_row_of(&c, x4 + 4 * (size_t) i, &along);
    near[count] = i;
    count += row >= 0 && (around[row + along / BITS] >> along % BITS & 1);
  }
  return count;
}
