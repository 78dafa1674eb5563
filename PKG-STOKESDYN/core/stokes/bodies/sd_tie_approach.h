/* What the mobility itself resists of the approach of close spheres, for the preconditioner of
 * sd_tie.h.
 *
 * The blocks M_b know a sphere alone. Close spheres that are pressed together drive each other's
 * fluid away: by the model of one point, a pair of equal ones that touch resists its approach 2.7
 * times as much as their drags do, by that of shells five times, many that touch each other nine
 * times. Lubrication makes such forces large, so M_b is wrong where it matters, and the number of
 * products grows with the density. So
 *
 *   M_b^-1 + X,   X = sum over pairs  c s s^T          s: how fast two spheres face each other
 *
 * stands for M^-1. c is what the pair resists beyond its drags if it is alone (sd_rpy_approach,
 * sd_film.h), fading from contact to the range of lubrication. X is as sparse as L and positive
 * semidefinite; it leaves the common motion of a pair, where M is large, to M_b.
 *
 *   rows are spheres    s.v = d.(U_i - U_j), d from i to j. It takes a quarter to a third off the
 *                       products, and what is left depends little on c.
 *   rows are points     s.v = d.(v_i - v_j) + b (d.e_i d + d.e_j d), (v, e) of sd_faces.h: what two
 *                       shells resist is, to 2 % of itself, this one motion, with b = 0.77 for
 *                       equal spheres that touch, 0.6 a radius apart. It takes a third off the
 *                       products at a volume fraction of 0.45 (18 to 12, to 1e-3), a quarter at
 *                       0.3; with b = 0 a tenth (found with dense matrices of 32 spheres).
 *
 * Rigid motions have no e, so that in both K^T X K is c (d, -d) (d, -d)^T on the velocities of the
 * centres. Pairs of spheres that have no faces are left out. */
#ifndef SD_TIE_APPROACH_H
#define SD_TIE_APPROACH_H

#include "sd_tied.h"

/* Room for where A->tie->L stands now; 0: there is none */
int sd_tie_approach_reserve(const sd_bodies *A);
/* In that room; mine [spheres]: scratch. On all ranks together. SD_OK; that of refresh. */
sd_status sd_tie_approach_make(const sd_bodies *A, double *mine);
/* X (r + K V) by way of spheres, in three steps. The first takes r (rows; NULL: 0), the second V [6 bodies]
 * (NULL: 0), which adds to what was seen before: f [6 bodies] (NULL: not wanted) = K^T of X of that. The
 * third adds X of that to l (rows). on_spheres [6 spheres]: scratch. SD_OK or that of refresh. */
void sd_tie_approach_see(const sd_bodies *A, const double *r);
sd_status sd_tie_approach_push(const sd_bodies *A, const double *V, double *on_spheres, double *f);
void sd_tie_approach_add(const sd_bodies *A, double *l);

#endif
