/* Film between a sphere that is a shell of points and a plane wall. Points see the images of each
 * other (sd_wall.h), and so the shell knows nearly all of what the wall does; what it lacks is the
 * film, mostly the pole of the normal resistance at contact:
 *
 *   B = R_exact - K^T M^-1 K           of the lone sphere at its height, M of its points above the
 *                                      wall with heights max(z, b), K their rigid motion
 *   E = (E_exact - K^T M^-1 z/h) u_t   what the flow u_t z/h does to it beyond the points
 *
 *   forces and torques on the fluid = those of the points + eta (B V - E)      as in sd_wall_film.h
 *
 * The shell is the one that there is, in its orientation: those differ by up to 6 % of themselves,
 * and a shell of 12 alone drifts sideways as it falls. Where it is stiffer than the sphere, by 0.04
 * Stokes drags at most, at gaps of 0.1 to 0.3 radii, the eigenvalues of B are clipped at 0: B >= 0.
 * So a lone sphere settles as it should within 2e-4 to a gap of 1, then within 1e-3, and moves and
 * turns along the wall within 1 %, near contact exactly. At a gap of 0.5 B is 1.5 % of the normal
 * resistance for 12 points and 3 % for 42, at 1 nothing for 12 and 0.6 % for 42; it fades from a
 * gap of 1 and ends at 2. Gaps below the floor count as the floor.
 * Source: our own; exact numbers are those of sd_wall_film.h. */
#ifndef SD_MULTIBLOB_WALL_H
#define SD_MULTIBLOB_WALL_H

#include "sd_multiblob.h"
#include "sd_wall.h"

SD_BEGIN_C

/* Gap in radii of the sphere from which on there is no film */
#define SD_MULTIBLOB_WALL_END 2.0

/* A sphere that is a shell */
typedef struct {
  const sd_multiblob *model;
  /* [3] centre; radius */
  const double *x;
  double a;
  /* [3 model->n] from the centre to its points, turned as they may be */
  const double *r;
  /* 1: with the addition */
  int one_body;
} sd_multiblob_sphere;

/* floor > 0, in radii. B [36] row-major, rows F T, columns U W, and E [6] for u [3], the undisturbed
 * velocity at the centre; NULL: the fluid rests, and E is 0. Both are 0 at once from the end on; nearer it
 * costs the matrix of all points and its inverse.
 * SD_OK; SD_ENOMEMORY; SD_ESINGULAR: the points' matrix is not positive definite; SD_ENOTFINITE. */
sd_status sd_multiblob_wall_film(const sd_multiblob_sphere *s, const sd_wall *wall, double floor,
                                 double eta, const double u[3], double B[36], double E[6]);

SD_END_C
#endif
