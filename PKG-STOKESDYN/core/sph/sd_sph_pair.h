/* The model of weakly compressible SPH, and its pair forces over a half neighbour list.
 *
 * With d = x_a - x_b, v = v_a - v_b, A = P / rho^2, V = m / rho, g = W'(r) / r <= 0, D = 2 or 3,
 * and h, alpha, beta, c, dp, mu those of the pair:
 *   force on a   F_a = - m_a m_b [ A_a + A_b + Pi + R f^4 ] g d  + friction,       F_b = - F_a
 *   artVisc      Pi = (- alpha c s + beta s^2) 2 / (rho_a + rho_b), s = h v.d / (r^2 + eta), for
 *                v.d < 0, otherwise 0; eta is a length^2, as given
 *   tensCorr     f = W(r) / W(dp); R = 0.01 (A_a + A_b) if both pressures are > 0, otherwise the
 *                sum of epsilon |A| over the negative ones
 *   laplacian    m_a m_b 2 mu / (rho_a rho_b) g v: Morris, Fox & Zhu 1997 with r.grad W / r^2 = g
 *   central      m_a m_b 2 (D+2) mu / (rho_a rho_b) (v.d) / (r^2 + 0.001 h^2) g d: Monaghan 2005.
 *                Along d, so it keeps angular momentum and leaves solid rotation alone
 *   rate of a    drho_a = sum m_b g v.d   (the same sum for b: v.d does not change sign)
 * With a viscosity mu_a of each particle mu is 2 mu_a mu_b / (mu_a + mu_b), for which the stress is
 * continuous where mu jumps (Cleary & Monaghan 1999).
 * Source: Monaghan 1992, 2000. What a scheme changes:
 *   shift        F_a += V_a V_b g [ rho_a v_a (du_a.d) + rho_b v_b (du_b.d) ]: particles that are
 *                moved with v + du carry their momentum along; still F_b = - F_a
 *   pliant         shift, and the pressure acts by B on both: - m_a m_b g (A_a B_a + A_b B_b) d, still F_b =
 *                - F_a; rate of a: - rho_a tr(G_a B_a), its adjoint. In rows that a flow has sheared
 *                M is not 1, and the stress P M of the plain force resists as that of a solid does;
 *                P M B does not. B is 1, and the rate plain, at a surface; a wall has B of its partner
 *   correction   F_a = - V_a V_b (P_b - P_a) g B_a d, F_b the same with B_b: exact for a linear
 *                pressure, not antisymmetric. In friction g becomes g (d.B d) / r^2, B the mean of
 *                the two. A wall has the B of its partner
 *   volume       F_a = - 2 V_a V_b p g d, p = (rho_b P_a + rho_a P_b) / (rho_a + rho_b): continuous
 *                where densities jump, Hu & Adams 2006. Rate: sum m_b g v.d 2 rho_a / (rho_a +
 *                rho_b), its adjoint: sum F.v = - sum V P rate / rho. VOLUME_SHIFT: with the term of
 *                shift. VOLUME_CORRECTION: F_a = - V_a V_b 2 rho_a / (rho_a + rho_b) (P_b - P_a) g
 *                B_a d with B of all fluids: an equal pressure everywhere pushes nobody, so that
 *                lattices have no stiffness, and at rest under gravity P_b - P_a is that of both
 *                densities
 *
 * The loops work on four pairs at a time, without a branch: K and G vanish beyond the support, so
 * neighbours outside contribute zeros. Every particle array therefore has one row more than there
 * are particles: a far-away particle without mass, which fills up the last four. */
#ifndef SD_SPH_PAIR_H
#define SD_SPH_PAIR_H

#include "sd_sph_kernel.h"

#include <stddef.h>

SD_BEGIN_C

typedef enum {
  SD_SPH_PLAIN,
  SD_SPH_SHIFT,
  SD_SPH_SHIFT_PLIANT,
  SD_SPH_CORRECTION,
  SD_SPH_VOLUME,
  SD_SPH_VOLUME_SHIFT,
  SD_SPH_VOLUME_CORRECTION
} sd_sph_scheme;
typedef enum { SD_SPH_INVISCID, SD_SPH_LAPLACIAN, SD_SPH_CENTRAL } sd_sph_friction;

/* What the user gives for a pair of types. */
typedef struct {
  double h, c, alpha, beta, deltap, mu;
} sd_sph_parameters;

/* The same, ready for the loops; 0 where no term of the model asks for it. */
typedef struct {
  /* 1 / h, N / h^(d+2), N / h^d */
  double inv_h, grad, weight;
  /* 2 alpha c h, 2 beta h^2 */
  double a1, b1;
  /* 1 / K(dp / h) */
  double tens;
  /* 2 mu, of central 2 (D+2) mu */
  double visc;
  /* 2 h */
  double support;
  /* delta c h */
  double diffusion;
} sd_sph_coefficients;

typedef struct {
  sd_sph_kernel kernel;
  int dimension;
  sd_sph_scheme scheme;
  /* which terms the force has */
  int artvisc, tenscorr;
  sd_sph_friction friction;
  double eta, epsilon;
  /* density diffusion, sd_sph_sums.h */
  double delta;
  /* particles of different class have different coefficients or mass */
  int nclasses;
  /* [nclasses * nclasses] */
  const sd_sph_coefficients *pair;
} sd_sph_model;

/* Is its scheme one for several fluids? */
int sd_sph_of_fluids(const sd_sph_model *model);
/* Does it move particles with v + du? */
int sd_sph_shifts(const sd_sph_model *model);
/* Does it correct gradients? */
int sd_sph_corrects(const sd_sph_model *model);

sd_sph_coefficients sd_sph_coefficients_of(const sd_sph_model *model, const sd_sph_parameters *p);

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
  /* [4 (n+1)] x y z and: for forces A, with correction and volume P; for sums V, of a wall - V */
  const double *x4;
  /* [4 (n+1)] vx vy vz rho */
  const double *v4;
  /* [n+1] mass and class, 0 .. nclasses - 1; read only if nclasses > 1 */
  const double *m;
  const int *cls;
  /* of each particle if nclasses = 1 */
  double mass;
  /* [n+1] k: of fluid k; ~k: of a wall before fluid k. NULL: all are of fluid 0 */
  const int *phase;
  /* [n+1] the viscosity of each particle, sd_sph_rheology.h; row n: > 0. NULL: that of pairs of
   * classes, mu of sd_sph_parameters, which is 1 otherwise */
  const double *mu;
  /* [4 (n+1)], [4 (n+1)], [8 (n+1)] made by sd_sph_order.h: with delta grad rho, rho; with shift and
   * correction du and a number without meaning here; with pliant and correction B xx yy zz xy | xz yz, 1
   * for walls, 0. Each in rows of its own: one loop reads one of them */
  const double *slope, *du, *B;
} sd_sph_particles;

/* Fills rows 0 .. n: position + shift * (velocity + du), with v and du [3 n] or null. The last
 * column is left alone but for row n. */
void sd_sph_pack_x(int n, const double *x, const double *v, const double *du, double shift,
                   double *x4);
void sd_sph_pack_v(int n, const double *v, const double *rho, double *v4);
/* The last column of x4 for forces, from P and rho [n]. Where particles are shifted, P - P0 acts: the sum
 * of 2 P0 V_a V_b g d over a body, or over the neighbours of a particle, is 0 only while they are spread
 * evenly around it. Of a body that accelerates it took up to a fifth of the added mass at P0 = 50 rho a R,
 * and the order of the particles is the business of shift. The plain force has P. */
void sd_sph_pack_pressures(const sd_sph_model *model, int n, const double *P, double P0,
                           const double *rho, double *x4);
/* The P0 that stands there: 0 in the plain scheme. */
double sd_sph_reference(const sd_sph_model *model, double P0);

/* Adds to f4 [4 (n+1)], rows Fx Fy Fz drho, the last column only with rates (then the scheme is
 * plain). Not with correction: sd_sph_corrected_forces. each, if not null: F_a of each pair, 3
 * numbers, in the order of the list. Returns the square of the shortest distance met: 0 means two
 * particles at one place, and then the forces are not finite. v4 is read where a term, the scheme
 * or rates ask for velocities or densities. */
double sd_sph_forces(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                     int rates, double *f4, double *each);

SD_END_C
#endif
