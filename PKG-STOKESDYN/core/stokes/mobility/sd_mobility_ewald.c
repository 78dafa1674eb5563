/* Ewald sums: a near part by pairs, a wave part by FFT, and what both leave out. */
#include "sd_mobility.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_ewald_image_pairs.h"
#include "sd_ewald_pairs.h"
#include "sd_ewald_waves.h"
#include "sd_room.h"

typedef struct {
  /* what the tables are made for */
  sd_ewald ewald;
  int width, ready;
  sd_world world;
  sd_ewald_waves waves;
  sd_ewald_pairs pairs;
  sd_ewald_image_pairs image_pairs;
  double tail[3];
  /* [own] this rank's spheres with radius in order of the near part's targets */
  int *sphere, own;
  size_t sphere_room;
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

static sd_status me_make_tables(ewald *e, const sd_mobility_scene *s)
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
  sd_ewald_pairs_create(&e->pairs, how, kernels, e->width);
  if (how->images.wall.sign) sd_ewald_image_pairs_create(&e->image_pairs, how, kernels);
  sd_radial_tail(how, e->tail);
  const sd_status status = sd_ewald_waves_create(&e->waves, how, kernels, e->width, &s->world);
  e->ready = status == SD_OK;
  return status;
}

/* Is there a splitting for which the tables are not? */
static int changed(const ewald *e, const sd_mobility_scene *s)
{
  return !e->ready || e->width != s->how.width || !sd_ewald_same_tables(&e->ewald, s->how.ewald);
}

/* --- where the spheres stand --- */

static int me_make_room(ewald *e, int n, size_t ghost_numbers)
{
  return sd_reserve(&e->sphere, sizeof(int), (size_t) n, &e->sphere_room) &&
      sd_reserve(&e->ghosts, sizeof(double), ghost_numbers, &e->ghost_room);
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
  e->own = e->pairs.n;
  for (int i = 0; i < e->pairs.n; i++) e->sphere[i] = e->pairs.sphere[e->pairs.target[i]];
}

static int all_finite(const sd_mobility_scene *s)
{
  for (int i = 0; i < s->n_all; i++)
    for (int d = 0; d < 3; d++)
      if (s->spheres.a[i] > 0.0 && !(fabs(s->spheres.x[3 * (long) i + d]) < INFINITY)) return 0;
  return 1;
}

static sd_status me_place(void *state, const sd_mobility_scene *s)
{
  ewald *e = state;
  e->n = s->n;
  e->n_all = s->n_all;
  sd_status status = SD_OK;
  if (changed(e, s)) status = me_make_tables(e, s);
  e->world = s->world;
  e->ewald.box = s->how.ewald->box;
  e->waves.grid.world = s->world;
  sd_ewald_waves_stand(&e->waves, &e->ewald.box);
  if (!(e->ewald.count > 0.0)) return status;
  int brick[6] = {0};
  if (status == SD_OK && !all_finite(s)) status = SD_ENOTFINITE;
  if (status == SD_OK && !keep_off_wall(e, s)) status = SD_ENOMEMORY;
  if (status == SD_OK) status = sd_ewald_pairs_place(&e->pairs, &e->spheres, s->n, s->n_all);
  if (status == SD_OK && e->ewald.images.wall.sign)
    status = sd_ewald_image_pairs_place(&e->image_pairs, &e->ewald.images.wall, &e->spheres, s->n, s->n_all);
  if (status == SD_OK && !me_make_room(e, s->n, (size_t) e->width * (size_t) (s->n_all - s->n)))
    status = SD_ENOMEMORY;
  if (status == SD_OK) list_spheres(e);
  if (status == SD_OK)
    status = sd_ewald_waves_find(&e->waves, &e->spheres, e->sphere, e->own, brick);
  return sd_ewald_waves_meet(&e->waves, brick, status, &e->world);
}

/* --- product --- */

/* Sums [9] over all spheres of w F, b w F and w T: what is far is felt as a mean. */
static sd_status sums_of(const ewald *e, const double *F, double *sums)
{
  const long m = e->width;
  memset(sums, 0, 9 * sizeof(double));
  for (int i = 0; i < e->own; i++) {
    const long j = e->sphere[i];
    const double w = e->spheres.w[j], b = sd_ewald_b(&e->ewald, e->spheres.a[j]);
    for (int d = 0; d < 3; d++) {
      sums[d] += w * F[m * j + d];
      sums[3 + d] += w * b * F[m * j + d];
      if (m == 6) sums[6 + d] += w * F[m * j + 3 + d];
    }
  }
  return sd_world_sum(&e->world, sums, 9);
}

/* u += w rows */
static void add_waves(const ewald *e, const double *rows, double *u)
{
  const long m = e->width;
  for (int i = 0; i < e->own; i++) {
    const long j = e->sphere[i];
    for (int d = 0; d < m; d++) u[m * j + d] += e->spheres.w[j] * rows[m * i + d];
  }
}

/* u += w (mean of what is beyond the range) */
static void add_means(const ewald *e, const double *S, double *u)
{
  const long m = e->width;
  const double over_V = 1.0 / sd_ewald_volume(&e->ewald.box), *C = e->tail;
  for (int i = 0; i < e->own; i++) {
    const long j = e->sphere[i];
    const double w = e->spheres.w[j], b = sd_ewald_b(&e->ewald, e->spheres.a[j]);
    for (int d = 0; d < 3; d++)
      u[m * j + d] += w * over_V * ((C[0] - b * C[1]) * S[d] - (C[1] - b * C[2]) * S[3 + d]);
    for (int d = 3; d < m; d++) u[m * j + d] += w * 0.25 * C[1] * over_V * S[3 + d];
  }
}

/* u = what is near; and the sums for what is far, of a periodic box. There are spheres. */
static sd_status me_near_part(ewald *e, const double *F, double *u, double *sums)
{
  sd_status status = e->ewald.box.periodic ? sums_of(e, F, sums) : SD_OK;
  if (status == SD_OK && e->world.refresh)
    status = e->world.refresh(e->world.ctx, F, e->ghosts, e->width);
  if (status != SD_OK) return status;
  sd_ewald_pairs_apply(&e->pairs, e->n, F, e->ghosts, u);
  if (e->ewald.images.wall.sign)
    sd_ewald_image_pairs_apply(&e->image_pairs, e->n, F, e->ghosts, u);
  return SD_OK;
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

static sd_status me_apply(void *state, const double *F, double *u)
{
  ewald *e = state;
  double sums[9], *rows = rows_of_waves(e);
  if (!(e->ewald.count > 0.0)) {
    clear(e, u);
    return SD_OK;
  }
  sd_status status = me_near_part(e, F, u, sums);
  if (status == SD_OK) status = sd_ewald_waves_apply(&e->waves, &e->spheres, F, rows);
  if (status == SD_OK) add_waves(e, rows, u);
  if (status == SD_OK && e->ewald.box.periodic) add_means(e, sums, u);
  return status;
}

/* --- noise: the wave part is drawn, the rest are products --- */

static int divides(const void *state)
{
  const ewald *e = state;
  return e->ewald.count > 0.0 && e->ewald.box.periodic && e->ewald.taken == 0.0 &&
      e->ewald.xi * e->ewald.largest <= e->ewald.positive * (1.0 + 1e-9);
}

static sd_status apply_rest(void *state, const double *F, double *u)
{
  ewald *e = state;
  double sums[9];
  const sd_status status = me_near_part(e, F, u, sums);
  if (status == SD_OK) add_means(e, sums, u);
  return status;
}

static sd_status draw(void *state, const sd_random_key *key, double *u)
{
  ewald *e = state;
  clear(e, u);
  double *rows = rows_of_waves(e);
  const sd_status status = sd_ewald_waves_draw(&e->waves, key, rows);
  if (status == SD_OK) add_waves(e, rows, u);
  return status;
}

static void me_release(void *state)
{
  ewald *e = state;
  sd_ewald_pairs_free(&e->pairs);
  sd_ewald_image_pairs_free(&e->image_pairs);
  sd_ewald_waves_free(&e->waves);
  free(e->sphere);
  free(e->stand);
  free(e->ghosts);
}

const sd_mobility_engine sd_mobility_ewald = {
    .name = "Ewald sum",
    .state = sizeof(ewald),
    .view = SD_VIEW_NEAR,
    .place = me_place,
    .apply = me_apply,
    .free = me_release,
    .divides = divides,
    .apply_rest = apply_rest,
    .draw = draw,
};
