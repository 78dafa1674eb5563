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

#define EACH_PAIR(f, i) (int at = 0; at < (f)->list->count[i]; at += LANES)
#define NEXT(f, i) ((f)->list->neighbor[i] + at)
#define IS_WALL(k, wall) (long long) -(wall)[j[k]]

INLINE void film_sums(const sd_sph_film *f, double *sums, sd_sph_kernel kernel, int walls)
{
  const scales c = scales_of(f);
  for (int i = 0; i < f->list->n; i++) {
    const row4 xi = load4(f->x4 + 4 * (size_t) i);
    vec sum[8];
    for (int k = 0; k < 8; k++) sum[k] = all(0.0);
    for EACH_PAIR(f, i) {
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

INLINE void film_wet_walls(const sd_sph_film *f, const double *contact, const double *sums, double *more,
                           sd_sph_kernel kernel)
{
  const scales c = scales_of(f);
  for (int i = 0; i < f->list->n; i++) {
    if (f->wall[i] || !(sums[8 * (size_t) i + 4] > 0.0)) continue;
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
    for (int part = 0; part < 8; part += 4) add4(more + 8 * (size_t) i + part, over_lanes(sum + part));
  }
}

INLINE void film_turns(const sd_sph_film *f, const double *surface, const double *at_wall, double *rows,
                       sd_sph_kernel kernel)
{
  const scales c = scales_of(f);
  const vec zero = all(0.0);
  for (int i = 0; i < f->list->n; i++) {
    const row4 xi = load4(f->x4 + 4 * (size_t) i), ni = load4(surface + 4 * (size_t) i);
    if (!(ni[3] > 0.0)) continue;
    const row4 shown = at_wall ? load4(at_wall + 4 * (size_t) i) : (row4){0};
    vec sum[16];
    for (int k = 0; k < 16; k++) sum[k] = zero;
    for EACH_PAIR(f, i) {
      const int *j = NEXT(f, i);
      vec n[4];
      gather(surface, 4, j, n);
      if (!any(n[3] != zero)) continue;
      const meeting m = meets(f, c, xi, j, 1, kernel);
      vec g = m.g * larger(n[3], zero);
      if (shown[3] > 0.0) {
        const yes_no wall = n[3] < zero;
        g = where(wall, m.g, g);
        for (int d = 0; d < 3; d++) n[d] = where(wall, all(shown[d]), n[d]);
      }
      const vec gx = g * m.d[0], gy = g * m.d[1], gz = g * m.d[2];
      sum[0] -= gx * m.d[0];
      sum[1] -= gy * m.d[1];
      sum[2] -= gz * m.d[2];
      sum[3] -= gx * m.d[1];
      sum[4] -= gx * m.d[2];
      sum[5] -= gy * m.d[2];
      for (int d = 0; d < 3; d++) {
        const vec turn = n[d] - ni[d];
        sum[6 + 3 * d] += turn * gx;
        sum[7 + 3 * d] += turn * gy;
        sum[8 + 3 * d] += turn * gz;
      }
    }
    for (int part = 0; part < 16; part += 4) store4(rows + 16 * (size_t) i + part, over_lanes(sum + part));
  }
}

#define FIRST_OF(k, rows) (rows)[2 * (size_t) j[k]]
#define SECOND_OF(k, rows) (rows)[2 * (size_t) j[k] + 1]
INLINE void film_means(const sd_sph_film *f, const double *surface, double least, const double *carried,
                       double *rows, sd_sph_kernel kernel)
{
  const scales c = scales_of(f);
  const vec zero = all(0.0);
  for (int i = 0; i < f->list->n; i++) {
    if (!(surface[4 * (size_t) i + 3] > least)) continue;
    const row4 xi = load4(f->x4 + 4 * (size_t) i);
    vec sum = zero, whole = zero;
    for EACH_PAIR(f, i) {
      const int *j = NEXT(f, i);
      const vec v = (vec) LANEWISE(SECOND_OF, carried);
      if (!any(v != zero)) continue;
      const vec k = (vec) LANEWISE(FIRST_OF, carried);
      const vec W = meets(f, c, xi, j, 0, kernel).W * v;
      sum += W * k;
      whole += W;
    }
    rows[2 * (size_t) i] = sum_of(sum);
    rows[2 * (size_t) i + 1] = sum_of(whole);
  }
}

INLINE void film_rubs(const sd_sph_film *f, const double *surface, const double *v4, double factor, double *F,
                      sd_sph_kernel kernel)
{
  const scales c = scales_of(f);
  const vec zero = all(0.0);
  for (int i = 0; i < f->list->n; i++) {
    const row4 xi = load4(f->x4 + 4 * (size_t) i), vi = load4(v4 + 4 * (size_t) i);
    const double wi = surface[4 * (size_t) i + 3];
    if (!(wi > 0.0)) continue;
    vec sum[4] = {zero, zero, zero, zero};
    for EACH_PAIR(f, i) {
      const int *j = NEXT(f, i);
      vec n[4], v[4];
      gather(surface, 4, j, n);
      const vec w = larger(n[3], zero);
      if (!any(w != zero)) continue;
      gather(v4, 4, j, v);
      const meeting m = meets(f, c, xi, j, 1, kernel);
      vec vd = zero;
      for (int d = 0; d < 3; d++) vd += (vi[d] - v[d]) * m.d[d];
      const vec along = m.g * w * vd / larger(m.r2, all(1e-300));
      for (int d = 0; d < 3; d++) sum[d] += along * m.d[d];
    }
    const row4 total = over_lanes(sum);
    for (int d = 0; d < 3; d++) F[3 * (size_t) i + d] += factor * wi * xi[3] * total[d];
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

static void all_wet_walls(const sd_sph_film *f, const double *contact, const double *sums, double *more)
{
  BY_KERNEL(f, film_wet_walls, contact, sums, more);
}

static void all_turns(const sd_sph_film *f, const double *surface, const double *at_wall, double *rows)
{
  BY_KERNEL(f, film_turns, surface, at_wall, rows);
}

static void all_means(const sd_sph_film *f, const double *surface, double least, const double *carried,
                      double *rows)
{
  BY_KERNEL(f, film_means, surface, least, carried, rows);
}

static void all_rubs(const sd_sph_film *f, const double *surface, const double *v4, double factor, double *F)
{
  BY_KERNEL(f, film_rubs, surface, v4, factor, F);
}

const sd_sph_film_loops SD_KERNELS(sd_sph_film_loops) = {all_sums, all_wet_walls, all_turns, all_means, all_rubs};
#endif
