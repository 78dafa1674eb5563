/* The force on each particle. */
#ifndef SD_SPH_FORCES_LOOP_H
#define SD_SPH_FORCES_LOOP_H

#include "sd_sph_neighbours.h"

/* What a scene asks for. Kernel, many (classes) and scheme are constants in a copy of a loop; on the
 * terms of the force it branches, the same way for every pair. */
typedef struct {
  sd_sph_kernel kernel;
  int many, artvisc, tenscorr, rates;
  sd_sph_friction friction;
  sd_sph_scheme scheme;
} terms;

INLINE terms terms_in_copy(terms has, sd_sph_kernel kernel, int many)
{
  has.kernel = kernel;
  has.many = many;
  return has;
}

/* Momentum goes along with du: of correction it is an acceleration. */
#define CARRIES(has)                                                                              \
  ((has).scheme == SD_SPH_SHIFT || (has).scheme == SD_SPH_SHIFT_PLIANT ||                           \
   (has).scheme == SD_SPH_VOLUME_SHIFT)

#define CORRECTS(has) \
  ((has).scheme == SD_SPH_CORRECTION || (has).scheme == SD_SPH_VOLUME_CORRECTION)

/* Particle i, and the pairs of it with j: d = x_i - x_j, u = v_i - v_j, A the last column of x4,
 * grad_i W = g d, m = m_i m_j. */
typedef struct {
  int index;
  row4 x, v, du;
  vec m, B[8];
  const sd_sph_coefficients *row;
} particle;

typedef struct {
  vec d[3], u[3], v_j[3], vd, r2, inv_h, g, m, masses, A_i, A_j, rho_i, rho_j;
  /* 1 / (rho_i rho_j), one division for all that has it */
  vec inverse;
} pairs_of_one;

INLINE particle particle_of(const sd_sph_model *model, const sd_sph_particles *p, int i, terms has)
{
  const int many = has.many;
  particle of = {.index = i,
                 .x = load4(p->x4 + 4 * (size_t) i),
                 .v = load4(p->v4 + 4 * (size_t) i),
                 .m = all(many ? p->m[i] : p->mass),
                 .row = ROW_OF(i)};
  if (CARRIES(has)) of.du = load4(p->du + 4 * (size_t) i);
  if (has.scheme == SD_SPH_SHIFT_PLIANT || CORRECTS(has))
    for (int c = 0; c < 8; c++) of.B[c] = all(p->B[8 * (size_t) i + c]);
  return of;
}

INLINE pairs_of_one meet(const sd_sph_particles *p, const particle *i, const int j[LANES],
                         terms has)
{
  const int many = has.many;
  const sd_sph_coefficients *row = i->row;
  const vec mi = i->m;
  const places x = from(p->x4, j, i->x);
  pairs_of_one q = {.d = {x.d[0], x.d[1], x.d[2]}, .r2 = x.r2, .A_i = all(i->x[3]), .A_j = x.last,
                    .rho_i = all(i->v[3]), .masses = MASSES};
  /* K and G end at q = 2 with the value 0: beyond, q = 2 will do. */
  q.inv_h = COEFFICIENT(inv_h);
  q.g = COEFFICIENT(grad) * G(has.kernel, smaller(root(q.r2) * q.inv_h, all(2.0)));
  q.m = mi * q.masses;
  if (has.artvisc || has.friction || has.rates || has.scheme != SD_SPH_PLAIN) {
    vec b[4];
    gather(p->v4, 4, j, b);
    for (int c = 0; c < 3; c++) {
      q.v_j[c] = b[c];
      q.u[c] = i->v[c] - b[c];
      q.vd += q.u[c] * q.d[c];
    }
    q.rho_j = b[3];
  }
  if (has.scheme != SD_SPH_PLAIN || has.friction) q.inverse = 1.0 / (q.rho_i * q.rho_j);
  return q;
}

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

/* The harmonic mean; a fluid that thickens has none at rest. */
#define MU_OF(k, p) (p)->mu[j[k]]
INLINE vec mean_viscosity(const sd_sph_particles *p, int i, const int j[LANES])
{
  const vec mine = all(p->mu[i]), theirs = (vec) LANEWISE(MU_OF, p);
  return 2.0 * mine * theirs / larger(mine + theirs, all(1e-300));
}

/* Friction, with correction's factor (d.B d) / r^2 in ratio. That of central is along d, so it
 * belongs to the bracket, whose force has the factor - m m g; the D + 2 in visc makes up for what
 * lies across d. */
INLINE vec central(const pairs_of_one *q, vec visc, vec ratio)
{
  return visc * q->inverse * ratio * q->vd / (q->r2 + 0.001 / (q->inv_h * q->inv_h));
}

/* y = B d for B xx yy zz xy | xz yz */
INLINE void turn(const vec B[6], const vec d[3], vec y[3])
{
  y[0] = B[0] * d[0] + B[3] * d[1] + B[4] * d[2];
  y[1] = B[3] * d[0] + B[1] * d[1] + B[5] * d[2];
  y[2] = B[4] * d[0] + B[5] * d[1] + B[2] * d[2];
}

/* (A_i B_i + A_j B_j) d. A wall has the B of its partner, so that all of both pressures stands with that
 * one. */
INLINE void through_both(const sd_sph_particles *p, const particle *i, const int j[LANES],
                         const pairs_of_one *q, vec y[3])
{
  const vec both = q->A_i + q->A_j;
  vec B[8];
  gather_eight(p->B, j, B);
  const yes_no wall_i = i->B[6] > 0.5, wall_j = B[6] > 0.5;
  const vec mine = where(wall_j, both, where(wall_i, all(0.0), q->A_i)), theirs = both - mine;
  for (int c = 0; c < 6; c++) B[c] = mine * i->B[c] + theirs * B[c];
  turn(B, q->d, y);
}

/* The force on i that is opposite to that on j: all of it, but for the slope of the pressure with
 * correction. */
INLINE void opposite_forces(const sd_sph_model *model, const sd_sph_particles *p, const particle *i,
                            const int j[LANES], const pairs_of_one *q, vec ratio, terms has,
                            vec F[3])
{
  const int many = has.many;
  const sd_sph_coefficients *row = i->row;
  vec visc = all(0.0);
  if (has.friction) visc = COEFFICIENT(visc);
  if (has.friction && p->mu) visc *= mean_viscosity(p, i->index, j);
  vec bracket = q->A_i + q->A_j;
  if (has.scheme == SD_SPH_SHIFT_PLIANT || CORRECTS(has)) bracket = all(0.0);
  if (has.tenscorr) {
    const vec distance = smaller(root(q->r2) * q->inv_h, all(2.0));
    bracket += tension(model->epsilon, q->A_i, q->A_j, COEFFICIENT(tens) * K(has.kernel, distance));
  }
  if (has.scheme == SD_SPH_VOLUME || has.scheme == SD_SPH_VOLUME_SHIFT)
    bracket = 2.0 * (q->rho_j * q->A_i + q->rho_i * q->A_j) * q->inverse / (q->rho_i + q->rho_j);
  if (has.artvisc)
    bracket += artificial(q->vd, q->r2 + model->eta, q->rho_i + q->rho_j, COEFFICIENT(a1),
                          COEFFICIENT(b1));
  if (has.friction == SD_SPH_CENTRAL) bracket -= central(q, visc, ratio);
  const vec along = -q->m * bracket * q->g;
  for (int c = 0; c < 3; c++) F[c] = along * q->d[c];
  if (has.friction == SD_SPH_LAPLACIAN) {
    const vec rub = q->m * visc * q->g * ratio * q->inverse;
    for (int c = 0; c < 3; c++) F[c] += rub * q->u[c];
  }
  if (has.scheme == SD_SPH_SHIFT_PLIANT) {
    vec pressed[3];
    through_both(p, i, j, q, pressed);
    for (int c = 0; c < 3; c++) F[c] -= q->m * q->g * pressed[c];
  }
  /* V_a V_b rho_a = m_a m_b / rho_b: momentum that a takes away, and that b brings. */
  if (CARRIES(has)) {
    vec du[4], mine = all(0.0), theirs = all(0.0);
    gather(p->du, 4, j, du);
    for (int c = 0; c < 3; c++) {
      mine += i->du[c] * q->d[c];
      theirs += du[c] * q->d[c];
    }
    const vec carry = q->m * q->inverse * q->g;
    const vec out = carry * q->rho_i * mine, in = carry * q->rho_j * theirs;
    for (int c = 0; c < 3; c++) F[c] += out * i->v[c] + in * q->v_j[c];
  }
}

/* The forces on i for the caller, `count` lanes of them. */
INLINE double *hand_out(const vec F[3], int count, double *each)
{
  for (int k = 0; k < LANES && k < count; k++)
    for (int c = 0; c < 3; c++) *each++ = F[c][k];
  return each;
}

/* Over a half list: what i gets is taken from j. */
COPIED double forces(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                     double *f4, double *each, terms has, sd_sph_kernel kernel, int many)
{
  has = terms_in_copy(has, kernel, many);
  vec nearest = all(HUGE_VAL);
  for (int ii = 0; ii < list->n; ii++) {
    const int i = list->first[ii], count = list->count[i];
    const particle of_i = particle_of(model, p, i, has);
    vec sum[4] = {all(0.0), all(0.0), all(0.0), all(0.0)};

    for (int at = 0; at < count; at += LANES) {
      int room[LANES];
      const int *j = next(list->neighbor[i] + at, count - at, list->mask, p->n, room);
      const pairs_of_one q = meet(p, &of_i, j, has);
      nearest = smaller(q.r2, nearest);
      vec F[4] = {all(0.0), all(0.0), all(0.0), all(0.0)};
      opposite_forces(model, p, &of_i, j, &q, all(1.0), has, F);
      for (int c = 0; c < 3; c++) sum[c] += F[c];
      if (has.rates) {
        const vec w = q.g * q.vd;
        sum[3] += q.masses * w;
        F[3] = -of_i.m * w;
      }
      if (SELDOM(each != NULL)) each = hand_out(F, count - at, each);
      take_from(f4, j, F);
    }
    add4(f4 + 4 * (size_t) i, over_lanes(sum));
  }
  return least_of(nearest);
}

/* B_i d, and d.B d / r^2 with the mean of the two. Where one of them is a wall, it has the B of the
 * other. */
INLINE vec corrected(const double *B, const vec own[8], const int j[LANES], const vec d[3],
                     vec r2, vec mine[3])
{
  vec other[8], theirs[3], product = all(0.0);
  gather_eight(B, j, other);
  turn(own, d, mine);
  turn(other, d, theirs);
  const yes_no wall_j = other[6] > 0.5, wall_i = own[6] > 0.5;
  for (int c = 0; c < 3; c++) {
    const vec y = where(wall_j, mine[c], theirs[c]);
    mine[c] = where(wall_i, theirs[c], mine[c]);
    product += d[c] * (mine[c] + y);
  }
  return 0.5 * product / r2;
}

/* What the pressures of a pair do to i with correction, but for - V_i V_j g: to fluid by their difference,
 * since it is the gradient that is corrected. What a wall bears no difference tells: it gets the force
 * of the scheme without correction, along d. */
INLINE vec pressures_on(int wall, const pairs_of_one *q, sd_sph_scheme scheme)
{
  const vec of_i = scheme == SD_SPH_VOLUME_CORRECTION ? 2.0 * q->rho_j / (q->rho_i + q->rho_j) : all(1.0);
  const vec of_j = scheme == SD_SPH_VOLUME_CORRECTION ? 2.0 * q->rho_i / (q->rho_i + q->rho_j) : all(1.0);
  return wall ? of_i * q->A_i + of_j * q->A_j : of_j * (q->A_j - q->A_i);
}

/* With correction, over a list both ways. Between fluid particles without friction B_j is not
 * needed, and B_i stands before the sum. */
COPIED double slopes(const sd_sph_model *model, const sd_sph_both *list, const sd_sph_particles *p,
                     double *f4, double *each, terms has, sd_sph_kernel kernel, int many)
{
  has = terms_in_copy(has, kernel, many);
  vec nearest = all(HUGE_VAL);
  for (int i = 0; i < list->n; i++) {
    const particle of_i = particle_of(model, p, i, has);
    const int wall = of_i.B[6][0] > 0.5, pairwise = has.friction || wall || each;
    vec sum[4] = {all(0.0), all(0.0), all(0.0), all(0.0)};
    vec slope[4] = {all(0.0), all(0.0), all(0.0), all(0.0)};

    for (int at = 0; at < list->count[i]; at += LANES) {
      const int *j = list->neighbor[i] + at;
      const pairs_of_one q = meet(p, &of_i, j, has);
      nearest = smaller(q.r2, nearest);
      const vec weight = -q.m * q.inverse * q.g * pressures_on(wall, &q, has.scheme);
      vec F[3], mine[3], ratio = all(1.0);
      if (pairwise) ratio = corrected(p->B, of_i.B, j, q.d, q.r2, mine);
      opposite_forces(model, p, &of_i, j, &q, ratio, has, F);
      for (int c = 0; c < 3; c++) {
        if (pairwise)
          F[c] += weight * (wall ? q.d[c] : mine[c]);
        else
          slope[c] += weight * q.d[c];
        sum[c] += F[c];
      }
      if (SELDOM(each != NULL)) each = hand_out(F, LANES, each);
    }
    vec turned[3];
    turn(of_i.B, slope, turned);
    for (int c = 0; c < 3; c++) sum[c] += turned[c];
    store4(f4 + 4 * (size_t) i, over_lanes(sum));
  }
  return least_of(nearest);
}

#endif
