/* Sums over a half list: the density rate, and values weighed with W. */
#ifndef SD_SPH_HALF_LOOPS_H
#define SD_SPH_HALF_LOOPS_H

#include "sd_sph_neighbours.h"

/* The density rate of the plain scheme and of two fluids. The list of near pairs comes with it. */
COPIED void rates(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                  double *rate, const sd_sph_near *near, int volume, sd_sph_kernel kernel, int many)
{
  const vec two = all(2.0);
  int *last = near->pool;
  for (int ii = 0; ii < list->n; ii++) {
    const int i = list->first[ii], count = list->count[i];
    const int *neighbor = list->neighbor[i];
    const row4 xi = load4(p->x4 + 4 * (size_t) i), vi = load4(p->v4 + 4 * (size_t) i);
    const sd_sph_coefficients *row = ROW_OF(i);
    const vec mi = all(many ? p->m[i] : p->mass);
    vec sum = all(0.0);
    near->neighbor[i] = last;

    for (int at = 0; at < count; at += LANES) {
      int room[LANES];
      const int *j = next(neighbor + at, count - at, list->mask, p->n, room);
      const places x = from(p->x4, j, xi);
      vec u[4], vd = all(0.0);
      gather(p->v4, 4, j, u);
      for (int c = 0; c < 3; c++) vd += x.d[c] * (vi[c] - u[c]);
      const vec inv_h = COEFFICIENT(inv_h), distance = root(x.r2) * inv_h;
      vec w = COEFFICIENT(grad) * G(kernel, smaller(distance, two)) * vd;
      vec masses = MASSES, mine = mi;
      /* m_b w 2 rho_a / (rho_a + rho_b): the common part in w, the density in the factors. */
      if (volume) {
        w *= 2.0 / (vi[3] + u[3]);
        masses *= vi[3];
        mine *= u[3];
      }
      /* for particles that fly apart the margin may reach beyond the filler */
      const unsigned closer = bits(distance < two + near->margin * inv_h);
      last += keep(last, j, closer & neighbours_of(count - at));
      sum += w * masses;
      for (int k = 0; k < LANES; k++) rate[j[k]] += mine[k] * w[k];
    }
    rate[i] += sum_of(sum);
    near->own[i] = near->count[i] = (int) (last - near->neighbor[i]);
  }
}

/* Both d and u change sign between i and j, so that the two have the same sums but for the volume of the
 * other one. */
COPIED void gradients(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                      double *sums, sd_sph_kernel kernel, int many)
{
  const vec zero = all(0.0), two = all(2.0);
  for (int ii = 0; ii < list->n; ii++) {
    const int i = list->first[ii], count = list->count[i];
    const int *neighbor = list->neighbor[i];
    const row4 xi = load4(p->x4 + 4 * (size_t) i), vi = load4(p->v4 + 4 * (size_t) i);
    const sd_sph_coefficients *row = ROW_OF(i);
    const vec mi = all(many ? p->m[i] : p->mass), mine = mi / vi[3];
    vec sum[SD_SPH_GRADIENTS];
    for (int c = 0; c < SD_SPH_GRADIENTS; c++) sum[c] = zero;

    for (int at = 0; at < count; at += LANES) {
      int room[LANES];
      const int *j = next(neighbor + at, count - at, list->mask, p->n, room);
      const places x = from(p->x4, j, xi);
      vec v[4], part[SD_SPH_GRADIENTS];
      gather(p->v4, 4, j, v);
      const vec q = smaller(root(x.r2) * COEFFICIENT(inv_h), two);
      const vec g = -COEFFICIENT(grad) * G(kernel, q), theirs = MASSES / v[3];
      const vec gx = g * x.d[0], gy = g * x.d[1], gz = g * x.d[2];
      part[0] = gx * x.d[0];
      part[1] = gy * x.d[1];
      part[2] = gz * x.d[2];
      part[3] = gx * x.d[1];
      part[4] = gx * x.d[2];
      part[5] = gy * x.d[2];
      for (int a = 0; a < 3; a++) {
        const vec u = vi[a] - v[a];
        part[6 + 3 * a] = gx * u;
        part[7 + 3 * a] = gy * u;
        part[8 + 3 * a] = gz * u;
      }
      part[15] = zero;
      for (int c = 0; c < SD_SPH_GRADIENTS; c++) {
        sum[c] += theirs * part[c];
        part[c] *= mine;
      }
      for (int c = 0; c < SD_SPH_GRADIENTS; c += 4)
        add_to_rows(sums + c, SD_SPH_GRADIENTS, j, part + c);
    }
    for (int c = 0; c < SD_SPH_GRADIENTS; c += 4)
      add4(sums + SD_SPH_GRADIENTS * (size_t) i + c, over_lanes(sum + c));
  }
}

/* W is the same for i and j, so each takes the other's row times W. */
COPIED void weigh(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                  const double *q, double *sums, sd_sph_kernel kernel, int many)
{
  const vec two = all(2.0);
  for (int ii = 0; ii < list->n; ii++) {
    const int i = list->first[ii], count = list->count[i];
    const int *neighbor = list->neighbor[i];
    const row4 xi = load4(p->x4 + 4 * (size_t) i), qi = load4(q + 4 * (size_t) i);
    const sd_sph_coefficients *row = ROW_OF(i);
    vec sum[4] = {all(0.0), all(0.0), all(0.0), all(0.0)};

    for (int at = 0; at < count; at += LANES) {
      int room[LANES];
      const int *j = next(neighbor + at, count - at, list->mask, p->n, room);
      vec qj[4];
      gather(q, 4, j, qj);
      const vec r = root(from(p->x4, j, xi).r2);
      const vec W = COEFFICIENT(weight) * K(kernel, smaller(r * COEFFICIENT(inv_h), two));
      for (int c = 0; c < 4; c++) sum[c] += W * qj[c];
      for (int k = 0; k < LANES; k++) add4(sums + 4 * (size_t) j[k], W[k] * qi);
    }
    add4(sums + 4 * (size_t) i, over_lanes(sum));
  }
}

/* Adds w x d with the rows w of the particles j. */
INLINE void add_turned(const double *spins, const int j[LANES], const vec d[3], vec v[3])
{
  vec w[4];
  gather(spins, 4, j, w);
  for (int c = 0; c < 3; c++) {
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    v[c] += w[a] * d[b] - w[b] * d[a];
  }
}

/* What wall particles take from the fluid before them. A pair counts for its wall particle alone,
 * and neighbours of the same kind as i, most of them, cost no kernel. */
COPIED void before_walls(const sd_sph_model *model, const sd_sph_list *list,
                         const sd_sph_particles *p, const double *q, const double *spins,
                         double *sums, sd_sph_kernel kernel, int many)
{
  const vec zero = all(0.0), two = all(2.0);
  for (int ii = 0; ii < list->n; ii++) {
    const int i = list->first[ii], count = list->count[i], is_wall = p->phase[i] < 0;
    const int *neighbor = list->neighbor[i];
    const row4 xi = load4(p->x4 + 4 * (size_t) i);
    const double *qi = q + 8 * (size_t) i, *wi = spins ? spins + 4 * (size_t) i : NULL;
    const sd_sph_coefficients *row = ROW_OF(i);
    vec sum[8];
    for (int c = 0; c < 8; c++) sum[c] = zero;

    for (int at = 0; at < count; at += LANES) {
      int room[LANES];
      const int *j = next(neighbor + at, count - at, list->mask, p->n, room);
      const yes_no counts = phases(p->phase, j) == same(~p->phase[i]);
      if (!any(counts)) continue;
      const places x = from(p->x4, j, xi);
      const vec distance = smaller(root(x.r2) * COEFFICIENT(inv_h), two);
      const vec W = where(counts, COEFFICIENT(weight) * K(kernel, distance), zero);
      if (is_wall) {
        vec qj[8];
        gather(q, 8, j, qj);
        gather(q + 4, 8, j, qj + 4);
        if (spins) add_turned(spins, j, x.d, qj + 4);
        for (int c = 0; c < 2; c++) sum[c] += W * qj[c];
        for (int c = 0; c < 3; c++) {
          sum[2 + c] += W * qj[2] * x.d[c];
          sum[5 + c] += W * qj[4 + c];
        }
      } else
        for (int k = 0; k < LANES; k++) {
          if (W[k] == 0.0) continue;
          double *row_j = sums + 8 * (size_t) j[k];
          for (int c = 0; c < 2; c++) row_j[c] += W[k] * qi[c];
          for (int c = 0; c < 3; c++) {
            row_j[2 + c] -= W[k] * qi[2] * x.d[c][k];
            row_j[5 + c] += W[k] * qi[4 + c];
            /* w x d with the d of the wall, - x.d */
            const int a = (c + 1) % 3, b = (c + 2) % 3;
            if (wi) row_j[5 + c] -= W[k] * (wi[a] * x.d[b][k] - wi[b] * x.d[a][k]);
          }
        }
    }
    if (!is_wall) continue;
    add4(sums + 8 * (size_t) i, over_lanes(sum));
    add4(sums + 8 * (size_t) i + 4, over_lanes(sum + 4));
  }
}

#endif
