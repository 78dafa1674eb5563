#include "sd_columns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_window.h"

enum { W = SD_COLUMN_WAVES };

void sd_columns_free(sd_columns *c)
{
  free(c->numbers);
  free(c->corner);
  for (int d = 0; d < 3; d++) free(c->corner_mean[d]);
  free(c->forces);
  free(c->work);
  memset(c, 0, sizeof(*c));
}

static int allocate(sd_columns *c, int rows)
{
  const size_t groups = (size_t) rows * (size_t) c->groups,
               planes = (size_t) c->slab.ewald.slab.planes;
  const size_t sums = (size_t) c->corner_sums + 1, number = sizeof(double);
  int ok = 1;
  c->numbers = calloc(groups * SD_COLUMN_NUMBERS * W + 1, number);
  c->corner = calloc(groups * sums * SD_CORNERS * W + 1, number);
  c->forces = malloc(number * 3 * planes);
  c->work = malloc(number * 12 * planes * W);
  for (int d = 0; d < 3; d++) ok = (c->corner_mean[d] = calloc(sums, number)) && ok;
  return ok && c->numbers && c->corner && c->forces && c->work;
}

/* --- tables --- */

/* Two directions of the box along the slab, as the grid has them */
static void along_slab(const sd_columns *c, int *d)
{
  for (int k = 0; k < 2; k++) d[k] = (c->slab.ewald.slab.across + 1 + k) % 3;
}

/* Where forces and velocities are freed of the windows along the slab: 1/(S w^2 w^2); 0 at a
 * wave without partner and beyond those that the grid has in all directions */
static double unit_of(const sd_columns *c, const int *wave, const double *k)
{
  const sd_ewald *e = &c->slab.ewald;
  int d[2];
  double unit = 1.0;
  along_slab(c, d);
  if (hypot(k[0], k[1]) > 0.96 * SD_PI / c->slab.spacing) return 0.0;
  for (int l = 0; l < 2; l++) {
    if (2 * abs(wave[l]) == e->grid[d[l]]) return 0.0;
    const double w = sd_window_transform(e->points, e->beta, 2.0 * SD_PI * wave[l] / e->grid[d[l]]);
    unit /= e->box.edge[d[l]] * w * w;
  }
  return unit;
}

/* The height of the upper wall, or of the highest plane */
static double top_of(const sd_slab *s)
{
  if (s->walls.kind == SD_SLAB_SLIT) return s->walls.height;
  return s->first + (s->ewald.slab.planes - 1) * s->spacing;
}

/* numbers [SD_COLUMN_NUMBERS][W] of one wave */
static void fill_numbers(const sd_columns *c, const double k_[2], double unit, double *number)
{
  const sd_slab *s = &c->slab;
  const double k = hypot(k_[0], k_[1]), top = top_of(s);
  const double last = s->first + (s->ewald.slab.planes - 1) * s->spacing;
  const double Lz = s->spacing * s->ewald.grid[s->ewald.slab.across];
  const sd_slab_window w = sd_slab_window_at(s, k);
  const double S0 = exp(-k * (Lz - top)) / -expm1(-k * Lz);
  number[SD_COLUMN_L1 * W] = k_[0] / k;
  number[SD_COLUMN_L2 * W] = k_[1] / k;
  number[SD_COLUMN_STEP * W] = exp(-k * s->spacing);
  number[SD_COLUMN_T1 * W] = exp(-k * s->first) / w.W;
  number[SD_COLUMN_T3 * W] = exp(-k * (top - last)) / w.W;
  number[SD_COLUMN_K * W] = k;
  number[SD_COLUMN_SHIFT * W] = w.shift;
  number[SD_COLUMN_S0 * W] = S0;
  number[SD_COLUMN_S1 * W] = S0 * (k * Lz / -expm1(-k * Lz) - k * top);
  number[SD_COLUMN_UNIT * W] = unit / (4.0 * k);
  if (s->walls.kind != SD_SLAB_SLIT) return;
  const sd_slab_stops stops = sd_slab_stops_at(k, s->walls.height);
  for (int n = 0; n < 3; n++) {
    number[(SD_COLUMN_EVEN + n) * W] = stops.even[n];
    number[(SD_COLUMN_ODD + n) * W] = stops.odd[n];
  }
  number[SD_COLUMN_E * W] = stops.E;
  number[SD_COLUMN_T * W] = stops.t;
}

/* Corners of one wave times 4k, which the unit takes away again. Waves in the opposite direction
 * along y have the same. */
static void fill_corner(sd_slab_corner *from, double k, double *corner)
{
  sd_slab_corner_at(from, k, corner, SD_CORNERS * W);
  for (long m = 0; m < (long) from->sums * SD_CORNERS; m++) corner[m * W] *= 4.0 * k;
}

static void copy_corner(const sd_columns *c, const double *from, double *to)
{
  for (long m = 0; m < (long) c->corner_sums * SD_CORNERS; m++) to[m * W] = from[m * W];
}

static long group_of(const sd_columns *c, int y, int z)
{
  return (long) (y - c->y0) * c->groups + (z - c->z0) / W;
}

static double *numbers_of(const sd_columns *c, long group)
{
  return c->numbers + group * SD_COLUMN_NUMBERS * W;
}

static double *corner_of(const sd_columns *c, long group)
{
  return c->corner + group * c->corner_sums * SD_CORNERS * W;
}

/* One lateral wave; end: of the rows along y */
static void fill_wave(sd_columns *c, sd_slab_corner *corner, int y, int z, int end)
{
  const sd_ewald *e = &c->slab.ewald;
  int d[2];
  along_slab(c, d);
  const int wave[2] = {sd_grid_wave(y, e->grid[d[0]]), z};
  const double k[2] = {2.0 * SD_PI * wave[0] / e->box.edge[d[0]],
                       2.0 * SD_PI * wave[1] / e->box.edge[d[1]]};
  const double unit = unit_of(c, wave, k);
  if (unit == 0.0 || hypot(k[0], k[1]) == 0.0) return;
  const long group = group_of(c, y, z), at = (z - c->z0) % W;
  fill_numbers(c, k, unit, numbers_of(c, group) + at);
  if (!c->corner_sums) return;
  const int other = e->grid[d[0]] - y; /* filled before? */
  if (wave[0] < 0 && other >= c->y0 && other < end)
    copy_corner(c, corner_of(c, group_of(c, other, z)) + at, corner_of(c, group) + at);
  else
    fill_corner(corner, hypot(k[0], k[1]), corner_of(c, group) + at);
}

static sd_status columns_make_tables(sd_columns *c, const int *y, const int *z, sd_slab_corner *corner)
{
  if (!allocate(c, y[1] - y[0])) return SD_ENOMEMORY;
  for (int row = y[0]; row < y[1]; row++)
    for (int m = z[0]; m < z[1]; m++) fill_wave(c, corner, row, m, y[1]);
  if (c->mean && c->corner_sums)
    sd_slab_corner_of_mean(corner, c->corner_mean[0], c->corner_mean[1], c->corner_mean[2]);
  return SD_OK;
}

sd_status sd_columns_create(sd_columns *c, const sd_slab *slab,
                            const struct sd_columns_kernels *kernels, const int *y, const int *z)
{
  sd_slab_corner corner = {0};
  sd_columns_free(c);
  c->slab = *slab;
  c->kernels = kernels;
  c->y0 = y[0];
  c->z0 = z[0];
  c->depth = z[1] - z[0];
  c->groups = (c->depth + W - 1) / W;
  c->mean = y[0] == 0 && z[0] == 0 && y[1] > 0 && z[1] > 0;
  sd_status status = SD_OK;
  if (slab->walls.kind != SD_SLAB_LAYER) {
    status = sd_slab_corner_create(&corner, &c->slab);
    c->corner_sums = corner.sums;
    c->corner_planes = corner.sums < slab->ewald.slab.planes ? corner.sums
                                                             : slab->ewald.slab.planes;
  }
  if (status == SD_OK) status = columns_make_tables(c, y, z, &corner);
  sd_slab_corner_free(&corner);
  return status;
}

/* --- product --- */

/* The number of a plane in the grid, by its height */
static int plane_at(const sd_columns *c, int p)
{
  return c->slab.walls.wall->sign > 0 ? p : c->slab.ewald.slab.planes - 1 - p;
}

/* Velocities u [planes] at k = 0 in one direction, of corners; across: is the direction */
static void columns_mean_of(const sd_columns *c, int across, double unit, const double *f, double *u, long stride)
{
  const int planes = c->slab.ewald.slab.planes, walls = sd_slab_many_walls(&c->slab.walls);
  const double *corner = c->corner_mean[across];
  for (int i = 0; i < planes; i++) {
    double sum = 0.0;
    for (int w = 0; w < walls; w++) {
      const int mi = w ? planes - 1 - i : i;
      for (int j = 0; j < c->corner_planes && mi + j < c->corner_sums; j++) {
        if (mi >= c->corner_planes) break;
        const double zi = c->slab.first + mi * c->slab.spacing,
                     zj = c->slab.first + j * c->slab.spacing;
        const double beta = across ? zi * zj * c->corner_mean[2][mi + j] : 0.0;
        sum += (corner[mi + j] + beta) * f[w ? planes - 1 - j : j];
      }
    }
    u[stride * plane_at(c, i)] = unit * sum;
  }
}

/* At k = 0 fields are real: forces are kept before the groups clear them, and velocities come
 * after. */
static void keep_mean(sd_columns *c, double *const *fields)
{
  const int planes = c->slab.ewald.slab.planes;
  for (int d = 0; d < 3; d++)
    for (int p = 0; p < planes; p++)
      c->forces[d * planes + p] = fields[d][2L * c->depth * plane_at(c, p)];
}

static void put_mean(sd_columns *c, double *const *fields)
{
  const sd_ewald *e = &c->slab.ewald;
  const int planes = e->slab.planes, none[2] = {0};
  const double k[2] = {0.0};
  for (int d = 0; d < 3; d++)
    columns_mean_of(c, d == 0, unit_of(c, none, k), c->forces + d * planes, fields[d], 2L * c->depth);
}

void sd_columns_apply(void *ctx, int y, double *const *fields)
{
  sd_columns *c = ctx;
  const sd_slab *s = &c->slab;
  const int planes = s->ewald.slab.planes, up = s->walls.wall->sign > 0;
  const long plane = 2L * c->depth;
  const int mean = c->mean && y == 0;
  if (mean) keep_mean(c, fields);
  for (int g = 0; g < c->groups; g++) {
    const long group = group_of(c, y, c->z0 + g * W);
    sd_column_group at = {.n = c->depth - g * W < W ? c->depth - g * W : W,
                          .planes = planes,
                          .walls = sd_slab_many_walls(&s->walls),
                          .plane = up ? plane : -plane,
                          .sign = up ? 1.0 : -1.0,
                          .first = s->first,
                          .spacing = s->spacing,
                          .top = top_of(s),
                          .numbers = numbers_of(c, group),
                          .corner = corner_of(c, group),
                          .corner_planes = c->corner_planes,
                          .corner_sums = c->corner_sums,
                          .work = c->work};
    for (int d = 0; d < 3; d++)
      at.field[d] = fields[d] + (up ? 0 : (planes - 1) * plane) + 2L * g * W;
    c->kernels->group(&at);
  }
  if (mean) put_mean(c, fields);
}
