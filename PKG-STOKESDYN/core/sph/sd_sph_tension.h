/* Surface tension of one fluid with a free surface, and its contact angle on walls: the continuum force
 * F = sigma kappa n delta on the particles that the surface cuts the support of; there is no gas.
 *
 * V = m / rho0, constant; g = W'/r, d = x_a - x_b, D dimension; f = fluid, w = wall.
 *   S_a = V W(0) + sum_f V W              G_a = sum_f V g d          (towards the fluid; 0 in the bulk)
 *   wetness c_w = min(1, S_w / max(1 - Sw_w, 0.02)), 0 where Sw_w > 0.98, Sw the sum over walls: then
 *   wall particles count in S and G in the measure c in which they are wet
 *   weight  w_a rises from 0 to 1 while h |G_a| rises from 0.1 to 0.3: who is at the surface. 0 where the
 *           support is whole: all eigenvalues of M of sd_sph_order.h above SD_SPH_WHOLE, no wall in it
 *   normal  n = - G/|G|; beside a wall, with e from the wall into the fluid and t the direction of - Gf
 *           across e, it goes over to the normal of the contact angle, sin(theta) t + cos(theta) e, with
 *           nw = min(1, 2 Sw)
 *   M = - sum w_b V g d d^T,  N = sum w_b V (n_b - n_a) g d^T. grad n = N M^-1, eigenvalues of M kept
 *           above 0.05; of it the part along the surface, P grad n P, P = I - n n^T
 *   line    a wall particle shows a the normal of the contact angle, with w_b = 1. That normal is true at
 *           the contact line, below a along the surface. So the wall says how n turns between the line and
 *           a, and nothing of how it turns along the line: with the direction u = sin(theta) e - cos(theta) t
 *           up the surface, its part in N is (n_b - n_a) V g (d.u) u^T and in M - V g (d.u) l u u^T. The arm
 *           is l = (1 - nw) z_w: z_w the height over the wall, 1 - nw since n_a has nw of that normal
 *           already. (With d.u for l the surface would have half its curvature there; with z_w / sin(theta)
 *           for z_w, the length along the surface, 150 degrees come out as 142 instead of 145.)
 *   depth   a particle at the depth z sees S0(z/h) of the whole; from curvatures k_i at its place follow
 *           those at the surface, k_i / (1 + k_i z). In 3-D they are the eigenvalues of the symmetric
 *           part of grad n, in 2-D it is its trace. A curved surface hides less: S0 = S + kappa h beta,
 *           beta(z) = 1/(2 (D-1) h) times the integral of y^2 W over the plane at z. |kappa| <= 2 (D-1)/h
 *   means   <k>_a = sum w_b V W k_b / sum w_b V W with a itself; k = <kappa> + 2.8 (<kappa> - <<kappa>>), but
 *           beside a wall k = (1 - nw) k + nw kappa; ks = k (1 + 0.16 h k/(D-1))
 *   inwards k_a = w_a ks_a + (1 - w_a) sum w_b V W ks_b / sum w_b V W with a itself
 *   force   F_a = 2 sigma V k_a G_a: 2, since the inner half of the smoothed step carries the particles
 * The force acts at the mean depth 0.37 h, where a wave of the surface moves the fluid less, by
 * exp(- 0.37 k h). The two numbers of ks give a part of that back: with 1 and 0 the frequency of a drop of 20
 * particles across is 7 % low and its pressure 1 % high, with these 2 % and 5 %; a uniform ks remains a
 * pressure.
 * The noise of the curvature from particle to particle is what drives drops until they break; the means,
 * and the friction between particles of the surface, take that away:
 *   F_ab = 2 (D+2) mu_s w_a w_b V_a V_b g (v_ab.d)/r^2 d,    mu_s = 0.15 sqrt(sigma rho h)
 * which keeps momentum and angular momentum. The force itself does so only to some thousandths of the
 * sum of its sizes: sd_sph_drops.h.
 * Uniform kappa and a uniform pressure sigma kappa cancel particle by particle, since the force of the
 * pressure is - 2 P V G. Beside a wall that holds only with what takes back the push of dry walls: fluid has
 * its pressure of all wall particles, - 2 P V (Gf + Gw), as if there were fluid beyond the contact line. So
 * F_a + 2 min(P_a, sigma k_a) V (Gf + Gw - G): no more than surface tension holds, for walls must stop water.
 * Source: Brackbill, Kothe & Zemach 1992 (the continuum force), Morris 2000 (in SPH); depth, means and
 * friction of the surface: unittest/core/sph/test_sph_tension.c and doc/fix_sph_tension.md. */
#ifndef SD_SPH_TENSION_H
#define SD_SPH_TENSION_H

#include "sd_sph_sums.h"

SD_BEGIN_C

/* What a plane surface at z = 2 h k / (SD_SPH_DEPTHS - 1) hides; by quadrature, once. start[m]: the interval
 * of S0 that has 1/2 + m / (2 SD_SPH_STARTS) in it. W0: W(0). */
enum { SD_SPH_DEPTHS = 201, SD_SPH_STARTS = 256 };
typedef struct {
  sd_sph_kernel kernel;
  int dimension;
  double h, W0, S0[SD_SPH_DEPTHS], beta[SD_SPH_DEPTHS];
  unsigned char start[SD_SPH_STARTS + 1];
} sd_sph_surface;
void sd_sph_surface_make(sd_sph_kernel kernel, int dimension, double h, sd_sph_surface *s);

/* The depth z, 0 to 2 h, where the sum over neighbours is S. */
double sd_sph_depth(const sd_sph_surface *s, double S);
/* Curvature at the surface of that in a particle with the sum S: gradient [9] of n by rows. curved: with
 * what a curved surface hides. */
double sd_sph_surface_curvature(const sd_sph_surface *s, const double *gradient, double S, int curved);

/* The particles. Rows 0 .. n - 1 of `list` are those of this rank, rows up to all are neighbours, and the
 * far-away one. */
typedef struct {
  const sd_sph_surface *surface;
  const sd_sph_both *list;
  int all;
  /* [4 (all+1)] x y z and V; - V of those whose support is whole, but for walls; 0 of atoms that are no
   * particles, and of the far-away one */
  const double *x4;
  /* [all+1] 1: of a wall; NULL: there are no walls */
  const int *wall;
  /* [count] those of this rank that somebody with w > 0 may have in reach, in their order. The others are
   * deep: loops pass over them, and leave their rows as they are. NULL: all n are near */
  const int *near;
  int count;
} sd_sph_film;
#define SD_SPH_WHOLE 0.95

/* The skin: particles of this rank that are at the surface, w > 0, and their neighbours that may be at one or
 * in a wall. Room for as many as are near. */
typedef struct {
  /* who they are, their neighbours, as rows of the list, and how many */
  int *who;
  const int **neighbor;
  int *count;
  /* [sd_sph_skin_size] the neighbours, where there are no walls; with walls they are those of the list */
  int *pool;
  /* w_b V_b W of the neighbours [sd_sph_skin_weights], from weight[first] on */
  size_t *first;
  double *weight;
  /* [SD_SPH_SKIN_SUMS] each: M | N | sum w V W | sum w V g (v.d)/r^2 d | 0 */
  double *turns;
  /* [2] each: w V W(0), and one over the sum w V W with that */
  double *own;
  /* how many */
  int size;
} sd_sph_skin;
enum { SD_SPH_SKIN_SUMS = 20 };

/* What is found of the particles, one after the other; each function below says what it fills, and reads what
 * those before it have filled. */
typedef struct {
  /* [8 n] S Gf | Sw Gw; not without walls of those whose support is whole: nearly all of them no surface
   * reaches */
  double *sums;
  /* [8 n] sum c V W | sum c V g d | sum V W cos, sum V W sin, sum V W | 0 over walls, of fluid with Sw > 0, 0
   * elsewhere; NULL without walls */
  double *beside;
  /* [4 n] S G with wet walls; when curvatures have been carried inwards, of all fluid that is near, but with
   * sum w V W in the place of S where w = 0 */
  double *whole;
  /* [4 (all+1)] normal, w; 0 0 0 -1 of wall particles; of others 0. When curvatures have been carried inwards
   * the first number of w > 0 is ks instead. */
  double *surface;
  /* [8 n] the normal of the contact angle, nw | u, l; NULL without walls */
  double *at_wall;
} sd_sph_film_rows;

/* Room for the neighbours of the skin; fills sums, and finds who may be in the skin. */
size_t sd_sph_skin_size(const sd_sph_film *f);
void sd_sph_film_sums(const sd_sph_film *f, const sd_sph_film_rows *rows, sd_sph_skin *skin);

/* c of wall particles, 0 of others that are near: wet [n]. */
void sd_sph_film_wetness(const sd_sph_film *f, const sd_sph_film_rows *rows, double *wet);

/* Fills beside, with c, cos and sin of the contact angle, and 1 of wall particles, 0 of others, as rows of
 * contact [4 (all+1)]. */
void sd_sph_film_wet_walls(const sd_sph_film *f, const double *contact, const sd_sph_film_rows *rows);

/* Fills whole, at_wall and, but for ghosts, surface, which is 0 before. */
void sd_sph_film_normals(const sd_sph_film *f, const sd_sph_film_rows *rows);

/* Room for the weights of the skin; finds the skin, its turns and its kappa, once after sd_sph_film_sums. v4
 * [4 (all+1)] v, unused; nothing is read of those whose support is whole where there are no walls. */
size_t sd_sph_skin_weights(const sd_sph_film *f, const sd_sph_film_rows *rows, const sd_sph_skin *skin);
void sd_sph_film_curvatures(const sd_sph_film *f, const sd_sph_film_rows *rows, const double *v4,
                            sd_sph_skin *skin, double *kappa);

/* <k> of the skin, of k [all+1], 0 where w is 0. */
void sd_sph_film_means(const sd_sph_skin *skin, const double *k, double *mean);

/* ks of the skin, in the place of <kappa>; of kappa, <kappa> and <<kappa>>. */
void sd_sph_film_sharpen(const sd_sph_film *f, const sd_sph_film_rows *rows, const sd_sph_skin *skin,
                         const double *kappa, double *once, const double *twice);

/* k of fluid that is near, of ks [all+1], 0 where w is 0. */
void sd_sph_film_inwards(const sd_sph_film *f, const sd_sph_film_rows *rows, const sd_sph_skin *skin,
                         const double *ks, double *k);

/* F [3 n] of k, and area [n]: the share of each particle in that of the surface of the fluid, 2 V |G| where
 * the surface reaches, without that on walls; both 0 before. friction: mu_s. */
typedef struct {
  double sigma, friction;
} sd_sph_tension;
void sd_sph_tension_forces(const sd_sph_film *f, const sd_sph_tension *t, const sd_sph_film_rows *rows,
                           const sd_sph_skin *skin, const double *k, double *F, double *area);

/* Adds to F [3 n] what takes back the push of dry walls; P [n]: pressure, of fluid. */
void sd_sph_dry_walls(const sd_sph_film *f, double sigma, const sd_sph_film_rows *rows, const double *k,
                      const double *P, double *F);

/* Time step up to which waves of the length 2 h on the surface are resolved, 0.25 sqrt(rho h^3 / (2 pi
 * sigma)); mu_s; and the Ohnesorge number mu / sqrt(rho sigma R) of a drop. */
double sd_sph_capillary_step(double sigma, double rho, double h);
double sd_sph_surface_friction(double sigma, double rho, double h);
double sd_sph_ohnesorge(double mu, double sigma, double rho, double R);

SD_END_C
#endif
