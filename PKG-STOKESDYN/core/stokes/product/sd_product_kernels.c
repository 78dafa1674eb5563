/* Kernels of the fast product, of doubles; sd_product_single_kernels.c: the same of floats. The block of a pair
 * (sd_tensor_lanes.h) is the same for both of its spheres: the symmetric kernels compute it once. */
#include "sd_product_loops.h"

/* f and h of the force. squares = a_i^2 + a_j^2 */
INLINE void forces_block(const law *w, vec r2, vec ai, vec aj, vec squares, vec *f, vec *h)
{
  if (w->tensor == SD_TENSOR_RPY)
    block(r2, ai, aj, squares, f, h);
  else {
    *f = all(1.0) / root(r2);
    *h = *f * *f * *f;
  }
  if (w->taper != SD_TAPER_NONE) {
    const vec t = taper_of(w, r2);
    *f *= t;
    *h *= t;
  }
}

INLINE void torques_block(const law *w, vec r2, vec ai, vec aj, vec squares, grand *b)
{
  grand_block(r2, ai, aj, squares, b);
  if (w->taper != SD_TAPER_NONE) {
    const vec t = taper_of(w, r2);
    b->f *= t;
    b->h *= t;
    b->cij *= t;
    b->cji *= t;
    b->k *= t;
    b->e *= t;
  }
}

/* The lane in which a sphere meets itself takes no part. */
NOT_INLINE void leave_out_self(int lane, vec *f, vec *h)
{
  const yes_no self = (vec) LANEWISE(NUMBER, 0) == all((real) lane);
  *f = where(self, all(0.0), *f);
  *h = where(self, all(0.0), *h);
}

/* Of floats in steps as they are: no length that forces need leaves their range. */
INLINE void add_forces(const law *w, int self, const side *i, const side *j)
{
  const place *p = &i->at, *q = &j->at;
  const vec *F = i->F, *G = j->F;
  vec *u = i->u, *v = j->u;
  const vec dx = steps_between(p->x, q->x), dy = steps_between(p->y, q->y), dz = steps_between(p->z, q->z);
  const vec r2 = dx * dx + dy * dy + dz * dz;
  vec f, h;
  forces_block(w, r2, p->a, q->a, p->a * p->a + q->a * q->a, &f, &h);
  if (self >= 0 && self < LANES) leave_out_self(self, &f, &h);
  const vec c = h * (dx * G[0] + dy * G[1] + dz * G[2]);
  u[0] = (u[0] + f * G[0]) + c * dx;
  u[1] = (u[1] + f * G[1]) + c * dy;
  u[2] = (u[2] + f * G[2]) + c * dz;
  if (!v) return;
  const vec e = h * (dx * F[0] + dy * F[1] + dz * F[2]);
  v[0] = (v[0] + f * F[0]) + e * dx;
  v[1] = (v[1] + f * F[1]) + e * dy;
  v[2] = (v[2] + f * F[2]) + e * dz;
}

/* Seen from the source, r is -r and the two cross products change places. */
INLINE void add_torques(const law *w, int self, const side *i, const side *j)
{
  const place *p = &i->at, *q = &j->at;
  const vec d[3] = {length_between(p->x, q->x, w->step), length_between(p->y, q->y, w->step),
                    length_between(p->z, q->z, w->step)};
  const vec r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  grand b;
  torques_block(w, r2, p->a, q->a, p->a * p->a + q->a * q->a, &b);
  if (self >= 0 && self < LANES) {
    vec f = b.f, k = b.k; /* the others are 0 or multiply r */
    leave_out_self(self, &f, &k);
    b.f = f;
    b.k = k;
  }
  grand_add(&b, b.cji, b.cij, d, j->F, i->u);
  if (j->u) grand_add(&b, -b.cij, -b.cji, d, i->F, j->u);
}

DEFINE_SYMMETRIC(symmetric, 3, MOST_TARGETS, add_forces)
DEFINE_SYMMETRIC(grand_symmetric, 6, 1, add_torques)

#ifdef SD_SINGLE
const struct sd_kernels SD_KERNELS(sd_product_single) = {{sizeof(real), LANES, symmetric, NULL},
                                                         {sizeof(real), LANES, grand_symmetric, NULL}};
#else
DEFINE_LIST(list, 3, 0, add_forces)
DEFINE_LIST(grand_list, 6, 0, add_torques)

const struct sd_kernels SD_KERNELS(sd_product) = {{sizeof(real), LANES, symmetric, list},
                                                  {sizeof(real), LANES, grand_symmetric, grand_list}};
#endif
