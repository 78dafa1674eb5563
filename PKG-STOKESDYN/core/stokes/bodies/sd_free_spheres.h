/* The case of sd_bodies.h that needs no loop: free spheres of one point each, with nothing that ties them.
 * K = 1, and V = u + M' F is the answer. */
#ifndef SD_FREE_SPHERES_H
#define SD_FREE_SPHERES_H

#include "sd_bodies.h"

SD_BEGIN_C

/* Is it that case on all ranks? Called by all of them together, who ask each other where A does not say.
 * SD_OK or that of the sum. */
sd_status sd_free_spheres_only(const sd_bodies *A, int *only);

/* As sd_bodies_solve, with one product; no guess is read. */
sd_status sd_free_spheres_solve(const sd_bodies *A, const sd_bodies_problem *problem,
                                const sd_bodies_answer *answer, sd_bodies_report *report);

SD_END_C
#endif
