/* What the points of a group (sd_ewald_groups.h) do to each other: one block for all groups of a form. */
#include "sd_ewald_groups.h"

#include <string.h>

#include "sd_constants.h"
#include "sd_ewald_rows.h"
#include "sd_isa.h"
#include "sd_room.h"

enum { COLUMNS = 3 * SD_GROUP_POINTS };

/* Column by column what the kernel of pairs makes of the rows of a group for unit forces, in doubles. */
static void make_block(const sd_ewald_pairs *p, int first, int points, double *block)
{
  sd_near_part part = sd_ewald_pairs_part(p);
  double row[8 * (SD_GROUP_POINTS + 1)], u[4 * (SD_GROUP_POINTS + 1)];
  int begin[SD_GROUP_POINTS + 1] = {0};
  long start[SD_GROUP_POINTS + 1] = {0};
  int neighbor[2 * SD_FULL * SD_GROUP_POINTS];
  for (int k = 0; k < points; k++) {
    begin[k + 1] = k + 1;
    start[k + 1] = start[k];
    for (int j = k + 1; j < points; j++) neighbor[start[k + 1]++] = j;
    while (start[k + 1] % SD_FULL) neighbor[start[k + 1]++] = points;
  }
  memset(row, 0, sizeof(row));
  for (int k = 0; k <= points; k++) {
    const long i = k < points ? p->sphere[first + k] : -1;
    for (int d = 0; d < 3; d++) row[8 * k + d] = i < 0 ? SD_NOWHERE : p->scale * p->spheres.x[3 * i + d];
    row[8 * k + 3] = i < 0 ? 0.0 : p->scale * p->spheres.a[i];
  }
  part.bunches = points;
  part.begin = begin;
  part.first = start;
  part.neighbor = neighbor;
  part.row = row;
  part.u = u;
  memset(block, 0, sizeof(double) * COLUMNS * SD_GROUP_ROW);
  for (int j = 0; j < 3 * points; j++) {
    for (int k = 0; k < points; k++)
      for (int d = 0; d < 3; d++) row[8 * k + 4 + d] = 3 * k + d == j;
    memset(u, 0, sizeof(u));
    p->doubles->near_part(&part);
    for (int k = 0; k < points; k++)
      for (int d = 0; d < 3; d++)
        block[SD_GROUP_ROW * j + 3 * k + d] = p->scale / (8.0 * SD_PI) * u[4 * k + d];
  }
}

/* Of the first group of each form; a form of which there is no group of ours has none. */
sd_status sd_ewald_groups_make_blocks(sd_ewald_pairs *p, const sd_groups *groups, int n)
{
  sd_ewald_groups *g = &p->groups;
  int forms = 0;
  g->own = 0;
  for (int k = 0; k < g->cells.rows; k++) {
    const int form = sd_ewald_groups_form(p, groups, n, k);
    forms = form < forms ? forms : form + 1;
  }
  if (forms == 0) return SD_OK;
  const size_t most = (size_t) g->cells.rows;
  if (!sd_reserve(&g->sphere, sizeof(int), most, &g->sphere_room) ||
      !sd_reserve(&g->form, sizeof(int), most, &g->form_room) ||
      !sd_reserve(&g->end, sizeof(int), most, &g->end_room) ||
      !sd_reserve(&g->block, sizeof(double) * COLUMNS * SD_GROUP_ROW, (size_t) forms, &g->block_room))
    return SD_ENOMEMORY;
  unsigned made = 0;
  int targets = 0;
  for (int k = 0; k < g->cells.rows; k++) {
    const int form = sd_ewald_groups_form(p, groups, n, k), first = g->first[k];
    if (!sd_ewald_groups_is_ghost(p, groups, n, k)) targets += g->first[k + 1] - first;
    if (form < 0) continue;
    if (!(made >> form & 1))
      make_block(p, first, g->first[k + 1] - first, g->block + COLUMNS * SD_GROUP_ROW * (long) form);
    made |= 1u << form;
    g->sphere[g->own] = p->sphere[first];
    g->end[g->own] = targets;
    g->form[g->own++] = form;
  }
  return SD_OK;
}

/* Groups are in order of cells, and their points anywhere in memory. */
static void fetch_forces(const double *F)
{
  enum { LINE = 8 };
  for (int d = 0; d < COLUMNS; d += LINE) sd_fetch(F + d);
}

void sd_ewald_groups_apply(const sd_ewald_pairs *p, int begin, int end, const double *F, double *u)
{
  enum { AHEAD = 3 };
  const sd_ewald_groups *g = &p->groups;
  for (int k = begin; k < end; k++) {
    const long i = g->sphere[k];
    fetch_forces(F + 3 * (long) g->sphere[k + AHEAD < g->own ? k + AHEAD : k]);
    const double w = p->spheres.w[i];
    p->doubles->own_block(g->block + COLUMNS * SD_GROUP_ROW * (long) g->form[k], w * w, F + 3 * i, u + 3 * i);
  }
}
