#include "sd_blocks.h"

#include <stdlib.h>
#include <string.h>

#include "sd_linear.h"
#include "sd_precondition_internal.h"

void sd_blocks_free(void *blocks)
{
  sd_blocks *b = blocks;
  free(b->first);
  free(b->member);
  free(b->lone);
  free(b->start);
  free(b->inverse);
  free(b->root);
  free(b->scratch);
  memset(b, 0, sizeof(*b));
}

/* Who is in which block: those that take part. Blocks of this part have (width m)^2 numbers, one
 * after the other. Returns the spheres of the largest one. */
static long fill_blocks(sd_blocks *b, const sd_precondition_case *c)
{
  long count = 0, largest = 0;
  for (long i = 0; i < b->n; i++) b->lone[i] = c->spheres.a[i] > 0.0;
  b->start[0] = 0;
  for (int k = 0; k < b->blocks; k++) {
    b->first[k] = count;
    for (long l = c->first[k]; l < c->first[k + 1]; l++) {
      const int i = c->member[l];
      if (!b->lone[i]) continue;
      b->member[count++] = i;
      b->lone[i] = 0;
    }
    const long m = count - b->first[k], size = b->width * m;
    if (m > largest) largest = m;
    b->start[k + 1] = b->start[k] + (k % b->parts == b->part ? size * size : 0);
  }
  b->first[b->blocks] = count;
  return largest;
}

/* Two steps: what is known from the number of clumps, then what follows from who is in them. */
static sd_status bl_allocate(sd_blocks *b, const sd_precondition_case *c)
{
  const size_t blocks = (size_t) c->clumps, n = (size_t) c->n;
  b->n = c->n;
  b->width = c->width;
  b->part = c->part;
  b->parts = c->parts;
  b->blocks = c->clumps;
  b->kernels = SD_KERNELS_OF(sd_blocks, plain, sd_isa_of(SD_ISA_BEST));
  b->first = malloc(sizeof(long) * (blocks + 1));
  b->start = malloc(sizeof(long) * (blocks + 1));
  b->member = malloc(sizeof(int) * ((size_t) c->first[blocks] + 1));
  b->lone = malloc(n + 1);
  b->root = malloc(sizeof(double) * (2 * n + 1));
  if (!b->first || !b->start || !b->member || !b->lone || !b->root) return SD_ENOMEMORY;
  const long largest = fill_blocks(b, c);
  b->inverse = malloc(sizeof(double) * (size_t) (b->start[blocks] + 1));
  b->scratch = malloc(sizeof(double) * (2 * (size_t) (b->width * largest) + 1));
  return b->inverse && b->scratch ? SD_OK : SD_ENOMEMORY;
}

/* Root of the diagonal in row p of a sphere */
static double root(const sd_blocks *b, int sphere, int p)
{
  return b->root[2 * (long) sphere + (p >= 3)];
}

/* A clump without spheres that take part has nothing to invert. */
static sd_status bl_invert(sd_blocks *b, const sd_precondition_case *c, int k)
{
  const int m = (int) (b->first[k + 1] - b->first[k]);
  double *A = b->inverse + b->start[k];
  if (m == 0) return SD_OK;
  const sd_unit_submatrix clump = {&c->law, &c->spheres, b->member + b->first[k], m, b->width};
  const sd_status status = sd_unit_cholesky(&clump, A);
  if (status != SD_OK) return status;
  return sd_cholesky_inverse(b->width * m, A) == SD_OK ? SD_OK : SD_EINDEFINITE;
}

sd_status sd_blocks_make(void *blocks, const sd_precondition_case *c)
{
  sd_blocks *b = blocks;
  sd_status status = bl_allocate(b, c);
  if (status == SD_OK) sd_unit_roots(&c->spheres, c->n, b->root);
  for (int k = b->part; k < b->blocks && status == SD_OK; k += b->parts) status = bl_invert(b, c, k);
  status = sd_world_agree(&c->world, status);
  if (status != SD_OK) sd_blocks_free(b);
  return status;
}

/* z = P r in the rows of block k, P = D^1/2 C^-1 D^1/2 from right to left */
static void apply_block(const sd_blocks *b, int k, const double *r, double *z)
{
  const int *member = b->member + b->first[k], width = b->width;
  const int m = (int) (b->first[k + 1] - b->first[k]), size = width * m;
  const double *A = b->inverse + b->start[k];
  double *in = b->scratch, *out = in + size;
  for (int l = 0; l < m; l++)
    for (int p = 0; p < width; p++)
      in[width * l + p] = root(b, member[l], p) * r[width * (long) member[l] + p];
  b->kernels->multiply(size, A, in, out);
  for (int l = 0; l < m; l++)
    for (int p = 0; p < width; p++)
      z[width * (long) member[l] + p] = root(b, member[l], p) * out[width * l + p];
}

/* Many columns at once: a number of P is made once for all of them. */
void sd_blocks_multiply(const sd_blocks *b, int k, int count, const double *in, double *out)
{
  const int *member = b->member + b->first[k], width = b->width;
  const long size = width * (b->first[k + 1] - b->first[k]);
  const double *A = b->inverse + b->start[k];
  memset(out, 0, sizeof(double) * (size_t) (count * size));
  for (long p = 0; p < size; p++)
    for (long q = 0; q < size; q++) {
      const double c = root(b, member[p / width], (int) (p % width)) * A[p + size * q] *
          root(b, member[q / width], (int) (q % width));
      for (int l = 0; l < count; l++) out[count * p + l] += c * in[count * q + l];
    }
}

/* Spheres by themselves, which every part knows, are the first part's. */
sd_status sd_blocks_apply(void *ctx, const double *r, double *z)
{
  const sd_blocks *b = ctx;
  const long width = b->width;
  memset(z, 0, sizeof(double) * (size_t) (width * b->n));
  for (int i = 0; i < b->n && b->part == 0; i++)
    for (int p = 0; p < width && b->lone[i]; p++)
      z[width * i + p] = root(b, i, p) * root(b, i, p) * r[width * i + p];
  for (int k = b->part; k < b->blocks; k += b->parts) apply_block(b, k, r, z);
  return SD_OK;
}

const sd_precondition_kind sd_precondition_blocks = {sizeof(sd_blocks), sd_blocks_make,
                                                     sd_blocks_apply, sd_blocks_free};
