/* A sphere as n nearly even points on a shell (rigid multiblob, Balboa Usabiaga et al. 2016).
 *
 * Every point is a small sphere that only translates, with the Rotne-Prager-Yamakawa tensor between
 * points. Shell radius and radius of the points are chosen together, so that the lone sphere has
 * exactly its two drags: with a = 1
 *   resistance to translation = 6 pi eta,   to rotation = 8 pi eta.
 * With kappa = point/radius they are eta radius T(kappa) and eta radius^3 Q(kappa), so kappa is the
 * root of T^3/Q = 27 pi^2 and radius = 6 pi/T. There are two roots. At the first one the points do
 * not overlap, and a flow that changes over the sphere leaks between them. At the second one they
 * do: the twelve points of the icosahedron, SD_SHELL_FAT, have it, with radius 0.6563, point 0.5623
 * and the stresslet of a sphere within 1e-3. Shells of more points have the first.
 *
 * All point sets have the symmetry T_h of a cube with stripes (the pyritohedron), which makes both
 * resistances isotropic:
 * n = 12, 42, 162, 642, ... are the icosahedron and its subdivisions; other n have the smallest
 * Coulomb energy found with orbits of 6, 8, 12 and 24 points. These orbits add up to n = 0, 2, 6 or
 * 8 (mod 12); any other n is rounded up. */
#ifndef SD_SHELL_H
#define SD_SHELL_H

#include "sd_status.h"

SD_BEGIN_C

enum { SD_SHELL_FAT = 12 };

typedef struct {
  /* points */
  int n;
  /* of the shell, in units of the sphere's radius */
  double radius;
  /* hydrodynamic radius of a point, in the same unit */
  double point;
  /* [3n] unit vectors */
  double *p;
} sd_shell;

/* Number of points of the shell that is made for n: 1 for n = 1, else the next number >= max(n, 12)
 * that has the symmetry. */
int sd_shell_size(int n);

/* The points alone of n = 12, 42, 162, 642, ...: p [3n] unit vectors. 0: n is no such number. */
int sd_shell_points(int n, double *p);

/* Points and calibration; a pure function of n (for n = 1 one point at the centre: radius 0, point
 * 1). The owner frees. Costs memory and time of a dense solve with 3n/8 unknowns. SD_OK;
 * SD_ENOMEMORY; SD_ESINGULAR: no calibration (never met). */
sd_status sd_shell_create(int n, sd_shell *shell);
void sd_shell_free(sd_shell *shell);

/* A cache of shells by number of points, the caller's: start with {0}, free when no more clumps are
 * to come. */
typedef struct {
  int count;
  sd_shell *shell;
} sd_shells;
void sd_shells_free(sd_shells *cache);

SD_END_C
#endif
