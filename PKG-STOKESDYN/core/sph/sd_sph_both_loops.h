/* Sums over a list both ways: the middle of a step with delta, shift or correction. */
#ifndef SD_SPH_BOTH_LOOPS_H
#define SD_SPH_BOTH_LOOPS_H

#include "sd_sph_neighbours.h"

/* Pairs of i: d = x_i - x_j, u = v_i - v_j, V = m_j / rho_j. */
typedef struct {
  vec d[3], u[3], V, rho_i, rho_j, g, near, f, speed;    // near: g, but 0 between two fluids
} pairs_with_sums;

/* Adds to the columns of sd_sph_sums.h but the rate. grad_i W = g d. M and the gradient of the
 * density use `near`, so that diffusion does not see the jump between two fluids. */
INLINE void add_columns(const pairs_with_sums *q, sd_sph_level level, vec *sum)
{
  const vec *d = q->d, near = q->near * q->V, jump = (q->rho_j - q->rho_i) * near;
  const vec nx = near * d[0], ny = near * d[1];
  for (int c = 0; c < 3; c++) sum[1 + c] += jump * d[c];
  sum[4] -= nx * d[0];
  sum[5] -= ny * d[1];
  sum[6] -= near * d[2] * d[2];
  sum[7] -= nx * d[1];
  sum[8] -= nx * d[2];
  sum[9] -= ny * d[2];
  if (level < SD_SPH_DISORDER) return;
  const vec f2 = q->f * q->f, gV = q->g * q->V, push = gV * (1.0 + 0.2 * (f2 * f2));
  for (int c = 0; c < 3; c++) sum[10 + c] += push * d[c];
  sum[SD_SPH_MAXIMUM] = larger(q->speed, sum[SD_SPH_MAXIMUM]);
  if (level < SD_SPH_VELOCITY) return;
  for (int a = 0; a < 3; a++) {
    const vec gu = gV * q->u[a];
    for (int b = 0; b < 3; b++) sum[14 + 3 * a + b] -= gu * d[b];
  }
  if (level < SD_SPH_MIXTURE) return;
  const vec gx = gV * d[0], gy = gV * d[1];
  sum[24] -= gx * d[0];
  sum[25] -= gy * d[1];
  sum[26] -= gV * d[2] * d[2];
  sum[27] -= gx * d[1];
  sum[28] -= gx * d[2];
  sum[29] -= gy * d[2];
}

/* The row of a particle from the sums in lanes. */
INLINE void store_columns(double *row, int columns, vec *sum)
{
  const double largest = columns > SD_SPH_MAXIMUM ? largest_of(sum[SD_SPH_MAXIMUM]) : 0.0;
  for (int first = 0; first < columns; first += 4) store4(row + first, over_lanes(sum + first));
  if (columns > SD_SPH_MAXIMUM) row[SD_SPH_MAXIMUM] = largest;
}

COPIED void middle(const sd_sph_model *model, const sd_sph_both *list, const sd_sph_particles *p,
                   double *sums, const sd_sph_near *near, sd_sph_level level, sd_sph_kernel kernel,
                   int many)
{
  const int volume = sd_sph_of_fluids(model), fluids = volume && p->phase;
  const vec zero = all(0.0), two = all(2.0);
  const int columns = level == SD_SPH_MIXTURE ? 32
      : level == SD_SPH_VELOCITY              ? 24
                                              : 8 + 4 * level;
  int *last = near->pool;
  for (int i = 0; i < list->n; i++) {
    const row4 xi = load4(p->x4 + 4 * (size_t) i), vi = load4(p->v4 + 4 * (size_t) i);
    const sd_sph_coefficients *row = ROW_OF(i);
    const vec mi = all(many ? p->m[i] : p->mass);
    const int phase = fluids ? p->phase[i] : 0, own = list->own[i];
    vec sum[32];
    for (int c = 0; c < columns; c++) sum[c] = zero;
    near->neighbor[i] = last;

    for (int at = 0; at < list->count[i]; at += LANES) {
      const int *j = list->neighbor[i] + at;
      const places x = from(p->x4, j, xi);
      vec u[4], vd = zero;
      gather(p->v4, 4, j, u);
      pairs_with_sums q = {.V = larger(x.last, -x.last), .rho_i = all(vi[3]), .rho_j = u[3]};
      for (int c = 0; c < 3; c++) {
        q.d[c] = x.d[c];
        q.u[c] = vi[c] - u[c];
        vd += q.d[c] * q.u[c];
      }
      const vec inv_h = COEFFICIENT(inv_h), r = root(x.r2), distance = smaller(r * inv_h, two);
      const unsigned closer = bits(r * inv_h < two + near->margin * inv_h);
      if (own >= at && own < at + LANES)
        near->own[i] = (int) (last - near->neighbor[i]) +
            __builtin_popcount(closer & neighbours_of(own - at));
      last += keep(last, j, closer);
      q.g = COEFFICIENT(grad) * G(kernel, distance);
      vec w = MASSES * q.g * vd;
      if (volume) w *= 2.0 * vi[3] / (vi[3] + u[3]);
      sum[0] += w;

      q.near = q.g;
      const yes_no moves = x.last > zero;    // the filler does not
      if (fluids) q.near = where(moves & (phases(p->phase, j) == same(phase)), q.g, zero);
      if (level >= SD_SPH_DISORDER) {
        q.f = COEFFICIENT(tens) * K(kernel, distance);
        q.speed = where(moves & (distance < two), larger(vd, -vd) / larger(r, all(1e-300)), zero);
      }
      add_columns(&q, level, sum);
    }
    if (own == list->count[i]) near->own[i] = (int) (last - near->neighbor[i]);
    while ((last - near->neighbor[i]) % SD_SPH_LANES) *last++ = p->n;
    near->count[i] = (int) (last - near->neighbor[i]);
    store_columns(sums + (size_t) columns * i, columns, sum);
  }
}

/* The second pass of a step with delta, when the gradients are known on both sides of each pair.
 * psi . grad W = -g (2 (rho_j - rho_i) + (grad rho_i + grad rho_j) . d). */
COPIED void diffusion(const sd_sph_model *model, const sd_sph_both *list, const sd_sph_particles *p,
                      double *rate, sd_sph_kernel kernel, int many)
{
  const int fluids = sd_sph_of_fluids(model) && p->phase;
  const vec zero = all(0.0), two = all(2.0);
  for (int i = 0; i < list->n; i++) {
    const row4 xi = load4(p->x4 + 4 * (size_t) i), gi = load4(p->slope + 4 * (size_t) i);
    const sd_sph_coefficients *row = ROW_OF(i);
    const int phase = p->phase ? p->phase[i] : 0;
    if (phase < 0) continue;
    vec sum = zero;

    for (int at = 0; at < list->count[i]; at += LANES) {
      const int *j = list->neighbor[i] + at;
      const places x = from(p->x4, j, xi);
      vec gj[4], along = zero;
      gather(p->slope, 4, j, gj);
      for (int c = 0; c < 3; c++) along += (gi[c] + gj[c]) * x.d[c];
      const vec q = smaller(root(x.r2) * COEFFICIENT(inv_h), two);
      vec g = COEFFICIENT(grad) * G(kernel, q) * larger(x.last, zero);
      if (fluids) g = where(phases(p->phase, j) == same(phase), g, zero);
      sum -= COEFFICIENT(diffusion) * g * (2.0 * (gj[3] - gi[3]) + along);
    }
    rate[i] += sum_of(sum);
  }
}

#endif
