/* A sphere as a rigid shell of points that all see each other: true many-body hydrodynamics of
 * spheres, with nothing but the translational tensor between points.
 *
 * A sphere of radius a is n points of radius a b on the vertices of an icosahedron (n = 12) or
 * of its first subdivision (n = 42), at the distance a R from its centre. R and b give the lone
 * sphere both its drags (sd_shell.h). Larger spheres beside smaller ones are half shells of more points
 * (sd_multiblob_half.h). Points bear no torques. All free spheres have one
 * orientation, fixed in the laboratory, a generic one: the icosahedron of sd_shell.h turned by
 * the quaternion (1, 2, 3, 4)/sqrt 30.
 *
 * Of a lone sphere a suspension sees five numbers: drag, rotation, stresslet, and in the flow of
 * a pressure gradient G, u_G(r) = (2 r^2 - r r) G/10, its velocity when it is free (exact G/6,
 * Faxen's law) and the moment sum u_G(r_k).f_k of its forces (exact 2 pi/15 G^2): how well it
 * keeps the flow out. The one-body addition makes the last three exact as well. Viscosity eta,
 * r_k = x_k - X:
 *
 *   u_k += [ alpha A0 + beta A1 + g_k (beta A0 + delta A1) + (strain S r_k + rotation T x r_k)/a^2 ]
 *          /(6 pi eta a)
 *   A0 = sum f_k,  A1 = sum g_k f_k,  S: symmetric traceless part of sum r_k f_k,  T = sum r_k x f_k
 *   g_k = (2 r^2 - r r)/(10 a^2) + (b^2 - 1)/6
 *   (alpha beta; beta delta) = 6 pi (exact^-1 - shell^-1), of the resistance to motions U + g_k V:
 *   exact 6 pi diag(1, 1/45), shell that of the points;  strain = 9/10 (1 - 1/stresslet)
 *   rotation = 3/4 (1 - 1/rotation of the shell): 0, but for half shells
 *
 * 12 points: -9.0e-5, -0.0728, -13.755, -7.6e-4. The mobility of the points alone is positive
 * definite for every configuration; the addition is negative, so there is no theorem with it,
 * but it is so in all that was tried: random spheres up to a volume fraction of 0.5, face-centred
 * crystals to 0.7, groups pressed by 20 % of a radius, touching clumps; but one: with 42 points such
 * a crystal along the axes, to 0.66. There it depends on how shells that are all alike stand: among
 * 15 orientations the smallest eigenvalue at 0.7 is -0.05 to 0.06 over 6 pi eta a. Shells that each
 * stand at random have 0.05 to 0.09.
 * Source: rigid multiblobs: Balboa Usabiaga et al. 2016; the fat icosahedron and the addition are our own. */
#ifndef SD_MULTIBLOB_H
#define SD_MULTIBLOB_H

#include <stddef.h>

#include "sd_status.h"

SD_BEGIN_C

enum { SD_MULTIBLOB_MOST = 642 };

typedef struct {
  /* points */
  int n;
  /* R and b, of a sphere of radius 1 */
  double radius, point;
  /* [3n] r_k of a free sphere of radius 1 */
  double r[3 * SD_MULTIBLOB_MOST];
  /* the constants of the addition: all 0 without it */
  double alpha, beta, delta, strain, rotation;
} sd_multiblob;

/* Are there shells of n points that have both drags of a sphere? */
int sd_multiblob_has(int n);

/* one_body: with the addition. It owns no memory. SD_OK; SD_EOUTSIDE: another n than 12 and 42;
 * SD_ENOMEMORY. */
sd_status sd_multiblob_create(int n, int one_body, sd_multiblob *out);
/* A half shell (sd_multiblob_half.h). SD_OK; SD_EOUTSIDE: another n than 42, 162 and 642. */
sd_status sd_multiblob_create_half(int n, int one_body, sd_multiblob *out);

/* By how much the error of a sum over points may be larger than that which is wanted of spheres, each over
 * the rms of F/(6 pi eta a) of its own: sqrt(n) b, which is 1.95 for 12 points.
 *
 * Of N spheres let the sum mistake the velocity of a point q by E_pq f_q where p pushes. It is within the
 * tolerance t of points: n N <E^2> = t^2/(6 pi eta a b)^2 (the mean over all pairs of points). A sphere with
 * the force F has F/n on each point and moves with the mean of its points, so that what J makes I mistake is
 * F_J times the mean of E over their n^2 pairs, whose square is at most the mean of E^2. The error of the
 * spheres over the rms of F/(6 pi eta a) is thus at most sqrt(N <E^2>) 6 pi eta a = t/(sqrt(n) b).
 * E differs from point to point, and so the means are smaller: a fifth to a half of this was measured, with
 * what points bear besides F/n. */
double sd_multiblob_looser(const sd_multiblob *m);

/* Rotation of the points of a free sphere from the axes of sd_shell.h, those of its mirrors: row-major */
void sd_multiblob_axes(double turn[9]);

/* u [3n] += the addition for the forces f [3n] of one whole sphere, r [3n]: from its centre, turned
 * as it may be. No aliasing. Costs about 35 n multiplications. */
void sd_multiblob_one_body(const sd_multiblob *m, double a, double eta, const double *r,
                           const double *f, double *u);
/* The same as a matrix, of a viscosity of 1: added to the rows and columns of these points in a matrix
 * of `size` columns; M: the first of these numbers */
void sd_multiblob_one_body_matrix(const sd_multiblob *m, double a, const double *r, size_t size,
                                  double *M);

SD_END_C
#endif
