/* Kernels of the long waves: Z, whose rows are made anew in every product, for LANES spheres at a
 * time. exp(i k.x) = exp(i n_1 t_1) exp(i n_2 t_2) exp(i n_3 t_3), and with q = (k a)^2/6
 *   s = 1 - q + 3/10 q^2 - ... ~ 1/(1 + q + 7/10 q^2)
 *   p = 1 - 3/5 q + 9/70 q^2 - ... ~ 1/(1 + 3/5 q + 81/350 q^2)
 * which, unlike the series, stay between 0 and 1 for spheres as large as the wave. */
#include "sd_precondition_internal.h"

#include "sd_lanes.h"

enum { POWERS = 2 * SD_WAVES_MOST + 1, DIRECTIONS = 4 };

/* Some spheres: exp(i n t_d) of each, n from -harmonics on; a^2/6 and 1/sqrt(eta). Lanes to spare
 * have no eta, and so no part. */
typedef struct {
  vec cosine[3][POWERS], sine[3][POWERS], square, w;
} group;

/* exp(i n t) by one product each from exp(i t) */
INLINE void powers(vec cosine, vec sine, int harmonics, vec *c, vec *s)
{
  c[harmonics] = all(1.0);
  s[harmonics] = all(0.0);
  for (int n = 1; n <= harmonics; n++) {
    const vec last = c[harmonics + n - 1], other = s[harmonics + n - 1];
    c[harmonics + n] = c[harmonics - n] = last * cosine - other * sine;
    s[harmonics + n] = last * sine + other * cosine;
    s[harmonics - n] = -s[harmonics + n];
  }
}

/* Spheres sphere[0 ... count - 1], count <= LANES */
INLINE void look_at(const sd_waves *p, const int *sphere, int count, group *g)
{
  vec phase[6], a = all(0.0);
  g->w = all(0.0);
  for (int d = 0; d < 6; d++) phase[d] = all(d % 2 ? 0.0 : 1.0);
  for (int l = 0; l < count; l++) {
    const long i = sphere[l];
    for (int d = 0; d < 6; d++) LANE(phase[d], l) = p->phase[6 * i + d];
    LANE(a, l) = p->size[2 * i];
    LANE(g->w, l) = p->size[2 * i + 1];
  }
  g->square = a * a * all(1.0 / 6.0);
  for (int d = 0; d < 3; d++)
    powers(phase[2 * d], phase[2 * d + 1], p->harmonics, g->cosine[d], g->sine[d]);
}

/* Spheres and one pair of waves: cosine and sine of k.x; w s, and w p k/2 */
typedef struct {
  vec c, s, force, torque;
} place;

INLINE place place_of(const sd_waves *p, const group *g, int m, int width)
{
  vec c[3], s[3], torque = all(0.0);
  for (int d = 0; d < 3; d++) {
    c[d] = g->cosine[d][p->harmonics + p->list.n[d][m]];
    s[d] = g->sine[d][p->harmonics + p->list.n[d][m]];
  }
  const double k = p->list.k[m];
  const vec cxy = c[0] * c[1] - s[0] * s[1], sxy = c[0] * s[1] + s[0] * c[1];
  const vec q = all(k * k) * g->square, one = all(1.0);
  if (width == 6)
    torque = all(0.5 * k) * g->w / (one + all(0.6) * q + all(81.0 / 350.0) * (q * q));
  return (place){cxy * c[2] - sxy * s[2], cxy * s[2] + sxy * c[2],
                 g->w / (one + q + all(0.7) * q * q), torque};
}

/* The two directions across wave m */
typedef struct {
  vec e[3], g[3];
} across;

INLINE across across_of(const sd_waves *p, int m)
{
  across a;
  for (int d = 0; d < 3; d++) {
    a.e[d] = all(p->list.e[0][d][m]);
    a.g[d] = all(p->list.e[1][d][m]);
  }
  return a;
}

INLINE vec along(const vec *e, const vec *F)
{
  return e[0] * F[0] + e[1] * F[1] + e[2] * F[2];
}

/* F [width] of some spheres: y[0 ... 3][m] += Z^T F in each lane, cosines of e_1 and e_2, then
 * sines. As k x e_1 = k e_2 and k x e_2 = -k e_1, the torque gives e_1 the product of T with e_2,
 * and e_2 that with -e_1. */
INLINE void add_products(const sd_waves *p, const group *g, const vec *F, int width,
                         vec (*restrict y)[SD_WAVES_PADDED])
{
  for (int m = 0; m < SD_WAVES_MOST; m++) {
    const place a = place_of(p, g, m, width);
    const across dir = across_of(p, m);
    const vec f1 = a.force * along(dir.e, F), f2 = a.force * along(dir.g, F);
    vec t1 = all(0.0), t2 = all(0.0);
    if (width == 6) {
      t1 = a.torque * along(dir.g, F + 3);
      t2 = -a.torque * along(dir.e, F + 3);
    }
    y[0][m] += a.c * f1 - a.s * t1;
    y[1][m] += a.c * f2 - a.s * t2;
    y[2][m] += a.s * f1 + a.c * t1;
    y[3][m] += a.s * f2 + a.c * t2;
  }
}

/* u [width] = Z y */
INLINE void sum_up(const sd_waves *p, const group *g, const double *y, int width, vec *u)
{
  for (int d = 0; d < width; d++) u[d] = all(0.0);
  for (int m = 0; m < SD_WAVES_MOST; m++) {
    const place a = place_of(p, g, m, width);
    const across dir = across_of(p, m);
    vec of[DIRECTIONS];
    for (int k = 0; k < DIRECTIONS; k++) of[k] = all(y[k * SD_WAVES_PADDED + m]);
    const vec a1 = a.force * (a.c * of[0] + a.s * of[2]), a2 = a.force * (a.c * of[1] + a.s * of[3]);
    for (int d = 0; d < 3; d++) u[d] += dir.e[d] * a1 + dir.g[d] * a2;
    if (width < 6) continue;
    const vec b1 = a.torque * (a.c * of[2] - a.s * of[0]);
    const vec b2 = a.torque * (a.c * of[3] - a.s * of[1]);
    for (int d = 0; d < 3; d++) u[3 + d] += dir.g[d] * b1 - dir.e[d] * b2;
  }
}

/* The next spheres from i on; returns how many */
INLINE int next(const sd_waves *p, int i, int *sphere)
{
  const int count = p->n - i < LANES ? p->n - i : LANES;
  for (int l = 0; l < count; l++) sphere[l] = i + l;
  return count;
}

INLINE void multiply_by(const sd_waves *p, int width, const double *F, double *y)
{
  vec lanes[DIRECTIONS][SD_WAVES_PADDED], f[6];
  int sphere[LANES];
  group g;
  for (int c = 0; c < SD_WAVES_COLUMNS; c++)
    lanes[c / SD_WAVES_PADDED][c % SD_WAVES_PADDED] = all(0.0);
  for (int i = 0; i < p->n; i += LANES) {
    const int count = next(p, i, sphere);
    for (int d = 0; d < width; d++) {
      f[d] = all(0.0);
      for (int l = 0; l < count; l++) LANE(f[d], l) = F[width * (long) (i + l) + d];
    }
    look_at(p, sphere, count, &g);
    add_products(p, &g, f, width, lanes);
  }
  for (int c = 0; c < SD_WAVES_COLUMNS; c++)
    y[c] = total(lanes[c / SD_WAVES_PADDED][c % SD_WAVES_PADDED]);
}

INLINE void subtract_by(const sd_waves *p, int width, const double *y, double *F)
{
  vec u[6];
  int sphere[LANES];
  group g;
  for (int i = 0; i < p->n; i += LANES) {
    const int count = next(p, i, sphere);
    look_at(p, sphere, count, &g);
    sum_up(p, &g, y, width, u);
    for (int l = 0; l < count; l++)
      for (int d = 0; d < width; d++) F[width * (long) (i + l) + d] -= LANE(u[d], l);
  }
}

/* What comes of a unit force or torque each, in its own lane */
INLINE void rows_by(const sd_waves *p, int width, const int *sphere, int count, double *rows)
{
  for (int begin = 0; begin < count; begin += LANES) {
    const int some = count - begin < LANES ? count - begin : LANES;
    group g;
    look_at(p, sphere + begin, some, &g);
    for (int d = 0; d < width; d++) {
      vec unit[6], y[DIRECTIONS][SD_WAVES_PADDED];
      for (int k = 0; k < width; k++) unit[k] = all(k == d ? 1.0 : 0.0);
      memset(y, 0, sizeof(y));
      add_products(p, &g, unit, width, y);
      for (int l = 0; l < some; l++)
        for (int c = 0; c < SD_WAVES_COLUMNS; c++)
          rows[SD_WAVES_COLUMNS * (long) (width * (begin + l) + d) + c] =
              LANE(y[c / SD_WAVES_PADDED][c % SD_WAVES_PADDED], l);
    }
  }
}

/* The compiler is to see the loops whole for either width. */
static void waves_multiply(const sd_waves *p, const double *F, double *y)
{
  if (p->width == 3)
    multiply_by(p, 3, F, y);
  else
    multiply_by(p, 6, F, y);
}

static void waves_subtract(const sd_waves *p, const double *y, double *F)
{
  if (p->width == 3)
    subtract_by(p, 3, y, F);
  else
    subtract_by(p, 6, y, F);
}

static void waves_rows(const sd_waves *p, const int *sphere, int count, double *out)
{
  if (p->width == 3)
    rows_by(p, 3, sphere, count, out);
  else
    rows_by(p, 6, sphere, count, out);
}

const struct sd_waves_kernels SD_KERNELS(sd_waves) = {waves_multiply, waves_subtract, waves_rows};
