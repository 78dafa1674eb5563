#include "sd_image_wave.h"

#include <math.h>

#include "sd_constants.h"

/* Radial functions as lists: f[n] = (1/R d/dR)^n f. Derivatives along directions are then
 *   d_k f = f[1] R_k,   d_k d_l f = f[1] delta_kl + f[2] R_k R_l   and so on. */
enum { MOST = 8 };

/* Laplacian: lap f = 3 f[1] + R^2 f[2], and (1/R d/dR)^n (R^2 g) = R^2 g[n] + 2n g[n - 1] */
static void laplacian(double R2, const double *f, int terms, double *lap)
{
  for (int n = 0; n < terms; n++) lap[n] = (3.0 + 2.0 * n) * f[n + 1] + R2 * f[n + 2];
}

/* erf(xi R)/R, the first `terms`. With E = 2 xi/sqrt(pi) exp(-q), q = (xi R)^2,
 *   R^2 L[n + 1] = (-2 xi^2)^n E - (2n + 1) L[n],
 * which cancels where q is small. There downwards, from the series of the last,
 *   L[n] = (-2 xi^2)^n E sum_k (2q)^k/((2n + 1) (2n + 3) ... (2n + 2k + 1)) */
static void filtered_inverse(double xi, double R2, int terms, double *L)
{
  const double q = xi * xi * R2, root = sqrt(R2), step = -2.0 * xi * xi;
  double unit = q > 42.0 ? 0.0 : 2.0 * xi / sqrt(SD_PI) * exp(-q);
  if (q > 2.5) {
    L[0] = (q > 42.0 ? 1.0 : erf(xi * root)) / root;
    for (int n = 0; n + 1 < terms; n++, unit *= step)
      L[n + 1] = (unit - (2.0 * n + 1.0) * L[n]) / R2;
    return;
  }
  const int last = terms - 1;
  double term = 1.0 / (2.0 * last + 1.0), sum = term;
  for (int k = 1; k < 200 && term > 1e-17 * sum; k++) {
    term *= 2.0 * q / (2.0 * (last + k) + 1.0);
    sum += term;
  }
  for (int n = 0; n < last; n++) unit *= step;
  L[last] = unit * sum;
  for (int n = last - 1; n >= 0; n--) {
    unit /= step;
    L[n] = (unit - R2 * L[n + 1]) / (2.0 * n + 1.0);
  }
}

/* Its Laplacian, -4 pi times a Gaussian */
static void filtered_delta(double xi, double R2, int terms, double *g)
{
  const double q = xi * xi * R2;
  g[0] = q > 42.0 ? 0.0 : -4.0 * xi * xi * xi / sqrt(SD_PI) * exp(-q);
  for (int n = 1; n < terms; n++) g[n] = -2.0 * xi * xi * g[n - 1];
}

/* lap^s L, s = 0 ... 3 */
typedef struct {
  double xi, R2, a2, L[4][MOST];
} filtered;

/* The first `terms` of L itself. laplacians: with those of L that spheres with b other than 0 take
 * too */
static filtered filtered_at(const sd_image_filter *filter, double R2, int terms, int laplacians)
{
  filtered f;
  f.xi = filter->xi;
  f.R2 = R2;
  f.a2 = filter->a_ref * filter->a_ref / 3.0;
  filtered_inverse(f.xi, R2, terms, f.L[0]);
  filtered_delta(f.xi, R2, laplacians ? MOST : 1, f.L[1]);
  if (laplacians) {
    laplacian(R2, f.L[1], 5, f.L[2]);
    laplacian(R2, f.L[2], 3, f.L[3]);
  }
  return f;
}

/* lap^s G. The biharmonic function whose gradient is R L has H = (1 + x) exp(-x), and the Laplacian
 * 2 L_H, L_H = L - lap L/(4 xi^2): G = (2 L + R^2 L[1]) 1 - L[1] R R. From then on, and for the part
 * of a_ref, lap (2 L 1 - ...) = 2 (lap L 1 - grad grad L). */
static void stokeslet(const filtered *f, int s, double *I, double *J)
{
  const double x = 0.25 / (f->xi * f->xi);
  const double *L = f->L[0];
  if (s == 0) {
    *I = 2.0 * L[0] + f->R2 * L[1];
    *J = -L[1];
  } else {
    const double *below = f->L[s - 1], *at = f->L[s], *above = f->L[s + 1];
    *I = 2.0 * (at[0] - x * above[0] - below[1] + x * at[1]);
    *J = -2.0 * (below[2] - x * at[2]);
  }
  const double *next = f->L[s + 1], *here = f->L[s];
  *I += 2.0 * f->a2 * (next[0] - here[1]);
  *J -= 2.0 * f->a2 * here[2];
}

sd_image_radial sd_image_radial_at(const sd_image_filter *filter, double R)
{
  const filtered f = filtered_at(filter, R * R, 3, 0);
  sd_image_radial r = {.L1 = f.L[0][1], .L2 = f.L[0][2]};
  stokeslet(&f, 0, &r.I, &r.J);
  return r;
}

/* (1) with the ends of both spheres, sorted by f, R and z */
void sd_image_wave(const sd_image_filter *filter, const double xi[3], double a, const double xj[3],
                   double b, double c[5])
{
  const double g = xi[2], h = xj[2], x = xi[0] - xj[0], y = xi[1] - xj[1], z = g + h;
  const double A = a * a / 6.0, B = b * b / 6.0, ref = filter->a_ref * filter->a_ref / 6.0;
  const double bi = A - ref, bj = B - ref;
  const int apart = bi != 0.0 || bj != 0.0;
  const filtered f = filtered_at(filter, x * x + y * y + z * z, 5, apart);
  double I, J, I1, J1, I2, J2;
  stokeslet(&f, 0, &I, &J);
  if (apart) {
    stokeslet(&f, 1, &I1, &J1);
    stokeslet(&f, 2, &I2, &J2);
    I += (bi + bj) * I1 + bi * bj * I2;
    J += (bi + bj) * J1 + bi * bj * J2;
  }
  /* L with 1 + b lap of both, of i, of j, of none */
  double both[5], of_i[5], of_j[5], X[5], Q[5];
  const double *L = f.L[0];
  for (int n = 0; n < 5; n++) {
    const double L1 = apart ? f.L[1][n] : 0.0, L2 = apart ? f.L[2][n] : 0.0;
    of_i[n] = L[n] + bi * L1;
    of_j[n] = L[n] + bj * L1;
    both[n] = L[n] + (bi + bj) * L1 + bi * bj * L2;
    /* the derivatives that come with heights, of one end and of both */
    X[n] = 4.0 * (g * bj * of_i[n] + h * bi * of_j[n] + z * ref * both[n]);
    Q[n] = 8.0 * (bi * bj * L[n] + ref * (bi * of_j[n] + bj * of_i[n] + ref * both[n]));
  }
  const double gh = 2.0 * g * h, sides = X[2] + 2.0 * z * Q[3];
  const double turn = (g - h) * both[1] + 2.0 * z * (bi * of_j[2] - bj * of_i[2]);
  c[0] = -I + gh * both[1] + X[2] * z + Q[2] + z * z * Q[3];
  c[1] = 2.0 * I + 2.0 * Q[2];
  c[2] = -J + gh * both[2] + X[3] * z + Q[3] + z * z * Q[4];
  c[3] = J * z - turn + sides;
  c[4] = J * z + turn + sides;
}
