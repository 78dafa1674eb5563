#include "sd_padded.h"

#include <fftw3.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_lagrange.h"
#include "sd_padded_lines.h"
#include "sd_window.h"

/* What is shared depends on the distance alone and has no wave beyond that of the grid: it is sampled at so
 * many distances in a spacing, and polynomials go through so many of these. */
enum { FINER = 8, NODES = 12 };

/* Three directions: n points of the large grid, of which m from `first` on are of the transform's;
 * periods of the transforms in points. A direction that is even or odd has half of each. */
typedef struct {
  const sd_padded *k;
  int n[3], m[3], first[3], n_period[3], m_period[3];
  double *taper[3], *inverse[3];
  /* of lines of n and of m numbers; NULL: across */
  sd_padded_lines *n_lines[3], *m_lines[3];
  /* what is shared at equal steps of the distance, [SD_PADDED_NUMBERS] each; of sd_lagrange.h */
  double *radial, lagrange[NODES];
  /* [n][SD_PADDED_NUMBERS]; one kernel [n]; the same of the transform's grid [m] */
  double *number, *field, *kept;
} workspace;

/* --- in space --- */

/* Points that the large grid has beyond the offsets wanted, each way, for windows of so many. Wide
 * windows blow up more of what the taper has at short waves. With these the error is that of the
 * rest from 1e-2 to 1e-13; a quarter fewer cost one to two digits. */
static int points_beyond(int points)
{
  return points > 5 ? 4 * points + 4 : 24;
}

/* So many points beyond what is wanted, of `many`: 1 up to a fifth of the way, then smoothly to 0
 * at the end, where the transform's next period begins */
static double taper(int beyond, int many)
{
  const double z = (beyond - 0.2 * many) / (0.8 * many);
  return z <= 0.0 ? 1.0 : 0.5 * erfc(6.0 * (2.0 * z - 1.0));
}

static void offset(const workspace *s, int x, int y, int z, double R[3])
{
  const double h = s->k->ewald->spacing;
  R[0] = s->k->start + (x - s->first[0]) * h;
  R[1] = y * h;
  R[2] = z * h;
}

/* The first is half a polynomial before distance 0, where all is as it is behind it. */
static int tabulate(workspace *s)
{
  const sd_padded *k = s->k;
  const double h = k->ewald->spacing;
  double R[3];
  offset(s, s->n[0], s->n[1], s->n[2], R);
  R[0] = fmax(fabs(R[0]), fabs(k->start) + s->n[0] * h);
  const double most = sqrt(R[0] * R[0] + R[1] * R[1] + R[2] * R[2]);
  const long many = (long) ceil(most / h * FINER) + NODES;
  s->radial = calloc((size_t) many * SD_PADDED_NUMBERS, sizeof(double));
  for (long m = 0; m < many && s->radial; m++)
    k->numbers(k->ewald, fabs((double) (m + 1 - NODES / 2)) * h / FINER, s->radial + m * SD_PADDED_NUMBERS);
  sd_lagrange_inverse(NODES, s->lagrange);
  return s->radial != NULL;
}

static void numbers_at(const workspace *s, double distance, double *number)
{
  const double at = distance / s->k->ewald->spacing * FINER;
  const long first = (long) at;
  const double *from = s->radial + first * SD_PADDED_NUMBERS;
  double weight[NODES];
  sd_lagrange(at - (double) first + NODES / 2 - 1, NODES, s->lagrange, weight);
  for (int m = 0; m < NODES; m++)
    for (int p = 0; p < SD_PADDED_NUMBERS; p++) number[p] += weight[m] * from[m * SD_PADDED_NUMBERS + p];
}

static void sample(workspace *s)
{
  double *out = s->number, R[3];
  for (int x = 0; x < s->n[0]; x++)
    for (int y = 0; y < s->n[1]; y++)
      for (int z = 0; z < s->n[2]; z++, out += SD_PADDED_NUMBERS) {
        const double weight = s->taper[0][x] * s->taper[1][y] * s->taper[2][z];
        memset(out, 0, SD_PADDED_NUMBERS * sizeof(double));
        if (!(weight > 1e-17)) continue;
        offset(s, x, y, z, R);
        numbers_at(s, sqrt(R[0] * R[0] + R[1] * R[1] + R[2] * R[2]), out);
        for (int p = 0; p < SD_PADDED_NUMBERS; p++) out[p] *= weight;
      }
}

static void pa_fill(const workspace *s, int kernel)
{
  const sd_padded *k = s->k;
  const double *number = s->number;
  double *out = s->field, R[3];
  for (int x = 0; x < s->n[0]; x++)
    for (int y = 0; y < s->n[1]; y++)
      for (int z = 0; z < s->n[2]; z++, number += SD_PADDED_NUMBERS) {
        offset(s, x, y, z, R);
        *out++ = k->value(k->ewald, kernel, number, R);
      }
}

/* --- transforms --- */

/* Of all lines of the direction across */
static int transform_across(const int *n, int back, double *field)
{
  const int plane = n[1] * n[2];
  const fftw_iodim line = {n[0], plane, plane}, lines = {plane, 1, 1};
  const fftw_r2r_kind kind = back ? FFTW_HC2R : FFTW_R2HC;
  fftw_plan plan = fftw_plan_guru_r2r(1, &line, 1, &lines, field, field, &kind, FFTW_ESTIMATE);
  if (!plan) return 0;
  fftw_execute(plan);
  fftw_destroy_plan(plan);
  return 1;
}

/* In place, of all lines; back from waves of the large grid, of those that lead to offsets which are kept */
static int transform(const workspace *s, int kernel, double *field, const int *n, sd_padded_lines *const lines[3],
                     int back)
{
  int from[3] = {0, 0, 0}, end[3] = {n[0], n[1], n[2]};
  for (int d = 0; d < 3; d++) {
    if (lines[d]) sd_padded_lines_apply(lines[d], s->k->odd[kernel][d], d, n, from, end, field);
    else if (!transform_across(n, back, field)) return 0;
    if (!back) continue;
    from[d] = s->first[d];
    end[d] = s->first[d] + s->m[d] - 1;
  }
  return 1;
}

/* Wave number of a place of a transform; across it is FFTW's half-complex list */
static int wave_of(int l, int period)
{
  return l <= period / 2 ? l : period - l;
}

/* The windows are taken out of the transform, once for spreading and once for interpolation. Where
 * the filter is nothing there are only rounding errors, which that would blow up. */
static void deconvolve(const workspace *s)
{
  const double most = s->k->last * s->k->last;
  double *field = s->field, unit[3], all = 1.0;
  for (int d = 0; d < 3; d++) {
    unit[d] = 2.0 * SD_PI / (s->n_period[d] * s->k->ewald->spacing);
    all *= s->n_period[d];
  }
  for (int l = 0; l < s->n[0]; l++)
    for (int y = 0; y < s->n[1]; y++) {
      const int x = wave_of(l, s->n_period[0]);
      const double across = pow(x * unit[0], 2) + pow(y * unit[1], 2);
      const double wxy = s->inverse[0][x] * s->inverse[1][y];
      for (int z = 0; z < s->n[2]; z++) {
        const double w = wxy * s->inverse[2][z], k = z * unit[2];
        *field++ *= across + k * k < most ? w * w / all : 0.0;
      }
    }
}

/* The offsets that are wanted go to the grid of the transform. The last of each direction, which no
 * two points within the box have, stay 0. */
static void keep(const workspace *s)
{
  const int *n = s->n, *m = s->m;
  memset(s->kept, 0, sizeof(double) * (size_t) m[0] * (size_t) m[1] * (size_t) m[2]);
  for (int x = 0; x < m[0] - 1; x++)
    for (int y = 0; y < m[1] - 1; y++)
      memcpy(s->kept + ((long) x * m[1] + y) * m[2],
             s->field + ((long) (x + s->first[0]) * n[1] + y) * n[2],
             sizeof(double) * (size_t) (m[2] - 1));
}

static void pa_store(const workspace *s, int kernel, const int *y, const int *z, double *table)
{
  const int *m = s->m, half = s->m_period[0] / 2 + 1, depth = z[1] - z[0];
  const int parts = s->k->across ? 2 : 1;
  const double unit = 1.0 / ((double) s->m_period[0] * s->m_period[1] * s->m_period[2]);
  const long plane = (long) m[1] * m[2];
  for (int k = y[0]; k < y[1]; k++)
    for (int x = 0; x < half; x++) {
      const long entry = ((long) (k - y[0]) * half + x) * s->k->kernels + kernel;
      const double *re = s->kept + x * plane + (long) k * m[2] + z[0];
      const double *im = s->kept + (m[0] - x) * plane + (long) k * m[2] + z[0];
      const int real = x == 0 || x == half - 1;
      double *out = table + parts * entry * depth;
      for (int l = 0; l < depth; l++) {
        out[l] = unit * re[l];
        if (parts == 2) out[depth + l] = real ? 0.0 : unit * im[l];
      }
    }
}

/* --- the table --- */

static int make_direction(workspace *s, int d, int size)
{
  const sd_ewald *e = s->k->ewald;
  const int whole = s->k->across && d == 0, beyond = points_beyond(e->points);
  const int half = sd_ewald_transformable(0.5 * size + beyond);
  s->m_period[d] = size;
  s->n_period[d] = 2 * half;
  s->m[d] = whole ? size : size / 2 + 1;
  s->n[d] = whole ? 2 * half : half + 1;
  s->first[d] = whole ? beyond : 0;
  const int end = whole ? beyond + size : size / 2, room = (whole ? 2 * half : half) - end;
  s->taper[d] = malloc(sizeof(double) * (size_t) s->n[d]);
  s->inverse[d] = sd_window_inverse(e->points, e->beta, half + 1);
  for (int l = 0; l < s->n[d] && s->taper[d]; l++)
    s->taper[d][l] = l < s->first[d] ? taper(s->first[d] - l, beyond) : taper(l - end, room);
  if (!whole) {
    s->n_lines[d] = sd_padded_lines_create(s->n[d]);
    s->m_lines[d] = sd_padded_lines_create(s->m[d]);
  }
  return s->taper[d] && s->inverse[d] && (whole || (s->n_lines[d] && s->m_lines[d]));
}

static int pa_make_room(workspace *s, const int *size)
{
  size_t large = 1, wanted = 1;
  int ok = 1;
  for (int d = 0; d < 3; d++) {
    ok = make_direction(s, d, size[d]) && ok;
    large *= (size_t) s->n[d];
    wanted *= (size_t) s->m[d];
  }
  s->number = malloc(SD_PADDED_NUMBERS * sizeof(double) * large);
  s->field = fftw_malloc(sizeof(double) * large);
  s->kept = fftw_malloc(sizeof(double) * wanted);
  return ok && s->number && s->field && s->kept;
}

static void pa_give_back(workspace *s)
{
  for (int d = 0; d < 3; d++) {
    free(s->taper[d]);
    free(s->inverse[d]);
    sd_padded_lines_free(s->n_lines[d]);
    sd_padded_lines_free(s->m_lines[d]);
  }
  free(s->radial);
  free(s->number);
  fftw_free(s->field);
  fftw_free(s->kept);
}

/* One kernel after the other: offsets -> waves of the large grid, without windows -> offsets that are
 * kept -> waves of the transform's grid */
sd_status sd_padded_table(const sd_padded *k, const int *size, const int *y, const int *z,
                          double *table)
{
  workspace s = {.k = k};
  int ok = pa_make_room(&s, size);
  ok = ok && tabulate(&s);
  if (ok) sample(&s);
  for (int c = 0; c < k->kernels && ok; c++) {
    pa_fill(&s, c);
    ok = transform(&s, c, s.field, s.n, s.n_lines, 0);
    if (ok) deconvolve(&s);
    ok = ok && transform(&s, c, s.field, s.n, s.n_lines, 1);
    if (ok) keep(&s);
    ok = ok && transform(&s, c, s.kept, s.m, s.m_lines, 0);
    if (ok) pa_store(&s, c, y, z, table);
  }
  pa_give_back(&s);
  return ok ? SD_OK : SD_ENOMEMORY;
}
