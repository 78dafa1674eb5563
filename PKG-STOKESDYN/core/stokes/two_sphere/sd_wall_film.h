/* Film between a sphere and a plane no-slip wall: what the lone sphere resists beyond what the
 * model knows, whose images already have the flow that the wall sends back.
 *
 *   forces and torques on the fluid = model's + eta (B V - E)            V = (U, W) of the sphere
 *
 * e: unit normal of the wall, into the fluid. With resistances over 6 pi a (normal, parallel), 8 pi
 * a^2 (coupling) and 8 pi a^3 (roll, spin)
 *
 *   B V:  F = parallel U + (normal - parallel) (e.U) e + coupling W x e
 *         T = roll W + (spin - roll) (e.W) e + coupling e x U
 *
 * It acts on V itself, not on V less the undisturbed fluid, since the wall rests; it is for every
 * sphere at its own height, whatever its neighbours, so nothing is shared and B of all spheres is
 * block diagonal. E is what the undisturbed flow does to a sphere that rests near the wall beyond
 * the model: smooth, and without it a free sphere in shear is 9 % too fast at gaps of 0.05 to 0.1
 * radii. u_t: undisturbed velocity at the centre, its part along the wall; it is taken to be
 * linear in the height.
 *
 *   E:  F = flow_force u_t,   T = flow_torque e x u_t
 *
 * Exact less the Rotne-Prager-Yamakawa model with torques, as a function of s = a/z, z the height
 * of the centre, l = -ln(1 - s), gap = z - a:
 *
 *   s^4 { A/(1-s) + B l + c1 (1-s) l + c2 (1-s)^2 l + p0 + ... + p9 s^9 }
 *       A, B = 1, 1/5 normal;  0, 8/15 parallel;  0, -1/10 coupling;  0, 2/5 roll;  0, 0 spin
 *   near contact, e = gap/a, L = ln(1/e), the exact functions are
 *       1/e + L/5 + 0.97127993 + e L/21,   8/15 L + 0.95429372 + 64/375 e L
 *       -(L/10 - 0.19295275 + 43/250 e L),   2/5 L + 0.37089257 + 66/125 e L,   zeta(3) - e L/2
 *
 * within 4e-6 of 1 + its size for every gap from 1e-6 to 100 radii, those of E within 1.2e-5.
 * Gaps below the floor, and spheres pressed into the wall, count as the floor: roughness. The
 * flow of the model is the one of least dissipation among more flows than the exact one, so the
 * difference is positive semidefinite; what rounding and fit leave of that at large gaps (1e-11)
 * is clipped, so B >= 0.
 * Sources: Brenner 1961 (normal), Jeffery 1915 (spin), Dean & O'Neill 1963, O'Neill 1964 (parallel,
 * roll), Jeffrey & Onishi 1984 (slopes near contact), Goldman, Cox & Brenner 1967 (shear); the
 * numbers are recomputed, and the published constants near contact are off by up to 0.011. */
#ifndef SD_WALL_FILM_H
#define SD_WALL_FILM_H

#include "sd_extern_c.h"

SD_BEGIN_C

/* Resistances of one sphere, for a viscosity of 1 */
typedef struct {
  /* force over velocity; force over spin, or torque over velocity; torque over spin */
  double normal, parallel, coupling, roll, spin;
  /* of E */
  double flow_force, flow_torque;
} sd_wall_film;

/* Exact less model, and exact, of a sphere of radius a > 0 whose centre is `height` above the wall;
 * floor > 0: gap in radii of the sphere below which nothing grows any more. flow_force and
 * flow_torque of the exact one are what a sphere at rest bears in the flow. One logarithm and some
 * 70 multiplications. Never fail. */
sd_wall_film sd_wall_film_at(double a, double height, double floor);
sd_wall_film sd_wall_film_exact(double a, double height, double floor);

/* B eta, row-major, symmetric: rows F T, columns U W. e [3] unit normal. */
void sd_wall_film_matrix(const sd_wall_film *film, const double e[3], double eta, double B[36]);

/* E eta [6]: force and torque; u [3] undisturbed velocity at the centre. */
void sd_wall_film_flow(const sd_wall_film *film, const double e[3], double eta, const double u[3],
                       double E[6]);

SD_END_C
#endif
