#include "sd_open_kernel.h"

#include <fftw3.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_radial.h"
#include "sd_window.h"

/* --- the kernel in space --- */

/* In closed form, with e = erf(xi r), E = exp(-xi^2 r^2), L = e/r^3 - 2 xi E/(sqrt(pi) r^2),
 *   I_0 = (e/r + 2 xi E/sqrt(pi))/(8 pi) - a_ref^2 (-L + 4 xi^3 E/sqrt(pi))/(12 pi)
 *   J_0 = (e/r - 2 xi E/sqrt(pi))/(8 pi) - a_ref^2 (3L - 4 xi^3 E/sqrt(pi))/(12 pi)
 * which cancels near r = 0. value [2]: I_0, J_0/r^2 */
static void wave_part(const sd_ewald *e, double r, double *value)
{
  const double xi = e->xi, z = xi * r, root = sqrt(SD_PI);
  const double ref = e->a_ref * e->a_ref / (12.0 * SD_PI);
  if (z < 1.0) {
    double D[SD_RADIALS];
    sd_radial(e, r, D);
    value[0] = D[SD_I0];
    value[1] = D[SD_J0];
    return;
  }
  const double E = z > 6.5 ? 0.0 : exp(-z * z) / root, over = (z > 6.5 ? 1.0 : erf(z)) / r;
  const double L = over / (r * r) - 2.0 * xi * E / (r * r), cube = 4.0 * xi * xi * xi * E;
  value[0] = (over + 2.0 * xi * E) / (8.0 * SD_PI) - ref * (cube - L);
  value[1] = ((over - 2.0 * xi * E) / (8.0 * SD_PI) - ref * (3.0 * L - cube)) / (r * r);
}

/* Of a level that another has taken its waves from: less those. */
static void kernel(const sd_ewald *e, const sd_ewald *large, double r, double *value)
{
  wave_part(e, r, value);
  if (!(e->large.from > 0.0)) return;
  double taken[2];
  wave_part(large, r, taken);
  for (int k = 0; k < 2; k++) value[k] -= taken[k];
}

double sd_open_kernel_taper(int beyond, int many)
{
  const double z = (beyond - 0.2 * many) / (0.8 * many);
  return z <= 0.0 ? 1.0 : 0.5 * erfc(6.0 * (2.0 * z - 1.0));
}

/* I_0 and J_0/r^2 with their taper, on the octant of n [3] points */
static void sample(const sd_ewald *e, const int *n, double *const *t, double *I0, double *J0)
{
  const double h = e->spacing;
  const sd_ewald large = sd_ewald_of_large(e);
  for (int x = 0; x < n[0]; x++)
    for (int y = 0; y < n[1]; y++)
      for (int z = 0; z < n[2]; z++) {
        const double weight = t[0][x] * t[1][y] * t[2][z];
        double value[2] = {0.0};
        const double r = h * sqrt((double) x * x + (double) y * y + (double) z * z);
        if (weight > 1e-17) kernel(e, &large, r, value);
        *I0++ = weight * value[0];
        *J0++ = weight * value[1];
      }
}

/* I_0 delta + J_0 hh; what is odd in two directions with the sign that two sine transforms bring */
static void fill_component(const sd_ewald *e, const int *n, const int *pair, const double *I0,
                           const double *J0, double *field)
{
  const double h2 = e->spacing * e->spacing;
  const int same = pair[0] == pair[1];
  for (int x = 0; x < n[0]; x++)
    for (int y = 0; y < n[1]; y++)
      for (int z = 0; z < n[2]; z++) {
        const double r[3] = {x, y, z}, along = h2 * r[pair[0]] * r[pair[1]] * *J0++;
        *field++ = same ? *I0 + along : -along;
        I0++;
      }
}

/* --- transforms --- */

double *sd_open_kernel_inverse(const sd_ewald *e, int n)
{
  double *inverse = malloc(sizeof(double) * (size_t) n);
  for (int m = 0; m < n && inverse; m++)
    inverse[m] =
        m == n - 1 ? 0.0 : 1.0 / sd_window_transform(e->points, e->beta, SD_PI * m / (n - 1));
  return inverse;
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

/* The windows are taken out of the transform, once for spreading and once for interpolation. Where
 * H is nothing there are only rounding errors, which that would blow up. */
static void deconvolve(const sd_ewald *e, const int *n, double *const *inverse, double *field)
{
  const double all = 8.0 * (n[0] - 1) * (n[1] - 1) * (double) (n[2] - 1);
  double unit[3];
  for (int d = 0; d < 3; d++) unit[d] = SD_PI / ((n[d] - 1) * e->spacing);
  for (int x = 0; x < n[0]; x++)
    for (int y = 0; y < n[1]; y++) {
      const double across = pow(x * unit[0], 2) + pow(y * unit[1], 2);
      const double wxy = inverse[0][x] * inverse[1][y];
      for (int z = 0; z < n[2]; z++) {
        const double w = wxy * inverse[2][z], k = z * unit[2];
        const double most = 4.0 * e->xi * e->xi * 37.0; /* exp(-37) = 1e-16 */
        *field++ *= across + k * k < most ? w * w / all : 0.0;
      }
    }
}

void sd_open_kernel_keep(const double *from, const int *n, double *to, const int *m)
{
  memset(to, 0, sizeof(double) * (size_t) m[0] * (size_t) m[1] * (size_t) m[2]);
  for (int x = 0; x < m[0] - 1; x++)
    for (int y = 0; y < m[1] - 1; y++)
      memcpy(to + ((long) x * m[1] + y) * m[2], from + ((long) x * n[1] + y) * n[2],
             sizeof(double) * (size_t) (m[2] - 1));
}

static void store_component(const double *octant, const int *m, const int *y, const int *z,
                            int component, double *table)
{
  const int depth = z[1] - z[0];
  const double unit = 0.125 / ((m[0] - 1.0) * (m[1] - 1.0) * (m[2] - 1.0));
  for (int x = 0; x < m[0]; x++)
    for (int k = y[0]; k < y[1]; k++)
      for (int l = z[0]; l < z[1]; l++)
        table[(((long) (k - y[0]) * m[0] + x) * 6 + component) * depth + l - z[0]] =
            unit * octant[((long) x * m[1] + k) * m[2] + l];
}

/* --- the table --- */

typedef struct {
  int n[3];
  double *taper[3], *inverse[3], *I0, *J0, *field, *kept;
} workspace;

int sd_open_kernel_beyond(int points)
{
  return points > 5 ? 4 * points + 4 : 24;
}

int sd_open_kernel_way(const sd_ewald *e, int m, int *n, double **taper, double **inverse)
{
  *n = sd_ewald_transformable(m - 1 + sd_open_kernel_beyond(e->points)) + 1;
  *taper = malloc(sizeof(double) * (size_t) *n);
  *inverse = sd_open_kernel_inverse(e, *n);
  for (int l = 0; l < *n && *taper; l++)
    (*taper)[l] = sd_open_kernel_taper(l - (m - 1), *n - 1 - (m - 1));
  return *taper && *inverse;
}

static int make_room(workspace *s, const sd_ewald *e, const int *m)
{
  size_t large = 1, octant = 1;
  int ok = 1;
  for (int d = 0; d < 3; d++) {
    ok = sd_open_kernel_way(e, m[d], &s->n[d], &s->taper[d], &s->inverse[d]) && ok;
    large *= (size_t) s->n[d];
    octant *= (size_t) m[d];
  }
  s->I0 = malloc(sizeof(double) * large);
  s->J0 = malloc(sizeof(double) * large);
  s->field = fftw_malloc(sizeof(double) * large);
  s->kept = fftw_malloc(sizeof(double) * octant);
  return ok && s->I0 && s->J0 && s->field && s->kept;
}

static void give_back(workspace *s)
{
  for (int d = 0; d < 3; d++) {
    free(s->taper[d]);
    free(s->inverse[d]);
  }
  free(s->I0);
  free(s->J0);
  fftw_free(s->field);
  fftw_free(s->kept);
}

/* Six components, one after the other: offsets -> waves of the large grid, without windows ->
 * offsets that are kept -> waves of the transform's grid */
sd_status sd_open_kernel(const sd_ewald *e, const int *m, const int *y, const int *z, double *table)
{
  static const int pair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  workspace s = {0};
  int ok = make_room(&s, e, m);
  if (ok) sample(e, s.n, s.taper, s.I0, s.J0);
  for (int c = 0; c < 6 && ok; c++) {
    int odd[3] = {0};
    if (c > 2) odd[pair[c][0]] = odd[pair[c][1]] = 1;
    fill_component(e, s.n, pair[c], s.I0, s.J0, s.field);
    ok = transform_octant(s.field, s.n, odd);
    if (ok) deconvolve(e, s.n, s.inverse, s.field);
    ok = ok && transform_octant(s.field, s.n, odd);
    if (ok) sd_open_kernel_keep(s.field, s.n, s.kept, m);
    ok = ok && transform_octant(s.kept, m, odd);
    if (ok) store_component(s.kept, m, y, z, c, table);
  }
  give_back(&s);
  return ok ? SD_OK : SD_ENOMEMORY;
}
