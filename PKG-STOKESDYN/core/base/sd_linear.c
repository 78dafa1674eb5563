#include "sd_linear.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* LAPACK, Fortran: all by reference, column-major, the lengths of character arguments in the
 * end. */
void dpotrf_(const char *uplo, const int *n, double *A, const int *lda, int *info, size_t);
void spotrf_(const char *uplo, const int *n, float *A, const int *lda, int *info, size_t);
void dstev_(const char *job, const int *n, double *d, double *e, double *Z, const int *ldz, double *work,
            int *info, size_t);
void dsyev_(const char *job, const char *uplo, const int *n, double *A, const int *lda, double *w,
            double *work, const int *lwork, int *info, size_t, size_t);
void dpotri_(const char *uplo, const int *n, double *A, const int *lda, int *info, size_t);
void dsyrk_(const char *uplo, const char *trans, const int *n, const int *k, const double *alpha,
            const double *A, const int *lda, const double *beta, double *C, const int *ldc, size_t,
            size_t);
void dgemm_(const char *transA, const char *transB, const int *m, const int *n, const int *k,
            const double *alpha, const double *A, const int *lda, const double *B, const int *ldb,
            const double *beta, double *C, const int *ldc, size_t, size_t);
void dpotrs_(const char *uplo, const int *n, const int *count, const double *A, const int *lda,
             double *B, const int *ldb, int *info, size_t);

/* OpenBLAS may start as many threads as there are cores, on every MPI rank: n ranks, n times the
 * cores. It is held to one from here on until threads_as_before(). Its functions are looked up
 * weakly, as other libraries do not have them. */
#if defined(__GNUC__) && !defined(__APPLE__)
__attribute__((weak)) void openblas_set_num_threads(int);
__attribute__((weak)) int openblas_get_num_threads(void);
static int one_thread(void)
{
  if (!openblas_set_num_threads || !openblas_get_num_threads) return 0;
  const int before = openblas_get_num_threads();
  if (before > 1) openblas_set_num_threads(1);
  return before;
}
static void threads_as_before(int before)
{
  if (before > 1) openblas_set_num_threads(before);
}
#else
static int one_thread(void)
{
  return 0;
}
static void threads_as_before(int before)
{
  (void) before;
}
#endif

sd_status sd_linear_room(void)
{
  void *volatile room = malloc(136u << 20); /* volatile: else no compiler asks for it */
  if (!room) return SD_ENOMEMORY;
  free(room);
  return SD_OK;
}

/* info of a factor: the pivot, counted from 1, that is not positive. A NaN is neither, and need not
 * stop LAPACK; it stays in its pivot. */
sd_status sd_cholesky(int n, double *A)
{
  const int before = one_thread();
  int info;
  dpotrf_("L", &n, A, &n, &info, 1);
  threads_as_before(before);
  for (long p = 0; p < (info ? info : n); p++)
    if (!(fabs(A[p * (n + 1)]) < INFINITY)) return SD_ENOTFINITE;
  return info == 0 ? SD_OK : SD_ESINGULAR;
}

sd_status sd_cholesky_single(int n, float *A)
{
  const int before = one_thread();
  int info;
  spotrf_("L", &n, A, &n, &info, 1);
  threads_as_before(before);
  for (long p = 0; p < (info ? info : n); p++)
    if (!(fabsf(A[p * (n + 1)]) < INFINITY)) return SD_ENOTFINITE;
  return info == 0 ? SD_OK : SD_ESINGULAR;
}

sd_status sd_cholesky_inverse(int n, double *A)
{
  const int before = one_thread();
  int info;
  dpotri_("L", &n, A, &n, &info, 1);
  threads_as_before(before);
  for (long q = 0; q < n; q++)
    for (long p = 0; p < q; p++) A[p + n * q] = A[q + n * p];
  return info == 0 ? SD_OK : SD_ESINGULAR;
}

sd_status sd_inverse(int n, double *A)
{
  const sd_status status = sd_cholesky(n, A);
  return status == SD_OK ? sd_cholesky_inverse(n, A) : status;
}

/* info of dpotrs is about its arguments alone */
void sd_cholesky_apply(int n, const double *A, int count, double *B)
{
  const int before = one_thread();
  int info;
  dpotrs_("L", &n, &count, A, &n, B, &n, &info, 1);
  threads_as_before(before);
}

sd_status sd_cholesky_solve(int n, double *A, int count, double *B)
{
  const sd_status status = sd_cholesky(n, A);
  if (status == SD_OK) sd_cholesky_apply(n, A, count, B);
  return status;
}

/* Rows are the columns of a matrix to Fortran: G = A B^T of what it sees. */
void sd_add_gram(int n, int rows, const double *A, const double *B, double *G)
{
  const double one = 1.0;
  const int before = one_thread();
  if (A == B)
    dsyrk_("L", "N", &n, &rows, &one, A, &n, &one, G, &n, 1, 1);
  else
    dgemm_("N", "T", &n, &n, &rows, &one, A, &n, B, &n, &one, G, &n, 1, 1);
  threads_as_before(before);
}

/* A = Z^T diag(d) Z with eigenvectors as rows of Z: the root is Y^T Y, Y = diag(d^1/4) Z. */
sd_status sd_symmetric_root(int n, double *A)
{
  const size_t square = (size_t) n * (size_t) n;
  const int room = 34 * n;
  double *d = malloc(sizeof(double) * (size_t) (n + room)), *Y = malloc(sizeof(double) * square);
  int info = 0;
  sd_status status = d && Y ? SD_OK : SD_ENOMEMORY;
  for (size_t e = 0; e < square && status == SD_OK; e++)
    if (!isfinite(A[e])) status = SD_ENOTFINITE;
  if (status == SD_OK) {
    const int before = one_thread();
    memcpy(Y, A, sizeof(double) * square);
    dsyev_("V", "L", &n, Y, &n, d, d + n, &room, &info, 1, 1);
    threads_as_before(before);
    if (info != 0) status = SD_ENOTFINITE;
  }
  if (status == SD_OK) {
    for (size_t e = 0; e < square; e++) Y[e] *= sqrt(sqrt(fmax(d[e / (size_t) n], 0.0)));
    memset(A, 0, sizeof(double) * square);
    sd_add_gram(n, n, Y, Y, A);
    for (size_t q = 0; q < (size_t) n; q++)
      for (size_t p = 0; p < q; p++) A[p + (size_t) n * q] = A[q + (size_t) n * p];
  }
  free(d);
  free(Y);
  return status;
}

/* Columns are rows here. */
sd_status sd_tridiagonal_eigen(int n, double *d, double *e, double *Z, double *work)
{
  for (int k = 0; k < n; k++)
    if (!isfinite(d[k]) || (k + 1 < n && !isfinite(e[k]))) return SD_ENOTFINITE;
  const int before = one_thread();
  int info;
  dstev_(Z ? "V" : "N", &n, d, e, Z, &n, work, &info, 1);
  threads_as_before(before);
  return info == 0 ? SD_OK : SD_ENOTFINITE;
}

/* Jacobi: a rotation by phi in the plane of p and q makes a_pq zero when cot(2 phi) = theta = (a_qq
 * - a_pp)/(2 a_pq); t = tan(phi) is the smaller root of t^2 + 2 theta t - 1 = 0, written so that
 * nothing cancels. Each rotation takes 2 a_pq^2 off the sum of squares beside the diagonal, and
 * once that is small a sweep squares it: six or seven sweeps, and 50 are never used up. */
void sd_eigen(int n, const double *A, double *w, double *V)
{
  double a[36];
  memcpy(a, A, sizeof(double) * (size_t) (n * n));
  for (int i = 0; i < n * n; i++) V[i] = i % (n + 1) == 0;
  for (int sweep = 0; sweep < 50; sweep++) {
    double off = 0.0, all = 0.0;
    for (int p = 0; p < n; p++)
      for (int q = 0; q < n; q++) {
        all += a[n * p + q] * a[n * p + q];
        if (p != q) off += a[n * p + q] * a[n * p + q];
      }
    if (!(off > 1e-36 * all)) break;
    for (int p = 0; p < n; p++)
      for (int q = p + 1; q < n; q++) {
        const double h = a[n * p + q];
        if (h == 0.0) continue;
        const double theta = 0.5 * (a[n * q + q] - a[n * p + p]) / h;
        const double t = (theta < 0.0 ? -1.0 : 1.0) / (fabs(theta) + sqrt(1.0 + theta * theta));
        const double c = 1.0 / sqrt(1.0 + t * t), s = t * c;
        for (int k = 0; k < n; k++) { /* columns p and q */
          const double x = a[n * k + p], y = a[n * k + q];
          a[n * k + p] = c * x - s * y;
          a[n * k + q] = s * x + c * y;
          const double v = V[n * k + p], u = V[n * k + q];
          V[n * k + p] = c * v - s * u;
          V[n * k + q] = s * v + c * u;
        }
        for (int k = 0; k < n; k++) { /* rows p and q */
          const double x = a[n * p + k], y = a[n * q + k];
          a[n * p + k] = c * x - s * y;
          a[n * q + k] = s * x + c * y;
        }
      }
  }
  /* largest first, each with its column of V */
  for (int i = 0; i < n; i++) w[i] = a[n * i + i];
  for (int i = 0; i < n; i++) {
    int m = i;
    for (int j = i + 1; j < n; j++)
      if (w[j] > w[m]) m = j;
    if (m == i) continue;
    const double x = w[i];
    w[i] = w[m];
    w[m] = x;
    for (int k = 0; k < n; k++) {
      const double v = V[n * k + i];
      V[n * k + i] = V[n * k + m];
      V[n * k + m] = v;
    }
  }
}

void sd_add_deviator(double c, const double a[3], const double b[3], double S[6])
{
  static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
  const double trace = sd_dot(a, b) / 3.0;
  for (int e = 0; e < 6; e++) {
    const int p = row[e], q = column[e];
    S[e] += c * (0.5 * (a[p] * b[q] + a[q] * b[p]) - (p == q ? trace : 0.0));
  }
}

void sd_normalize(double v[3])
{
  const double inverse = 1.0 / sqrt(sd_dot(v, v));
  for (int d = 0; d < 3; d++) v[d] *= inverse;
}

/* Across e and the axis that is farthest from it, so that nothing cancels in the product */
void sd_across(const double e[3], double f[3])
{
  int least = 0;
  double axis[3] = {0.0, 0.0, 0.0};
  for (int d = 1; d < 3; d++)
    if (fabs(e[d]) < fabs(e[least])) least = d;
  axis[least] = 1.0;
  sd_cross(e, axis, f);
  sd_normalize(f);
}

/* With L = diag(1, 1, 1, l, l, l) the matrix A = L^-1 R L^-1 has one unit throughout, so that
 * "small beside the largest" means something; R^+ = L^-1 A^+ L^-1. */
void sd_pseudo_inverse6(const double R[36], double inverse[36])
{
  const double tt = R[0] + R[7] + R[14], rr = R[21] + R[28] + R[35];
  const double length = tt > 0.0 && rr > 0.0 ? sqrt(rr / tt) : 1.0;
  double A[36], w[6], V[36];
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 6; q++)
      A[6 * p + q] = R[6 * p + q] / ((p < 3 ? 1.0 : length) * (q < 3 ? 1.0 : length));
  sd_eigen(6, A, w, V);
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 6; q++) {
      double s = 0.0;
      for (int k = 0; k < 6; k++)
        if (w[k] > 1e-9 * w[0]) s += V[6 * p + k] * V[6 * q + k] / w[k];
      inverse[6 * p + q] = s / ((p < 3 ? 1.0 : length) * (q < 3 ? 1.0 : length));
    }
}
