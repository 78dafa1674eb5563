/* Ewald sums: a near part by pairs, a wave part by FFT, and what both leave out. */
#include "sd_mobility.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_ewald_image_pairs.h"
#include "sd_ewald_pairs.h"
#include "sd_ewald_waves.h"
#include "sd_rank_spheres.h"
#include "sd_real.h"

typedef struct {
  /* what the tables are made for */
  sd_ewald ewald;
  int width, ready;
  sd_world world;
  sd_ewald_waves waves;
  sd_ewald_pairs pairs;
  sd_ewald_image_pairs image_pairs;
  double tail[3];
  sd_rank_spheres here;
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
  const struct sd_ewald_kernels *kernels = sd_ewald_kernels_for(how);
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

/* Above a wall the whole matrix is made with heights of at least the radii (sd_wall.h). */
static sd_status take_spheres(ewald *e, const sd_mobility_scene *s)
{
  const sd_wall *wall = &e->ewald.images.wall;
  const sd_status status =
      sd_rank_spheres_take(&e->here, &s->spheres, e->width, s->n, s->n_all, wall->sign);
  if (status != SD_OK || !wall->sign) return status;
  for (long i = 0; i < s->n_all; i++)
    sd_wall_keep_off(wall, s->spheres.x + 3 * i, s->spheres.a[i], e->here.stand + 3 * i);
  return SD_OK;
}

/* Where spheres are kept off a wall, none is like another. */
static sd_groups groups_of(const ewald *e, const sd_mobility_scene *s)
{
  sd_groups groups = s->groups;
  if (e->ewald.images.wall.sign) groups.form = NULL;
  return groups;
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
  sd_rank_spheres *here = &e->here;
  here->n = s->n;
  sd_status status = SD_OK;
  if (changed(e, s)) status = me_make_tables(e, s);
  e->world = s->world;
  e->ewald.box = s->how.ewald->box;
  e->waves.grid.world = s->world;
  sd_ewald_waves_stand(&e->waves, &e->ewald.box);
  if (!(e->ewald.count > 0.0)) return status;
  int brick[6] = {0};
  if (status == SD_OK && !all_finite(s)) status = SD_ENOTFINITE;
  if (status == SD_OK) status = take_spheres(e, s);
  const sd_groups groups = groups_of(e, s);
  if (status == SD_OK)
    status = sd_ewald_pairs_place(&e->pairs, &here->spheres, &groups, s->n, s->n_all);
  if (status == SD_OK && e->ewald.images.wall.sign)
    status = sd_ewald_image_pairs_place(&e->image_pairs, &e->ewald.images.wall, &here->spheres, s->n,
                                        s->n_all);
  if (status == SD_OK) sd_rank_spheres_list(here, &e->pairs);
  if (status == SD_OK)
    status = sd_ewald_waves_find(&e->waves, &here->spheres, here->sphere, here->own, brick);
  return sd_ewald_waves_meet(&e->waves, brick, status, &e->world);
}

/* --- product --- */

/* Sums [9] over all spheres of w F, b w F and w T: what is far is felt as a mean. */
static sd_status ewald_sums_of(const ewald *e, const double *F, double *sums)
{
  const sd_rank_spheres *here = &e->here;
  const long m = e->width;
  memset(sums, 0, 9 * sizeof(double));
  for (int i = 0; i < here->own; i++) {
    const long j = here->sphere[i];
    const double w = here->spheres.w[j], b = sd_ewald_b(&e->ewald, here->spheres.a[j]);
    for (int d = 0; d < 3; d++) {
      sums[d] += w * F[m * j + d];
      sums[3 + d] += w * b * F[m * j + d];
      if (m == 6) sums[6 + d] += w * F[m * j + 3 + d];
    }
  }
  return sd_world_sum(&e->world, sums, 9);
}

/* u += w (mean of what is beyond the range), of one sphere */
static void add_mean(const ewald *e, long j, double over_V, const double *S, double *u)
{
  const long m = e->width;
  const double w = e->here.spheres.w[j], b = sd_ewald_b(&e->ewald, e->here.spheres.a[j]), *C = e->tail;
  for (int d = 0; d < 3; d++)
    u[m * j + d] += w * over_V * ((C[0] - b * C[1]) * S[d] - (C[1] - b * C[2]) * S[3 + d]);
  for (int d = 3; d < m; d++) u[m * j + d] += w * 0.25 * C[1] * over_V * S[3 + d];
}

/* u += w (waves, and the mean of what is beyond the range of a periodic box); rows NULL: no waves */
static void add_far(const ewald *e, const void *rows, const double *sums, double *u)
{
  const sd_rank_spheres *here = &e->here;
  const long m = e->width;
  const double over_V = 1.0 / sd_ewald_volume(&e->ewald.box);
  const size_t bytes = e->waves.kernels->bytes;
  for (int i = 0; i < here->own; i++) {
    const long j = here->sphere[i];
    for (int d = 0; d < m && rows; d++) u[m * j + d] += here->spheres.w[j] * sd_number(rows, bytes, m * i + d);
    if (e->ewald.box.periodic) add_mean(e, j, over_V, sums, u);
  }
}

/* u = what is near; and the sums for what is far, of a periodic box. There are spheres. */
static sd_status me_near_part(ewald *e, const double *F, double *u, double *sums)
{
  sd_rank_spheres *here = &e->here;
  sd_status status = e->ewald.box.periodic ? ewald_sums_of(e, F, sums) : SD_OK;
  if (status == SD_OK) status = sd_rank_spheres_refresh(here, &e->world, F);
  if (status != SD_OK) return status;
  sd_ewald_pairs_apply(&e->pairs, here->n, F, here->ghosts, u);
  if (e->ewald.images.wall.sign)
    sd_ewald_image_pairs_apply(&e->image_pairs, here->n, F, here->ghosts, u);
  return SD_OK;
}

static void clear(const ewald *e, double *u)
{
  memset(u, 0, sizeof(double) * (size_t) e->width * (size_t) e->here.n);
}

static sd_status me_apply(void *state, const double *F, double *u)
{
  ewald *e = state;
  double sums[9];
  if (!(e->ewald.count > 0.0)) {
    clear(e, u);
    return SD_OK;
  }
  sd_status status = me_near_part(e, F, u, sums);
  if (status != SD_OK) return status;
  void *rows = sd_ewald_pairs_rows(&e->pairs);
  status = sd_ewald_waves_apply(&e->waves, rows);
  if (status == SD_OK) add_far(e, rows, sums, u);
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
  if (status == SD_OK) add_far(e, NULL, sums, u);
  return status;
}

static sd_status draw(void *state, const sd_random_key *key, double *u)
{
  ewald *e = state;
  void *rows = e->pairs.u; /* free between two products */
  clear(e, u);
  const sd_status status = sd_ewald_waves_draw(&e->waves, key, rows);
  if (status == SD_OK) sd_ewald_waves_add(&e->waves, &e->here.spheres, rows, u);
  return status;
}

static void me_release(void *state)
{
  ewald *e = state;
  sd_ewald_pairs_free(&e->pairs);
  sd_ewald_image_pairs_free(&e->image_pairs);
  sd_ewald_waves_free(&e->waves);
  sd_rank_spheres_free(&e->here);
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
