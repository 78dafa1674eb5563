/* The pair sums of weakly compressible SPH over a half neighbour list: forces and density rates.
 *
 * With d = x_a - x_b, v = v_a - v_b, A = P / rho^2, g = W'(r) / r <= 0, and h, alpha, beta, c, dp
 * those of the pair:
 *   force on a   F_a = - m_a m_b [ A_a + A_b + Pi + R f^4 ] g d
 *                      + m_a m_b 2 mu / (rho_a rho_b) g v,            F_b = - F_a
 *   artVisc      Pi = (- alpha c s + beta s^2) 2 / (rho_a + rho_b), s = h v.d / (r^2 + eta), for
 *                v.d < 0, otherwise 0; eta is a length^2, as given
 *   tensCorr     f = W(r) / W(dp); R = 0.01 (A_a + A_b) if both pressures are > 0, otherwise the
 *                sum of epsilon |A| over the negative ones
 *   viscosity    the last term of F_a: Morris, Fox & Zhu 1997 with r.grad W / r^2 = g, for one
 *                dynamic viscosity mu
 *   rate of a    drho_a = sum m_b g v.d   (the same sum for b: v.d does not change sign)
 * Source: Monaghan 1992, 2000.
 *
 * The loops work on four pairs at a time, without a branch: K and G vanish beyond the support, so
 * neighbours outside contribute zeros. Every particle array therefore has one row more than there
 * are particles: a far-away particle without mass, which fills up the last four. */
#ifndef SD_SPH_PAIR_H
#define SD_SPH_PAIR_H

#include "sd_sph_kernel.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What the user gives for a pair of types. */
typedef struct {
  double h, c, alpha, beta, deltap;
} sd_sph_parameters;

/* The same, ready for the loops. */
typedef struct {
  /* 1 / h, N / h^(d+2), N / h^d */
  double inv_h, grad, weight;
  /* 2 alpha c h, 2 beta h^2 */
  double a1, b1;
  /* 1 / K(dp / h) */
  double tens;
  /* 2 mu */
  double visc;
  /* 2 h */
  double support;
  /* c h, 0 without c */
  double ch;
} sd_sph_coefficients;

typedef struct {
  sd_sph_kernel kernel;
  int dimension;
  /* which terms the force has */
  int artvisc, tenscorr, viscous;
  double eta, epsilon;
  /* particles of different class have different coefficients or mass */
  int nclasses;
  /* [nclasses * nclasses] */
  const sd_sph_coefficients *pair;
} sd_sph_model;

sd_sph_coefficients sd_sph_coefficients_of(sd_sph_kernel kernel, int dimension,
                                           const sd_sph_parameters *p, double mu);

/* Each pair once: the neighbours of particle i = first[k], k < n, are
 * neighbor[i][0 .. count[i] - 1] & mask. */
typedef struct {
  int n, mask;
  const int *first, *count;
  int *const *neighbor;
} sd_sph_list;

/* Rows 0 .. n - 1 are particles (owned and ghosts), row n is the far-away one. */
typedef struct {
  int n;
  /* [4 (n+1)] x y z A, and vx vy vz rho */
  const double *x4, *v4;
  /* [n+1] mass and class, 0 .. nclasses - 1; read only if nclasses > 1 */
  const double *m;
  const int *cls;
  /* of each particle if nclasses = 1 */
  double mass;
} sd_sph_particles;

/* Fills rows 0 .. n: position + shift * velocity (v may be null if shift is 0). The last column is
 * left alone: sd_sph_pressures writes A there. */
void sd_sph_pack_x(int n, const double *x, const double *v, double shift, double *x4);
void sd_sph_pack_v(int n, const double *v, const double *rho, double *v4);

/* Adds to f4 [4 (n+1)], rows Fx Fy Fz drho, the last column only with rates (then v4 must be
 * packed). each, if not null: F_a of each pair, 3 numbers, in the order of the list. Returns the
 * square of the shortest distance met: 0 means two particles at one place, and then the forces are
 * not finite. */
double sd_sph_forces(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                     int rates, double *f4, double *each);

/* Room for the pairs closer than 2 h + margin: neighbor[i] and count[i], in the pool, which must
 * hold every pair of the list and three more entries. */
typedef struct {
  double margin;
  int *pool, **neighbor, *count;
} sd_sph_near;

/* Adds drho to rate [n+1] and, with near not null, finds the near pairs. */
void sd_sph_rates(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                  double *rate, const sd_sph_near *near);

/* The loops as compiled for one instruction set: sd_sph_loops.h. */
typedef struct {
  double (*forces)(const sd_sph_model *, const sd_sph_list *, const sd_sph_particles *, int,
                   double *, double *);
  void (*rates)(const sd_sph_model *, const sd_sph_list *, const sd_sph_particles *, double *,
                const sd_sph_near *);
} sd_sph_loops;
extern const sd_sph_loops sd_sph_loops_any, sd_sph_loops_avx2;

#ifdef __cplusplus
}
#endif
#endif
