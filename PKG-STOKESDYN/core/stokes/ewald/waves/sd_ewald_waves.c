#include "sd_ewald_waves.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_isa.h"
#include "sd_real.h"
#include "sd_room.h"
#include "sd_whole.h"

/* Gradients of the grid's coordinates, as vectors of the box, and their products */
static void metric(sd_ewald_waves *w)
{
  const sd_ewald_box *b = &w->ewald.box;
  double (*G)[3] = w->spreading.gradient, wave[3][3];
  sd_ewald_reciprocal(b, wave);
  for (int d = 0; d < 3; d++)
    for (int c = 0; c < 3; c++)
      G[d][(c + w->turn) % 3] = b->periodic ? wave[d][c] / (2.0 * SD_PI) * w->ewald.grid[d]
          : d == c                          ? 1.0 / w->ewald.spacing
                                            : 0.0;
  static const int of[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  for (int k = 0; k < 6; k++) {
    const double *g = G[of[k][0]], *h = G[of[k][1]];
    w->spreading.metric[k] = g[0] * h[0] + g[1] * h[1] + g[2] * h[2];
  }
}

/* Three things, one a direction, in the frame that is `turn` further */
static void turn_numbers(double *v, int turn)
{
  const double old[3] = {v[0], v[1], v[2]};
  for (int d = 0; d < 3; d++) v[d] = old[(d + turn) % 3];
}

static void turn_integers(int *v, int turn)
{
  const int old[3] = {v[0], v[1], v[2]};
  for (int d = 0; d < 3; d++) v[d] = old[(d + turn) % 3];
}

/* Numbers k, k + 1, k + 2 of memory whose numbers have so many bytes */
static void turn_row(void *rows, size_t bytes, long k, int turn)
{
  double v[3];
  for (int d = 0; d < 3; d++) v[d] = sd_number(rows, bytes, k + d);
  turn_numbers(v, turn);
  for (int d = 0; d < 3; d++) sd_put_number(rows, bytes, k + d, v[d]);
}

static void turn_frame(sd_ewald_waves *w, int turn)
{
  turn_numbers(w->ewald.box.origin, turn);
  turn_numbers(w->ewald.box.edge, turn);
  turn_integers(w->ewald.grid, turn);
  w->turn = (w->turn + turn) % 3;
}

static int may_turn(const sd_ewald_box *b)
{
  return b->tilt[0] == 0.0 && b->tilt[1] == 0.0 && b->tilt[2] == 0.0;
}

/* Heights above a wall, of the planes of the first direction */
static sd_status raise_grid(sd_ewald_waves *w)
{
  const sd_ewald *e = &w->ewald;
  const sd_wall *wall = &e->images.wall;
  double *height = malloc(sizeof(double) * (size_t) e->grid[0]);
  for (int k = 0; k < e->grid[0] && height; k++)
    height[k] = wall->sign *
        (e->box.origin[0] + (k - 0.5 * e->points) * e->spacing - wall->at);
  const sd_status status = height ? sd_grid_raise(&w->grid, height) : SD_ENOMEMORY;
  free(height);
  return status;
}

/* Wave numbers n along the last direction of the frame that end within the band b, with m along the one before:
 * k has the products 2 pi m and 2 pi n with these edges p and q, so that (2 pi)^-2 k^2 is at least
 * (qq m^2 - 2 pq m n + pp n^2)/(pp qq - pq^2). */
static double waves_in_band(const sd_ewald *e, int m)
{
  const double *tilt = e->box.tilt, *edge = e->box.edge;
  const double pp = tilt[0] * tilt[0] + edge[1] * edge[1], pq = tilt[0] * tilt[1] + edge[1] * tilt[2];
  const double qq = tilt[1] * tilt[1] + tilt[2] * tilt[2] + edge[2] * edge[2];
  const double b = e->band / (2.0 * SD_PI), inside = pp * b * b - (double) m * m;
  return inside < 0.0 ? 0.0 : fmax(0.0, 1.0 + floor((pq * m + sqrt((pp * qq - pq * pq) * inside)) / pp));
}

/* Of the grid's wave numbers along z those that the sum has at y, in whole vectors of FFTW; the wave of half as many
 * as points has no partner. */
static int waves_at(const sd_ewald *e, const int *size, int y)
{
  enum { VECTOR = 4 };
  const int half = size[2] / 2 + 1;
  if (!e->box.periodic || e->slab.planes > 0) return half;
  double waves = (size[2] + 1) / 2;
  if (e->band > 0.0) waves = fmin(waves, waves_in_band(e, sd_grid_wave(y, size[1])));
  const int whole = ((int) waves + VECTOR - 1) / VECTOR * VECTOR;
  return whole < half ? whole : half;
}

/* Grid and waves of the frame */
static sd_status make_grid(sd_ewald_waves *w, const sd_world *world)
{
  const sd_ewald *e = &w->ewald;
  metric(w);
  int size[3];
  const int occupied[3] = {e->slab.planes > 0 ? e->slab.planes : e->grid[0], e->grid[1], e->grid[2]};
  for (int d = 0; d < 3; d++) size[d] = (e->box.periodic ? 1 : 2) * e->grid[d];
  int *waves = malloc(sizeof(int) * (size_t) size[1]);
  for (int y = 0; y < size[1] && waves; y++) waves[y] = waves_at(e, size, y);
  sd_status status =
      waves ? sd_grid_create(&w->grid, size, occupied, waves, w->kernels->bytes, world) : SD_ENOMEMORY;
  free(waves);
  if (status == SD_OK)
    status = sd_wave_create(&w->wave, e, w->kernels, size, w->grid.own[SD_SHARED_Y],
                            w->grid.own[SD_SHARED_Z]);
  w->grid.turn = w->turn;
  return status == SD_OK && e->images.wall.sign ? raise_grid(w) : status;
}

/* Of sd_window.h: parabolas where all spheres are alike. Slits, whose waves have few planes, keep the constant. */
static int order_of_window(const sd_ewald *e)
{
  return e->a_ref == e->largest && e->slab.planes == 0 ? 2 : 0;
}

sd_status sd_ewald_waves_create(sd_ewald_waves *w, const sd_ewald *e,
                                const struct sd_ewald_kernels *kernels, int width,
                                const sd_world *world)
{
  const int turn = e->images.wall.sign ? e->images.wall.axis
      : e->slab.planes > 0             ? e->slab.across
      : may_turn(&e->box)              ? w->turn
                                       : 0;
  sd_ewald_waves_free(w);
  w->ewald = *e;
  w->kernels = kernels;
  w->width = width;
  turn_frame(w, turn);
  sd_window_fit(e->points, e->beta, order_of_window(e), e->bend, e->tolerance, &w->window);
  return make_grid(w, world);
}

void sd_ewald_waves_free(sd_ewald_waves *w)
{
  sd_wave_free(&w->wave);
  sd_grid_free(&w->grid);
  free(w->corner);
  free(w->place);
  sd_ewald_runs_free(&w->runs);
  memset(w, 0, sizeof(*w));
}

/* --- where the box and the spheres stand on the grid --- */

void sd_ewald_waves_stand(sd_ewald_waves *w, const sd_ewald_box *box)
{
  memcpy(w->ewald.box.origin, box->origin, sizeof(box->origin));
  turn_numbers(w->ewald.box.origin, w->turn);
}

/* Coordinates in grid spacings, P/2 beyond the first point of an open box; there within the box, whose tables know no
 * larger distance, but for rounding. */
static sd_standing standing_of(const sd_ewald_waves *w)
{
  const sd_ewald_box *b = &w->ewald.box;
  sd_standing s = {.shift = b->periodic ? -0.5 * w->ewald.points : 0.0, .a_ref = w->ewald.a_ref, .equal = 1};
  for (int d = 0; d < 3; d++) {
    for (int c = 0; c < 3; c++) s.gradient[d][c] = w->spreading.gradient[d][(c + w->turn) % 3];
    const double spare = 1e-9 * b->edge[d];
    s.origin[d] = b->origin[d];
    s.lo[d] = b->periodic ? -INFINITY : b->origin[d] - spare;
    s.hi[d] = b->periodic ? INFINITY : b->origin[d] + b->edge[d] + spare;
    s.first[d] = INT_MAX;
    s.last[d] = INT_MIN;
  }
  return s;
}

static void find_places(sd_ewald_waves *w, const sd_spheres *spheres, sd_standing *s)
{
  enum { AHEAD = 12 }; /* spheres stand anywhere in memory */
  const int to[3] = {(3 - w->turn) % 3, (4 - w->turn) % 3, (5 - w->turn) % 3};
  for (int begin = 0; begin < w->n; begin += SD_STAND_MANY) {
    const int many = w->n - begin < SD_STAND_MANY ? w->n - begin : SD_STAND_MANY;
    for (int k = 0; k < many; k++) {
      const int i = begin + k;
      const long j = w->sphere[i], later = w->sphere[i + AHEAD < w->n ? i + AHEAD : i];
      sd_fetch(spheres->x + 3 * later);
      sd_fetch(spheres->a + later);
      for (int d = 0; d < 3; d++) s->x[to[d]][k] = spheres->x[3 * j + d];
      s->a[k] = spheres->a[j];
    }
    w->kernels->stand(s, many, w->corner + begin, sd_at_number(w->place, w->kernels->bytes, 4L * begin));
  }
}

/* From lo to end - 1 are the first points of their windows: where they would fill more than a period with these, all go
 * within half a period of their mean. As they are given, whatever their order: so do ranks' bricks. */
static void keep_together(sd_ewald_waves *w, const sd_standing *s, int *lo, int *end)
{
  int all = 1, begin[3];
  for (int d = 0; d < 3; d++) {
    const int period = w->ewald.grid[d];
    begin[d] = lo[d] = s->first[d];
    end[d] = s->last[d] + 1;
    if (!w->ewald.box.periodic || end[d] - lo[d] <= period) continue;
    all = 0;
    begin[d] = (int) floor((double) s->sum[d] / w->n - 0.5 * period);
    end[d] = begin[d] + period;
    lo[d] = end[d] - 1;
  }
  int last[3] = {begin[0], begin[1], begin[2]};
  for (int i = 0; i < w->n && !all; i++)
    for (int d = 0; d < 3; d++) {
      int *at = w->corner[i] + d;
      if (*at < begin[d] || *at >= end[d])
        *at -= w->ewald.grid[d] * (int) sd_whole_below((double) (*at - begin[d]) / w->ewald.grid[d]);
      lo[d] = *at < lo[d] ? *at : lo[d];
      last[d] = *at > last[d] ? *at : last[d];
    }
  for (int d = 0; d < 3 && !all; d++) end[d] = last[d] + 1;
}

sd_status sd_ewald_waves_find(sd_ewald_waves *w, const sd_spheres *s, const int *sphere, int n,
                              int *brick)
{
  memset(brick, 0, 6 * sizeof(int));
  if (!sd_reserve(&w->corner, sizeof(*w->corner), (size_t) n, &w->corner_room) ||
      !sd_reserve(&w->place, w->kernels->bytes, 4 * (size_t) n, &w->place_room))
    return SD_ENOMEMORY;
  w->sphere = sphere;
  w->n = n;
  sd_standing here = standing_of(w);
  find_places(w, s, &here);
  w->equal = here.equal;
  for (int d = 0; d < 3; d++)
    if (here.last[d] > SD_NOT_THERE) return SD_ENOTFINITE;
  int end[3] = {0};
  if (n > 0) keep_together(w, &here, brick, end);
  for (int d = 0; d < 3 && n > 0; d++) brick[3 + d] = end[d] + w->ewald.points - 1 - brick[d];
  return SD_OK;
}

/* How much further must the frame turn for slabs along which most of the bricks is at home? The first
 * direction of the box that has nearly most, so that it depends on the bricks alone. */
static int better_turn(const sd_ewald_waves *w, const int *bricks)
{
  double most = 0.0, points[3];
  if (w->grid.ranks == 1 || !may_turn(&w->ewald.box) || w->ewald.images.wall.sign ||
      w->ewald.slab.planes > 0)
    return 0;
  for (int d = 0; d < 3; d++) {
    points[d] = sd_grid_at_home(&w->grid, bricks, d);
    most = fmax(most, points[d]);
  }
  turn_numbers(points, 3 - w->turn);
  for (int d = 0; d < 3; d++)
    if (points[d] >= 0.9 * most) return (d - w->turn + 3) % 3;
  return 0;
}

/* All that is known of the frame, in one `turn` further */
static sd_status turn_by(sd_ewald_waves *w, int turn, int *bricks)
{
  const sd_world world = w->grid.world;
  for (int k = 0; k < 2 * w->grid.ranks; k++) turn_integers(bricks + 3 * k, turn);
  for (int i = 0; i < w->n; i++) {
    turn_integers(w->corner[i], turn);
    turn_row(w->place, w->kernels->bytes, 4L * i, turn);
  }
  turn_frame(w, turn);
  return make_grid(w, &world);
}

/* The grid has its bricks. */
static sd_status find_terms(sd_ewald_waves *w)
{
  const sd_grid *g = &w->grid;
  sd_spreading *s = &w->spreading;
  const double *m = s->metric;
  const int oblique = m[3] != 0.0 || m[4] != 0.0 || m[5] != 0.0;
  s->n = w->n;
  s->width = w->width;
  s->window = &w->window;
  s->terms = w->equal ? (w->width == 6 ? 3 : 1) : w->width == 6 || oblique ? 4 : 2;
  s->corner = (const int(*)[3]) w->corner;
  s->place = w->place;
  s->brick = g->brick;
  memcpy(s->lo, g->lo, sizeof(s->lo));
  s->row = g->row;
  s->layer = g->layer;
  const sd_status status = s->terms == 1 ? sd_ewald_runs_find(&w->runs, w->n, w->sphere, s->corner, w->window.points)
                                         : SD_OK;
  s->runs = s->terms == 1 ? w->runs.n : 0;
  s->run = w->runs.run;
  return status;
}

sd_status sd_ewald_waves_place(sd_ewald_waves *w, int *bricks)
{
  const int turn = better_turn(w, bricks);
  sd_status status = turn ? turn_by(w, turn, bricks) : SD_OK;
  if (status == SD_OK) status = sd_grid_place(&w->grid, bricks);
  return status == SD_OK ? find_terms(w) : status;
}

sd_status sd_ewald_waves_meet(sd_ewald_waves *w, const int *brick, sd_status status,
                              const sd_world *world)
{
  const int ranks = sd_world_ranks(world), me = sd_world_me(world);
  const int failed = 6 * ranks, many = failed + 2;
  double *values = calloc((size_t) many, sizeof(double));
  int *bricks = calloc((size_t) many, sizeof(int));
  if (!values || !bricks) status = SD_ENOMEMORY;
  for (int k = 0; k < 6 && values && status == SD_OK; k++) values[6 * me + k] = brick[k];
  if (values) {
    values[failed] = status == SD_ENOMEMORY;
    values[failed + 1] = status != SD_OK && status != SD_ENOMEMORY;
    const sd_status said = sd_world_sum(world, values, many);
    if (status == SD_OK) status = said;
  }
  if (status == SD_OK && values[failed + 1] > 0.0) status = SD_ENOTFINITE;
  if (status == SD_OK && values[failed] > 0.0) status = SD_ENOMEMORY;
  for (int k = 0; k < failed && status == SD_OK; k++) bricks[k] = (int) lrint(values[k]);
  if (status == SD_OK) status = sd_ewald_waves_place(w, bricks);
  free(values);
  free(bricks);
  return status;
}

sd_status sd_ewald_waves_place_whole(sd_ewald_waves *w)
{
  const sd_ewald *e = &w->ewald;
  const int ranks = w->grid.ranks;
  int *bricks = calloc(6 * (size_t) ranks, sizeof(int));
  if (!bricks) return SD_ENOMEMORY;
  for (int k = 0; k < ranks; k++)
    for (int d = 0; d < 3; d++)
      bricks[6 * k + 3 + d] = e->grid[d] + (e->box.periodic ? e->points - 1 : 0);
  for (int i = 0; i < w->n && e->box.periodic; i++)
    for (int d = 0; d < 3; d++) {
      int *at = w->corner[i] + d;
      *at = (*at % e->grid[d] + e->grid[d]) % e->grid[d];
    }
  const sd_status status = sd_grid_place(&w->grid, bricks);
  free(bricks);
  return status == SD_OK ? find_terms(w) : status;
}

/* --- product --- */

void sd_ewald_waves_load(const sd_ewald_waves *w, const sd_spheres *s, const double *F, void *rows)
{
  const long m = w->width;
  for (int i = 0; i < w->n; i++) {
    const long j = w->sphere[i];
    for (int d = 0; d < m; d++)
      sd_put_number(rows, w->kernels->bytes, m * i + d, s->w[j] * F[m * j + d]);
  }
}

void sd_ewald_waves_add(const sd_ewald_waves *w, const sd_spheres *s, const void *rows, double *u)
{
  const long m = w->width;
  for (int i = 0; i < w->n; i++) {
    const long j = w->sphere[i];
    for (int d = 0; d < m; d++)
      u[m * j + d] += s->w[j] * sd_number(rows, w->kernels->bytes, m * i + d);
  }
}

sd_status sd_ewald_waves_convolve(sd_ewald_waves *w, void *rows)
{
  sd_grid *g = &w->grid;
  memset(g->brick, 0, g->bytes * sd_grid_brick_numbers(g));
  w->spreading.F = rows;
  w->kernels->spread(&w->spreading);
  return sd_grid_convolve(g, sd_wave_multiply, &w->wave);
}

sd_status sd_ewald_waves_apply(sd_ewald_waves *w, void *rows)
{
  const sd_status status = sd_ewald_waves_convolve(w, rows);
  if (status == SD_OK) w->kernels->interpolate(&w->spreading);
  return status;
}

/* --- noise --- */

typedef struct {
  const sd_ewald_waves *waves;
  sd_random_key key;
} white;

/* Direction d of the frame is d + turn of the box. */
static void fill_white(void *ctx, int x, int y, int y_end, double *const *fields)
{
  const white *from = ctx;
  const sd_ewald_waves *w = from->waves;
  int size[3], at[3];
  for (int d = 0; d < 3; d++) size[(d + w->turn) % 3] = w->ewald.grid[d];
  at[w->turn] = x;
  for (int k = y; k < y_end; k++) {
    at[(1 + w->turn) % 3] = k;
    for (int z = 0; z < w->ewald.grid[2]; z++) {
      at[(2 + w->turn) % 3] = z;
      const uint64_t point = ((uint64_t) at[0] * (uint64_t) size[1] + (uint64_t) at[1]) *
              (uint64_t) size[2] + (uint64_t) at[2];
      double normals[3];
      sd_random_normals(&from->key, point, 3, normals);
      for (int d = 0; d < 3; d++) fields[d][sd_grid_number(w->ewald.grid[2], k - y, z)] = normals[d];
    }
  }
}

sd_status sd_ewald_waves_draw(sd_ewald_waves *w, const sd_random_key *key, void *rows)
{
  white from = {w, *key};
  from.key.purpose = SD_RANDOM_GRID;
  w->spreading.F = rows;
  const sd_status status =
      sd_grid_convolve_values(&w->grid, fill_white, &from, sd_wave_multiply_root, &w->wave);
  if (status == SD_OK) w->kernels->interpolate(&w->spreading);
  return status;
}
