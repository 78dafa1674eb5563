#include "sd_image_kernel.h"

#include <fftw3.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_image_wave.h"
#include "sd_open_kernel.h"
#include "sd_window.h"

/* Odd along directions 1 and 2? */
static const int ODD[SD_IMAGE_KERNELS][2] = {
    [SD_IMAGE_G12] = {1, 1}, [SD_IMAGE_L12] = {1, 1}, [SD_IMAGE_L1Z] = {1, 0},
    [SD_IMAGE_L2Z] = {0, 1}, [SD_IMAGE_L1] = {1, 0},  [SD_IMAGE_L2] = {0, 1}};

/* Offsets of the grid in three directions: n points of the large one, of which `kept` from `first`
 * on are wanted; m points of the transform's */
typedef struct {
  const sd_ewald *e;
  int n[3], first, m[3];
  double *taper[3], *inverse[3];
  /* [n] of each place; one component of it; the same of the transform's grid */
  sd_image_radial *radial;
  double *field, *kept;
} workspace;

/* --- in space --- */

/* R of a place; across the wall the height over it of a point and of another, index l - first apart
 * from twice the first point */
static void offset(const workspace *s, int l, int y, int z, double R[3])
{
  const sd_ewald *e = s->e;
  const sd_wall *wall = &e->images.wall;
  const double first = wall->sign * (e->box.origin[0] - wall->at) -
      wall->sign * 0.5 * e->points * e->spacing;
  R[0] = 2.0 * first + wall->sign * (l - s->first) * e->spacing;
  R[1] = y * e->spacing;
  R[2] = z * e->spacing;
}

static void sample(workspace *s)
{
  const sd_image_filter filter = {s->e->images.xi, s->e->a_ref};
  sd_image_radial *out = s->radial;
  for (int l = 0; l < s->n[0]; l++)
    for (int y = 0; y < s->n[1]; y++)
      for (int z = 0; z < s->n[2]; z++, out++) {
        const double weight = s->taper[0][l] * s->taper[1][y] * s->taper[2][z] / (8.0 * SD_PI);
        double R[3];
        memset(out, 0, sizeof(*out));
        if (!(weight > 1e-18)) continue;
        offset(s, l, y, z, R);
        *out = sd_image_radial_at(&filter, sqrt(R[0] * R[0] + R[1] * R[1] + R[2] * R[2]));
        out->I *= weight;
        out->J *= weight;
        out->L1 *= weight;
        out->L2 *= weight;
      }
}

/* Axes of the wall against those of the grid: a factor of sign for each index across. L_12, G_12:
 * with the sign that two sine transforms bring */
static double value_of(int kernel, const sd_image_radial *r, const double R[3], int sign)
{
  switch (kernel) {
    case SD_IMAGE_G11: return r->I + r->J * R[1] * R[1];
    case SD_IMAGE_G22: return r->I + r->J * R[2] * R[2];
    case SD_IMAGE_G12: return -r->J * R[1] * R[2];
    case SD_IMAGE_GZZ: return r->I + r->J * R[0] * R[0];
    case SD_IMAGE_L11: return r->L1 + r->L2 * R[1] * R[1];
    case SD_IMAGE_L22: return r->L1 + r->L2 * R[2] * R[2];
    case SD_IMAGE_L12: return -r->L2 * R[1] * R[2];
    case SD_IMAGE_LZZ: return r->L1 + r->L2 * R[0] * R[0];
    case SD_IMAGE_L1Z: return sign * r->L2 * R[0] * R[1];
    case SD_IMAGE_L2Z: return sign * r->L2 * R[0] * R[2];
    case SD_IMAGE_L1: return sign * r->L1 * R[1];
    default: return sign * r->L1 * R[2];
  }
}

static void fill(const workspace *s, int kernel)
{
  const sd_image_radial *r = s->radial;
  double *out = s->field;
  for (int l = 0; l < s->n[0]; l++)
    for (int y = 0; y < s->n[1]; y++)
      for (int z = 0; z < s->n[2]; z++) {
        double R[3];
        offset(s, l, y, z, R);
        *out++ = value_of(kernel, r++, R, s->e->images.wall.sign);
      }
}

/* --- transforms --- */

/* In place: the first direction as it is (back: from its waves), the others even or odd */
static int transform(double *field, const int *n, const int *odd, int back)
{
  const long plane = (long) n[1] * n[2];
  fftw_iodim dims[3] = {{n[0], (int) plane, (int) plane}}, whole = {1, 0, 0};
  fftw_r2r_kind kinds[3] = {back ? FFTW_HC2R : FFTW_R2HC};
  long first = 0;
  for (int d = 1; d < 3; d++) {
    const int stride = d == 1 ? n[2] : 1;
    dims[d] = (fftw_iodim){odd[d - 1] ? n[d] - 2 : n[d], stride, stride};
    kinds[d] = odd[d - 1] ? FFTW_RODFT00 : FFTW_REDFT00;
    if (odd[d - 1]) first += stride;
  }
  fftw_plan plan =
      fftw_plan_guru_r2r(3, dims, 1, &whole, field + first, field + first, kinds, FFTW_ESTIMATE);
  if (!plan) return 0;
  fftw_execute(plan);
  fftw_destroy_plan(plan);
  return 1;
}

/* Wave number of a place of FFTW's half-complex list */
static int wave_of(int l, int n)
{
  return l <= n / 2 ? l : n - l;
}

static void deconvolve(const workspace *s)
{
  const sd_ewald *e = s->e;
  const int *n = s->n;
  const double all = 4.0 * n[0] * (n[1] - 1) * (double) (n[2] - 1);
  const double most = 4.0 * e->images.xi * e->images.xi * 37.0; /* exp(-37) = 1e-16 */
  const double unit[3] = {2.0 * SD_PI / (n[0] * e->spacing), SD_PI / ((n[1] - 1) * e->spacing),
                          SD_PI / ((n[2] - 1) * e->spacing)};
  double *field = s->field;
  for (int l = 0; l < n[0]; l++)
    for (int y = 0; y < n[1]; y++) {
      const double across = pow(wave_of(l, n[0]) * unit[0], 2) + pow(y * unit[1], 2);
      const double w01 = s->inverse[0][wave_of(l, n[0])] * s->inverse[1][y];
      for (int z = 0; z < n[2]; z++) {
        const double w = w01 * s->inverse[2][z], k = z * unit[2];
        *field++ *= across + k * k < most ? w * w / all : 0.0;
      }
    }
}

static void store(const workspace *s, int kernel, const int *y, const int *z, double *table)
{
  const int *m = s->m, depth = z[1] - z[0], half = m[0] / 2 + 1;
  const double unit = 0.25 / (m[0] * (m[1] - 1.0) * (m[2] - 1.0));
  const long plane = (long) m[1] * m[2];
  for (int k = y[0]; k < y[1]; k++)
    for (int x = 0; x < half; x++) {
      const long entry = ((long) (k - y[0]) * half + x) * SD_IMAGE_KERNELS + kernel;
      double *out = table + 2 * entry * depth;
      const double *re = s->kept + x * plane + (long) k * m[2] + z[0];
      const double *im = s->kept + (m[0] - x) * plane + (long) k * m[2] + z[0];
      const int real = x == 0 || 2 * x == m[0];
      for (int l = 0; l < depth; l++) {
        out[l] = unit * re[l];
        out[depth + l] = real ? 0.0 : unit * im[l];
      }
    }
}

/* --- the table --- */

static int make_room(workspace *s, const int *m)
{
  const int beyond = sd_open_kernel_beyond(s->e->points);
  s->m[0] = 2 * (m[0] - 1);
  s->n[0] = 2 * sd_ewald_transformable(0.5 * s->m[0] + beyond);
  s->first = beyond;
  s->taper[0] = malloc(sizeof(double) * (size_t) s->n[0]);
  s->inverse[0] = sd_open_kernel_inverse(s->e, s->n[0] / 2 + 1);
  int ok = s->taper[0] && s->inverse[0];
  for (int l = 0; l < s->n[0] && ok; l++) {
    const int before = s->first - l, after = l - s->first - s->m[0];
    const int room = before > 0 ? s->first : s->n[0] - s->first - s->m[0];
    s->taper[0][l] = sd_open_kernel_taper(before > 0 ? before : after, room);
  }
  for (int d = 1; d < 3; d++) {
    s->m[d] = m[d];
    ok = sd_open_kernel_way(s->e, m[d], &s->n[d], &s->taper[d], &s->inverse[d]) && ok;
  }
  const size_t all = (size_t) s->n[0] * (size_t) s->n[1] * (size_t) s->n[2];
  s->radial = malloc(sizeof(sd_image_radial) * all);
  s->field = fftw_malloc(sizeof(double) * all);
  s->kept = fftw_malloc(sizeof(double) * (size_t) s->m[0] * (size_t) m[1] * (size_t) m[2]);
  return ok && s->radial && s->field && s->kept;
}

static void give_back(workspace *s)
{
  for (int d = 0; d < 3; d++) {
    free(s->taper[d]);
    free(s->inverse[d]);
  }
  free(s->radial);
  fftw_free(s->field);
  fftw_free(s->kept);
}

sd_status sd_image_kernel(const sd_ewald *e, const int *m, const int *y, const int *z,
                          double *table)
{
  workspace s = {.e = e};
  int ok = make_room(&s, m);
  const long plane = (long) s.n[1] * s.n[2];
  if (ok) sample(&s);
  for (int c = 0; c < SD_IMAGE_KERNELS && ok; c++) {
    fill(&s, c);
    ok = transform(s.field, s.n, ODD[c], 0);
    if (ok) deconvolve(&s);
    ok = ok && transform(s.field, s.n, ODD[c], 1);
    if (ok) sd_open_kernel_keep(s.field + plane * s.first, s.n, s.kept, s.m);
    ok = ok && transform(s.kept, s.m, ODD[c], 0);
    if (ok) store(&s, c, y, z, table);
  }
  give_back(&s);
  return ok ? SD_OK : SD_ENOMEMORY;
}

void sd_image_slopes(const sd_ewald *e, int size, double *gamma)
{
  for (int m = 0; m < size; m++) {
    const int wave = m < (size + 1) / 2 ? m : m - size;
    const double theta = 2.0 * SD_PI * wave / size;
    gamma[m] = e->spacing * sd_window_slope(e->points, e->beta, theta) +
        e->a_ref * e->a_ref / 3.0 * theta / e->spacing;
    if (2 * m == size) gamma[m] = 0.0; /* no partner */
  }
}
