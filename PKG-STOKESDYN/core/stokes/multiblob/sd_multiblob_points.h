/* From spheres to their points and back. Every sphere has the same number n of rows, one after the
 * other: rows n i ... n (i + 1) - 1 are the points of sphere i, so that a row of 3 n numbers of a
 * sphere crosses between ranks where one of 6 did. Points that are left out have radius 0, and take
 * no part in any product. */
#ifndef SD_MULTIBLOB_POINTS_H
#define SD_MULTIBLOB_POINTS_H

#include <stdint.h>

#include "sd_multiblob.h"
#include "sd_shape.h"

SD_BEGIN_C

/* What there is of a sphere's shell: bit k is set if point k is there, and SD_MULTIBLOB_WHOLE if
 * the sphere has the one-body addition. Exact as a double, too. */
typedef uint64_t sd_multiblob_mask;
#define SD_MULTIBLOB_WHOLE (UINT64_C(1) << SD_MULTIBLOB_MOST)

/* Of a sphere that is free, or touches others at most */
static inline sd_multiblob_mask sd_multiblob_whole(const sd_multiblob *m)
{
  return SD_MULTIBLOB_WHOLE | ((UINT64_C(1) << m->n) - 1);
}

/* Of the members of a rigid clump, mask [clump->n], whose shells are turned by turn [9] in its axes:
 * points nearer to the centre of another member than the radius of its shell are left out; the
 * addition is for members that overlap no other, by more than the tolerance of shapes. */
void sd_multiblob_masks(const sd_multiblob *m, const sd_shape *clump, const double turn[9],
                        sd_multiblob_mask *mask);

typedef struct {
  /* [3 n], [n] centres and radii */
  const double *x, *a;
  /* [9 n] rotation of the shells, row-major; NULL: all are free. [n]; NULL: all are whole */
  const double *turn;
  const sd_multiblob_mask *mask;
  int n;
} sd_multiblob_spheres;

/* Has sphere i the one-body addition? */
static inline int sd_multiblob_is_whole(const sd_multiblob_spheres *s, long i)
{
  return s->a[i] > 0.0 && (!s->mask || s->mask[i] & SD_MULTIBLOB_WHOLE);
}

/* Points of all of them: r [3 m->n n] from the centre of their sphere (NULL: not wanted), x where
 * they are, b [m->n n] radii */
void sd_multiblob_expand(const sd_multiblob *m, const sd_multiblob_spheres *s, double *r, double *x,
                         double *b);

/* u [3 m->n n] += the one-body addition of each sphere that has it, w [n] 1/sqrt(eta) */
void sd_multiblob_add(const sd_multiblob *m, const sd_multiblob_spheres *s, const double *w,
                      const double *r, const double *f, double *u);

/* First moments of the forces f of the points of each sphere, so many a sphere, about its centre,
 * symmetric and traceless, xx yy zz xy xz yz: S [6 spheres] += dev sym sum r_k f_k. f acts on the fluid;
 * the stress of the suspension is 2 eta E - (sum of S)/V. */
void sd_multiblob_moments(int points, int spheres, const double *r, const double *f, double *S);

SD_END_C
#endif
