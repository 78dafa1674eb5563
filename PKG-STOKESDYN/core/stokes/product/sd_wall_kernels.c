/* What the image of every sphere adds to the fast product: the formulas of sd_wall.h in vectors. The
 * spheres stand in the axes of the wall, at heights of at least their radii. A sphere meets its own
 * image as it meets any other, and no pair has another formula, so that there is no branch. The
 * functions of a pair serve both of its spheres. */
#include "sd_product_loops.h"

/* c1 ... c5 and what both widths share of them; A and B: a^2/6, b^2/6 */
typedef struct {
  vec x, y, z, A, B, c[5], u2, u3, u5;
} image;

/* All that is added is linear in c, u3 and u5, which so bear the taper: of the distance of the
 * spheres. */
INLINE void taper_image(const law *w, vec dz, image *m)
{
  const vec t = taper_of(w, m->x * m->x + m->y * m->y + dz * dz);
  for (int k = 0; k < 5; k++) m->c[k] *= t;
  m->u3 *= t;
  m->u5 *= t;
}

INLINE void image_of(const law *w, const place *i, const place *j, image *m)
{
  const vec g = i->z, h = j->z, dx = i->x - j->x, dy = i->y - j->y;
  const vec A = i->a * i->a * all(1.0 / 6.0), B = j->a * j->a * all(1.0 / 6.0);
  const vec z = g + h, u = inverse_root(dx * dx + dy * dy + z * z), u2 = u * u;
  const vec u3 = u * u2, u5 = u3 * u2, sum = A + B, q = A * B;
  const vec e = all(12.0) * z * (A * h + B * g) + all(24.0) * q;
  const vec k = all(120.0) * q * z * u2, kz = k * z, s = all(2.0) * (h * g + sum); /* Q = k u^5 */
  const vec v = all(12.0) * (B - A) * u5, two = all(2.0) * u3, Q = all(2.0) * k * u5;
  m->x = dx;
  m->y = dy;
  m->z = z;
  m->A = A;
  m->B = B;
  m->u2 = u2;
  m->u3 = u3;
  m->u5 = u5;
  m->c[0] = (e - kz) * u5 - (u + s * u3);
  m->c[1] = all(2.0) * u + all(4.0) * sum * u3 + all(48.0) * q * u5;
  m->c[2] = (all(3.0) * s + u2 * (all(7.0) * kz - all(5.0) * e)) * u5 - u3;
  m->c[3] = g * (two + v) - Q;
  m->c[4] = h * (two - v) - Q;
  if (w->taper != SD_TAPER_NONE) taper_image(w, g - h, m);
}

/* What changes with the sphere that sees the image: c4 and c5 change places, and x, y are turned round. */
typedef struct {
  vec x, y, c4, c5;
} view;

INLINE view seen_by_target(const image *m)
{
  return (view){m->x, m->y, m->c[3], m->c[4]};
}

INLINE view seen_by_source(const image *m)
{
  return (view){-m->x, -m->y, m->c[4], m->c[3]};
}

/* u [3] += image of F */
INLINE void image_add(const image *m, view by, const vec *F, vec *u)
{
  const vec x = by.x, y = by.y, p = x * F[0] + y * F[1] - m->z * F[2];
  const vec along = m->c[2] * p - by.c4 * F[2], up = by.c5 * p - m->c[1] * F[2];
  u[0] = (u[0] + m->c[0] * F[0]) + along * x;
  u[1] = (u[1] + m->c[0] * F[1]) + along * y;
  u[2] = (u[2] + up) + (along * m->z - m->c[0] * F[2]);
}

INLINE void add_images(const law *w, int self, const side *i, const side *j)
{
  image m;
  (void) self;
  image_of(w, &i->at, &j->at, &m);
  image_add(&m, seen_by_target(&m), j->F, i->u);
  if (j->u) image_add(&m, seen_by_source(&m), i->F, j->u);
}

/* --- forces and torques --- */

/* k l n of a sphere as source, for the other's spin from its force; and as target, for its own
 * velocity from the other's torque */
typedef struct {
  vec k, l, n;
} half_image;

INLINE half_image half_of(const image *m, vec difference, vec height, vec square)
{
  const vec v = all(12.0) * square * m->u5;
  return (half_image){difference * m->u3 - v * m->z,
                      all(5.0) * v * m->z * m->u2 - all(6.0) * height * m->u5,
                      all(0.0) - m->u3 - v};
}

/* u [6] += image of F [6]; me, it: half images of target and source */
INLINE void image_add_grand(const image *m, const half_image *me, const half_image *it, view by, const vec *F,
                            vec *u)
{
  const vec x = by.x, y = by.y;
  const vec d = m->u3 - all(3.0) * m->u5 * m->z * m->z, turn = m->u3 * F[5];
  const vec p = x * F[0] + y * F[1] - m->z * F[2], t = x * F[4] - y * F[3];
  const vec along = m->c[2] * p - by.c4 * F[2] - me->l * t;
  const vec up = by.c5 * p - m->c[1] * F[2] - me->n * t;
  u[0] = (u[0] + m->c[0] * F[0]) + (along * x + turn * y) - me->k * F[4];
  u[1] = (u[1] + m->c[0] * F[1]) + (along * y - turn * x) + me->k * F[3];
  u[2] = (u[2] + up) + (along * m->z - m->c[0] * F[2]);
  const vec s = it->l * p - it->n * F[2], r = x * F[3] + y * F[4];
  const vec self = all(1.5) * m->u3 + all(2.0) * d;
  const vec back = all(1.5) * m->u5 * (all(3.0) * r + m->z * F[5]);
  u[3] = (u[3] + it->k * F[1]) + s * y + (self * F[3] - back * x);
  u[4] = (u[4] - it->k * F[0]) - s * x + (self * F[4] - back * y);
  u[5] = u[5] + m->u3 * (x * F[1] - y * F[0]) +
      all(0.5) * (d * F[5] + all(3.0) * m->u5 * m->z * r);
}

INLINE void add_grand_images(const law *w, int self, const side *i, const side *j)
{
  image m;
  (void) self;
  image_of(w, &i->at, &j->at, &m);
  const vec g = i->at.z, h = j->at.z;
  const half_image of_i = half_of(&m, g - h, g, m.A), of_j = half_of(&m, h - g, h, m.B);
  image_add_grand(&m, &of_i, &of_j, seen_by_target(&m), j->F, i->u);
  if (j->u) image_add_grand(&m, &of_j, &of_i, seen_by_source(&m), i->F, j->u);
}

DEFINE_SYMMETRIC(symmetric, 3, 1, add_images)
DEFINE_SYMMETRIC(grand_symmetric, 6, 1, add_grand_images)
DEFINE_LIST(list, 3, 1, add_images)
DEFINE_LIST(grand_list, 6, 1, add_grand_images)

const struct sd_kernels SD_KERNELS(sd_wall) = {{sizeof(real), LANES, symmetric, list},
                                               {sizeof(real), LANES, grand_symmetric, grand_list}};
