/* Ewald sums in a box that is periodic in two directions (sd_slab.h): near pairs, near images in
 * each wall, waves with columns, and the mean flow along the walls. */
#include "sd_mobility.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_columns.h"
#include "sd_ewald_image_pairs.h"
#include "sd_ewald_pairs.h"
#include "sd_ewald_waves.h"
#include "sd_rank_spheres.h"
#include "sd_room.h"
#include "sd_slab_rest.h"

typedef struct {
  /* what the tables are made for */
  sd_slab slab;
  int ready;
  sd_world world;
  sd_ewald_pairs pairs;
  sd_ewald_image_pairs images[2];
  sd_ewald_waves waves;
  sd_columns columns;
  sd_slab_rest rest;
  sd_rank_spheres here;
  /* [here.own] heights of this rank's spheres with radius */
  double *height;
  size_t height_room;
} slab;

/* --- tables of a splitting --- */

static sd_status slab_make_tables(slab *s, const sd_mobility_scene *scene)
{
  const sd_slab *how = scene->how.slab;
  s->ready = 0;
  s->slab = *how;
  if (!(how->ewald.count > 0.0)) {
    s->ready = 1;
    return SD_OK;
  }
  const struct sd_ewald_kernels *kernels = sd_ewald_kernels_for(&how->ewald);
  const struct sd_columns_kernels *columns =
      SD_KERNELS_OF(sd_columns, plain, sd_isa_of(SD_ISA_BEST));
  sd_ewald_pairs_create(&s->pairs, &how->ewald, kernels, 3);
  for (int w = 0; w < sd_slab_many_walls(&how->walls); w++)
    sd_ewald_image_pairs_create(s->images + w, &how->ewald, kernels);
  sd_status status = sd_ewald_waves_create(&s->waves, &how->ewald, kernels, 3, &scene->world);
  const sd_grid *grid = &s->waves.grid;
  if (status == SD_OK)
    status = sd_columns_create(&s->columns, how, columns, grid->own[SD_SHARED_Y],
                               grid->own[SD_SHARED_Z]);
  if (status == SD_OK) status = sd_grid_add_sweep(&s->waves.grid, sd_columns_apply, &s->columns);
  if (status == SD_OK) status = sd_slab_rest_create(&s->rest, how);
  s->ready = status == SD_OK;
  return status;
}

/* --- where the spheres stand --- */

/* Off the walls, and within the heights that the tables have; 0: not all of them */
static int stand_spheres(slab *s, const sd_spheres *spheres)
{
  const double spare = 1e-9 * (s->slab.hi - s->slab.lo + s->slab.spacing);
  int sound = 1;
  for (long i = 0; i < s->here.n_all; i++) {
    double *x = s->here.stand + 3 * i;
    sd_slab_keep_off(&s->slab.walls, spheres->x + 3 * i, spheres->a[i], x);
    const double height = sd_slab_height(&s->slab.walls, x);
    if (!(spheres->a[i] > 0.0)) continue;
    for (int d = 0; d < 3; d++) sound = sound && fabs(x[d]) < INFINITY;
    sound = sound && height >= s->slab.lo - spare && height <= s->slab.hi + spare;
  }
  return sound;
}

static sd_status place_images(slab *s)
{
  sd_status status = SD_OK;
  for (int w = 0; w < sd_slab_many_walls(&s->slab.walls) && status == SD_OK; w++)
    status = sd_ewald_image_pairs_place(s->images + w, s->slab.walls.wall + w, &s->here.spheres,
                                        s->here.n, s->here.n_all);
  return status;
}

static void list_spheres(slab *s)
{
  sd_rank_spheres_list(&s->here, &s->pairs);
  for (int i = 0; i < s->here.own; i++)
    s->height[i] = sd_slab_height(&s->slab.walls, s->here.spheres.x + 3L * s->here.sphere[i]);
}

static sd_status place(void *state, const sd_mobility_scene *scene)
{
  slab *s = state;
  sd_rank_spheres *here = &s->here;
  const int n = here->n = scene->n;
  sd_status status = SD_OK;
  if (!s->ready || !sd_slab_same_tables(&s->slab, scene->how.slab)) status = slab_make_tables(s, scene);
  s->world = scene->world;
  s->waves.grid.world = scene->world;
  if (!(s->slab.ewald.count > 0.0)) return status;
  int brick[6] = {0};
  /* where spheres are kept off a wall, none is like another */
  const sd_groups groups = {scene->groups.n, scene->groups.first, NULL};
  if (status == SD_OK) status = sd_rank_spheres_take(here, &scene->spheres, 3, n, scene->n_all, 1);
  if (status == SD_OK && !sd_reserve(&s->height, sizeof(double), (size_t) n, &s->height_room))
    status = SD_ENOMEMORY;
  if (status == SD_OK && !stand_spheres(s, &scene->spheres)) status = SD_ENOTFINITE;
  if (status == SD_OK)
    status = sd_ewald_pairs_place(&s->pairs, &here->spheres, &groups, n, here->n_all, s->waves.turn);
  if (status == SD_OK) status = place_images(s);
  if (status == SD_OK) list_spheres(s);
  if (status == SD_OK)
    status = sd_ewald_waves_find(&s->waves, &here->spheres, here->sphere, here->own, brick);
  return sd_ewald_waves_meet(&s->waves, brick, status, &s->world);
}

/* --- product --- */

/* Sums over all spheres of F, z F and (z^2 + 2 A) F along the slab, A = a^2/6: [2][3]; and those of the rest */
static sd_status slab_sums_of(slab *s, const double *F)
{
  const sd_rank_spheres *here = &s->here;
  const int axis = s->slab.walls.wall->axis;
  double *sums = s->rest.means;
  sd_slab_rest_clear(&s->rest);
  for (int i = 0; i < here->own; i++) {
    const long j = here->sphere[i];
    const double z = s->height[i], a = here->spheres.a[j];
    for (int d = 0; d < 2; d++) {
      const double f = here->spheres.w[j] * F[3 * j + (axis + 1 + d) % 3];
      sums[3 * d] += f;
      sums[3 * d + 1] += z * f;
      sums[3 * d + 2] += (z * z + a * a / 3.0) * f;
    }
    double weighed[3];
    for (int d = 0; d < 3; d++) weighed[d] = here->spheres.w[j] * F[3 * j + d];
    sd_slab_rest_add(&s->rest, z, a, weighed);
  }
  return sd_world_sum(&s->world, s->rest.sums, s->rest.numbers);
}

/* The mean along the slab: that of the taller periodic box taken away, which has
 * -|d|/2 + Lz/12 + d^2/(2 Lz), and the walls' (sd_slab.h) put in; |d| stays. */
static void add_means(const slab *s, double *u)
{
  const sd_rank_spheres *here = &s->here;
  const sd_slab_walls *walls = &s->slab.walls;
  const sd_ewald *e = &s->slab.ewald;
  const int axis = walls->wall->axis;
  const double Lz = s->slab.spacing * e->grid[axis], H = walls->height;
  const double over = 1.0 / (e->box.edge[(axis + 1) % 3] * e->box.edge[(axis + 2) % 3]);
  for (int i = 0; i < here->own; i++) {
    const long j = here->sphere[i];
    const double a = here->spheres.a[j], z = s->height[i], square = z * z + a * a / 3.0;
    for (int d = 0; d < 2; d++) {
      const double *S = s->rest.means + 3 * d;
      double v = -Lz / 12.0 * S[0] - (square * S[0] - 2.0 * z * S[1] + S[2]) / (2.0 * Lz);
      if (walls->kind != SD_SLAB_LAYER) v += 0.5 * (z * S[0] + S[1]);
      if (walls->kind == SD_SLAB_SLIT) v -= z * S[1] / H;
      if (walls->no_flux) v -= 3.0 / (H * H * H) * (z * H - square) * (H * S[1] - S[2]);
      u[3 * j + (axis + 1 + d) % 3] += here->spheres.w[j] * over * v;
    }
  }
}

/* What the near part leaves out beyond its range */
static void add_rest(slab *s, double *u)
{
  const sd_rank_spheres *here = &s->here;
  sd_slab_rest_sum(&s->rest);
  for (int i = 0; i < here->own; i++) {
    const long j = here->sphere[i];
    double v[3] = {0.0};
    sd_slab_rest_take(&s->rest, s->height[i], here->spheres.a[j], v);
    for (int d = 0; d < 3; d++) u[3 * j + d] += here->spheres.w[j] * v[d];
  }
}

static sd_status slab_apply(void *state, const double *F, double *u)
{
  slab *s = state;
  sd_rank_spheres *here = &s->here;
  if (!(s->slab.ewald.count > 0.0)) {
    memset(u, 0, 3 * sizeof(double) * (size_t) s->here.n);
    return SD_OK;
  }
  sd_status status = slab_sums_of(s, F);
  if (status == SD_OK) status = sd_rank_spheres_refresh(here, &s->world, F);
  if (status == SD_OK) status = sd_ewald_pairs_load(&s->pairs, here->n, F, here->ghosts, &s->world, NULL);
  if (status != SD_OK) return status;
  sd_ewald_pairs_apply(&s->pairs);
  void *rows = sd_ewald_pairs_rows(&s->pairs);
  status = sd_ewald_waves_apply(&s->waves, rows);
  if (status != SD_OK) return status;
  sd_ewald_pairs_take(&s->pairs, here->n, F, rows, NULL, NULL, u);
  for (int w = 0; w < sd_slab_many_walls(&s->slab.walls); w++)
    sd_ewald_image_pairs_apply(s->images + w, here->n, F, here->ghosts, u);
  add_means(s, u);
  add_rest(s, u);
  return SD_OK;
}

static void slab_release(void *state)
{
  slab *s = state;
  sd_ewald_pairs_free(&s->pairs);
  for (int w = 0; w < 2; w++) sd_ewald_image_pairs_free(s->images + w);
  sd_columns_free(&s->columns);
  sd_slab_rest_free(&s->rest);
  sd_ewald_waves_free(&s->waves);
  sd_rank_spheres_free(&s->here);
  free(s->height);
}

const sd_mobility_engine sd_mobility_slab = {
    .name = "Ewald sum in a slab",
    .state = sizeof(slab),
    .view = SD_VIEW_NEAR,
    .place = place,
    .apply = slab_apply,
    .free = slab_release,
};
