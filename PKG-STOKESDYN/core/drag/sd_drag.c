#include "sd_drag.h"

#include <math.h>

double sd_drag_number(sd_drag_of_one law, double Re)
{
  switch (law) {
    case SD_DRAG_YADE: return 24.4 + 0.44 * Re;
    case SD_DRAG_SCHILLER_NAUMANN:
      return fmax(24.0 * (1.0 + 0.15 * pow(Re, 0.687)), 0.44 * Re);
    case SD_DRAG_BROWN_LAWLER:
      return 24.0 * (1.0 + 0.15 * pow(Re, 0.681)) + 0.407 * Re * Re / (Re + 8710.0);
    case SD_DRAG_FERGUSON_CHURCH: {
      /* w (18 nu + sqrt(3/4 C_2 R g d^3)/w ...) solved for the drag: with C = C_d,
       * C - sqrt(C_2 C) - 24/Re = 0, C_2 = 1 */
      const double root = 0.5 * (sqrt(Re) + sqrt(Re + 96.0));
      return root * root;
    }
    case SD_DRAG_ERGUN:
    case SD_DRAG_GIDASPOW:
    case SD_DRAG_BEETSTRA:
    case SD_DRAG_KOCH_HILL: break;
  }
  return 0.0;
}

// --- beds: F/(6 pi a eta w) ------------------------------------------------------------------------

static double ergun(double Re, double e)
{
  return 150.0 * (1.0 - e) / (18.0 * e * e) + 1.75 * Re / (18.0 * e);
}

static double gidaspow(double Re, double e)
{
  if (e <= 0.8) return ergun(Re, e);
  return sd_drag_number(SD_DRAG_SCHILLER_NAUMANN, e * Re) / 24.0 * pow(e, -3.65);
}

static double beetstra(double Re, double e)
{
  const double phi = 1.0 - e, Re_s = e * Re,
               slow = 10.0 * phi / (e * e) + e * e * (1.0 + 1.5 * sqrt(phi));
  if (!(Re_s > 0.0)) return slow;
  const double above = 1.0 / e + 3.0 * phi * e + 8.4 * pow(Re_s, -0.343),
               below = 1.0 + pow(10.0, 3.0 * phi) * pow(Re_s, -0.5 * (1.0 + 4.0 * phi));
  return slow + 0.413 * Re_s / (24.0 * e * e) * above / below;
}

static double koch_hill(double Re, double e)
{
  const double phi = 1.0 - e, logarithm = phi > 0.0 ? phi * log(phi) : 0.0,
               dilute = (1.0 + 3.0 * sqrt(0.5 * phi) + 135.0 / 64.0 * logarithm + 16.14 * phi) /
      (1.0 + phi * (0.681 + phi * (-8.48 + phi * 8.16))),
               F_0 = phi < 0.4 ? dilute : 10.0 * phi / (e * e * e),
               F_3 = 0.0673 + 0.212 * phi + 0.0232 / pow(e, 5.0);
  return e * (F_0 + 0.5 * F_3 * e * Re);
}

static double of_bed(sd_drag_of_one law, double Re, double e)
{
  switch (law) {
    case SD_DRAG_ERGUN: return ergun(Re, e);
    case SD_DRAG_GIDASPOW: return gidaspow(Re, e);
    case SD_DRAG_BEETSTRA: return beetstra(Re, e);
    default: return koch_hill(Re, e);
  }
}

void sd_hindrance_of(sd_drag_law law, int n, const double *phi, double exponent, double *hindrance)
{
  for (int k = 0; k < n; k++)
    hindrance[k] = law.hindrance != SD_HINDRANCE_POWER ? 1.0 - phi[k]
        : phi[k] == 0.0                                 ? 1.0
                                                        : pow(1.0 - phi[k], -exponent);
}

/* Lambert's W, W e^W = z > 0, to rounding: a rational function of W's series below 1, Winitzki's
 * approximation above, each right to a few per cent or better; then steps of Fritsch, Shafer and
 * Crowley (1973), which leave the fourth power of a relative error: one, or two from 1 on. */
static double lambert_w(double z)
{
  double w;
  if (z < 1.0)
    w = z * (60.0 + z * (114.0 + 17.0 * z)) / (60.0 + z * (174.0 + 101.0 * z));
  else {
    const double L = log1p(z);
    w = L * (1.0 - log1p(L) / (2.0 + L));
  }
  for (int k = 0; k < 4; k++) {
    const double r = log(z / w) - w, q = 2.0 * (1.0 + w) * (1.0 + w + 2.0 / 3.0 * r),
                 e = r / (1.0 + w) * (q - r) / (q - 2.0 * r);
    w *= 1.0 + e;
    if (fabs(e) < 1e-4) break;
  }
  return w;
}

/* ln Re_0 where 4.4 Re_0^-0.03 is 4.65 and where 4.4 Re_0^-0.1 is 2.39. */
#define SLOWEST (-1.8420892891683138)
#define FASTEST 6.103111749807962

/* y = ln(Re_0/Re), which solves y = (1 - n(Re_0)) L, L = ln e < 0. Re rises with Re_0, so that the
 * ends of the parts of n are at ln Re = ln Re_0 + (n - 1) L. In a part n = 4.4 Re_0^-p
 *   y = L + s,  s = -4.4 L e^(-p (ln Re + L)) e^(-p s):  p s = W(-4.4 p L e^(-p (ln Re + L))) */
static double logarithm_of_lone_speed(double Re, double L)
{
  if (!(Re > 0.0)) return -3.65 * L;
  const double x = log(Re);
  if (x <= SLOWEST + 3.65 * L) return -3.65 * L;
  if (x >= FASTEST + 1.39 * L) return -1.39 * L;
  const double p = x < 3.4 * L ? 0.03 : 0.1;
  return L + lambert_w(-4.4 * p * L * exp(-p * (x + L))) / p;
}

static double drag_of_sphere(sd_drag_law law, double rho, double eta, double a,
                             double hindrance, double speed)
{
  const double Re = 2.0 * a * rho * speed / eta, viscous = 0.25 * SD_PI * a * eta;
  switch (law.hindrance) {
    case SD_HINDRANCE_POWER: break;
    case SD_HINDRANCE_OWN: return 24.0 * viscous * of_bed(law.law, Re, hindrance);
    case SD_HINDRANCE_RICHARDSON_ZAKI: {
      if (hindrance == 1.0) return viscous * sd_drag_number(law.law, Re);
      const double more = exp(logarithm_of_lone_speed(Re, log(hindrance)));
      return viscous * sd_drag_number(law.law, Re * more) * more;
    }
    case SD_HINDRANCE_DI_FELICE: {
      const double through = hindrance * Re, x = 1.5 - log10(fmax(through, 1e-30)),
                   beta = 3.7 - 0.65 * exp(-0.5 * x * x);
      return viscous * sd_drag_number(law.law, through) * pow(hindrance, -beta);
    }
  }
  return viscous * sd_drag_number(law.law, Re) * hindrance;
}

double sd_drag_by_law(sd_drag_law law, double rho, double eta, double a, double hindrance,
                      double speed)
{
  if (law.fall == 0.0) return drag_of_sphere(law, rho, eta, a, hindrance, speed);
  return drag_of_sphere(law, rho, eta, law.fall * a, hindrance, speed) /
      (law.fall * law.fall * law.fall);
}

double sd_drag_slope(sd_drag_law law, double rho, double eta, double a, double hindrance,
                     double speed)
{
  /* a step of 1e-3 of the speed, for a derivative that needs two digits */
  const double more = 1.001 * speed,
               F = sd_drag_factor(law, rho, eta, a, hindrance, speed) * speed;
  if (!(speed > 0.0)) return sd_drag_factor(law, rho, eta, a, hindrance, 0.0);
  return (sd_drag_factor(law, rho, eta, a, hindrance, more) * more - F) / (more - speed);
}

/* A lone grain has hindrance 1 by any law. F(w) is convex and no less than the drag at rest times w: by
 * Newton's steps w falls from where that would balance the force. */
double sd_fall_speed(sd_drag_law law, double rho, double eta, double a, double force)
{
  double w = force / sd_drag_factor(law, rho, eta, a, 1.0, 0.0);
  for (int k = 0; k < 100; k++) {
    const double excess = sd_drag_factor(law, rho, eta, a, 1.0, w) * w - force;
    if (!(excess > 1e-12 * force)) break;
    w -= excess / sd_drag_slope(law, rho, eta, a, 1.0, w);
  }
  return w;
}
