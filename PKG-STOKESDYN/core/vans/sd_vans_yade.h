/* What Yade 2023.02a does in another way than this room, whole function by whole function, its
 * defects included: SD_VANS_YADE repeats its answers to rounding. */
#ifndef SD_VANS_YADE_H
#define SD_VANS_YADE_H

#include "sd_vans.h"

/* As sd_vans_slices. Slice n has the limits of slice 2p-n, p that of the centre, and the sphere's
 * lower end is cut only off the lower limit, its upper end only off the upper one. */
sd_vans_reach sd_vans_yade_slices(const sd_vans_mesh *mesh, double z, double a, double *V);

/* Adds a grain to the sums of its class: volume and drag where they are, velocities all in the
 * slice of the centre (NULL: outside the mesh). drag [count] */
void sd_vans_yade_add_slices(double *sums, const sd_vans_reach *reach, const double *v, const double *drag,
                             double *centre);

/* As sd_vans_steps: dt is added up until the sum, rounded after every step, reaches T. */
int64_t sd_vans_yade_steps(double T, double dt);

/* The exchange coefficient of slice n: over the size of the slip, at least least_slip, and none in
 * the lowest slice. */
double sd_vans_yade_coefficient(const sd_vans_fluid *fluid, int n, double drag, double slip);

/* r_(m+1) = 2 ln(Re sqrt(f_m)) + 0.32, f_m = 1/r_m^2, from f_0 = 0.32^-2 until f changes by less
 * than 1 %; after 100 steps 0. */
void sd_vans_yade_friction(double Re, sd_vans_friction *near);

#endif
