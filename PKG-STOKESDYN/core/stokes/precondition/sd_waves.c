#include "sd_waves.h"

#include <stdlib.h>
#include <string.h>

#include "sd_linear.h"
#include "sd_product_internal.h"

/* Part of the diagonal that is left when the long waves are taken out of it: 0.5 to 0.7 need about
 * the same iterations from phi 0.01 to 0.45. */
static const double ALPHA = 0.6;

#define INLINE static inline __attribute__((always_inline))

/* --- which waves ------------------------------------------------------------------------------ */

typedef struct {
  int n[3];
  double k[3], square;
} wave;

/* By |k|, then by n, so that every rank and every compiler takes the same of equally long ones */
static int by_length(const void *pa, const void *pb)
{
  const wave *a = pa, *b = pb;
  if (a->square != b->square) return a->square < b->square ? -1 : 1;
  for (int d = 0; d < 3; d++)
    if (a->n[d] != b->n[d]) return a->n[d] < b->n[d] ? -1 : 1;
  return 0;
}

/* 2 pi times the reciprocal edges, one after the other: each across the other two edges, so that
 * places along the edges are x.G/(2 pi). */
static void reciprocal(const sd_ewald_box *b, double G[9])
{
  const double *edge = b->edge, xy = b->tilt[0], xz = b->tilt[1], yz = b->tilt[2];
  memset(G, 0, sizeof(double) * 9);
  for (int d = 0; d < 3; d++) G[4 * d] = 2.0 * SD_PI / edge[d];
  G[1] = -G[0] * xy / edge[1];
  G[2] = -(G[0] * xz + G[1] * yz) / edge[2];
  G[5] = -G[4] * yz / edge[2];
}

/* One of each pair +-k with |k| <= radius, into out if there is one. Returns how many. An edge a
 * has n = k.a/(2 pi), so |n| is at most |k||a|/(2 pi). */
static long waves_within(const sd_ewald_box *b, const double G[9], double radius, wave *out)
{
  const double *t = b->tilt, c = radius / (2.0 * SD_PI);
  const double lengths[3] = {b->edge[0], hypot(t[0], b->edge[1]),
                             hypot(hypot(t[1], t[2]), b->edge[2])};
  const int x = (int) (c * lengths[0]), y = (int) (c * lengths[1]), z = (int) (c * lengths[2]);
  long count = 0;
  for (int l = 0; l <= x; l++)
    for (int m = l > 0 ? -y : 0; m <= y; m++)
      for (int n = l > 0 || m > 0 ? -z : 1; n <= z; n++) {
        wave w = {.n = {l, m, n}};
        for (int d = 0; d < 3; d++) w.k[d] = l * G[d] + m * G[3 + d] + n * G[6 + d];
        w.square = sd_dot(w.k, w.k);
        if (w.square > radius * radius) continue;
        if (out) out[count] = w;
        count++;
      }
  return count;
}

/* Two directions across k and one |k| make a pair of waves; the rest of the lists stays 0, and
 * waves without directions neither take nor give anything. */
int sd_wave_list_of(const sd_ewald_box *box, sd_wave_list *list)
{
  double G[9];
  int harmonics = 0;
  *list = (sd_wave_list){0};
  if (!box || !box->periodic) return 0;
  reciprocal(box, G);
  /* A cubic box has just so many pairs within 3 times its longest wave, and a ball of that size
   * holds about as many of any box; where there are fewer, it grows. */
  const double volume = sd_ewald_volume(box);
  double radius = 3.05 * 2.0 * SD_PI / cbrt(volume);
  while (waves_within(box, G, radius, NULL) < SD_WAVES_MOST) radius *= 1.1;
  wave *w = malloc(sizeof(wave) * (size_t) waves_within(box, G, radius, NULL));
  if (!w) return -1;
  qsort(w, (size_t) waves_within(box, G, radius, w), sizeof(wave), by_length);
  for (int m = 0; m < SD_WAVES_MOST; m++) {
    double e[2][3];
    const double k = sqrt(w[m].square), unit[3] = {w[m].k[0] / k, w[m].k[1] / k, w[m].k[2] / k};
    sd_across(unit, e[0]);
    sd_cross(unit, e[0], e[1]);
    list->k[m] = k;
    list->strength[m] = 2.0 / (w[m].square * volume);
    for (int d = 0; d < 3; d++) {
      list->n[d][m] = w[m].n[d];
      list->e[0][d][m] = e[0][d];
      list->e[1][d][m] = e[1][d];
      harmonics = abs(w[m].n[d]) > harmonics ? abs(w[m].n[d]) : harmonics;
    }
  }
  free(w);
  return harmonics;
}

/* --- rows of Z -------------------------------------------------------------------------------- */

/* Of one sphere, for all waves: cosine and sine of k.x; w s, and w p k/2 */
typedef struct {
  double cosine[SD_WAVES_PADDED], sine[SD_WAVES_PADDED];
  double force[SD_WAVES_PADDED], torque[SD_WAVES_PADDED];
} place;

/* exp(i n t) for |n| <= harmonics, from exp(i t), by one product each */
INLINE void powers(const double *unit, int harmonics, double *c, double *s)
{
  c[harmonics] = 1.0;
  s[harmonics] = 0.0;
  for (int n = 1; n <= harmonics; n++) {
    const double *const lc = c + harmonics + n - 1, *const ls = s + harmonics + n - 1;
    c[harmonics + n] = c[harmonics - n] = *lc * unit[0] - *ls * unit[1];
    s[harmonics + n] = *lc * unit[1] + *ls * unit[0];
    s[harmonics - n] = -s[harmonics + n];
  }
}

/* exp(i k.x) = exp(i n_1 t_1) exp(i n_2 t_2) exp(i n_3 t_3), and with q = (k a)^2/6
 *   s = 1 - q + 3/10 q^2 - ... ~ 1/(1 + q + 7/10 q^2)
 *   p = 1 - 3/5 q + 9/70 q^2 - ... ~ 1/(1 + 3/5 q + 81/350 q^2)
 * which, unlike the series, stay between 0 and 1 for spheres as large as the wave. */
INLINE void look_at(const sd_waves *p, long i, int width, place *restrict at)
{
  enum { MOST = 2 * SD_WAVES_MOST + 1 };
  const int h = p->harmonics;
  const sd_wave_list *l = &p->list;
  const double a = p->size[2 * i], w = p->size[2 * i + 1];
  double c[3][MOST], s[3][MOST];
  for (int d = 0; d < 3; d++) powers(p->phase + 6 * i + 2 * d, h, c[d], s[d]);
  for (int m = 0; m < SD_WAVES_PADDED; m++) {
    const int x = h + l->n[0][m], y = h + l->n[1][m], z = h + l->n[2][m];
    const double cxy = c[0][x] * c[1][y] - s[0][x] * s[1][y];
    const double sxy = c[0][x] * s[1][y] + s[0][x] * c[1][y];
    at->cosine[m] = cxy * c[2][z] - sxy * s[2][z];
    at->sine[m] = cxy * s[2][z] + sxy * c[2][z];
  }
  for (int m = 0; m < SD_WAVES_PADDED; m++) {
    const double q = l->k[m] * l->k[m] * (a * a / 6.0);
    at->force[m] = w / (1.0 + q + 0.7 * q * q);
    if (width == 6) at->torque[m] = 0.5 * w * l->k[m] / (1.0 + 0.6 * q + 81.0 / 350.0 * (q * q));
  }
}

/* y [4][PADDED] += Z_i^T (F T): cosines of e_1 and e_2, then sines. As k x e_1 = k e_2 and k x e_2
 * = -k e_1, the torque gives e_1 the product of T with e_2, and e_2 that with -e_1. */
INLINE void add_products(const sd_wave_list *restrict l, const place *restrict at, const double *F,
                         int width, double *restrict y)
{
  for (int m = 0; m < SD_WAVES_PADDED; m++) {
    const double ex = l->e[0][0][m], ey = l->e[0][1][m], ez = l->e[0][2][m];
    const double gx = l->e[1][0][m], gy = l->e[1][1][m], gz = l->e[1][2][m];
    const double f1 = at->force[m] * (ex * F[0] + ey * F[1] + ez * F[2]);
    const double f2 = at->force[m] * (gx * F[0] + gy * F[1] + gz * F[2]);
    double t1 = 0.0, t2 = 0.0;
    if (width == 6) {
      t1 = at->torque[m] * (gx * F[3] + gy * F[4] + gz * F[5]);
      t2 = -at->torque[m] * (ex * F[3] + ey * F[4] + ez * F[5]);
    }
    const double c = at->cosine[m], s = at->sine[m];
    y[m] += c * f1 - s * t1;
    y[SD_WAVES_PADDED + m] += c * f2 - s * t2;
    y[2 * SD_WAVES_PADDED + m] += s * f1 + c * t1;
    y[3 * SD_WAVES_PADDED + m] += s * f2 + c * t2;
  }
}

/* Sums in lanes, so that they fill a vector: the same order on every processor. */
INLINE double dot(const double *a, const double *b)
{
  double lane[8] = {0.0}, sum = 0.0;
  for (int m = 0; m < SD_WAVES_PADDED; m += 8)
    for (int l = 0; l < 8; l++) lane[l] += a[m + l] * b[m + l];
  for (int l = 0; l < 8; l++) sum += lane[l];
  return sum;
}

/* u = Z_i y */
INLINE void sum_up(const sd_wave_list *l, const place *at, const double *y, int width, double *u)
{
  const double *y1 = y, *y2 = y + SD_WAVES_PADDED, *y3 = y2 + SD_WAVES_PADDED,
               *y4 = y3 + SD_WAVES_PADDED;
  double one[SD_WAVES_PADDED], two[SD_WAVES_PADDED];
  for (int m = 0; m < SD_WAVES_PADDED; m++) {
    one[m] = at->force[m] * (at->cosine[m] * y1[m] + at->sine[m] * y3[m]);
    two[m] = at->force[m] * (at->cosine[m] * y2[m] + at->sine[m] * y4[m]);
  }
  for (int d = 0; d < 3; d++) u[d] = dot(l->e[0][d], one) + dot(l->e[1][d], two);
  if (width == 3) return;
  for (int m = 0; m < SD_WAVES_PADDED; m++) {
    one[m] = at->torque[m] * (at->cosine[m] * y3[m] - at->sine[m] * y1[m]);
    two[m] = at->torque[m] * (at->cosine[m] * y4[m] - at->sine[m] * y2[m]);
  }
  for (int d = 0; d < 3; d++) u[3 + d] = dot(l->e[1][d], one) - dot(l->e[0][d], two);
}

/* y = Z^T F, and F -= Z y, of this rank's spheres: loops that the compiler is to see whole, for
 * either width */
INLINE void multiply(const sd_waves *p, int width, const double *F, double *y)
{
  place at;
  memset(y, 0, sizeof(double) * SD_WAVES_COLUMNS);
  for (long i = 0; i < p->n; i++) {
    look_at(p, i, width, &at);
    add_products(&p->list, &at, F + width * i, width, y);
  }
}

INLINE void subtract(const sd_waves *p, int width, const double *y, double *F)
{
  place at;
  double u[6];
  for (long i = 0; i < p->n; i++) {
    look_at(p, i, width, &at);
    sum_up(&p->list, &at, y, width, u);
    for (int d = 0; d < width; d++) F[width * i + d] -= u[d];
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

/* Rows of Z of sphere i, [width][columns]: what comes of a unit force or torque each */
static void rows_of(const sd_waves *p, long i, double *rows)
{
  place at;
  look_at(p, i, p->width, &at);
  memset(rows, 0, sizeof(double) * SD_WAVES_COLUMNS * (size_t) p->width);
  for (int d = 0; d < p->width; d++) {
    double unit[6] = {0.0};
    unit[d] = 1.0;
    add_products(&p->list, &at, unit, p->width, rows + SD_WAVES_COLUMNS * d);
  }
}

/* Spheres by themselves: D^1/2 Z by so many of them, and its product with itself. With parts each
 * takes its share of them. */
static void add_lone(const sd_waves *p, int part, int parts, double *rows, double *G)
{
  enum { AT_ONCE = 32 };
  const int width = p->width;
  int count = 0;
  for (long i = part; i < p->n; i += parts) {
    if (p->near.lone[i]) {
      double *own = rows + SD_WAVES_COLUMNS * (long) (width * count++);
      rows_of(p, i, own);
      for (int d = 0; d < width; d++)
        for (int m = 0; m < SD_WAVES_COLUMNS; m++)
          own[SD_WAVES_COLUMNS * d + m] *= p->near.root[2 * i + (d >= 3)];
    }
    if (count == AT_ONCE || i + parts >= p->n) {
      sd_add_gram(SD_WAVES_COLUMNS, width * count, rows, rows, G);
      count = 0;
    }
  }
}

/* Clumps: Z and B Z of one after the other */
static void add_clumps(const sd_waves *p, double *rows, double *G)
{
  const sd_blocks *b = &p->near;
  for (int k = b->part; k < b->blocks; k += b->parts) {
    const int m = (int) (b->first[k + 1] - b->first[k]), size = p->width * m;
    double *product = rows + SD_WAVES_COLUMNS * (long) size;
    for (int l = 0; l < m; l++)
      rows_of(p, b->member[b->first[k] + l], rows + SD_WAVES_COLUMNS * (long) (p->width * l));
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

/* Spheres whose rows are in memory at once: those of the largest clump, or the 32 of add_lone */
static long largest_block(const sd_blocks *b)
{
  long largest = 32;
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
  double G[9];
  int sound = 1;
  reciprocal(c->box, G);
  p->phase = malloc(sizeof(double) * (6 * (size_t) c->n + 1));
  p->size = malloc(sizeof(double) * (2 * (size_t) c->n + 1));
  p->scratch = malloc(sizeof(double) * ((size_t) c->width * (size_t) c->n + 1));
  if (!p->phase || !p->size || !p->scratch) return SD_ENOMEMORY;
  for (long i = 0; i < c->n; i++) {
    const int active = c->spheres.a[i] > 0.0;
    double r[3] = {0.0, 0.0, 0.0};
    if (active) sd_minus(c->spheres.x + 3 * i, c->box->origin, r);
    for (int d = 0; d < 3; d++) {
      const double t = sd_dot(G + 3 * d, r);
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
  near.rho = 0.0;
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
