/* The near part of an Ewald sum where points stand in groups, as those of a shell do: who is near whom is
 * found among the middles of groups, and then point by point among the groups that are near. Groups of one
 * form have one block of what their own points do to each other, the near part of these and the sphere's
 * own D(0) not among it, instead of pairs that are made anew in every product. */
#ifndef SD_EWALD_GROUPS_H
#define SD_EWALD_GROUPS_H

#include "sd_ewald_near.h"

SD_BEGIN_C

/* May these be taken by groups? */
int sd_ewald_groups_serve(const sd_ewald_pairs *p, const sd_groups *groups);

/* Rows of points by groups in order of cells, to p->sphere. SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_groups_sort(sd_ewald_pairs *p, const sd_groups *groups, int n);

/* The rows stand: neighbours of each, and the blocks. SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_groups_find(sd_ewald_pairs *p, const sd_groups *groups, int n);

/* u [3 n] += the blocks of F [3 n] */
void sd_ewald_groups_apply(const sd_ewald_pairs *p, const double *F, double *u);

void sd_ewald_groups_free(sd_ewald_groups *g);

SD_END_C
#endif
