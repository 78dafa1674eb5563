/* Smoothing kernels W(r, h) of smoothed particle hydrodynamics in 2 and 3 dimensions. Both vanish
 * at r = 2 h. With q = r / h,
 *   W  = N / h^d     K(q)
 *   W' = N / h^(d+1) q G(q),  so W'/r = N / h^(d+2) G(q): grad W = (W'/r) r needs no division by r
 *
 *                 K(q)                         G(q)                N in 3-D       N in 2-D
 *   cubic spline  (2-q)^3 - 4 (1-q)^3  q < 1   9 q - 12            1 / (4 pi)     5 / (14 pi)
 *                 (2-q)^3              q > 1   -3 (2-q)^2 / q
 *   Wendland C2   (1-q/2)^4 (2 q + 1)          -5 (1-q/2)^3        21 / (16 pi)   7 / (4 pi)
 *
 * N makes the integral over the support 1. Source: Monaghan & Lattanzio 1985 (cubic spline),
 * Wendland 1995. */
#ifndef SD_SPH_KERNEL_H
#define SD_SPH_KERNEL_H

#include "sd_extern_c.h"

SD_BEGIN_C

typedef enum { SD_SPH_CUBICSPLINE, SD_SPH_WENDLAND } sd_sph_kernel;

/* N; K and G for q >= 0, both 0 from q = 2 on. */
double sd_sph_norm(sd_sph_kernel kernel, int dimension);
double sd_sph_K(sd_sph_kernel kernel, double q);
double sd_sph_G(sd_sph_kernel kernel, double q);

/* W and W'/r for one distance r >= 0, h > 0. */
double sd_sph_W(sd_sph_kernel kernel, int dimension, double r, double h);
double sd_sph_dW_over_r(sd_sph_kernel kernel, int dimension, double r, double h);

SD_END_C
#endif
