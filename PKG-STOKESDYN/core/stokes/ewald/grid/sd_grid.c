#include "sd_grid.h"

#include <assert.h>
#include <fftw3.h>
#include <stdlib.h>
#include <string.h>

#include "sd_grid_internal.h"
#include "sd_real.h"
#include "sd_room.h"

/* --- memory --- */

int sd_grid_pairs(const sd_grid *g)
{
  return (sd_grid_own(g, SD_SHARED_LINES) + 1) / 2;
}

/* Complex numbers of a plane at work: points, their waves along z, and those of a turn */
static size_t plane_numbers(const sd_grid *g)
{
  const size_t pairs = (size_t) sd_grid_pairs(g), points = pairs * (size_t) g->size[2];
  const int longer = g->size[0] > g->size[1] ? g->size[0] : g->size[1];
  const size_t waves = 2 * pairs * (size_t) g->waves, turned = (size_t) longer * (size_t) sd_grid_own(g, SD_SHARED_Z);
  const size_t most = points > waves ? points : waves;
  return (most > turned ? most : turned) + 1;
}

static void *make_plane(const sd_grid *g)
{
  const size_t bytes = 2 * g->bytes * plane_numbers(g);
  return fftw_alloc_complex((bytes + sizeof(fftw_complex) - 1) / sizeof(fftw_complex));
}

static int gr_allocate(sd_grid *g)
{
  int ok = 1;
  for (int c = 0; c < 3; c++) {
    g->plane[c] = make_plane(g);
    ok = ok && g->plane[c];
  }
  g->slab = calloc((size_t) sd_grid_own(g, SD_SHARED_X) + 1, sizeof(void *));
  g->beside = make_plane(g);
  g->counts = calloc(6 * (size_t) g->ranks, sizeof(int));
  g->x_forth = calloc((size_t) sd_grid_own(g, SD_SHARED_Z) + 1, sizeof(void *));
  g->x_back = calloc((size_t) sd_grid_own(g, SD_SHARED_Z) + 1, sizeof(void *));
  return ok && g->slab && g->beside && g->counts && g->x_forth && g->x_back;
}

/* Who has which waves */
static int share_waves(sd_grid *g, const int *waves)
{
  const size_t lines = (size_t) g->size[1];
  for (int y = 0; y < g->size[1]; y++) g->waves = waves[y] > g->waves ? waves[y] : g->waves;
  g->columns = sd_grid_columns(g, 0);
  g->rows = g->ranks / g->columns;
  g->first_y = malloc(sizeof(int) * ((size_t) g->rows + 1));
  g->before = calloc(lines + 1, sizeof(long));
  if (!g->first_y || !g->before) return 0;
  sd_grid_share_waves(g, waves);
  for (int k = 0; k < 4; k++) sd_grid_range_of(g, k, g->me, g->own[k]);
  for (int y = 0; y < g->size[1]; y++) {
    const int *z = g->own[SD_SHARED_Z], end = waves[y] < z[1] ? waves[y] : z[1];
    g->before[y + 1] = g->before[y] + (end > z[0] ? end - z[0] : 0);
  }
  return 1;
}

sd_status sd_grid_create(sd_grid *g, const int *size, const int *occupied, const int *waves, size_t bytes,
                         const sd_world *world)
{
  sd_grid_free(g);
  g->bytes = bytes;
  g->fields = bytes == sizeof(float) ? &sd_grid_floats : &sd_grid_doubles;
  const sd_isa isa = sd_isa_of(SD_ISA_BEST);
  g->kernels =
      bytes == sizeof(float) ? SD_KERNELS_OF(sd_grid_single, plain, isa) : SD_KERNELS_OF(sd_grid, plain, isa);
  g->world = *world;
  g->ranks = world->exchange ? sd_world_ranks(world) : 1;
  g->me = g->ranks > 1 ? world->me : 0;
  for (int d = 0; d < 3; d++) {
    g->size[d] = size[d];
    g->occupied[d] = occupied[d];
  }
  if (share_waves(g, waves) && gr_allocate(g) && sd_grid_count_turns(g) && g->fields->plan(g)) return SD_OK;
  sd_grid_free(g);
  return SD_ENOMEMORY;
}

void sd_grid_free(sd_grid *g)
{
  if (g->fields) g->fields->forget(g);
  for (int c = 0; c < 3; c++) {
    fftw_free(g->plane[c]);
    fftw_free(g->raised[c]);
  }
  free(g->height);
  fftw_free(g->beside);
  free(g->x_forth);
  free(g->x_back);
  free(g->first_y);
  free(g->before);
  free(g->slab);
  free(g->spare);
  free(g->brick_memory);
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
    if (!g->raised[c]) g->raised[c] = make_plane(g);
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
  assert(g->bytes == sizeof(double));
  g->sweep = sweep;
  g->sweep_ctx = ctx;
  return three_more_planes(g);
}

/* --- bricks --- */

long sd_grid_slab_field(const sd_grid *g)
{
  const long numbers = (long) g->size[1] * sd_grid_own(g, SD_SHARED_Z);
  return g->bytes == sizeof(float) ? (numbers + 1) / 2 * 2 : numbers;
}

/* Where the planes of our slab will be */
static int place_slab(sd_grid *g)
{
  const int planes = sd_grid_own(g, SD_SHARED_X), x0 = g->own[SD_SHARED_X][0];
  const long numbers = 6 * sd_grid_slab_field(g);
  long missing = 0;
  for (int x = 0; x < planes; x++) g->slab[x] = NULL;
  for (int k = 0; k < g->ins && g->layer >= numbers; k++) {
    const sd_piece *p = g->in + k;
    for (int i = 0; i < p->n[0] && p->rank == g->me; i++)
      g->slab[p->to[0] + i - x0] = sd_at_number(g->brick, g->bytes, (p->at[0] + i) * g->layer);
  }
  for (int x = 0; x < planes; x++) missing += !g->slab[x];
  if (!sd_reserve(&g->spare, g->bytes, (size_t) (missing * numbers), &g->spare_room))
    return 0;
  for (int x = 0; x < planes; x++)
    if (!g->slab[x]) g->slab[x] = sd_at_number(g->spare, g->bytes, --missing * numbers);
  return 1;
}

size_t sd_grid_brick_numbers(const sd_grid *g)
{
  return (size_t) (g->layer * g->n[0]) + 64;
}

/* A core takes a load for one of what it has just stored if both addresses have the same last twelve bits, and
 * waits. So rows that one window touches in turn, of this layer and of the next one, must differ there by more
 * than their length: with rows of 2 kB spreading took three times as long. */
static int apart(long bytes, long row, long layer)
{
  enum { PAGE = 4096, NUMBERS = 24, ROWS = 5 };
  for (int p = 0; p < 2; p++)
    for (int q = p ? -ROWS : 1; q <= ROWS; q++) {
      const long off = labs(bytes * (p * layer + q * row)) % PAGE;
      if (off < NUMBERS * bytes || off > PAGE - NUMBERS * bytes) return 0;
    }
  return 1;
}

/* Numbers from row to row and from layer to layer of the brick. Vectors of the windows end beyond the last point. */
static void stride(sd_grid *g)
{
  enum { STEP = 8, TRIES = 16 };
  const long row = (3 * (long) g->n[2] + STEP - 1) / STEP * STEP + STEP, bytes = (long) g->bytes;
  for (int k = 0; k < TRIES * TRIES; k++) {
    g->row = row + k / TRIES * STEP;
    g->layer = g->row * g->n[1] + k % TRIES * STEP;
    if (apart(bytes, g->row, g->layer)) return;
  }
  g->row = row;
  g->layer = row * g->n[1];
}

sd_status sd_grid_place(sd_grid *g, const int *bricks)
{
  const int *own = bricks + 6 * g->me;
  for (int d = 0; d < 3; d++) {
    g->lo[d] = own[d];
    g->n[d] = own[3 + d];
  }
  stride(g);
  sd_grid_list_pieces(g, bricks, NULL, NULL, &g->outs, &g->ins);
  if (!sd_reserve(&g->out, sizeof(sd_piece), (size_t) g->outs, &g->out_room) ||
      !sd_reserve(&g->in, sizeof(sd_piece), (size_t) g->ins, &g->in_room))
    return SD_ENOMEMORY;
  sd_grid_list_pieces(g, bricks, g->out, g->in, &g->outs, &g->ins);
  if (!sd_grid_count_pieces(g, g->out, g->outs, PIECES_TO) || !sd_grid_count_pieces(g, g->in, g->ins, PIECES_FROM))
    return SD_ENOMEMORY;
  const size_t doubles = sd_grid_largest_message(g);
  const size_t in_brick = sd_grid_brick_numbers(g) * g->bytes / sizeof(double) + 1;
  g->brick = sd_reserve_lines(&g->brick_memory, in_brick, &g->brick_room);
  if (!g->brick) return SD_ENOMEMORY;
  for (int k = 0; k < 2; k++)
    if (!sd_reserve(g->message + k, sizeof(double), doubles, g->message_room + k))
      return SD_ENOMEMORY;
  return place_slab(g) ? SD_OK : SD_ENOMEMORY;
}

/* --- the product --- */

sd_status sd_grid_convolve(sd_grid *g, sd_grid_multiply *multiply, void *ctx)
{
  return g->fields->convolve(g, multiply, ctx);
}

sd_status sd_grid_convolve_values(sd_grid *g, sd_grid_fill *fill, void *fill_ctx,
                                  sd_grid_multiply *multiply, void *ctx)
{
  assert(g->bytes == sizeof(double));
  return g->fields->convolve_values(g, fill, fill_ctx, multiply, ctx);
}
