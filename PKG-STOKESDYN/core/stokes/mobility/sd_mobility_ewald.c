/* Ewald sums: a near part by pairs, a wave part by FFT, and what both leave out. With two levels
 * (sd_ewald.h) each has a wave part; the first is of the small spheres alone. */
#include "sd_mobility.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_ewald_image_pairs.h"
#include "sd_ewald_large_pairs.h"
#include "sd_ewald_pairs.h"
#include "sd_ewald_waves.h"
#include "sd_room.h"

typedef struct {
  /* what the tables are made for */
  sd_ewald ewald;
  int width, ready;
  sd_world world;
  int levels;
  sd_ewald_waves waves[2];
  sd_ewald_pairs pairs;
  sd_ewald_large_pairs large_pairs;
  sd_ewald_image_pairs image_pairs;
  double tail[2][3];
  /* this rank's spheres with radius: [small] in order of the near part's targets, then those of the
   * second level */
  int *sphere, small, own;
  size_t sphere_room;
  /* [n_all] two levels: radii, 0 of the large ones */
  double *small_a;
  size_t small_room;
  /* [3 n_all] wall: centres at heights of at least the radii */
  double *stand;
  size_t stand_room;
  /* this rank's spheres, with ghosts */
  int n, n_all;
  double *ghosts;
  size_t ghost_room;
  sd_spheres spheres;
} ewald;

/* --- tables of a splitting --- */

static sd_status make_tables(ewald *e, const sd_mobility_scene *s)
{
  const sd_ewald *how = s->how.ewald;
  e->ready = 0;
  e->ewald = *how;
  e->width = s->how.width;
  if (!(how->count > 0.0)) {
    e->ready = 1;
    return SD_OK;
  }
  const struct sd_ewald_kernels *kernels =
      SD_KERNELS_OF(sd_ewald, plain, sd_isa_of(SD_ISA_BEST));
  const sd_ewald level[2] = {*how, sd_ewald_of_large(how)};
  e->levels = how->large.from > 0.0 ? 2 : 1;
  sd_ewald_pairs_create(&e->pairs, how, kernels, e->width);
  if (e->levels == 2) sd_ewald_large_pairs_create(&e->large_pairs, how, e->width);
  sd_status status = SD_OK;
  for (int l = 0; l < e->levels && status == SD_OK; l++) {
    sd_radial_tail(level + l, e->tail[l]);
    status = sd_ewald_waves_create(e->waves + l, level + l, kernels, e->width, &s->world);
  }
  e->ready = status == SD_OK;
  return status;
}

/* Is there a splitting for which the tables are not? */
static int changed(const ewald *e, const sd_mobility_scene *s)
{
  return !e->ready || e->width != s->how.width || !sd_ewald_same_tables(&e->ewald, s->how.ewald);
}

/* --- where the spheres stand --- */

static int make_room(ewald *e, int n, size_t ghost_numbers)
{
  return sd_reserve(&e->sphere, sizeof(int), (size_t) n, &e->sphere_room) &&
      sd_reserve(&e->ghosts, sizeof(double), ghost_numbers, &e->ghost_room);
}

/* Without the large spheres, of which the first level knows nothing */
static int hide_large(ewald *e, const sd_mobility_scene *s, sd_spheres *small)
{
  *small = e->spheres;
  if (e->levels == 1) return 1;
  if (!sd_reserve(&e->small_a, sizeof(double), (size_t) s->n_all, &e->small_room)) return 0;
  for (int i = 0; i < s->n_all; i++)
    e->small_a[i] = s->spheres.a[i] < e->ewald.large.from ? s->spheres.a[i] : 0.0;
  small->a = e->small_a;
  return 1;
}

/* Above a wall the whole matrix is made with heights of at least the radii (sd_wall.h). */
static int keep_off_wall(ewald *e, const sd_mobility_scene *s)
{
  const sd_wall *wall = &e->ewald.images.wall;
  e->spheres = s->spheres;
  if (!wall->sign) return 1;
  if (!sd_reserve(&e->stand, 3 * sizeof(double), (size_t) s->n_all, &e->stand_room)) return 0;
  for (long i = 0; i < s->n_all; i++)
    sd_wall_keep_off(wall, s->spheres.x + 3 * i, s->spheres.a[i], e->stand + 3 * i);
  e->spheres.x = e->stand;
  return 1;
}

static void list_spheres(ewald *e)
{
  e->own = e->small = e->pairs.n;
  for (int i = 0; i < e->pairs.n; i++) e->sphere[i] = e->pairs.sphere[e->pairs.target[i]];
  for (int i = 0; i < e->n && e->levels == 2; i++)
    if (e->spheres.a[i] >= e->ewald.large.from) e->sphere[e->own++] = i;
}

/* All bricks, by a sum over the ranks, which also carries who has failed: then all fail. Of all ranks
 * of the world, also where this one has no grid. brick [levels][6] */
static sd_status share_bricks(ewald *e, const int *brick, sd_status status)
{
  const int ranks = sd_world_ranks(&e->world), me = sd_world_me(&e->world), levels = e->levels;
  const int failed = 6 * ranks * levels, many = failed + 2;
  double *values = calloc((size_t) many, sizeof(double));
  int *bricks = calloc((size_t) many, sizeof(int));
  if (!values || !bricks) status = SD_ENOMEMORY;
  for (int l = 0; l < levels && values && status == SD_OK; l++)
    for (int k = 0; k < 6; k++) values[6 * (l * ranks + me) + k] = brick[6 * l + k];
  if (values) {
    values[failed] = status == SD_ENOMEMORY;
    values[failed + 1] = status != SD_OK && status != SD_ENOMEMORY;
  }
  if (values && e->world.sum) {
    const sd_status said = e->world.sum(e->world.ctx, values, many);
    if (status == SD_OK) status = said;
  }
  if (status == SD_OK && values[failed + 1] > 0.0) status = SD_ENOTFINITE;
  if (status == SD_OK && values[failed] > 0.0) status = SD_ENOMEMORY;
  for (int k = 0; k < failed && status == SD_OK; k++) bricks[k] = (int) lrint(values[k]);
  for (int l = 0; l < levels && status == SD_OK; l++)
    status = sd_ewald_waves_place(e->waves + l, bricks + 6 * ranks * l);
  free(values);
  free(bricks);
  return status;
}

static int all_finite(const sd_mobility_scene *s)
{
  for (int i = 0; i < s->n_all; i++)
    for (int d = 0; d < 3; d++)
      if (s->spheres.a[i] > 0.0 && !(fabs(s->spheres.x[3 * (long) i + d]) < INFINITY)) return 0;
  return 1;
}

static sd_status place(void *state, const sd_mobility_scene *s)
{
  ewald *e = state;
  e->n = s->n;
  e->n_all = s->n_all;
  sd_status status = SD_OK;
  if (changed(e, s)) status = make_tables(e, s);
  e->world = s->world;
  e->ewald.box = s->how.ewald->box;
  for (int l = 0; l < 2; l++) {
    e->waves[l].grid.world = s->world;
    sd_ewald_waves_stand(e->waves + l, &e->ewald.box);
  }
  if (!(e->ewald.count > 0.0)) return status;
  int brick[12] = {0};
  sd_spheres small;
  if (status == SD_OK && !all_finite(s)) status = SD_ENOTFINITE;
  if (status == SD_OK && (!keep_off_wall(e, s) || !hide_large(e, s, &small)))
    status = SD_ENOMEMORY;
  if (status == SD_OK) status = sd_ewald_pairs_place(&e->pairs, &small, s->n, s->n_all);
  if (status == SD_OK && e->ewald.images.wall.sign)
    status = sd_ewald_image_pairs_place(&e->image_pairs, &e->ewald, &e->spheres, s->n, s->n_all);
  if (status == SD_OK && !make_room(e, s->n, (size_t) e->width * (size_t) (s->n_all - s->n)))
    status = SD_ENOMEMORY;
  if (status == SD_OK) list_spheres(e);
  for (int l = 0; l < e->levels && status == SD_OK; l++)
    status = sd_ewald_waves_find(e->waves + l, &e->spheres, e->sphere, l == 0 ? e->small : e->own,
                                 brick + 6 * l);
  if (e->levels == 2) { /* on all ranks, also where something has failed */
    const sd_status large = sd_ewald_large_pairs_place(&e->large_pairs, &e->spheres, e->sphere,
                                                       status == SD_OK ? e->own : 0, &e->world);
    if (status == SD_OK) status = large;
  }
  return share_bricks(e, brick, status);
}

/* --- product --- */

/* Sums over all spheres of w F, b w F and w T: what is far is felt as a mean. Those of the second
 * level apart: sums [2][9]. */
static sd_status sums_of(const ewald *e, const double *F, double *sums)
{
  const long m = e->width;
  memset(sums, 0, 18 * sizeof(double));
  for (int i = 0; i < e->own; i++) {
    const long j = e->sphere[i];
    const double w = e->spheres.w[j], b = sd_ewald_b(&e->ewald, e->spheres.a[j]);
    double *s = sums + (i < e->small ? 0 : 9);
    for (int d = 0; d < 3; d++) {
      s[d] += w * F[m * j + d];
      s[3 + d] += w * b * F[m * j + d];
      if (m == 6) s[6 + d] += w * F[m * j + 3 + d];
    }
  }
  return e->world.sum ? e->world.sum(e->world.ctx, sums, 9 * e->levels) : SD_OK;
}

/* u += w rows */
static void add_waves(const ewald *e, int level, const double *rows, double *u)
{
  const long m = e->width;
  const sd_ewald_waves *waves = e->waves + level;
  for (int i = 0; i < waves->n; i++) {
    const long j = e->sphere[i];
    for (int d = 0; d < m; d++) u[m * j + d] += e->spheres.w[j] * rows[m * i + d];
  }
}

/* u += w (mean of what is beyond the range). Two small spheres have the range of the first level, any
 * others that of the second. */
static void add_means(const ewald *e, const double *sums, double *u)
{
  const long m = e->width;
  const double over_V = 1.0 / sd_ewald_volume(&e->ewald.box);
  for (int i = 0; i < e->own; i++) {
    const long j = e->sphere[i];
    const double w = e->spheres.w[j], b = sd_ewald_b(&e->ewald, e->spheres.a[j]);
    for (int l = 0; l < e->levels; l++) {
      const double *C = e->tail[i < e->small ? l : 1], *S = sums + 9 * l;
      for (int d = 0; d < 3; d++)
        u[m * j + d] += w * over_V * ((C[0] - b * C[1]) * S[d] - (C[1] - b * C[2]) * S[3 + d]);
      for (int d = 3; d < m; d++) u[m * j + d] += w * 0.25 * C[1] * over_V * S[3 + d];
    }
  }
}

/* u = what is near, of both levels; and the sums for what is far, of a periodic box. There are
 * spheres. */
static sd_status near_part(ewald *e, const double *F, double *u, double *sums)
{
  sd_status status = e->ewald.box.periodic ? sums_of(e, F, sums) : SD_OK;
  if (status == SD_OK && e->world.refresh)
    status = e->world.refresh(e->world.ctx, F, e->ghosts, e->width);
  if (status != SD_OK) return status;
  sd_ewald_pairs_apply(&e->pairs, e->n, F, e->ghosts, u);
  if (e->ewald.images.wall.sign)
    sd_ewald_image_pairs_apply(&e->image_pairs, e->n, F, e->ghosts, u);
  if (e->levels == 2)
    status = sd_ewald_large_pairs_apply(&e->large_pairs, &e->spheres, e->sphere, &e->world, F, u);
  return status;
}

/* Free between two products of the near part, and longer than a row for each of our spheres */
static double *rows_of_waves(const ewald *e)
{
  return e->pairs.u;
}

static void clear(const ewald *e, double *u)
{
  memset(u, 0, sizeof(double) * (size_t) e->width * (size_t) e->n);
}

static sd_status apply(void *state, const double *F, double *u)
{
  ewald *e = state;
  double sums[18], *rows = rows_of_waves(e);
  if (!(e->ewald.count > 0.0)) {
    clear(e, u);
    return SD_OK;
  }
  sd_status status = near_part(e, F, u, sums);
  for (int l = 0; l < e->levels && status == SD_OK; l++) {
    status = sd_ewald_waves_apply(e->waves + l, &e->spheres, F, rows);
    if (status == SD_OK) add_waves(e, l, rows, u);
  }
  if (status == SD_OK && e->ewald.box.periodic) add_means(e, sums, u);
  return status;
}

/* --- noise: the wave part is drawn, the rest are products --- */

static int divides(const void *state)
{
  const ewald *e = state;
  return e->ewald.count > 0.0 && e->ewald.box.periodic && e->levels == 1 &&
      e->ewald.xi * e->ewald.largest <= SD_EWALD_POSITIVE * (1.0 + 1e-9);
}

static sd_status apply_rest(void *state, const double *F, double *u)
{
  ewald *e = state;
  double sums[18];
  const sd_status status = near_part(e, F, u, sums);
  if (status == SD_OK) add_means(e, sums, u);
  return status;
}

static sd_status draw(void *state, const sd_random_key *key, double *u)
{
  ewald *e = state;
  clear(e, u);
  double *rows = rows_of_waves(e);
  const sd_status status = sd_ewald_waves_draw(e->waves, key, rows);
  if (status == SD_OK) add_waves(e, 0, rows, u);
  return status;
}

static void release(void *state)
{
  ewald *e = state;
  sd_ewald_pairs_free(&e->pairs);
  sd_ewald_large_pairs_free(&e->large_pairs);
  sd_ewald_image_pairs_free(&e->image_pairs);
  for (int l = 0; l < 2; l++) sd_ewald_waves_free(e->waves + l);
  free(e->sphere);
  free(e->small_a);
  free(e->stand);
  free(e->ghosts);
}

const sd_mobility_engine sd_mobility_ewald = {
    .name = "Ewald sum",
    .state = sizeof(ewald),
    .view = SD_VIEW_NEAR,
    .place = place,
    .apply = apply,
    .free = release,
    .divides = divides,
    .apply_rest = apply_rest,
    .draw = draw,
};
