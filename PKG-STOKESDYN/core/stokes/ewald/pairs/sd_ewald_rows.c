/* What goes into the rows of the near part and what comes out of them. Of doubles; sd_ewald_rows_floats.c: the
 * same of floats. */
#include "sd_ewald_rows.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_isa.h"
#include "sd_real.h"
#include "sd_whole.h"

/* --- places --- */

/* unit: of lengths, as many to 1 */
static inline void put_place(double unit, real *row, const double *x)
{
#ifdef SD_SINGLE
  for (int d = 0; d < 3; d++) {
    const uint32_t whole = (uint32_t) sd_whole_below(x[d] * unit + 0.5); /* modulo 2^32 */
    memcpy(row + d, &whole, sizeof(whole));
  }
#else
  for (int d = 0; d < 3; d++) row[d] = x[d] * unit;
#endif
}

static void rows_stand(sd_ewald_pairs *p, long begin, long end)
{
  real *row = p->row, *turn = p->torque_row;
  const sd_spheres s = p->spheres;
  const double scale = p->scale, unit = sizeof(real) == sizeof(float) ? sd_ewald_pairs_steps(p) : scale;
  for (long k = begin; k < end; k++) {
    const long i = p->sphere[k];
    put_place(unit, row + 8 * k, s.x + 3 * i);
    row[8 * k + 3] = (real) ((p->equal ? p->ewald.a_ref : s.a[i]) * scale);
    row[8 * k + 7] = (real) s.w[i];
  }
  if (end < p->rows) return;
  for (long d = 0; d < 8 * SD_EMPTY_ROWS; d++) row[8L * p->rows + d] = (real) (d % 8 < 3 ? SD_NOWHERE : 0.0);
  for (long d = 0; d < 4 * SD_EMPTY_ROWS && turn; d++) turn[4L * p->rows + d] = 0;
}

/* --- forces --- */

/* Rows are in order of cells, and spheres anywhere in memory: what one has there is fetched so many rows before
 * it is wanted. */
enum { AHEAD = 12 };

static inline void fetch_ahead(int m, const double *numbers)
{
  sd_fetch(numbers);
  sd_fetch(numbers + m - 1);
}

static inline const double *force_on(int m, const sd_ewald_pairs *p, long row, int n, const double *F,
                                     const double *ghosts)
{
  const long i = p->sphere[row];
  return i < n ? F + m * i : ghosts + m * (i - n);
}

/* m: the width, of which the compiler makes a copy each. Sums of sizes are three, which do not wait for each
 * other. */
static inline void load_of_width(int m, const sd_ewald_pairs *p, int n, const double *F, const double *ghosts,
                                 double *sums)
{
  real *row = p->row, *turn = p->torque_row;
  const int *sphere = p->sphere;
  const double scale = p->scale, length = 1.0 / scale;
  double sum[SD_EWALD_SUMS] = {0.0}, size[3] = {0.0};
  for (long k = 0; k < p->rows; k++) {
    const long i = sphere[k];
    real *to = row + 8 * k;
    fetch_ahead(m, force_on(m, p, k + AHEAD < p->rows ? k + AHEAD : k, n, F, ghosts));
    const double w = to[7], *from = force_on(m, p, k, n, F, ghosts);
    const double b = p->equal || i >= n ? 0.0 : sd_ewald_b(&p->ewald, to[3] * length);
    for (int d = 0; d < m; d++) {
      const double f = w * from[d];
      if (d < 3) to[4 + d] = (real) (p->unit * f);
      else turn[4 * k + d - 3] = (real) (p->unit * scale * f);
      if (i >= n) continue;
      sum[d < 3 ? d : d + 3] += f;
      size[d % 3] += fabs(d < 3 ? f : scale * f);
      if (d < 3) sum[3 + d] += b * f;
    }
  }
  sum[SD_EWALD_SIZES] = size[0] + size[1] + size[2];
  memcpy(sums, sum, sizeof(sum));
}

static void rows_load(const sd_ewald_pairs *p, int n, const double *F, const double *ghosts, double *sums)
{
  if (p->width == 6) load_of_width(6, p, n, F, ghosts, sums);
  else load_of_width(3, p, n, F, ghosts, sums);
}

/* The scale of torques is a power of two, and nothing is lost. */
static void rows_of_targets(const sd_ewald_pairs *p, void *out)
{
  const real *row = p->row, *turn = p->torque_row, length = (real) (1.0 / p->scale);
  real *to = out;
  for (long i = 0; i < p->n; i++) {
    const long k = p->target[i];
    for (int d = 0; d < 3; d++) *to++ = row[8 * k + 4 + d];
    for (int d = 0; d < 3 && turn; d++) *to++ = turn[4 * k + d] * length;
  }
}

/* --- velocities --- */

/* Of the sphere itself: what its own wave part is at no distance, and of torques */
static double self_of(const sd_ewald_pairs *p, double b)
{
  return p->origin[SD_I0] - 2.0 * b * p->origin[SD_I1] + b * b * p->origin[SD_I2];
}

/* What is beyond the range, as a mean: by (C_0 - b C_1) S - (C_1 - b C_2) S', which is constant but for b */
typedef struct {
  double of_all[3], of_b[3], turned[3];
} far_part;

static far_part far_of(const sd_ewald_pairs *p, const double *C, const double *S)
{
  far_part far = {{0.0}, {0.0}, {0.0}};
  const double over_V = 1.0 / sd_ewald_volume(&p->ewald.box);
  for (int d = 0; d < 3 && S; d++) {
    far.of_all[d] = over_V * (C[0] * S[d] - C[1] * S[3 + d]);
    far.of_b[d] = over_V * (C[1] * S[d] - C[2] * S[3 + d]);
    far.turned[d] = over_V * 0.25 * C[1] * S[6 + d];
  }
  return far;
}

/* Number d of m of what is near of row k, over w and near_unit_of */
static inline double near_number(int m, const sd_ewald_pairs *p, long k, int d)
{
  const real *near = p->u;
  if (m == 3) return near[4 * k + d];
  return d < 3 ? near[8 * k + d] : p->scale * near[8 * k + d + 1];
}

static double near_unit_of(const sd_ewald_pairs *p)
{
  return p->scale / (8.0 * SD_PI) / p->unit;
}

static inline void take_of_width(int m, const sd_ewald_pairs *p, long begin, long end, const real *waves,
                                 const far_part *far, double *u)
{
  const real *row = p->row, *turn = p->torque_row;
  const double length = 1.0 / p->scale, alike = self_of(p, 0.0), turned = 0.25 * p->origin[SD_I1];
  const double over_unit = 1.0 / p->unit; /* of a power of two: exact */
  const double near_unit = near_unit_of(p);
  for (long i = begin; i < end; i++) {
    const long k = p->target[i], j = p->sphere[k];
    const double w = row[8 * k + 7], unit = w * near_unit, wave = w * over_unit;
    fetch_ahead(m, u + m * (long) p->sphere[p->target[i + AHEAD < p->n ? i + AHEAD : i]]);
    const double b = p->equal ? 0.0 : sd_ewald_b(&p->ewald, row[8 * k + 3] * length);
    const double self = p->equal ? alike : self_of(p, b);
    for (int d = 0; d < m; d++) {
      const double sum = unit * near_number(m, p, k, d);
      const double beyond = d < 3 ? far->of_all[d] - b * far->of_b[d] : far->turned[d - 3];
      const double own = d < 3 ? self * row[8 * k + 4 + d] : turned * length * turn[4 * k + d - 3];
      double v = sum - wave * own;
      if (waves) v += wave * waves[m * i + d];
      u[m * j + d] = v + w * beyond;
    }
  }
}

static void rows_take(const sd_ewald_pairs *p, long begin, long end, const void *waves, const double *tail,
                      const double *sums, double *u)
{
  const far_part far = far_of(p, tail, sums);
  if (p->width == 6) take_of_width(6, p, begin, end, waves, &far, u);
  else take_of_width(3, p, begin, end, waves, &far, u);
}

static inline void of_ghosts_of_width(int m, const sd_ewald_pairs *p, int n, double *u)
{
  const real *row = p->row;
  const double near_unit = near_unit_of(p);
  for (long k = 0; k < p->rows; k++) {
    const long ghost = (long) p->sphere[k] - n;
    if (ghost < 0) continue;
    const double unit = row[8 * k + 7] * near_unit;
    for (int d = 0; d < m; d++) u[m * ghost + d] = unit * near_number(m, p, k, d);
  }
}

static void rows_of_ghosts(const sd_ewald_pairs *p, int n, double *u)
{
  if (p->width == 6) of_ghosts_of_width(6, p, n, u);
  else of_ghosts_of_width(3, p, n, u);
}

#ifdef SD_SINGLE
const struct sd_ewald_rows sd_ewald_rows_floats = {rows_stand, rows_load, rows_of_targets, rows_take, rows_of_ghosts};
#else
const struct sd_ewald_rows sd_ewald_rows_doubles = {rows_stand, rows_load, rows_of_targets, rows_take, rows_of_ghosts};
#endif
