/* Kernels of sd_columns.h. */
#include "sd_columns_internal.h"

#include "sd_lanes.h"

enum { W = SD_COLUMN_WAVES, FL = 0, FZ, FT };

/* One number a wave */
typedef struct {
  double v[W];
} lane;

/* Real and imaginary parts */
typedef struct {
  double v[2][W];
} waves;

/* Three components of a plane */
typedef struct {
  waves c[3];
} plane;

/* Moments, and what functions are multiplied with: of t1, t2, t3, t4 */
typedef struct {
  plane t[4];
} terms;

INLINE const double *number(const sd_column_group *g, int which)
{
  return g->numbers + which * W;
}

/* The fields along k, across it, and i times that across the slab */
static void load_planes(const sd_column_group *g, plane *in)
{
  const double *l1 = number(g, SD_COLUMN_L1), *l2 = number(g, SD_COLUMN_L2);
  for (int p = 0; p < g->planes; p++) {
    const double *f[3];
    for (int c = 0; c < 3; c++) f[c] = g->field[c] + p * g->plane;
    if (g->n < W) memset(in + p, 0, sizeof(plane));
    for (int m = 0; m < g->n; m++) {
      for (int part = 0; part < 2; part++) {
        const double a = f[1][2 * m + part], b = f[2][2 * m + part];
        in[p].c[FL].v[part][m] = l1[m] * a + l2[m] * b;
        in[p].c[FT].v[part][m] = l1[m] * b - l2[m] * a;
      }
      in[p].c[FZ].v[0][m] = -g->sign * f[0][2 * m + 1];
      in[p].c[FZ].v[1][m] = g->sign * f[0][2 * m];
    }
  }
}

static void store_planes(const sd_column_group *g, const plane *out)
{
  const double *l1 = number(g, SD_COLUMN_L1), *l2 = number(g, SD_COLUMN_L2);
  const double *unit = number(g, SD_COLUMN_UNIT);
  for (int p = 0; p < g->planes; p++) {
    double *f[3];
    for (int c = 0; c < 3; c++) f[c] = g->field[c] + p * g->plane;
    for (int m = 0; m < g->n; m++) {
      for (int part = 0; part < 2; part++) {
        const double l = unit[m] * out[p].c[FL].v[part][m], t = unit[m] * out[p].c[FT].v[part][m];
        f[1][2 * m + part] = l1[m] * l - l2[m] * t;
        f[2][2 * m + part] = l2[m] * l + l1[m] * t;
      }
      f[0][2 * m] = g->sign * unit[m] * out[p].c[FZ].v[1][m];
      f[0][2 * m + 1] = -g->sign * unit[m] * out[p].c[FZ].v[0][m];
    }
  }
}

/* The next plane's function; beyond 1e-250 nothing is left that counts, and tinier numbers are
 * slow. */
INLINE void step(double *restrict t, const double *restrict by)
{
  for (int m = 0; m < W; m++) t[m] = t[m] > 1e-250 ? t[m] * by[m] : 0.0;
}

/* slope [W] = k z + c, z: of plane p from below, or from above */
INLINE void slopes(const sd_column_group *g, int above, int p, double *restrict slope)
{
  const double *k = number(g, SD_COLUMN_K), *c = number(g, SD_COLUMN_SHIFT);
  const double z = above ? g->top - g->first - p * g->spacing : g->first + p * g->spacing;
  for (int m = 0; m < W; m++) slope[m] = k[m] * z + c[m];
}

/* t [W] of the first plane from below, or from above */
INLINE void first_of(const sd_column_group *g, int above, double *t)
{
  memcpy(t, number(g, above ? SD_COLUMN_T3 : SD_COLUMN_T1), sizeof(lane));
}

INLINE void add_moments(const plane *restrict f, const double *restrict t,
                        const double *restrict slope, plane *restrict first, plane *restrict second)
{
  for (int c = 0; c < 3; c++)
    for (int part = 0; part < 2; part++)
      for (int m = 0; m < W; m++) {
        const double one = t[m] * f->c[c].v[part][m];
        first->c[c].v[part][m] += one;
        second->c[c].v[part][m] += slope[m] * one;
      }
}

/* From below for t1 and t2, from above for t3 and t4 */
static void moments(const sd_column_group *g, const plane *in, terms *m)
{
  lane t, slope;
  memset(m, 0, sizeof(*m));
  for (int above = 0; above < 2; above++) {
    first_of(g, above, t.v);
    for (int q = 0; q < g->planes; q++, step(t.v, number(g, SD_COLUMN_STEP))) {
      const int p = above ? g->planes - 1 - q : q;
      slopes(g, above, p, slope.v);
      add_moments(in + p, t.v, slope.v, m->t + 2 * above, m->t + 2 * above + 1);
    }
  }
}

/* u += t1 a + t2 b */
INLINE void add_expansion(plane *restrict u, const double *restrict t, const double *restrict slope,
                          const plane *restrict a, const plane *restrict b)
{
  for (int c = 0; c < 3; c++)
    for (int part = 0; part < 2; part++)
      for (int m = 0; m < W; m++)
        u->c[c].v[part][m] += t[m] * (a->c[c].v[part][m] + slope[m] * b->c[c].v[part][m]);
}

static void expand(const sd_column_group *g, const terms *a, plane *out)
{
  lane t, slope;
  for (int above = 0; above < 2; above++) {
    first_of(g, above, t.v);
    for (int q = 0; q < g->planes; q++, step(t.v, number(g, SD_COLUMN_STEP))) {
      const int p = above ? g->planes - 1 - q : q;
      slopes(g, above, p, slope.v);
      add_expansion(out + p, t.v, slope.v, a->t + 2 * above, a->t + 2 * above + 1);
    }
  }
}

/* Of a wave: numbers of moments m[n][component] -> those of the expansion a, times 4k. Copies: a
 * sum over n != 0 of (1) of sd_slab_wave.h at distances z - z' + n Lz. */
INLINE void take_copies(double S0, double S1, double m[4][3], double a[4][3])
{
  const double Yl = S1 * m[2][FL] + S0 * m[3][FL], Yz = S1 * m[2][FZ] + S0 * m[3][FZ];
  const double Xl = S1 * m[0][FL] + S0 * m[1][FL], Xz = S1 * m[0][FZ] + S0 * m[1][FZ];
  a[0][FL] = -(S0 * m[2][FL] - Yl - Yz);
  a[0][FZ] = -(S0 * m[2][FZ] + Yz + Yl);
  a[1][FL] = S0 * (m[2][FL] + m[2][FZ]);
  a[1][FZ] = -a[1][FL];
  a[2][FL] = -(S0 * m[0][FL] - Xl + Xz);
  a[2][FZ] = -(S0 * m[0][FZ] + Xz - Xl);
  a[3][FL] = S0 * (m[0][FL] - m[0][FZ]);
  a[3][FZ] = a[3][FL];
  a[0][FT] = -2.0 * S0 * m[2][FT];
  a[2][FT] = -2.0 * S0 * m[0][FT];
  a[1][FT] = a[3][FT] = 0.0;
}

/* The flow that forces L on the walls make: below (l, z~), above (l, z~); t */
INLINE void add_walls(const double L[4], const double Lt[2], double a[4][3])
{
  a[0][FL] += L[0];
  a[0][FZ] += L[1];
  a[1][FL] -= L[0] + L[1];
  a[1][FZ] += L[0] + L[1];
  a[2][FL] += L[2];
  a[2][FZ] += L[3];
  a[3][FL] += L[3] - L[2];
  a[3][FZ] += L[3] - L[2];
  a[0][FT] += 2.0 * Lt[0];
  a[2][FT] += 2.0 * Lt[1];
}

/* 4k times the free flow at the walls, and 2k times it along t, stopped by a floor */
INLINE void stop_at_floor(double m[4][3], double a[4][3])
{
  const double L[4] = {-(m[0][FL] - m[1][FL] + m[1][FZ]), -(m[0][FZ] - m[1][FL] + m[1][FZ])};
  const double Lt[2] = {-m[0][FT]};
  add_walls(L, Lt, a);
}

INLINE void stop_in_slit(const sd_column_group *g, int w, double m[4][3], double a[4][3])
{
#define OF(n) g->numbers[(n) * W + w]
  const double v[4] = {m[0][FL] - m[1][FL] + m[1][FZ], m[0][FZ] - m[1][FL] + m[1][FZ],
                       m[2][FL] - m[3][FL] - m[3][FZ], m[2][FZ] + m[3][FL] + m[3][FZ]};
  const double even[2] = {v[0] + v[2], v[1] - v[3]}, odd[2] = {v[0] - v[2], v[1] + v[3]};
  const double *ev = &OF(SD_COLUMN_EVEN), *od = &OF(SD_COLUMN_ODD);
  const double el = 0.5 * (ev[0] * even[0] + ev[W] * even[1]);
  const double ez = 0.5 * (ev[W] * even[0] + ev[2 * W] * even[1]);
  const double ol = 0.5 * (od[0] * odd[0] + od[W] * odd[1]);
  const double oz = 0.5 * (od[W] * odd[0] + od[2 * W] * odd[1]);
  const double L[4] = {-(el + ol), -(ez + oz), ol - el, ez - oz};
  const double E = OF(SD_COLUMN_E), t = OF(SD_COLUMN_T);
  const double Lt[2] = {-t * (m[0][FT] - E * m[2][FT]), -t * (m[2][FT] - E * m[0][FT])};
  add_walls(L, Lt, a);
#undef OF
}

/* walls: a constant where this is called, so that each has its own loop */
INLINE void combine(const sd_column_group *g, int walls, const terms *from, terms *to)
{
  const double *S0 = number(g, SD_COLUMN_S0), *S1 = number(g, SD_COLUMN_S1);
  for (int part = 0; part < 2; part++)
    for (int w = 0; w < W; w++) {
      double m[4][3], a[4][3];
      for (int n = 0; n < 4; n++)
        for (int c = 0; c < 3; c++) m[n][c] = from->t[n].c[c].v[part][w];
      take_copies(S0[w], S1[w], m, a);
      if (walls == 1) stop_at_floor(m, a);
      if (walls == 2) stop_in_slit(g, w, m, a);
      for (int n = 0; n < 4; n++)
        for (int c = 0; c < 3; c++) to->t[n].c[c].v[part][w] = a[n][c];
    }
}

/* One entry of the corner: u of plane i from f of plane j; zz = z z', d = z - z'. turned: above
 * the other wall z~ points down. */
INLINE void add_entry(const double *restrict c, double zz, double d, double turned,
                      const plane *restrict f, plane *restrict u)
{
  for (int m = 0; m < W; m++) {
    const double ll = c[SD_CORNER_LL * W + m] + zz * c[SD_CORNER_ZZ_LL * W + m];
    const double both = turned * (c[SD_CORNER_LZ * W + m] + zz * c[SD_CORNER_ZZ_LZ * W + m]);
    const double one = turned * d * c[SD_CORNER_DIFFERENCE * W + m];
    const double zz_ = c[SD_CORNER_ZZ * W + m] + zz * c[SD_CORNER_ZZ_ZZ * W + m];
    for (int part = 0; part < 2; part++) {
      u->c[FL].v[part][m] += ll * f->c[FL].v[part][m] + (both + one) * f->c[FZ].v[part][m];
      u->c[FZ].v[part][m] += (both - one) * f->c[FL].v[part][m] + zz_ * f->c[FZ].v[part][m];
      u->c[FT].v[part][m] += c[SD_CORNER_T * W + m] * f->c[FT].v[part][m];
    }
  }
}

static void add_corner(const sd_column_group *g, int above, const plane *in, plane *out)
{
  const int last = g->planes - 1;
  for (int i = 0; i < g->corner_planes; i++) {
    const double zi = g->first + i * g->spacing;
    for (int j = 0; j < g->corner_planes && i + j < g->corner_sums; j++) {
      const double zj = g->first + j * g->spacing;
      add_entry(g->corner + (long) (i + j) * SD_CORNERS * W, zi * zj, zi - zj, above ? -1.0 : 1.0,
                in + (above ? last - j : j), out + (above ? last - i : i));
    }
  }
}

static void group(const sd_column_group *g)
{
  plane *in = (plane *) g->work, *out = in + g->planes;
  terms m, a;
  load_planes(g, in);
  moments(g, in, &m);
  if (g->walls == 0) combine(g, 0, &m, &a);
  if (g->walls == 1) combine(g, 1, &m, &a);
  if (g->walls == 2) combine(g, 2, &m, &a);
  memset(out, 0, sizeof(plane) * (size_t) g->planes);
  expand(g, &a, out);
  for (int w = 0; w < g->walls; w++) add_corner(g, w, in, out);
  store_planes(g, out);
}

const struct sd_columns_kernels SD_KERNELS(sd_columns) = {group};
