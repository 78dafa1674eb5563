/* A preconditioner that is kept from solve to solve (sd_precondition.h).
 *
 * It is made at some positions x_0 and stays good for a while as spheres move on. The caller keeps
 * x_0, says by sd_moved_too_far when to take new ones, and asks for the P of x_0 in every solve: it is made
 * where it is not there yet, so that what is kept is a matter of time, never of the answer.
 * Viscosities may change in between: M = W M_1 W with W = diag(1/sqrt(eta)), so P = W^-1 P_1 W^-1
 * with the W of now and the P_1 of viscosity 1.
 * Zero-initialise; sd_preconditioner_free in the end. */
#ifndef SD_PRECONDITIONER_H
#define SD_PRECONDITIONER_H

#include <stdint.h>

#include "sd_precondition.h"

SD_BEGIN_C

typedef struct {
  /* what was asked for, and what there is */
  const sd_precondition_kind *wanted, *kind;
  void *state;
  /* a hash of all that it is made of */
  uint64_t made_of;
  int n, width;
  /* [width n] */
  double *scratch;
} sd_preconditioner;

void sd_preconditioner_free(sd_preconditioner *p);

/* P of this kind at c->spheres.x, made unless it is there already; c->spheres.w is not read. On all
 * ranks together, and the same on all. Where it is not to be had, as the sparse factor with a hard
 * cut-off, it is D. SD_OK; SD_ENOMEMORY; that of the sum. */
sd_status sd_preconditioner_make(sd_preconditioner *p, const sd_precondition_kind *kind,
                                 const sd_precondition_case *c);

/* z = P r (this part's share); w [n] 1/sqrt(eta), 0: takes no part */
sd_status sd_preconditioner_apply(sd_preconditioner *p, const double *w, const double *r,
                                  double *z);

/* How far spheres have moved since x_0, beside their common motion: sums over all spheres of all
 * ranks, of the vectors d from x_0 to x: their number, d, d.d and a^2. Zeros in the beginning. */
enum { SD_MOVED = 6 };
void sd_moved_add(double sums[SD_MOVED], const double d[3], double a);

/* That, root of the mean square, over the radius, likewise. Is it more than half? At that distance a
 * factor needs 21 iterations to 1e-6 instead of 17. */
double sd_moved_far(const double sums[SD_MOVED]);
int sd_moved_too_far(const double sums[SD_MOVED]);

SD_END_C
#endif
