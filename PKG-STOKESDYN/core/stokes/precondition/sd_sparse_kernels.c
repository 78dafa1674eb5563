/* Kernels of the sparse factor. */
#include "sd_precondition_internal.h"

#if SD_LANES > 1
#define LEAST_LANES 4
#endif
#include "sd_lanes.h"

#if SD_LANES > 1
typedef float row4_floats __attribute__((vector_size(16), aligned(4), may_alias));

INLINE row4 column_at(const float *value)
{
  return __builtin_convertvector(*(const row4_floats *) value, row4);
}

/* The fourth number is padding. */
static void sparse_three(int columns, const long *first, const int *row, const float *value,
                         const double *in, double *out)
{
  for (int k = 0; k < columns; k++) {
    row4 s0 = {0.0, 0.0, 0.0, 0.0}, s1 = s0, s2 = s0;
    for (long l = first[k]; l < first[k + 1]; l++) { /* t = L^T in */
      const row4 v = load4(in + 4 * (long) row[l]);
      s0 += column_at(value + 12 * l) * v;
      s1 += column_at(value + 12 * l + 4) * v;
      s2 += column_at(value + 12 * l + 8) * v;
    }
    const double t0 = s0[0] + s0[1] + s0[2], t1 = s1[0] + s1[1] + s1[2], t2 = s2[0] + s2[1] + s2[2];
    for (long l = first[k]; l < first[k + 1]; l++) { /* out += L t */
      double *o = out + 4 * (long) row[l];
      store4(o, load4(o) + (column_at(value + 12 * l) * t0 + column_at(value + 12 * l + 4) * t1 +
                            column_at(value + 12 * l + 8) * t2));
    }
  }
}
#endif

/* Two rows of four for the six numbers of a sphere, where six columns fit into registers */
#if SD_LANES >= 4
static void six(int columns, const long *first, const int *row, const float *value,
                const double *in, double *out)
{
  for (int k = 0; k < columns; k++) {
    row4 s[6] = {{0.0}}, t[6];
    for (long l = first[k]; l < first[k + 1]; l++) { /* t = L^T in */
      const row4 low = load4(in + 8 * (long) row[l]), high = load4(in + 8 * (long) row[l] + 4);
#pragma GCC unroll 6
      for (int q = 0; q < 6; q++)
        s[q] += column_at(value + 36 * l + 6 * q) * low + column_at(value + 36 * l + 6 * q + 4) * high;
    }
    for (int q = 0; q < 6; q++) {
      const double sum = s[q][0] + s[q][1] + s[q][2] + s[q][3];
      t[q] = (row4){sum, sum, sum, sum};
    }
    for (long l = first[k]; l < first[k + 1]; l++) { /* out += L t */
      double *o = out + 8 * (long) row[l];
      row4 low = load4(o), high = load4(o + 4);
#pragma GCC unroll 6
      for (int q = 0; q < 6; q++) {
        low += column_at(value + 36 * l + 6 * q) * t[q];
        high += column_at(value + 36 * l + 6 * q + 4) * t[q];
      }
      store4(o, low);
      store4(o + 4, high);
    }
  }
}
#endif

/* Number by number */
#if SD_LANES < 4
INLINE void plain(int width, int columns, const long *first, const int *row, const float *value, const double *in,
                  double *out)
{
  const int size = sd_sparse_floats(width), lda = width == 3 ? 4 : 6, step = width == 3 ? 4 : 8;
  for (int k = 0; k < columns; k++) {
    double t[6] = {0.0};
    for (long l = first[k]; l < first[k + 1]; l++)
      for (int q = 0; q < width; q++)
        for (int p = 0; p < width; p++)
          t[q] += value[size * l + lda * q + p] * in[step * (long) row[l] + p];
    for (long l = first[k]; l < first[k + 1]; l++)
      for (int q = 0; q < width; q++)
        for (int p = 0; p < width; p++)
          out[step * (long) row[l] + p] += value[size * l + lda * q + p] * t[q];
  }
}

static void six(int columns, const long *first, const int *row, const float *value,
                const double *in, double *out)
{
  plain(6, columns, first, row, value, in, out);
}
#endif
#if SD_LANES == 1
static void sparse_three(int columns, const long *first, const int *row, const float *value,
                         const double *in, double *out)
{
  plain(3, columns, first, row, value, in, out);
}
#endif

const struct sd_sparse_kernels SD_KERNELS(sd_sparse) = {sparse_three, six};
