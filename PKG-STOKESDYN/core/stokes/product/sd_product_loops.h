/* The loops over pairs that all kernels of the product share: a file of kernels says what one pair
 * of vectors makes of forces (pair_sum), and ends in DEFINE_SYMMETRIC and DEFINE_LIST for each width. For
 * sources only. */
#ifndef SD_PRODUCT_LOOPS_H
#define SD_PRODUCT_LOOPS_H

#include "sd_product_internal.h"
#include "sd_rows.h"
#include "sd_steps.h"
#include "sd_tensor_lanes.h"

/* The law of a product. All loops have a copy for RPY without taper as constants: a branch on the
 * law, though it always goes the same way, would cost those of forces 4 %. step: of sd_steps.h */
typedef struct {
  sd_tensor tensor;
  sd_taper taper;
  vec inverse_range, step;
} law;

static int is_rpy(const sd_packed *p)
{
  return p->law.tensor == SD_TENSOR_RPY && p->law.taper == SD_TAPER_NONE;
}

static inline law law_of(const sd_packed *p, sd_tensor tensor, sd_taper taper)
{
  return (law){tensor, taper, all((real) (1.0 / p->law.range)), all((real) p->step)};
}

/* sd_taper_factor at the distance whose square is r2 */
INLINE vec taper_of(const law *w, vec r2)
{
  const vec q = root(r2) * w->inverse_range, s = larger(all(1.0) - q, all(0.0));
  if (w->taper == SD_TAPER_WENDLAND) return (s * s) * (s * s) * (all(1.0) + all(4.0) * q);
  return s * s * (all(1.0) + all(0.5) * q);
}

typedef struct {
  vec x, y, z, a;
} place;

/* One side of the pairs of a vector: where it is, its forces F [width] and what it gets, u [width]; u NULL:
 * nothing */
typedef struct {
  place at;
  const vec *F;
  vec *u;
} side;

/* A target i in all lanes and a vector of sources j: each gets what the forces of the other make. self: the
 * lane in which the source is the target, any other number: none */
typedef void pair_sum(const law *w, int self, const side *i, const side *j);

/* Sources are taken in chunks that stay in the first-level cache while all targets pass: sixteen
 * columns, those with torques, of so many spheres are 16 KiB, half of it. */
enum { CHUNK = 2048 / sizeof(real), GRAND_CHUNK = CHUNK / 2 };
/* Targets at a time: what is loaded serves so often. With torques the registers are full with one. */
enum { MOST_TARGETS = LANES > 1 ? 2 : 1 };

/* Sums of the sources of a chunk while targets pass: source j's is of[k][j - begin]. */
typedef struct {
  real *of[6];
  int begin;
} chunk_sums;

/* Targets from `target` on, and sources, in whole vectors */
typedef struct {
  int target, begin, end;
} meeting;

/* sums NULL: the sources get nothing */
INLINE void tile(int width, int targets, pair_sum *add, const law *w, const sd_packed *p, meeting m,
                 const chunk_sums *sums)
{
  const int i = m.target;
  const real *restrict px = p->x, *restrict py = p->y, *restrict pz = p->z, *restrict pa = p->a;
  place target[MOST_TARGETS];
  vec F[MOST_TARGETS][6], u[MOST_TARGETS][6], G[6], v[6];
#pragma GCC unroll 2
  for (int t = 0; t < targets; t++) {
    target[t] = (place){all(px[i + t]), all(py[i + t]), all(pz[i + t]), all(pa[i + t])};
#pragma GCC unroll 6
    for (int k = 0; k < width; k++) {
      F[t][k] = all(((const real *) p->f[k])[i + t]);
      u[t][k] = all(0.0);
    }
  }
  for (int j = m.begin; j < m.end; j += LANES) {
    const side source = {{load(px + j), load(py + j), load(pz + j), load(pa + j)}, G, sums ? v : NULL};
#pragma GCC unroll 6
    for (int k = 0; k < width; k++) {
      G[k] = load((const real *) p->f[k] + j);
      if (sums) v[k] = load(sums->of[k] + j - sums->begin);
    }
#pragma GCC unroll 2
    for (int t = 0; t < targets; t++) {
      const side one = {target[t], F[t], u[t]};
      add(w, sums ? -1 : i + t - j, &one, &source);
    }
#pragma GCC unroll 6
    for (int k = 0; k < width && sums; k++) store(sums->of[k] + j - sums->begin, v[k]);
  }
#pragma GCC unroll 2
  for (int t = 0; t < targets; t++)
#pragma GCC unroll 6
    for (int k = 0; k < width; k++) p->u[k][i + t] += total(u[t][k]);
}

#ifdef SD_SINGLE
/* Floats add up what one group of targets makes, in memory of their own; then doubles go on. */
typedef struct {
  ALIGNED(64) real of[6][CHUNK];
} chunk_room;

static chunk_sums sums_of_chunk(const sd_packed *p, int width, int begin, chunk_room *room)
{
  chunk_sums s = {.begin = begin};
  (void) p;
  for (int k = 0; k < width; k++) s.of[k] = memset(room->of[k], 0, sizeof(room->of[k]));
  return s;
}

/* Into the columns of the sources up to `end`; nothing is held then. */
static void give_sums(const sd_packed *p, int width, const chunk_sums *s, int end)
{
  for (int k = 0; k < width; k++) {
    double *restrict u = p->u[k] + s->begin;
    real *restrict held = s->of[k];
    for (int j = 0; j < end - s->begin; j++) {
      u[j] += held[j];
      held[j] = 0;
    }
  }
}
#else
/* Doubles add to the columns themselves. */
typedef int chunk_room;

static chunk_sums sums_of_chunk(const sd_packed *p, int width, int begin, chunk_room *room)
{
  chunk_sums s = {.begin = begin};
  (void) room;
  for (int k = 0; k < width; k++) s.of[k] = p->u[k] + begin;
  return s;
}

static void give_sums(const sd_packed *p, int width, const chunk_sums *s, int end)
{
  (void) p, (void) width, (void) s, (void) end;
}
#endif

/* Groups of LANES columns: does the pair of a group with any later one belong to this part? In
 * turn, there and back, so that the sums of (groups - I) over a part's groups are equal. */
INLINE int mine(int group, int part, int parts)
{
  const int turn = group % (2 * parts);
  return turn == part || turn == 2 * parts - 1 - part;
}

/* All pairs of this part, `targets` at a time. A group of LANES targets meets itself one-sidedly, as
 * its own lanes are among the sources, and every later group once for both: a block serves two
 * spheres, which is what makes this about 1.4 times as fast as a loop over all targets. */
INLINE void share_of_pairs(int width, int targets, pair_sum *add, const law *w, const sd_packed *p,
                           int part, int parts)
{
  const int chunk = width == 6 ? GRAND_CHUNK : CHUNK;
  chunk_room room;
  for (int c = 0; c < p->padded; c += chunk) {
    const int end = c + chunk < p->padded ? c + chunk : p->padded;
    const chunk_sums sums = sums_of_chunk(p, width, c, &room);
    for (int i = 0; i < end; i += LANES) {
      if (!mine(i / LANES, part, parts)) continue;
      const int from = i + LANES > c ? i + LANES : c;
      for (int t = i; t < i + LANES; t += targets) {
        if (i >= c) tile(width, targets, add, w, p, (meeting){t, i, i + LANES}, NULL);
        if (from < end) tile(width, targets, add, w, p, (meeting){t, from, end}, &sums);
      }
      give_sums(p, width, &sums, end);
    }
  }
}

/* symmetric of struct sd_kernel, with this name */
#define DEFINE_SYMMETRIC(name, width, targets, add)                             \
  static void name(const sd_packed *p, int part, int parts)                     \
  {                                                                             \
    const law w = law_of(p, p->law.tensor, p->law.taper);                       \
    const law rpy = law_of(p, SD_TENSOR_RPY, SD_TAPER_NONE);                    \
    if (is_rpy(p))                                                              \
      share_of_pairs(width, targets, add, &rpy, p, part, parts);                \
    else                                                                        \
      share_of_pairs(width, targets, add, &w, p, part, parts);                  \
  }

/* --- by list, in doubles alone --- */

#ifndef SD_SINGLE
/* LANES neighbours from k on; what is missing before end is the row that stands for nothing. From
 * before the first: the sphere itself alone */
INLINE const int *neighbors(const sd_pairs *pairs, int i, long k, int nothing, int *rest)
{
  const long begin = pairs->first[i], end = pairs->first[i + 1];
  if (k >= begin && end - k >= LANES) return pairs->neighbor + k;
  for (int l = 0; l < LANES; l++) {
    if (k < begin)
      rest[l] = l == 0 ? i : nothing;
    else
      rest[l] = k + l < end ? pairs->neighbor[k + l] : nothing;
  }
  return rest;
}

/* Row by row, LANES neighbours at a time. A neighbour has a row of its own, so its sums are its own
 * row's: nothing is written but u of the target, and no two targets meet. itself: a sphere meets
 * itself too. */
INLINE void rows_of_pairs(int width, int itself, pair_sum *add, const law *w, const sd_packed *p,
                          const sd_pairs *pairs)
{
  for (int i = 0; i < pairs->n; i++) {
    const double *own = p->row + 8 * (long) i;
    const place target = {all(own[0]), all(own[1]), all(own[2]), all(own[3])};
    const long end = pairs->first[i + 1];
    vec u[6];
#pragma GCC unroll 6
    for (int k = 0; k < width; k++) u[k] = all(0.0);
    for (long k = pairs->first[i] - (itself ? LANES : 0); k < end; k += LANES) {
      int rest[LANES];
      const int *j = neighbors(pairs, i, k, p->n, rest);
      vec at[4], F[7]; /* rows have four numbers */
      gather(p->row, 8, j, at);
      gather(p->row + 4, 8, j, F);
      if (width == 6) gather(p->torque_row, 4, j, F + 3);
      const side one = {target, NULL, u}, source = {{at[0], at[1], at[2], at[3]}, F, NULL};
      add(w, -1, &one, &source);
    }
#pragma GCC unroll 6
    for (int k = 0; k < width; k++) p->u[k][i] += total(u[k]);
  }
}

/* list of struct sd_kernel, with this name */
#define DEFINE_LIST(name, width, itself, add)                                   \
  static void name(const sd_packed *p, const sd_pairs *pairs)                   \
  {                                                                             \
    const law w = law_of(p, p->law.tensor, p->law.taper);                       \
    const law rpy = law_of(p, SD_TENSOR_RPY, SD_TAPER_NONE);                    \
    if (is_rpy(p))                                                              \
      rows_of_pairs(width, itself, add, &rpy, p, pairs);                        \
    else                                                                        \
      rows_of_pairs(width, itself, add, &w, p, pairs);                          \
  }
#endif

#endif
