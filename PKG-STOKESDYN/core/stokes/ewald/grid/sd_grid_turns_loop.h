/* The two turns of the numbers between ranks, in a row of ranks from z to y and in a column from y to x:
 * whose numbers are where in messages. Included by sd_grid_fields.c, once for each precision. */

static waves *slab_row(const sd_grid *g, int c, int x, int y)
{
  const long depth = sd_grid_own(g, SD_SHARED_Z);
  waves *plane = g->slab[x - g->own[SD_SHARED_X][0]];
  return plane + c * sd_grid_slab_field(g) + y * depth;
}

static void copy(real *plane, real *box, long numbers, int to_plane)
{
  memcpy(to_plane ? plane : box, to_plane ? box : plane, sizeof(real) * (size_t) numbers);
}

/* The turn in a row, of pencils from z to y: from each of its ranks to each a box of wave numbers
 * [3][x][its lines][z of the other], which goes forth and comes back; what stays here waits where the
 * slab will be. Our lines, all z of them, between boxes and their plane */
static void copy_lines(const sd_grid *g, int c, int x, real *message, int to_plane)
{
  const long planes = sd_grid_own(g, SD_SHARED_X), lines = sd_grid_own(g, SD_SHARED_LINES);
  const int first = g->me - g->me % g->columns;
  for (int r = first; r < first + g->columns; r++) {
    int z[2];
    sd_grid_range_of(g, SD_SHARED_Z, r, z);
    const long row = 2L * (z[1] - z[0]);
    real *box = message + (c * planes + x - g->own[SD_SHARED_X][0]) * lines * row;
    if (r == g->me) box = (real *) slab_row(g, c, x, 0);
    for (long l = 0; l < lines; l++, box += row)
      copy((real *) g->plane[c] + 2 * (l * g->waves + z[0]), box, row, to_plane);
    if (r != g->me) message += 3 * planes * lines * row;
  }
}

/* All lines at our z, between boxes and their plane */
static void copy_depths(const sd_grid *g, int c, int x, real *message, int to_plane)
{
  const long planes = sd_grid_own(g, SD_SHARED_X), row = 2L * sd_grid_own(g, SD_SHARED_Z);
  const int first = g->me - g->me % g->columns;
  real *plane = (real *) g->plane[c];
  for (int r = first; r < first + g->columns; r++) {
    const long numbers = sd_grid_length(g, SD_SHARED_LINES, r) * row;
    real *box = message + (c * planes + x - g->own[SD_SHARED_X][0]) * numbers;
    copy(plane, r == g->me ? (real *) slab_row(g, c, x, 0) : box, numbers, to_plane);
    plane += numbers;
    if (r != g->me) message += 3 * planes * numbers;
  }
}

/* The turn in a column, from x to y planes: from each rank to each a box of wave numbers [3][its x][its y][z
 * that are left]. Rows y of our plane x: those of other ranks from the slab to the message; or all of them
 * to `beside`, from the slab or from the message, with zeros for what is not left. What is transformed next
 * is in the cache then, and rows that have come in are written once. */
static void copy_rows(const sd_grid *g, int c, int x, real *message, int to_beside)
{
  const long planes = sd_grid_own(g, SD_SHARED_X), depth = 2L * sd_grid_own(g, SD_SHARED_Z);
  for (int r = g->me % g->columns; r < g->rows * g->columns; r += g->columns) {
    const int ours = r == g->me;
    int range[2];
    if (ours && !to_beside) continue;
    sd_grid_range_of(g, SD_SHARED_Y, r, range);
    const long numbers = 2 * sd_grid_waves_of(g, r);
    real *box = message + (c * planes + x - g->own[SD_SHARED_X][0]) * numbers;
    for (int y = range[0]; y < range[1]; y++) {
      const long row = 2L * sd_grid_depth(g, y);
      real *slab = (real *) slab_row(g, c, x, y), *beside = (real *) g->beside + y * depth;
      copy(to_beside ? beside : slab, ours ? slab : box, row, to_beside);
      if (to_beside) memset(beside + row, 0, sizeof(real) * (size_t) (depth - row));
      box += row;
    }
    if (!ours) message += 3 * planes * numbers;
  }
}

/* Rows of our plane y, one for each x: in the slab, or where other ranks' have come in; to `beside`
 * or from it */
static void copy_plane(const sd_grid *g, int c, int y, real *message, int to_beside)
{
  const long row = 2L * sd_grid_depth(g, y), numbers = 2 * sd_grid_waves_of(g, g->me);
  const long at = 2 * (g->before[y] - g->before[g->own[SD_SHARED_Y][0]]);
  real *beside = (real *) g->beside;
  for (int r = g->me % g->columns; r < g->rows * g->columns; r += g->columns) {
    int x[2];
    sd_grid_range_of(g, SD_SHARED_X, r, x);
    const long rows = x[1] - x[0];
    for (long k = 0; k < rows; k++, beside += row)
      copy(beside,
           r == g->me ? (real *) slab_row(g, c, x[0] + (int) k, y)
                      : message + (c * rows + k) * numbers + at,
           row, to_beside);
    if (r != g->me) message += 3 * rows * numbers;
  }
}
