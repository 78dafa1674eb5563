/* Lagrange's polynomials of even steps: the weights of values at 0, 1 ... n - 1 for that at t.
 *   inverse [n]   1/(prod over l != k of (k - l))
 *   w [n]         out */
#ifndef SD_LAGRANGE_H
#define SD_LAGRANGE_H

/* What is below a node times what is above it. */
static inline void sd_lagrange(double t, int n, const double *inverse, double *w)
{
  double above = 1.0;
  w[0] = 1.0;
  for (int k = 1; k < n; k++) w[k] = w[k - 1] * (t - (k - 1));
  for (int k = n - 1; k >= 0; k--) {
    w[k] = w[k] * above * inverse[k];
    above *= t - k;
  }
}

static inline void sd_lagrange_inverse(int n, double *inverse)
{
  for (int k = 0; k < n; k++) {
    inverse[k] = 1.0;
    for (int l = 0; l < n; l++)
      if (l != k) inverse[k] /= k - l;
  }
}

#endif
