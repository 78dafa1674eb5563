#include "sd_slab_rest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_radial.h"

/* Orders of b that pairs have; forces and flows: with and without b */
enum { ORDERS = 3, SIDES = 2, MEANS = 6 };

void sd_slab_rest_free(sd_slab_rest *r)
{
  free(r->tail);
  free(r->sums);
  free(r->flow);
  memset(r, 0, sizeof(*r));
}

/* A and B of the three orders: the tensor of two spheres a_ref less their D, and what b adds */
static void rest_of_pair(const sd_ewald *e, double r, double A[ORDERS], double B[ORDERS])
{
  const double unit = 1.0 / (8.0 * SD_PI * r), r2 = r * r, reach = 2.0 * e->a_ref * e->a_ref / r2;
  double D[SD_RADIALS];
  sd_radial(e, r, D);
  A[0] = unit * (1.0 + reach / 3.0) - D[SD_I0];
  B[0] = unit * (1.0 - reach) - r2 * D[SD_J0];
  A[1] = -2.0 * unit / r2 - D[SD_I1];
  B[1] = 6.0 * unit / r2 - r2 * D[SD_J1];
  A[2] = -D[SD_I2];
  B[2] = -r2 * D[SD_J2];
}

/* Simpson's rule over [from, from + 8/xi] in so many steps, of r A + B r/2, B/(2 r), r A and B/r */
static void integrals_of_rest(const sd_ewald *e, double from, int steps, double integral[ORDERS][4])
{
  const double dr = 8.0 / e->xi / steps;
  memset(integral, 0, sizeof(double[ORDERS][4]));
  for (int s = 0; s <= steps; s++) {
    const double r = from + s * dr, weight = (s == 0 || s == steps ? 1.0 : s % 2 ? 4.0 : 2.0) * dr / 3.0;
    double A[ORDERS], B[ORDERS];
    rest_of_pair(e, r, A, B);
    for (int o = 0; o < ORDERS; o++) {
      integral[o][0] += weight * (r * A[o] + 0.5 * r * B[o]);
      integral[o][1] += weight * 0.5 * B[o] / r;
      integral[o][2] += weight * r * A[o];
      integral[o][3] += weight * B[o] / r;
    }
  }
}

/* Up to R, where most of it is, all planes have the same integrals. */
static void fill_tail(sd_slab_rest *r)
{
  const sd_ewald *e = &r->slab.ewald;
  const int planes = e->slab.planes;
  double within[ORDERS][4], beyond[ORDERS][4];
  integrals_of_rest(e, e->range, 400, within);
  for (int p = 0; p < planes; p++) {
    const double d = p * r->slab.spacing;
    if (d > e->range + 8.0 / e->xi) break;
    if (d > e->range) integrals_of_rest(e, d, 40, beyond);
    for (int o = 0; o < ORDERS; o++) {
      const double *of = d > e->range ? beyond[o] : within[o];
      r->tail[o * planes + p] = 2.0 * SD_PI * (of[0] - d * d * of[1]);
      r->tail[(ORDERS + o) * planes + p] = 2.0 * SD_PI * (of[2] + d * d * of[3]);
    }
  }
}

sd_status sd_slab_rest_create(sd_slab_rest *r, const sd_slab *slab)
{
  const size_t planes = (size_t) slab->ewald.slab.planes;
  sd_slab_rest_free(r);
  r->slab = *slab;
  r->numbers = (int) planes * SIDES * 3 + MEANS;
  r->tail = calloc(2 * ORDERS * planes, sizeof(double));
  r->sums = calloc((size_t) r->numbers, sizeof(double));
  r->flow = calloc(planes * SIDES * 3, sizeof(double));
  if (!r->tail || !r->sums || !r->flow) return SD_ENOMEMORY;
  r->means = r->sums + planes * SIDES * 3;
  fill_tail(r);
  return SD_OK;
}

void sd_slab_rest_clear(sd_slab_rest *r)
{
  memset(r->sums, 0, sizeof(double) * (size_t) r->numbers);
}

/* The first of three planes, and their shares */
static int planes_of(const sd_slab_rest *r, double height, double share[3])
{
  const int last = r->slab.ewald.slab.planes - 2;
  const double s = (height - r->slab.first) / r->slab.spacing;
  const int middle = (int) fmin(fmax(rint(s), 1.0), last);
  const double t = s - middle;
  share[0] = 0.5 * t * (t - 1.0);
  share[1] = 1.0 - t * t;
  share[2] = 0.5 * t * (t + 1.0);
  return middle - 1;
}

void sd_slab_rest_add(sd_slab_rest *r, double height, double a, const double F[3])
{
  double share[3];
  const double b = sd_ewald_b(&r->slab.ewald, a);
  double *to = r->sums + 3 * SIDES * planes_of(r, height, share);
  for (int p = 0; p < 3; p++, to += 3 * SIDES)
    for (int d = 0; d < 3; d++) {
      to[d] += share[p] * F[d];
      to[3 + d] += share[p] * b * F[d];
    }
}

void sd_slab_rest_sum(sd_slab_rest *r)
{
  const sd_ewald *e = &r->slab.ewald;
  const int planes = e->slab.planes, across = e->slab.across;
  const double over = e->box.edge[across] / sd_ewald_volume(&e->box);
  memset(r->flow, 0, sizeof(double) * (size_t) planes * SIDES * 3);
  for (int i = 0; i < planes; i++)
    for (int j = 0; j < planes; j++)
      for (int d = 0; d < 3; d++) {
        const double *C = r->tail + (d == across ? ORDERS * planes : 0) + abs(i - j);
        const double *f = r->sums + 3 * SIDES * j + d;
        double *u = r->flow + 3 * SIDES * i + d;
        u[0] += over * (C[0] * f[0] - C[planes] * f[3]);
        u[3] += over * (C[2 * planes] * f[3] - C[planes] * f[0]);
      }
}

void sd_slab_rest_take(const sd_slab_rest *r, double height, double a, double u[3])
{
  double share[3];
  const double b = sd_ewald_b(&r->slab.ewald, a);
  const double *from = r->flow + 3 * SIDES * planes_of(r, height, share);
  for (int p = 0; p < 3; p++, from += 3 * SIDES)
    for (int d = 0; d < 3; d++) u[d] += share[p] * (from[d] + b * from[3 + d]);
}
