#include <limits.h>

#include "sd_grid_internal.h"

/* --- who has what --- */

static int share(int all, int part, int parts)
{
  return (int) ((long) all * part / parts);
}

static double most_of(int all, int parts)
{
  return (all + parts - 1) / parts;
}

/* Wave numbers along a direction, if it were the last */
static int waves_along(const sd_grid *g, int d)
{
  return d == 2 ? g->waves : g->size[d] / 2 + 1;
}

/* Of ranks in so many columns, the most numbers that one of them transforms along z, y and x, if the
 * first direction is d */
static double gs_load(const sd_grid *g, int d, int columns)
{
  const int e = (d + 1) % 3, waves = waves_along(g, (d + 2) % 3), rows = g->ranks / columns;
  const double planes = most_of(g->occupied[d], rows), depth = most_of(waves, columns);
  return planes * most_of(g->occupied[e], columns) * waves + planes * g->size[e] * depth +
      g->size[d] * most_of(g->size[e], rows) * depth;
}

/* As many columns as make the load least; the turn that more than one need is a quarter of it. */
int sd_grid_columns(const sd_grid *g, int d)
{
  const int most = g->occupied[(d + 1) % 3], waves = waves_along(g, (d + 2) % 3);
  int best = 1;
  double least = gs_load(g, d, 1);
  for (int c = 2; c <= g->ranks && c <= most && c <= waves; c++)
    if (1.25 * gs_load(g, d, c) < least) {
      least = 1.25 * gs_load(g, d, c);
      best = c;
    }
  return best;
}

/* What a rank has of `all` planes: first and end. Rows share those of X, columns the others. */
void sd_grid_range(int all, sd_grid_part what, int rank, int rows, int columns, int *range)
{
  const int by_row = what == SD_SHARED_X;
  const int part = by_row ? rank / columns : rank % columns, parts = by_row ? rows : columns;
  range[0] = range[1] = 0;
  if (rank >= rows * columns) return;
  range[0] = share(all, part, parts);
  range[1] = share(all, part + 1, parts);
}

void sd_grid_range_of(const sd_grid *g, sd_grid_part what, int rank, int *range)
{
  const int row = rank / g->columns, all[] = {g->occupied[0], g->occupied[1], g->size[1], g->waves};
  sd_grid_range(all[what], what, rank, g->rows, g->columns, range);
  if (what != SD_SHARED_Y || row >= g->rows) return;
  range[0] = g->first_y[row];
  range[1] = g->first_y[row + 1];
}

void sd_grid_share_waves(sd_grid *g, const int *waves)
{
  long all = 0, before = 0;
  for (int y = 0; y < g->size[1]; y++) all += waves[y];
  for (int row = 0, y = 0; row <= g->rows; row++) {
    while (y < g->size[1] && (before + waves[y]) * g->rows <= all * row) before += waves[y++];
    g->first_y[row] = row < g->rows ? y : g->size[1];
  }
}

int sd_grid_length(const sd_grid *g, sd_grid_part what, int rank)
{
  int range[2];
  sd_grid_range_of(g, what, rank, range);
  return range[1] - range[0];
}

int sd_grid_own(const sd_grid *g, sd_grid_part what)
{
  return g->own[what][1] - g->own[what][0];
}

long sd_grid_waves_of(const sd_grid *g, int rank)
{
  int y[2];
  sd_grid_range_of(g, SD_SHARED_Y, rank, y);
  return g->before[y[1]] - g->before[y[0]];
}

/* --- messages --- */

int sd_grid_count(const sd_grid *g, int which, int rank, long numbers, long *all)
{
  const long in_double = (long) (sizeof(double) / g->bytes);
  const long doubles = (numbers + in_double - 1) / in_double;
  *all += doubles * in_double;
  if (*all > INT_MAX) return 0;
  g->counts[which * g->ranks + rank] += (int) doubles;
  return 1;
}

/* Of both turns, each of which goes to those of our row or column */
int sd_grid_count_turns(const sd_grid *g)
{
  const long planes = sd_grid_own(g, SD_SHARED_X), lines = sd_grid_own(g, SD_SHARED_LINES);
  const long waves = sd_grid_waves_of(g, g->me), depth = sd_grid_own(g, SD_SHARED_Z);
  long all[4] = {0};
  int ok = 1;
  for (int r = 0; r < g->rows * g->columns && ok; r++) {
    if (r == g->me || g->me >= g->rows * g->columns) continue;
    if (r / g->columns == g->me / g->columns)
      ok = sd_grid_count(g, ROW_TO, r, 6 * planes * lines * sd_grid_length(g, SD_SHARED_Z, r), all) &&
          sd_grid_count(g, ROW_FROM, r, 6 * planes * sd_grid_length(g, SD_SHARED_LINES, r) * depth, all + 1);
    if (r % g->columns == g->me % g->columns)
      ok = ok && sd_grid_count(g, COLUMN_TO, r, 6 * planes * sd_grid_waves_of(g, r), all + 2) &&
          sd_grid_count(g, COLUMN_FROM, r, 6 * sd_grid_length(g, SD_SHARED_X, r) * waves, all + 3);
  }
  return ok;
}

/* Of the longest of all messages */
size_t sd_grid_largest_message(const sd_grid *g)
{
  size_t most = 0;
  for (int which = PIECES_TO; which <= COLUMN_FROM; which++) {
    size_t all = 0;
    for (int r = 0; r < g->ranks; r++) all += (size_t) g->counts[which * g->ranks + r];
    if (all > most) most = all;
  }
  return most;
}
