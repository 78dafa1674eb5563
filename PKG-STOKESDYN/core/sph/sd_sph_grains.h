/* Grains in the water of SPH that are smaller than h: the water between them is averaged over the
 * support of its kernel, as Anderson & Jackson 1967 and Robinson, Ramaioli & Luding 2014 average
 * it.
 *
 * A water particle a keeps its mass m_a and has the density rho_a of the water itself. Its volume
 * is that of the mixture around it, V_a = m_a / (eps_a rho_a), eps = 1 - phi.
 *   weights      w_aj = V_a W_aj / S_j,  S_j = sum_a V_a W_aj over water, so sum_a w_aj = 1
 *   wetness      t_j = min(1, S_j / (1 - Sw_j)), Sw_j the same sum over the particles of walls:
 *                the part of the room around the grain, without walls, that is water
 *   grains       phi_a = sum_j t_j V_j w_aj / V_a: sum_a V_a phi_a = sum_j t_j V_j, none is lost
 *   flux         q_a = eps_a v_a + sum_j t_j V_j w_aj/V_a v_j, of water and grains together;
 *                d rho_a/dt = rho_a/eps_a sum_b V_b (q_a - q_b).grad W, since grains do not yield
 *   at a grain   any mean of the water, q_j = sum_a w_aj q_a
 * Force on a grain: the stress of the water, divided by volume between water and grains, and drag
 *   F_j = t_j V_j <F_a / V_a>_j + D_j,      F_a: pressure and friction on a by water and walls
 *   D_j = t_j (1 - phi) F(w),               F of sd_drag.h, w = u_j - v_j
 * Water gets eps_a F_a - sum_j w_aj D_j. Momentum is exact, since sum_a phi_a F_a is what grains
 * get. The work of F_a is then F_a.q_a, in water and grains together, which is what the rate of rho
 * takes up: no sound is made or lost. The water that stands still between grains that stand still
 * has the flux eps_a v_a of its own place, so a steady flux is the same on both sides of the edge
 * of a bed. At rest eps_a F_a = - m_a g, which gives Archimedes' buoyancy also at a surface or a
 * wall, where sums over neighbours are not exact. The laws of sd_drag.h are for a force beside the
 * buoyancy of clear water, with the excess pressure of the mixture in it; here that pressure acts
 * by F_a, and what is left is 1 - phi of them: of a bed that floats, n F = n (M - rho V) g = -
 * grad P', and F = D + V (- grad P') = D + phi F.
 *
 * A grain is in the means that it sees. Of grains at random all of that must go, of a lattice
 * nothing: the mean over a large volume of those around a grain lacks 1 - s of a grain, where s is
 * the structure factor for long waves, of hard spheres (Carnahan & Starling 1969)
 *   s = (1 - phi)^4 / ((1 + 2 phi)^2 + phi^3 (phi - 4))
 * so s of its own share is taken from phi, and s of the flow that its own drag D makes at its
 * place, by Oseen's equation with the kernel on both sides and the friction of SPH, mu k^2 S(hk)
 * of a wave,
 *   u = D T(Re_h) / (6 pi eta h),   Re_h = rho h |w| / eta
 *   T(Re) = 3h/(2 pi) int_0^inf |W(k)|^2/S 2 A(Re/(h k S)) dk,    T(0) = 2h/pi int |W|^2/S dk
 *   A(s) = (1 + 1/s^2) atan(s)/s - 1/s^2
 * (real part of int (1 - c^2)/(S k^2 + i Re k c/h) over all directions).
 *   S k^2 = 8 pi int r |W'| (1 - sin(kr)/(kr)) dr              laplacian
 *   S k^2 = 40 pi int r |W'| (1/3 - j1(kr)/(kr)) dr            central
 * are the sums of sd_sph_pair.h as integrals. The drag of the grains around, n k per volume,
 * screens that flow (Brinkman 1949): with K^2 = n k h^2/eta, k^2 + K^2/h^2 in place of k^2, for
 * which stands
 *   T(Re, K) = T(Re) / (1 + K/T(0) + K^2 T(0)/T_2),   T_2 = 2 h^3/pi int |W(k)|^2 k^2/S dk
 * right for small and for large K. It is the quasi-steady flow: a grain that has just been let go
 * has not made it yet. */
#ifndef SD_SPH_GRAINS_H
#define SD_SPH_GRAINS_H

#include "sd_cells.h"
#include "sd_drag.h"
#include "sd_sph_kernel.h"

SD_BEGIN_C

/* T(Re_h), at Re_h = 0.5 (e^(0.2 k) - 1) */
enum { SD_SPH_WAKES = 64 };
typedef struct {
  double T[SD_SPH_WAKES], T_2;
} sd_sph_wake;
/* Of this kernel and friction in three dimensions, by quadrature; 10 ms. */
void sd_sph_wake_make(sd_sph_kernel kernel, int laplacian, sd_sph_wake *wake);
double sd_sph_wake_of(const sd_sph_wake *wake, double Re_h, double K);

/* s of hard spheres, 1 for phi = 0. */
double sd_sph_structure(double phi);

/* The particles around each grain: those of grain j are particle[first[j] .. first[j+1] - 1],
 * indices into the points that the cells were filled with, with their weights w_aj: 0 of walls. */
typedef struct {
  int n;
  const int *first, *particle;
  double *weight;
} sd_sph_around;

/* Of the m particles: places [3m], volumes V_a [m], wall [m] 1: of a wall */
typedef struct {
  const double *x, *volume;
  const int *wall;
} sd_sph_points;

/* Of the n grains: radii and volumes [n], their wetness t_j [n], 0 where there is no water */
typedef struct {
  const double *a, *V, *wet;
} sd_sph_grains;

/* Particles of points [3m], which fill the cells (sides of about reach), that are nearer than
 * reach to the grains at x [3n]. first [n+1] is always written; particle [first[n]] unless it is
 * NULL: call twice. */
void sd_sph_look_around(const sd_cells *cells, const double *points, int n, const double *x,
                        double reach, int *first, int *particle);

/* Finds the weights of the list, and wet [n]: t_j. x [3n] of grains */
void sd_sph_grain_weights(sd_sph_kernel kernel, double h, const sd_sph_around *list,
                          const double *x, const sd_sph_points *points, double *wet);

/* Volumes V_a [m] of the particles that are rows row [m] of all, of masses, densities and phi there */
void sd_sph_grain_volumes(int m, const int *row, const double *mass, const double *rho, const double *phi,
                          double *volume);
/* What grains displace goes: mass and V_a eps_a rho_a are the same again. */
void sd_sph_grain_displace(int m, const int *row, const double *phi, double *mass);

/* Adds phi_a to phi [m]; volume [m] of the particles, as below. */
void sd_sph_grain_fractions(const sd_sph_around *list, const sd_sph_grains *grains,
                            const double *volume, double *phi);

/* Adds what grains of velocities v [3n] carry, q_a - eps_a v_a, to flux [3m]. */
void sd_sph_grain_flux(const sd_sph_around *list, const sd_sph_grains *grains,
                       const double *volume, const double *v, double *flux);
/* And what the water carries: eps_a v_a, of n particles */
void sd_sph_grain_water_flux(int n, const double *phi, const double *v, double *flux);

/* Means of the water at each grain, means [n] out: sum_a w_aj of numbers [m]; and [3n] of vectors
 * [3m]. */
void sd_sph_grain_means(const sd_sph_around *list, const double *numbers, double *means);
void sd_sph_grain_vector_means(const sd_sph_around *list, const double *vectors, double *means);

/* The grain's own share of phi at its place: sum_a w_aj t_j V_j w_aj / V_a. own [n] */
void sd_sph_grain_shares(const sd_sph_around *list, const sd_sph_grains *grains,
                         const double *volume, double *own);

typedef struct {
  sd_sph_kernel kernel;
  double h, eta;
  sd_drag_law drag;
  double exponent;
  /* NULL: the flow that a grain makes itself stays in what it sees */
  const sd_sph_wake *wake;
} sd_sph_grain_law;

/* phi [n] at each grain without its share: phi = mean - s(phi) own of the mean of phi. */
void sd_sph_grain_phi(int n, const double *mean, const double *own, double *phi);

/* The part of F that is the water's stress, [3n]: of forces F_a [3m] on the particles, volume [m]. forces are
 * divided by these then. */
void sd_sph_grain_stresses(const sd_sph_around *list, const sd_sph_grains *grains, int m,
                           const double *volume, double *forces, double *F);

/* What the laws of drag ask at the grains: velocities [3n] of the water and of grains, at one time */
typedef struct {
  const double *u, *v;
} sd_sph_slip;

/* Velocities v [3n] in, and out what forces f + F (F NULL: 0) on masses M [n] make of them in a step dt */
void sd_sph_grain_push(int n, double dt, const double *f, const double *F, const double *M, double *v);

/* D_j/(u_j - v_j) of each grain, k [n]; rho [n] of the water itself. The own flow takes half of the slip at
 * most. */
void sd_sph_grain_drag(const sd_sph_grain_law *law, int n, const sd_sph_grains *grains,
                       const sd_sph_slip *slip, const double *rho, const double *phi, double *k);

/* Adds w_aj k_j to total [m]: how much drag a velocity of water particle a makes. */
void sd_sph_grain_load(const sd_sph_around *list, const double *k, double *total);

/* D [3n], implicit in time: with u and v at the end of the step but for drag, and R_j = sum_a w_aj
 * slowed_a, slowed_a = total_a/m_a, the rate at which all grains around slow the water at grain j,
 *   D_j = k (u - v) / (1 + dt (k/M + R))
 * which is the drag at the end of the step where all grains around have one slip. M [n]: mass of
 * grains. */
void sd_sph_grain_drags(const sd_sph_around *list, double dt, const sd_sph_slip *slip,
                        const double *M, const double *k, const double *slowed, double *D);

/* Takes w_aj F_j from reaction [3m]. */
void sd_sph_grain_reactions(const sd_sph_around *list, const double *F, double *reaction);

/* The rates [n] of a density that would follow q become those of the water: divided by eps, but
 * for what shift adds, du.grad rho; slope and du as of sd_sph_particles, du NULL: no shift. */
void sd_sph_grain_rates(int n, const double *phi, const double *slope, const double *du, double *rate);

SD_END_C
#endif
