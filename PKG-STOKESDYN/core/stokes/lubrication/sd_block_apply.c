/* The factor of sd_block_cholesky.h applied to a vector. */
#include <string.h>

#include "sd_block_internal.h"

static const struct sd_block_kernels *kernels_here(void)
{
  return SD_KERNELS_OF(sd_block, plain, sd_isa_of(SD_ISA_BEST));
}

static void take_in(const sd_block_cholesky *f, long p, const double *x)
{
  for (int r = 0; r < 6; r++) f->vector[SD_BLOCK_LANES * p + r] = (float) x[6 * p + r];
}

static void give_out(const sd_block_cholesky *f, long p, double *x)
{
  for (int r = 0; r < 6; r++) x[6 * p + r] = f->vector[SD_BLOCK_LANES * p + r];
}

static void take_all(const sd_block_cholesky *f, const double *x)
{
  memset(f->vector, 0, sizeof(float) * SD_BLOCK_LANES * (size_t) f->n);
  for (long p = 0; p < f->n; p++) take_in(f, p, x);
}

void sd_block_cholesky_apply(const sd_block_cholesky *f, double *x)
{
  take_all(f, x);
  kernels_here()->forth(f, 0, f->n);
  kernels_here()->back(f, 0, f->n);
  for (long p = 0; p < f->n; p++) give_out(f, p, x);
}

void sd_block_cholesky_forth(const sd_block_cholesky *f, double *x)
{
  take_all(f, x);
  kernels_here()->forth(f, 0, f->early);
  for (long k = f->early; k < f->n; k++) give_out(f, f->order[k], x);
}

void sd_block_cholesky_middle(const sd_block_cholesky *f, double *x)
{
  for (long k = f->early; k < f->factored; k++) take_in(f, f->order[k], x);
  kernels_here()->forth(f, f->early, f->factored);
  kernels_here()->back(f, f->early, f->factored);
  for (long k = f->early; k < f->factored; k++) give_out(f, f->order[k], x);
}

void sd_block_cholesky_back(const sd_block_cholesky *f, double *x)
{
  for (long k = f->early; k < f->n; k++) take_in(f, f->order[k], x);
  kernels_here()->back(f, 0, f->early);
  for (long p = 0; p < f->n; p++) give_out(f, p, x);
}
