/* Polynomials on [-1, 1] through samples of a smooth function. In long double, since powers of high
 * degree multiply its rounding. */
#ifndef SD_CHEBYSHEV_H
#define SD_CHEBYSHEV_H

#include "sd_extern_c.h"

SD_BEGIN_C

enum { SD_CHEBYSHEV_MOST = 64 };

/* Where sample s of n is taken, n up to SD_CHEBYSHEV_MOST */
long double sd_chebyshev_node(int s, int n);

/* series [n] from sample [n]: the function is sum_k series[k] T_k */
void sd_chebyshev_series(const long double *sample, int n, long double *series);

/* The same up to a degree in powers: coefficient [degree + 1], of 1, t, t^2 ... */
void sd_chebyshev_powers(const long double *series, int degree, double *coefficient);

SD_END_C
#endif
