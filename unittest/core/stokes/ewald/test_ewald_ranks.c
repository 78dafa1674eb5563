/* The engine ewald on several ranks: bricks and slabs of the grid, two levels, and what stops all. */
#include "on_ranks.h"

#include "periodic.h"

#include "sd_ewald_waves.h"

enum { N = 300, MOST_RANKS = RANKS_MOST };

/* FFTW's own, but on the rank that has no memory left */
static int no_memory;
void *fftw_malloc(size_t bytes);
void *fftw_alloc_complex(size_t numbers)
{
  return no_memory ? NULL : fftw_malloc(2 * sizeof(double) * numbers);
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
  sd_ewald_level second;
  sd_status expected; /* of place */
  int one_sided;
  int poor; /* this rank has no memory for a grid; 0: all have */
} cloud;

static cloud make(const layout *l)
{
  cloud c = {0};
  uint64_t seed = 12;
  sd_ewald_box box = {.periodic = l->periodic, .origin = {-2, 1, 3}, .edge = {15, 13, 14},
                      .tilt = {l->tilt, -l->tilt, 0.5 * l->tilt}};
  for (int i = 0; i < N; i++) {
    for (int d = 0; d < 3; d++) c.x[3 * i + d] = box.origin[d] + uniform(&seed, 0, 1) * box.edge[d];
    c.a[i] = i % 7 == 6 ? 0.0 : uniform(&seed, 0.5, 1.5); /* some take no part */
    if (l->wide) c.a[i] *= i % 80 == 20 ? 8.0 : 0.1; /* all see many images of the large */
    c.w[i] = uniform(&seed, 0.7, 1.3);
    for (int d = 0; d < l->width; d++) c.F[l->width * i + d] = uniform(&seed, -1, 1);
  }
  const sd_ewald_sizes sizes = periodic_sizes(c.a, N);
  assert_int_equal(sd_ewald_levels_choose(&box, &sizes, l->width, l->wide ? 1e-4 : 1e-6, &c.how, &c.second), SD_OK);
  assert_int_equal(c.second.from > 0.0, l->wide);
  return c;
}

/* Ours: by place along one direction, or dealt in turn, so that bricks of all ranks overlap everywhere. The last of 4
   ranks has none. */
static int owner(const cloud *c, const layout *l, int i, int ranks)
{
  const int parts = ranks == 4 ? 3 : ranks;
  if (l->scattered) return i % parts;
  const sd_ewald_box *b = &c->how.box;
  return (int) ((c->x[3 * i + l->cut] - b->origin[l->cut]) / b->edge[l->cut] * parts) % parts;
}

/* Of two that see each other across a border, is the second that above the first? It is there from a higher rank, or
   moved up by edges. */
static int above(const cloud *c, const periodic *p, int k, int me, int rank)
{
  for (int d = 2; d >= 0; d--) {
    const double moved = p->x[3 * k + d] - c->x[3 * p->owner[k] + d];
    if (fabs(moved) > 1e-9) return moved > 0.0;
  }
  return rank > me;
}

typedef struct {
  const cloud *c;
  const layout *l;
} task;

static void work(rank *r, const void *ctx)
{
  const cloud *c = ((const task *) ctx)->c;
  const layout *l = ((const task *) ctx)->l;
  no_memory = c->poor > 0 && r->me == c->poor;
  periodic p = {.n = N, .ewald = c->how};
  if (!l->periodic) p.ewald.reach = 0.0; /* no images are wanted */
  periodic_images(&p, c->x, c->a, c->w);
  const int total = l->periodic ? p.n_all : N;
  double *x = malloc(sizeof(double) * 3 * (size_t) total), *a = malloc(sizeof(double) * (size_t) total);
  double *w = malloc(sizeof(double) * (size_t) total), mine[6 * N], u[6 * N];
  r->number = malloc(sizeof(int) * (size_t) total);
  for (int pass = 0; pass < 2; pass++) {
    for (int k = 0; k < total; k++) {
      if ((k < N && owner(c, l, k, r->ranks) == r->me) != (pass == 0)) continue;
      if (pass == 1 && c->one_sided && !above(c, &p, k, r->me, owner(c, l, p.owner[k], r->ranks))) continue;
      for (int d = 0; d < 3; d++) x[3 * r->n_all + d] = p.x[3 * k + d];
      a[r->n_all] = p.a[k];
      w[r->n_all] = p.w[k];
      r->number[r->n_all++] = p.owner[k];
    }
    if (pass == 0) r->n = r->n_all;
  }
  for (int i = 0; i < r->n; i++)
    memcpy(mine + l->width * i, c->F + l->width * r->number[i], sizeof(double) * (size_t) l->width);
  const sd_mobility_scene scene = {.how = {.width = l->width, .ewald = &c->how, .second = &c->second}, .n = r->n,
                                   .n_all = r->n_all, .spheres = {x, a, w}, .one_sided = c->one_sided,
                                   .world = rank_world(r)};
  sd_mobility m = {0};
  for (int turn = 0; turn < 2; turn++) { /* the tables of the first time serve the second */
    if (sd_mobility_place(&m, periodic_engine(&c->second), &scene) != c->expected) r->all->failed = 1;
    if (c->expected == SD_OK && sd_mobility_apply(&m, mine, u) != SD_OK) r->all->failed = 1;
  }
  for (int i = 0; i < r->n && c->expected == SD_OK; i++)
    memcpy(r->all->u + l->width * r->number[i], u + l->width * i, sizeof(double) * (size_t) l->width);
  sd_mobility_free(&m);
  periodic_free(&p);
  free(x), free(a), free(w), free(r->number);
}

static shared *on(const cloud *c, const layout *l, int ranks)
{
  const task t = {c, l};
  return on_ranks(ranks, work, &t);
}

static void several_ranks_are_one(void **state)
{
  (void) state;
  const layout layouts[] = {{3, 1, 0, 0.0, 0, 0}, {6, 1, 1, 3.0, 0, 0}, {6, 0, 0, 0.0, 0, 0}, {3, 0, 1, 0.0, 0, 0},
                            {6, 1, 0, 0.0, 2, 0}, {6, 0, 0, 0.0, 1, 0}, {6, 0, 0, 0.0, 2, 0}, {3, 1, 0, 2.0, 1, 0},
                            {3, 1, 0, 3.0, 1, 1}, {6, 1, 1, 0.0, 0, 1}};
  /* of doubles, then of floats; with sanitizers every third, which have all that a layout may have */
  for (int k = 0; k < 20; k += CHECK_SIZE(1, 3)) {
    const layout *l = layouts + k % 10;
    cloud c = make(l);
    c.how.single = c.second.split.single = k >= 10;
    shared *one = on(&c, l, 1);
    double scale = 0.0;
    for (int i = 0; i < l->width * N; i++) scale = fmax(scale, fabs(one->u[i]));
    assert_true(scale > 0.0);
    for (int ranks = 1; ranks <= MOST_RANKS; ranks += CHECK_SIZE(1, 3)) {
      c.one_sided = !l->wide && (k + ranks) % 2;
      shared *many = on(&c, l, ranks);
      for (int i = 0; i < l->width * N; i++) {
        CHECK_NEAR(many->u[i], one->u[i], (k < 10 ? 1e-12 : 1e-6) * scale);
        if (c.a[i / l->width] == 0.0) CHECK_NEAR(many->u[i], 0.0, 0.0);
      }
      munmap(many, sizeof(shared));
    }
    munmap(one, sizeof(shared));
  }
}

/* Spheres that fill a little more than half a period: whichever comes first, the brick is no longer than they are. */
static void a_brick_is_as_long_as_its_spheres_stand(void **state)
{
  (void) state;
  const layout l = {3, 1, 0, 0.0, 0, 0};
  cloud c = make(&l);
  sd_ewald_waves w = {0};
  int up[N], down[N], brick[6], n = 0;
  double lowest = INFINITY, highest = -INFINITY;
  assert_int_equal(sd_ewald_waves_create(&w, &c.how, sd_ewald_kernels_for(&c.how), 3, &(sd_world){0}), SD_OK);
  const double h = c.how.box.edge[2] / c.how.grid[2];
  for (int i = 0; i < N; i++) {
    const double z = c.x[3 * i + 2] - c.how.box.origin[2];
    if (z > 0.6 * c.how.box.edge[2]) continue;
    lowest = fmin(lowest, z);
    highest = fmax(highest, z);
    up[n++] = i;
  }
  for (int k = 0; k < n; k++)
    for (int j = k; j > 0 && c.x[3 * up[j - 1] + 2] > c.x[3 * up[j] + 2]; j--) {
      const int other = up[j];
      up[j] = up[j - 1];
      up[j - 1] = other;
    }
  for (int k = 0; k < n; k++) down[n - 1 - k] = up[k];
  const double most = (highest - lowest) / h + 1.0 + c.how.points;
  const sd_spheres spheres = {c.x, c.a, c.w};
  for (int k = 0; k < 2; k++) {
    assert_int_equal(sd_ewald_waves_find(&w, &spheres, k ? down : up, n, brick), SD_OK);
    assert_true(brick[5] <= most);
  }
  sd_ewald_waves_free(&w);
}

/* One rank meets a place that is no number: all say so, none waits. */
static void a_place_that_is_no_number_stops_all_ranks(void **state)
{
  (void) state;
  const layout l = {3, 1, 0, 0.0, 0, 0};
  cloud c = make(&l);
  c.x[3 * 4 + 1] = NAN;
  c.expected = SD_ENOTFINITE;
  munmap(on(&c, &l, 3), sizeof(shared));
  const layout open = {3, 0, 0, 0.0, 0, 0}, wide = {6, 1, 0, 0.0, 0, 1};
  c = make(&open);
  c.x[3 * 4] = c.how.box.origin[0] + 1.001 * c.how.box.edge[0]; /* outside of an open box: the same */
  c.expected = SD_ENOTFINITE;
  munmap(on(&c, &open, 3), sizeof(shared));
  c = make(&wide);
  c.x[3 * 4 + 1] = NAN;
  c.expected = SD_ENOTFINITE;
  munmap(on(&c, &wide, 3), sizeof(shared));
}

static void a_grid_without_memory_stops_all_ranks(void **state)
{
  (void) state;
  const layout l = {3, 1, 0, 0.0, 0, 0};
  cloud c = make(&l);
  c.expected = SD_ENOMEMORY;
  c.poor = 1;
  munmap(on(&c, &l, 2), sizeof(shared));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(several_ranks_are_one),
      cmocka_unit_test(a_brick_is_as_long_as_its_spheres_stand),
      cmocka_unit_test(a_place_that_is_no_number_stops_all_ranks),
      cmocka_unit_test(a_grid_without_memory_stops_all_ranks),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
