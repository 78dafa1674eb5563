/* The near part of an Ewald sum where points stand in groups, as those of a shell do: who is near whom is
 * found among the middles of groups. Of two groups that are near each other the kernel takes all points at
 * once where its vectors hold a group; else their neighbours are found point by point. Groups of one form
 * have one block of what their own points do to each other, the near part of these and the sphere's own D(0)
 * not among it, instead of pairs that are made anew in every product. */
#ifndef SD_EWALD_GROUPS_H
#define SD_EWALD_GROUPS_H

#include "sd_ewald_near.h"

SD_BEGIN_C

/* May these be taken by groups? */
int sd_ewald_groups_serve(const sd_ewald_pairs *p, const sd_groups *groups);

/* Rows of points by groups in order of cells, to p->sphere; of cells of before where the lists of then hold.
 * SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_groups_sort(sd_ewald_pairs *p, const sd_groups *groups, int n);

/* The rows stand: who is near whom, and the blocks. SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_groups_find(sd_ewald_pairs *p, const sd_groups *groups, int n);

/* Those near each other, for the kernel that takes them whole */
sd_near_groups sd_ewald_groups_near(const sd_ewald_pairs *p);

/* u [3 n] += the blocks of F [3 n], of groups begin ... end - 1 of those that have one */
void sd_ewald_groups_apply(const sd_ewald_pairs *p, int begin, int end, const double *F, double *u);

void sd_ewald_groups_free(sd_ewald_groups *g);

SD_END_C
#endif
