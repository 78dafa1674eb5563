/* Between the files of this room: the matrix that preconditioners are made of, and their kernels, of
 * which each instruction set has its own build. */
#ifndef SD_PRECONDITION_INTERNAL_H
#define SD_PRECONDITION_INTERNAL_H

#include "sd_isa.h"
#include "sd_waves.h"

/* --- sd_unit.c --- */

/* The mobility matrix of a few spheres scaled to unit diagonal, C = D^1/2 M D^1/2, D = 6 pi eta a
 * in the rows of forces and 8 pi eta a^3 in those of torques: its blocks depend on positions, radii
 * and the law only. Above a wall the diagonal has the sphere's own image besides. Preconditioners
 * are made of its parts. width: 3 (forces), or 6 (forces and torques, sd_tensor_grand; not with
 * SD_TENSOR_OSEEN). */

/* Roots of D [2n]: (6 pi eta a)^1/2 and (8 pi eta a^3)^1/2 of each sphere; 0 for those that take no
 * part. */
void sd_unit_roots(const sd_spheres *s, int n, double *root);

/* Its rows and columns of the spheres member[0 ... m-1] */
typedef struct {
  const sd_law *law;
  const sd_spheres *spheres;
  const int *member;
  int m, width;
} sd_unit_submatrix;

/* Cholesky factor of these, in the lower triangle of A [(width m)^2], column-major. Singular within
 * rounding (spheres at one point): that of C with a small diagonal added. SD_OK; SD_EINDEFINITE;
 * SD_ENOTFINITE. */
sd_status sd_unit_cholesky(const sd_unit_submatrix *c, double *A);

/* The same in single precision, which is enough for an approximation of the inverse and takes two
 * thirds of the time. Also SD_ESINGULAR: too near to singular for it, as spheres nearly at one
 * point are. */
sd_status sd_unit_cholesky_single(const sd_unit_submatrix *c, float *A);

/* --- blocks of clumps --- */

struct sd_blocks_kernels {
  /* out [size] = A in; A [size size] by columns */
  void (*multiply)(long size, const double *A, const double *in, double *out);
};

SD_KERNEL_TABLES(struct sd_blocks_kernels, sd_blocks);

/* --- the sparse factor --- */

/* A block by columns of floats. Width 3: each column has a fourth number, 0; width 6: the kernels
 * read the next two numbers with each column, which do no harm. */
static inline int sd_sparse_floats(int width)
{
  return width == 3 ? 12 : 36;
}

/* out += L (L^T in), one column of blocks after the other: t = L_k^T in needs all of it, then L_k t
 * is added while it is still in the cache. The numbers of a sphere stand every 4 (width 3) or 8
 * (width 6); those beyond its width are 0 in `in` and mean nothing in `out`. */
typedef void sd_sparse_product(int columns, const long *first, const int *row, const float *value,
                               const double *in, double *out);

struct sd_sparse_kernels {
  sd_sparse_product *three, *six;
};

SD_KERNEL_TABLES(struct sd_sparse_kernels, sd_sparse);

/* --- the long waves --- */

/* Of this rank's rows of Z: y [SD_WAVES_COLUMNS] = Z^T F; F -= Z y; and the rows of some spheres as
 * they are, [width count][SD_WAVES_COLUMNS] */
struct sd_waves_kernels {
  void (*multiply)(const sd_waves *p, const double *F, double *y);
  void (*subtract)(const sd_waves *p, const double *y, double *F);
  void (*rows)(const sd_waves *p, const int *sphere, int count, double *rows);
};

SD_KERNEL_TABLES(struct sd_waves_kernels, sd_waves);

#endif
