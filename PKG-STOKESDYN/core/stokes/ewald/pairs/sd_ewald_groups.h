/* The near part of an Ewald sum where points stand in groups, as those of a shell do: who is near whom is
 * found among the middles of groups. Of two groups that are near each other the kernel takes all points at
 * once where its vectors hold a group; else their neighbours are found point by point. Groups of one form
 * have one block of what their own points do to each other, the near part of these and the sphere's own D(0)
 * not among it, instead of pairs that are made anew in every product. */
#ifndef SD_EWALD_GROUPS_H
#define SD_EWALD_GROUPS_H

#include "sd_ewald_near.h"

SD_BEGIN_C

/* Within which middles of groups are near each other: a hair more, so that rounding of these loses no pair */
static inline double sd_ewald_groups_reach(const sd_ewald_pairs *p)
{
  return (p->ewald.range + 2.0 * p->groups.farthest) * (1.0 + 1e-9);
}

/* sd_group_places, while kernels that look at whole groups find who is near whom and nobody needs centres */
static inline float *sd_ewald_groups_arms(const sd_ewald_pairs *p)
{
  return p->u;
}

static inline int sd_ewald_groups_is_ghost(const sd_ewald_pairs *p, const sd_groups *all, int n, int group)
{
  return all->first[p->groups.cells.place[group]] >= n;
}

/* Its form; -1: it has none, or is a ghost */
static inline int sd_ewald_groups_form(const sd_ewald_pairs *p, const sd_groups *all, int n, int group)
{
  const int mine = all->form && !sd_ewald_groups_is_ghost(p, all, n, group);
  return mine ? all->form[p->groups.cells.place[group]] : -1;
}

/* May these be taken by groups? */
int sd_ewald_groups_serve(const sd_ewald_pairs *p, const sd_groups *groups);

/* Rows of points by groups in order of cells, and where they stand; in cells of before where the lists of
 * then hold. SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_groups_sort(sd_ewald_pairs *p, const sd_groups *groups, int n);

/* Who is near whom. SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_groups_find(sd_ewald_pairs *p, const sd_groups *groups, int n);

/* The blocks. SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_groups_make_blocks(sd_ewald_pairs *p, const sd_groups *groups, int n);

/* Those near each other, for the kernel that takes them whole */
sd_near_groups sd_ewald_groups_near(const sd_ewald_pairs *p);

/* u [3 n] += the blocks of F [3 n], of groups begin ... end - 1 of those that have one */
void sd_ewald_groups_apply(const sd_ewald_pairs *p, int begin, int end, const double *F, double *u);

void sd_ewald_groups_free(sd_ewald_groups *g);

SD_END_C
#endif
