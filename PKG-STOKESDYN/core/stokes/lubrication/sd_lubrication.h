/* Lubrication: what close spheres of different bodies resist beyond the Rotne-Prager-Yamakawa
 * model, without counting anything twice.
 *
 *   L = sum over pairs  t [ w D + (1 - w) Q^T D Q ]        forces and torques on the fluid = L V
 *   D    exact resistance of the two spheres alone less that of the model (sd_two_sphere.h)
 *   Q    takes the motion of the pair as one rigid body out of its velocities
 *   t    1 up to half the range, 1 - s^2 (3 - 2s) from there to the range, s = 2 xi/range - 1
 *   w_ij = (2 t_ij / (n_i + n_j))^1.2,  n_i = sum_j t_ij
 *
 * xi is the gap over the mean radius. A pair resists its relative motion in full. What it resists
 * of its common motion the neighbours resist as well, since they hold the same fluid: the sum of D
 * would count it once for each, and a cluster of 27 would settle 40 % too slowly. So pairs share
 * it, by a fit to exact velocities of clusters; a pair alone has w = 1 and is exact. D >= 0 and
 * 0 <= w <= 1, so L >= 0. Gaps below the floor, and overlaps, count as the floor: roughness.
 *
 * In viscosities that differ from place to place a pair has the mean of its two.
 *
 * In a flow the forces are L V - sum over pairs t w D V_inf, V_inf the motion as one rigid body in
 * which the fluid takes the pair along: with its mean velocity and angular velocity, weighted by
 * the radii. So a film resists when its spheres approach, also if the flow presses them together,
 * and does not when they are carried and turned as one. Other effects of a strain on a pair are left
 * out.
 *
 * Where spheres are shells of points (sd_multiblob.h) that know the common motion of a pair and of
 * its neighbours, nothing is shared: L = sum of t times the films of sd_film.h. These see no motion
 * of the pair as one rigid body, so that the flow takes nothing off where V are the velocities as
 * they are; only the drift of images is in `carried`.
 * Where larger spheres have more points, films end at a gap of the smaller sphere's size: between a large and
 * a small sphere more gap than that holds third ones, which their shells know and a film does not. Others
 * keep the range over the mean radius.
 * Source: pairs exactly, less what the model has of them: Durlofsky, Brady & Bossis 1987; the rule of sharing
 * and the films of shells are our own. */
#ifndef SD_LUBRICATION_H
#define SD_LUBRICATION_H

#include <stdint.h>

#include "sd_film.h"
#include "sd_neighbor.h"
#include "sd_world.h"

SD_BEGIN_C

typedef struct {
  const sd_two_sphere *functions;
  /* spheres are shells of points, then range up to SD_FILM_LARGEST_XI; NULL: they are points */
  const sd_films *films;
  /* [n_all] of each sphere, where larger spheres have more; NULL: all films are of one kind */
  const int *points;
  /* gap: the floor, > 0; range > gap: where it ends. Over the mean radius of the pair; with points, range
   * over its harmonic mean, 2 a_1 a_2/(a_1 + a_2) */
  double gap, range;
  /* this rank's spheres, then those of other ranks and periodic images within the range */
  int n, n_all;
  sd_spheres spheres;
  /* [n] spheres of one body, not 0, have no lubrication between them; NULL: all free */
  const int64_t *body;
  /* [6n] velocity and angular velocity of the undisturbed fluid at the centres; NULL: it rests.
   * Not read with films */
  const double *u;
  /* [3 (n_all - n)] velocities of the images beyond those of their spheres, and of the fluid there
   * likewise, in a box that deforms with the flow; NULL: none */
  const double *drift;
  /* refresh: rows of the n_all - n from those of the n, NULL: there are none */
  sd_world world;
  /* will random forces be drawn (sd_lubrication_noise.h)? Then pairs are kept whole */
  int noisy;
} sd_lubrication_scene;

/* L_12 of a pair by what it knows, a quarter of its numbers: d the unit vector from 1 to 2, the
 * rest as in sd_pair_resistance.h */
typedef struct {
  double d[3], XA, YA, YB12, YB21, XC, YC;
} sd_lubrication_link;

enum { SD_LUBRICATION_OWN = 21 };

/* Zero-initialise; placed again it keeps its memory; sd_lubrication_free in the end. */
typedef struct {
  /* spheres of this rank, and with those of other ranks and images */
  int n, n_all;
  /* each pair once: i < j < n, or j >= n: another rank's. A sphere's own images are in the
   * diagonal. Behind them, for preconditioners, those between spheres of two other ranks that both have
   * pairs with this one's, i, j >= n */
  long count, beyond;
  int (*pair)[2];
  /* [count + beyond] L_ij; L_ji is its transpose */
  sd_lubrication_link *link;
  /* [count + beyond] for preconditioners: what the model itself resists when the two approach each other,
   * beyond their drags, fading from contact to the range */
  double *model;
  /* [SD_LUBRICATION_OWN n] L_ii, which is symmetric: FU and TW, each xx yy zz xy xz yz, and FW, row-major */
  double *diagonal;
  /* [6n] what the flow takes off: forces and torques on the fluid are L V - carried */
  double *carried;
  /* [7n] of sd_lubrication_strain_power: sum of t w D e of each sphere, and of e.(t w D V_inf); NULL: it was
   * never placed without films */
  double *strain;
  /* [6 (n_all - n)] velocities of the others */
  double *others;
  sd_world world;
  struct sd_lubrication_work *work;
} sd_lubrication;

/* The spheres have moved. On all ranks together. SD_OK; SD_ENOMEMORY; SD_EOUTSIDE: radii that
 * `functions` does not have; SD_ENOTFINITE; that of refresh. */
sd_status sd_lubrication_place(sd_lubrication *L, const sd_lubrication_scene *scene);
/* What sphere i < n resists alone, as a wall makes it: L_ii += B [36], carried += E [6]. B is symmetric:
 * of its blocks FU and TW the lower triangles are read, and FW in place of TU. After place, which forgets
 * it. */
void sd_lubrication_add_own(sd_lubrication *L, int i, const double B[36], const double E[6]);
/* B += L_ij of a pair, row-major, rows F T, columns U W */
void sd_lubrication_add_block(const sd_lubrication_link *l, double B[36]);
/* B [36] = L_ii of sphere i < n, likewise */
void sd_lubrication_own_block(const sd_lubrication *L, long i, double B[36]);
/* out = L V, rows [6 n]: no aliasing. ctx is an sd_lubrication. SD_OK or that of refresh. */
sd_status sd_lubrication_apply(void *ctx, const double *V, double *out);
/* What films do to the spheres: F [6 n] = carried - L V, likewise */
sd_status sd_lubrication_forces(const sd_lubrication *L, const double *V, double *F);
/* out = (L + X) V, X of translations alone: X_ij = -c d d^T of each pair, c [count]; X_ii: own [6 n], xx yy
 * zz xy xz yz. own and c NULL: 0 */
sd_status sd_lubrication_apply_both(const sd_lubrication *L, const double *own, const double *c,
                                    const double *V, double *out);

/* First moments of films, symmetric and traceless, xx yy zz xy xz yz: S [6 n] += half of that of
 * each pair of this sphere, r F with F the force of the first on the fluid and r from the first to
 * the second, V rows as for sd_lubrication_apply. The other half is its neighbour's. Placed with
 * films. SD_OK or that of refresh. */
sd_status sd_lubrication_stress(const sd_lubrication *L, const double *V, double *S);

/* out [n]: the power that the flow puts into films beside that of the forces f on the spheres. It
 * carries a sphere with u and its pair with V_inf; with e = V_inf - u that power is sum f.e, f =
 * t w D (V_inf - V), and the films then lose, summed over all spheres,
 *   sum f.(u - V) + out = (V_inf - V).t w D (V_inf - V) >= 0.
 * 0 in a flow without a strain. V [6n] */
void sd_lubrication_strain_power(const sd_lubrication *L, const double *V, double *out);

/* The rate at which the stiffest motion decays that films alone resist (sd_rate.h), by 30 products. W > 0
 * [6 n]: an inertia; v [6 n], not 0, is another then; work [6 n]. SD_OK; SD_ENOTFINITE; that of a function
 * of the caller. */
sd_status sd_lubrication_rate(sd_lubrication *L, const double *W, double *v, double *work,
                              double *rate);
void sd_lubrication_free(sd_lubrication *L);

SD_END_C
#endif
