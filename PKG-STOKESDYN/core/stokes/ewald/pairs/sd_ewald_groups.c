#include "sd_ewald_groups.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_ewald_rows.h"
#include "sd_isa.h"
#include "sd_linear.h"
#include "sd_room.h"
#include "sd_skin.h"

void sd_ewald_groups_free(sd_ewald_groups *g)
{
  sd_ewald_cells_free(&g->cells);
  free(g->middle);
  free(g->candidate);
  free(g->from);
  free(g->first);
  free(g->near);
  free(g->range);
  free(g->begin);
  free(g->pair);
  free(g->sphere);
  free(g->form);
  free(g->end);
  free(g->block);
  memset(g, 0, sizeof(*g));
}

int sd_ewald_groups_serve(const sd_ewald_pairs *p, const sd_groups *groups)
{
  if (p->width != 3 || !groups->first) return 0;
  for (int g = 0; g < groups->n; g++)
    if (groups->first[g + 1] - groups->first[g] > SD_GROUP_POINTS) return 0;
  return 1;
}

/* --- rows --- */

/* Middle of the points of a group that there are, and their number; *farthest: of any point from a middle, squared */
static int find_middle(const sd_groups *groups, const sd_spheres *s, int group, double at[3], double *farthest)
{
  int points = 0;
  at[0] = at[1] = at[2] = 0.0;
  for (int i = groups->first[group]; i < groups->first[group + 1]; i++) {
    if (!(s->a[i] > 0.0)) continue;
    points++;
    for (int d = 0; d < 3; d++) at[d] += s->x[3 * (long) i + d];
  }
  for (int d = 0; d < 3 && points > 0; d++) at[d] /= points;
  for (int i = groups->first[group]; i < groups->first[group + 1]; i++) {
    const double far = s->a[i] > 0.0 ? sd_distance_squared(at, s->x + 3 * (long) i) : 0.0;
    *farthest = far > *farthest ? far : *farthest;
  }
  return points;
}

/* Are the rows the points of these groups? Then every group has points, and each row is one that its group had. */
static int same_rows(const sd_ewald_pairs *p, const sd_groups *groups, int n)
{
  const sd_ewald_groups *g = &p->groups;
  const int all = groups->first[groups->n];
  int there = 0;
  if (!(g->reach > 0.0) || g->groups != groups->n || g->points != all || g->ours != n) return 0;
  for (int i = 0; i < all; i++) there += p->spheres.a[i] > 0.0;
  int same = there == p->rows && g->cells.rows == groups->n;
  for (int k = 0; k < g->cells.rows && same; k++) {
    const int *own = groups->first + g->cells.place[k];
    same = p->sphere[g->first[k]] >= own[0] && p->sphere[g->first[k + 1] - 1] < own[1];
  }
  for (int k = 0; k < p->rows && same && there < all; k++) same = p->spheres.a[p->sphere[k]] > 0.0;
  return same;
}

/* Group k where it is now: its middle; its points, from there in floats where kernels look at whole groups, else
 * their centres; *farthest as above */
static void stand_group(sd_ewald_pairs *p, int k, double at[3], double *farthest)
{
  const int begin = p->groups.first[k], points = p->groups.first[k + 1] - begin, *sphere = p->sphere + begin;
  double squares[SD_GROUP_POINTS] = {0.0};
  for (int d = 0; d < 3; d++) {
    const double *from = p->spheres.x + (d + p->turn) % 3;
    double x[SD_GROUP_POINTS];
    at[d] = 0.0;
    for (int i = 0; i < points; i++) at[d] += x[i] = from[3 * (long) sphere[i]];
    at[d] /= points;
    for (int i = 0; i < points; i++) squares[i] += (x[i] - at[d]) * (x[i] - at[d]);
    if (p->by_groups) {
      float *arm = sd_ewald_groups_arms(p) + SD_GROUP_LANES * (3L * k + d);
      for (int i = 0; i < SD_GROUP_LANES; i++) arm[i] = (float) (i < points ? x[i] - at[d] : SD_NOWHERE);
    } else
      memcpy(sd_ewald_centres(p) + (long) d * p->rows + begin, x, sizeof(double) * (size_t) points);
  }
  for (int i = 0; i < points; i++) *farthest = squares[i] > *farthest ? squares[i] : *farthest;
}

/* A group may be anywhere in memory. */
static void fetch_points_of_group(const double *x)
{
  enum { LINE = 8 };
  for (int k = 0; k < 3 * SD_GROUP_POINTS; k += LINE) sd_fetch(x + k);
}

/* All of them, in the order of the lists, and their rows; returns how far a middle is from where these were made at
 * most. */
static double stand_groups(sd_ewald_pairs *p)
{
  enum { AHEAD = 5 };
  sd_ewald_groups *g = &p->groups;
  const long rows = g->cells.rows;
  double moved = 0.0, farthest = 0.0, at[3];
  for (long k = 0; k < rows; k++) {
    double square = 0.0;
    fetch_points_of_group(p->spheres.x + 3L * p->sphere[g->first[k + AHEAD < rows ? k + AHEAD : k]]);
    stand_group(p, (int) k, at, &farthest);
    p->numbers->stand(p, g->first[k], g->first[k + 1]);
    for (long d = 0; d < 3; d++) {
      const double step = at[d] - g->middle[d * rows + k];
      square += step * step;
      g->cells.centre[d * rows + k] = at[d];
    }
    moved = square > moved ? square : moved;
  }
  g->farthest = sqrt(farthest);
  return sqrt(moved);
}

/* The rows and where they are now, in the order of before: do the lists hold? */
static int lists_hold(sd_ewald_pairs *p, const sd_groups *groups, int n)
{
  if (!same_rows(p, groups, n)) return 0;
  const double moved = stand_groups(p);
  return sd_ewald_groups_reach(p) + 2.0 * moved <= p->groups.reach;
}

/* Of groups in order of cells the points */
static void list_rows(sd_ewald_pairs *p, const sd_groups *groups, int n)
{
  sd_ewald_groups *g = &p->groups;
  p->rows = p->n = 0;
  for (int k = 0; k < g->cells.rows; k++) {
    const int group = g->cells.place[k];
    g->first[k] = p->rows;
    for (int i = groups->first[group]; i < groups->first[group + 1]; i++)
      if (p->spheres.a[i] > 0.0) {
        if (i < n) p->target[p->n++] = p->rows;
        p->sphere[p->rows++] = i;
      }
  }
  g->first[g->cells.rows] = p->rows;
}

sd_status sd_ewald_groups_sort(sd_ewald_pairs *p, const sd_groups *groups, int n)
{
  sd_ewald_groups *g = &p->groups;
  const size_t count = (size_t) groups->n;
  if (lists_hold(p, groups, n)) return SD_OK;
  g->reach = 0.0;
  if (!sd_reserve(&g->middle, sizeof(double), 7 * count + SD_FULL, &g->middle_room) ||
      !sd_reserve(&g->first, sizeof(int), count + 1, &g->first_room))
    return SD_ENOMEMORY;
  double *points = g->middle + 3 * count, farthest = 0.0;
  for (int k = 0; k < groups->n; k++)
    points[k] = find_middle(groups, &p->spheres, k, g->middle + 3 * (long) k, &farthest);
  g->farthest = sqrt(farthest);
  const sd_status status = sd_ewald_cells_sort(&g->cells, g->middle, points, groups->n,
                                               sd_with_skin(sd_ewald_groups_reach(p)), p->turn, points + count);
  if (status != SD_OK) return status;
  memcpy(g->middle, g->cells.centre, 3 * sizeof(double) * (size_t) g->cells.rows);
  list_rows(p, groups, n);
  stand_groups(p);
  return SD_OK;
}
