/* The way of the numbers through the grid of sd_grid.h: from bricks to pencils, along z, y and x, the
 * product, and back. Of doubles; sd_grid_floats.c: the same of floats. */
#include <fftw3.h>
#include <string.h>

#include "sd_grid_internal.h"
#include "sd_real.h"

#ifdef SD_SINGLE
#define FFT(name) fftwf_##name
#else
#define FFT(name) fftw_##name
#endif
typedef FFT(complex) waves;

/* --- plans --- */

/* All x at so many of our z along x, forth and back */
static int plan_x(sd_grid *g, int depth)
{
  waves *plane = g->plane[0], *beside = g->beside;
  if (depth == 0 || g->x_forth[depth]) return 1;
  g->x_forth[depth] = FFT(plan_many_dft)(1, g->size, depth, beside, NULL, depth, 1, plane, NULL, depth, 1,
                                         FFTW_FORWARD, FFTW_ESTIMATE);
  g->x_back[depth] = FFT(plan_many_dft)(1, g->size, depth, plane, NULL, depth, 1, beside, NULL, depth, 1,
                                        FFTW_BACKWARD, FFTW_ESTIMATE);
  return g->x_forth[depth] && g->x_back[depth];
}

/* Our lines of an x plane along z, two as one; all lines at our z along y to the slab; then along x. FFTW
 * takes half as long for complex lines as for the real ones in them, and less from one place to another than in one.
 * FFTW_ESTIMATE: measured plans differ from run to run, and so do their last bits. */
static int plan(sd_grid *g)
{
  const unsigned how = FFTW_ESTIMATE;
  const int pairs = sd_grid_pairs(g), depth = sd_grid_own(g, SD_SHARED_Z);
  const int *size = g->size;
  waves *slab = g->plane[1], *plane = g->plane[0], *beside = g->beside;
  if (depth == 0) return 1; /* no pencils */
  g->z_forth = FFT(plan_many_dft)(1, size + 2, pairs, plane, NULL, 1, size[2], beside, NULL, 1, size[2],
                                  FFTW_FORWARD, how);
  g->z_back = FFT(plan_many_dft)(1, size + 2, pairs, beside, NULL, 1, size[2], plane, NULL, 1, size[2],
                                 FFTW_BACKWARD, how);
  g->y_forth = FFT(plan_many_dft)(1, size + 1, depth, plane, NULL, depth, 1, slab, NULL, depth, 1,
                                  FFTW_FORWARD, how);
  g->y_back = FFT(plan_many_dft)(1, size + 1, depth, beside, NULL, depth, 1, plane, NULL, depth, 1,
                                 FFTW_BACKWARD, how);
  int ok = g->z_forth && g->z_back && g->y_forth && g->y_back;
  for (int y = g->own[SD_SHARED_Y][0]; y < g->own[SD_SHARED_Y][1] && ok; y++) ok = plan_x(g, sd_grid_depth(g, y));
  return ok;
}

static void forget_plan(void *plan)
{
  if (plan) FFT(destroy_plan)(plan);
}

static void forget(sd_grid *g)
{
  void *const plans[] = {g->z_forth, g->z_back, g->y_forth, g->y_back};
  for (int k = 0; k < 4; k++) forget_plan(plans[k]);
  for (int d = 0; d <= sd_grid_own(g, SD_SHARED_Z) && g->x_forth && g->x_back; d++) {
    forget_plan(g->x_forth[d]);
    forget_plan(g->x_back[d]);
  }
}

/* --- bricks and planes of points --- */

/* Rows of a piece along z: three numbers a point, of the brick or of a message */
static real *brick_row(const sd_grid *g, const sd_piece *p, int i, int j)
{
  return (real *) g->brick + (p->at[0] + i) * g->layer + (p->at[1] + j) * g->row + 3 * (long) p->at[2];
}

static real *message_row(const sd_piece *p, real *message, int i, int j)
{
  return message + p->message + 3 * ((long) i * p->n[1] + j) * p->n[2];
}

/* The pieces of other ranks, from the brick to a message or back */
static void copy_pieces(const sd_grid *g, real *message, int to_brick)
{
  for (int k = 0; k < g->outs; k++) {
    const sd_piece *p = g->out + k;
    if (p->rank == g->me) continue;
    for (int i = 0; i < p->n[0]; i++)
      for (int j = 0; j < p->n[1]; j++) {
        real *brick = brick_row(g, p, i, j), *row = message_row(p, message, i, j);
        memcpy(to_brick ? brick : row, to_brick ? row : brick,
               3 * sizeof(real) * (size_t) p->n[2]);
      }
  }
}

static void add_row(const sd_grid *g, long at, real *row, int n)
{
  real *restrict f0 = (real *) g->plane[0] + at, *restrict f1 = (real *) g->plane[1] + at;
  real *restrict f2 = (real *) g->plane[2] + at;
  for (int k = 0; k < n; k++) {
    f0[2 * k] += row[3 * k];
    f1[2 * k] += row[3 * k + 1];
    f2[2 * k] += row[3 * k + 2];
  }
}

static void take_row(const sd_grid *g, long at, real *row, int n)
{
  const real *f0 = (real *) g->plane[0] + at, *f1 = (real *) g->plane[1] + at;
  const real *f2 = (real *) g->plane[2] + at;
  for (int k = 0; k < n; k++) {
    row[3 * k] = f0[2 * k];
    row[3 * k + 1] = f1[2 * k];
    row[3 * k + 2] = f2[2 * k];
  }
}

/* Points of our lines of plane x, two rows of a piece after the other where they are parts of one complex line: added
 * from them, or given to them. Our own are in the brick, others in the message. */
static inline void each_row(const sd_grid *g, int x, real *message, int to_brick)
{
  for (int k = 0; k < g->ins; k++) {
    const sd_piece *p = g->in + k;
    const int i = x - p->to[0], first = p->to[1] - g->own[SD_SHARED_LINES][0];
    if (i < 0 || i >= p->n[0]) continue;
    for (int j = 0, rows; j < p->n[1]; j += rows) {
      const long at = sd_grid_number(g->size[2], first + j, p->to[2]);
      real *row[2];
      rows = at % 2 == 0 && j + 1 < p->n[1] ? 2 : 1;
      for (int q = 0; q < rows; q++)
        row[q] = p->rank == g->me ? brick_row(g, p, i, j + q) : message_row(p, message, i, j + q);
      if (rows == 2) {
        void *const line[3] = {(real *) g->plane[0] + at, (real *) g->plane[1] + at, (real *) g->plane[2] + at};
        if (to_brick) g->kernels->take(row[0], row[1], p->n[2], line);
        else g->kernels->add(row[0], row[1], p->n[2], line);
      } else if (to_brick)
        take_row(g, at, row[0], p->n[2]);
      else
        add_row(g, at, row[0], p->n[2]);
    }
  }
}

static void clear_points(const sd_grid *g)
{
  for (int c = 0; c < 3; c++)
    memset(g->plane[c], 0, sizeof(waves) * (size_t) sd_grid_pairs(g) * (size_t) g->size[2]);
}

#include "sd_grid_turns_loop.h"

/* --- transforms --- */

/* Our lines along z, from points to waves [lines][waves], or back; of an odd number of lines the last has one of
 * zeros for a partner. */
static void forth_along_z(sd_grid *g, int c)
{
  waves *plane = g->plane[c], *both = g->beside;
  const int n = g->size[2];
  FFT(execute_dft)(g->z_forth, plane, both);
  for (int k = 0; k < sd_grid_pairs(g); k++)
    g->kernels->part(both + (long) k * n, n, g->waves, plane + 2L * k * g->waves, plane + (2L * k + 1) * g->waves);
}

static void back_along_z(sd_grid *g, int c)
{
  waves *plane = g->plane[c], *both = g->beside;
  const int n = g->size[2], lines = sd_grid_own(g, SD_SHARED_LINES);
  if (lines % 2) memset(plane + (long) lines * g->waves, 0, sizeof(waves) * (size_t) g->waves);
  for (int k = 0; k < sd_grid_pairs(g); k++)
    g->kernels->join(plane + 2L * k * g->waves, plane + (2L * k + 1) * g->waves, n, g->waves, both + (long) k * n);
  FFT(execute_dft)(g->z_back, both, plane);
}

/* Rows of `depth` that hold nothing */
static void clear_rows(waves *rows, int from, int end, int depth)
{
  memset(rows + (long) from * depth, 0, sizeof(waves) * (size_t) (end - from) * (size_t) depth);
}

/* A plane along y to the slab, or back */
static void forth_along_y(sd_grid *g, int c, int x, real *message)
{
  clear_rows(g->plane[c], g->occupied[1], g->size[1], sd_grid_own(g, SD_SHARED_Z));
  FFT(execute_dft)(g->y_forth, g->plane[c], slab_row(g, c, x, 0));
  copy_rows(g, c, x, message, 0);
}

static void back_along_y(sd_grid *g, int c, int x, real *message)
{
  copy_rows(g, c, x, message, 1);
  FFT(execute_dft)(g->y_back, g->beside, g->plane[c]);
}

/* Rows of `beside` times their heights, along x to `raised` */
static void raise_rows(sd_grid *g, int c, int depth)
{
  const long row = 2L * depth;
  real *beside = (real *) g->beside;
  for (int x = 0; x < g->occupied[0]; x++)
    for (long k = 0; k < row; k++) beside[x * row + k] *= (real) g->height[x];
  FFT(execute_dft)(g->x_forth[depth], g->beside, g->raised[c]);
}

/* `raised` back along x, and its product with the heights to `beside`; plane c is free. */
static void add_raised(sd_grid *g, int c, int depth)
{
  const long row = 2L * depth;
  real *beside = (real *) g->beside;
  const real *raised = (const real *) g->plane[c];
  FFT(execute_dft)(g->x_back[depth], g->raised[c], g->plane[c]);
  for (int x = 0; x < g->occupied[0]; x++)
    for (long k = 0; k < row; k++) beside[x * row + k] += (real) g->height[x] * raised[x * row + k];
}

/* What a sweep starts from, as long as it is there, and what they make of it */
static void keep_for_sweep(sd_grid *g, int c, int depth)
{
  memcpy(g->raised[c], g->beside, sizeof(waves) * (size_t) depth * (size_t) g->occupied[0]);
}

static void add_sweep(sd_grid *g, int c, int depth)
{
  const long numbers = 2L * depth * g->occupied[0];
  real *restrict beside = (real *) g->beside;
  const real *restrict swept = (const real *) g->raised[c];
  for (long k = 0; k < numbers; k++) beside[k] += swept[k];
}

/* One y plane: along x, the product, back along x. It stays in the cache meanwhile. */
static void through_plane(sd_grid *g, int y, sd_grid_multiply *multiply, void *ctx, real *message)
{
  const int depth = sd_grid_depth(g, y);
  void *planes[6];
  if (depth == 0) return;
  for (int c = 0; c < 3; c++) {
    planes[c] = g->plane[(c + g->turn) % 3];
    planes[3 + c] = g->raised[(c + g->turn) % 3];
    copy_plane(g, c, y, message, 1);
    clear_rows(g->beside, g->occupied[0], g->size[0], depth);
    FFT(execute_dft)(g->x_forth[depth], g->beside, g->plane[c]);
    if (g->height) raise_rows(g, c, depth);
    if (g->sweep) keep_for_sweep(g, c, depth);
  }
  multiply(ctx, y, depth, planes);
  if (g->sweep) g->sweep(g->sweep_ctx, y, (double *const *) (planes + 3));
  for (int c = 0; c < 3; c++) {
    FFT(execute_dft)(g->x_back[depth], g->plane[c], g->beside);
    if (g->height) add_raised(g, c, depth);
    if (g->sweep) add_sweep(g, c, depth);
    copy_plane(g, c, y, message, 0);
  }
}

/* --- all of it --- */

/* What is in message `from` to the other ranks, what they send to the other message */
static sd_status grid_exchange(const sd_grid *g, int from, int to_counts, int from_counts)
{
  if (g->ranks == 1) return SD_OK;
  return g->world.exchange(g->world.ctx, g->message[from], g->counts + to_counts * g->ranks,
                           g->message[1 - from], g->counts + from_counts * g->ranks);
}

/* From the pieces in the second message, or from what `fill` says, to the slab, and what of it is
 * others' to the first */
static sd_status forth(sd_grid *g, sd_grid_fill *fill, void *fill_ctx)
{
  real *first = (real *) g->message[0], *second = (real *) g->message[1];
  const int *x = g->own[SD_SHARED_X], *lines = g->own[SD_SHARED_LINES];
  double *const fields[3] = {g->plane[0], g->plane[1], g->plane[2]};
  for (int k = x[0]; k < x[1]; k++) {
    clear_points(g);
    if (fill)
      fill(fill_ctx, k, lines[0], lines[1], fields);
    else
      each_row(g, k, second, 0);
    for (int c = 0; c < 3; c++) {
      forth_along_z(g, c);
      if (g->columns == 1)
        forth_along_y(g, c, k, first);
      else
        copy_lines(g, c, k, first, 0);
    }
  }
  if (g->columns == 1) return SD_OK;
  const sd_status status = grid_exchange(g, 0, ROW_TO, ROW_FROM);
  for (int k = x[0]; k < x[1] && status == SD_OK; k++)
    for (int c = 0; c < 3; c++) {
      copy_depths(g, c, k, second, 1);
      forth_along_y(g, c, k, first);
    }
  return status;
}

/* From what came back in the first message to the pieces in the second */
static sd_status back(sd_grid *g)
{
  real *first = (real *) g->message[0], *second = (real *) g->message[1];
  const int *x = g->own[SD_SHARED_X];
  for (int k = x[0]; k < x[1] && g->columns > 1; k++)
    for (int c = 0; c < 3; c++) {
      back_along_y(g, c, k, first);
      copy_depths(g, c, k, second, 0);
    }
  const sd_status status = g->columns > 1 ? grid_exchange(g, 1, ROW_FROM, ROW_TO) : SD_OK;
  for (int k = x[0]; k < x[1] && status == SD_OK; k++) {
    for (int c = 0; c < 3; c++) {
      if (g->columns == 1)
        back_along_y(g, c, k, first);
      else
        copy_lines(g, c, k, first, 1);
      back_along_z(g, c);
    }
    each_row(g, k, second, 1);
  }
  return status;
}

static sd_status convolve_values(sd_grid *g, sd_grid_fill *fill, void *fill_ctx,
                                 sd_grid_multiply *multiply, void *ctx)
{
  const int *y = g->own[SD_SHARED_Y];
  sd_status status = forth(g, fill, fill_ctx);
  if (status == SD_OK) status = grid_exchange(g, 0, COLUMN_TO, COLUMN_FROM);
  for (int k = y[0]; k < y[1] && status == SD_OK; k++)
    through_plane(g, k, multiply, ctx, (real *) g->message[1]);
  if (status == SD_OK) status = grid_exchange(g, 1, COLUMN_FROM, COLUMN_TO);
  if (status == SD_OK) status = back(g);
  if (status == SD_OK) status = grid_exchange(g, 1, PIECES_FROM, PIECES_TO);
  if (status == SD_OK) copy_pieces(g, (real *) g->message[0], 1);
  return status;
}

static sd_status grid_convolve(sd_grid *g, sd_grid_multiply *multiply, void *ctx)
{
  copy_pieces(g, (real *) g->message[0], 0);
  const sd_status status = grid_exchange(g, 0, PIECES_TO, PIECES_FROM);
  return status == SD_OK ? convolve_values(g, NULL, NULL, multiply, ctx) : status;
}

#ifdef SD_SINGLE
const struct sd_grid_fields sd_grid_floats = {plan, forget, grid_convolve, convolve_values};
#else
const struct sd_grid_fields sd_grid_doubles = {plan, forget, grid_convolve, convolve_values};
#endif
