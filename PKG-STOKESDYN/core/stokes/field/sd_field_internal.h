/* Between the parts of a field, and between those and the kernels. */
#ifndef SD_FIELD_INTERNAL_H
#define SD_FIELD_INTERNAL_H

#include "sd_field.h"
#include "sd_radial.h"

/* A row of a source: x y z a, F, T, and two numbers that are free */
enum { SD_FIELD_ROW = 12 };

/* Our points in columns, rows along x `stride` apart, which is more than a vector longer than the
 * row; lengths scaled as in sd_packed, sums times 8 pi.
 *   source [n]   rows, images among them
 *   range        only points nearer than this get something; not read by `direct`
 *   I0 J0 I1 J1 K0   of sd_radial.h, so scaled, of a degree that there is a kernel for */
typedef struct {
  int n, turns;
  const double *source;
  double lo[3], step[3];
  int points[3];
  long stride;
  double range;
  int degree;
  double coefficient[SD_RADIALS][SD_RADIAL_TERMS];
  double *u[3];
} sd_field_part;

struct sd_field_kernels {
  /* every source with every point */
  void (*direct)(const sd_field_part *p);
  /* the tensor less its wave part in open space, within the range */
  void (*near)(const sd_field_part *p);
};

SD_KERNEL_TABLES(struct sd_field_kernels, sd_field);

/* Calls visit for each image of the place x within lo ... hi [3], steps [3] edges away; where the
 * box is not periodic, for x itself. 0 as soon as visit returns 0, else 1. */
typedef int sd_field_visit(void *ctx, const double *image, const int *steps);
int sd_field_images(const sd_ewald_box *box, const double *lo, const double *hi, const double *x,
                    sd_field_visit *visit, void *ctx);

/* u columns += what the convolved grid of the waves has at our points: f = scale u */
sd_status sd_field_gather(const sd_ewald_waves *w, const sd_field_grid *g, double factor,
                          long stride, double *const *column);

#endif
