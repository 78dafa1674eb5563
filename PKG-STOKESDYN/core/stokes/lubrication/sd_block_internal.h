/* Between the elimination of sd_block_cholesky.c and its kernels, of which each instruction set has
 * its own build. Blocks that it works with are [6][SD_BLOCK_LANES], row by row, zeros behind each row; those
 * of the factor, which are read again and again from memory, are without these. */
#ifndef SD_BLOCK_INTERNAL_H
#define SD_BLOCK_INTERNAL_H

#include "sd_block_cholesky.h"
#include "sd_isa.h"

enum { SD_BLOCK = 6 * SD_BLOCK_LANES, SD_BLOCK_KEPT = 36 };

/* What a product of two blocks of a column goes to: `to` -= C_q C_r^T, the other way round if its
 * rows are those of r; or `to` is new */
typedef enum { SD_BLOCK_AS_IT_IS, SD_BLOCK_TURNED, SD_BLOCK_NEW } sd_block_way;
typedef struct {
  float *to;
  sd_block_way way;
  /* sum of the squares of what is new */
  float square;
} sd_block_target;

struct sd_block_kernels {
  /* pivot = G G^T, inverse = G^-1 by columns; column [count] blocks B become G^-1 B. 0: the pivot
   * is not positive definite. */
  int (*divide)(float *pivot, float *inverse, int count, float *column);
  /* Of blocks C_q^T, C_r^T of a column, first q and then `count` r: pivot -= C_q C_q^T, and the
   * targets by r */
  void (*subtract)(const float *column, float *pivot, int count, sd_block_target *target);
  /* f->vector by columns begin ... end - 1 of P = C C^T: C^-1, and C^-T in the order back */
  void (*forth)(const sd_block_cholesky *f, long begin, long end);
  void (*back)(const sd_block_cholesky *f, long begin, long end);
};

/* A block as the factor keeps it */
static inline void sd_block_keep(const float *A, float *out)
{
  for (int r = 0; r < 6; r++)
    for (int c = 0; c < 6; c++) out[6 * r + c] = A[SD_BLOCK_LANES * r + c];
}

SD_KERNEL_TABLES(struct sd_block_kernels, sd_block);

#endif
