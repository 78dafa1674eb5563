/* Between the files of sd_clump.h. */
#ifndef SD_CLUMP_INTERNAL_H
#define SD_CLUMP_INTERNAL_H

#include "sd_clump_options.h"
#include "sd_shape.h"
#include "sd_shell.h"

enum { SD_CLUMP_COLUMNS = 12 }; /* unit slips: 3 velocities, 3 angular velocities, 6 strains */

/* --- sd_clump_surface.c: the points that carry the unknown forces ----------------------------- */

/* x [3n], a [n] their radii, sphere [n] whose they are; number: of the orientation. All of these: SD_OK or
 * SD_ENOMEMORY. */
typedef struct {
  int n, number;
  double *x, *a;
  int *sphere;
} sd_surface;

void sd_surface_free(sd_surface *s);

/* Centres alone, for shell 1 */
sd_status sd_surface_of_centres(const sd_shape *shape, sd_surface *out);

/* Exposed points for count [n] points a sphere (sizes of shells) and one of the orientations */
sd_status sd_surface_of_shells(const sd_shape *shape, const int *count, int number, sd_shells *cache,
                               sd_surface *out);

/* Which part of its surface every sphere shows: all of it, or by a fine shell of directions.
 * fraction [n] */
sd_status sd_surface_exposed(const sd_shape *shape, sd_shells *cache, double *fraction);

/* Points of the whole shell of every sphere: even density, n exposed points for every sphere that
 * shows. Without fractions (NULL): as if nothing were hidden. count [n] */
void sd_surface_share(const sd_shape *shape, int n, const double *fraction, int *count);

/* Points are not quite as even as a sphere, and where they happen to lie at a contact or along a
 * seam is chance. With few points the result is the mean over this many orientations of all shells
 * together. */
int sd_surface_orientations(int n);

/* --- sd_clump_solve.c: the forces on the points for the unit slips ---------------------------- */

/* Unknowns a point */
int sd_clump_width(const sd_clump_options *o);

/* SD_OK, or SD_ENOMEMORY: neither way to solve fits */
sd_status sd_clump_check_need(double points, const sd_clump_options *o, sd_clump_need *need);

/* The unit slips at the points, B [12][width n]; solved in place. iterations: raised to the largest number
 * of an iterative solve. Errors as of sd_clump_create. */
sd_status sd_clump_solve(const sd_surface *s, const sd_clump_options *o, const sd_clump_need *need,
                         double *B, int *iterations);

#endif
