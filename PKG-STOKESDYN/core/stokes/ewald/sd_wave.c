#include "sd_wave.h"

#include <fftw3.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_ewald_internal.h"

/* Wave number of point m of n: 0, 1 ... n/2 - 1, then from -n/2 on */
static int wave_number(int m, int n)
{
  return m < (n + 1) / 2 ? m : m - n;
}

/* 1/w^ at each point of a direction, less the one without partner: 0 */
static double *deconvolution(const sd_ewald *e, int n)
{
  double *inverse = malloc(sizeof(double) * (size_t) n);
  for (int m = 0; m < n && inverse; m++) {
    const double theta = 2.0 * SD_PI * wave_number(m, n) / n;
    inverse[m] = 2 * m == n ? 0.0 : 1.0 / sd_window_transform(e->points, e->beta, theta);
  }
  return inverse;
}

/* --- periodic --- */

static void reciprocal(sd_wave *w, const sd_ewald_box *b)
{
  const double lx = b->edge[0], ly = b->edge[1], lz = b->edge[2];
  const double xy = b->tilt[0], xz = b->tilt[1], yz = b->tilt[2], unit = 2.0 * SD_PI;
  const double rows[3][3] = {{unit / lx, -unit * xy / (lx * ly),
                              unit * (xy * yz - ly * xz) / (lx * ly * lz)},
                             {0.0, unit / ly, -unit * yz / (ly * lz)},
                             {0.0, 0.0, unit / lz}};
  memcpy(w->k, rows, sizeof(rows));
}

/* One row along z of the table, and its share of the self sums: all but the first of the row stand
 * for their partner at -k too. */
static void periodic_entries(sd_wave *w, const sd_ewald *e, const double *start, double factor,
                             const double *inverse_z, double *table)
{
  for (int m = 0; m < w->half; m++) {
    const double k[3] = {start[0], start[1], start[2] + m * w->k[2][2]};
    const double k2 = k[0] * k[0] + k[1] * k[1] + k[2] * k[2], d = factor * inverse_z[m];
    table[m] = 0.0;
    if (!(k2 > 0.0) || d == 0.0) continue;
    const double B = sd_ewald_wave_screen(e, k2) / (k2 * sd_ewald_volume(&e->box));
    table[m] = B * d * d;
    for (int c = 0; c < 3; c++) {
      const double part = (m == 0 ? 1.0 : 2.0) * B * (1.0 - k[c] * k[c] / k2);
      w->self[0][c] += part;
      w->self[1][c] += part * k2;
      w->self[2][c] += part * k2 * k2;
    }
  }
}

static sd_status periodic_table(sd_wave *w, const sd_ewald *e, int y1)
{
  reciprocal(w, &e->box);
  double *inverse[3];
  for (int d = 0; d < 3; d++) inverse[d] = deconvolution(e, w->size[d]);
  const size_t row = (size_t) w->half, rows = (size_t) (y1 - w->y0) * (size_t) w->size[0];
  w->table = malloc(sizeof(double) * (row * rows + 1));
  const int ok = w->table && inverse[0] && inverse[1] && inverse[2];
  double *next = w->table;
  for (int y = w->y0; y < y1 && ok; y++)
    for (int x = 0; x < w->size[0]; x++, next += row) {
      double start[3];
      const int mx = wave_number(x, w->size[0]), my = wave_number(y, w->size[1]);
      for (int c = 0; c < 3; c++) start[c] = mx * w->k[0][c] + my * w->k[1][c];
      periodic_entries(w, e, start, inverse[0][x] * inverse[1][y], inverse[2], next);
    }
  for (int d = 0; d < 3; d++) free(inverse[d]);
  return ok ? SD_OK : SD_ENOMEMORY;
}

/* --- open --- */

/* The biharmonic kernel of Stokes flow, -r/(8 pi), cut at R where it is made to vanish with its
 * slope: (R/2 + r^2/(2R) - r)/(8 pi). Its transform is bounded and never negative,
 *   [2 + cos q - 3 sin(q)/q]/(2 k^4),   q = kR;   R^4/120 at k = 0
 * The constant makes no flow; r^2/(2R) a uniform one, which sd_wave.uniform takes back. */
static double truncated(double k2, double R)
{
  const double q2 = k2 * R * R, q = sqrt(q2);
  if (q < 0.3) return R * R * R * R / 120.0 * (1.0 - q2 / 21.0 + q2 * q2 / 1008.0);
  return (2.0 + cos(q) - 3.0 * sin(q) / q) / (2.0 * k2 * k2);
}

/* A real field that is even or odd in each direction, from its octant: transformed in place. Odd
 * ones are 0 at both ends of their direction, and FFTW does not see these. */
static int transform_octant(double *field, const int *n, const int *odd)
{
  fftw_iodim dims[3], whole = {1, 0, 0};
  fftw_r2r_kind kinds[3];
  long stride = 1, first = 0;
  for (int d = 2; d >= 0; d--) {
    dims[d] = (fftw_iodim){odd[d] ? n[d] - 2 : n[d], (int) stride, (int) stride};
    kinds[d] = odd[d] ? FFTW_RODFT00 : FFTW_REDFT00;
    if (odd[d]) first += stride;
    stride *= n[d];
  }
  whole.n = 1;
  fftw_plan plan =
      fftw_plan_guru_r2r(3, dims, 1, &whole, field + first, field + first, kinds, FFTW_ESTIMATE);
  if (!plan) return 0;
  fftw_execute(plan);
  fftw_destroy_plan(plan);
  return 1;
}

/* Wave numbers of an octant: one step each way */
static void octant_steps(const sd_ewald *e, const int *n, double *unit)
{
  for (int d = 0; d < 3; d++) unit[d] = SD_PI / ((n[d] - 1) * e->spacing);
}

/* B_R(k) H/w^2 on the octant of a grid of 2 (n - 1) points of this spacing, large enough for the
 * truncated kernel: what all components share */
static void fill_octant(const sd_ewald *e, double R, const int *n, double *const *inverse,
                        double *shared)
{
  double unit[3], V = 1.0;
  octant_steps(e, n, unit);
  for (int d = 0; d < 3; d++) V *= 2.0 * (n[d] - 1) * e->spacing;
  for (int x = 0; x < n[0]; x++)
    for (int y = 0; y < n[1]; y++)
      for (int z = 0; z < n[2]; z++, shared++) {
        const double k[3] = {x * unit[0], y * unit[1], z * unit[2]};
        const double k2 = k[0] * k[0] + k[1] * k[1] + k[2] * k[2];
        const double w = inverse[0][x] * inverse[1][y] * inverse[2][z];
        *shared = w == 0.0 ? 0.0 : truncated(k2, R) * sd_ewald_wave_screen(e, k2) * w * w / V;
      }
}

/* Component c, d: k^2 delta_cd - k_c k_d times that */
static void fill_component(const sd_ewald *e, const int *n, const int *pair, const double *shared,
                           double *field)
{
  double unit[3];
  octant_steps(e, n, unit);
  for (int x = 0; x < n[0]; x++)
    for (int y = 0; y < n[1]; y++)
      for (int z = 0; z < n[2]; z++) {
        const double k[3] = {x * unit[0], y * unit[1], z * unit[2]};
        const double k2 = pair[0] == pair[1] ? k[0] * k[0] + k[1] * k[1] + k[2] * k[2] : 0.0;
        *field++ = *shared++ * (k2 - k[pair[0]] * k[pair[1]]);
      }
}

/* Offsets 0 ... half - 2 of the kernel go to the octant of the transform's grid; the last, which no
 * two points within the box have, stays 0. */
static void keep_offsets(const double *from, const int *n, double *to, const int *m)
{
  memset(to, 0, sizeof(double) * (size_t) m[0] * (size_t) m[1] * (size_t) m[2]);
  for (int x = 0; x < m[0] - 1; x++)
    for (int y = 0; y < m[1] - 1; y++)
      memcpy(to + ((long) x * m[1] + y) * m[2], from + ((long) x * n[1] + y) * n[2],
             sizeof(double) * (size_t) (m[2] - 1));
}

static void store_component(const sd_wave *w, const double *octant, const int *m, int component)
{
  const double unit = 1.0 / ((double) w->size[0] * w->size[1] * w->size[2]);
  for (int x = 0; x < m[0]; x++)
    for (int y = 0; y < m[1]; y++)
      for (int z = 0; z < m[2]; z++)
        w->table[(((long) y * m[0] + x) * 6 + component) * m[2] + z] =
            unit * octant[((long) x * m[1] + y) * m[2] + z];
}

static int next_fast(double at_least)
{
  for (int n = (int) ceil(at_least);; n++) {
    int m = n;
    for (int p = 2; p < 8; p++)
      while (m % p == 0) m /= p;
    if (m == 1) return n;
  }
}

/* Six components, one after the other: table of k on the large grid -> offsets -> table of k on the
 * transform's grid. R covers the box and the range of H. */
static sd_status open_table(sd_wave *w, const sd_ewald *e)
{
  const double range = 6.5 / (e->large.from > 0.0 ? e->large.xi : e->xi), *L = e->box.edge;
  const double R = sqrt(L[0] * L[0] + L[1] * L[1] + L[2] * L[2]) + range;
  int n[3], m[3];
  double *inverse[3] = {0};
  size_t large = 1, octant = 1;
  for (int d = 0; d < 3; d++) {
    m[d] = w->size[d] / 2 + 1;
    n[d] = next_fast(0.5 * (m[d] + (R + range) / e->spacing + 2.0)) + 1;
    if (n[d] < m[d]) n[d] = m[d];
    inverse[d] = deconvolution(e, 2 * (n[d] - 1));
    large *= (size_t) n[d];
    octant *= (size_t) m[d];
  }
  double *field = fftw_malloc(sizeof(double) * large), *kept = fftw_malloc(sizeof(double) * octant);
  double *shared = fftw_malloc(sizeof(double) * large);
  w->table = malloc(sizeof(double) * 6 * octant);
  /* the difference of two levels has no k = 0 */
  w->uniform = e->large.from > 0.0 ? 0.0 : 1.0 / (4.0 * SD_PI * R);
  int ok = field && kept && shared && w->table && inverse[0] && inverse[1] && inverse[2];
  static const int pair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  if (ok) fill_octant(e, R, n, inverse, shared);
  for (int c = 0; c < 6 && ok; c++) {
    int odd[3] = {0};
    if (c > 2) odd[pair[c][0]] = odd[pair[c][1]] = 1;
    fill_component(e, n, pair[c], shared, field);
    ok = transform_octant(field, n, odd);
    if (!ok) break;
    keep_offsets(field, n, kept, m);
    ok = transform_octant(kept, m, odd);
    if (ok) store_component(w, kept, m, c);
  }
  for (int d = 0; d < 3; d++) free(inverse[d]);
  fftw_free(field);
  fftw_free(kept);
  fftw_free(shared);
  return ok ? SD_OK : SD_ENOMEMORY;
}

/* --- both --- */

sd_status sd_wave_create(sd_wave *w, const sd_ewald *e, const struct sd_ewald_kernels *kernels,
                         const int *size, int y0, int y1)
{
  sd_wave_free(w);
  w->kernels = kernels;
  w->periodic = e->box.periodic;
  for (int d = 0; d < 3; d++) w->size[d] = size[d];
  w->half = size[2] / 2 + 1;
  w->y0 = y0;
  return w->periodic ? periodic_table(w, e, y1) : open_table(w, e);
}

void sd_wave_free(sd_wave *w)
{
  free(w->table);
  memset(w, 0, sizeof(*w));
}

void sd_wave_multiply(void *ctx, int y, double *const *plane)
{
  const sd_wave *w = ctx;
  const int half = w->half, half_x = w->size[0] / 2 + 1;
  const int my = wave_number(y, w->size[1]);
  for (int x = 0; x < w->size[0]; x++) {
    const int mx = wave_number(x, w->size[0]);
    double *row[3];
    for (int c = 0; c < 3; c++) row[c] = plane[c] + (long) x * 2 * half;
    if (w->periodic) {
      const double *B = w->table + ((long) (y - w->y0) * w->size[0] + x) * half;
      double k[3];
      for (int c = 0; c < 3; c++) k[c] = mx * w->k[0][c] + my * w->k[1][c];
      w->kernels->periodic_row(row, B, k, w->k[2][2], half);
    } else {
      const double *K = w->table + ((long) abs(my) * half_x + abs(mx)) * 6 * half;
      w->kernels->open_row(row, K, mx < 0 ? -1.0 : 1.0, my < 0 ? -1.0 : 1.0, half);
    }
  }
}
