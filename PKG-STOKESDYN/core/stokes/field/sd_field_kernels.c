/* Kernels of a field: a sphere and the points of a row or of a brick, which are neighbours in memory.
 * With y = 1/R and everything times 8 pi the tensor of a sphere of radius a and a point is
 *
 *   outside   f = y + a^2 y^3/3,  h = y^3 - a^2 y^5,  c = y^3      u = f F + h r (r.F) + c T x r
 *   inside    f = 4/(3a),         h = 0,              c = 1/a^3
 *
 * where inside is what the formulas of outside give for R = a. A point force counts as a sphere of
 * radius 1e-12. */
#include "sd_field_internal.h"

#include <stdint.h>

#include "sd_float_lanes.h"

/* --- which bricks are near --- */

enum { BRICKS = SD_FIELD_BRICKS * SD_FIELD_BRICKS * SD_FIELD_BRICKS };

/* Middles of bricks from the first point of a block: along x for 2 x 4 of a plane, along y for the
 * first 2 x 4 and the second, along z; far away where no point is asked for. Half of a brick, and the
 * range, a little more for what floats lose. */
typedef struct {
  float x[8], y[2][8], z[SD_FIELD_BRICKS], half[3], range2;
} brick_middles;

static brick_middles middles_of(const sd_field_part *p, const sd_field_block *b)
{
  const float far_away = 1e15f;
  brick_middles m = {.range2 = (float) (p->range * p->range * (1.0 + 1e-5))};
  float middle[3][SD_FIELD_BRICKS];
  for (int d = 0; d < 3; d++) {
    m.half[d] = (float) (0.5 * p->step[d]);
    for (int k = 0; k < SD_FIELD_BRICKS; k++)
      middle[d][k] = k < b->bricks[d] ? (float) ((2 * k + 0.5) * p->step[d]) : far_away;
  }
  for (int l = 0; l < 8; l++) {
    m.x[l] = middle[0][l % 4];
    m.y[0][l] = middle[1][l / 4];
    m.y[1][l] = middle[1][2 + l / 4];
  }
  memcpy(m.z, middle[2], sizeof(middle[2]));
  return m;
}

/* Squared distance from a place to bricks in one direction */
INLINE floats gap(const float *middle, float x, float half)
{
  const floats d = load_floats(middle) - all_floats(x);
  const floats beyond = larger_floats(larger_floats(d, -d) - all_floats(half), all_floats(0.0f));
  return beyond * beyond;
}

/* Which bricks may have a point within the range of a source? Brick k in bit k */
INLINE uint64_t bricks_near(const brick_middles *m, const sd_field_block *b, const double *s)
{
  enum { VECTORS = 8 / FLOATS };
  const float x = (float) (s[0] - b->lo[0]), y = (float) (s[1] - b->lo[1]);
  const float z = (float) (s[2] - b->lo[2]);
  floats across[2][VECTORS];
  uint64_t near = 0;
  for (int l = 0; l < VECTORS; l++) {
    const floats along_x = gap(m->x + FLOATS * l, x, m->half[0]);
    for (int k = 0; k < 2; k++)
      across[k][l] = along_x + gap(m->y[k] + FLOATS * l, y, m->half[1]);
  }
  for (int j = 0; j < b->bricks[2]; j++) {
    const float beyond = fabsf(m->z[j] - z) - m->half[2], least = beyond > 0.0f ? beyond : 0.0f;
    const floats left = all_floats(m->range2 - least * least);
    for (int k = 0; k < 2; k++)
      for (int l = 0; l < VECTORS; l++)
        near |= (uint64_t) float_hits(across[k][l], left) << (16 * j + 8 * k + FLOATS * l);
  }
  return near;
}

/* The lowest of the bits, which are not 0 */
INLINE unsigned lowest(uint64_t bits)
{
#ifdef SD_HAS_VECTORS
  return (unsigned) __builtin_ctzll(bits);
#else
  unsigned k = 0;
  while (!(bits >> k & 1)) k++;
  return k;
#endif
}

/* --- within the range --- */

/* A source is fetched so many before it is its turn. */
enum { AHEAD = 6 };

INLINE vec within(vec a, vec most, vec x)
{
  return where(a <= most, x, all(0.0));
}

#define REAL double
#define REALS vec
#define WIDTH LANES
#define OF(name) name##_double
#define ALL all
#define LOAD load_any
#define STORE store_any
#define LARGER larger
#define SMALLER smaller
#define WITHIN within
#define INVERSE_ROOT inverse_root
#define NEAR_DEGREES SD_NEAR_DEGREES
#include "sd_field_near_kernel.h"

#define REAL float
#define REALS floats
#define WIDTH FLOATS
#define OF(name) name##_float
#define ALL all_floats
#define LOAD load_floats
#define STORE store_floats
#define LARGER larger_floats
#define SMALLER smaller_floats
#define WITHIN floats_within
#define INVERSE_ROOT inverse_root_floats
#define NEAR_DEGREES SD_FIELD_FLOAT_DEGREES
#include "sd_field_near_kernel.h"

/* --- all pairs --- */

/* x of the points i ... i + LANES - 1 of every row */
INLINE vec along(const sd_field_part *p, int i)
{
  return all(p->lo[0]) + (all((double) i) + (vec) LANEWISE(NUMBER, 0)) * all(p->step[0]);
}

INLINE void direct_with(int turns, const sd_field_part *p)
{
  for (int k = 0; k < p->points[2]; k++)
    for (int j = 0; j < p->points[1]; j++) {
      const vec y = all(p->lo[1] + j * p->step[1]), z = all(p->lo[2] + k * p->step[2]);
      double *row = p->u + 3 * ((long) k * p->points[1] + j) * p->points[0];
      for (int i = 0; i < p->points[0]; i += LANES) {
        const vec x = along(p, i);
        vec u[3] = {all(0.0), all(0.0), all(0.0)};
        for (int m = 0; m < p->n; m++) {
          const double *s = p->source + (long) SD_FIELD_ROW * m;
          const vec dx = x - all(s[0]), dy = y - all(s[1]), dz = z - all(s[2]);
          vec f, h, c, G[6];
          for (int d = 0; d < 6; d++) G[d] = all(s[4 + d]);
          point_block_double(dx * dx + dy * dy + dz * dz, all(s[3] > 1e-12 ? s[3] * s[3] : 1e-24), &f, &h, &c);
          add_flow_double(turns, G, f, h, c, dx, dy, dz, u);
        }
        for (int l = 0; l < LANES && i + l < p->points[0]; l++)
          for (int d = 0; d < 3; d++) row[3 * (i + l) + d] += p->unit * LANE(u[d], l);
      }
    }
}

static void direct(const sd_field_part *p)
{
  if (p->turns)
    direct_with(1, p);
  else
    direct_with(0, p);
}

/* --- from the waves' grid --- */

static void windows(const sd_field_place *place, int n, int points, const sd_field_line *line, double *out,
                    long apart)
{
  const int columns = line->columns;
  for (int l = 0; l < n; l++) {
    const double *at = line->from + columns * (long) place[l].at, *value = place[l].value;
    double *to = out + apart * l;
    sd_fetch(at + line->next);
#if LANES >= 4
    row4 sum = value[0] * load4(at);
    for (int k = 1; k < points; k++) sum += value[k] * load4(at + columns * k);
    store4(to, sum);
#else
    for (int d = 0; d < 4; d++) {
      to[d] = value[0] * at[d];
      for (int k = 1; k < points; k++) to[d] += value[k] * at[columns * k + d];
    }
#endif
  }
}

/* n: a multiple of 4 */
static void field_rows(const double *value, int points, const double *from, long n, double *out)
{
  enum { STEP = LANES < 4 ? LANES : 4 };
  for (long m = 0; m < n; m += STEP) {
#if LANES >= 4
    row4 sum = value[0] * load4(from + m);
    for (int k = 1; k < points; k++) sum += value[k] * load4(from + n * k + m);
    store4(out + m, sum);
#else
    vec sum = all(value[0]) * load_any(from + m);
    for (int k = 1; k < points; k++) sum += all(value[k]) * load_any(from + n * k + m);
    store_any(out + m, sum);
#endif
  }
}

const struct sd_field_kernels SD_KERNELS(sd_field) = {direct, near_part_double, near_part_float,
                                                        windows, field_rows};
