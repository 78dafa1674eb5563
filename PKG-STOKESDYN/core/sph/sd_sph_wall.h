/* Walls of SPH: repulsion by a surface, and fixed particles that carry the fluid's pressure. */
#ifndef SD_SPH_WALL_H
#define SD_SPH_WALL_H

#include "sd_sph_pressure.h"
#include "sd_sph_sums.h"

SD_BEGIN_C

/* Force of a mirror particle behind the wall, m^2 2 P / rho^2 |W'(r)|; dW = W'(r) < 0. */
double sd_sph_mirror(double m, double P, double rho, double dW);

/* Force along the inward normal at the distance r from a wall, Monaghan 1994:
 * D ((r0/r)^4 - (r0/r)^2) for 0 < r < r0, 0 beyond. */
double sd_sph_repulsion(double D, double r0, double r);

/* Adami, Hu & Adams 2012: a wall particle w takes pressure and velocity from the fluid particles f
 * in its support,
 *   P_w = sum [P_f + rho_f b.(x_w - x_f)] W / sum W,   <v> = sum [v_f + w x (x_w - x_f)] W / sum W
 * with b = g - a_w, the body force per mass as the wall particle sees it, and w the angular velocity of
 * the wall: fluid that turns with the wall does not slip on it, however deep the wall particle is (of
 * our own; with w = 0 as published). q [8 (n+1)] for
 * sd_sph_before_walls: 1, P, rho, 0, v, 0 of the fluid and 0 of walls. v4 must be packed. */
void sd_sph_pack_fluid(const sd_sph_particles *p, const double *pressure, double *q);

/* The acceleration a [3] of a wall particle from its velocities v and before, dt apart, as a mean
 * over the time tau: a += dt / (dt + tau) ((v - before) / dt - a). The wall's pressure acts on a
 * body that swims with it, and the body's acceleration on that pressure: with tau of the time that
 * sound takes through the support, also bodies much lighter than the fluid are stable. before
 * becomes v. */
void sd_sph_wall_acceleration(const double v[3], double dt, double tau, double before[3],
                              double a[3]);

/* How well each wall particle fits the fluid in its support: likeness [n+1], taken as maximum with
 * what is there, of -|ln(m_w / m_f)| over the particles f of its own fluid (phase) in its support; 0:
 * one has its mass. Where none is in reach it is left alone. x4 must be packed. */
void sd_sph_likeness(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                     double *likeness);

/* How the wall particles w around each fluid particle f move: adds to the rows of fluid particles, sums
 * [SD_SPH_MOTION (n+1)], with d = x_w - x_f, u = v_w - v_f
 *   0 their number   1-3 d   4-6 u   7-9 d x u   10-15 d d^T, xx yy zz xy xz yz   16 u.u
 * x4 and v4 must be packed. */
enum { SD_SPH_MOTION = 17 };
void sd_sph_motion_of_walls(const sd_sph_model *model, const sd_sph_list *list,
                            const sd_sph_particles *p, double *sums);

/* If these wall particles move as one rigid body that turns: its angular velocity w, otherwise w = 0 and
 * shear = 0; returns |w|. shear: about the shear rate before it, |<u - w x d>| / <d.d>^(1/2), means over
 * the wall particles: at least a quarter of it. Walls that slide past each other within one support are
 * not one body, and less than six particles do not tell. */
double sd_sph_spin(const double sums[SD_SPH_MOTION], double w[3], double *shear);

typedef struct {
  const sd_sph_state *state;
  int slip;
  /* 0: the wall does not pull, its pressure is 0 where P_w would be negative */
  int suction;
} sd_sph_wall;

/* What the sums s of sd_sph_before_walls make of one wall particle that moves with v and sees the
 * body force b. row, in: its density. Out: the density that has the pressure of the fluid before it
 * (0: none has), and by how much the velocity that friction sees differs from v: to that of the fluid
 * with slip, to its mirror image without.
 * A wall without fluid in reach has P0, or keeps its density (absolut). Returns the pressure. */
double sd_sph_wall_particle(const sd_sph_wall *wall, const double s[8], const double v[3],
                            const double b[3], double row[4]);

/* What the arrangement of the particles does to a body of the volume V (an area in two dimensions) in a fluid
 * with the pressure P: a force against its displacement, per length. Particles in rows are a weak solid of
 * the shear modulus
 *   G = 0.01 P (2 dx/h)^3, three dimensions 0.014 P (2 dx/h)^3     wendland
 *   G = 0.07 P (1.3 dx/h)^3                                        cubicspline
 * with the measured values at h = 2 dx (2.5 dx: 0.005 P) and 1.3 dx, and an incompressible solid holds a
 * cylinder with 2 pi G a length of it (measured: 0.07 P, h = 2 dx), a sphere of the radius R with 6 pi G R.
 * With pliant shift a fifth of it (measured: 0.012 P): of rows that are sheared nothing is left, but where
 * they are torn at the body, the sums are not those of rows. 0 with correction. spacing: dx. */
double sd_sph_arrangement(const sd_sph_model *model, double h, double spacing, double P, double V);

SD_END_C
#endif
