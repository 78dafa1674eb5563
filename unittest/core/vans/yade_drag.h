/* The default law of drag by itself: a power of the water between the grains, Yade's drag of one. */
#ifndef YADE_DRAG_H
#define YADE_DRAG_H

#include "sd_drag.h"

#include <math.h>

static inline void hindrance_of(int ncell, const double *phi, double exponent, double *hindrance)
{
  sd_hindrance_of((sd_drag_law){0}, ncell, phi, exponent, hindrance);
}

/* F [3] on a sphere that the water passes with w [3] */
static inline void yade_drag(double rho, double eta, double a, double hindrance, const double w[3],
                             double F[3])
{
  const double speed = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
  const double k = sd_drag_factor((sd_drag_law){0}, rho, eta, a, hindrance, speed);
  for (int d = 0; d < 3; d++) F[d] = k * w[d];
}

#endif
