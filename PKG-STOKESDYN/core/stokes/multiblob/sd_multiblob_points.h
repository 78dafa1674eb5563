/* From spheres to their points and back. The rows of a sphere are its points, one after the other: where
 * all have n, rows n i ... n (i + 1) - 1 are those of sphere i, and where larger spheres have more
 * (sd_multiblob_half.h) rows first[i] ... first[i + 1] - 1. Between ranks all of them cross where one of 6
 * numbers did. Points that are left out have radius 0, and take no part in any product. */
#ifndef SD_MULTIBLOB_POINTS_H
#define SD_MULTIBLOB_POINTS_H

#include <stdint.h>

#include "sd_multiblob.h"
#include "sd_shape.h"

SD_BEGIN_C

/* What there is of a sphere's shell: bit 1 + k is set if point k is there, and bit 0 if the sphere has
 * the one-body addition. Those of shells of up to 63 points are in the first word. */
enum { SD_MULTIBLOB_WORDS = SD_MULTIBLOB_MOST / 64 + 1 };
typedef struct {
  uint64_t word[SD_MULTIBLOB_WORDS];
} sd_multiblob_mask;

static inline int sd_multiblob_mask_is_whole(const sd_multiblob_mask *mask)
{
  return (int) (mask->word[0] & 1);
}

static inline int sd_multiblob_has_point(const sd_multiblob_mask *mask, int k)
{
  return (int) (mask->word[(k + 1) / 64] >> (k + 1) % 64 & 1);
}

/* Of a sphere that is free, or touches others at most */
sd_multiblob_mask sd_multiblob_whole(const sd_multiblob *m);

/* Of the members of a rigid clump, mask [clump->n], whose shells, of models m[kind[i]] (kind NULL: the
 * first), are turned by turn [9] in its axes: points nearer to the centre of another member than the
 * radius of its shell are left out; the addition is for members that overlap no other, by more than the
 * tolerance of shapes. */
void sd_multiblob_masks(const sd_multiblob *m, const int *kind, const sd_shape *clump,
                        const double turn[9], sd_multiblob_mask *mask);

typedef struct {
  /* [3 n], [n] centres and radii */
  const double *x, *a;
  /* [9 n] rotation of the shells, row-major; NULL: all are free. [n]; NULL: all are whole */
  const double *turn;
  const sd_multiblob_mask *mask;
  int n;
  /* [n] which of the models it has, NULL: all have the first; [n + 1] where its rows begin, NULL: all have
   * as many as that has */
  const int *kind, *first;
} sd_multiblob_spheres;

/* Of models m */
static inline const sd_multiblob *sd_multiblob_of(const sd_multiblob *m,
                                                  const sd_multiblob_spheres *s, long i)
{
  return s->kind ? m + s->kind[i] : m;
}

static inline long sd_multiblob_first(const sd_multiblob *m, const sd_multiblob_spheres *s, long i)
{
  return s->first ? s->first[i] : m->n * i;
}

/* Has sphere i the one-body addition? */
static inline int sd_multiblob_is_whole(const sd_multiblob_spheres *s, long i)
{
  return s->a[i] > 0.0 && (!s->mask || sd_multiblob_mask_is_whole(s->mask + i));
}

/* Points of all of them: r [3 rows] from the centre of their sphere, x where they are (r, x NULL: not
 * wanted), b [rows] radii */
void sd_multiblob_expand(const sd_multiblob *m, const sd_multiblob_spheres *s, double *r, double *x,
                         double *b);

/* The one-body additions of spheres of models; all that it points to outlives it */
typedef struct {
  const sd_multiblob *model;
  sd_multiblob_spheres spheres;
  /* [spheres.n] 1/sqrt(eta); [3 rows] from the centres */
  const double *w, *r;
} sd_multiblob_additions;

/* u [3 rows] += that of each of the spheres begin ... end - 1 that has it. ctx is an sd_multiblob_additions:
 * for sd_bodies.add. */
void sd_multiblob_add(const void *ctx, int begin, int end, const double *f, double *u);

/* D [3 rows]: 6 pi eta b for each component of each point, of radius b [rows]; 1 of those left out */
void sd_multiblob_drags(const sd_multiblob_additions *points, const double *b, double *D);

/* First moments of the forces f of the points of a sphere about its centre, symmetric and traceless, xx
 * yy zz xy xz yz: S [6] += dev sym sum r_k f_k. f acts on the fluid; the stress of the suspension is
 * 2 eta E - (sum of S)/V. */
void sd_multiblob_moment(long points, const double *r, const double *f, double S[6]);
/* Of so many spheres, whose rows begin at first [spheres + 1]: S [6 spheres]; and what the points of each
 * exert together, F [3 spheres] += sum f_k */
void sd_multiblob_moments(int spheres, const int *first, const double *r, const double *f, double *S);
void sd_multiblob_forces(int spheres, const int *first, const double *f, double *F);
/* And those of these, F [3], each at its arm [3] from the centre of a body: S [6 spheres] += that. All that
 * the spheres of a body have so is the first moment of its points about its own centre. */
void sd_multiblob_moments_at(int spheres, const double *arm, const double *F, double *S);

SD_END_C
#endif
