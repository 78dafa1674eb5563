/* What the files of this room share and nobody else needs. */
#ifndef SD_VANS_INTERNAL_H
#define SD_VANS_INTERNAL_H

#include "sd_constants.h"
#include "sd_vans.h"

/* Volume of a sphere between its equator and the height s, |s| <= a: integral of pi (a^2 - s^2). */
static inline double primitive(double a2, double s)
{
  return SD_PI * s * (a2 - s * s / 3.0);
}

/* The water at a height: velocity along x and z, hindrance. */
typedef struct {
  double u, w, hindrance;
} sd_vans_water;

/* Of slice n; n < 0: below the mesh, n >= N: above it. */
sd_vans_water sd_vans_water_in(const sd_vans_mesh *mesh, const sd_vans_force_law *law,
                               const double *U, const double *hindrance, int n);

/* F += share times the drag of grain i, were it all in this water. */
void sd_vans_add_drag(const sd_vans_force_law *law, const sd_vans_grains *grains, int i,
                      sd_vans_water water, double share, double F[3]);

#define SD_VANS_SMOOTH 0.32 /* of the laws of smooth walls */

/* Series in s of the friction of the walls. Terms of ln(1 + s). */
extern const double sd_vans_log_series[SD_VANS_FRICTION_TERMS];

/* What the terms below n add to n q_n r_0 = n r_n - sum k q_k r_(n-k), the series q = ln r. */
double sd_vans_lower_terms(int n, const double *q, const double *r);

/* The series of r^-2 from those of r and q = ln r, as far as the next term is below 1e-14 f_0. */
void sd_vans_inverse_square(const double *r, const double *q, sd_vans_friction *near);

#endif
