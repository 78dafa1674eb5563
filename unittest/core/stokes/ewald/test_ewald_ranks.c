/* The engine ewald on several ranks: processes that exchange through shared memory what MPI would carry. */
#define _GNU_SOURCE
#include "periodic.h"

#include <pthread.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

enum { N = 300, MOST_RANKS = 4, MESSAGE = 400000 };

/* FFTW's own, but on the rank that has no memory left */
static int no_memory;
void *fftw_malloc(size_t bytes);
void *fftw_alloc_complex(size_t numbers)
{
  return no_memory ? NULL : fftw_malloc(2 * sizeof(double) * numbers);
}

/* What all processes see */
typedef struct {
  pthread_barrier_t barrier;
  double F[6 * N], u[6 * N], sum[MOST_RANKS][128], message[MOST_RANKS][MESSAGE];
  int count[MOST_RANKS][MOST_RANKS], failed;
} shared;

/* A rank: its own spheres first, then ghosts of the others and images, each with the number of its sphere. */
typedef struct {
  shared *all;
  int me, ranks, n, n_all;
  int *number;
} rank;

static void meet(const rank *r)
{
  pthread_barrier_wait(&r->all->barrier);
}

static sd_status refresh(void *ctx, const double *rows, double *ghosts, int width)
{
  rank *r = ctx;
  for (int i = 0; i < r->n; i++)
    memcpy(r->all->F + width * r->number[i], rows + width * i, sizeof(double) * (size_t) width);
  meet(r);
  for (int i = r->n; i < r->n_all; i++)
    memcpy(ghosts + width * (i - r->n), r->all->F + width * r->number[i], sizeof(double) * (size_t) width);
  meet(r);
  return SD_OK;
}

static sd_status sum(void *ctx, double *values, int count)
{
  rank *r = ctx;
  memcpy(r->all->sum[r->me], values, sizeof(double) * (size_t) count);
  r->all->count[r->me][0] = count;
  meet(r);
  if (count != r->all->count[0][0]) r->all->failed = 1;
  for (int k = 0; k < count; k++) {
    values[k] = 0.0;
    for (int p = 0; p < r->ranks; p++) values[k] += r->all->sum[p][k];
  }
  meet(r);
  return SD_OK;
}

static sd_status exchange(void *ctx, const double *send, const int *to, double *receive, const int *from)
{
  rank *r = ctx;
  size_t many = 0;
  for (int p = 0; p < r->ranks; p++) many += (size_t) to[p];
  if (many > MESSAGE) r->all->failed = 1;
  else memcpy(r->all->message[r->me], send, sizeof(double) * many);
  memcpy(r->all->count[r->me], to, sizeof(int) * (size_t) r->ranks);
  meet(r);
  for (int p = 0; p < r->ranks; p++) {
    size_t before = 0;
    for (int q = 0; q < r->me; q++) before += (size_t) r->all->count[p][q];
    if (r->all->count[p][r->me] != from[p] || (p == r->me && from[p] != 0)) r->all->failed = 1;
    memcpy(receive, r->all->message[p] + before, sizeof(double) * (size_t) from[p]);
    receive += from[p];
  }
  meet(r);
  return SD_OK;
}

typedef struct {
  int width, periodic, scattered;
  double tilt;
  int cut; /* direction along which ranks are cut */
  int wide; /* some are so large that there are two levels */
} layout;

typedef struct {
  double x[3 * N], a[N], w[N], F[6 * N];
  sd_ewald how;
  sd_status expected; /* of place */
  int poor; /* this rank has no memory for a grid; 0: all have */
} cloud;

static cloud make(const layout *l)
{
  cloud c = {0};
  uint64_t seed = 12;
  sd_ewald_box box = {.periodic = l->periodic, .origin = {-2, 1, 3}, .edge = {15, 13, 14}, .tilt = {l->tilt, -l->tilt, 0.5 * l->tilt}};
  for (int i = 0; i < N; i++) {
    for (int d = 0; d < 3; d++) c.x[3 * i + d] = box.origin[d] + uniform(&seed, 0, 1) * box.edge[d];
    c.a[i] = i % 7 == 6 ? 0.0 : uniform(&seed, 0.5, 1.5); /* some take no part */
    if (l->wide) c.a[i] *= i % 80 == 20 ? 8.0 : 0.1; /* all see many images of the large */
    c.w[i] = uniform(&seed, 0.7, 1.3);
    for (int d = 0; d < l->width; d++) c.F[l->width * i + d] = uniform(&seed, -1, 1);
  }
  c.how = periodic_choose(&box, c.a, N, l->width, l->wide ? 1e-4 : 1e-6);
  assert_int_equal(c.how.large.from > 0.0, l->wide);
  return c;
}

/* Ours: by place along one direction, or dealt in turn, so that bricks of all ranks overlap everywhere. The last of 4 ranks has none. */
static int owner(const cloud *c, const layout *l, int i, int ranks)
{
  const int parts = ranks == 4 ? 3 : ranks;
  if (l->scattered) return i % parts;
  const sd_ewald_box *b = &c->how.box;
  return (int) ((c->x[3 * i + l->cut] - b->origin[l->cut]) / b->edge[l->cut] * parts) % parts;
}

static void work(const cloud *c, const layout *l, shared *all, int me, int ranks)
{
  periodic p = {.n = N, .ewald = c->how};
  if (!l->periodic) p.ewald.reach = 0.0; /* no images are wanted */
  periodic_images(&p, c->x, c->a, c->w);
  const int total = l->periodic ? p.n_all : N;
  double *x = malloc(sizeof(double) * 3 * (size_t) total), *a = malloc(sizeof(double) * (size_t) total);
  double *w = malloc(sizeof(double) * (size_t) total), mine[6 * N], u[6 * N];
  rank r = {.all = all, .me = me, .ranks = ranks, .number = malloc(sizeof(int) * (size_t) total)};
  for (int pass = 0; pass < 2; pass++) {
    for (int k = 0; k < total; k++) {
      if ((k < N && owner(c, l, k, ranks) == me) != (pass == 0)) continue;
      for (int d = 0; d < 3; d++) x[3 * r.n_all + d] = p.x[3 * k + d];
      a[r.n_all] = p.a[k];
      w[r.n_all] = p.w[k];
      r.number[r.n_all++] = p.owner[k];
    }
    if (pass == 0) r.n = r.n_all;
  }
  for (int i = 0; i < r.n; i++)
    memcpy(mine + l->width * i, c->F + l->width * r.number[i], sizeof(double) * (size_t) l->width);
  const sd_mobility_scene scene = {
      .how = {.width = l->width, .ewald = &c->how}, .n = r.n, .n_all = r.n_all, .spheres = {x, a, w},
      .world = {.ctx = &r, .me = me, .ranks = ranks, .refresh = refresh, .sum = sum, .exchange = exchange}};
  sd_mobility m = {0};
  for (int turn = 0; turn < 2; turn++) { /* the tables of the first time serve the second */
    if (sd_mobility_place(&m, &sd_mobility_ewald, &scene) != c->expected) all->failed = 1;
    if (c->expected == SD_OK && sd_mobility_apply(&m, mine, u) != SD_OK) all->failed = 1;
  }
  for (int i = 0; i < r.n && c->expected == SD_OK; i++)
    memcpy(all->u + l->width * r.number[i], u + l->width * i, sizeof(double) * (size_t) l->width);
  sd_mobility_free(&m);
  periodic_free(&p);
  free(x), free(a), free(w), free(r.number);
}

static shared *on_ranks(const cloud *c, const layout *l, int ranks)
{
  shared *all = mmap(NULL, sizeof(shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  pthread_barrierattr_t attribute;
  pthread_barrierattr_init(&attribute);
  pthread_barrierattr_setpshared(&attribute, PTHREAD_PROCESS_SHARED);
  pthread_barrier_init(&all->barrier, &attribute, (unsigned) ranks);
  pid_t child[MOST_RANKS];
  for (int r = 0; r < ranks; r++) {
    child[r] = fork();
    if (child[r] == 0) {
      alarm(60); /* a rank that waits for one that has died */
      no_memory = c->poor > 0 && r == c->poor;
      work(c, l, all, r, ranks);
      _exit(0);
    }
  }
  for (int r = 0; r < ranks; r++) {
    int status;
    waitpid(child[r], &status, 0);
    assert_int_equal(status, 0);
  }
  assert_int_equal(all->failed, 0);
  return all;
}

static void several_ranks_are_one(void **state)
{
  (void) state;
  const layout layouts[] = {{3, 1, 0, 0.0, 0, 0}, {6, 1, 1, 3.0, 0, 0}, {6, 0, 0, 0.0, 0, 0}, {3, 0, 1, 0.0, 0, 0},
                            {6, 1, 0, 0.0, 2, 0}, {6, 0, 0, 0.0, 1, 0}, {6, 0, 0, 0.0, 2, 0}, {3, 1, 0, 2.0, 1, 0},
                            {3, 1, 0, 3.0, 1, 1}, {6, 1, 1, 0.0, 0, 1}};
  for (int k = 0; k < 10; k++) {
    const layout *l = layouts + k;
    const cloud c = make(l);
    shared *one = on_ranks(&c, l, 1);
    double scale = 0.0;
    for (int i = 0; i < l->width * N; i++) scale = fmax(scale, fabs(one->u[i]));
    assert_true(scale > 0.0);
    for (int ranks = 2; ranks <= MOST_RANKS; ranks++) {
      shared *many = on_ranks(&c, l, ranks);
      for (int i = 0; i < l->width * N; i++) {
        CHECK_NEAR(many->u[i], one->u[i], 1e-12 * scale);
        if (c.a[i / l->width] == 0.0) CHECK_NEAR(many->u[i], 0.0, 0.0);
      }
      munmap(many, sizeof(shared));
    }
    munmap(one, sizeof(shared));
  }
}

/* One rank meets a place that is no number: all say so, none waits. */
static void a_place_that_is_no_number_stops_all_ranks(void **state)
{
  (void) state;
  const layout l = {3, 1, 0, 0.0, 0, 0};
  cloud c = make(&l);
  c.x[3 * 4 + 1] = NAN;
  c.expected = SD_ENOTFINITE;
  munmap(on_ranks(&c, &l, 3), sizeof(shared));
  const layout open = {3, 0, 0, 0.0, 0, 0}, wide = {6, 1, 0, 0.0, 0, 1};
  c = make(&open);
  c.x[3 * 4] = c.how.box.origin[0] + 1.001 * c.how.box.edge[0]; /* outside of an open box: the same */
  c.expected = SD_ENOTFINITE;
  munmap(on_ranks(&c, &open, 3), sizeof(shared));
  c = make(&wide);
  c.x[3 * 4 + 1] = NAN;
  c.expected = SD_ENOTFINITE;
  munmap(on_ranks(&c, &wide, 3), sizeof(shared));
}

static void a_grid_without_memory_stops_all_ranks(void **state)
{
  (void) state;
  const layout l = {3, 1, 0, 0.0, 0, 0};
  cloud c = make(&l);
  c.expected = SD_ENOMEMORY;
  c.poor = 1;
  munmap(on_ranks(&c, &l, 2), sizeof(shared));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(several_ranks_are_one),
      cmocka_unit_test(a_place_that_is_no_number_stops_all_ranks),
      cmocka_unit_test(a_grid_without_memory_stops_all_ranks),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
