/* Ewald sums: a near part by pairs, a wave part by FFT, and what both leave out. */
#include "sd_mobility.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_ewald_image_pairs.h"
#include "sd_ewald_pairs.h"
#include "sd_ewald_waves.h"
#include "sd_rank_spheres.h"

typedef struct {
  /* what the tables are made for */
  sd_ewald ewald;
  int width, ready;
  /* sd_mobility_scene's */
  int one_sided;
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

/* Pairs and waves, unless something has failed; on all ranks together */
static sd_status me_stand(ewald *e, const sd_mobility_scene *s, sd_status status)
{
  sd_rank_spheres *here = &e->here;
  int brick[6] = {0};
  if (status == SD_OK && !all_finite(s)) status = SD_ENOTFINITE;
  if (status == SD_OK) status = take_spheres(e, s);
  const sd_groups groups = groups_of(e, s);
  if (status == SD_OK)
    status = sd_ewald_pairs_place(&e->pairs, &here->spheres, &groups, s->n, s->n_all, e->waves.turn);
  if (status == SD_OK && e->ewald.images.wall.sign)
    status = sd_ewald_image_pairs_place(&e->image_pairs, &e->ewald.images.wall, &here->spheres, s->n,
                                        s->n_all);
  if (status == SD_OK) sd_rank_spheres_list(here, &e->pairs);
  if (status == SD_OK)
    status = sd_ewald_waves_find(&e->waves, &here->spheres, here->sphere, here->own, brick);
  return sd_ewald_waves_meet(&e->waves, brick, status, &e->world);
}

/* Spheres are spread in the order of the pairs' rows, which is that of the grid: where the frame has turned, all of
 * it again. */
static sd_status me_place(void *state, const sd_mobility_scene *s)
{
  ewald *e = state;
  sd_status status = SD_OK;
  e->here.n = s->n;
  if (changed(e, s)) status = me_make_tables(e, s);
  e->world = s->world;
  e->one_sided = s->one_sided;
  e->ewald.box = s->how.ewald->box;
  e->waves.grid.world = s->world;
  sd_ewald_waves_stand(&e->waves, &e->ewald.box);
  if (!(e->ewald.count > 0.0)) return status;
  const int turn = e->waves.turn;
  status = me_stand(e, s, status);
  return status == SD_OK && e->waves.turn != turn ? me_stand(e, s, status) : status;
}

/* --- product --- */

/* What is near, and the sums over all spheres for what is far. There are spheres. */
static sd_status me_near_part(ewald *e, const double *F, double *sums)
{
  sd_rank_spheres *here = &e->here;
  const int wanted = e->ewald.box.periodic || e->ewald.single;
  sd_status status = sd_rank_spheres_refresh(here, &e->world, F);
  if (status == SD_OK)
    status = sd_ewald_pairs_load(&e->pairs, here->n, F, here->ghosts, &e->world, wanted ? sums : NULL);
  if (status == SD_OK) sd_ewald_pairs_apply(&e->pairs);
  return status;
}

/* u = all of it; rows of what waves do, NULL: without them */
static sd_status me_take(ewald *e, const double *F, const void *rows, const double *sums, double *u)
{
  const sd_rank_spheres *here = &e->here;
  sd_ewald_pairs_take(&e->pairs, here->n, F, rows, e->tail, e->ewald.box.periodic ? sums : NULL, u);
  if (e->ewald.images.wall.sign)
    sd_ewald_image_pairs_apply(&e->image_pairs, here->n, F, here->ghosts, u);
  if (!e->one_sided) return SD_OK;
  sd_ewald_pairs_of_ghosts(&e->pairs, here->n, here->n_all, here->ghosts);
  return e->world.reduce(e->world.ctx, here->ghosts, u, e->width);
}

static void clear(const ewald *e, double *u)
{
  memset(u, 0, sizeof(double) * (size_t) e->width * (size_t) e->here.n);
}

static sd_status me_apply(void *state, const double *F, double *u)
{
  ewald *e = state;
  double sums[SD_EWALD_SUMS];
  if (!(e->ewald.count > 0.0)) {
    clear(e, u);
    return SD_OK;
  }
  sd_status status = me_near_part(e, F, sums);
  if (status != SD_OK) return status;
  void *rows = sd_ewald_pairs_rows(&e->pairs);
  status = sd_ewald_waves_apply(&e->waves, rows);
  return status == SD_OK ? me_take(e, F, rows, sums, u) : status;
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
  double sums[SD_EWALD_SUMS];
  const sd_status status = me_near_part(e, F, sums);
  return status == SD_OK ? me_take(e, F, NULL, sums, u) : status;
}

static sd_status draw(void *state, const sd_random_key *key, double *u)
{
  ewald *e = state;
  void *rows = e->pairs.waves; /* free between two products */
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
    .reads_places_once = 1,
    .place = me_place,
    .apply = me_apply,
    .free = me_release,
    .divides = divides,
    .apply_rest = apply_rest,
    .draw = draw,
};
