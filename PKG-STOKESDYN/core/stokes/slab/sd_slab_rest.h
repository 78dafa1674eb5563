/* What the near part of a slab leaves out beyond its range, in the mean over a plane along the walls: forces
 * that are alike add it up, so that it would be far larger than the error of random ones. Between planes at
 * a distance d, with R the range and A 1 + B hh the pair less D of sd_radial.h, over r from max(R, d) on,
 *   along the walls  C = 2 pi int (r A + B (r^2 - d^2)/(2 r)) dr,   across  C = 2 pi int (r A + B d^2/r) dr
 *   U_i += 1/S sum_j (C_0 - (b_i + b_j) C_1 + b_i b_j C_2) F_j                         over eta
 * Up to d = R these are parabolas in d: three planes of the grid next to a sphere stand for it. */
#ifndef SD_SLAB_REST_H
#define SD_SLAB_REST_H

#include "sd_slab.h"
#include "sd_status.h"

SD_BEGIN_C

/* Zero-initialise; sd_slab_rest_free in the end. */
typedef struct {
  sd_slab slab;
  /* numbers of sums, which ranks add up: with six of the caller's, `means`, that go by the same message */
  int numbers;
  /* C by difference of planes: [along, across][3][planes] */
  double *tail;
  /* [planes][2][3] sums of F and of b F; flow that goes with 1 and with b */
  double *sums, *means, *flow;
} sd_slab_rest;

/* SD_OK or SD_ENOMEMORY */
sd_status sd_slab_rest_create(sd_slab_rest *r, const sd_slab *slab);

/* Before a product; the force on a sphere; when the sums of all ranks are there; its velocity u += */
void sd_slab_rest_clear(sd_slab_rest *r);
void sd_slab_rest_add(sd_slab_rest *r, double height, double a, const double F[3]);
void sd_slab_rest_sum(sd_slab_rest *r);
void sd_slab_rest_take(const sd_slab_rest *r, double height, double a, double u[3]);

void sd_slab_rest_free(sd_slab_rest *r);

SD_END_C
#endif
