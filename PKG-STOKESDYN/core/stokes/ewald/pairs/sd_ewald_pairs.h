/* The near part of an Ewald sum: pairs up to the range, the tensor of a pair less its wave part in
 * open space (sd_radial.h), and what that wave part is at no distance, for the sphere itself.
 *
 *   u_i = sum_j [ RPY_ij(r) - D_ij(r) ] F_j - D_ii(0) F_i         all spheres j within range of i,
 *                                                                images among them */
#ifndef SD_EWALD_PAIRS_H
#define SD_EWALD_PAIRS_H

#include "sd_ewald_near.h"

SD_BEGIN_C

/* Polynomials for a splitting. */
void sd_ewald_pairs_create(sd_ewald_pairs *p, const sd_ewald *e,
                           const struct sd_ewald_kernels *kernels, int width);

/* n spheres of ours and the ghosts after them, n_all together, in groups or not; targets in the order of a
 * frame with this turn (sd_ewald_cells.h). SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_pairs_place(sd_ewald_pairs *p, const sd_spheres *s, const sd_groups *groups, int n,
                               int n_all, int turn);

/* A product, in four steps. The first takes F [width n] of ours and ghosts [width (n_all - n)], on all
 * ranks together; sums [SD_EWALD_SUMS], out, of all ranks; NULL, of doubles alone: not wanted. SD_OK or
 * what the sum over ranks said. */
sd_status sd_ewald_pairs_load(sd_ewald_pairs *p, int n, const double *F, const double *ghosts,
                              const sd_world *world, double *sums);

/* What is near */
void sd_ewald_pairs_apply(sd_ewald_pairs *p);

/* Rows [width] for each target, unit w F, which may become what waves do to it: in memory that lasts
 * until the next product */
void *sd_ewald_pairs_rows(sd_ewald_pairs *p);

/* u [width n] = w (what is near; rows of velocities, NULL: none; and what is beyond the range of a periodic
 * box, as a mean: the tail of sd_radial.h, and the sums of all ranks, NULL: none); 0 for spheres without
 * radius. */
void sd_ewald_pairs_take(const sd_ewald_pairs *p, int n, const double *F, const void *rows,
                         const double *tail, const double *sums, double *u);

/* u [width (n_all - n)] = what is near of the ghosts: of ours alone, since no pair of ghosts counts */
void sd_ewald_pairs_of_ghosts(const sd_ewald_pairs *p, int n, int n_all, double *u);

void sd_ewald_pairs_free(sd_ewald_pairs *p);

SD_END_C
#endif
