/* The grid on emulated ranks, which are threads: whatever pencils they share, what comes out is what one rank has. */
#define _GNU_SOURCE
#include "check.h"

#include "sd_grid.h"
#include "sd_real.h"

#include <pthread.h>
#include <string.h>

enum { MOST_RANKS = 16, MOST_LINES = 12 };

typedef struct {
  pthread_barrier_t barrier;
  const double *send[MOST_RANKS];
  const int *to[MOST_RANKS];
  int ranks, failed;
} post;

typedef struct {
  post *all;
  int me, exchanges, waves;
  sd_grid grid;
  pthread_t thread;
} rank;

/* Checks that both ends agree, and that nobody writes to himself or, in a turn, to more than his row or column. */
static sd_status exchange(void *ctx, const double *send, const int *to, double *receive, const int *from)
{
  rank *r = ctx;
  post *all = r->all;
  int partners = 0;
  all->send[r->me] = send;
  all->to[r->me] = to;
  pthread_barrier_wait(&all->barrier);
  for (int p = 0; p < all->ranks; p++) {
    const double *at = all->send[p];
    for (int q = 0; q < r->me; q++) at += all->to[p][q];
    if (all->to[p][r->me] != from[p] || (p == r->me && from[p])) all->failed = 1;
    memcpy(receive, at, sizeof(double) * (size_t) from[p]);
    receive += from[p];
    partners += to[p] > 0;
  }
  const int last = r->grid.columns > 1 ? 5 : 3, turn = r->exchanges > 0 && r->exchanges < last;
  const int most = r->grid.rows > r->grid.columns ? r->grid.rows : r->grid.columns;
  if (turn && partners >= most && all->ranks > 1) all->failed = 1;
  r->exchanges++;
  pthread_barrier_wait(&all->barrier);
  return SD_OK;
}

/* Waves that are left at y, of so many: fewer for larger wave numbers, down to none */
static int left_at(int y, int size, int waves)
{
  const int m = y < size - y ? y : size - y, left = waves - 2 * m * m / size;
  return left > 0 ? left : 0;
}

/* Any function of the wave vector that couples the fields and leaves some of them */
static void multiply(void *ctx, int y, int depth, void *const *plane)
{
  const rank *r = ctx;
  const sd_grid *g = &r->grid;
  const int z = g->own[SD_SHARED_Z][0], end = left_at(y, g->size[1], r->waves);
  long k = 0;
  for (int x = 0; x < g->size[0]; x++)
    for (int w = z; w < z + depth; w++)
      for (int part = 0; part < 2; part++, k++) {
        double v[3];
        for (int c = 0; c < 3; c++) v[c] = sd_number(plane[c], g->bytes, k);
        const double a = 1.0 / (1.0 + x + 2 * y + 3 * w), left = w < end;
        sd_put_number(plane[0], g->bytes, k, left * (a * v[0] + 0.1 * v[1]));
        sd_put_number(plane[1], g->bytes, k, left * (a * v[1] - 0.2 * v[2]));
        sd_put_number(plane[2], g->bytes, k, left * (a * v[2] + 0.3 * v[0]));
      }
}

static void *convolve(void *ctx)
{
  rank *r = ctx;
  if (sd_grid_convolve(&r->grid, multiply, r) != SD_OK) r->all->failed = 1;
  return NULL;
}

typedef struct {
  int size[3], occupied[3], periodic, waves;
} layout;

/* Where the brick of a rank is: anywhere, of any size, over the faces of a periodic box; some have none. */
static void brick_of(const layout *l, int ranks, int *bricks)
{
  uint64_t seed = 3;
  for (int r = 0; r < ranks; r++)
    for (int d = 0; d < 3; d++) {
      int *lo = bricks + 6 * r + d, *n = lo + 3;
      *n = 1 + (int) uniform(&seed, 0, (l->periodic ? 1.3 : 0.7) * l->occupied[d]);
      *lo = l->periodic ? (int) uniform(&seed, -1.5 * l->size[d], l->size[d])
                        : (int) uniform(&seed, 0, l->occupied[d] - *n + 1);
      if (r == 0) *lo = 0, *n = l->occupied[d]; /* the first has all */
      if (r % 5 == 4) *n = 0;
    }
}

static double force(int r, int i, int j, int k, int c)
{
  return sin(1.0 + 3 * r + 5 * i + 7 * j + 11 * k + 13 * c);
}

static int wrapped(int i, int period)
{
  return ((i % period) + period) % period;
}

#define EACH_POINT(g)                        \
  for (int i = 0; i < (g)->n[0]; i++)        \
    for (int j = 0; j < (g)->n[1]; j++)      \
      for (int k = 0; k < (g)->n[2]; k++)    \
        for (int c = 0; c < 3; c++)

static long number_at(const sd_grid *g, int i, int j, int k, int c)
{
  return i * g->layer + j * g->row + 3L * k + c;
}

static void add_to(const sd_grid *g, int i, int j, int k, int c, double f)
{
  const long at = number_at(g, i, j, k, c);
  sd_put_number(g->brick, g->bytes, at, sd_number(g->brick, g->bytes, at) + f);
}

/* Sums of all bricks on `ranks`, of which one knows nothing of waves that are not left, and all through the grid:
 * velocities of rank 0, whose brick is the whole box, by point */
static void run(const layout *l, size_t bytes, int ranks, const int *bricks, int of, double *whole, double largest)
{
  const double bound = bytes == sizeof(float) ? 1e-6 : 1e-12;
  post all = {.ranks = ranks};
  rank r[MOST_RANKS] = {{0}};
  pthread_barrier_init(&all.barrier, NULL, (unsigned) ranks);
  for (int p = 0; p < ranks; p++) {
    r[p].all = &all;
    r[p].me = p;
    r[p].waves = l->waves;
    const sd_world world = {.ctx = r + p, .me = p, .ranks = ranks, .exchange = exchange};
    sd_grid *g = &r[p].grid;
    int waves[MOST_LINES];
    for (int y = 0; y < l->size[1]; y++) waves[y] = ranks > 1 ? left_at(y, l->size[1], l->waves) : l->size[2] / 2 + 1;
    assert_int_equal(sd_grid_create(g, l->size, l->occupied, waves, bytes, &world), SD_OK);
    assert_int_equal(sd_grid_place(g, bricks), SD_OK);
    memset(g->brick, 0, bytes * sd_grid_brick_numbers(g));
    EACH_POINT(g) add_to(g, i, j, k, c, force(p, i, j, k, c));
    /* one rank stands for all: their bricks added to its own */
    for (int q = ranks; q < of; q++) {
      const int *lo = bricks + 6 * q, *n = lo + 3;
      for (int i = 0; i < n[0]; i++)
        for (int j = 0; j < n[1]; j++)
          for (int k = 0; k < n[2]; k++)
            for (int c = 0; c < 3; c++)
              add_to(g, wrapped(lo[0] + i, l->size[0]), wrapped(lo[1] + j, l->size[1]), wrapped(lo[2] + k, l->size[2]),
                     c, force(q, i, j, k, c));
    }
  }
  for (int p = 0; p < ranks; p++) pthread_create(&r[p].thread, NULL, convolve, r + p);
  for (int p = 0; p < ranks; p++) pthread_join(r[p].thread, NULL);
  assert_int_equal(all.failed, 0);
  for (int p = 0; p < ranks; p++) {
    sd_grid *g = &r[p].grid;
    EACH_POINT(g) {
      const long point = ((long) wrapped(g->lo[0] + i, l->size[0]) * l->size[1] + wrapped(g->lo[1] + j, l->size[1])) *
          l->size[2] +
          wrapped(g->lo[2] + k, l->size[2]);
      const double u = sd_number(g->brick, bytes, number_at(g, i, j, k, c));
      if (largest == 0.0) whole[3 * point + c] = u;
      else CHECK_NEAR(u, whole[3 * point + c], bound * largest);
    }
    sd_grid_free(g);
  }
  pthread_barrier_destroy(&all.barrier);
}

static void any_number_of_ranks_is_one(void **state)
{
  (void) state;
  const layout layouts[] = {{{6, 10, 8}, {6, 10, 8}, 1, 5}, {{24, 5, 9}, {24, 5, 9}, 1, 4},
                            {{8, 12, 10}, {4, 6, 5}, 0, 6}, {{3, 4, 30}, {3, 4, 30}, 1, 16},
                            {{10, 9, 16}, {10, 9, 16}, 1, 6}};
  for (int k = 0; k < 5; k++) {
    const layout *l = layouts + k;
    double *whole = malloc(sizeof(double) * 3 * (size_t) (l->size[0] * l->size[1] * l->size[2]));
    for (int ranks = 2; ranks <= MOST_RANKS; ranks++) {
      int bricks[6 * MOST_RANKS];
      brick_of(l, ranks, bricks);
      run(l, sizeof(double), 1, bricks, ranks, whole, 0.0);
      double largest = 0.0;
      for (int c = 0; c < 3; c++) largest = fmax(largest, fabs(whole[c]));
      assert_true(largest > 0.0);
      run(l, sizeof(double), ranks, bricks, ranks, whole, 10.0 * largest);
      run(l, sizeof(float), ranks, bricks, ranks, whole, 10.0 * largest);
    }
    free(whole);
  }
}

/* Slabs while ranks are few; columns where there are more ranks than planes, so that nearly all have a part */
static void ranks_are_not_limited_by_planes(void **state)
{
  (void) state;
  const int size[3] = {12, 12, 12}, waves[12] = {7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7};
  for (int ranks = 1; ranks <= 60; ranks++) {
    sd_grid g = {0};
    int busy = 0, columns = 0;
    for (int me = 0; me < ranks; me++) {
      const sd_world world = {.me = me, .ranks = ranks, .exchange = exchange};
      assert_int_equal(sd_grid_create(&g, size, size, waves, sizeof(double), &world), SD_OK);
      busy += g.own[SD_SHARED_X][1] > g.own[SD_SHARED_X][0] && g.own[SD_SHARED_LINES][1] > g.own[SD_SHARED_LINES][0];
      columns = g.columns;
      sd_grid_free(&g);
    }
    if (ranks <= 4) assert_int_equal(columns, 1);
    if (ranks >= 18) assert_true(columns > 1 && busy >= 18);
  }
}

/* Fewer waves are left where y is large: who has those y has more of them. */
static void rows_share_the_waves_that_are_left(void **state)
{
  (void) state;
  enum { SIZE = 32, MOST = 16 };
  const int size[3] = {SIZE, SIZE, SIZE};
  int waves[SIZE];
  double all = 0.0;
  for (int y = 0; y < SIZE; y++) all += waves[y] = left_at(y, SIZE, MOST);
  for (int ranks = 2; ranks <= 6; ranks++) {
    sd_grid g = {0};
    double shared = 0.0;
    for (int me = 0; me < ranks; me++) {
      const sd_world world = {.me = me, .ranks = ranks, .exchange = exchange};
      assert_int_equal(sd_grid_create(&g, size, size, waves, sizeof(double), &world), SD_OK);
      assert_int_equal(g.columns, 1);
      const int *y = g.own[SD_SHARED_Y];
      const double ours = (double) (g.before[y[1]] - g.before[y[0]]);
      CHECK_NEAR(ours, all / ranks, MOST);
      shared += ours;
      sd_grid_free(&g);
    }
    assert_true(shared == all);
  }
}

/* Two ranks and 1600^3 points: 6e9 numbers go from each to each. The same of a brick, of which 2.2e9 come. */
static void more_numbers_than_an_int_counts_are_no_memory(void **state)
{
  (void) state;
  const int large[3] = {1600, 1600, 1600}, small[3] = {8, 8, 8};
  const sd_world world = {.ranks = 2, .exchange = exchange};
  sd_grid g = {0};
  int waves[1600];
  for (int y = 0; y < 1600; y++) waves[y] = 801;
  assert_int_equal(sd_grid_create(&g, large, large, waves, sizeof(double), &world), SD_ENOMEMORY);
  for (int y = 0; y < 8; y++) waves[y] = 5;
  assert_int_equal(sd_grid_create(&g, small, small, waves, sizeof(double), &world), SD_OK);
  const int many = 2400 * 1200, bricks[12] = {0, 0, 0, 1, 1, 1, 0, 0, 0, 8, 8, many * 8};
  g.size[2] = g.occupied[2] = many * 8; /* as if its rows were so long */
  assert_int_equal(sd_grid_place(&g, bricks), SD_ENOMEMORY);
  sd_grid_free(&g);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(any_number_of_ranks_is_one),
      cmocka_unit_test(ranks_are_not_limited_by_planes),
      cmocka_unit_test(rows_share_the_waves_that_are_left),
      cmocka_unit_test(more_numbers_than_an_int_counts_are_no_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
