#include "sd_waves.h"

#include <stdlib.h>
#include <string.h>

#include "sd_linear.h"
#include "sd_isa.h"

/* Part of the diagonal that is left when the long waves are taken out of it: 0.5 to 0.7 need about
 * the same iterations from phi 0.01 to 0.45. */
static const double ALPHA = 0.6;

#define INLINE static inline __attribute__((always_inline))

/* --- rows of Z --------------------------------------------------------------------------------
 *
 * Spheres are taken LANES at a time, and the loops over lanes are what the compiler makes vectors
 * of. exp(i k.x) = exp(i n_1 t_1) exp(i n_2 t_2) exp(i n_3 t_3), and with q = (k a)^2/6
 *   s = 1 - q + 3/10 q^2 - ... ~ 1/(1 + q + 7/10 q^2)
 *   p = 1 - 3/5 q + 9/70 q^2 - ... ~ 1/(1 + 3/5 q + 81/350 q^2)
 * which, unlike the series, stay between 0 and 1 for spheres as large as the wave. */

enum { LANES = 8, POWERS = 2 * SD_WAVES_MOST + 1 };

/* Some spheres: exp(i n t_d) of each, n from -harmonics on; a^2/6 and 1/sqrt(eta). Lanes to spare
 * have no eta, and so no part. */
typedef struct {
  double cosine[3][POWERS][LANES], sine[3][POWERS][LANES];
  double square[LANES], w[LANES];
} group;

/* exp(i n t) by one product each from exp(i t) */
INLINE void powers(const double *unit, int harmonics, int lane, double (*c)[LANES],
                   double (*s)[LANES])
{
  c[harmonics][lane] = 1.0;
  s[harmonics][lane] = 0.0;
  for (int n = 1; n <= harmonics; n++) {
    const double last = c[harmonics + n - 1][lane], other = s[harmonics + n - 1][lane];
    c[harmonics + n][lane] = c[harmonics - n][lane] = last * unit[0] - other * unit[1];
    s[harmonics + n][lane] = last * unit[1] + other * unit[0];
    s[harmonics - n][lane] = -s[harmonics + n][lane];
  }
}

/* Spheres sphere[0 ... count - 1], count <= LANES */
INLINE void look_at(const sd_waves *p, const int *sphere, int count, group *g)
{
  static const double still[2] = {1.0, 0.0};
  for (int l = 0; l < LANES; l++) {
    const long i = l < count ? sphere[l] : -1;
    for (int d = 0; d < 3; d++)
      powers(i < 0 ? still : p->phase + 6 * i + 2 * d, p->harmonics, l, g->cosine[d], g->sine[d]);
    g->square[l] = i < 0 ? 0.0 : p->size[2 * i] * p->size[2 * i] / 6.0;
    g->w[l] = i < 0 ? 0.0 : p->size[2 * i + 1];
  }
}

/* One pair of waves at a group: rows of its powers, k^2 */
typedef struct {
  const double *cosine[3], *sine[3];
  double square, k;
} seen;

INLINE seen see(const sd_waves *p, const group *g, int m)
{
  seen v = {.k = p->list.k[m], .square = p->list.k[m] * p->list.k[m]};
  for (int d = 0; d < 3; d++) {
    v.cosine[d] = g->cosine[d][p->harmonics + p->list.n[d][m]];
    v.sine[d] = g->sine[d][p->harmonics + p->list.n[d][m]];
  }
  return v;
}

/* Of one sphere and one pair of waves: cosine and sine of k.x; w s, and w p k/2 */
typedef struct {
  double c, s, force, torque;
} place;

INLINE place place_of(const seen *v, const group *g, int l, int width)
{
  const double cxy = v->cosine[0][l] * v->cosine[1][l] - v->sine[0][l] * v->sine[1][l];
  const double sxy = v->cosine[0][l] * v->sine[1][l] + v->sine[0][l] * v->cosine[1][l];
  const double q = v->square * g->square[l], w = g->w[l];
  return (place){.c = cxy * v->cosine[2][l] - sxy * v->sine[2][l],
                 .s = cxy * v->sine[2][l] + sxy * v->cosine[2][l],
                 .force = w / (1.0 + q + 0.7 * q * q),
                 .torque = width == 6 ? 0.5 * w * v->k / (1.0 + 0.6 * q + 81.0 / 350.0 * (q * q))
                                      : 0.0};
}

/* F [6][LANES] of some spheres: y[0 ... 3][m] += Z^T F in each lane, cosines of e_1 and e_2, then
 * sines. As k x e_1 = k e_2 and k x e_2 = -k e_1, the torque gives e_1 the product of T with e_2,
 * and e_2 that with -e_1. */
INLINE void add_products(const sd_waves *p, const group *g, const double (*F)[LANES], int width,
                         double (*restrict y)[SD_WAVES_PADDED][LANES])
{
  for (int m = 0; m < SD_WAVES_MOST; m++) {
    const seen v = see(p, g, m);
    const double ex = p->list.e[0][0][m], ey = p->list.e[0][1][m], ez = p->list.e[0][2][m];
    const double gx = p->list.e[1][0][m], gy = p->list.e[1][1][m], gz = p->list.e[1][2][m];
    double *restrict y1 = y[0][m], *restrict y2 = y[1][m], *restrict y3 = y[2][m],
                     *restrict y4 = y[3][m];
    for (int l = 0; l < LANES; l++) {
      const place a = place_of(&v, g, l, width);
      const double f1 = a.force * (ex * F[0][l] + ey * F[1][l] + ez * F[2][l]);
      const double f2 = a.force * (gx * F[0][l] + gy * F[1][l] + gz * F[2][l]);
      double t1 = 0.0, t2 = 0.0;
      if (width == 6) {
        t1 = a.torque * (gx * F[3][l] + gy * F[4][l] + gz * F[5][l]);
        t2 = -a.torque * (ex * F[3][l] + ey * F[4][l] + ez * F[5][l]);
      }
      y1[l] += a.c * f1 - a.s * t1;
      y2[l] += a.c * f2 - a.s * t2;
      y3[l] += a.s * f1 + a.c * t1;
      y4[l] += a.s * f2 + a.c * t2;
    }
  }
}

/* u [6][LANES] = Z y */
INLINE void sum_up(const sd_waves *p, const group *g, const double *y, int width,
                   double (*restrict u)[LANES])
{
  memset(u, 0, sizeof(double) * 6 * LANES);
  for (int m = 0; m < SD_WAVES_MOST; m++) {
    const seen v = see(p, g, m);
    const double ex = p->list.e[0][0][m], ey = p->list.e[0][1][m], ez = p->list.e[0][2][m];
    const double gx = p->list.e[1][0][m], gy = p->list.e[1][1][m], gz = p->list.e[1][2][m];
    const double y1 = y[m], y2 = y[SD_WAVES_PADDED + m], y3 = y[2 * SD_WAVES_PADDED + m],
                 y4 = y[3 * SD_WAVES_PADDED + m];
    for (int l = 0; l < LANES; l++) {
      const place a = place_of(&v, g, l, width);
      const double a1 = a.force * (a.c * y1 + a.s * y3), a2 = a.force * (a.c * y2 + a.s * y4);
      u[0][l] += ex * a1 + gx * a2;
      u[1][l] += ey * a1 + gy * a2;
      u[2][l] += ez * a1 + gz * a2;
      if (width == 6) {
        const double b1 = a.torque * (a.c * y3 - a.s * y1), b2 = a.torque * (a.c * y4 - a.s * y2);
        u[3][l] += gx * b1 - ex * b2;
        u[4][l] += gy * b1 - ey * b2;
        u[5][l] += gz * b1 - ez * b2;
      }
    }
  }
}

/* y = Z^T F, and F -= Z y, of this rank's spheres: loops that the compiler is to see whole, for
 * either width */
INLINE void multiply(const sd_waves *p, int width, const double *F, double *y)
{
  double lanes[4][SD_WAVES_PADDED][LANES] = {{{0.0}}}, f[6][LANES];
  int sphere[LANES];
  group g;
  for (int i = 0; i < p->n; i += LANES) {
    const int count = p->n - i < LANES ? p->n - i : LANES;
    for (int l = 0; l < LANES; l++) {
      sphere[l] = i + l;
      for (int d = 0; d < width; d++) f[d][l] = l < count ? F[width * (long) (i + l) + d] : 0.0;
    }
    look_at(p, sphere, count, &g);
    add_products(p, &g, f, width, lanes);
  }
  for (int c = 0; c < SD_WAVES_COLUMNS; c++) {
    y[c] = 0.0;
    for (int l = 0; l < LANES; l++) y[c] += lanes[c / SD_WAVES_PADDED][c % SD_WAVES_PADDED][l];
  }
}

INLINE void subtract(const sd_waves *p, int width, const double *y, double *F)
{
  double u[6][LANES];
  int sphere[LANES];
  group g;
  for (int i = 0; i < p->n; i += LANES) {
    const int count = p->n - i < LANES ? p->n - i : LANES;
    for (int l = 0; l < LANES; l++) sphere[l] = i + l;
    look_at(p, sphere, count, &g);
    sum_up(p, &g, y, width, u);
    for (int l = 0; l < count; l++)
      for (int d = 0; d < width; d++) F[width * (long) (i + l) + d] -= u[d][l];
  }
}

INLINE void multiply_any(const sd_waves *p, const double *F, double *y)
{
  if (p->width == 3)
    multiply(p, 3, F, y);
  else
    multiply(p, 6, F, y);
}

INLINE void subtract_any(const sd_waves *p, const double *y, double *F)
{
  if (p->width == 3)
    subtract(p, 3, y, F);
  else
    subtract(p, 6, y, F);
}

#if defined(SD_HAS_X86_KERNELS)
__attribute__((target("avx2,fma"))) static void multiply_avx2(const sd_waves *p, const double *F,
                                                              double *y)
{
  multiply_any(p, F, y);
}

__attribute__((target("avx2,fma"))) static void subtract_avx2(const sd_waves *p, const double *y,
                                                              double *F)
{
  subtract_any(p, y, F);
}
#endif

static void waves_of_forces(const sd_waves *p, const double *F, double *y)
{
#if defined(SD_HAS_X86_KERNELS)
  if (sd_isa_supported(SD_ISA_AVX2)) return multiply_avx2(p, F, y);
#endif
  multiply_any(p, F, y);
}

static void take_waves_from(const sd_waves *p, const double *y, double *F)
{
#if defined(SD_HAS_X86_KERNELS)
  if (sd_isa_supported(SD_ISA_AVX2)) return subtract_avx2(p, y, F);
#endif
  subtract_any(p, y, F);
}

/* --- G ---------------------------------------------------------------------------------------- */

/* Spheres whose rows are in memory at once, if there are no larger clumps */
enum { AT_ONCE = 32 };

/* Rows of Z of some spheres, [width count][columns]: what comes of a unit force or torque each, in
 * its own lane */
static void rows_of(const sd_waves *p, const int *sphere, int count, double *rows)
{
  const int width = p->width;
  for (int begin = 0; begin < count; begin += LANES) {
    const int some = count - begin < LANES ? count - begin : LANES;
    group g;
    look_at(p, sphere + begin, some, &g);
    for (int d = 0; d < width; d++) {
      double unit[6][LANES] = {{0.0}}, y[4][SD_WAVES_PADDED][LANES] = {{{0.0}}};
      for (int l = 0; l < LANES; l++) unit[d][l] = 1.0;
      if (width == 3)
        add_products(p, &g, unit, 3, y);
      else
        add_products(p, &g, unit, 6, y);
      for (int l = 0; l < some; l++)
        for (int c = 0; c < SD_WAVES_COLUMNS; c++)
          rows[SD_WAVES_COLUMNS * (long) (width * (begin + l) + d) + c] =
              y[c / SD_WAVES_PADDED][c % SD_WAVES_PADDED][l];
    }
  }
}

/* Spheres by themselves: D^1/2 Z of so many of them, and its product with itself. With parts each
 * takes its share of them. */
static void add_lone(const sd_waves *p, int part, int parts, double *rows, double *G)
{
  const int width = p->width;
  int sphere[AT_ONCE], count = 0;
  for (long i = part; i < p->n; i += parts) {
    if (p->near.lone[i]) sphere[count++] = (int) i;
    if (count < AT_ONCE && i + parts < p->n) continue;
    rows_of(p, sphere, count, rows);
    for (int r = 0; r < width * count; r++)
      for (int c = 0; c < SD_WAVES_COLUMNS; c++)
        rows[SD_WAVES_COLUMNS * (long) r + c] *=
            p->near.root[2 * (long) sphere[r / width] + (r % width >= 3)];
    sd_add_gram(SD_WAVES_COLUMNS, width * count, rows, rows, G);
    count = 0;
  }
}

/* Clumps: Z and B Z of one after the other */
static void add_clumps(const sd_waves *p, double *rows, double *G)
{
  const sd_blocks *b = &p->near;
  for (int k = b->part; k < b->blocks; k += b->parts) {
    const int m = (int) (b->first[k + 1] - b->first[k]), size = p->width * m;
    double *product = rows + SD_WAVES_COLUMNS * (long) size;
    rows_of(p, b->member + b->first[k], m, rows);
    sd_blocks_multiply(b, k, SD_WAVES_COLUMNS, rows, product);
    sd_add_gram(SD_WAVES_COLUMNS, size, rows, product, G);
  }
}

/* Columns that only fill up get unity. A viscosity has gone into D and w alike: B Z is theirs. */
static void add_strengths(const sd_waves *p, double *G)
{
  for (int c = 0; c < SD_WAVES_COLUMNS; c++) {
    const double E = p->list.strength[c % SD_WAVES_PADDED];
    G[(SD_WAVES_COLUMNS + 1) * (long) c] += E > 0.0 ? ALPHA / E : 1.0;
  }
}

static long largest_block(const sd_blocks *b)
{
  long largest = AT_ONCE;
  for (int k = 0; k < b->blocks; k++)
    if (b->first[k + 1] - b->first[k] > largest) largest = b->first[k + 1] - b->first[k];
  return largest;
}

/* G of all ranks on each of them, and its factor there: the sums have the same bits everywhere, so
 * the factors have too. */
static sd_status factorize(sd_waves *p, const sd_precondition_case *c)
{
  const size_t matrix = (size_t) SD_WAVES_COLUMNS * SD_WAVES_COLUMNS;
  const size_t rows = (size_t) p->width * (size_t) largest_block(&p->near);
  double *row = malloc(sizeof(double) * 2 * SD_WAVES_COLUMNS * rows);
  p->factor = calloc(matrix, sizeof(double));
  sd_status status = sd_precondition_agree(c, row && p->factor ? SD_OK : SD_ENOMEMORY);
  if (status == SD_OK) {
    add_lone(p, c->part, c->parts, row, p->factor);
    add_clumps(p, row, p->factor);
    if (c->sum) status = c->sum(c->sum_ctx, p->factor, (int) matrix);
  }
  if (status == SD_OK) {
    add_strengths(p, p->factor);
    status = sd_cholesky(SD_WAVES_COLUMNS, p->factor);
  }
  free(row);
  return status;
}

/* --- the preconditioner ----------------------------------------------------------------------- */

/* Places along the edges, as phases */
static sd_status set_places(sd_waves *p, const sd_precondition_case *c)
{
  double G[3][3];
  int sound = 1;
  sd_ewald_reciprocal(c->box, G);
  p->phase = malloc(sizeof(double) * (6 * (size_t) c->n + 1));
  p->size = malloc(sizeof(double) * (2 * (size_t) c->n + 1));
  p->scratch = malloc(sizeof(double) * ((size_t) c->width * (size_t) c->n + 1));
  if (!p->phase || !p->size || !p->scratch) return SD_ENOMEMORY;
  for (long i = 0; i < c->n; i++) {
    const int active = c->spheres.a[i] > 0.0;
    double r[3] = {0.0, 0.0, 0.0};
    if (active) sd_minus(c->spheres.x + 3 * i, c->box->origin, r);
    for (int d = 0; d < 3; d++) {
      const double t = sd_dot(G[d], r);
      sound = sound && isfinite(t);
      p->phase[6 * i + 2 * d] = cos(t);
      p->phase[6 * i + 2 * d + 1] = sin(t);
    }
    p->size[2 * i] = active ? c->spheres.a[i] : 0.0;
    p->size[2 * i + 1] = active ? c->spheres.w[i] : 0.0;
  }
  return sound ? SD_OK : SD_ENOTFINITE;
}

/* Ranks agree before every step that sums, so that none waits for one that has given up. */
sd_status sd_waves_make(sd_waves *p, const sd_precondition_case *c)
{
  static const long none[1] = {0};
  sd_precondition_case near = *c;
  if (c->clumps == 0) near.first = none;
  p->n = c->n;
  p->width = c->width;
  p->sum = c->sum;
  p->sum_ctx = c->sum_ctx;
  p->harmonics = sd_wave_list_of(c->box, &p->list);
  sd_status status = p->harmonics < 0 ? SD_ENOMEMORY : SD_OK;
  if (status == SD_OK && p->harmonics > 0) status = set_places(p, c);
  status = sd_precondition_agree(c, status);
  if (status == SD_OK) status = sd_blocks_make(&p->near, &near);
  if (status == SD_OK && p->harmonics > 0) status = factorize(p, c);
  if (status != SD_OK) sd_waves_free(p);
  return status;
}

void sd_waves_free(sd_waves *p)
{
  sd_blocks_free(&p->near);
  free(p->phase);
  free(p->size);
  free(p->factor);
  free(p->scratch);
  *p = (sd_waves){0};
}

/* B Z y = B (Z y), so P r = B (r - Z G^-1 Z^T B r)/alpha: twice B, once forth and once back through
 * Z. With parts B r is a share, and so is Z^T B r, which is summed; the second B makes a share of
 * what is then the same in all parts. */
sd_status sd_waves_apply(void *ctx, const double *r, double *z)
{
  sd_waves *p = ctx;
  const long size = (long) p->width * p->n;
  double y[SD_WAVES_COLUMNS];
  sd_status status = sd_blocks_apply(&p->near, r, z);
  if (status != SD_OK || p->harmonics == 0) return status;
  waves_of_forces(p, z, y);
  if (p->sum) status = p->sum(p->sum_ctx, y, SD_WAVES_COLUMNS);
  if (status != SD_OK) return status;
  sd_cholesky_apply(SD_WAVES_COLUMNS, p->factor, 1, y);
  memcpy(p->scratch, r, sizeof(double) * (size_t) size);
  take_waves_from(p, y, p->scratch);
  status = sd_blocks_apply(&p->near, p->scratch, z);
  for (long j = 0; j < size; j++) z[j] /= ALPHA;
  return status;
}
