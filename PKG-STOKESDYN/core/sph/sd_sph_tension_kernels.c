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

/* Of the next pairs: d, r^2, V_b W and V_b g */
typedef struct {
  vec d[3], r2, W, g;
} meeting;

INLINE meeting meets(const sd_sph_film *f, scales c, row4 xi, const int *j, int gradients, sd_sph_kernel kernel)
{
  const places x = from(f->x4, j, xi);
  meeting m = {.d = {x.d[0], x.d[1], x.d[2]}, .r2 = x.r2};
  const vec q = smaller(root(x.r2) * c.inv_h, all(2.0));
  m.W = c.weight * K(kernel, q) * x.last;
  if (gradients) m.g = c.grad * G(kernel, q) * x.last;
  return m;
}

/* Of those whose support is whole the sums are asked for only where the surface is in reach: inwards. Where there are
 * walls, sums say first who is beside one. */
INLINE int sums_wait(const sd_sph_film *f, int i)
{
  return f->inside && f->inside[i] && !f->wall;
}

#define EACH_PAIR(f, i) (int at = 0; at < (f)->list->count[i]; at += LANES)
#define NEXT(f, i) ((f)->list->neighbor[i] + at)
#define IS_WALL(k, wall) (long long) -(wall)[j[k]]

COPIED void film_sums(const sd_sph_film *f, double *sums, sd_sph_kernel kernel, int walls)
{
  const scales c = scales_of(f);
  for EACH_NEAR(f, row, i) {
    const row4 xi = load4(f->x4 + 4 * (size_t) i);
    vec sum[8];
    for (int k = 0; k < 8; k++) sum[k] = all(0.0);
    for EACH_PAIR(f, i) {
      if (!walls && sums_wait(f, i)) break;
      const int *j = NEXT(f, i);
      const meeting m = meets(f, c, xi, j, 1, kernel);
      vec W = m.W, g = m.g;
      if (walls) {
        const yes_no solid = (yes_no) LANEWISE(IS_WALL, f->wall);
        const vec Ws = where(solid, W, all(0.0)), gs = where(solid, g, all(0.0));
        sum[4] += Ws;
        for (int d = 0; d < 3; d++) sum[5 + d] += gs * m.d[d];
        W -= Ws;
        g -= gs;
      }
      sum[0] += W;
      for (int d = 0; d < 3; d++) sum[1 + d] += g * m.d[d];
    }
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
      const meeting m = meets(f, c, xi, j, 1, kernel);
      vec q[4];
      gather(contact, 4, j, q);
      sum[0] += q[0] * m.W;
      for (int d = 0; d < 3; d++) sum[1 + d] += q[0] * m.g * m.d[d];
      for (int d = 0; d < 3; d++) sum[4 + d] += q[1 + d] * m.W;
    }
    for (int part = 0; part < 8; part += 4) add4(rows->beside + 8 * (size_t) i + part, over_lanes(sum + part));
  }
}

#define WEIGHT_OF(k, surface) (surface)[4 * (size_t) j[k] + 3]
#define VALUE_OF(k, values) (values)[j[k]]

/* Of the neighbours of i those that show a normal, filled up with the far-away particle. */
INLINE int skin_of(const sd_sph_film *f, const char *shows, int i, int *skin)
{
  int count = 0;
  for EACH_PAIR(f, i) {
    const int *j = NEXT(f, i);
    unsigned hits = 0;
    for (int k = 0; k < LANES; k++) hits |= (unsigned) shows[j[k]] << k;
    if (hits) count += keep(skin + count, j, hits);
  }
  while (count % LANES) skin[count++] = f->all;
  return count;
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

COPIED void film_turns(const sd_sph_film *f, const sd_sph_film_rows *rows, const double *v4, const sd_sph_skin *skin,
                       sd_sph_kernel kernel)
{
  const double *surface = rows->surface, *at_wall = rows->at_wall;
  const scales c = scales_of(f);
  const vec zero = all(0.0);
  size_t last = 0;
  for EACH_NEAR(f, row, i) {
    const row4 xi = load4(f->x4 + 4 * (size_t) i), vi = load4(v4 + 4 * (size_t) i);
    const row4 ni = load4(surface + 4 * (size_t) i);
    skin->first[row] = last;
    if (!(ni[3] > 0.0)) continue;
    const row4 shown = at_wall ? load4(at_wall + 8 * (size_t) i) : (row4){0};
    const row4 line = at_wall ? load4(at_wall + 8 * (size_t) i + 4) : (row4){0};
    const size_t end = last + (size_t) skin_of(f, skin->shows, i, skin->neighbor + last);
    vec sum[SD_SPH_SKIN_SUMS];
    for (int k = 0; k < SD_SPH_SKIN_SUMS; k++) sum[k] = zero;
    for (; last < end; last += LANES) {
      const int *j = skin->neighbor + last;
      meeting m = meets(f, c, xi, j, 1, kernel);
      vec n[4], v[4], vd = zero;
      gather(surface, 4, j, n);
      gather(v4, 4, j, v);
      const vec w = larger(n[3], zero), W = w * m.W;
      vec g = w * m.g;
      store_any(skin->weight + last, W);
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
    for (int part = 0; part < SD_SPH_SKIN_SUMS; part += 4)
      store4(rows->turns + SD_SPH_SKIN_SUMS * (size_t) i + part, over_lanes(sum + part));
  }
  skin->first[NEAR_COUNT(f)] = last;
}

INLINE double weighed(const sd_sph_skin *skin, size_t from, size_t to, const double *k)
{
  vec sum = all(0.0);
  if (from == to) return 0.0;
  for (size_t at = from; at < to; at += LANES) {
    const int *j = skin->neighbor + at;
    sum += load_any(skin->weight + at) * (vec) LANEWISE(VALUE_OF, k);
  }
  return sum_of(sum);
}

static void film_means(const sd_sph_film *f, const sd_sph_skin *skin, const double *k, double *sums)
{
  for EACH_NEAR(f, row, i) sums[i] = weighed(skin, skin->first[row], skin->first[row + 1], k);
}

/* Few of all neighbours show a curvature, but to pick them first is slower than to sum up zeros; with G of those whose
 * sums have waited. */
COPIED void film_inwards(const sd_sph_film *f, const sd_sph_film_rows *rows, const double *k, double *mean,
                         sd_sph_kernel kernel)
{
  const double *surface = rows->surface;
  const scales c = scales_of(f);
  const vec zero = all(0.0);
  for EACH_NEAR(f, row, i) {
    if (surface[4 * (size_t) i + 3] != 0.0) continue;
    const row4 xi = load4(f->x4 + 4 * (size_t) i);
    vec sum[4] = {zero, zero, zero, zero}, G[4] = {zero, zero, zero, zero};
    for EACH_PAIR(f, i) {
      const int *j = NEXT(f, i);
      const meeting m = meets(f, c, xi, j, 1, kernel);
      const vec W = m.W * larger((vec) LANEWISE(WEIGHT_OF, surface), zero);
      sum[0] += W;
      sum[1] += W * (vec) LANEWISE(VALUE_OF, k);
      for (int d = 0; d < 3; d++) G[1 + d] += m.g * m.d[d];
    }
    if (sums_wait(f, i)) store4(rows->whole + 4 * (size_t) i, over_lanes(G));
    const row4 around = over_lanes(sum);
    rows->turns[SD_SPH_SKIN_SUMS * (size_t) i + 15] = around[0];
    mean[i] = around[0] > 1e-9 ? around[1] / around[0] : 0.0;
  }
}

#define BY_KERNEL(f, loop, ...)                                                     \
  ((f)->surface->kernel == SD_SPH_WENDLAND ? loop(f, __VA_ARGS__, SD_SPH_WENDLAND)  \
                                           : loop(f, __VA_ARGS__, SD_SPH_CUBICSPLINE))

static void sums_without_walls(const sd_sph_film *f, double *sums, sd_sph_kernel kernel)
{
  film_sums(f, sums, kernel, 0);
}

static void sums_with_walls(const sd_sph_film *f, double *sums, sd_sph_kernel kernel)
{
  film_sums(f, sums, kernel, 1);
}

static void all_sums(const sd_sph_film *f, double *sums)
{
  if (f->wall)
    BY_KERNEL(f, sums_with_walls, sums);
  else
    BY_KERNEL(f, sums_without_walls, sums);
}

static void all_wet_walls(const sd_sph_film *f, const double *contact, const sd_sph_film_rows *rows)
{
  BY_KERNEL(f, film_wet_walls, contact, rows);
}

static void all_turns(const sd_sph_film *f, const sd_sph_film_rows *rows, const double *v4, const sd_sph_skin *skin)
{
  BY_KERNEL(f, film_turns, rows, v4, skin);
}

static void all_inwards(const sd_sph_film *f, const sd_sph_film_rows *rows, const double *k, double *mean)
{
  BY_KERNEL(f, film_inwards, rows, k, mean);
}

const sd_sph_film_loops SD_KERNELS(sd_sph_film_loops) = {all_sums, all_wet_walls, all_turns, film_means, all_inwards};
#endif
