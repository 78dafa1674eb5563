/* The loops of sd_sph_pair.h, compiled once for each instruction set by the two files that include
 * this one and define LOOPS. Four pairs are a vector; what a scene does not ask for is a constant 0
 * in its copy of the loop, so the compiler drops it. */
#include "sd_sph_pair.h"

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

INLINE v4 root(v4 a)
{
  return (v4){sqrt(a[0]), sqrt(a[1]), sqrt(a[2]), sqrt(a[3])};
}

INLINE void transpose(v4 r[4])
{
  const v4 a = SHUFFLE(r[0], r[1], 0, 4, 2, 6), b = SHUFFLE(r[0], r[1], 1, 5, 3, 7);
  const v4 c = SHUFFLE(r[2], r[3], 0, 4, 2, 6), d = SHUFFLE(r[2], r[3], 1, 5, 3, 7);
  r[0] = SHUFFLE(a, c, 0, 1, 4, 5);
  r[1] = SHUFFLE(b, d, 0, 1, 4, 5);
  r[2] = SHUFFLE(a, c, 2, 3, 6, 7);
  r[3] = SHUFFLE(b, d, 2, 3, 6, 7);
}

/* Column c of rows j[0..3] becomes r[c]. */
INLINE void gather(const double *rows, const int j[4], v4 r[4])
{
  for (int k = 0; k < 4; k++) r[k] = load(rows + 4 * (size_t) j[k]);
  transpose(r);
}

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

INLINE void next_four(const int *neighbor, int at, int count, int mask, int filler, int j[4])
{
  for (int k = 0; k < 4; k++) j[k] = at + k < count ? neighbor[at + k] & mask : filler;
}

/* What a scene asks for: constants of one copy of the loop. many: classes. */
typedef struct {
  sd_sph_kernel kernel;
  int many, artvisc, tenscorr, viscous, rates;
} terms;

/* R f^4 of tensCorr. */
INLINE v4 tension(double epsilon, v4 A, v4 B, v4 f)
{
  const v4 zero = all(0.0), f2 = f * f;
  const v4 attraction = -epsilon * (smaller(A, zero) + smaller(B, zero));
  return where((A > zero) & (B > zero), 0.01 * (A + B), attraction) * (f2 * f2);
}

/* Pi of artVisc, with one division for s and 2 / (rho_a + rho_b): a1 = 2 alpha c h, b1 = 2 beta
 * h^2. */
INLINE v4 friction(v4 vd, v4 lengths, v4 densities, v4 a1, v4 b1)
{
  const v4 inverse = 1.0 / (lengths * densities);
  const v4 s = smaller(vd, all(0.0)) * densities * inverse;
  return s * (b1 * s - a1) * (lengths * inverse);
}

INLINE double forces(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                     double *f4, double *each, terms has)
{
  const v4 zero = all(0.0), two = all(2.0);
  v4 nearest = all(HUGE_VAL);
  const int many = has.many, moving = has.artvisc || has.viscous || has.rates;
  for (int ii = 0; ii < list->n; ii++) {
    const int i = list->first[ii], count = list->count[i];
    const int *neighbor = list->neighbor[i];
    const v4 xi = load(p->x4 + 4 * (size_t) i);
    const v4 x = all(xi[0]), y = all(xi[1]), z = all(xi[2]), A = all(xi[3]);
    const v4 vi = moving ? load(p->v4 + 4 * (size_t) i) : zero;
    const sd_sph_coefficients *row =
        model->pair + (many ? (size_t) p->cls[i] * model->nclasses : 0);
    const v4 mi = all(many ? p->m[i] : p->mass);
    v4 sum[4] = {zero, zero, zero, zero};

    for (int at = 0; at < count; at += 4) {
      int j[4];
      next_four(neighbor, at, count, list->mask, p->n, j);
      v4 b[4];
      gather(p->x4, j, b);
      const v4 dx = x - b[0], dy = y - b[1], dz = z - b[2];
      const v4 r2 = dx * dx + dy * dy + dz * dz;
      nearest = smaller(r2, nearest);
      const v4 inv_h = COEFFICIENT(inv_h);
      const v4 q = smaller(root(r2) * inv_h, two);
      const v4 g = COEFFICIENT(grad) * G(has.kernel, q);
      const v4 mj = many ? (v4){p->m[j[0]], p->m[j[1]], p->m[j[2]], p->m[j[3]]} : mi;
      v4 bracket = A + b[3];

      if (has.tenscorr)
        bracket += tension(model->epsilon, A, b[3], COEFFICIENT(tens) * K(has.kernel, q));
      v4 u[4], vd = zero;
      if (moving) {
        gather(p->v4, j, u);
        for (int c = 0; c < 3; c++) u[c] = vi[c] - u[c];
        vd = u[0] * dx + u[1] * dy + u[2] * dz;
      }
      if (has.artvisc)
        bracket += friction(vd, r2 + model->eta, vi[3] + u[3], COEFFICIENT(a1),
                            COEFFICIENT(b1));
      const v4 fd = -mi * mj * bracket * g;
      v4 F[4] = {fd * dx, fd * dy, fd * dz, zero};
      if (has.viscous) {
        const v4 fv = mi * mj * COEFFICIENT(visc) * g / (vi[3] * u[3]);
        for (int c = 0; c < 3; c++) F[c] += fv * u[c];
      }
      for (int c = 0; c < 3; c++) sum[c] += F[c];
      if (has.rates) {
        const v4 w = g * vd;
        sum[3] += mj * w;
        F[3] = -mi * w;
      }
      if (each)
        for (int k = 0; k < 4 && at + k < count; k++)
          for (int c = 0; c < 3; c++) *each++ = F[c][k];

      transpose(F);
      for (int k = 0; k < 4; k++) {
        double *fj = f4 + 4 * (size_t) j[k];
        store(fj, load(fj) - F[k]);
      }
    }
    transpose(sum);
    double *fi = f4 + 4 * (size_t) i;
    store(fi, load(fi) + ((sum[0] + sum[1]) + (sum[2] + sum[3])));
  }
  return fmin(fmin(nearest[0], nearest[1]), fmin(nearest[2], nearest[3]));
}

INLINE void rates(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                  double *rate, const sd_sph_near *near, sd_sph_kernel kernel, int many)
{
  const v4 zero = all(0.0), two = all(2.0);
  const double margin = near ? near->margin : 0.0;
  int *pool = near ? near->pool : NULL;
  for (int ii = 0; ii < list->n; ii++) {
    const int i = list->first[ii], count = list->count[i];
    const int *neighbor = list->neighbor[i];
    const v4 xi = load(p->x4 + 4 * (size_t) i), vi = load(p->v4 + 4 * (size_t) i);
    const v4 x = all(xi[0]), y = all(xi[1]), z = all(xi[2]);
    const sd_sph_coefficients *row =
        model->pair + (many ? (size_t) p->cls[i] * model->nclasses : 0);
    const double mi = many ? p->m[i] : p->mass;
    v4 sum = zero;
    int *last = pool;

    for (int at = 0; at < count; at += 4) {
      int j[4];
      next_four(neighbor, at, count, list->mask, p->n, j);
      v4 b[4], u[4];
      gather(p->x4, j, b);
      gather(p->v4, j, u);
      const v4 dx = x - b[0], dy = y - b[1], dz = z - b[2];
      const v4 inv_h = COEFFICIENT(inv_h);
      const v4 distance = root(dx * dx + dy * dy + dz * dz) * inv_h;
      const v4 w = COEFFICIENT(grad) * G(kernel, smaller(distance, two)) *
          (dx * (vi[0] - u[0]) + dy * (vi[1] - u[1]) + dz * (vi[2] - u[2]));
      sum += many ? w * (v4){p->m[j[0]], p->m[j[1]], p->m[j[2]], p->m[j[3]]} : w * mi;
      for (int k = 0; k < 4; k++) rate[j[k]] += mi * w[k];
      if (pool) {
        const m4 inside = distance < two + margin * inv_h;
        for (int k = 0; k < 4; k++) {
          *last = j[k];
          last -= inside[k];
        }
      }
    }
    rate[i] += (sum[0] + sum[1]) + (sum[2] + sum[3]);
    if (pool) {
      near->neighbor[i] = pool;
      near->count[i] = (int) (last - pool);
      pool = last;
    }
  }
}

/* One function for each combination; the switch picks it once a step. */
#define COMBINATION(kernel, many, artvisc, tenscorr, viscous, with_rates)                          \
  case ((kernel) << 5) + ((many) << 4) + ((artvisc) << 3) + ((tenscorr) << 2) + ((viscous) << 1) + \
      (with_rates):                                                                                \
    return forces(model, list, p, f4, each,                                                        \
                  (terms){kernel, many, artvisc, tenscorr, viscous, with_rates});
#define TWICE(next, ...) next(__VA_ARGS__, 0) next(__VA_ARGS__, 1)
#define BY_VISCOUS(...) TWICE(COMBINATION, __VA_ARGS__, 0) TWICE(COMBINATION, __VA_ARGS__, 1)
#define BY_TENSCORR(...) BY_VISCOUS(__VA_ARGS__, 0) BY_VISCOUS(__VA_ARGS__, 1)
#define BY_ARTVISC(...) BY_TENSCORR(__VA_ARGS__, 0) BY_TENSCORR(__VA_ARGS__, 1)
#define BY_MANY(kernel) BY_ARTVISC(kernel, 0) BY_ARTVISC(kernel, 1)

static double all_forces(const sd_sph_model *model, const sd_sph_list *list,
                         const sd_sph_particles *p, int with_rates, double *f4, double *each)
{
  switch ((model->kernel << 5) + ((model->nclasses > 1) << 4) + (!!model->artvisc << 3) +
          (!!model->tenscorr << 2) + (!!model->viscous << 1) + !!with_rates) {
    BY_MANY(SD_SPH_CUBICSPLINE)
    BY_MANY(SD_SPH_WENDLAND)
  }
  return 0.0;
}

static void all_rates(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                      double *rate, const sd_sph_near *near)
{
  switch ((model->kernel << 1) + (model->nclasses > 1)) {
    case SD_SPH_CUBICSPLINE << 1:
      rates(model, list, p, rate, near, SD_SPH_CUBICSPLINE, 0);
      break;
    case (SD_SPH_CUBICSPLINE << 1) + 1:
      rates(model, list, p, rate, near, SD_SPH_CUBICSPLINE, 1);
      break;
    case SD_SPH_WENDLAND << 1:
      rates(model, list, p, rate, near, SD_SPH_WENDLAND, 0);
      break;
    case (SD_SPH_WENDLAND << 1) + 1:
      rates(model, list, p, rate, near, SD_SPH_WENDLAND, 1);
      break;
  }
}

const sd_sph_loops LOOPS = {all_forces, all_rates};
