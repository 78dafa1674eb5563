#include "sd_grid.h"

#include <stdlib.h>
#include <string.h>

/* --- plans and slabs --- */

static int share(int all, int part, int parts)
{
  return (int) ((long) all * part / parts);
}

static size_t slab_numbers(const sd_grid *g)
{
  return (size_t) (g->x1 - g->x0) * (size_t) g->size[1] * (size_t) g->half;
}

static size_t turned_numbers(const sd_grid *g)
{
  return (size_t) (g->y1 - g->y0) * (size_t) g->occupied[0] * (size_t) g->half;
}

static int allocate(sd_grid *g)
{
  const size_t planes = (size_t) g->size[0] * (size_t) g->half;
  int ok = 1;
  for (int c = 0; c < 3; c++) {
    /* a rank without planes still plans, on one of its own */
    const size_t least = (size_t) g->size[1] * (size_t) g->half, slab = slab_numbers(g);
    g->x_slab[c] = fftw_alloc_complex(slab > least ? slab : least);
    g->plane[c] = fftw_alloc_complex(planes);
    if (g->ranks > 1) g->y_slab[c] = fftw_alloc_complex(turned_numbers(g) + 1);
    ok = ok && g->x_slab[c] && g->plane[c] && (g->ranks == 1 || g->y_slab[c]);
  }
  const int longer = g->size[0] > g->size[1] ? g->size[0] : g->size[1];
  g->beside = fftw_alloc_complex((size_t) longer * (size_t) g->half);
  g->counts = calloc(4 * (size_t) g->ranks, sizeof(int));
  return ok && g->beside && g->counts;
}

/* One x plane along z, rows that hold something; one along y, all wave numbers of z; one y plane
 * along x. From one place to another, which FFTW does faster than in one place. FFTW_ESTIMATE:
 * measured plans differ from run to run, and so do their last bits. */
static int plan(sd_grid *g)
{
  const unsigned how = FFTW_ESTIMATE;
  const int half = g->half, rows = g->occupied[1], *size = g->size;
  fftw_complex *slab = g->x_slab[0], *plane = g->plane[0], *beside = g->beside;
  g->z_forth = fftw_plan_many_dft_r2c(1, size + 2, rows, (double *) slab, NULL, 1, 2 * half, beside,
                                      NULL, 1, half, how);
  g->z_back = fftw_plan_many_dft_c2r(1, size + 2, rows, beside, NULL, 1, half, (double *) slab, NULL,
                                     1, 2 * half, how);
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
  fftw_plan *const plans[] = {&g->z_forth, &g->z_back, &g->y_forth,
                              &g->y_back,  &g->x_forth, &g->x_back};
  for (int k = 0; k < 6; k++)
    if (*plans[k]) fftw_destroy_plan(*plans[k]);
  for (int c = 0; c < 3; c++) {
    fftw_free(g->x_slab[c]);
    fftw_free(g->y_slab[c]);
    fftw_free(g->plane[c]);
  }
  fftw_free(g->beside);
  free(g->brick);
  free(g->out);
  free(g->in);
  free(g->counts);
  free(g->send);
  free(g->receive);
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
    for (int j = 0; (p.n[1] = part_of(lo[1], n[1], g->size[1], 0, g->size[1], j, p.at + 1,
                                      p.to + 1)) >= 0; j++)
      for (int k = 0; (p.n[2] = part_of(lo[2], n[2], g->size[2], 0, g->size[2], k, p.at + 2,
                                        p.to + 2)) >= 0; k++) {
        if (p.n[0] == 0 || p.n[1] == 0 || p.n[2] == 0) continue;
        if (list) list[count] = p;
        count++;
      }
  return count;
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

/* Numbers to and from each rank. Our own pieces need no message. */
static size_t count_numbers(sd_grid *g)
{
  int *to = g->counts, *from = to + g->ranks, *turn_to = from + g->ranks;
  int *turn_from = turn_to + g->ranks;
  size_t most_to = 0, most_from = 0, turn = 0, turned = 0;
  memset(g->counts, 0, sizeof(int) * 4 * (size_t) g->ranks);
  for (int k = 0; k < g->outs; k++)
    if (g->out[k].rank != g->me)
      to[g->out[k].rank] += 3 * g->out[k].n[0] * g->out[k].n[1] * g->out[k].n[2];
  for (int k = 0; k < g->ins; k++)
    if (g->in[k].rank != g->me)
      from[g->in[k].rank] += 3 * g->in[k].n[0] * g->in[k].n[1] * g->in[k].n[2];
  for (int r = 0; r < g->ranks; r++) {
    const int nx = share(g->occupied[0], r + 1, g->ranks) - share(g->occupied[0], r, g->ranks);
    const int ny = share(g->size[1], r + 1, g->ranks) - share(g->size[1], r, g->ranks);
    if (r != g->me) {
      turn_to[r] = 6 * g->half * (g->x1 - g->x0) * ny;
      turn_from[r] = 6 * g->half * nx * (g->y1 - g->y0);
    }
    most_to += (size_t) to[r];
    most_from += (size_t) from[r];
    turn += (size_t) turn_to[r];
    turned += (size_t) turn_from[r];
  }
  if (most_from > most_to) most_to = most_from;
  if (turned > turn) turn = turned;
  return most_to > turn ? most_to : turn;
}

static int reserve(double **buffer, size_t *capacity, size_t doubles)
{
  if (doubles <= *capacity && *buffer) return 1;
  free(*buffer);
  *buffer = malloc(sizeof(double) * (doubles + 8));
  *capacity = *buffer ? doubles : 0;
  return *buffer != NULL;
}

sd_status sd_grid_place(sd_grid *g, const int *bricks)
{
  const int *own = bricks + 6 * g->me;
  for (int d = 0; d < 3; d++) {
    g->lo[d] = own[d];
    g->n[d] = own[3 + d];
  }
  g->row = (3 * (long) g->n[2] + 7) / 8 * 8 + 8; /* vectors of the windows end beyond the last point */
  g->layer = g->row * g->n[1];
  if (!reserve(&g->brick, &g->brick_capacity, (size_t) (g->layer * g->n[0]) + 16))
    return SD_ENOMEMORY;
  list_pieces(g, bricks, NULL, NULL, &g->outs, &g->ins);
  const int most = g->outs > g->ins ? g->outs : g->ins;
  if (most > g->piece_capacity || !g->out) {
    free(g->out);
    free(g->in);
    g->out = malloc(sizeof(sd_piece) * ((size_t) most + 1));
    g->in = malloc(sizeof(sd_piece) * ((size_t) most + 1));
    g->piece_capacity = g->out && g->in ? most : 0;
    if (!g->out || !g->in) return SD_ENOMEMORY;
  }
  list_pieces(g, bricks, g->out, g->in, &g->outs, &g->ins);
  size_t capacity = g->buffer_capacity;
  const size_t doubles = count_numbers(g);
  if (!reserve(&g->send, &g->buffer_capacity, doubles) ||
      !reserve(&g->receive, &capacity, doubles))
    return SD_ENOMEMORY;
  return SD_OK;
}

/* --- forth and back --- */

/* Rows of a piece: of the brick and of a message three numbers a point, of the slab three fields */
static double *brick_row(const sd_grid *g, const sd_piece *p, int i, int j)
{
  return g->brick + (p->at[0] + i) * g->layer + (p->at[1] + j) * g->row + 3 * (long) p->at[2];
}

static long slab_row(const sd_grid *g, const sd_piece *p, int i, int j)
{
  const long x = p->to[0] + i - g->x0, y = p->to[1] + j;
  return (x * g->size[1] + y) * 2 * g->half + p->to[2];
}

/* Rows along z, of wave numbers or of points */
static fftw_complex *x_slab_row(const sd_grid *g, int c, int x, int y)
{
  return g->x_slab[c] + ((long) (x - g->x0) * g->size[1] + y) * g->half;
}

static fftw_complex *y_slab_row(const sd_grid *g, int c, int x, int y)
{
  if (g->ranks == 1) return x_slab_row(g, c, x, y);
  return g->y_slab[c] + ((long) (y - g->y0) * g->occupied[0] + x) * g->half;
}

static void add_to_slab(const sd_grid *g, long at, const double *row, int n)
{
  double *restrict f0 = (double *) g->x_slab[0] + at, *restrict f1 = (double *) g->x_slab[1] + at;
  double *restrict f2 = (double *) g->x_slab[2] + at;
  for (int k = 0; k < n; k++) {
    f0[k] += row[3 * k];
    f1[k] += row[3 * k + 1];
    f2[k] += row[3 * k + 2];
  }
}

static void take_from_slab(const sd_grid *g, long at, double *restrict row, int n)
{
  const double *f0 = (double *) g->x_slab[0] + at, *f1 = (double *) g->x_slab[1] + at;
  const double *f2 = (double *) g->x_slab[2] + at;
  for (int k = 0; k < n; k++) {
    row[3 * k] = f0[k];
    row[3 * k + 1] = f1[k];
    row[3 * k + 2] = f2[k];
  }
}

static sd_status bricks_to_slabs(sd_grid *g)
{
  double *next = g->send;
  for (int c = 0; c < 3; c++)
    for (int x = g->x0; x < g->x1; x++) /* rows beyond the occupied ones are not read */
      memset(x_slab_row(g, c, x, 0), 0,
             sizeof(fftw_complex) * (size_t) g->occupied[1] * (size_t) g->half);
  for (int k = 0; k < g->outs; k++) {
    const sd_piece *p = g->out + k;
    for (int i = 0; i < p->n[0]; i++)
      for (int j = 0; j < p->n[1]; j++) {
        const double *row = brick_row(g, p, i, j);
        if (p->rank == g->me) {
          add_to_slab(g, slab_row(g, p, i, j), row, p->n[2]);
        } else {
          memcpy(next, row, 3 * sizeof(double) * (size_t) p->n[2]);
          next += 3 * p->n[2];
        }
      }
  }
  if (g->ranks == 1) return SD_OK;
  const sd_status status = g->world.exchange(g->world.ctx, g->send, g->counts, g->receive,
                                             g->counts + g->ranks);
  next = g->receive;
  for (int k = 0; k < g->ins && status == SD_OK; k++) {
    const sd_piece *p = g->in + k;
    if (p->rank == g->me) continue;
    for (int i = 0; i < p->n[0]; i++)
      for (int j = 0; j < p->n[1]; j++, next += 3 * p->n[2])
        add_to_slab(g, slab_row(g, p, i, j), next, p->n[2]);
  }
  return status;
}

static sd_status slabs_to_bricks(sd_grid *g)
{
  double *next = g->send;
  for (int k = 0; k < g->ins && g->ranks > 1; k++) {
    const sd_piece *p = g->in + k;
    if (p->rank == g->me) continue;
    for (int i = 0; i < p->n[0]; i++)
      for (int j = 0; j < p->n[1]; j++, next += 3 * p->n[2])
        take_from_slab(g, slab_row(g, p, i, j), next, p->n[2]);
  }
  if (g->ranks > 1) {
    const sd_status status = g->world.exchange(g->world.ctx, g->send, g->counts + g->ranks,
                                               g->receive, g->counts);
    if (status != SD_OK) return status;
  }
  next = g->receive;
  for (int k = 0; k < g->outs; k++) {
    const sd_piece *p = g->out + k;
    for (int i = 0; i < p->n[0]; i++)
      for (int j = 0; j < p->n[1]; j++) {
        double *row = brick_row(g, p, i, j);
        if (p->rank == g->me) {
          take_from_slab(g, slab_row(g, p, i, j), row, p->n[2]);
        } else {
          memcpy(row, next, 3 * sizeof(double) * (size_t) p->n[2]);
          next += 3 * p->n[2];
        }
      }
  }
  return SD_OK;
}

/* The turn: our x slab has rows for all ranks' y planes, our y slab from all ranks' x planes. */
typedef fftw_complex *slab_row_of(const sd_grid *g, int c, int x, int y);

/* The box x, y of all three fields to the message or from it; returns where the message goes on. */
static double *pack(const sd_grid *g, slab_row_of *row, const int *x, const int *y, int packs,
                    double *message)
{
  const size_t numbers = 2 * (size_t) g->half;
  for (int c = 0; c < 3; c++)
    for (int j = y[0]; j < y[1]; j++)
      for (int i = x[0]; i < x[1]; i++, message += numbers) {
        double *at = (double *) row(g, c, i, j);
        memcpy(packs ? message : at, packs ? at : message, sizeof(double) * numbers);
      }
  return message;
}

/* x slabs to y slabs, or back */
static sd_status turn(sd_grid *g, int forth)
{
  const int own_x[2] = {g->x0, g->x1}, own_y[2] = {g->y0, g->y1};
  int *to = g->counts + 2 * g->ranks, *from = to + g->ranks;
  double *next = g->send;
  for (int pass = 0; pass < 2; pass++) {
    for (int r = 0; r < g->ranks; r++) {
      const int x[2] = {share(g->occupied[0], r, g->ranks), share(g->occupied[0], r + 1, g->ranks)};
      const int y[2] = {share(g->size[1], r, g->ranks), share(g->size[1], r + 1, g->ranks)};
      const int in_x_slab = forth == (pass == 0);
      if (r != g->me)
        next = in_x_slab ? pack(g, x_slab_row, own_x, y, pass == 0, next)
                         : pack(g, y_slab_row, x, own_y, pass == 0, next);
    }
    if (pass == 1) break;
    const sd_status status = g->world.exchange(g->world.ctx, g->send, forth ? to : from, g->receive,
                                               forth ? from : to);
    if (status != SD_OK) return status;
    next = g->receive;
  }
  for (int c = 0; c < 3; c++)
    for (int y = g->y0; y < g->y1; y++)
      for (int x = g->x0; x < g->x1; x++)
        memcpy(forth ? y_slab_row(g, c, x, y) : x_slab_row(g, c, x, y),
               forth ? x_slab_row(g, c, x, y) : y_slab_row(g, c, x, y),
               sizeof(fftw_complex) * (size_t) g->half);
  return SD_OK;
}

/* One y plane: along x, the product, back along x. It stays in the cache meanwhile. */
static void through_plane(sd_grid *g, int y, sd_grid_multiply *multiply, void *ctx)
{
  const size_t row = sizeof(fftw_complex) * (size_t) g->half;
  double *planes[3];
  for (int c = 0; c < 3; c++) {
    planes[c] = (double *) g->plane[c];
    for (int x = 0; x < g->occupied[0]; x++)
      memcpy(g->beside + (long) x * g->half, y_slab_row(g, c, x, y), row);
    memset(g->beside + (long) g->occupied[0] * g->half, 0,
           row * (size_t) (g->size[0] - g->occupied[0]));
    fftw_execute_dft(g->x_forth, g->beside, g->plane[c]);
  }
  multiply(ctx, y, planes);
  for (int c = 0; c < 3; c++) {
    fftw_execute_dft(g->x_back, g->plane[c], g->beside);
    for (int x = 0; x < g->occupied[0]; x++)
      memcpy(y_slab_row(g, c, x, y), g->beside + (long) x * g->half, row);
  }
}

/* One x plane along z and y, or back */
static void along_plane(sd_grid *g, int c, int x, int forth)
{
  fftw_complex *slab = x_slab_row(g, c, x, 0);
  if (forth) {
    const size_t empty = (size_t) (g->size[1] - g->occupied[1]) * (size_t) g->half;
    fftw_execute_dft_r2c(g->z_forth, (double *) slab, g->beside);
    memset(g->beside + (long) g->occupied[1] * g->half, 0, sizeof(fftw_complex) * empty);
    fftw_execute_dft(g->y_forth, g->beside, slab);
  } else {
    fftw_execute_dft(g->y_back, slab, g->beside);
    fftw_execute_dft_c2r(g->z_back, g->beside, (double *) slab);
  }
}

sd_status sd_grid_convolve(sd_grid *g, sd_grid_multiply *multiply, void *ctx)
{
  sd_status status = bricks_to_slabs(g);
  if (status != SD_OK) return status;
  for (int c = 0; c < 3; c++)
    for (int x = g->x0; x < g->x1; x++) along_plane(g, c, x, 1);
  if (g->ranks > 1 && (status = turn(g, 1)) != SD_OK) return status;
  for (int y = g->y0; y < g->y1; y++) through_plane(g, y, multiply, ctx);
  if (g->ranks > 1 && (status = turn(g, 0)) != SD_OK) return status;
  for (int c = 0; c < 3; c++)
    for (int x = g->x0; x < g->x1; x++) along_plane(g, c, x, 0);
  return slabs_to_bricks(g);
}
