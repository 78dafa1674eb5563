/* Kernels of the near part: the block of a pair (sd_tensor_lanes.h) less the wave part of the same
 * pair in open space, polynomials in t = 2 r^2/range^2 - 1. Included by sd_ewald_kernels.c. */

#ifndef SD_SINGLE
INLINE vec distance_squared(const vec *a, const vec *b)
{
  const vec dx = a[0] - b[0], dy = a[1] - b[1], dz = a[2] - b[2];
  return dx * dx + dy * dy + dz * dz;
}

/* The lanes beyond the end, of other rows, are cut off; centres have room for them. */
INLINE long search_range(const sd_near_ranges *rows, int k, const vec (*x)[3], int places, vec most,
                         int *list)
{
  const double *px = rows->centre, *py = px + rows->stride, *pz = py + rows->stride;
  const int begin = rows->range[2 * k], end = rows->range[2 * k + 1];
  long many = 0;
  for (int j = begin; j < end; j += LANES) {
    const vec at[3] = {load_any(px + j), load_any(py + j), load_any(pz + j)};
    vec least = distance_squared(at, x[0]);
    for (int q = 1; q < places; q++) least = smaller(least, distance_squared(at, x[q]));
    unsigned hits = bits(least <= most);
    if (end - j < LANES) hits &= (1u << (end - j)) - 1;
    many += keep_next(list + many, j, hits);
  }
  return many;
}

INLINE long search_places(const sd_near_ranges *rows, const double *x, int places, double distance2,
                          int *list)
{
  vec at[SD_BUNCH][3];
  long many = 0;
  for (int q = 0; q < places; q++)
    for (int d = 0; d < 3; d++) at[q][d] = all(x[3 * q + d]);
  for (int k = 0; k < rows->count; k++)
    many += search_range(rows, k, at, places, all(distance2), list + many);
  return many;
}

/* One place, and a full bunch, in loops of their own. No number of the list can be a part of this copy of the
 * rows: it stays in registers. */
static long search(const sd_near_ranges *rows, const double *x, int places, double distance2, int *list)
{
  const sd_near_ranges own = *rows;
  return places == 1       ? search_places(&own, x, 1, distance2, list)
      : places == SD_BUNCH ? search_places(&own, x, SD_BUNCH, distance2, list)
                           : search_places(&own, x, places, distance2, list);
}

#endif

/* Rows of a bunch: with vectors of 64 bytes, reading and writing the rows of neighbours takes longer than the
 * pairs; with shorter ones it does not, and pairs beyond the range would cost more than is saved. So it is
 * with unlike radii in doubles, which have twice as many polynomials. Groups are longer. */
#if LANES == LANES_OF(64)
enum {
  BUNCH = SD_BUNCH,
  BUNCH_UNLIKE = sizeof(real) == sizeof(float) ? SD_BUNCH : 1,
  NEAR_ROWS = SD_GROUP_POINTS
};
#else
enum { BUNCH = 1, BUNCH_UNLIKE = 1, NEAR_ROWS = BUNCH };
#endif

/* Is the arithmetic of a vector of pairs so short that a branch costs more than the formulas on both its
 * sides? */
enum { BRANCHLESS = LANES == LANES_OF(64) || sizeof(real) == sizeof(float) };

/* COUNT polynomials of one degree at once: coefficient [COUNT][stride] */
INLINE void horner(int count, int degree, const real *coefficient, int stride, vec t, vec *value)
{
#pragma GCC unroll 8
  for (int f = 0; f < count; f++) value[f] = all(coefficient[f * stride + degree]);
#pragma GCC unroll 40
  for (int k = degree - 1; k >= 0; k--)
#pragma GCC unroll 8
    for (int f = 0; f < count; f++) value[f] = value[f] * t + all(coefficient[f * stride + k]);
}

/* A = I_0 - (b_i + b_j) I_1 + b_i b_j I_2 = (I_0 - b_i I_1) - b_j (I_1 - b_i I_2), and the same of J:
 * four polynomials for a target, out [4][SD_RADIAL_TERMS]. */
INLINE void polynomials_of_target(const sd_near_part *p, double b, int degree, real *out)
{
  for (int l = 0; l < 2; l++)
    for (int k = 0; k <= degree; k++) {
      const double c0 = p->coefficient[SD_I0 + l][k], c1 = p->coefficient[SD_I1 + l][k];
      const double c2 = p->coefficient[SD_I2 + l][k];
      out[l * SD_RADIAL_TERMS + k] = (real) (c0 - b * c1);
      out[(2 + l) * SD_RADIAL_TERMS + k] = (real) (c1 - b * c2);
    }
}

/* The polynomials of all radii, as real numbers */
typedef struct {
  real of[SD_RADIALS][SD_RADIAL_TERMS];
} near_polynomials;

static void near_polynomials_of(const sd_near_part *p, near_polynomials *c)
{
  for (int f = 0; f < SD_RADIALS; f++)
    for (int k = 0; k <= p->degree; k++) c->of[f][k] = (real) p->coefficient[f][k];
}

/* More than rounding makes of the square of a distance */
static const double HAIR = sizeof(real) == sizeof(float) ? 1e-6 : 1e-13;

/* What the kernels of forces know of all pairs, and of the first sphere of one. ends2: where they end if
 * nobody has looked before; a hair beyond the range, since images of one sphere may be just there, and
 * rounding would decide. c: its polynomials, those of all where radii are equal; G: its force */
typedef struct {
  vec unit, range2, ends2, twice, ref2;
  alike of_all;
} near_constants;

typedef struct {
  real x[3], G[3], a;
  const real *c;
} near_first;

INLINE near_constants near_constants_of(const sd_near_part *p)
{
  return (near_constants){all((real) p->unit), all((real) p->range2), all((real) (p->range2 * (1.0 + HAIR))),
                          all((real) (2.0 / p->range2)), all((real) p->ref2), alike_of((real) sqrt(p->ref2))};
}

INLINE near_first near_first_of(const real *own, const real *c)
{
  return (near_first){{own[0], own[1], own[2]}, {own[4], own[5], own[6]}, own[3], c};
}

/* Pairs of one sphere with a vector of others, d from these to it: M F = f F + h d (d.F) */
typedef struct {
  vec d[3], f, h;
} near_pairs;

/* Pairs with spheres whose rows are the columns `at`. equal: all radii are a_ref, and two polynomials do.
 * ends: f and h are 0 beyond ends2; without it all pairs are within the range */
INLINE near_pairs near_radial(int equal, int ends, int degree, const near_constants *k, const near_first *i,
                              const vec at[8])
{
  near_pairs out;
  vec D[4], *d = out.d, *f = &out.f, *h = &out.h;
  for (int e = 0; e < 3; e++) d[e] = length_between(all(i->x[e]), at[e], k->unit);
  const vec ai = all(i->a), aj = at[3], r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  const vec t = smaller(r2, k->range2) * k->twice - all(1.0);
  if (equal && BRANCHLESS)
    block_alike(r2, &k->of_all, f, h);
  else
    block(r2, ai, aj, ai * ai + aj * aj, f, h);
  horner(equal ? 2 : 4, degree, i->c, SD_RADIAL_TERMS, t, D);
  if (equal) {
    *f -= D[0];
    *h -= D[1];
  } else {
    const vec b = (aj * aj - k->ref2) * all(1.0 / 6.0);
    *f -= D[0] - b * D[2];
    *h -= D[1] - b * D[3];
  }
  if (!ends) return out;
  *f = where(r2 <= k->ends2, *f, all(0.0));
  *h = where(r2 <= k->ends2, *h, all(0.0));
  return out;
}

/* u += what the forces F of the others do to the one */
INLINE void near_add(const near_pairs *m, const vec F[3], vec u[3])
{
  const vec *d = m->d, f = m->f, e = m->h * (d[0] * F[0] + d[1] * F[1] + d[2] * F[2]);
  for (int c = 0; c < 3; c++) u[c] = (u[c] + f * F[c]) + e * d[c];
}

/* u += what the one does to the others */
INLINE void near_add_of(const near_first *i, const near_pairs *m, vec u[3])
{
  const vec *d = m->d, f = m->f, h = m->h;
  const vec G[3] = {all(i->G[0]), all(i->G[1]), all(i->G[2])};
  const vec g = h * (d[0] * G[0] + d[1] * G[1] + d[2] * G[2]);
  for (int c = 0; c < 3; c++) u[c] = (u[c] + g * d[c]) + f * G[c];
}

/* Rows from `begin` on that are taken together, and what they feel */
typedef struct {
  int begin, rows;
  near_first row[NEAR_ROWS];
  vec u[NEAR_ROWS][3];
  real of_row[NEAR_ROWS][4 * SD_RADIAL_TERMS];
} near_bunch;

INLINE void near_bunch_begin(int equal, int degree, const sd_near_part *p, const near_polynomials *shared,
                             int begin, int rows, near_bunch *b)
{
  b->begin = begin;
  b->rows = rows;
  for (int q = 0; q < rows; q++) {
    const real *own = (const real *) p->row + 8 * (long) (begin + q);
    if (!equal) polynomials_of_target(p, ((double) own[3] * own[3] - p->ref2) / 6.0, degree, b->of_row[q]);
    b->row[q] = near_first_of(own, equal ? shared->of[0] : b->of_row[q]);
    b->u[q][0] = b->u[q][1] = b->u[q][2] = all(0.0);
  }
}

INLINE void near_bunch_end(const near_bunch *b, real *sums)
{
  for (int q = 0; q < b->rows; q++)
    for (int c = 0; c < 3; c++) sums[4 * (long) (b->begin + q) + c] += total(b->u[q][c]);
}

/* What a bunch and a vector of its neighbours do to each other: v is what these feel. own: the first of them
 * are the bunch's rows behind its first, and a row has pairs with those behind it. */
INLINE void near_bunch_add(int equal, int own, int degree, const near_constants *k, near_bunch *b,
                           const vec at[8], vec v[3])
{
  for (int q = 0; q < b->rows; q++) {
    near_pairs m = near_radial(equal, BUNCH > 1, degree, k, b->row + q, at);
    if (own) {
      const yes_no behind = (vec) LANEWISE(NUMBER, 0) >= all((real) q);
      m.f = where(behind, m.f, all(0.0));
      m.h = where(behind, m.h, all(0.0));
    }
    near_add(&m, at + 4, b->u[q]);
    near_add_of(b->row + q, &m, v);
  }
}

COPIED void near_forces(int equal, int degree, const sd_near_part *p)
{
  near_polynomials shared;
  near_polynomials_of(p, &shared);
  const near_constants all_pairs = near_constants_of(p);
  for (int i = 0; i < p->bunches; i++) {
    const long first = p->first[i], end = p->first[i + 1];
    near_bunch b;
    if (first == end) continue;
    const int begin = p->begin[i], rows = BUNCH == 1 ? 1 : p->begin[i + 1] - begin;
    near_bunch_begin(equal, degree, p, &shared, begin, rows, &b);
    for (long k = first; k < end; k += LANES) {
      const int *j = p->neighbor + k;
      vec at[8], v[4] = {all(0.0), all(0.0), all(0.0), all(0.0)};
      gather_eight(p->row, j, at);
      if (BUNCH > 1 && k == first) near_bunch_add(equal, 1, degree, &all_pairs, &b, at, v);
      else near_bunch_add(equal, 0, degree, &all_pairs, &b, at, v);
      add_to_rows(p->u, 4, j, v);
    }
    near_bunch_end(&b, p->u);
  }
}

/* With torques all eight; of equal radii those that b is not a factor of. A bunch is one row. */
COPIED void near_torques(int equal, int degree, const sd_near_part *p)
{
  const real *rows = p->row, *turns = p->torque_row;
  real *sums = p->u;
  near_polynomials shared;
  near_polynomials_of(p, &shared);
  const vec unit = all((real) p->unit), range2 = all((real) p->range2), twice = all((real) (2.0 / p->range2));
  const vec one = all(1.0), ref2 = all((real) p->ref2);
  const vec quarter = all(0.25), sixth = all(1.0 / 6.0);
  const alike of_all = alike_of((real) sqrt(p->ref2));
  for (int i = 0; i < p->bunches; i++) {
    const real *own = rows + 8 * (long) i, *turn = turns + 4 * (long) i;
    const vec x[3] = {all(own[0]), all(own[1]), all(own[2])}, a = all(own[3]);
    const vec bi = (a * a - ref2) * sixth;
    vec u[6], G[6];
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) {
      u[k] = all(0.0);
      G[k] = all(k < 3 ? own[4 + k] : turn[k - 3]);
    }
    const long end = p->first[i + 1];
    for (long k = p->first[i]; k < end; k += LANES) {
      const int *j = p->neighbor + k;
      vec at[11], *F = at + 4, D[SD_RADIALS], v[6], d[3];
      grand b;
      gather_eight(rows, j, at);
      gather(turns, 4, j, F + 3);
      for (int c = 0; c < 3; c++) d[c] = length_between(x[c], at[c], unit);
      const vec aj = at[3];
      const vec r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], t = smaller(r2, range2) * twice - one;
      if (equal && BRANCHLESS)
        grand_alike(r2, &of_all, &b);
      else
        grand_block(r2, a, aj, a * a + aj * aj, &b);
      horner(equal ? SD_I2 : SD_RADIALS, degree, shared.of[0], SD_RADIAL_TERMS, t, D);
      if (equal) {
        horner(1, degree, shared.of[SD_K0], SD_RADIAL_TERMS, t, D + SD_K0);
        b.f -= D[SD_I0];
        b.h -= D[SD_J0];
        b.cij -= D[SD_K0];
        b.cji -= D[SD_K0];
      } else {
        const vec bj = (aj * aj - ref2) * sixth, sum = bi + bj, product = bi * bj;
        b.f -= D[SD_I0] - sum * D[SD_I1] + product * D[SD_I2];
        b.h -= D[SD_J0] - sum * D[SD_J1] + product * D[SD_J2];
        b.cij -= D[SD_K0] - bj * D[SD_K1];
        b.cji -= D[SD_K0] - bi * D[SD_K1];
      }
      b.k -= quarter * D[SD_I1];
      b.e -= quarter * D[SD_J1];
      grand_add(&b, b.cji, b.cij, d, F, u);
#pragma GCC unroll 6
      for (int e = 0; e < 6; e++) v[e] = all(0.0);
      grand_add(&b, -b.cij, -b.cji, d, G, v);
      vec U[4] = {v[0], v[1], v[2], all(0.0)}, W[4] = {v[3], v[4], v[5], all(0.0)};
      add_to_rows(sums, 8, j, U);
      add_to_rows(sums + 4, 8, j, W);
    }
    real *own_u = sums + 8 * (long) i;
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) own_u[k < 3 ? k : k + 1] += total(u[k]);
  }
}

/* A copy of each for each degree: loops of a length that is not known cost twice as much. */
#ifdef SD_SINGLE
#define ALL_DEGREES SD_NEAR_SINGLE_DEGREES
#else
#define ALL_DEGREES SD_NEAR_DEGREES
#endif
#define COPY(name, loop, equal, d) \
  static void name##_##d(const sd_near_part *p) { loop(equal, d, p); }
#define OF_DEGREE(d)                                                          \
  COPY(near_equal, near_forces, 1, d) COPY(near_any, near_forces, 0, d)       \
  COPY(turn_equal, near_torques, 1, d) COPY(turn_any, near_torques, 0, d)
ALL_DEGREES(OF_DEGREE)
#undef OF_DEGREE
#undef COPY

static void near_part(const sd_near_part *p)
{
#define OF_DEGREE(d)                                    \
  if (p->degree == (d)) {                               \
    if (p->width == 6)                                  \
      (p->equal ? turn_equal_##d : turn_any_##d)(p);    \
    else                                                \
      (p->equal ? near_equal_##d : near_any_##d)(p);    \
    return;                                             \
  }
  ALL_DEGREES(OF_DEGREE)
#undef OF_DEGREE
}
