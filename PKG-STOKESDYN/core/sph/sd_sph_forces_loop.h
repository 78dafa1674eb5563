/* The force on each particle, over a half list. */
#ifndef SD_SPH_FORCES_LOOP_H
#define SD_SPH_FORCES_LOOP_H

#include "sd_sph_neighbours.h"

/* What a scene asks for. In copies of a loop for the plain scheme all are constants; the others
 * branch on the terms of the force, the same way for every pair. many: classes. */
typedef struct {
  sd_sph_kernel kernel;
  int many, artvisc, tenscorr, rates;
  sd_sph_friction friction;
  sd_sph_scheme scheme;
} terms;

/* R f^4 of tensCorr. The attraction of negative pressures is what pairs; the small repulsion of two
 * positive ones keeps lattices from forming along the force. f^4 falls from 1 at dp to 0 at 2 h. */
INLINE vec tension(double epsilon, vec A, vec B, vec f)
{
  const vec zero = all(0.0), f2 = f * f;
  const vec attraction = -epsilon * (smaller(A, zero) + smaller(B, zero));
  return where((A > zero) & (B > zero), 0.01 * (A + B), attraction) * (f2 * f2);
}

/* Pi of artVisc: s = h v.d / (r^2 + eta) counts only where v.d < 0, so that separating particles
 * feel nothing: smaller(v.d, 0) is s without a test. With one division for s and 2 / (rho_a +
 * rho_b): a1 = 2 alpha c h, b1 = 2 beta h^2. */
INLINE vec artificial(vec vd, vec lengths, vec densities, vec a1, vec b1)
{
  const vec inverse = 1.0 / (lengths * densities);
  const vec s = smaller(vd, all(0.0)) * densities * inverse;
  return s * (b1 * s - a1) * (lengths * inverse);
}

/* y = B d for B xx yy zz xy | xz yz in two blocks of four. */
INLINE void turn(const vec B[8], const vec d[3], vec y[3])
{
  y[0] = B[0] * d[0] + B[3] * d[1] + B[4] * d[2];
  y[1] = B[3] * d[0] + B[1] * d[1] + B[5] * d[2];
  y[2] = B[4] * d[0] + B[5] * d[1] + B[2] * d[2];
}

/* B d for both of a pair, and d.B d / r^2 with the mean of the two. `order` points to the eight
 * columns of B in a row of 16. Where one of them is a wall, it has the B of the other. */
INLINE vec corrected(const double *order, int i, const int j[LANES], const vec d[3], vec r2,
                     vec mine[3], vec theirs[3])
{
  vec own[8], other[8], y[3];
  const row4 low = load(order + 16 * (size_t) i), high = load(order + 16 * (size_t) i + 4);
  gather_from(order, 16, j, other);
  gather_from(order + 4, 16, j, other + 4);
  for (int c = 0; c < 4; c++) {
    own[c] = all(low[c]);
    own[4 + c] = all(high[c]);
  }
  turn(own, d, mine);
  turn(other, d, y);
  const yes_no wall_j = other[6] > 0.5, wall_i = own[6] > 0.5;
  vec product = all(0.0);
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
  const vec zero = all(0.0), two = all(2.0);
  vec nearest = all(HUGE_VAL);
  const int many = has.many, plain = has.scheme == SD_SPH_PLAIN;
  const int moving = has.artvisc || has.friction || has.rates || !plain;
  const int columns = has.scheme == SD_SPH_CORRECTION ? 16 : 8;
  for (int ii = 0; ii < list->n; ii++) {
    const int i = list->first[ii], count = list->count[i];
    const int *neighbor = list->neighbor[i];
    const row4 xi = load(p->x4 + 4 * (size_t) i);
    const vec x = all(xi[0]), y = all(xi[1]), z = all(xi[2]), A = all(xi[3]);
    const row4 vi = moving ? load(p->v4 + 4 * (size_t) i) : (row4){0};
    const row4 dui = has.scheme == SD_SPH_SHIFT ? load(p->order + 8 * (size_t) i + 4) : (row4){0};
    const sd_sph_coefficients *row = ROW_OF(i);
    const vec mi = all(many ? p->m[i] : p->mass);
    vec sum[4] = {zero, zero, zero, zero};

    for (int at = 0; at < count; at += LANES) {
      int j[LANES];
      next(neighbor + at, count - at, list->mask, p->n, j);
      vec b[4];
      gather(p->x4, j, b);
      /* K and G end at q = 2 with the value 0: beyond, q = 2 will do. */
      const vec d[3] = {x - b[0], y - b[1], z - b[2]};
      const vec r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
      nearest = smaller(r2, nearest);
      const vec inv_h = COEFFICIENT(inv_h);
      const vec q = smaller(root(r2) * inv_h, two);
      const vec g = COEFFICIENT(grad) * G(has.kernel, q), mm = mi * MASSES;
      vec bracket = plain || has.scheme == SD_SPH_SHIFT ? A + b[3] : zero;
      vec u[4], theirs[4], vd = zero, inverse = zero, rho = zero, ratio = all(1.0);
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
      vec mine[3], other[3];
      if (has.scheme == SD_SPH_CORRECTION)
        ratio = corrected(p->order + 8, i, j, d, r2, mine, other);
      /* Along d, so into the bracket, whose force has the factor - m m g. The factor D + 2 of
       * visc makes up for what lies across d. */
      if (has.friction == SD_SPH_CENTRAL)
        bracket -= COEFFICIENT(visc) * inverse * ratio * vd / (r2 + 0.001 / (inv_h * inv_h));
      const vec fd = -mm * bracket * g;
      vec F[4] = {fd * d[0], fd * d[1], fd * d[2], zero};
      if (has.friction == SD_SPH_LAPLACIAN) {
        const vec fv = mm * COEFFICIENT(visc) * g * ratio * inverse;
        for (int c = 0; c < 3; c++) F[c] += fv * u[c];
      }
      /* V_a V_b rho_a = m_a m_b / rho_b: momentum that a takes away, and that b brings. */
      if (has.scheme == SD_SPH_SHIFT) {
        vec du[4];
        gather_from(p->order + 4, columns, j, du);
        const vec carry = mm * inverse * g;
        const vec out = carry * vi[3] * (dui[0] * d[0] + dui[1] * d[1] + dui[2] * d[2]);
        const vec in = carry * rho * (du[0] * d[0] + du[1] * d[1] + du[2] * d[2]);
        for (int c = 0; c < 3; c++) F[c] += out * vi[c] + in * theirs[c];
      }
      /* Whatever is antisymmetric is added to i and taken from j; the slope of P is not. */
      vec on_j[4] = {F[0], F[1], F[2], zero};    // less the force on j
      if (has.scheme == SD_SPH_CORRECTION) {
        const vec slope = -mm * inverse * (b[3] - A) * g;
        for (int c = 0; c < 3; c++) {
          F[c] += slope * mine[c];
          on_j[c] -= slope * other[c];
        }
      }
      for (int c = 0; c < 3; c++) sum[c] += F[c];
      if (has.rates) {
        const vec w = g * vd;
        sum[3] += MASSES * w;
        on_j[3] = -mi * w;
      }
      if (each)
        for (int k = 0; k < LANES && at + k < count; k++)
          for (int c = 0; c < 3; c++) *each++ = 0.5 * (F[c][k] + on_j[c][k]);

      take_from(f4, j, on_j);
    }
    double *fi = f4 + 4 * (size_t) i;
    store(fi, load(fi) + over_lanes(sum));
  }
  return least_of(nearest);
}

#endif
