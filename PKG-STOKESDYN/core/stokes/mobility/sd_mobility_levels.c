/* Ewald sums of two levels: an engine of one level sums the small spheres, as if there were no
 * others. Here are the pairs with a large sphere, the waves that all make and feel, and what both
 * leave out. */
#include "sd_mobility.h"

#include <stdlib.h>
#include <string.h>

#include "sd_ewald_large_pairs.h"
#include "sd_ewald_waves.h"
#include "sd_room.h"

typedef struct {
  /* what the tables are made for */
  sd_ewald_level second;
  int width, ready;
  sd_world world;
  sd_mobility small;
  sd_ewald_waves waves;
  sd_ewald_large_pairs pairs;
  double tail[3];
  /* [own] this rank's spheres with radius */
  int *sphere, own;
  size_t sphere_room;
  /* [n_all] radii, 0 of the large ones */
  double *small_a;
  size_t small_room;
  /* [width n] what waves do to them, and more, since whole vectors are read */
  double *rows;
  size_t rows_room;
  sd_spheres spheres;
} levels;

enum { SPARE = 16 };

static sd_status le_make_tables(levels *e, const sd_mobility_scene *s)
{
  const struct sd_ewald_kernels *kernels = sd_ewald_kernels_for(&s->how.second->split);
  e->second = *s->how.second;
  e->width = s->how.width;
  sd_ewald_large_pairs_create(&e->pairs, &e->second, e->width);
  sd_radial_tail(&e->second.split, e->tail);
  const sd_status status =
      sd_ewald_waves_create(&e->waves, &e->second.split, kernels, e->width, &s->world);
  e->ready = status == SD_OK;
  return status;
}

static int le_changed(const levels *e, const sd_mobility_scene *s)
{
  const sd_ewald_level *second = s->how.second;
  return !e->ready || e->width != s->how.width || e->second.from != second->from ||
      !sd_ewald_same_tables(&e->second.split, &second->split);
}

/* Which spheres are small, and which are ours */
static sd_status le_list(levels *e, const sd_mobility_scene *s)
{
  const size_t n = (size_t) s->n, numbers = (size_t) s->how.width * n + SPARE;
  e->own = 0;
  if (!sd_reserve(&e->small_a, sizeof(double), (size_t) s->n_all, &e->small_room) ||
      !sd_reserve(&e->sphere, sizeof(int), n, &e->sphere_room) ||
      !sd_reserve(&e->rows, sizeof(double), numbers, &e->rows_room))
    return SD_ENOMEMORY;
  for (int i = 0; i < s->n_all; i++)
    e->small_a[i] = s->spheres.a[i] < s->how.second->from ? s->spheres.a[i] : 0.0;
  for (int i = 0; i < s->n; i++)
    if (s->spheres.a[i] > 0.0) e->sphere[e->own++] = i;
  return SD_OK;
}

static sd_status le_place_small(levels *e, const sd_mobility_scene *s)
{
  sd_mobility_scene small = *s;
  small.spheres.a = e->small_a;
  small.how.second = NULL;
  return sd_mobility_place(&e->small, &sd_mobility_ewald, &small);
}

/* All ranks go through the same sums, also where one has failed. */
static sd_status le_place(void *state, const sd_mobility_scene *s)
{
  levels *e = state;
  int brick[6] = {0};
  sd_status status = le_changed(e, s) ? le_make_tables(e, s) : SD_OK;
  e->world = s->world;
  e->spheres = s->spheres;
  e->waves.grid.world = s->world;
  e->second.split.box = e->pairs.ewald.box = s->how.second->split.box;
  sd_ewald_waves_stand(&e->waves, &e->second.split.box);
  if (status == SD_OK) status = le_list(e, s);
  status = sd_world_agree(&e->world, status);
  if (status == SD_OK) status = le_place_small(e, s);
  if (status != SD_OK) return status;
  status = sd_ewald_waves_find(&e->waves, &e->spheres, e->sphere, e->own, brick);
  const sd_status pairs = sd_ewald_large_pairs_place(
      &e->pairs, &e->spheres, e->sphere, status == SD_OK ? e->own : 0, &e->world);
  return sd_ewald_waves_meet(&e->waves, brick, status == SD_OK ? pairs : status, &e->world);
}

/* --- product --- */

/* Sums over the small spheres, and over the large ones, of w F, b w F and w T: sums [2][9] */
static sd_status le_sums(const levels *e, const double *F, double *sums)
{
  const long m = e->width;
  memset(sums, 0, 18 * sizeof(double));
  for (int i = 0; i < e->own; i++) {
    const long j = e->sphere[i];
    const double w = e->spheres.w[j], b = sd_ewald_b(&e->second.split, e->spheres.a[j]);
    double *s = sums + (e->spheres.a[j] < e->second.from ? 0 : 9);
    for (int d = 0; d < 3; d++) {
      s[d] += w * F[m * j + d];
      s[3 + d] += w * b * F[m * j + d];
      if (m == 6) s[6 + d] += w * F[m * j + 3 + d];
    }
  }
  return sd_world_sum(&e->world, sums, 18);
}

/* u += w (mean of what is beyond the range): small spheres have that of one another
 * already */
static void le_add_far(const levels *e, const double *sums, double *u)
{
  const long m = e->width;
  const sd_ewald_box *box = &e->second.split.box;
  const double over_V = box->periodic ? 1.0 / sd_ewald_volume(box) : 0.0, *C = e->tail;
  double all[9];
  for (int k = 0; k < 9; k++) all[k] = sums[k] + sums[9 + k];
  for (int i = 0; i < e->own; i++) {
    const long j = e->sphere[i];
    const double w = e->spheres.w[j], a = e->spheres.a[j], b = sd_ewald_b(&e->second.split, a);
    const double *S = a < e->second.from ? sums + 9 : all;
    for (int d = 0; d < 3; d++)
      u[m * j + d] += w * over_V * ((C[0] - b * C[1]) * S[d] - (C[1] - b * C[2]) * S[3 + d]);
    for (int d = 3; d < m; d++) u[m * j + d] += w * 0.25 * C[1] * over_V * S[3 + d];
  }
}

static sd_status le_apply(void *state, const double *F, double *u)
{
  levels *e = state;
  double sums[18] = {0.0};
  sd_status status = sd_mobility_apply(&e->small, F, u);
  if (status == SD_OK && e->second.split.box.periodic) status = le_sums(e, F, sums);
  if (status == SD_OK)
    status = sd_ewald_large_pairs_apply(&e->pairs, &e->spheres, e->sphere, &e->world, F, u);
  if (status != SD_OK) return status;
  sd_ewald_waves_load(&e->waves, &e->spheres, F, e->rows);
  status = sd_ewald_waves_apply(&e->waves, e->rows);
  if (status == SD_OK) sd_ewald_waves_add(&e->waves, &e->spheres, e->rows, u);
  if (status == SD_OK) le_add_far(e, sums, u);
  return status;
}

static void le_free(void *state)
{
  levels *e = state;
  sd_mobility_free(&e->small);
  sd_ewald_waves_free(&e->waves);
  sd_ewald_large_pairs_free(&e->pairs);
  free(e->sphere);
  free(e->small_a);
  free(e->rows);
}

const sd_mobility_engine sd_mobility_levels = {
    .name = "Ewald sum of two levels",
    .state = sizeof(levels),
    .view = SD_VIEW_NEAR,
    .place = le_place,
    .apply = le_apply,
    .free = le_free,
};
