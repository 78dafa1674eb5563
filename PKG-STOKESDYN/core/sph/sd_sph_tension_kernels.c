/* The loops of surface tension, over lists both ways: no particle writes to another one. */
#if SD_LANES > 1 /* there are no loops in plain C */
#include "sd_sph_neighbours.h"
#include "sd_sph_tension_internal.h"

/* N / h^(d+2), N / h^d, 1 / h: one h for all */
typedef struct {
  double grad, weight, inv_h;
} scales;

INLINE scales scales_of(const sd_sph_film *f)
{
  const sd_sph_surface *s = f->surface;
  const double weight = sd_sph_norm(s->kernel, s->dimension) / (s->dimension == 3 ? s->h * s->h * s->h : s->h * s->h);
  return (scales){weight / (s->h * s->h), weight, 1.0 / s->h};
}

/* Of the next pairs: d, r^2, V_b W, V_b g; and who may be at the surface */
typedef struct {
  vec d[3], r2, W, g;
  yes_no cut;
} meeting;

INLINE meeting meets(const sd_sph_film *f, scales c, row4 xi, const int *j, sd_sph_kernel kernel)
{
  const places x = from(f->x4, j, xi);
  const vec q = smaller(root(x.r2) * c.inv_h, all(2.0)), V = larger(x.last, -x.last);
  return (meeting){.d = {x.d[0], x.d[1], x.d[2]},
                   .r2 = x.r2,
                   .W = c.weight * K(kernel, q) * V,
                   .g = c.grad * G(kernel, q) * V,
                   .cut = x.last > all(0.0)};
}

#define EACH_PAIR(f, i) (int at = 0; at < (f)->list->count[i]; at += LANES)
#define NEXT(f, i) ((f)->list->neighbor[i] + at)
/* Neighbours of who is near after row, which are fetched meanwhile: lists of all particles do not fit into caches, and
 * where some are passed over processors do not guess what comes next. */
INLINE const int *ahead_of(const sd_sph_film *f, int row)
{
  const int after = row + 1 < NEAR_COUNT(f) ? row + 1 : row;
  return f->list->neighbor[f->near ? f->near[after] : after];
}

#define IS_WALL(k, wall) (long long) -(wall)[j[k]]

COPIED void film_sums(const sd_sph_film *f, double *sums, const sd_sph_skin *skin, sd_sph_kernel kernel, int walls)
{
  const scales c = scales_of(f);
  int *last = skin->pool;
  for EACH_NEAR(f, row, i) {
    const row4 xi = load4(f->x4 + 4 * (size_t) i);
    int *begin = walls ? f->list->neighbor[i] : last;
    skin->neighbor[row] = begin;
    skin->count[row] = walls ? f->list->count[i] : 0;
    if (!walls && xi[3] < 0.0) continue;
    vec sum[8];
    for (int k = 0; k < 8; k++) sum[k] = all(0.0);
    const int *ahead = ahead_of(f, row);
    for EACH_PAIR(f, i) {
      const int *j = NEXT(f, i);
      sd_fetch(ahead + at);
      const meeting m = meets(f, c, xi, j, kernel);
      vec W = m.W, g = m.g;
      if (walls) {
        const yes_no solid = (yes_no) LANEWISE(IS_WALL, f->wall);
        const vec Ws = where(solid, W, all(0.0)), gs = where(solid, g, all(0.0));
        sum[4] += Ws;
        for (int d = 0; d < 3; d++) sum[5 + d] += gs * m.d[d];
        W -= Ws;
        g -= gs;
      } else
        last += keep(last, j, bits(m.cut));
      sum[0] += W;
      for (int d = 0; d < 3; d++) sum[1 + d] += g * m.d[d];
    }
    while (!walls && (last - begin) % LANES) *last++ = f->all;
    if (!walls) skin->count[row] = (int) (last - begin);
    store4(sums + 8 * (size_t) i, over_lanes(sum));
    store4(sums + 8 * (size_t) i + 4, walls ? over_lanes(sum + 4) : (row4){0});
  }
}

COPIED void film_wet_walls(const sd_sph_film *f, const double *contact, const sd_sph_film_rows *rows,
                           sd_sph_kernel kernel)
{
  const scales c = scales_of(f);
  for EACH_NEAR(f, row, i) {
    if (f->wall[i] || !(rows->sums[8 * (size_t) i + 4] > 0.0)) continue;
    const row4 xi = load4(f->x4 + 4 * (size_t) i);
    vec sum[8];
    for (int k = 0; k < 8; k++) sum[k] = all(0.0);
    for EACH_PAIR(f, i) {
      const int *j = NEXT(f, i);
      const meeting m = meets(f, c, xi, j, kernel);
      vec q[4];
      gather(contact, 4, j, q);
      sum[0] += q[0] * m.W;
      for (int d = 0; d < 3; d++) sum[1 + d] += q[0] * m.g * m.d[d];
      for (int d = 0; d < 3; d++) sum[4 + d] += q[1 + d] * m.W;
    }
    for (int part = 0; part < 8; part += 4) add4(rows->beside + 8 * (size_t) i + part, over_lanes(sum + part));
  }
}

/* Adds g turn d^T and - g d d^T to N and M. */
INLINE void add_turns(const vec d[3], const vec turn[3], vec g, vec *sum)
{
  const vec gx = g * d[0], gy = g * d[1], gz = g * d[2];
  sum[0] -= gx * d[0];
  sum[1] -= gy * d[1];
  sum[2] -= gz * d[2];
  sum[3] -= gx * d[1];
  sum[4] -= gx * d[2];
  sum[5] -= gy * d[2];
  for (int c = 0; c < 3; c++) {
    sum[6 + 3 * c] += turn[c] * gx;
    sum[7 + 3 * c] += turn[c] * gy;
    sum[8 + 3 * c] += turn[c] * gz;
  }
}

/* The rows of those that are not at the surface go: the skin closes up. */
COPIED void film_turns(const sd_sph_film *f, const sd_sph_film_rows *rows, const double *v4, sd_sph_skin *skin,
                       sd_sph_kernel kernel)
{
  const double *surface = rows->surface, *at_wall = rows->at_wall;
  const scales c = scales_of(f);
  const vec zero = all(0.0);
  double *weight = skin->weight, *turns = skin->turns, *own = skin->own;
  int size = 0;
  for EACH_NEAR(f, row, i) {
    const row4 ni = load4(surface + 4 * (size_t) i);
    if (!(ni[3] > 0.0)) continue;
    const row4 xi = load4(f->x4 + 4 * (size_t) i), vi = load4(v4 + 4 * (size_t) i);
    const row4 shown = at_wall ? load4(at_wall + 8 * (size_t) i) : (row4){0};
    const row4 line = at_wall ? load4(at_wall + 8 * (size_t) i + 4) : (row4){0};
    const int *neighbor = skin->neighbor[row], count = skin->count[row];
    skin->who[size] = i;
    skin->neighbor[size] = neighbor;
    skin->count[size] = count;
    skin->first[size++] = (size_t) (weight - skin->weight);
    vec sum[SD_SPH_SKIN_SUMS];
    for (int k = 0; k < SD_SPH_SKIN_SUMS; k++) sum[k] = zero;
    for (int at = 0; at < count; at += LANES, weight += LANES) {
      const int *j = neighbor + at;
      meeting m = meets(f, c, xi, j, kernel);
      vec n[4], v[4], vd = zero;
      gather(surface, 4, j, n);
      gather(v4, 4, j, v);
      const vec w = larger(n[3], zero), W = w * m.W;
      vec g = w * m.g;
      store_any(weight, W);
      sum[15] += W;
      for (int d = 0; d < 3; d++) vd += (vi[d] - v[d]) * m.d[d];
      const vec along = g * vd / larger(m.r2, all(1e-300));
      for (int d = 0; d < 3; d++) sum[16 + d] += along * m.d[d];
      const yes_no shows = n[3] < zero;
      if (shown[3] > 0.0) {
        const vec up = larger(m.d[0] * line[0] + m.d[1] * line[1] + m.d[2] * line[2], zero);
        g = where(shows, m.g * up * (1.0 / line[3]), g);
        for (int d = 0; d < 3; d++) m.d[d] = where(shows, all(line[3] * line[d]), m.d[d]);
      }
      for (int d = 0; d < 3; d++) n[d] = where(shows, all(shown[d]), n[d]) - ni[d];
      add_turns(m.d, n, g, sum);
    }
    for (int part = 0; part < SD_SPH_SKIN_SUMS; part += 4) store4(turns + part, over_lanes(sum + part));
    own[0] = ni[3] * f->surface->W0 * (xi[3] < 0.0 ? -xi[3] : xi[3]);
    own[1] = 1.0 / (turns[15] + own[0]);
    turns += SD_SPH_SKIN_SUMS;
    own += 2;
  }
  skin->size = size;
}

#define VALUE_OF(k, values) (values)[j[k]]

static void film_means(const sd_sph_skin *skin, const double *k, double *mean)
{
  for (int row = 0; row < skin->size; row++) {
    const double *weight = skin->weight + skin->first[row], *own = skin->own + 2 * (size_t) row;
    const int i = skin->who[row];
    vec sum = all(0.0);
    for (int at = 0; at < skin->count[row]; at += LANES) {
      const int *j = skin->neighbor[row] + at;
      sum += load_any(weight + at) * (vec) LANEWISE(VALUE_OF, k);
    }
    mean[i] = (sum_of(sum) + own[0] * k[i]) * own[1];
  }
}

/* Few of all neighbours show a curvature, but to pick them first is slower than to sum up zeros; with G of those whose
 * sums have waited. */
COPIED void film_inwards(const sd_sph_film *f, const sd_sph_film_rows *rows, double *mean, sd_sph_kernel kernel)
{
  const double *surface = rows->surface;
  const scales c = scales_of(f);
  const vec zero = all(0.0);
  for EACH_NEAR(f, row, i) {
    if (surface[4 * (size_t) i + 3] != 0.0) continue;
    const row4 xi = load4(f->x4 + 4 * (size_t) i);
    vec sum[4] = {zero, zero, zero, zero}, G[4] = {zero, zero, zero, zero};
    const int *ahead = ahead_of(f, row);
    for EACH_PAIR(f, i) {
      const int *j = NEXT(f, i);
      sd_fetch(ahead + at);
      const meeting m = meets(f, c, xi, j, kernel);
      vec k_w[4];
      gather(surface, 4, j, k_w);
      const vec W = m.W * larger(k_w[3], zero);
      sum[0] += W;
      sum[1] += W * k_w[0];
      for (int d = 0; d < 3; d++) G[1 + d] += m.g * m.d[d];
    }
    const row4 around = over_lanes(sum);
    if (sd_sph_sums_wait(f, i)) store4(rows->whole + 4 * (size_t) i, over_lanes(G));
    rows->whole[4 * (size_t) i] = around[0];
    mean[i] = around[0] > 1e-9 ? around[1] / around[0] : 0.0;
  }
}

#define BY_KERNEL(f, loop, ...)                                                     \
  ((f)->surface->kernel == SD_SPH_WENDLAND ? loop(f, __VA_ARGS__, SD_SPH_WENDLAND)  \
                                           : loop(f, __VA_ARGS__, SD_SPH_CUBICSPLINE))

static void sums_without_walls(const sd_sph_film *f, double *sums, const sd_sph_skin *skin, sd_sph_kernel kernel)
{
  film_sums(f, sums, skin, kernel, 0);
}

static void sums_with_walls(const sd_sph_film *f, double *sums, const sd_sph_skin *skin, sd_sph_kernel kernel)
{
  film_sums(f, sums, skin, kernel, 1);
}

static void all_sums(const sd_sph_film *f, double *sums, const sd_sph_skin *skin)
{
  if (f->wall)
    BY_KERNEL(f, sums_with_walls, sums, skin);
  else
    BY_KERNEL(f, sums_without_walls, sums, skin);
}

static void all_wet_walls(const sd_sph_film *f, const double *contact, const sd_sph_film_rows *rows)
{
  BY_KERNEL(f, film_wet_walls, contact, rows);
}

static void all_turns(const sd_sph_film *f, const sd_sph_film_rows *rows, const double *v4, sd_sph_skin *skin)
{
  BY_KERNEL(f, film_turns, rows, v4, skin);
}

static void all_inwards(const sd_sph_film *f, const sd_sph_film_rows *rows, double *mean)
{
  BY_KERNEL(f, film_inwards, rows, mean);
}

const sd_sph_film_loops SD_KERNELS(sd_sph_film_loops) = {all_sums, all_wet_walls, all_turns, film_means, all_inwards};
#endif
