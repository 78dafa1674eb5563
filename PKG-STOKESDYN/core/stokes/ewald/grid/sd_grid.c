#include "sd_grid.h"

#include <stdlib.h>
#include <string.h>

#include "sd_grid_internal.h"
#include "sd_room.h"

/* --- plans --- */

/* Complex numbers of a plane at work */
static size_t plane_numbers(const sd_grid *g)
{
  const size_t lines = (size_t) sd_grid_own(g, SD_SHARED_LINES) * (size_t) g->half;
  const int longer = g->size[0] > g->size[1] ? g->size[0] : g->size[1];
  const size_t waves = (size_t) longer * (size_t) sd_grid_own(g, SD_SHARED_Z);
  return (lines > waves ? lines : waves) + 1;
}

static int gr_allocate(sd_grid *g)
{
  const size_t plane = plane_numbers(g);
  int ok = 1;
  for (int c = 0; c < 3; c++) {
    g->plane[c] = fftw_alloc_complex(plane);
    ok = ok && g->plane[c];
  }
  g->slab = calloc((size_t) sd_grid_own(g, SD_SHARED_X) + 1, sizeof(fftw_complex *));
  g->beside = fftw_alloc_complex(plane);
  g->counts = calloc(6 * (size_t) g->ranks, sizeof(int));
  return ok && g->slab && g->beside && g->counts;
}

/* Our lines of an x plane along z to wave numbers beside; all lines at our z along y to the slab; all
 * x at our z along x. From one place to another, which FFTW does faster than in one place.
 * FFTW_ESTIMATE: measured plans differ from run to run, and so do their last bits. */
static int plan(sd_grid *g)
{
  const unsigned how = FFTW_ESTIMATE;
  const int half = g->half, lines = sd_grid_own(g, SD_SHARED_LINES), depth = sd_grid_own(g, SD_SHARED_Z);
  const int *size = g->size;
  fftw_complex *slab = g->plane[1], *plane = g->plane[0], *beside = g->beside;
  if (depth == 0) return 1; /* no pencils */
  g->z_forth = fftw_plan_many_dft_r2c(1, size + 2, lines, (double *) plane, NULL, 1, 2 * half,
                                      beside, NULL, 1, half, how);
  g->z_back = fftw_plan_many_dft_c2r(1, size + 2, lines, beside, NULL, 1, half, (double *) plane,
                                     NULL, 1, 2 * half, how);
  g->y_forth = fftw_plan_many_dft(1, size + 1, depth, beside, NULL, depth, 1, slab, NULL, depth, 1,
                                  FFTW_FORWARD, how);
  g->y_back = fftw_plan_many_dft(1, size + 1, depth, slab, NULL, depth, 1, beside, NULL, depth, 1,
                                 FFTW_BACKWARD, how);
  g->x_forth = fftw_plan_many_dft(1, size, depth, beside, NULL, depth, 1, plane, NULL, depth, 1,
                                  FFTW_FORWARD, how);
  g->x_back = fftw_plan_many_dft(1, size, depth, plane, NULL, depth, 1, beside, NULL, depth, 1,
                                 FFTW_BACKWARD, how);
  return g->z_forth && g->z_back && g->y_forth && g->y_back && g->x_forth && g->x_back;
}

sd_status sd_grid_create(sd_grid *g, const int *size, const int *occupied, const sd_world *world)
{
  sd_grid_free(g);
  g->world = *world;
  g->ranks = world->exchange ? sd_world_ranks(world) : 1;
  g->me = g->ranks > 1 ? world->me : 0;
  for (int d = 0; d < 3; d++) {
    g->size[d] = size[d];
    g->occupied[d] = occupied[d];
  }
  g->half = size[2] / 2 + 1;
  g->columns = sd_grid_columns(g, 0);
  g->rows = g->ranks / g->columns;
  for (int k = 0; k < 4; k++) sd_grid_range_of(g, k, g->me, g->own[k]);
  if (gr_allocate(g) && sd_grid_count_turns(g) && plan(g)) return SD_OK;
  sd_grid_free(g);
  return SD_ENOMEMORY;
}

void sd_grid_free(sd_grid *g)
{
  fftw_plan *const plans[] = {&g->z_forth, &g->z_back,  &g->y_forth,
                              &g->y_back,  &g->x_forth, &g->x_back};
  for (int k = 0; k < 6; k++)
    if (*plans[k]) fftw_destroy_plan(*plans[k]);
  for (int c = 0; c < 3; c++) {
    fftw_free(g->plane[c]);
    fftw_free(g->raised[c]);
  }
  free(g->height);
  fftw_free(g->beside);
  free(g->slab);
  free(g->spare);
  free(g->brick);
  free(g->out);
  free(g->in);
  free(g->counts);
  free(g->message[0]);
  free(g->message[1]);
  memset(g, 0, sizeof(*g));
}

static sd_status three_more_planes(sd_grid *g)
{
  for (int c = 0; c < 3; c++) {
    if (!g->raised[c]) g->raised[c] = fftw_alloc_complex(plane_numbers(g));
    if (!g->raised[c]) return SD_ENOMEMORY;
  }
  return SD_OK;
}

sd_status sd_grid_raise(sd_grid *g, const double *height)
{
  const size_t planes = (size_t) g->occupied[0];
  if (!sd_grow(&g->height, sizeof(double), planes)) return SD_ENOMEMORY;
  memcpy(g->height, height, sizeof(double) * planes);
  return three_more_planes(g);
}

sd_status sd_grid_add_sweep(sd_grid *g, sd_grid_sweep *sweep, void *ctx)
{
  g->sweep = sweep;
  g->sweep_ctx = ctx;
  return three_more_planes(g);
}

/* --- bricks --- */

/* Where the planes of our slab will be */
static int place_slab(sd_grid *g)
{
  const int planes = sd_grid_own(g, SD_SHARED_X), x0 = g->own[SD_SHARED_X][0];
  const long numbers = 6L * g->size[1] * sd_grid_own(g, SD_SHARED_Z);
  long missing = 0;
  for (int x = 0; x < planes; x++) g->slab[x] = NULL;
  for (int k = 0; k < g->ins && g->layer >= numbers; k++) {
    const sd_piece *p = g->in + k;
    for (int i = 0; i < p->n[0] && p->rank == g->me; i++)
      g->slab[p->to[0] + i - x0] = (fftw_complex *) (g->brick + (p->at[0] + i) * g->layer);
  }
  for (int x = 0; x < planes; x++) missing += !g->slab[x];
  if (!sd_reserve(&g->spare, sizeof(double), (size_t) (missing * numbers), &g->spare_room))
    return 0;
  for (int x = 0; x < planes; x++)
    if (!g->slab[x]) g->slab[x] = (fftw_complex *) (g->spare + --missing * numbers);
  return 1;
}

sd_status sd_grid_place(sd_grid *g, const int *bricks)
{
  const int *own = bricks + 6 * g->me;
  for (int d = 0; d < 3; d++) {
    g->lo[d] = own[d];
    g->n[d] = own[3 + d];
  }
  g->row =
      (3 * (long) g->n[2] + 7) / 8 * 8 + 8; /* vectors of the windows end beyond the last point */
  g->layer = g->row * g->n[1];
  sd_grid_list_pieces(g, bricks, NULL, NULL, &g->outs, &g->ins);
  if (!sd_reserve(&g->out, sizeof(sd_piece), (size_t) g->outs, &g->out_room) ||
      !sd_reserve(&g->in, sizeof(sd_piece), (size_t) g->ins, &g->in_room))
    return SD_ENOMEMORY;
  sd_grid_list_pieces(g, bricks, g->out, g->in, &g->outs, &g->ins);
  if (!sd_grid_count_pieces(g, g->out, g->outs, PIECES_TO) || !sd_grid_count_pieces(g, g->in, g->ins, PIECES_FROM))
    return SD_ENOMEMORY;
  const size_t brick = (size_t) (g->layer * g->n[0]) + 24, doubles = sd_grid_largest_message(g);
  if (!sd_reserve(&g->brick, sizeof(double), brick, &g->brick_room)) return SD_ENOMEMORY;
  for (int k = 0; k < 2; k++)
    if (!sd_reserve(g->message + k, sizeof(double), doubles, g->message_room + k))
      return SD_ENOMEMORY;
  return place_slab(g) ? SD_OK : SD_ENOMEMORY;
}

/* --- bricks and planes of points --- */

/* Rows of a piece along z: three numbers a point, of the brick or of a message */
static double *brick_row(const sd_grid *g, const sd_piece *p, int i, int j)
{
  return g->brick + (p->at[0] + i) * g->layer + (p->at[1] + j) * g->row + 3 * (long) p->at[2];
}

static double *message_row(const sd_piece *p, double *message, int i, int j)
{
  return message + p->message + 3 * ((long) i * p->n[1] + j) * p->n[2];
}

/* The pieces of other ranks, from the brick to a message or back */
static void copy_pieces(const sd_grid *g, double *message, int to_brick)
{
  for (int k = 0; k < g->outs; k++) {
    const sd_piece *p = g->out + k;
    if (p->rank == g->me) continue;
    for (int i = 0; i < p->n[0]; i++)
      for (int j = 0; j < p->n[1]; j++) {
        double *brick = brick_row(g, p, i, j), *row = message_row(p, message, i, j);
        memcpy(to_brick ? brick : row, to_brick ? row : brick,
               3 * sizeof(double) * (size_t) p->n[2]);
      }
  }
}

static void add_row(const sd_grid *g, long at, double *row, int n)
{
  double *restrict f0 = (double *) g->plane[0] + at, *restrict f1 = (double *) g->plane[1] + at;
  double *restrict f2 = (double *) g->plane[2] + at;
  for (int k = 0; k < n; k++) {
    f0[k] += row[3 * k];
    f1[k] += row[3 * k + 1];
    f2[k] += row[3 * k + 2];
  }
}

static void take_row(const sd_grid *g, long at, double *row, int n)
{
  const double *f0 = (double *) g->plane[0] + at, *f1 = (double *) g->plane[1] + at;
  const double *f2 = (double *) g->plane[2] + at;
  for (int k = 0; k < n; k++) {
    row[3 * k] = f0[k];
    row[3 * k + 1] = f1[k];
    row[3 * k + 2] = f2[k];
  }
}

/* Points of our lines of plane x, row by row of the pieces: added from them, or given to them. Our
 * own are in the brick, others in the message. */
static inline void each_row(const sd_grid *g, int x, double *message,
                            void (*visit)(const sd_grid *g, long at, double *row, int n))
{
  for (int k = 0; k < g->ins; k++) {
    const sd_piece *p = g->in + k;
    const int i = x - p->to[0];
    if (i < 0 || i >= p->n[0]) continue;
    for (int j = 0; j < p->n[1]; j++)
      visit(g, 2L * g->half * (p->to[1] - g->own[SD_SHARED_LINES][0] + j) + p->to[2],
            p->rank == g->me ? brick_row(g, p, i, j) : message_row(p, message, i, j), p->n[2]);
  }
}

static void fill_plane(const sd_grid *g, int x, double *message)
{
  for (int c = 0; c < 3; c++)
    memset(g->plane[c], 0,
           sizeof(fftw_complex) * (size_t) sd_grid_own(g, SD_SHARED_LINES) * (size_t) g->half);
  each_row(g, x, message, add_row);
}

/* --- transforms --- */

static fftw_complex *slab_row(const sd_grid *g, int c, int x, int y)
{
  const long depth = sd_grid_own(g, SD_SHARED_Z);
  return g->slab[x - g->own[SD_SHARED_X][0]] + ((long) c * g->size[1] + y) * depth;
}

static void copy(double *beside, double *box, long numbers, int to_beside)
{
  memcpy(to_beside ? beside : box, to_beside ? box : beside, sizeof(double) * (size_t) numbers);
}

/* The turn in a row, of pencils from z to y: from each of its ranks to each a box of wave numbers
 * [3][x][its lines][z of the other], which goes forth and comes back; what stays here waits where the
 * slab will be. Our lines, all z of them, between boxes and `beside` */
static void copy_lines(const sd_grid *g, int c, int x, double *message, int to_beside)
{
  const long planes = sd_grid_own(g, SD_SHARED_X), lines = sd_grid_own(g, SD_SHARED_LINES);
  const int first = g->me - g->me % g->columns;
  for (int r = first; r < first + g->columns; r++) {
    int z[2];
    sd_grid_range_of(g, SD_SHARED_Z, r, z);
    const long row = 2L * (z[1] - z[0]);
    double *box = message + (c * planes + x - g->own[SD_SHARED_X][0]) * lines * row;
    if (r == g->me) box = (double *) slab_row(g, c, x, 0);
    for (long l = 0; l < lines; l++, box += row)
      copy((double *) g->beside + 2 * (l * g->half + z[0]), box, row, to_beside);
    if (r != g->me) message += 3 * planes * lines * row;
  }
}

/* All lines at our z, between boxes and `beside` */
static void copy_depths(const sd_grid *g, int c, int x, double *message, int to_beside)
{
  const long planes = sd_grid_own(g, SD_SHARED_X), row = 2L * sd_grid_own(g, SD_SHARED_Z);
  const int first = g->me - g->me % g->columns;
  double *beside = (double *) g->beside;
  for (int r = first; r < first + g->columns; r++) {
    const long numbers = sd_grid_length(g, SD_SHARED_LINES, r) * row;
    double *box = message + (c * planes + x - g->own[SD_SHARED_X][0]) * numbers;
    copy(beside, r == g->me ? (double *) slab_row(g, c, x, 0) : box, numbers, to_beside);
    beside += numbers;
    if (r != g->me) message += 3 * planes * numbers;
  }
}

/* The turn in a column, from x to y planes: from each rank to each a box of wave numbers [3][its
 * x][its y][z]. Rows y of other ranks in our plane x, to the message or from it */
static void copy_rows(const sd_grid *g, int c, int x, double *message, int to_slab)
{
  const long planes = sd_grid_own(g, SD_SHARED_X), row = 2L * sd_grid_own(g, SD_SHARED_Z);
  for (int r = g->me % g->columns; r < g->rows * g->columns; r += g->columns) {
    int y[2];
    if (r == g->me) continue;
    sd_grid_range_of(g, SD_SHARED_Y, r, y);
    const long rows = y[1] - y[0];
    copy((double *) slab_row(g, c, x, y[0]),
         message + (c * planes + x - g->own[SD_SHARED_X][0]) * rows * row, rows * row, to_slab);
    message += 3 * planes * rows * row;
  }
}

/* Rows of our plane y, one for each x: in the slab, or where other ranks' have come in; to `beside`
 * or from it */
static void copy_plane(const sd_grid *g, int c, int y, double *message, int to_beside)
{
  const long row = 2L * sd_grid_own(g, SD_SHARED_Z), planes = sd_grid_own(g, SD_SHARED_Y);
  double *beside = (double *) g->beside;
  for (int r = g->me % g->columns; r < g->rows * g->columns; r += g->columns) {
    int x[2];
    sd_grid_range_of(g, SD_SHARED_X, r, x);
    const long rows = x[1] - x[0];
    for (long k = 0; k < rows; k++, beside += row)
      copy(beside,
           r == g->me ? (double *) slab_row(g, c, x[0] + (int) k, y)
                      : message + ((c * rows + k) * planes + y - g->own[SD_SHARED_Y][0]) * row,
           row, to_beside);
    if (r != g->me) message += 3 * rows * planes * row;
  }
}

/* Rows of `beside` that hold nothing, at our z */
static void clear_rows(const sd_grid *g, int from, int end)
{
  const size_t depth = (size_t) sd_grid_own(g, SD_SHARED_Z);
  memset(g->beside + (size_t) from * depth, 0, sizeof(fftw_complex) * (size_t) (end - from) * depth);
}

/* What is beside along y to the slab, or back */
static void forth_along_y(sd_grid *g, int c, int x, double *message)
{
  clear_rows(g, g->occupied[1], g->size[1]);
  fftw_execute_dft(g->y_forth, g->beside, slab_row(g, c, x, 0));
  copy_rows(g, c, x, message, 0);
}

static void back_along_y(sd_grid *g, int c, int x, double *message)
{
  copy_rows(g, c, x, message, 1);
  fftw_execute_dft(g->y_back, slab_row(g, c, x, 0), g->beside);
}

/* Rows of `beside` times their heights, along x to `raised` */
static void raise_rows(sd_grid *g, int c)
{
  const long row = 2L * sd_grid_own(g, SD_SHARED_Z);
  double *beside = (double *) g->beside;
  for (int x = 0; x < g->occupied[0]; x++)
    for (long k = 0; k < row; k++) beside[x * row + k] *= g->height[x];
  fftw_execute_dft(g->x_forth, g->beside, g->raised[c]);
}

/* `raised` back along x, and its product with the heights to `beside`; plane c is free. */
static void add_raised(sd_grid *g, int c)
{
  const long row = 2L * sd_grid_own(g, SD_SHARED_Z);
  double *beside = (double *) g->beside;
  const double *raised = (const double *) g->plane[c];
  fftw_execute_dft(g->x_back, g->raised[c], g->plane[c]);
  for (int x = 0; x < g->occupied[0]; x++)
    for (long k = 0; k < row; k++) beside[x * row + k] += g->height[x] * raised[x * row + k];
}

/* What a sweep starts from, as long as it is there, and what they make of it */
static void keep_for_sweep(sd_grid *g, int c)
{
  const size_t row = 2 * (size_t) sd_grid_own(g, SD_SHARED_Z);
  memcpy(g->raised[c], g->beside, sizeof(double) * row * (size_t) g->occupied[0]);
}

static void add_sweep(sd_grid *g, int c)
{
  const long numbers = 2L * sd_grid_own(g, SD_SHARED_Z) * g->occupied[0];
  double *restrict beside = (double *) g->beside;
  const double *restrict swept = (const double *) g->raised[c];
  for (long k = 0; k < numbers; k++) beside[k] += swept[k];
}

/* One y plane: along x, the product, back along x. It stays in the cache meanwhile. */
static void through_plane(sd_grid *g, int y, sd_grid_multiply *multiply, void *ctx, double *message)
{
  double *planes[6];
  for (int c = 0; c < 3; c++) {
    planes[c] = (double *) g->plane[c];
    planes[3 + c] = (double *) g->raised[c];
    copy_plane(g, c, y, message, 1);
    clear_rows(g, g->occupied[0], g->size[0]);
    fftw_execute_dft(g->x_forth, g->beside, g->plane[c]);
    if (g->height) raise_rows(g, c);
    if (g->sweep) keep_for_sweep(g, c);
  }
  multiply(ctx, y, planes);
  if (g->sweep) g->sweep(g->sweep_ctx, y, planes + 3);
  for (int c = 0; c < 3; c++) {
    fftw_execute_dft(g->x_back, g->plane[c], g->beside);
    if (g->height) add_raised(g, c);
    if (g->sweep) add_sweep(g, c);
    copy_plane(g, c, y, message, 0);
  }
}

/* --- all of it --- */

/* What is in message `from` to the other ranks, what they send to the other message */
static sd_status exchange(const sd_grid *g, int from, int to_counts, int from_counts)
{
  if (g->ranks == 1) return SD_OK;
  return g->world.exchange(g->world.ctx, g->message[from], g->counts + to_counts * g->ranks,
                           g->message[1 - from], g->counts + from_counts * g->ranks);
}

/* From the pieces in the second message, or from what `fill` says, to the slab, and what of it is
 * others' to the first */
static sd_status forth(sd_grid *g, sd_grid_fill *fill, void *fill_ctx)
{
  double *first = g->message[0], *second = g->message[1];
  const int *x = g->own[SD_SHARED_X], *lines = g->own[SD_SHARED_LINES];
  double *const fields[3] = {(double *) g->plane[0], (double *) g->plane[1], (double *) g->plane[2]};
  for (int k = x[0]; k < x[1]; k++) {
    if (fill)
      fill(fill_ctx, k, lines[0], lines[1], 2L * g->half, fields);
    else
      fill_plane(g, k, second);
    for (int c = 0; c < 3; c++) {
      fftw_execute_dft_r2c(g->z_forth, (double *) g->plane[c], g->beside);
      if (g->columns == 1)
        forth_along_y(g, c, k, first);
      else
        copy_lines(g, c, k, first, 0);
    }
  }
  if (g->columns == 1) return SD_OK;
  const sd_status status = exchange(g, 0, ROW_TO, ROW_FROM);
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
  double *first = g->message[0], *second = g->message[1];
  const int *x = g->own[SD_SHARED_X];
  for (int k = x[0]; k < x[1] && g->columns > 1; k++)
    for (int c = 0; c < 3; c++) {
      back_along_y(g, c, k, first);
      copy_depths(g, c, k, second, 0);
    }
  const sd_status status = g->columns > 1 ? exchange(g, 1, ROW_FROM, ROW_TO) : SD_OK;
  for (int k = x[0]; k < x[1] && status == SD_OK; k++) {
    for (int c = 0; c < 3; c++) {
      if (g->columns == 1)
        back_along_y(g, c, k, first);
      else
        copy_lines(g, c, k, first, 1);
      fftw_execute_dft_c2r(g->z_back, g->beside, (double *) g->plane[c]);
    }
    each_row(g, k, second, take_row);
  }
  return status;
}

sd_status sd_grid_convolve(sd_grid *g, sd_grid_multiply *multiply, void *ctx)
{
  copy_pieces(g, g->message[0], 0);
  const sd_status status = exchange(g, 0, PIECES_TO, PIECES_FROM);
  return status == SD_OK ? sd_grid_convolve_values(g, NULL, NULL, multiply, ctx) : status;
}

sd_status sd_grid_convolve_values(sd_grid *g, sd_grid_fill *fill, void *fill_ctx,
                                  sd_grid_multiply *multiply, void *ctx)
{
  const int *y = g->own[SD_SHARED_Y];
  sd_status status = forth(g, fill, fill_ctx);
  if (status == SD_OK) status = exchange(g, 0, COLUMN_TO, COLUMN_FROM);
  for (int k = y[0]; k < y[1] && status == SD_OK; k++)
    through_plane(g, k, multiply, ctx, g->message[1]);
  if (status == SD_OK) status = exchange(g, 1, COLUMN_FROM, COLUMN_TO);
  if (status == SD_OK) status = back(g);
  if (status == SD_OK) status = exchange(g, 1, PIECES_FROM, PIECES_TO);
  if (status == SD_OK) copy_pieces(g, g->message[0], 1);
  return status;
}
