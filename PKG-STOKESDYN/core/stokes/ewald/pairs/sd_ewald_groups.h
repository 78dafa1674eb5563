/* The near part of an Ewald sum where points stand in groups, as those of a shell do: who is near whom is
 * found among the middles of groups, and then point by point among the groups that are near. Groups of one
 * form have one block of what their own points do to each other, the near part of these and the sphere's
 * own D(0) not among it, instead of pairs that are made anew in every product. */
#ifndef SD_EWALD_GROUPS_H
#define SD_EWALD_GROUPS_H

#include "sd_ewald_cells.h"
#include "sd_product.h"

SD_BEGIN_C

/* Zero-initialise; sd_ewald_groups_free in the end. */
typedef struct {
  /* of the groups: those that take part, in order of cells */
  sd_ewald_cells cells;
  /* [7 groups + SD_FULL] middles, how many points each has, and what the cells need */
  double *middle;
  /* [rows of cells + 1] first row of each; [..] groups near one; [2 ..] their rows */
  int *first, *near, *range;
  size_t middle_room, first_room, near_room, range_room;
  /* groups of ours that have a form: [own] first sphere, and which; [forms][3 SD_GROUP_POINTS]
   * [SD_GROUP_ROW] the blocks, for w = 1 */
  int own, *sphere, *form;
  double *block;
  size_t sphere_room, form_room, block_room;
} sd_ewald_groups;

struct sd_ewald_pairs;

/* May these be taken by groups? */
int sd_ewald_groups_serve(const struct sd_ewald_pairs *p, const sd_groups *groups);

/* Rows of points by groups in order of cells, to p->sphere. SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_groups_sort(struct sd_ewald_pairs *p, const sd_groups *groups, int n);

/* The rows stand: neighbours of each, and the blocks. SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_groups_find(struct sd_ewald_pairs *p, const sd_groups *groups, int n);

/* u [3 n] += the blocks of F [3 n] */
void sd_ewald_groups_apply(const struct sd_ewald_pairs *p, const double *F, double *u);

void sd_ewald_groups_free(sd_ewald_groups *g);

SD_END_C
#endif
