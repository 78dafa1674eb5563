/* Squirmers: spheres that swim by a slip of their surface, as shells of points. About a direction e, at
 * the point n of the surface, with the angle theta from e,
 *
 *   u_s = (B1 + B2 cos theta) sin theta e_theta + beta cos theta sin theta e_phi
 *       = -(B1 + B2 e.n) (e - (e.n) n) + beta (e.n) e x n
 *
 * relative to the rigid motion of the sphere. Nobody pulls: alone it swims with 2 B1/3 along e, does
 * not turn, and the first moments of its forces on the fluid are -4 pi eta a^2 B2 (e e - 1/3): B2 > 0
 * pulls the fluid towards it along e (a puller), B2 < 0 pushes it away (a pusher).
 *
 * A shell of points knows smooth motions only, so the slip at its points, x = r_k/a from the centre, is
 *
 *   B1 [ -2/3 e - 10 (g_k - m) e ]                        g_k: sd_multiblob.h, -10 g = n n - 1/3 on a
 *                                                         sphere
 *   + B2 [ -w (e.n) (e - (e.n) n) + s (e e - 1/3) x ],    n = x/|x|
 *   + beta t (e.n) e x n
 *
 * with constants of the shell, from its own solution when it is alone: m, so that it swims with 2 B1/3
 * exactly; s, so that the moments above are exact; t, so that sum (e.r)(e.(r x f)), the rotlet dipole, is
 * that of a sphere, 8 pi/3 eta a^3 beta; w = 1 of 42 points and more, 0 of 12, which cannot carry
 * the pattern.
 * With the one-body addition m = 0, and the source dipole of B1 is exact too.
 * What is not exact is the flow close by. Root of the mean square error of the velocity of the fluid at
 * 1.3, 2 and 3 radii over that of the velocity itself, with the addition: B1 0.32 0.33 0.20 (12 points),
 * 0.21 0.05 0.02 (42); B2 0.47 0.18 0.07, 0.19 0.04 0.02.
 * Source: Lighthill 1952, Blake 1971, Ishikawa, Simmonds & Pedley 2006 (slip, speed, stresslet); slip at
 * points of a shell: ours. */
#ifndef SD_SQUIRMER_H
#define SD_SQUIRMER_H

#include "sd_body_shape.h"
#include "sd_multiblob.h"

SD_BEGIN_C

/* m, w, s, t of a shell */
typedef struct {
  double uniform, tangential, strain, twist;
} sd_squirmer;

/* A swimmer: e of length 1; B1, B2, beta velocities */
typedef struct {
  double e[3], B1, B2, beta;
} sd_squirmer_stroke;

/* lone: the shell of radius 1 and viscosity 1, with the addition if it has it
 * (sd_multiblob_shape.points). Never fails. */
void sd_squirmer_create(const sd_multiblob *m, const sd_body_shape *lone, sd_squirmer *out);

/* u [3 n] -= slip at the points r [3 n] from the centre of a sphere of radius a: what the fluid at the
 * points is to the rigid motion of the swimmer (u of sd_bodies.h) */
void sd_squirmer_slip(const sd_multiblob *m, const sd_squirmer *s, const sd_squirmer_stroke *stroke,
                      double a, const double *r, double *u);

SD_END_C
#endif
