#include <string.h>

#include "sd_grid_internal.h"

/* Part k of the points lo ... lo + n - 1 that lies within one period and within a range of it: its offset in the
 * brick, its place, its points; -1: there is no part k. */
static int gp_part_of(int lo, int n, int period, const int range[2], int k, int *at, int *to)
{
  const int first = lo >= 0 ? lo / period : -((period - 1 - lo) / period);
  const int origin = (first + k) * period;
  if (origin >= lo + n) return -1;
  const int from = lo > origin + range[0] ? lo : origin + range[0];
  const int till = lo + n < origin + range[1] ? lo + n : origin + range[1];
  *at = from - lo;
  *to = from - origin;
  return till > from ? till - from : 0;
}

/* The pieces of a brick [6] in some rank's pencils, after those in list; NULL: only counted. rank: at
 * the other end of the message that they go by */
static int pieces_of(const sd_grid *g, const int *brick, int pencils, int rank, sd_piece *list)
{
  const int *lo = brick, *n = brick + 3, *size = g->size, whole[2] = {0, size[2]};
  int x[2], y[2];
  sd_grid_range_of(g, SD_SHARED_X, pencils, x);
  sd_grid_range_of(g, SD_SHARED_LINES, pencils, y);
  int count = 0;
  sd_piece p = {.rank = rank};
  if (n[0] == 0 || n[1] == 0 || n[2] == 0) return 0;
  for (int i = 0; (p.n[0] = gp_part_of(lo[0], n[0], size[0], x, i, p.at, p.to)) >= 0; i++)
    for (int j = 0; (p.n[1] = gp_part_of(lo[1], n[1], size[1], y, j, p.at + 1, p.to + 1)) >= 0; j++)
      for (int k = 0; (p.n[2] = gp_part_of(lo[2], n[2], size[2], whole, k, p.at + 2, p.to + 2)) >= 0; k++) {
        if (p.n[0] == 0 || p.n[1] == 0 || p.n[2] == 0) continue;
        if (list) list[count] = p;
        count++;
      }
  return count;
}

/* How many of the points lo ... lo + n - 1 are within a range of the period */
static int points_within(int lo, int n, int period, const int *range)
{
  int at, to, part, points = 0;
  for (int k = 0; n > 0 && (part = gp_part_of(lo, n, period, range, k, &at, &to)) >= 0; k++)
    points += part;
  return points;
}

double sd_grid_at_home(const sd_grid *g, const int *bricks, int d)
{
  const int e = (d + 1) % 3, columns = sd_grid_columns(g, d), rows = g->ranks / columns;
  double points = 0.0;
  for (int r = 0; r < g->ranks; r++) {
    const int *lo = bricks + 6 * r, *n = lo + 3;
    int x[2], y[2];
    sd_grid_range(g->occupied[d], SD_SHARED_X, r, rows, columns, x);
    sd_grid_range(g->occupied[e], SD_SHARED_LINES, r, rows, columns, y);
    points += (double) points_within(lo[d], n[d], g->size[d], x) *
        points_within(lo[e], n[e], g->size[e], y) * n[(d + 2) % 3];
  }
  return points;
}

void sd_grid_list_pieces(const sd_grid *g, const int *bricks, sd_piece *out, sd_piece *in, int *outs,
                        int *ins)
{
  *outs = *ins = 0;
  for (int r = 0; r < g->ranks; r++) {
    *outs += pieces_of(g, bricks + 6 * g->me, r, r, out ? out + *outs : NULL);
    *ins += pieces_of(g, bricks + 6 * r, g->me, r, in ? in + *ins : NULL);
  }
}

/* Numbers of pieces to or from each rank, one rank after the other; our own need no message. 0: more
 * than an int counts */
int sd_grid_count_pieces(const sd_grid *g, sd_piece *list, int pieces, int which)
{
  long all = 0;
  int ok = 1;
  memset(g->counts + which * g->ranks, 0, sizeof(int) * (size_t) g->ranks);
  for (int k = 0; k < pieces && ok; k++) {
    sd_piece *p = list + k;
    p->message = all;
    if (p->rank != g->me) ok = sd_grid_count(g, which, p->rank, 3L * p->n[0] * p->n[1] * p->n[2], &all);
  }
  return ok;
}
