#include "sd_grid.h"

#include <stdlib.h>
#include <string.h>

#include "sd_room.h"

/* --- plans and slabs --- */

static int share(int all, int part, int parts)
{
  return (int) ((long) all * part / parts);
}

static int allocate(sd_grid *g)
{
  const int longer = g->size[0] > g->size[1] ? g->size[0] : g->size[1];
  const size_t half = (size_t) g->half, plane = (size_t) longer * half;
  int ok = 1;
  for (int c = 0; c < 3; c++) {
    g->plane[c] = fftw_alloc_complex(plane);
    ok = ok && g->plane[c];
  }
  g->slab = calloc((size_t) (g->x1 - g->x0) + 1, sizeof(fftw_complex *));
  g->beside = fftw_alloc_complex(plane);
  g->counts = calloc(4 * (size_t) g->ranks, sizeof(int));
  return ok && g->slab && g->beside && g->counts;
}

/* One x plane along z, rows that hold something, to wave numbers beside; from there along y to the
 * slab, all wave numbers of z; one y plane along x. From one place to another, which FFTW does faster
 * than in one place. FFTW_ESTIMATE: measured plans differ from run to run, and so do their last bits. */
static int plan(sd_grid *g)
{
  const unsigned how = FFTW_ESTIMATE;
  const int half = g->half, rows = g->occupied[1], *size = g->size;
  fftw_complex *slab = g->plane[1], *plane = g->plane[0], *beside = g->beside;
  g->z_forth = fftw_plan_many_dft_r2c(1, size + 2, rows, (double *) plane, NULL, 1, 2 * half,
                                      beside, NULL, 1, half, how);
  g->z_back = fftw_plan_many_dft_c2r(1, size + 2, rows, beside, NULL, 1, half, (double *) plane,
                                     NULL, 1, 2 * half, how);
  g->y_forth = fftw_plan_many_dft(1, size + 1, half, beside, NULL, half, 1, slab, NULL, half, 1,
                                  FFTW_FORWARD, how);
  g->y_back = fftw_plan_many_dft(1, size + 1, half, slab, NULL, half, 1, beside, NULL, half, 1,
                                 FFTW_BACKWARD, how);
  g->x_forth = fftw_plan_many_dft(1, size, half, beside, NULL, half, 1, plane, NULL, half, 1,
                                  FFTW_FORWARD, how);
  g->x_back = fftw_plan_many_dft(1, size, half, plane, NULL, half, 1, beside, NULL, half, 1,
                                 FFTW_BACKWARD, how);
  return g->z_forth && g->z_back && g->y_forth && g->y_back && g->x_forth && g->x_back;
}

sd_status sd_grid_create(sd_grid *g, const int *size, const int *occupied, const sd_world *world)
{
  sd_grid_free(g);
  g->world = *world;
  g->ranks = world->ranks > 0 && world->exchange ? world->ranks : 1;
  g->me = g->ranks > 1 ? world->me : 0;
  for (int d = 0; d < 3; d++) {
    g->size[d] = size[d];
    g->occupied[d] = occupied[d];
  }
  g->half = size[2] / 2 + 1;
  g->x0 = share(occupied[0], g->me, g->ranks);
  g->x1 = share(occupied[0], g->me + 1, g->ranks);
  g->y0 = share(size[1], g->me, g->ranks);
  g->y1 = share(size[1], g->me + 1, g->ranks);
  if (allocate(g) && plan(g)) return SD_OK;
  sd_grid_free(g);
  return SD_ENOMEMORY;
}

void sd_grid_free(sd_grid *g)
{
  fftw_plan *const plans[] = {&g->z_forth, &g->z_back,  &g->y_forth,
                              &g->y_back,  &g->x_forth, &g->x_back};
  for (int k = 0; k < 6; k++)
    if (*plans[k]) fftw_destroy_plan(*plans[k]);
  for (int c = 0; c < 3; c++) { fftw_free(g->plane[c]); }
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

/* --- bricks and pieces --- */

/* Part k of the points lo ... lo + n - 1 that lies within one period and within [begin, end) of it:
 * its offset in the brick, its place, its points; 0: there is no part k. */
static int part_of(int lo, int n, int period, int begin, int end, int k, int *at, int *to)
{
  const int first = lo >= 0 ? lo / period : -((period - 1 - lo) / period);
  const int origin = (first + k) * period;
  if (origin >= lo + n) return -1;
  const int from = lo > origin + begin ? lo : origin + begin;
  const int till = lo + n < origin + end ? lo + n : origin + end;
  *at = from - lo;
  *to = from - origin;
  return till > from ? till - from : 0;
}

/* The pieces of a brick [6] within the x planes begin ... end - 1, after those in list; NULL: only
 * counted. */
static int pieces_of(const sd_grid *g, const int *brick, int rank, int begin, int end,
                     sd_piece *list)
{
  const int *lo = brick, *n = brick + 3;
  int count = 0;
  sd_piece p = {.rank = rank};
  if (n[0] == 0 || n[1] == 0 || n[2] == 0) return 0;
  for (int i = 0; (p.n[0] = part_of(lo[0], n[0], g->size[0], begin, end, i, p.at, p.to)) >= 0; i++)
    for (int j = 0;
         (p.n[1] = part_of(lo[1], n[1], g->size[1], 0, g->size[1], j, p.at + 1, p.to + 1)) >= 0;
         j++)
      for (int k = 0;
           (p.n[2] = part_of(lo[2], n[2], g->size[2], 0, g->size[2], k, p.at + 2, p.to + 2)) >= 0;
           k++) {
        if (p.n[0] == 0 || p.n[1] == 0 || p.n[2] == 0) continue;
        if (list) list[count] = p;
        count++;
      }
  return count;
}

double sd_grid_at_home(const sd_grid *g, const int *bricks, int d)
{
  double points = 0.0;
  for (int r = 0; r < g->ranks; r++) {
    const int *lo = bricks + 6 * r, *n = lo + 3;
    const int begin = share(g->occupied[d], r, g->ranks),
              end = share(g->occupied[d], r + 1, g->ranks);
    int at, to, planes = 0, part;
    for (int k = 0;
         n[d] > 0 && (part = part_of(lo[d], n[d], g->size[d], begin, end, k, &at, &to)) >= 0; k++)
      planes += part;
    points += (double) planes * n[(d + 1) % 3] * n[(d + 2) % 3];
  }
  return points;
}

static void list_pieces(const sd_grid *g, const int *bricks, sd_piece *out, sd_piece *in, int *outs,
                        int *ins)
{
  *outs = *ins = 0;
  for (int r = 0; r < g->ranks; r++) {
    const int begin = share(g->occupied[0], r, g->ranks);
    const int end = share(g->occupied[0], r + 1, g->ranks);
    *outs += pieces_of(g, bricks + 6 * g->me, r, begin, end, out ? out + *outs : NULL);
    *ins += pieces_of(g, bricks + 6 * r, r, g->x0, g->x1, in ? in + *ins : NULL);
  }
}

/* Numbers of pieces to or from each rank, one rank after the other; our own need no message. All
 * together */
static size_t count_pieces(const sd_grid *g, sd_piece *list, int pieces, int *counts)
{
  long all = 0;
  for (int k = 0; k < pieces; k++) {
    sd_piece *p = list + k;
    p->message = all;
    if (p->rank == g->me) continue;
    const int numbers = 3 * p->n[0] * p->n[1] * p->n[2];
    counts[p->rank] += numbers;
    all += numbers;
  }
  return (size_t) all;
}

/* Planes of a rank in the slabs along x or y: first and end */
static void planes_of(const sd_grid *g, int rank, int d, int *planes)
{
  const int all = d == 0 ? g->occupied[0] : g->size[1];
  planes[0] = share(all, rank, g->ranks);
  planes[1] = share(all, rank + 1, g->ranks);
}

/* Numbers to and from each rank; returns the largest message. */
static size_t count_numbers(sd_grid *g)
{
  int *to = g->counts, *from = to + g->ranks, *turn_to = from + g->ranks;
  int *turn_from = turn_to + g->ranks;
  memset(g->counts, 0, sizeof(int) * 4 * (size_t) g->ranks);
  const size_t out = count_pieces(g, g->out, g->outs, to);
  size_t most = count_pieces(g, g->in, g->ins, from), turn = 0, turned = 0;
  for (int r = 0; r < g->ranks; r++) {
    int x[2], y[2];
    planes_of(g, r, 0, x);
    planes_of(g, r, 1, y);
    if (r == g->me) continue;
    turn_to[r] = 6 * g->half * (g->x1 - g->x0) * (y[1] - y[0]);
    turn_from[r] = 6 * g->half * (x[1] - x[0]) * (g->y1 - g->y0);
    turn += (size_t) turn_to[r];
    turned += (size_t) turn_from[r];
  }
  if (out > most) most = out;
  if (turn > most) most = turn;
  return turned > most ? turned : most;
}

/* Where the planes of our slab will be */
static int place_slab(sd_grid *g)
{
  const int planes = g->x1 - g->x0;
  const long numbers = 6L * g->size[1] * g->half;
  long missing = 0;
  for (int x = 0; x < planes; x++) g->slab[x] = NULL;
  for (int k = 0; k < g->ins && g->layer >= numbers; k++) {
    const sd_piece *p = g->in + k;
    for (int i = 0; i < p->n[0] && p->rank == g->me; i++)
      g->slab[p->to[0] + i - g->x0] = (fftw_complex *) (g->brick + (p->at[0] + i) * g->layer);
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
  const size_t brick = (size_t) (g->layer * g->n[0]) + 24;
  if (!sd_reserve(&g->brick, sizeof(double), brick, &g->brick_room)) return SD_ENOMEMORY;
  list_pieces(g, bricks, NULL, NULL, &g->outs, &g->ins);
  if (!sd_reserve(&g->out, sizeof(sd_piece), (size_t) g->outs, &g->out_room) ||
      !sd_reserve(&g->in, sizeof(sd_piece), (size_t) g->ins, &g->in_room))
    return SD_ENOMEMORY;
  list_pieces(g, bricks, g->out, g->in, &g->outs, &g->ins);
  const size_t doubles = count_numbers(g);
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

static void add_row(const sd_grid *g, long at, const double *row, int n)
{
  double *restrict f0 = (double *) g->plane[0] + at, *restrict f1 = (double *) g->plane[1] + at;
  double *restrict f2 = (double *) g->plane[2] + at;
  for (int k = 0; k < n; k++) {
    f0[k] += row[3 * k];
    f1[k] += row[3 * k + 1];
    f2[k] += row[3 * k + 2];
  }
}

static void take_row(const sd_grid *g, long at, double *restrict row, int n)
{
  const double *f0 = (double *) g->plane[0] + at, *f1 = (double *) g->plane[1] + at;
  const double *f2 = (double *) g->plane[2] + at;
  for (int k = 0; k < n; k++) {
    row[3 * k] = f0[k];
    row[3 * k + 1] = f1[k];
    row[3 * k + 2] = f2[k];
  }
}

/* Points of plane x of our slab: added from what of the pieces lies in it, or given to them. Our own
 * are in the brick, others in the message. */
static void fill_plane(const sd_grid *g, int x, double *message)
{
  for (int c = 0; c < 3; c++)
    memset(g->plane[c], 0, sizeof(fftw_complex) * (size_t) g->occupied[1] * (size_t) g->half);
  for (int k = 0; k < g->ins; k++) {
    const sd_piece *p = g->in + k;
    const int i = x - p->to[0];
    if (i < 0 || i >= p->n[0]) continue;
    for (int j = 0; j < p->n[1]; j++)
      add_row(g, 2L * g->half * (p->to[1] + j) + p->to[2],
              p->rank == g->me ? brick_row(g, p, i, j) : message_row(p, message, i, j), p->n[2]);
  }
}

static void empty_plane(const sd_grid *g, int x, double *message)
{
  for (int k = 0; k < g->ins; k++) {
    const sd_piece *p = g->in + k;
    const int i = x - p->to[0];
    if (i < 0 || i >= p->n[0]) continue;
    for (int j = 0; j < p->n[1]; j++)
      take_row(g, 2L * g->half * (p->to[1] + j) + p->to[2],
               p->rank == g->me ? brick_row(g, p, i, j) : message_row(p, message, i, j), p->n[2]);
  }
}

/* --- transforms --- */

static fftw_complex *slab_row(const sd_grid *g, int c, int x, int y)
{
  return g->slab[x - g->x0] + ((long) c * g->size[1] + y) * g->half;
}

/* Plane x of our slab along z and y, or back */
static void forth_along_zy(sd_grid *g, int c, int x)
{
  const size_t empty = (size_t) (g->size[1] - g->occupied[1]) * (size_t) g->half;
  fftw_execute_dft_r2c(g->z_forth, (double *) g->plane[c], g->beside);
  memset(g->beside + (long) g->occupied[1] * g->half, 0, sizeof(fftw_complex) * empty);
  fftw_execute_dft(g->y_forth, g->beside, slab_row(g, c, x, 0));
}

static void back_along_yz(sd_grid *g, int c, int x)
{
  fftw_execute_dft(g->y_back, slab_row(g, c, x, 0), g->beside);
  fftw_execute_dft_c2r(g->z_back, g->beside, (double *) g->plane[c]);
}

/* The turn from x to y planes: from each rank to each a box of wave numbers [3][its x][its y][half],
 * which goes forth and comes back. Rows y of other ranks in our plane x, to the message or from it */
static void copy_rows(const sd_grid *g, int c, int x, double *message, int to_slab)
{
  const long planes = g->x1 - g->x0, row = 2L * g->half;
  for (int r = 0; r < g->ranks; r++) {
    int y[2];
    if (r == g->me) continue;
    planes_of(g, r, 1, y);
    const long rows = y[1] - y[0];
    double *there = message + (c * planes + x - g->x0) * rows * row;
    double *here = (double *) slab_row(g, c, x, y[0]);
    memcpy(to_slab ? here : there, to_slab ? there : here, sizeof(double) * (size_t) (rows * row));
    message += 3 * planes * rows * row;
  }
}

/* Rows of our plane y, one for each x: in the slab, or where other ranks' have come in; to `beside`
 * or from it */
static void copy_plane(const sd_grid *g, int c, int y, double *message, int to_beside)
{
  const long row = 2L * g->half, planes = g->y1 - g->y0;
  const size_t bytes = sizeof(double) * (size_t) row;
  double *beside = (double *) g->beside;
  for (int r = 0; r < g->ranks; r++) {
    int x[2];
    planes_of(g, r, 0, x);
    const long rows = x[1] - x[0];
    for (long k = 0; k < rows; k++, beside += row) {
      double *at = r == g->me ? (double *) slab_row(g, c, x[0] + (int) k, y)
                              : message + ((c * rows + k) * planes + y - g->y0) * row;
      memcpy(to_beside ? beside : at, to_beside ? at : beside, bytes);
    }
    if (r != g->me) message += 3 * rows * planes * row;
  }
}

/* One y plane: along x, the product, back along x. It stays in the cache meanwhile. */
static void through_plane(sd_grid *g, int y, sd_grid_multiply *multiply, void *ctx, double *message)
{
  const size_t empty = (size_t) (g->size[0] - g->occupied[0]) * (size_t) g->half;
  double *planes[3];
  for (int c = 0; c < 3; c++) {
    planes[c] = (double *) g->plane[c];
    copy_plane(g, c, y, message, 1);
    memset(g->beside + (long) g->occupied[0] * g->half, 0, sizeof(fftw_complex) * empty);
    fftw_execute_dft(g->x_forth, g->beside, g->plane[c]);
  }
  multiply(ctx, y, planes);
  for (int c = 0; c < 3; c++) {
    fftw_execute_dft(g->x_back, g->plane[c], g->beside);
    copy_plane(g, c, y, message, 0);
  }
}

/* --- all of it --- */

/* What is in message `from` to the other ranks, what they send to the other message; counts: which
 * numbers of those of the grid, to and from each rank */
static sd_status exchange(const sd_grid *g, int from, int to_counts, int from_counts)
{
  if (g->ranks == 1) return SD_OK;
  return g->world.exchange(g->world.ctx, g->message[from], g->counts + to_counts * g->ranks,
                           g->message[1 - from], g->counts + from_counts * g->ranks);
}

sd_status sd_grid_convolve(sd_grid *g, sd_grid_multiply *multiply, void *ctx)
{
  double *first = g->message[0], *second = g->message[1];
  copy_pieces(g, first, 0);
  sd_status status = exchange(g, 0, 0, 1);
  if (status != SD_OK) return status;
  for (int x = g->x0; x < g->x1; x++) {
    fill_plane(g, x, second);
    for (int c = 0; c < 3; c++) {
      forth_along_zy(g, c, x);
      copy_rows(g, c, x, first, 0);
    }
  }
  if ((status = exchange(g, 0, 2, 3)) != SD_OK) return status;
  for (int y = g->y0; y < g->y1; y++) through_plane(g, y, multiply, ctx, second);
  if ((status = exchange(g, 1, 3, 2)) != SD_OK) return status;
  for (int x = g->x0; x < g->x1; x++) {
    for (int c = 0; c < 3; c++) {
      copy_rows(g, c, x, first, 1);
      back_along_yz(g, c, x);
    }
    empty_plane(g, x, second);
  }
  if ((status = exchange(g, 1, 1, 0)) != SD_OK) return status;
  copy_pieces(g, first, 1);
  return SD_OK;
}
