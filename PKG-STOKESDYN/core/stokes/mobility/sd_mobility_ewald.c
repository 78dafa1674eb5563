/* Ewald sums: a near part by pairs, a wave part by FFT, and what both leave out. */
#include "sd_mobility.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_ewald_pairs.h"
#include "sd_ewald_waves.h"

typedef struct {
  /* what the tables are made for */
  sd_ewald ewald;
  int width, ready;
  sd_world world;
  sd_ewald_waves waves;
  sd_ewald_pairs pairs;
  double tail[3], origin[SD_RADIALS];
  /* summed over the ranks: sd_wave.self */
  double self[3][3];
  /* [pairs.n] this rank's spheres with radius, in order of the near part's targets */
  int *sphere, room;
  /* this rank's spheres, with ghosts */
  int n, n_all;
  double *ghosts;
  size_t ghost_room;
  sd_spheres spheres;
} ewald;

static double ghosts(const sd_mobility_how *how)
{
  return how->ewald ? how->ewald->reach : 0.0;
}

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
  const struct sd_ewald_kernels *kernels = sd_ewald_kernels_of(SD_ISA_BEST);
  sd_ewald_pairs_create(&e->pairs, how, kernels, e->width);
  sd_radial_tail(how, e->tail);
  sd_radial(how, 0.0, e->origin);
  const sd_status status = sd_ewald_waves_create(&e->waves, how, kernels, e->width, &s->world);
  e->ready = status == SD_OK;
  return status;
}

/* Is there a splitting for which the tables are not? */
static int changed(const ewald *e, const sd_mobility_scene *s)
{
  return !e->ready || e->width != s->how.width || memcmp(&e->ewald, s->how.ewald, sizeof(sd_ewald));
}

/* --- where the spheres stand --- */

static int make_room(ewald *e, int n, size_t ghost_numbers)
{
  if (n > e->room || !e->sphere) {
    const size_t many = (size_t) n + (size_t) n / 8 + 8;
    free(e->sphere);
    e->sphere = malloc(sizeof(int) * many);
    e->room = e->sphere ? (int) many : 0;
    if (!e->room) return 0;
  }
  if (ghost_numbers > e->ghost_room || !e->ghosts) {
    free(e->ghosts);
    e->ghosts = malloc(sizeof(double) * (ghost_numbers + 1));
    e->ghost_room = e->ghosts ? ghost_numbers : 0;
  }
  return e->ghosts != NULL;
}

/* All bricks, by a sum over the ranks, which also carries what a sphere's images do to it, and who
 * has failed: then all fail. */
static sd_status share_bricks(ewald *e, const int *brick, sd_status status)
{
  const int ranks = e->waves.grid.ranks, me = e->waves.grid.me, many = 6 * ranks + 2 + 9;
  double *values = calloc((size_t) many, sizeof(double));
  int *bricks = calloc((size_t) many, sizeof(int));
  if (!values || !bricks) status = SD_ENOMEMORY;
  if (values) {
    for (int k = 0; k < 6; k++) values[6 * me + k] = status == SD_OK ? brick[k] : 0;
    values[6 * ranks] = status == SD_ENOMEMORY;
    values[6 * ranks + 1] = status != SD_OK && status != SD_ENOMEMORY;
    memcpy(values + 6 * ranks + 2, e->waves.wave.self, sizeof(e->waves.wave.self));
  }
  if (values && e->world.sum) {
    const sd_status said = e->world.sum(e->world.ctx, values, many);
    if (status == SD_OK) status = said;
  }
  if (status == SD_OK && values[6 * ranks + 1] > 0.0) status = SD_ENOTFINITE;
  if (status == SD_OK && values[6 * ranks] > 0.0) status = SD_ENOMEMORY;
  for (int k = 0; k < 6 * ranks && status == SD_OK; k++) bricks[k] = (int) lrint(values[k]);
  if (status == SD_OK) memcpy(e->self, values + 6 * ranks + 2, sizeof(e->self));
  if (status == SD_OK) status = sd_ewald_waves_place(&e->waves, bricks);
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
  e->spheres = s->spheres;
  sd_status status = SD_OK;
  if (changed(e, s)) status = make_tables(e, s);
  e->world = s->world;
  e->waves.grid.world = s->world;
  if (!(e->ewald.count > 0.0)) return status;
  int brick[6] = {0};
  if (status == SD_OK && !all_finite(s)) status = SD_ENOTFINITE;
  if (status == SD_OK) status = sd_ewald_pairs_place(&e->pairs, &s->spheres, s->n, s->n_all);
  if (status == SD_OK &&
      !make_room(e, e->pairs.n, (size_t) e->width * (size_t) (s->n_all - s->n)))
    status = SD_ENOMEMORY;
  for (int i = 0; status == SD_OK && i < e->pairs.n; i++)
    e->sphere[i] = e->pairs.sphere[e->pairs.target[i]];
  if (status == SD_OK)
    status = sd_ewald_waves_find(&e->waves, &e->spheres, e->sphere, e->pairs.n, brick);
  return share_bricks(e, brick, status);
}

/* --- product --- */

/* Sums over all spheres of w F, b w F and w T: what is far is felt as a mean. */
static sd_status sums_of(const ewald *e, const double *F, double *sums)
{
  const long m = e->width;
  memset(sums, 0, 9 * sizeof(double));
  for (int i = 0; i < e->pairs.n; i++) {
    const long j = e->sphere[i];
    const double w = e->spheres.w[j];
    for (int d = 0; d < 3; d++) {
      sums[d] += w * F[m * j + d];
      sums[3 + d] += w * e->waves.place[i].b * F[m * j + d];
      if (m == 6) sums[6 + d] += w * F[m * j + 3 + d];
    }
  }
  return e->world.sum ? e->world.sum(e->world.ctx, sums, 9) : SD_OK;
}

/* u += w (wave part + mean of what is beyond the range, or of what the open kernel leaves out) */
static void add_waves(const ewald *e, const double *sums, double *u)
{
  const long m = e->width;
  const double V = sd_ewald_volume(&e->ewald.box), *C = e->tail;
  for (int i = 0; i < e->pairs.n; i++) {
    const long j = e->sphere[i];
    const double w = e->spheres.w[j], b = e->waves.place[i].b;
    for (int d = 0; d < 3; d++) {
      const double mean = e->waves.wave.periodic
                              ? ((C[0] - b * C[1]) * sums[d] - (C[1] - b * C[2]) * sums[3 + d]) / V
                              : e->waves.wave.uniform * sums[d];
      u[m * j + d] += w * (e->waves.F[m * i + d] + mean);
    }
    for (int d = 3; d < m; d++)
      u[m * j + d] += w * (e->waves.F[m * i + d] +
                           (e->waves.wave.periodic ? 0.25 * C[1] / V * sums[3 + d] : 0.0));
  }
}

static sd_status apply(void *state, const double *F, double *u)
{
  ewald *e = state;
  const long m = e->width;
  if (!(e->ewald.count > 0.0)) {
    memset(u, 0, sizeof(double) * (size_t) m * (size_t) e->n);
    return SD_OK;
  }
  double sums[9];
  sd_status status = sums_of(e, F, sums);
  if (status == SD_OK && e->world.refresh)
    status = e->world.refresh(e->world.ctx, F, e->ghosts, e->width);
  if (status != SD_OK) return status;
  sd_ewald_pairs_apply(&e->pairs, e->n, F, e->ghosts, u);
  status = sd_ewald_waves_apply(&e->waves, &e->spheres, F);
  if (status != SD_OK) return status;
  add_waves(e, sums, u);
  return SD_OK;
}

/* Near part of a sphere of radius a and one of its images at r [3]: diagonal [6] += */
static void add_image(const ewald *e, double a, const double *r, double *diagonal)
{
  const double R = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]), b = sd_ewald_b(&e->ewald, a);
  double M[36], D[SD_RADIALS];
  if (R > fmax(e->ewald.range, 2.0 * a)) return;
  sd_tensor_grand(r, a, a, 1.0, M);
  sd_radial(&e->ewald, R, D);
  for (int d = 0; d < 3; d++) {
    const double along = r[d] * r[d];
    diagonal[d] += M[7 * d] - (D[SD_I0] - 2.0 * b * D[SD_I1] + b * b * D[SD_I2]) -
                   along * (D[SD_J0] - 2.0 * b * D[SD_J1] + b * b * D[SD_J2]);
    diagonal[d + 3] += M[7 * (d + 3)] - 0.25 * (D[SD_I1] + along * D[SD_J1]);
  }
}

static void add_images(const ewald *e, double a, double *diagonal)
{
  const sd_ewald_box *b = &e->ewald.box;
  const double reach = fmax(e->ewald.range, 2.0 * a);
  const int nz = (int) (reach / b->edge[2]);
  for (int k = -nz; k <= nz; k++) {
    const int ny = (int) ((reach + fabs(k * b->tilt[2])) / b->edge[1]);
    for (int j = -ny; j <= ny; j++) {
      const double offset = j * b->tilt[0] + k * b->tilt[1];
      const int nx = (int) ((reach + fabs(offset)) / b->edge[0]);
      for (int i = -nx; i <= nx; i++) {
        const double r[3] = {i * b->edge[0] + offset, j * b->edge[1] + k * b->tilt[2],
                             k * b->edge[2]};
        if (i != 0 || j != 0 || k != 0) add_image(e, a, r, diagonal);
      }
    }
  }
}

/* Through its images: wave part with its own D(0) taken away, near images, and the mean of what is
 * beyond. In an open box wave part and D(0) are the same. */
static void self(const void *state, double *diagonal)
{
  const ewald *e = state;
  const long m = e->width;
  memset(diagonal, 0, sizeof(double) * (size_t) m * (size_t) e->n);
  if (!(e->ewald.count > 0.0) || !e->ewald.box.periodic) return;
  const double V = sd_ewald_volume(&e->ewald.box), *C = e->tail, *D = e->origin;
  double last = 0.0, own[6] = {0.0};
  for (int i = 0; i < e->n; i++) {
    const double a = e->spheres.a[i], w = e->spheres.w[i], b = sd_ewald_b(&e->ewald, a);
    if (!(a > 0.0)) continue;
    for (int d = 0; d < 3 && a != last; d++) {
      own[d] = e->self[0][d] - 2.0 * b * e->self[1][d] + b * b * e->self[2][d] -
               (D[SD_I0] - 2.0 * b * D[SD_I1] + b * b * D[SD_I2]) +
               (C[0] - 2.0 * b * C[1] + b * b * C[2]) / V;
      own[d + 3] = 0.25 * (e->self[1][d] - D[SD_I1] + C[1] / V);
    }
    if (a != last) add_images(e, a, own);
    last = a;
    for (int d = 0; d < m; d++) diagonal[m * i + d] = w * w * own[d];
  }
}

static void release(void *state)
{
  ewald *e = state;
  sd_ewald_pairs_free(&e->pairs);
  sd_ewald_waves_free(&e->waves);
  free(e->sphere);
  free(e->ghosts);
}

const sd_mobility_engine sd_mobility_ewald = {
    .name = "Ewald sum",
    .state = sizeof(ewald),
    .view = SD_VIEW_NEAR,
    .ghosts = ghosts,
    .place = place,
    .apply = apply,
    .self = self,
    .free = release,
};
