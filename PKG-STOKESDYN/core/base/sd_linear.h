/* Small and dense linear algebra: eigenvalues of small symmetric matrices, Cholesky (LAPACK),
 * rotations. */
#ifndef SD_LINEAR_H
#define SD_LINEAR_H

#include "sd_status.h"

SD_BEGIN_C

/* Eigenvalues w [n], largest first, and eigenvectors, the columns of V [n n] row-major, of the
 * symmetric A [n n]; n <= 6. Jacobi's rotations. */
void sd_eigen(int n, const double *A, double *w, double *V);

/* Pseudo-inverse of the symmetric positive semidefinite 6x6 resistance or mobility about some
 * point:
 * eigenvalues below 1e-9 of the largest count as zero. Rotations are first made comparable to
 * translations by the length that the matrix itself has, (tr RR / tr TT)^(1/2). */
void sd_pseudo_inverse6(const double R[36], double inverse[36]);

/* Before the first of the functions below: OpenBLAS maps 134 MB at its first call, and where an
 * address space has not got them it tries for ever. SD_OK; SD_ENOMEMORY: there is no such room, so
 * that they must not be called. Takes nothing; 0.1 ms. */
sd_status sd_linear_room(void);

/* Lower Cholesky factor of the symmetric positive definite A [n n], in its place. One triangle is
 * enough: elements A[p + n q], p >= q, that is the lower one by columns or the upper one by rows.
 * The only functions that call LAPACK: one thread whatever the library is set to.
 * SD_OK; SD_ESINGULAR when a pivot is not positive; SD_ENOTFINITE. */
sd_status sd_cholesky(int n, double *A);
sd_status sd_cholesky_single(int n, float *A);

/* A^-1 [n n], both triangles, from the factor of A in its place. SD_OK; SD_ESINGULAR. */
sd_status sd_cholesky_inverse(int n, double *A);

/* The same from A itself, as of sd_cholesky. Status of that. */
sd_status sd_inverse(int n, double *A);

/* B [count][n] becomes A^-1 B, from the factor of A: one right-hand side after the other. */
void sd_cholesky_apply(int n, const double *A, int count, double *B);

/* G [n n] += A^T B of A, B [rows][n], row-major, whose product is symmetric: at least the triangle
 * that sd_cholesky reads. A and B may be one. */
void sd_add_gram(int n, int rows, const double *A, const double *B, double *G);

/* Solve A X = B: A as of sd_cholesky, destroyed; B [count][n], one right-hand side after the other,
 * X in its place. Status of sd_cholesky. */
sd_status sd_cholesky_solve(int n, double *A, int count, double *B);

/* The symmetric A^1/2 [n n] of the symmetric positive semidefinite A [n n], in its place;
 * eigenvalues below 0 are rounding, and count as 0. SD_OK; SD_ENOMEMORY; SD_ENOTFINITE. */
sd_status sd_symmetric_root(int n, double *A);

/* Eigenvalues d [n], smallest first, and eigenvectors of the symmetric tridiagonal matrix with
 * diagonal d [n] in and e [n - 1], destroyed, beside it: row k of Z [n n], out, belongs to d[k].
 * work [2 n]. Z, work NULL: values alone. SD_OK; SD_ENOTFINITE. */
sd_status sd_tridiagonal_eigen(int n, double *d, double *e, double *Z, double *work);

/* Where element p, q of a symmetric 3x3 stands in its xx yy zz xy xz yz */
static inline int sd_symmetric3_at(int p, int q)
{
  return p == q ? p : p + q + 2;
}

/* In that order: S += c (a b + b a - 2/3 a.b)/2, the symmetric traceless part of a first moment */
void sd_add_deviator(double c, const double a[3], const double b[3], double S[6]);

/* y = A x; y = A^T x; C = A B. 3x3 row-major, no aliasing. */
static inline void sd_multiply3(const double A[9], const double x[3], double y[3])
{
  for (int p = 0; p < 3; p++) y[p] = A[3 * p] * x[0] + A[3 * p + 1] * x[1] + A[3 * p + 2] * x[2];
}
static inline void sd_multiply3t(const double A[9], const double x[3], double y[3])
{
  for (int p = 0; p < 3; p++) y[p] = A[p] * x[0] + A[3 + p] * x[1] + A[6 + p] * x[2];
}
static inline void sd_product3(const double A[9], const double B[9], double C[9])
{
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++)
      C[3 * p + q] = A[3 * p] * B[q] + A[3 * p + 1] * B[3 + q] + A[3 * p + 2] * B[6 + q];
}
static inline void sd_cross(const double a[3], const double b[3], double c[3])
{
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}
static inline double sd_dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static inline void sd_minus(const double a[3], const double b[3], double c[3])
{
  for (int d = 0; d < 3; d++) c[d] = a[d] - b[d];
}
static inline double sd_distance_squared(const double a[3], const double b[3])
{
  double r[3];
  sd_minus(a, b, r);
  return sd_dot(r, r);
}

/* v / |v|, in its place */
void sd_normalize(double v[3]);

/* Some unit vector across e, which is not 0 */
void sd_across(const double e[3], double f[3]);

SD_END_C
#endif
