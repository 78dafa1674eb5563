/* Mobility times vector, the pair part only: u_i = sum_{j != i} Omega_ij F_j. The diagonal 1/(6 pi eta_i a_i) is the solver's.
 *
 * Local viscosity: Omega_ij is taken with sqrt(eta_i eta_j). Then the matrix is E^-1/2 M_1 E^-1/2 with M_1 the matrix of unit
 * viscosity and E = diag(eta): symmetric and positive definite whenever M_1 is.
 * Blocks are computed afresh in every product; they are never stored (72 bytes a pair would be slower to read). */
#ifndef SD_PRODUCT_H
#define SD_PRODUCT_H

#include "sd_tensor.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Spheres that a product reads.
 *   x [3n]  centres        length
 *   a [n]   radii; 0: the sphere takes no part, neither as target nor as source
 *   w [n]   1/sqrt(eta)  */
typedef struct {
  const double *x, *a, *w;
} sd_spheres;

/* Pairs as rows: targets 0 ... n-1 are the first n spheres; their sources are neighbor[first[i]] ... neighbor[first[i+1]-1].
 * Every directed pair once. A source may be a ghost (index >= n) and may be the image of any sphere, also of i itself. */
typedef struct {
  int n;
  const long *first;
  const int *neighbor;
} sd_pairs;

/* F [3 * all spheres], ghosts included -> u [3n] */
void sd_product_list(sd_tensor kind, const sd_spheres *s, const sd_pairs *pairs, const double *F,
                     double *u);

/* All pairs: targets begin ... begin + n - 1 of n_all spheres, sources all of them. F [3 n_all] -> u [3n]. */
void sd_product_all(sd_tensor kind, const sd_spheres *s, int n_all, int begin, int n,
                    const double *F, double *u);

/* Keep the pairs that interact now: centre distance up to cutoff (INFINITY: all), both radii > 0.
 *   candidates, s    in
 *   first [n+1], neighbor [candidates->first[n]]   out, caller's */
void sd_pairs_within(const sd_pairs *candidates, const sd_spheres *s, double cutoff, long *first,
                     int *neighbor);

#ifdef __cplusplus
}
#endif
#endif
