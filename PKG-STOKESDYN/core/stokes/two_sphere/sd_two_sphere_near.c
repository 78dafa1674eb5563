#include "sd_two_sphere_near.h"

#include <math.h>

#include "sd_constants.h"

/* YB11, YC11 over their scales, of sphere 1 and the ratio l of the other radius to its own */
static double torque_from_velocity(double l, double L, double xi)
{
  const double p = 1.0 + l;
  return -(l * (4.0 + l) / 5.0 + (32.0 + l * (-33.0 + l * (83.0 + 43.0 * l))) / 250.0 * xi) * L /
      (p * p);
}

static double torque_from_spin(double l, double L, double xi)
{
  return (2.0 * l / 5.0 + (8.0 + l * (6.0 + 33.0 * l)) / 125.0 * xi) * L / (1.0 + l);
}

sd_pair_resistance sd_two_sphere_near(double a1, double a2, double xi)
{
  const double l = a2 / a1, p = 1.0 + l, p3 = p * p * p, l2 = l * l, L = log1p(1.0 / xi);
  const double force = 6.0 * SD_PI * a1 / p3, spin = 8.0 * SD_PI * a1 * a1 * a1 / p;
  const double XA = force *
      (2.0 * l2 / xi +
       (l * (1.0 + l * (7.0 + l)) / 5.0 +
        (1.0 + l * (18.0 + l * (-29.0 + l * (18.0 + l)))) / 42.0 * xi) *
           L);
  const double YA = force * L *
      (4.0 * l * (2.0 + l + 2.0 * l2) / 15.0 +
       2.0 * (16.0 + l * (-45.0 + l * (58.0 + l * (-45.0 + 16.0 * l)))) / 375.0 * xi);
  const double YB1 = 4.0 * SD_PI * a1 * a1 * torque_from_velocity(l, L, xi);
  const double YB2 = -4.0 * SD_PI * a2 * a2 * torque_from_velocity(1.0 / l, L, xi);
  const double XC = -spin * l2 / 4.0 * xi * L;
  const double YC11 = 8.0 * SD_PI * a1 * a1 * a1 * torque_from_spin(l, L, xi);
  const double YC12 = spin * L * (l2 / 10.0 + l * (43.0 + l * (-24.0 + 43.0 * l)) / 500.0 * xi);
  const double YC22 = 8.0 * SD_PI * a2 * a2 * a2 * torque_from_spin(1.0 / l, L, xi);
  return (sd_pair_resistance){
      {XA, -XA, XA}, {YA, -YA, YA}, {YB1, -YB1, -YB2, YB2}, {XC, -XC, XC}, {YC11, YC12, YC22}};
}
