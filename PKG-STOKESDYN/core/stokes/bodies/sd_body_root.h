/* Roots of a body's own matrix, by which Lanczos's process for random velocities goes (sd_bodies_noise.h):
 * every body for itself, so that what is stiff within bodies is no part of the process.
 *
 *   M_b' = C C,   C symmetric        P = C^-1 and its inverse C, in the frame of the shape
 *
 * Where the sum over images is split, M_b' is that of the near part: less the waves of its points in open
 * space (sd_radial.h). Any C gives the same noise, in more or fewer products. Torques count over a length
 * that makes them comparable to forces, and lengths and viscosity are as in sd_body_shape.h. */
#ifndef SD_BODY_ROOT_H
#define SD_BODY_ROOT_H

#include "sd_body_shape.h"
#include "sd_ewald.h"

SD_BEGIN_C

typedef struct {
  /* width m numbers; 0: there is no root */
  int n;
  /* torques are over it */
  double length;
  /* [n n] symmetric: C^-1, C */
  double *inverse, *root;
} sd_body_root;

/* A body of more numbers, or whose inverse is in blocks, does without, since the roots would take longer
 * than what they save. */
enum { SD_BODY_ROOT_MOST = 600 };

/* Of bodies whose lengths are those of the shape times a. split NULL: of the whole matrix. No root, n = 0,
 * also where what is left of M_b' is not positive. The owner frees. SD_OK; SD_ENOMEMORY; SD_ENOTFINITE. */
sd_status sd_body_root_create(const sd_body_shape *shape, double a, const sd_ewald *split,
                              sd_body_root *out);
void sd_body_root_free(sd_body_root *r);

/* One root serves splittings that are about the same, for bodies of all sizes: in steps of 3 % of
 *   log(xi a L)/0.03,   log(a_ref/(a L))/0.03,   log(xi range)/0.03,   to the nearest whole number
 * L: radius of the largest point in the unit of the shape, a: as above. */
typedef struct {
  int xi, a_ref, range;
} sd_body_root_steps;
sd_body_root_steps sd_body_root_steps_of(const sd_body_shape *shape, double a, const sd_ewald *split);
/* The splitting of these steps for a = 1, whichever of those that have these steps split is:
 * band/(xi^2 range) and all that a root does not ask for are those of split. */
sd_ewald sd_body_root_split(const sd_body_shape *shape, const sd_body_root_steps *steps,
                            const sd_ewald *split);

SD_END_C
#endif
