/* Spreading and interpolation of points that stand side by side, as those of a shell do: included by
 * sd_ewald_kernels.c. Windows of such points lie on the same rows of the grid, which are read, and written,
 * once for all of them: in one plane after the other all rows stay in registers, while the points whose
 * windows reach the plane add to them. (Point by point each row would be read and written several times, and
 * loads would wait for the stores just before them that they overlap.) For equal radii without torques, and
 * vectors that hold a row in two. */

#if defined(SD_SINGLE) && LANES == LANES_OF(64)
enum { RUN_LANES = 2 * LANES };
_Static_assert(3 * SD_RUN_WIDE <= RUN_LANES && SD_RUN_WIDE <= LANES, "two vectors hold a row, one a window");

/* Along a row each point has three numbers: which is whose */
#define TEN_TIMES(x, y, z)                                                                           \
  {x, y, z, x, y, z, x, y, z, x, y, z, x, y, z, x, y, z, x, y, z, x, y, z, x, y, z, x, y, z, x, y}
static const real whose[3][RUN_LANES] = {TEN_TIMES(1, 0, 0), TEN_TIMES(0, 1, 0), TEN_TIMES(0, 0, 1)};
#undef TEN_TIMES

/* The windows of a run; points in order of their first planes */
typedef struct {
  /* [many] which, and the first plane of each; how many begin before a plane */
  int point[SD_GROUP_POINTS], plane[SD_GROUP_POINTS], below[SD_RUN_WIDE + 2];
  /* along x from the first plane on; along y and, thrice, z from the first row and number of the run on, 0
   * where the window does not reach; windows are stored in whole vectors */
  real x[SD_GROUP_POINTS][LANES], y[SD_GROUP_POINTS][2 * LANES], z[SD_GROUP_POINTS][2 * RUN_LANES];
  /* what each spreads, or has gathered, along z */
  vec v[SD_GROUP_POINTS][2];
} run_windows;

/* Windows of point i, the k-th of the run */
INLINE void windows_of_run(const spreading *s, const sd_spread_run *run, int i, int k, run_windows *w)
{
  const real *v = s->place[i];
  const vec u[3] = {all(v[0]), all(v[1]), all(v[2])};
  vec x = load_any(s->coefficient[s->degree]), y = x, z = load_any(s->thrice[s->degree]);
  vec z1 = load_any(s->thrice[s->degree] + LANES);
  for (int m = s->degree - 1; m >= 0; m--) {
    const vec c = load_any(s->coefficient[m]);
    x = x * u[0] + c;
    y = y * u[1] + c;
    z = z * u[2] + load_any(s->thrice[m]);
    z1 = z1 * u[2] + load_any(s->thrice[m] + LANES);
  }
  real *to_y = w->y[k], *to_z = w->z[k];
  store_any(w->x[k], x);
  store_any(to_y, all(0));
  store_any(to_y + s->corner[i][1] - run->at[1], y);
  for (int l = 0; l < 2; l++) store_any(to_z + l * LANES, all(0));
  to_z += 3 * (s->corner[i][2] - run->at[2]);
  store_any(to_z, z);
  store_any(to_z + LANES, z1);
}

/* All of them, by order of the planes */
INLINE void windows_of_all(const spreading *s, const sd_spread_run *run, run_windows *w)
{
  const int (*corner)[3] = s->corner + run->first;
  int next[SD_RUN_WIDE + 2] = {0};
  for (int i = 0; i < run->many; i++) next[corner[i][0] - run->at[0] + 1]++;
  for (int p = 0; p <= SD_RUN_WIDE; p++) w->below[p + 1] = next[p + 1] += next[p];
  w->below[0] = 0;
  for (int i = 0; i < run->many; i++) {
    const int plane = corner[i][0] - run->at[0], k = next[plane]++;
    w->point[k] = run->first + i;
    w->plane[k] = plane;
    windows_of_run(s, run, run->first + i, k, w);
  }
}

/* The points whose windows reach plane p: from the first of them, and its end */
INLINE int first_of_plane(const spreading *s, const run_windows *w, int p)
{
  return p < s->points ? 0 : w->below[p - s->points + 1];
}

/* Rows of a plane of the grid, which are wanted soon */
INLINE void fetch_plane(int rows, const spreading *s, const real *corner)
{
  for (int q = 0; q < rows; q++) {
    const real *row = corner + q * s->row;
    sd_fetch(row);
    sd_fetch(row + LANES);
    sd_fetch(row + RUN_LANES - 1);
  }
}

/* A force at each point of a row, from lane `skip` on */
INLINE vec force_along(const real *F, int skip)
{
  return all(F[0]) * load_any(whose[0] + skip) + all(F[1]) * load_any(whose[1] + skip) +
      all(F[2]) * load_any(whose[2] + skip);
}

INLINE void spread_run(int rows, const spreading *s, const sd_spread_run *run, const sd_spread_run *next,
                       run_windows *w)
{
  real *corner = corner_at(s, run->at);
  const real *later = corner_at(s, next->at);
  for (int k = 0; k < run->many; k++)
    for (int l = 0; l < 2; l++)
      w->v[k][l] = force_along(s->F + 3L * w->point[k], l * LANES) * load_any(w->z[k] + l * LANES);
  for (int p = 0; p < run->size[0]; p++, corner += s->layer, later += s->layer) {
    fetch_plane(rows, s, later);
    vec sum[SD_RUN_WIDE][2];
#pragma GCC unroll 10
    for (int q = 0; q < rows; q++)
      for (int l = 0; l < 2; l++) sum[q][l] = load_any(corner + q * s->row + l * LANES);
    for (int k = first_of_plane(s, w, p); k < w->below[p + 1]; k++) {
      const vec x = all(w->x[k][p - w->plane[k]]), v[2] = {x * w->v[k][0], x * w->v[k][1]};
#pragma GCC unroll 10
      for (int q = 0; q < rows; q++)
        for (int l = 0; l < 2; l++) sum[q][l] += all(w->y[k][q]) * v[l];
    }
#pragma GCC unroll 10
    for (int q = 0; q < rows; q++)
      for (int l = 0; l < 2; l++) store_any(corner + q * s->row + l * LANES, sum[q][l]);
  }
}

INLINE void interpolate_run(int rows, const spreading *s, const sd_spread_run *run, const sd_spread_run *next,
                            run_windows *w)
{
  const real *corner = corner_at(s, run->at);
  const real *later = corner_at(s, next->at);
  for (int k = 0; k < run->many; k++) w->v[k][0] = w->v[k][1] = all(0);
  for (int p = 0; p < run->size[0]; p++, corner += s->layer, later += s->layer) {
    fetch_plane(rows, s, later);
    vec u[SD_RUN_WIDE][2];
#pragma GCC unroll 10
    for (int q = 0; q < rows; q++)
      for (int l = 0; l < 2; l++) u[q][l] = load_any(corner + q * s->row + l * LANES);
    for (int k = first_of_plane(s, w, p); k < w->below[p + 1]; k++) {
      vec sum[2] = {all(0), all(0)};
#pragma GCC unroll 10
      for (int q = 0; q < rows; q++)
        for (int l = 0; l < 2; l++) sum[l] += all(w->y[k][q]) * u[q][l];
      for (int l = 0; l < 2; l++) w->v[k][l] += all(w->x[k][p - w->plane[k]]) * sum[l];
    }
  }
  for (int k = 0; k < run->many; k++) {
    const vec a = w->v[k][0] * load_any(w->z[k]), b = w->v[k][1] * load_any(w->z[k] + LANES);
    for (int c = 0; c < 3; c++)
      s->F[3L * w->point[k] + c] = total(a * load_any(whose[c]) + b * load_any(whose[c] + LANES));
  }
}

/* A copy of the work for each number of rows */
#define OF_ROWS(rows, work) \
  case rows: \
    work(rows, s, run, next, &w); \
    break;
#define BY_ROWS(work) \
  switch (run->size[1]) { \
    OF_ROWS(4, work) OF_ROWS(5, work) OF_ROWS(6, work) OF_ROWS(7, work) \
    OF_ROWS(8, work) OF_ROWS(9, work) OF_ROWS(10, work) \
  }

static void spread_one_run(const spreading *s, const sd_spread_run *run, const sd_spread_run *next)
{
  run_windows w;
  windows_of_all(s, run, &w);
  BY_ROWS(spread_run)
}

static void interpolate_one_run(const spreading *s, const sd_spread_run *run, const sd_spread_run *next)
{
  run_windows w;
  windows_of_all(s, run, &w);
  BY_ROWS(interpolate_run)
}
#undef BY_ROWS
#undef OF_ROWS

typedef void of_run(const spreading *s, const sd_spread_run *run, const sd_spread_run *next);
typedef void of_points(const sd_spreading *s);

/* Places stand far apart in memory: those of the next run are fetched to their last while this one works. */
static void fetch_places(const spreading *s, int i)
{
  for (int k = 0; k < 4 * SD_GROUP_POINTS + LANES; k += LANES) sd_fetch(s->place[i] + (k > 0 ? k - 1 : 0));
  for (int k = 0; k < 3 * SD_GROUP_POINTS + LANES; k += LANES) sd_fetch(s->corner[i] + (k > 0 ? k - 1 : 0));
}

/* Points from one on up to another, which are in no run */
static void by_points(const sd_spreading *all_points, int from, int to, of_points *points)
{
  sd_spreading some = *all_points;
  if (from == to) return;
  some.n = to - from;
  some.corner += from;
  some.place = (const real *) some.place + 4L * from;
  some.F = (real *) some.F + (long) some.width * from;
  points(&some);
}

static void by_runs(const sd_spreading *asked, of_run *whole, of_points *points)
{
  spreading s;
  int done = 0;
  in_reals(asked, &s);
  for (int k = 0; k < asked->runs; k++) {
    const sd_spread_run *run = asked->run + k, *next = k + 1 < asked->runs ? run + 1 : run;
    fetch_places(&s, next->first);
    by_points(asked, done, run->first, points);
    whole(&s, run, next);
    done = run->first + run->many;
  }
  by_points(asked, done, asked->n, points);
}

static void spread_runs(const sd_spreading *s)
{
  by_runs(s, spread_one_run, spread);
}

static void interpolate_runs(const sd_spreading *s)
{
  by_runs(s, interpolate_one_run, interpolate);
}

#define SPREAD spread_runs
#define INTERPOLATE interpolate_runs
#else
#define SPREAD spread
#define INTERPOLATE interpolate
#endif
