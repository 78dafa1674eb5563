/* Ewald sums: a near part by pairs, a wave part by FFT, and what both leave out.
 *
 *   F --spread--> grid --transform, multiply, transform--> grid --interpolate--> u
 *   F, F of ghosts --near pairs--> u
 *
 * Each rank spreads and interpolates its own spheres on a brick of the grid; slabs of it are
 * transformed by turns (sd_grid.h). */
#include "sd_mobility.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_ewald_pairs.h"
#include "sd_grid.h"
#include "sd_wave.h"

typedef struct {
  /* what the tables are made for */
  sd_ewald ewald;
  int width, ready;
  sd_world world;
  const struct sd_ewald_kernels *kernels;
  sd_window window;
  sd_wave wave;
  sd_grid grid;
  sd_ewald_pairs pairs;
  double tail[3], origin[SD_RADIALS];
  /* summed over the ranks: sd_wave.self */
  double self[3][3];
  sd_spreading spreading;
  /* [pairs.n] in order of the near part's targets; F and then u [width pairs.n] */
  sd_spread_place *place;
  double *F;
  int room;
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

/* Gradients of the grid's coordinates, and their products */
static void metric(ewald *e)
{
  const sd_ewald_box *b = &e->ewald.box;
  const double lx = b->edge[0], ly = b->edge[1], lz = b->edge[2];
  const double xy = b->tilt[0], xz = b->tilt[1], yz = b->tilt[2];
  double G[3][3] = {{1.0 / lx, -xy / (lx * ly), (xy * yz - ly * xz) / (lx * ly * lz)},
                    {0.0, 1.0 / ly, -yz / (ly * lz)},
                    {0.0, 0.0, 1.0 / lz}};
  for (int d = 0; d < 3; d++)
    for (int c = 0; c < 3; c++) {
      if (b->periodic)
        G[d][c] *= e->ewald.grid[d];
      else
        G[d][c] = d == c ? 1.0 / e->ewald.spacing : 0.0;
      e->spreading.gradient[d][c] = G[d][c];
    }
  static const int of[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  for (int k = 0; k < 6; k++) {
    const double *g = G[of[k][0]], *h = G[of[k][1]];
    e->spreading.metric[k] = g[0] * h[0] + g[1] * h[1] + g[2] * h[2];
  }
}

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
  e->kernels = sd_ewald_kernels_of(SD_ISA_BEST);
  sd_window_fit(how->points, how->beta, how->tolerance, &e->window);
  sd_ewald_pairs_create(&e->pairs, how, e->kernels, e->width);
  sd_radial_tail(how, e->tail);
  sd_radial(how, 0.0, e->origin);
  metric(e);
  int size[3];
  for (int d = 0; d < 3; d++) size[d] = (how->box.periodic ? 1 : 2) * how->grid[d];
  sd_status status = sd_grid_create(&e->grid, size, how->grid, &s->world);
  if (status == SD_OK)
    status = sd_wave_create(&e->wave, how, e->kernels, size, e->grid.y0, e->grid.y1);
  e->ready = status == SD_OK;
  return status;
}

/* Is there a splitting for which the tables are not? */
static int changed(const ewald *e, const sd_mobility_scene *s)
{
  return !e->ready || e->width != s->how.width || memcmp(&e->ewald, s->how.ewald, sizeof(sd_ewald));
}

/* --- where the spheres stand on the grid --- */

static int make_room(ewald *e, int n, size_t ghost_numbers)
{
  if (n > e->room || !e->place) {
    const size_t many = (size_t) n + (size_t) n / 8 + 8;
    free(e->place);
    free(e->F);
    e->place = malloc(sizeof(sd_spread_place) * many);
    e->F = malloc(sizeof(double) * 6 * many);
    e->room = e->place && e->F ? (int) many : 0;
    if (!e->room) return 0;
  }
  if (ghost_numbers > e->ghost_room || !e->ghosts) {
    free(e->ghosts);
    e->ghosts = malloc(sizeof(double) * (ghost_numbers + 1));
    e->ghost_room = e->ghosts ? ghost_numbers : 0;
  }
  return e->ghosts != NULL;
}

/* Coordinates in grid spacings, P/2 beyond the first point of an open box */
static void on_grid(const ewald *e, const double *x, double *s)
{
  const sd_ewald_box *b = &e->ewald.box;
  for (int d = 0; d < 3; d++) {
    s[d] = b->periodic ? 0.0 : 0.5 * e->ewald.points;
    for (int c = 0; c < 3; c++) s[d] += e->spreading.gradient[d][c] * (x[c] - b->origin[c]);
  }
}

/* Within an open box, whose tables know no larger distance; but for rounding */
static int inside(const sd_ewald_box *b, double x, int d)
{
  const double spare = 1e-9 * b->edge[d];
  return x >= b->origin[d] - spare && x <= b->origin[d] + b->edge[d] + spare;
}

/* Places of the spheres, and the brick [6] that holds their windows. In a periodic box all stand
 * within half a period of the first. 0: one is outside of an open box, or nowhere. */
static int find_places(ewald *e, int *brick)
{
  const int points = e->ewald.points;
  double near[3] = {0.0};
  int hi[3] = {0}, *lo = brick, sound = 1;
  for (int i = 0; i < e->pairs.n && sound; i++) {
    const int j = e->pairs.sphere[e->pairs.target[i]];
    double s[3];
    int at[3];
    on_grid(e, e->spheres.x + 3 * (long) j, s);
    for (int d = 0; d < 3; d++) {
      const double period = e->ewald.grid[d];
      sound = sound && fabs(s[d]) < 1e9;
      if (!sound) break;
      if (i == 0) near[d] = e->ewald.box.periodic ? s[d] - period * floor(s[d] / period) : 0.0;
      if (e->ewald.box.periodic) s[d] -= period * floor((s[d] - near[d]) / period + 0.5);
      const double first = floor(s[d] - 0.5 * points);
      at[d] = (int) first + 1;
      e->place[i].v[d] = 2.0 * (s[d] - 0.5 * points - first) - 1.0;
      if (!e->ewald.box.periodic) sound = sound && inside(&e->ewald.box, e->spheres.x[3 * (long) j + d], d);
      if (i == 0 || at[d] < lo[d]) lo[d] = at[d];
      if (i == 0 || at[d] + points > hi[d]) hi[d] = at[d] + points;
    }
    e->place[i].b = sd_ewald_b(&e->ewald, e->spheres.a[j]);
    e->place[i].at[0] = at[0], e->place[i].at[1] = at[1], e->place[i].at[2] = at[2];
  }
  for (int d = 0; d < 3; d++) brick[3 + d] = sound && e->pairs.n > 0 ? hi[d] - lo[d] : 0;
  return sound;
}

static void place_in_brick(ewald *e)
{
  const sd_grid *g = &e->grid;
  for (int i = 0; i < e->pairs.n; i++) {
    sd_spread_place *p = e->place + i;
    p->base = (p->at[0] - g->lo[0]) * g->layer + (p->at[1] - g->lo[1]) * g->row +
              3L * (p->at[2] - g->lo[2]);
  }
  sd_spreading *s = &e->spreading;
  const double *m = s->metric;
  const int oblique = m[3] != 0.0 || m[4] != 0.0 || m[5] != 0.0;
  s->n = e->pairs.n;
  s->width = e->width;
  s->window = &e->window;
  s->terms = e->width == 6 || (oblique && !e->pairs.equal) ? 4 : e->pairs.equal ? 1 : 2;
  s->place = e->place;
  s->F = e->F;
  s->brick = g->brick;
  s->row = g->row;
  s->layer = g->layer;
}

/* All bricks, by a sum over the ranks, which also carries what a sphere's images do to it, and who
 * has failed: then all fail. */
static sd_status share_bricks(ewald *e, const int *brick, sd_status status)
{
  const int ranks = e->grid.ranks, me = e->grid.me, many = 6 * ranks + 2 + 9;
  double *values = calloc((size_t) many, sizeof(double));
  int *bricks = calloc((size_t) many, sizeof(int));
  if (!values || !bricks) status = SD_ENOMEMORY;
  if (values) {
    for (int k = 0; k < 6; k++) values[6 * me + k] = status == SD_OK ? brick[k] : 0;
    values[6 * ranks] = status == SD_ENOMEMORY;
    values[6 * ranks + 1] = status != SD_OK && status != SD_ENOMEMORY;
    memcpy(values + 6 * ranks + 2, e->wave.self, sizeof(e->wave.self));
  }
  if (values && e->world.sum) {
    const sd_status said = e->world.sum(e->world.ctx, values, many);
    if (status == SD_OK) status = said;
  }
  if (status == SD_OK && values[6 * ranks + 1] > 0.0) status = SD_ENOTFINITE;
  if (status == SD_OK && values[6 * ranks] > 0.0) status = SD_ENOMEMORY;
  for (int k = 0; k < 6 * ranks && status == SD_OK; k++) bricks[k] = (int) lrint(values[k]);
  if (status == SD_OK) memcpy(e->self, values + 6 * ranks + 2, sizeof(e->self));
  if (status == SD_OK) status = sd_grid_place(&e->grid, bricks);
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
  e->grid.world = s->world;
  if (!(e->ewald.count > 0.0)) return status;
  int brick[6] = {0};
  if (status == SD_OK && !all_finite(s)) status = SD_ENOTFINITE;
  if (status == SD_OK) status = sd_ewald_pairs_place(&e->pairs, &s->spheres, s->n, s->n_all);
  if (status == SD_OK &&
      !make_room(e, e->pairs.n, (size_t) e->width * (size_t) (s->n_all - s->n)))
    status = SD_ENOMEMORY;
  if (status == SD_OK && !find_places(e, brick)) status = SD_ENOTFINITE;
  status = share_bricks(e, brick, status);
  if (status == SD_OK) place_in_brick(e);
  return status;
}

/* --- product --- */

/* Sums over all spheres of w F, b w F and w T: what is far is felt as a mean. */
static sd_status sums_of(const ewald *e, const double *F, double *sums)
{
  const long m = e->width;
  memset(sums, 0, 9 * sizeof(double));
  for (int i = 0; i < e->pairs.n; i++) {
    const long j = e->pairs.sphere[e->pairs.target[i]];
    const double w = e->spheres.w[j];
    for (int d = 0; d < 3; d++) {
      sums[d] += w * F[m * j + d];
      sums[3 + d] += w * e->place[i].b * F[m * j + d];
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
    const long j = e->pairs.sphere[e->pairs.target[i]];
    const double w = e->spheres.w[j], b = e->place[i].b;
    for (int d = 0; d < 3; d++) {
      const double mean = e->wave.periodic
                              ? ((C[0] - b * C[1]) * sums[d] - (C[1] - b * C[2]) * sums[3 + d]) / V
                              : e->wave.uniform * sums[d];
      u[m * j + d] += w * (e->F[m * i + d] + mean);
    }
    for (int d = 3; d < m; d++)
      u[m * j + d] += w * (e->F[m * i + d] +
                           (e->wave.periodic ? 0.25 * C[1] / V * sums[3 + d] : 0.0));
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
  for (int i = 0; i < e->pairs.n; i++) {
    const long j = e->pairs.sphere[e->pairs.target[i]];
    for (int d = 0; d < m; d++) e->F[m * i + d] = e->spheres.w[j] * F[m * j + d];
  }
  memset(e->grid.brick, 0, sizeof(double) * ((size_t) (e->grid.layer * e->grid.n[0]) + 16));
  e->kernels->spread(&e->spreading);
  status = sd_grid_convolve(&e->grid, sd_wave_multiply, &e->wave);
  if (status != SD_OK) return status;
  e->kernels->interpolate(&e->spreading);
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
  sd_wave_free(&e->wave);
  sd_grid_free(&e->grid);
  free(e->place);
  free(e->F);
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
