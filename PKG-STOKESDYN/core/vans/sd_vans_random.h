/* Velocity fluctuations of the water: a discrete random walk of each grain, or a Langevin one. */
#ifndef SD_VANS_RANDOM_H
#define SD_VANS_RANDOM_H

#include "sd_vans.h"

#include <stdint.h>

SD_BEGIN_C

/* Three independent standard normal numbers that depend on nothing but the three keys: the same on
 * any number of ranks (sd_random.h, of which the seed has the lower 32 bits). */
void sd_vans_normal3(uint64_t seed, uint64_t id, uint64_t count, double out[3]);

/* u_star [n] of each slice, sqrt(|stress|/rho) with the sign of the stress. Yade's rule: 0 where that is
 * negative. */
void sd_vans_friction_velocities(const sd_vans_fluid *fluid, int n, const double *stress, double *u_star);

/* u' of one grain from a, b, c ~ N(0,1) and the friction velocity u_star = sqrt(stress/rho):
 * correlated: (-a + c, b, a) u_star, with <u'x u'z> = -u_star^2; uncorrelated: (c, b, a) u_star.
 * Where the stress is negative, as in a stream along -x, u_star is -sqrt(-stress/rho): u'x then
 * changes its sign, and with it the correlation. */
void sd_vans_fluctuation(const double normal[3], double u_star, int correlated, double u[3]);

/* Life of an eddy at the height z above the bed: 0.33 * 0.41 max(z, 11.6 nu/u_star)/u_star, at most
 * longest; where nothing moves, 10 dt. */
double sd_vans_eddy_life(double z_above_bed, double nu, double u_star, double longest, double dt);

/* The longest life. Where next to nothing moves an eddy would live for ever: thirty times H/u_star
 * are about two hundred lives of one as high as the stream, u_star from what drives the stream or
 * from its largest stress. Yade's rule: fluid->longest_life. */
double sd_vans_longest_life(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid,
                            const double *stress);

/* The random walk of all grains. */
typedef struct {
  uint64_t seed;
  int correlated;
  /* height above z_ref below which there is none */
  double bed;
  /* [N] friction velocity of each slice, with the sign of the stress */
  const double *u_star;
  /* of an eddy; time step of the walk */
  double longest, dt;
} sd_vans_walk;

/* What a grain carries: life left of its eddy, and how many it has had. */
typedef struct {
  double life, count;
} sd_vans_eddy;

/* A new eddy for the grain of this ID at the height z (LAMMPS's): u' [3] out, 0 below the bed and
 * outside the mesh. */
void sd_vans_new_eddy(const sd_vans_mesh *mesh, double nu, const sd_vans_walk *walk, double z,
                      uint64_t id, sd_vans_eddy *eddy, double u[3]);

/* The Langevin walk: the water that a grain meets forgets its velocity within the Lagrangian time
 * T. With sigma = |u_star| of the grain's slice and y = (a, b, c) = the velocity over sigma,
 *   dy = -y/T dt + sqrt(2/T) dW + (dsigma/dz, 0, 0) dt,   u' = (c - a, b, a) sigma
 * Each of a, b, c is N(0,1), and the grains are spread by D = sigma^2 T. By the last term water that
 * is marked evenly stays so where sigma changes with the height. At the surface water turns back: a
 * grain above it meets that of the highest slice, with a = -|a|. Whoever mirrors a grain at a wall
 * of his own and leaves a as it is makes grains gather there, in a layer of about sigma T.
 * Sources: Wilson, Legg & Thomson 1983 (Boundary-Layer Meteorol. 27); Thomson 1987 (JFM 180);
 * Thomson & Montgomery 1994 (Atmos. Environ. 28; why the velocity is mirrored with the place). */
typedef struct {
  uint64_t seed;
  /* height above z_ref below which there is none */
  double bed;
  /* [N] friction velocity of each slice, with the sign of the stress, and T */
  const double *u_star, *life;
  /* of a step; HUGE_VAL: the walk begins */
  double dt;
  /* slices below the surface; 0: there is none */
  int water;
} sd_vans_langevin;

/* What a grain carries: a, b, c, and the number of its steps. */
typedef struct {
  double normal[3], count;
} sd_vans_wander;

/* T for which grains are spread by nut/schmidt, the turbulent Schmidt number: nut/(schmidt
 * u_star^2); 0 where u_star is. life [N] out */
void sd_vans_lagrangian_times(const sd_vans_mesh *mesh, double schmidt, const double *nut,
                              const double *u_star, double *life);

/* A step of the grain of this ID at the height z (LAMMPS's): u' [3] out, 0 below the bed and
 * outside the mesh. Exact for any step where sigma and T are even. */
void sd_vans_langevin_step(const sd_vans_mesh *mesh, const sd_vans_langevin *walk, double z,
                           uint64_t id, sd_vans_wander *wander, double u[3]);

SD_END_C
#endif
