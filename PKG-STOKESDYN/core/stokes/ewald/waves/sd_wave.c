#include "sd_wave.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_ewald_kernels.h"
#include "sd_grid.h"
#include "sd_image_kernel.h"
#include "sd_padded.h"
#include "sd_radial.h"
#include "sd_real.h"
#include "sd_window.h"

/* A table that was made of doubles, of kernels that take floats */
static sd_status narrow(sd_wave *w, size_t numbers)
{
  if (w->kernels->bytes == sizeof(double)) return SD_OK;
  const double *from = w->table;
  float *table = malloc(sizeof(float) * (numbers + 1));
  if (!table) return SD_ENOMEMORY;
  for (size_t k = 0; k < numbers; k++) table[k] = (float) from[k];
  free(w->table);
  w->table = table;
  return SD_OK;
}

/* --- periodic --- */

/* One row along z of the table */
static void periodic_entries(const sd_wave *w, const sd_ewald *e, const double *start, double factor,
                             const double *inverse_z, double *table)
{
  for (int m = 0; m < w->depth; m++) {
    const double k[3] = {start[0], start[1], start[2] + (w->z0 + m) * w->k[2][2]};
    const double k2 = k[0] * k[0] + k[1] * k[1] + k[2] * k[2], d = factor * inverse_z[w->z0 + m];
    table[m] = 0.0;
    if (!(k2 > 0.0) || d == 0.0) continue;
    table[m] = d * d * sd_ewald_wave_screen(e, k2) / (k2 * sd_ewald_volume(&e->box));
  }
}

static sd_status periodic_table(sd_wave *w, const sd_ewald *e, int y1)
{
  sd_ewald_reciprocal(&e->box, w->k);
  double *inverse[3];
  for (int d = 0; d < 3; d++) inverse[d] = sd_window_inverse(e->points, e->beta, w->size[d] / 2 + 1);
  const size_t row = (size_t) w->depth, rows = (size_t) (y1 - w->y0) * (size_t) w->size[0];
  w->table = malloc(sizeof(double) * (row * rows + 1));
  w->roots = malloc(sizeof(double) * (row + 1));
  const int ok = w->table && w->roots && inverse[0] && inverse[1] && inverse[2];
  double *next = w->table;
  for (int y = w->y0; y < y1 && ok; y++)
    for (int x = 0; x < w->size[0]; x++, next += row) {
      double start[3];
      const int mx = sd_grid_wave(x, w->size[0]), my = sd_grid_wave(y, w->size[1]);
      for (int c = 0; c < 3; c++) start[c] = mx * w->k[0][c] + my * w->k[1][c];
      periodic_entries(w, e, start, inverse[0][abs(mx)] * inverse[1][abs(my)], inverse[2], next);
    }
  for (int d = 0; d < 3; d++) free(inverse[d]);
  return ok ? narrow(w, row * rows) : SD_ENOMEMORY;
}

/* --- open --- */

/* I_0, J_0/r^2 of sd_radial.h, less what a smoother splitting has taken */
static void wa_numbers(const sd_ewald *e, double distance, double *number)
{
  if (e->band > 0.0) {
    double value[SD_RADIALS];
    sd_radial(e, distance, value);
    number[0] = value[SD_I0];
    number[1] = value[SD_J0];
    return;
  }
  const sd_filter filter[2] = {{e->xi, e->a_ref}, {e->taken, e->a_ref}};
  for (int l = 0; l < (e->taken > 0.0 ? 2 : 1); l++) {
    const sd_filtered f = sd_filtered_at(filter + l, distance * distance, 3, 0);
    double I, J;
    sd_filtered_stokeslet(&f, 0, &I, &J);
    number[0] += (l == 0 ? I : -I) / (8.0 * SD_PI);
    number[1] += (l == 0 ? J : -J) / (8.0 * SD_PI);
  }
}

/* xx yy zz xy xz yz of I_0 1 + J_0 hh */
static double wa_value(const sd_ewald *e, int kernel, const double *number, const double *R)
{
  static const int pair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  (void) e;
  const double along = number[1] * R[pair[kernel][0]] * R[pair[kernel][1]];
  return kernel < 3 ? number[0] + along : -along;
}

static sd_padded open_kernel(const sd_ewald *e)
{
  static const int odd[6][3] = {[3] = {1, 1, 0}, [4] = {1, 0, 1}, [5] = {0, 1, 1}};
  const double last = e->band > 0.0 ? e->band : sd_padded_last_of(e->xi);
  return (sd_padded){
      .ewald = e, .last = last, .kernels = 6, .numbers = wa_numbers, .value = wa_value, .odd = odd};
}

static sd_status image_table(sd_wave *w, const sd_ewald *e, const int *y, const int *z)
{
  const size_t row = SD_IMAGE_KERNELS * (size_t) (w->size[0] + 2) * (size_t) w->depth;
  w->images = malloc(sizeof(double) * (row * (size_t) (y[1] - y[0]) + 1));
  w->gamma = malloc(sizeof(double) * (size_t) w->size[0]);
  if (!w->images || !w->gamma) return SD_ENOMEMORY;
  sd_image_slopes(e, w->size[0], w->gamma);
  for (int x = 0; x < w->size[0]; x++) w->gamma[x] *= e->images.wall.sign;
  return sd_image_kernel(e, w->size, y, z, w->images);
}

/* Of the octant the rows that this rank's planes have, by |wave number| */
static sd_status open_table(sd_wave *w, const sd_ewald *e, int y1)
{
  int end = 0;
  w->first_row = w->size[1];
  for (int y = w->y0; y < y1; y++) {
    const int row = abs(sd_grid_wave(y, w->size[1]));
    if (row < w->first_row) w->first_row = row;
    if (row + 1 > end) end = row + 1;
  }
  if (end == 0) w->first_row = 0;
  const size_t row = 6 * (size_t) (w->size[0] / 2 + 1) * (size_t) w->depth;
  const size_t numbers = row * (size_t) (end - w->first_row);
  w->table = malloc(sizeof(double) * (numbers + 1));
  if (!w->table) return SD_ENOMEMORY;
  const int y[2] = {w->first_row, end}, z[2] = {w->z0, w->z0 + w->depth};
  const sd_padded kernel = open_kernel(e);
  sd_status status = sd_padded_table(&kernel, w->size, y, z, w->table);
  if (status == SD_OK) status = narrow(w, numbers);
  return status == SD_OK && e->images.wall.sign ? image_table(w, e, y, z) : status;
}

/* --- both --- */

sd_status sd_wave_create(sd_wave *w, const sd_ewald *e, const struct sd_ewald_kernels *kernels,
                         const int *size, const int *y, const int *z)
{
  sd_wave_free(w);
  w->kernels = kernels;
  w->periodic = e->box.periodic;
  for (int d = 0; d < 3; d++) w->size[d] = size[d];
  w->y0 = y[0];
  w->z0 = z[0];
  w->depth = z[1] - z[0];
  return w->periodic ? periodic_table(w, e, y[1]) : open_table(w, e, y[1]);
}

void sd_wave_free(sd_wave *w)
{
  free(w->table);
  free(w->roots);
  free(w->images);
  free(w->gamma);
  memset(w, 0, sizeof(*w));
}

/* B of the row of wave numbers x and y along z */
static const void *periodic_entry(const sd_wave *w, int x, int y)
{
  return sd_at_number(w->table, w->kernels->bytes, ((long) (y - w->y0) * w->size[0] + x) * w->depth);
}

/* Row x of the three fields of a plane, whose rows have `depth` waves */
static void rows_at(const sd_wave *w, void *const *plane, int x, int depth, void **row)
{
  for (int c = 0; c < 3; c++) row[c] = sd_at_number(plane[c], w->kernels->bytes, 2L * x * depth);
}

/* That row of the three fields, times B and the projection */
static void wa_periodic_row(const sd_wave *w, int x, int y, int depth, const void *B, void *const *row)
{
  const int mx = sd_grid_wave(x, w->size[0]), my = sd_grid_wave(y, w->size[1]);
  double k[3];
  for (int c = 0; c < 3; c++) k[c] = mx * w->k[0][c] + my * w->k[1][c];
  k[2] += w->z0 * w->k[2][2];
  w->kernels->periodic_row(row, B, k, w->k[2][2], depth);
}

void sd_wave_multiply_root(void *ctx, int y, int depth, void *const *plane)
{
  const sd_wave *w = ctx;
  const double points = (double) w->size[0] * w->size[1] * w->size[2];
  for (int x = 0; x < w->size[0]; x++) {
    const double *B = periodic_entry(w, x, y);
    void *row[3];
    rows_at(w, plane, x, depth, row);
    for (int m = 0; m < depth; m++) w->roots[m] = sqrt(B[m] / points);
    wa_periodic_row(w, x, y, depth, w->roots, row);
  }
}

/* Rows x and -x of a plane of an open box above a wall, and what they are multiplied with */
static sd_image_rows rows_above(const sd_wave *w, int x, int y, void *const *plane)
{
  const int half_x = w->size[0] / 2 + 1, my = sd_grid_wave(y, w->size[1]), depth = w->depth;
  const long entry = (long) (abs(my) - w->first_row) * half_x + x;
  sd_image_rows r = {.depth = depth,
                     .K = (const double *) w->table + entry * 6 * depth,
                     .images = w->images + entry * 2 * SD_IMAGE_KERNELS * depth,
                     .gamma = w->gamma[x],
                     .sy = my < 0 ? -1.0 : 1.0};
  const long at[2] = {x, (w->size[0] - x) % w->size[0]};
  for (int side = 0; side < 2; side++)
    for (int c = 0; c < 6; c++) r.row[side][c] = (double *) plane[c] + at[side] * 2 * depth;
  return r;
}

void sd_wave_multiply(void *ctx, int y, int depth, void *const *plane)
{
  const sd_wave *w = ctx;
  for (int x = 0; x <= w->size[0] / 2 && w->images; x++) {
    const sd_image_rows r = rows_above(w, x, y, plane);
    w->kernels->image_rows(&r);
  }
  if (w->images) return;
  const int half_x = w->size[0] / 2 + 1;
  const int my = sd_grid_wave(y, w->size[1]);
  for (int x = 0; x < w->size[0]; x++) {
    const int mx = sd_grid_wave(x, w->size[0]);
    void *row[3];
    rows_at(w, plane, x, depth, row);
    if (w->periodic)
      wa_periodic_row(w, x, y, depth, periodic_entry(w, x, y), row);
    else {
      const long entry = (long) (abs(my) - w->first_row) * half_x + abs(mx);
      const void *K = sd_at_number(w->table, w->kernels->bytes, entry * 6 * depth);
      w->kernels->open_row(row, K, mx < 0 ? -1.0 : 1.0, my < 0 ? -1.0 : 1.0, depth);
    }
  }
}
