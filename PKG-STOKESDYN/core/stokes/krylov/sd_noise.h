/* Random numbers whose covariance is a symmetric positive definite matrix M, from products with M
 * alone: Lanczos's process on A = P^T M P, P = D^1/2 or blocks, begun from standard normal numbers w.
 *
 *   A V = V T + ...,  V [m] orthonormal, the first w/|w|;  T tridiagonal;  p = T^1/2 e1,  c = T^-1/2 e1
 *   y = |w| P^-T V p      covariance M          velocities sqrt(2 kT/dt) y
 *
 * After m products the covariance is diagonal in the eigenvectors of A, as M's own is, so that only
 * the variances of modes are wrong. Each mode counts by its own variance in
 *
 *   e^2 = dc.T dc,  dc = c of this product less c of the last one
 *
 * the step in the energy norm, by which the process stops: the variance of the worst mode is then
 * wrong by 1 to 4 e (slow modes too large). The usual rule, the step of y in the Euclidean norm, is blind
 * to slow modes: it leaves them 3 to 30 per cent off.
 *
 * Every vector is orthogonalised against all before it, twice, so that rounding copies no mode.
 * Source: Chow & Saad, SIAM J. Sci. Comput. 36, A588 (2014), for the method; the rule is our own. */
#ifndef SD_NOISE_H
#define SD_NOISE_H

#include <stddef.h>

#include "sd_solve.h"

SD_BEGIN_C

/* Products beyond which the process gives up */
enum { SD_NOISE_MOST = 100 };

typedef struct {
  /* numbers of this rank */
  long n;
  /* M, all of it */
  sd_apply *apply;
  void *ctx;
  /* [n] D, about the inverse of M's diagonal; 0: M has no such row, y is 0 there */
  const double *D;
  /* out = P v, also in its place, for a better P: P P^T about the inverse of M. D then only tells which
   * rows there are. NULL: P = D^1/2. half_back: out = P^T v likewise; half_inverse:
   * out = P^-T v */
  sd_apply *half, *half_back, *half_inverse;
  void *half_ctx;
  /* sum */
  sd_world world;
} sd_noise_matrix;

/* The vectors V, which stay from one draw to the next. Zero-initialise; sd_noise_free in the end. */
typedef struct {
  double *row[SD_NOISE_MOST + 1];
  size_t room[SD_NOISE_MOST + 1];
  /* [n] P times a row, on its way into the product */
  double *work;
  size_t work_room;
} sd_noise;

typedef struct {
  int products;
  /* e as above */
  double error;
} sd_noise_report;

/* y [n] of covariance M from independent standard normal numbers w [n]; e < tolerance. On all ranks
 * together. SD_OK; SD_EINDEFINITE: M has an eigenvalue <= 0; SD_EMAXITER after SD_NOISE_MOST products,
 * y as it is then; SD_ENOTFINITE; SD_ENOMEMORY; that of apply. */
sd_status sd_noise_velocities(sd_noise *s, const sd_noise_matrix *M, const double *w, double tolerance,
                              double *y, sd_noise_report *report);

/* y [n] = scale (y + other): all of what is drawn in parts (other NULL: y alone), as a velocity or a force of
 * noise, scale sqrt(2 kT/dt) */
void sd_noise_join(long n, double scale, const double *other, double *y);

void sd_noise_free(sd_noise *s);

SD_END_C
#endif
