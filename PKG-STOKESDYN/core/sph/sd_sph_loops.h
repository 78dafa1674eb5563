/* The loops of sd_sph_pair.h, compiled once for each instruction set by the two files that include
 * this one and define LOOPS. Four pairs are a vector; what a scene does not ask for is a constant 0
 * in its copy of the loop, so the compiler drops it. */
#include "sd_sph_sums.h"

#include <math.h>
#include <string.h>

typedef double v4 __attribute__((vector_size(32)));
typedef long long m4 __attribute__((vector_size(32)));
typedef double v4_unaligned __attribute__((vector_size(32), aligned(8), may_alias));
#define INLINE static inline __attribute__((always_inline))

#if defined(__clang__) || __GNUC__ >= 12
#define SHUFFLE(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#else
#define SHUFFLE(a, b, i, j, k, l) __builtin_shuffle(a, b, (m4){i, j, k, l})
#endif

/* A row need not begin at a multiple of 32 bytes, and holds numbers of another type. */
INLINE v4 load(const double *p)
{
  return *(const v4_unaligned *) p;
}

INLINE void store(double *p, v4 a)
{
  *(v4_unaligned *) p = a;
}

INLINE v4 all(double a)
{
  return (v4){a, a, a, a};
}

/* yes is all bits or none in each lane, as comparisons make it: no branch. */
INLINE v4 where(m4 yes, v4 a, v4 b)
{
  return (v4) ((yes & (m4) a) | (~yes & (m4) b));
}

INLINE v4 smaller(v4 a, v4 b)
{
  return where(a < b, a, b);
}

INLINE v4 larger(v4 a, v4 b)
{
  return where(a > b, a, b);
}

/* The compiler makes one instruction of these four. */
INLINE v4 root(v4 a)
{
  return (v4){sqrt(a[0]), sqrt(a[1]), sqrt(a[2]), sqrt(a[3])};
}

/* Four rows of four become four columns: eight shuffles, two levels of pairs. */
INLINE void transpose(v4 r[4])
{
  const v4 a = SHUFFLE(r[0], r[1], 0, 4, 2, 6), b = SHUFFLE(r[0], r[1], 1, 5, 3, 7);
  const v4 c = SHUFFLE(r[2], r[3], 0, 4, 2, 6), d = SHUFFLE(r[2], r[3], 1, 5, 3, 7);
  r[0] = SHUFFLE(a, c, 0, 1, 4, 5);
  r[1] = SHUFFLE(b, d, 0, 1, 4, 5);
  r[2] = SHUFFLE(a, c, 2, 3, 6, 7);
  r[3] = SHUFFLE(b, d, 2, 3, 6, 7);
}

/* Column c of rows j[0..3], `columns` apart, becomes r[c]. */
INLINE void gather_from(const double *rows, int columns, const int j[4], v4 r[4])
{
  for (int k = 0; k < 4; k++) r[k] = load(rows + (size_t) columns * j[k]);
  transpose(r);
}

INLINE void gather(const double *rows, const int j[4], v4 r[4])
{
  gather_from(rows, 4, j, r);
}

/* Adds the sums over the lanes of sum[0..3] to the four numbers of a row. */
INLINE void add_lanes(double *row, v4 sum[4])
{
  transpose(sum);
  store(row, load(row) + ((sum[0] + sum[1]) + (sum[2] + sum[3])));
}

/* K and G of sd_sph_kernel.h for q <= 2, four at a time. */
INLINE v4 K(sd_sph_kernel kernel, v4 q)
{
  if (kernel == SD_SPH_CUBICSPLINE) {
    const v4 outer = 2.0 - q, inner = larger(1.0 - q, all(0.0));
    return outer * outer * outer - 4.0 * (inner * inner * inner);
  }
  const v4 t = 1.0 - 0.5 * q, t2 = t * t;
  return t2 * t2 * (2.0 * q + 1.0);
}

INLINE v4 G(sd_sph_kernel kernel, v4 q)
{
  if (kernel == SD_SPH_CUBICSPLINE) {
    const v4 outer = 2.0 - q;
    return where(q < 1.0, 9.0 * q - 12.0, -3.0 * (outer * outer) / q);
  }
  const v4 t = 1.0 - 0.5 * q;
  return -5.0 * (t * t * t);
}

/* Coefficient NAME of the pairs of i with j[0..3]. */
#define COEFFICIENT(NAME)                                                              \
  (many ? (v4){row[p->cls[j[0]]].NAME, row[p->cls[j[1]]].NAME, row[p->cls[j[2]]].NAME, \
               row[p->cls[j[3]]].NAME}                                                 \
        : all(row->NAME))
#define MASSES (many ? (v4){p->m[j[0]], p->m[j[1]], p->m[j[2]], p->m[j[3]]} : mi)
#define ROW_OF(i) (model->pair + (many ? (size_t) p->cls[i] * model->nclasses : 0))

/* The next four neighbours; the last ones are filled up with the far-away particle. */
INLINE void next_four(const int *neighbor, int at, int count, int mask, int filler, int j[4])
{
  for (int k = 0; k < 4; k++) j[k] = at + k < count ? neighbor[at + k] & mask : filler;
}

/* What a scene asks for. In copies of a loop for the plain scheme all are constants; the others
 * branch on the terms of the force, the same way for every pair. many: classes. */
typedef struct {
  sd_sph_kernel kernel;
  int many, artvisc, tenscorr, rates;
  sd_sph_friction friction;
  sd_sph_scheme scheme;
} terms;

/* How the loops are written. A half list gives each pair to one of its two particles, i, which
 * keeps its own sums in registers until its neighbours are through; what a neighbour j gets is
 * added to its row in memory at once. Rows of four numbers are loaded whole, since neighbours lie
 * anywhere in memory, and transposed: then lane k of every vector is the pair of i with j[k].
 * Lanes of neighbours that are too far, and of the filler, carry zeros, because G or K are 0
 * there: a test for each lane would cost more. So nothing in a lane may be infinite or undefined,
 * were it multiplied by 0 or not.
 *
 * The order of the sums depends on the list, and so on the number of ranks, to rounding. */

/* R f^4 of tensCorr. The attraction of negative pressures is what pairs; the small repulsion of two
 * positive ones keeps lattices from forming along the force. f^4 falls from 1 at dp to 0 at 2 h. */
INLINE v4 tension(double epsilon, v4 A, v4 B, v4 f)
{
  const v4 zero = all(0.0), f2 = f * f;
  const v4 attraction = -epsilon * (smaller(A, zero) + smaller(B, zero));
  return where((A > zero) & (B > zero), 0.01 * (A + B), attraction) * (f2 * f2);
}

/* Pi of artVisc: s = h v.d / (r^2 + eta) counts only where v.d < 0, so that separating particles
 * feel nothing: smaller(v.d, 0) is s without a test. With one division for s and 2 / (rho_a +
 * rho_b): a1 = 2 alpha c h, b1 = 2 beta h^2. */
INLINE v4 artificial(v4 vd, v4 lengths, v4 densities, v4 a1, v4 b1)
{
  const v4 inverse = 1.0 / (lengths * densities);
  const v4 s = smaller(vd, all(0.0)) * densities * inverse;
  return s * (b1 * s - a1) * (lengths * inverse);
}

/* y = B d for B xx yy zz xy | xz yz in two blocks of four. */
INLINE void turn(const v4 B[8], const v4 d[3], v4 y[3])
{
  y[0] = B[0] * d[0] + B[3] * d[1] + B[4] * d[2];
  y[1] = B[3] * d[0] + B[1] * d[1] + B[5] * d[2];
  y[2] = B[4] * d[0] + B[5] * d[1] + B[2] * d[2];
}

/* B d for both of a pair, and d.B d / r^2 with the mean of the two. `order` points to the eight
 * columns of B in a row of 16. Where one of them is a wall, it has the B of the other. */
INLINE v4 corrected(const double *order, int i, const int j[4], const v4 d[3], v4 r2, v4 mine[3],
                    v4 theirs[3])
{
  v4 own[8], other[8], y[3];
  const v4 low = load(order + 16 * (size_t) i), high = load(order + 16 * (size_t) i + 4);
  gather_from(order, 16, j, other);
  gather_from(order + 4, 16, j, other + 4);
  for (int c = 0; c < 4; c++) {
    own[c] = all(low[c]);
    own[4 + c] = all(high[c]);
  }
  turn(own, d, mine);
  turn(other, d, y);
  const m4 wall_j = other[6] > 0.5, wall_i = own[6] > 0.5;
  v4 product = all(0.0);
  for (int c = 0; c < 3; c++) {
    theirs[c] = where(wall_j, mine[c], y[c]);
    mine[c] = where(wall_i, y[c], mine[c]);
    product += d[c] * (mine[c] + theirs[c]);
  }
  return 0.5 * product / r2;
}

INLINE double forces(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                     double *f4, double *each, terms has)
{
  const v4 zero = all(0.0), two = all(2.0);
  v4 nearest = all(HUGE_VAL);
  const int many = has.many, plain = has.scheme == SD_SPH_PLAIN;
  const int moving = has.artvisc || has.friction || has.rates || !plain;
  const int columns = has.scheme == SD_SPH_CORRECTION ? 16 : 8;
  for (int ii = 0; ii < list->n; ii++) {
    const int i = list->first[ii], count = list->count[i];
    const int *neighbor = list->neighbor[i];
    const v4 xi = load(p->x4 + 4 * (size_t) i);
    const v4 x = all(xi[0]), y = all(xi[1]), z = all(xi[2]), A = all(xi[3]);
    const v4 vi = moving ? load(p->v4 + 4 * (size_t) i) : zero;
    const v4 dui = has.scheme == SD_SPH_SHIFT ? load(p->order + 8 * (size_t) i + 4) : zero;
    const sd_sph_coefficients *row = ROW_OF(i);
    const v4 mi = all(many ? p->m[i] : p->mass);
    v4 sum[4] = {zero, zero, zero, zero};

    for (int at = 0; at < count; at += 4) {
      int j[4];
      next_four(neighbor, at, count, list->mask, p->n, j);
      v4 b[4];
      gather(p->x4, j, b);
      /* K and G end at q = 2 with the value 0: beyond, q = 2 will do. */
      const v4 d[3] = {x - b[0], y - b[1], z - b[2]};
      const v4 r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
      nearest = smaller(r2, nearest);
      const v4 inv_h = COEFFICIENT(inv_h);
      const v4 q = smaller(root(r2) * inv_h, two);
      const v4 g = COEFFICIENT(grad) * G(has.kernel, q), mm = mi * MASSES;
      v4 bracket = plain || has.scheme == SD_SPH_SHIFT ? A + b[3] : zero;
      v4 u[4], theirs[4], vd = zero, inverse = zero, rho = zero, ratio = all(1.0);
      if (moving) {
        gather(p->v4, j, theirs);
        for (int c = 0; c < 3; c++) u[c] = vi[c] - theirs[c];
        vd = u[0] * d[0] + u[1] * d[1] + u[2] * d[2];
        rho = theirs[3];
      }
      /* one division for all that has 1 / (rho_a rho_b) */
      if (!plain || has.friction) inverse = 1.0 / (vi[3] * rho);

      if (has.tenscorr)
        bracket += tension(model->epsilon, A, b[3], COEFFICIENT(tens) * K(has.kernel, q));
      if (has.scheme == SD_SPH_VOLUME)
        bracket = 2.0 * (rho * A + vi[3] * b[3]) * inverse / (vi[3] + rho);
      if (has.artvisc)
        bracket += artificial(vd, r2 + model->eta, vi[3] + rho, COEFFICIENT(a1), COEFFICIENT(b1));
      v4 mine[3], other[3];
      if (has.scheme == SD_SPH_CORRECTION)
        ratio = corrected(p->order + 8, i, j, d, r2, mine, other);
      /* Along d, so into the bracket, whose force has the factor - m m g. The factor D + 2 of
       * visc makes up for what lies across d. */
      if (has.friction == SD_SPH_CENTRAL)
        bracket -= COEFFICIENT(visc) * inverse * ratio * vd / (r2 + 0.001 / (inv_h * inv_h));
      const v4 fd = -mm * bracket * g;
      v4 F[4] = {fd * d[0], fd * d[1], fd * d[2], zero};
      if (has.friction == SD_SPH_LAPLACIAN) {
        const v4 fv = mm * COEFFICIENT(visc) * g * ratio * inverse;
        for (int c = 0; c < 3; c++) F[c] += fv * u[c];
      }
      /* V_a V_b rho_a = m_a m_b / rho_b: momentum that a takes away, and that b brings. */
      if (has.scheme == SD_SPH_SHIFT) {
        v4 du[4];
        gather_from(p->order + 4, columns, j, du);
        const v4 carry = mm * inverse * g;
        const v4 out = carry * vi[3] * (dui[0] * d[0] + dui[1] * d[1] + dui[2] * d[2]);
        const v4 in = carry * rho * (du[0] * d[0] + du[1] * d[1] + du[2] * d[2]);
        for (int c = 0; c < 3; c++) F[c] += out * vi[c] + in * theirs[c];
      }
      /* Whatever is antisymmetric is added to i and taken from j; the slope of P is not. */
      v4 on_j[4] = {F[0], F[1], F[2], zero};    // less the force on j
      if (has.scheme == SD_SPH_CORRECTION) {
        const v4 slope = -mm * inverse * (b[3] - A) * g;
        for (int c = 0; c < 3; c++) {
          F[c] += slope * mine[c];
          on_j[c] -= slope * other[c];
        }
      }
      for (int c = 0; c < 3; c++) sum[c] += F[c];
      if (has.rates) {
        const v4 w = g * vd;
        sum[3] += MASSES * w;
        on_j[3] = -mi * w;
      }
      if (each)
        for (int k = 0; k < 4 && at + k < count; k++)
          for (int c = 0; c < 3; c++) *each++ = 0.5 * (F[c][k] + on_j[c][k]);

      /* One after the other: a filler may be there more than once, and rows are whole vectors. */
      transpose(on_j);
      for (int k = 0; k < 4; k++) {
        double *fj = f4 + 4 * (size_t) j[k];
        store(fj, load(fj) - on_j[k]);
      }
    }
    add_lanes(f4 + 4 * (size_t) i, sum);
  }
  return fmin(fmin(nearest[0], nearest[1]), fmin(nearest[2], nearest[3]));
}

/* Appends those of j[0..3] to the list that are inside; the others are overwritten by the next. */
INLINE int *keep(int *last, const int j[4], m4 inside)
{
  for (int k = 0; k < 4; k++) {
    *last = j[k];
    last -= inside[k];
  }
  return last;
}

/* The near pairs of i to the end of the pool; returns its new end. Distances alone, so that the
 * sums, which cost more, come across no neighbour of the skin. */
INLINE int *pick(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                 int i, int *last, double margin, int many)
{
  const v4 xi = load(p->x4 + 4 * (size_t) i);
  const sd_sph_coefficients *row = ROW_OF(i);
  for (int at = 0; at < list->count[i]; at += 4) {
    int j[4];
    next_four(list->neighbor[i], at, list->count[i], list->mask, p->n, j);
    v4 b[4];
    gather(p->x4, j, b);
    const v4 dx = xi[0] - b[0], dy = xi[1] - b[1], dz = xi[2] - b[2];
    const v4 reach = COEFFICIENT(support) + margin;
    last = keep(last, j, dx * dx + dy * dy + dz * dz < reach * reach);
  }
  return last;
}

INLINE m4 phases(const int *phase, const int j[4])
{
  return (m4){phase[j[0]], phase[j[1]], phase[j[2]], phase[j[3]]};
}

INLINE m4 same(long long a)
{
  return (m4){a, a, a, a};
}

/* Four pairs of i: d = x_i - x_j, u = v_i - v_j. */
typedef struct {
  v4 d[3], u[3], rho_i, rho_j, g, near, f, speed;    // near: g, but 0 between two fluids
} pair_of_four;

/* The columns of sd_sph_sums.h without the factor that is different for i and j. */
/* grad_i W = g d. Under exchange of i and j, d and u change sign, g does not: what has two of them
 * or none is the same for both, s has one. M and the gradient of the density use `near`, so that
 * diffusion does not see the jump between two fluids. */
INLINE void columns_of(const pair_of_four *q, sd_sph_level level, v4 *column)
{
  const v4 *d = q->d, zero = all(0.0), jump = (q->rho_j - q->rho_i) * q->near;
  for (int c = 0; c < 3; c++) {
    column[1 + c] = jump * d[c];
    column[4 + c] = -q->near * d[c] * d[c];
  }
  column[7] = -q->near * d[0] * d[1];
  column[8] = -q->near * d[0] * d[2];
  column[9] = -q->near * d[1] * d[2];
  column[10] = column[11] = zero;
  if (level < SD_SPH_DISORDER) return;
  const v4 f2 = q->f * q->f, push = q->g * (1.0 + 0.2 * (f2 * f2));
  for (int c = 0; c < 3; c++) column[10 + c] = push * d[c];
  column[SD_SPH_MAXIMUM] = q->speed;
  column[14] = column[15] = zero;
  if (level < SD_SPH_VELOCITY) return;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) column[14 + 3 * a + b] = -q->g * q->u[a] * d[b];
  column[23] = zero;
}

/* Four columns of a row take those of one pair. The columns of i and j differ by factors: the
 * other's mass for the rate, +- the other's volume for the sums (s is odd in d), 0 for walls or 1
 * for the speed U, which is not added: the larger stays. */
INLINE v4 take(v4 row, int first, v4 columns, v4 factor)
{
  const v4 sum = row + columns * factor;
  if (first != (SD_SPH_MAXIMUM & ~3)) return sum;
  return where((m4){0, -1, 0, 0}, larger(row, columns * factor), sum);
}

/* The factors of the four columns from `first`; odd: volume for i, - volume for j. */
INLINE v4 factors(int first, v4 mass, v4 volume, v4 odd, v4 moves)
{
  if (first == 0) return where((m4){-1, 0, 0, 0}, mass, volume);
  if (first == 8) return where((m4){0, 0, -1, -1}, odd, volume);
  if (first == 12)
    return where((m4){0, -1, 0, 0}, moves, where((m4){-1, 0, 0, 0}, odd, volume));
  return volume;
}

/* The first pass of a step. With the rate alone it is one column, added to each j as a number; the
 * list of near pairs comes with it. With more, the near pairs are picked first (above), each pair
 * makes its columns, and they are added in blocks of four. */
INLINE void middle(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                   double *sums, const sd_sph_near *near, sd_sph_kernel kernel, int many,
                   sd_sph_level level, int volume)
{
  const v4 zero = all(0.0), two = all(2.0);
  const int columns = level == SD_SPH_RATE ? 1 : 8 + 4 * level + 4 * (level == SD_SPH_VELOCITY);
  const double margin = near ? near->margin : 0.0;
  int *pool = near ? near->pool : NULL;
  for (int ii = 0; ii < list->n; ii++) {
    const int i = list->first[ii];
    const v4 xi = load(p->x4 + 4 * (size_t) i), vi = load(p->v4 + 4 * (size_t) i);
    const v4 x = all(xi[0]), y = all(xi[1]), z = all(xi[2]);
    const sd_sph_coefficients *row = ROW_OF(i);
    const v4 mi = all(many ? p->m[i] : p->mass);
    const int phase = p->phase ? p->phase[i] : 0, picks = pool && level != SD_SPH_RATE;
    int *last = picks ? pick(model, list, p, i, pool, margin, many) : pool;
    const int *neighbor = picks ? pool : list->neighbor[i], mask = picks ? ~0 : list->mask;
    const int count = picks ? (int) (last - pool) : list->count[i];
    v4 rate = zero, mine[6] = {zero, zero, zero, zero, zero, zero}, factor_j[6];
    for (int first = 0; first < columns; first += 4)
      factor_j[first / 4] =
          factors(first, mi, all(xi[3]), all(-xi[3]), all(phase >= 0 ? 1.0 : 0.0));

    for (int at = 0; at < count; at += 4) {
      int j[4];
      next_four(neighbor, at, count, mask, p->n, j);
      v4 b[4], u[4];
      gather(p->x4, j, b);
      gather(p->v4, j, u);
      pair_of_four q = {.d = {x - b[0], y - b[1], z - b[2]}, .rho_i = all(vi[3]), .rho_j = u[3]};
      for (int c = 0; c < 3; c++) q.u[c] = vi[c] - u[c];
      const v4 inv_h = COEFFICIENT(inv_h);
      const v4 r = root(q.d[0] * q.d[0] + q.d[1] * q.d[1] + q.d[2] * q.d[2]), distance = r * inv_h;
      const v4 reach = smaller(distance, two);
      q.g = COEFFICIENT(grad) * G(kernel, reach);
      const v4 vd = q.d[0] * q.u[0] + q.d[1] * q.u[1] + q.d[2] * q.u[2];
      v4 w = q.g * vd, mass_j = MASSES, mass_i = mi;
      /* m_b w 2 rho_a / (rho_a + rho_b): the common part in w, the density in the factors. */
      if (volume) {
        w *= 2.0 / (vi[3] + u[3]);
        mass_j *= vi[3];
        mass_i *= u[3];
      }
      if (level == SD_SPH_RATE) {
        if (pool) last = keep(last, j, distance < two + margin * inv_h);
        rate += w * mass_j;
        for (int k = 0; k < 4; k++) sums[j[k]] += mass_i[k] * w[k];
        continue;
      }

      q.near = q.g;
      v4 moves = all(1.0);
      if (p->phase) {
        const m4 other = phases(p->phase, j);
        moves = where(other >= same(0), moves, zero);
        if (volume) q.near = where(other == same(phase), q.g * moves, zero);
      }
      if (level >= SD_SPH_DISORDER) {
        q.f = COEFFICIENT(tens) * K(kernel, reach);
        /* The filler is far away and rests, which is fast along d: only neighbours count. */
        q.speed = where(distance < two, larger(vd, -vd) / larger(r, all(1e-300)), zero);
      }
      /* Each pair's columns become a vector, so that the row of i is a few vectors too, and not a
       * vector for each column. */
      v4 column[24];
      column[0] = w;
      columns_of(&q, level, column);
#pragma GCC unroll 6
      for (int first = 0; first < columns; first += 4) {
        transpose(column + first);
        for (int k = 0; k < 4; k++) {
          const v4 V = all(b[3][k]);
          double *row_j = sums + (size_t) columns * j[k] + first;
          v4 of_j = factor_j[first / 4];
          if (volume && first == 0) of_j = factors(0, all(mass_i[k]), of_j, of_j, of_j);
          store(row_j, take(load(row_j), first, column[first + k], of_j));
          mine[first / 4] = take(mine[first / 4], first, column[first + k],
                                 factors(first, all(mass_j[k]), V, V, all(moves[k])));
        }
      }
    }
    double *row_i = sums + (size_t) columns * i;
    if (level == SD_SPH_RATE) *row_i += (rate[0] + rate[1]) + (rate[2] + rate[3]);
    if (level != SD_SPH_RATE)
      for (int first = 0; first < columns; first += 4)
        store(row_i + first, take(load(row_i + first), first, mine[first / 4], all(1.0)));
    if (pool) {
      near->neighbor[i] = pool;
      near->count[i] = (int) (last - pool);
      pool = last;
    }
  }
}

/* The second pass of a step with delta, when the gradients are known on both sides of each pair.
 * psi . grad W = -g (2 (rho_j - rho_i) + (grad rho_i + grad rho_j) . d), odd under exchange of i
 * and j. */
INLINE void diffusion(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                      double *rate, sd_sph_kernel kernel, int many)
{
  const v4 zero = all(0.0), two = all(2.0);
  const int columns = sd_sph_columns(model);
  for (int ii = 0; ii < list->n; ii++) {
    const int i = list->first[ii], count = list->count[i];
    const int *neighbor = list->neighbor[i];
    const v4 xi = load(p->x4 + 4 * (size_t) i), gi = load(p->order + (size_t) columns * i);
    const v4 x = all(xi[0]), y = all(xi[1]), z = all(xi[2]);
    const sd_sph_coefficients *row = ROW_OF(i);
    const int phase = p->phase ? p->phase[i] : 0;
    if (phase < 0) continue;
    v4 sum = zero;

    for (int at = 0; at < count; at += 4) {
      int j[4];
      next_four(neighbor, at, count, list->mask, p->n, j);
      v4 b[4], gj[4];
      gather(p->x4, j, b);
      gather_from(p->order, columns, j, gj);
      const v4 dx = x - b[0], dy = y - b[1], dz = z - b[2];
      const v4 q = smaller(root(dx * dx + dy * dy + dz * dz) * COEFFICIENT(inv_h), two);
      v4 g = COEFFICIENT(grad) * G(kernel, q);
      if (p->phase) g = where(phases(p->phase, j) == same(phase), g, zero);
      const v4 along = (gi[0] + gj[0]) * dx + (gi[1] + gj[1]) * dy + (gi[2] + gj[2]) * dz;
      const v4 flux = -COEFFICIENT(diffusion) * g * (2.0 * (gj[3] - gi[3]) + along);
      sum += b[3] * flux;
      for (int k = 0; k < 4; k++) rate[j[k]] -= xi[3] * flux[k];
    }
    rate[i] += (sum[0] + sum[1]) + (sum[2] + sum[3]);
  }
}

/* W is the same for i and j, so each takes the other's row times W. Between a fluid and its walls
 * four neighbours of the same kind as i, most of them, cost no kernel. */
INLINE void weigh(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                  const double *q, double *sums, sd_sph_kernel kernel, int many, int fours,
                  int walls)
{
  const v4 zero = all(0.0), two = all(2.0);
  const int columns = 4 * fours;
  for (int ii = 0; ii < list->n; ii++) {
    const int i = list->first[ii], count = list->count[i];
    const int *neighbor = list->neighbor[i];
    const v4 xi = load(p->x4 + 4 * (size_t) i);
    const v4 x = all(xi[0]), y = all(xi[1]), z = all(xi[2]);
    const sd_sph_coefficients *row = ROW_OF(i);
    v4 sum[8];
    for (int c = 0; c < columns; c++) sum[c] = zero;

    for (int at = 0; at < count; at += 4) {
      int j[4];
      next_four(neighbor, at, count, list->mask, p->n, j);
      m4 counts = same(-1);
      if (walls) {
        counts = phases(p->phase, j) == same(~p->phase[i]);
        if (!(counts[0] | counts[1] | counts[2] | counts[3])) continue;
      }
      v4 b[4];
      gather(p->x4, j, b);
      const v4 dx = x - b[0], dy = y - b[1], dz = z - b[2];
      const v4 distance = smaller(root(dx * dx + dy * dy + dz * dz) * COEFFICIENT(inv_h), two);
      v4 W = COEFFICIENT(weight) * K(kernel, distance);
      if (walls) W = where(counts, W, zero);
      for (int first = 0; first < columns; first += 4) {
        const v4 qi = load(q + (size_t) columns * i + first);
        v4 qj[4];
        gather_from(q + first, columns, j, qj);
        for (int c = 0; c < 4; c++) sum[first + c] += W * qj[c];
        for (int k = 0; k < 4; k++) {
          double *row_j = sums + (size_t) columns * j[k] + first;
          store(row_j, load(row_j) + W[k] * qi);
        }
      }
    }
    for (int first = 0; first < columns; first += 4)
      add_lanes(sums + (size_t) columns * i + first, sum + first);
  }
}

/* What a scene asks for picks one of many copies. Each is a function of its own, since a compiler
 * takes minutes over one function that has them all. A table lists them in the order in which these
 * macros make them: its index has a bit for each choice, the first one highest. */
#define TWICE(next, ...) next(__VA_ARGS__, 0) next(__VA_ARGS__, 1)
/* All copies of a loop for the two kernels, each for one class and for many. */
#define BY_KERNEL(next, ...)                                           \
  TWICE(next, __VA_ARGS__, SD_SPH_CUBICSPLINE) TWICE(next, __VA_ARGS__, SD_SPH_WENDLAND)
#define BY_ARTVISC(next, ...) BY_KERNEL(next, __VA_ARGS__, 0) BY_KERNEL(next, __VA_ARGS__, 1)
#define BY_TENSCORR(next, ...) BY_ARTVISC(next, __VA_ARGS__, 0) BY_ARTVISC(next, __VA_ARGS__, 1)
#define BY_FRICTION(next, ...) BY_TENSCORR(next, __VA_ARGS__, 0) BY_TENSCORR(next, __VA_ARGS__, 1)
#define BY_RATES(next) BY_FRICTION(next, 0) BY_FRICTION(next, 1)

static int kernel_copy(const sd_sph_model *model)
{
  return 2 * model->kernel + (model->nclasses > 1);
}

#define FORCES(name, ...)                                                                         \
  static double name(const sd_sph_model *model, const sd_sph_list *list,                          \
                     const sd_sph_particles *p, double *f4, double *each)                         \
  {                                                                                               \
    return forces(model, list, p, f4, each, (terms) __VA_ARGS__);                                 \
  }
#define PLAIN_NAME(rates, rubs, tenscorr, artvisc, kernel, many) \
  plain_##rates##rubs##tenscorr##artvisc##kernel##many
#define PLAIN(rates, rubs, tenscorr, artvisc, kernel, many)                                       \
  FORCES(PLAIN_NAME(rates, rubs, tenscorr, artvisc, kernel, many),                                \
         {kernel, many, artvisc, tenscorr, rates, rubs ? model->friction : SD_SPH_INVISCID,       \
          SD_SPH_PLAIN})
#define PLAIN_ENTRY(...) PLAIN_NAME(__VA_ARGS__),
/* The schemes beyond the plain one have no tensCorr and no rates, and look at the model for the
 * terms. */
#define SCHEME(scheme, kernel, many)                                                              \
  FORCES(scheme##kernel##many,                                                                    \
         {kernel, many, model->artvisc, 0, 0, model->friction, scheme})
#define SCHEME_ENTRY(scheme, kernel, many) scheme##kernel##many,
BY_RATES(PLAIN)
BY_KERNEL(SCHEME, SD_SPH_SHIFT)
BY_KERNEL(SCHEME, SD_SPH_CORRECTION)
BY_KERNEL(SCHEME, SD_SPH_VOLUME)

static double all_forces(const sd_sph_model *model, const sd_sph_list *list,
                         const sd_sph_particles *p, int with_rates, double *f4, double *each)
{
  typedef double copy(const sd_sph_model *, const sd_sph_list *, const sd_sph_particles *, double *,
                      double *);
  static copy *const plain[] = {BY_RATES(PLAIN_ENTRY)};
  static copy *const scheme[][4] = {
      [SD_SPH_SHIFT] = {BY_KERNEL(SCHEME_ENTRY, SD_SPH_SHIFT)},
      [SD_SPH_CORRECTION] = {BY_KERNEL(SCHEME_ENTRY, SD_SPH_CORRECTION)},
      [SD_SPH_VOLUME] = {BY_KERNEL(SCHEME_ENTRY, SD_SPH_VOLUME)}};
  const int has = 8 * !!with_rates + 4 * !!model->friction + 2 * !!model->tenscorr +
      !!model->artvisc;
  copy *const chosen = model->scheme == SD_SPH_PLAIN
      ? plain[4 * has + kernel_copy(model)]
      : scheme[model->scheme][kernel_copy(model)];
  return chosen(model, list, p, f4, each);
}

#define LEVEL(level, volume, kernel, many)                                                        \
  static void level##volume##kernel##many(const sd_sph_model *model, const sd_sph_list *list,     \
                                          const sd_sph_particles *p, double *sums,                \
                                          const sd_sph_near *near)                                \
  {                                                                                               \
    middle(model, list, p, sums, near, kernel, many, level, volume);                              \
  }
#define LEVEL_ENTRY(level, volume, kernel, many) level##volume##kernel##many,
/* Volume has neither shift nor correction. */
BY_KERNEL(LEVEL, SD_SPH_RATE, 0)
BY_KERNEL(LEVEL, SD_SPH_RATE, 1)
BY_KERNEL(LEVEL, SD_SPH_GRADIENT, 0)
BY_KERNEL(LEVEL, SD_SPH_GRADIENT, 1)
BY_KERNEL(LEVEL, SD_SPH_DISORDER, 0)
BY_KERNEL(LEVEL, SD_SPH_VELOCITY, 0)

static void all_middle(const sd_sph_model *model, const sd_sph_list *list,
                       const sd_sph_particles *p, double *sums, const sd_sph_near *near)
{
  typedef void copy(const sd_sph_model *, const sd_sph_list *, const sd_sph_particles *, double *,
                    const sd_sph_near *);
  static copy *const copies[][2][4] = {
      [SD_SPH_RATE] = {{BY_KERNEL(LEVEL_ENTRY, SD_SPH_RATE, 0)},
                       {BY_KERNEL(LEVEL_ENTRY, SD_SPH_RATE, 1)}},
      [SD_SPH_GRADIENT] = {{BY_KERNEL(LEVEL_ENTRY, SD_SPH_GRADIENT, 0)},
                           {BY_KERNEL(LEVEL_ENTRY, SD_SPH_GRADIENT, 1)}},
      [SD_SPH_DISORDER] = {{BY_KERNEL(LEVEL_ENTRY, SD_SPH_DISORDER, 0)}},
      [SD_SPH_VELOCITY] = {{BY_KERNEL(LEVEL_ENTRY, SD_SPH_VELOCITY, 0)}}};
  const int volume = model->scheme == SD_SPH_VOLUME;
  copies[sd_sph_level_of(model)][volume][kernel_copy(model)](model, list, p, sums, near);
}

#define DIFFUSION(ignored, kernel, many)                  \
  case ((kernel) << 1) + (many):                          \
    diffusion(model, list, p, rate, kernel, many);        \
    break;

static void all_diffusion(const sd_sph_model *model, const sd_sph_list *list,
                          const sd_sph_particles *p, double *rate)
{
  switch (kernel_copy(model)) {
    BY_KERNEL(DIFFUSION, 0)
  }
}

#define WEIGH(fours, walls, kernel, many)                                    \
  case ((fours) << 3) + ((walls) << 2) + ((kernel) << 1) + (many):           \
    weigh(model, list, p, q, sums, kernel, many, fours, walls);              \
    break;

static void all_weigh(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                      int fours, int walls, const double *q, double *sums)
{
  switch ((fours << 3) + (walls << 2) + kernel_copy(model)) {
    BY_KERNEL(WEIGH, 1, 0)
    BY_KERNEL(WEIGH, 2, 1)
  }
}

const sd_sph_loops LOOPS = {all_forces, all_middle, all_diffusion, all_weigh};
