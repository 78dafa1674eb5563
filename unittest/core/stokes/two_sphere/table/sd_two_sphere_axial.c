#include <math.h>

#include "sd_two_sphere_modes_internal.h"

/* The fluid only turns about the axis, its velocity is harmonic with sin t P_n'(m). On a sphere it
 * is W rho, so that the modes there are 2 sqrt2 W e^(-k |xi|), from (cosh xi - m)^(-3/2). A mode
 * far away is 2 sqrt2 rho/r^3 n(n + 1)/2, which is a torque. Jeffery 1915. */
void sd_two_sphere_axial_rotation(sd_real alpha, sd_real beta, sd_real XC[2][2])
{
  const int modes = (int) (SD_TWO_SPHERE_DEPTH / (alpha + beta)) + 30;
  XC[0][0] = XC[0][1] = XC[1][1] = 0.0L;
  for (int n = modes; n > 0; n--) {
    const sd_real k = n + 0.5L, E = expl(-2.0L * k * (alpha + beta));
    const sd_real s = 32.0L * SD_PI_LONG * n * (n + 1.0L) / (1.0L - E);
    XC[0][0] += s * expl(-2.0L * k * alpha);
    XC[0][1] -= s * E;
    XC[1][1] += s * expl(-2.0L * k * beta) * E; /* less those of sphere 2 alone */
  }
  const sd_real a2 = 1.0L / sinhl(beta);
  XC[1][1] += 8.0L * SD_PI_LONG * a2 * a2 * a2;
  XC[1][0] = XC[0][1];
}

/* sinh z - z without cancellation */
static sd_real sinh_less(sd_real z)
{
  if (z > 1.0L) return sinhl(z) - z;
  sd_real term = z * z * z / 6.0L, sum = term;
  for (int j = 4; term > 1e-22L * sum; j += 2) sum += term *= z * z / (j * (j + 1.0L));
  return sum;
}

/* Stokes' stream function is (cosh xi - m)^(-3/2) sum_n f_n(xi) [P_(n-1) - P_(n+1)], f_n made of
 * e^(+-p xi) and e^(+-q xi), p = n - 1/2, q = n + 3/2. On a sphere with velocity 1 it is -rho^2/2:
 * value and slope of f_n there follow. The force is 4 pi sqrt2 times the sum of -(2n+1) times both
 * growing coefficients for sphere 1, both decaying ones for sphere 2. Stimson & Jeffery 1926. */
typedef struct {
  sd_real p, q, value[2], slope[2];
} mode;

static mode mode_on_spheres(int n, const sd_real xi[2])
{
  mode f = {n - 0.5L, n + 1.5L, {0}, {0}};
  const sd_real k = n * (n + 1.0L) / (SD_ROOT2_LONG * 4.0L * f.p * (2 * n + 1) * f.q);
  for (int s = 0; s < 2; s++) {
    const sd_real ep = expl(-f.p * xi[s]),
                  step = -expm1l(-2.0L * xi[s]); /* e^-p - e^-q = ep step */
    f.value[s] = -k * ep * (4.0L + 2.0L * f.p * step);
    f.slope[s] = (s ? -2.0L : 2.0L) * k * f.p * f.q * ep * step;
  }
  return f;
}

/* Growing and decaying coefficient, each that of p times e^(-p xi) plus that of q times e^(-q xi),
 * from f and f' at the ends of -h < th < h: even and odd part by themselves. Its determinants, q
 * ch_p sh_q - p sh_p ch_q and q sh_p ch_q - p ch_p sh_q, are [2 sinh(mh) +- m sinh(2h)]/2 with m =
 * p + q. Everything carries e^(-p h) or e^(-q h). */
static void coefficients(const mode *f, const sd_real v[2], const sd_real d[2], const sd_real xi[2],
                         sd_real out[2])
{
  const sd_real h = 0.5L * (xi[0] + xi[1]), p = f->p, q = f->q, m = p + q;
  const sd_real chp = 0.5L * (1.0L + expl(-2.0L * p * h)), shp = -0.5L * expm1l(-2.0L * p * h);
  const sd_real chq = 0.5L * (1.0L + expl(-2.0L * q * h)), shq = -0.5L * expm1l(-2.0L * q * h);
  const sd_real fade = expl(-m * h);
  const sd_real even = -0.5L * expm1l(-2.0L * m * h) + 0.5L * m * sinhl(2.0L * h) * fade;
  const sd_real odd = m * h < 1.0L
      ? fade * (sinh_less(m * h) - 0.5L * m * sinh_less(2.0L * h))
      : -0.5L * expm1l(-2.0L * m * h) - 0.5L * m * sinhl(2.0L * h) * fade;
  const sd_real ev = 0.5L * (v[0] + v[1]), ed = 0.5L * (d[0] - d[1]);
  const sd_real ov = 0.5L * (v[0] - v[1]), od = 0.5L * (d[0] + d[1]);
  const sd_real Ae = (ev * q * shq - ed * chq) / even, Ce = (ed * chp - ev * p * shp) / even;
  const sd_real Ao = (ov * q * chq - od * shq) / odd, Co = (od * shp - ov * p * chp) / odd;
  out[0] = 0.5L * ((Ae + Ao) * expl(-p * xi[0]) + (Ce + Co) * expl(-q * xi[0]));
  out[1] = 0.5L * ((Ae - Ao) * expl(-p * xi[1]) + (Ce - Co) * expl(-q * xi[1]));
}

void sd_two_sphere_axial_translation(sd_real alpha, sd_real beta, sd_real XA[2][2])
{
  const sd_real xi[2] = {alpha, beta}, factor = -4.0L * SD_PI_LONG * SD_ROOT2_LONG;
  const int modes = (int) (SD_TWO_SPHERE_DEPTH / (alpha + beta)) + 30;
  XA[0][0] = XA[0][1] = XA[1][0] = XA[1][1] = 0.0L;
  for (int n = modes; n > 0; n--) {
    const mode f = mode_on_spheres(n, xi);
    const sd_real weight = factor * (2 * n + 1);
    for (int moves = 0; moves < 2; moves++) {
      sd_real v[2] = {0.0L, 0.0L}, d[2] = {0.0L, 0.0L}, c[2];
      v[moves] = f.value[moves];
      d[moves] = f.slope[moves];
      coefficients(&f, v, d, xi, c);
      XA[0][moves] += weight * c[0];
      XA[1][moves] += weight * c[1];
    }
    /* sphere 2 alone: both coefficients from its own value and slope */
    const sd_real v = f.value[1], d = f.slope[1];
    XA[1][1] -=
        weight * 0.5L * ((d + f.q * v) * expl(-f.p * beta) - (d + f.p * v) * expl(-f.q * beta));
  }
  XA[1][1] += 6.0L * SD_PI_LONG / sinhl(beta);
}
