/* Kernel of near images: the image of a pair (sd_wall.h) less its smooth part (sd_image_wave.h), whose
 * functions are polynomials in t = 2 R^2/range^2 - 1. Included by sd_ewald_kernels.c. */

/* The functions for a target: P[0] + b_i P[1] and P[1] + b_i P[2], P8 and P9: out
 * [2 SD_IMAGE_SYMMETRIC + 2][SD_RADIAL_TERMS] */
INLINE void image_polynomials_of_target(const sd_image_part *p, double b, int degree, double *out)
{
  for (int f = 0; f < SD_IMAGE_SYMMETRIC; f++)
    for (int k = 0; k <= degree; k++) {
      const double c0 = p->coefficient[f][0][k], c1 = p->coefficient[f][1][k];
      out[f * SD_RADIAL_TERMS + k] = c0 + b * c1;
      out[(SD_IMAGE_SYMMETRIC + f) * SD_RADIAL_TERMS + k] = c1 + b * p->coefficient[f][2][k];
    }
  for (int f = SD_IMAGE_SYMMETRIC; f < SD_IMAGE_FUNCTIONS; f++)
    for (int k = 0; k <= degree; k++)
      out[(SD_IMAGE_SYMMETRIC + f) * SD_RADIAL_TERMS + k] = p->coefficient[f][0][k];
}

/* Where all radii are alike: P[0] + 2 b P[1] + b^2 P[2] */
INLINE void image_polynomials_of_all(const sd_image_part *p, double b, int degree, double *out)
{
  for (int f = 0; f < SD_IMAGE_SYMMETRIC; f++)
    for (int k = 0; k <= degree; k++)
      out[f * SD_RADIAL_TERMS + k] = p->coefficient[f][0][k] + 2.0 * b * p->coefficient[f][1][k] +
          b * b * p->coefficient[f][2][k];
}

/* Spheres at the heights g and h, r2 the square of the distance from one to the image of the other; A, B:
 * a^2/6 of each */
typedef struct {
  vec r2, g, h, A, B;
} image_pairs;

/* c1 ... c5 of the smooth part; bj = B less that of the reference radius */
INLINE void image_smooth(int equal, int degree, const double *polynomial, vec t, vec bj,
                         const image_pairs *m, vec *c)
{
  const vec g = m->g, h = m->h, D = m->B - m->A;
  vec P[2 * SD_IMAGE_SYMMETRIC + 2];
  horner(SD_IMAGE_SYMMETRIC, degree, polynomial, SD_RADIAL_TERMS, t, P);
  if (!equal) {
    const double *more = polynomial + SD_IMAGE_SYMMETRIC * SD_RADIAL_TERMS;
    horner(SD_IMAGE_SYMMETRIC, degree, more, SD_RADIAL_TERMS, t, P + SD_IMAGE_SYMMETRIC);
    horner(2, degree, more + SD_IMAGE_SYMMETRIC * SD_RADIAL_TERMS, SD_RADIAL_TERMS, t,
           P + 2 * SD_IMAGE_SYMMETRIC);
#pragma GCC unroll 8
    for (int f = 0; f < SD_IMAGE_SYMMETRIC; f++) P[f] += bj * P[SD_IMAGE_SYMMETRIC + f];
  }
  const vec z = g + h, apart = g - h, gh = g * h, z2 = z * z, turn = all(0.5) * apart * P[1];
  c[0] = P[0] + gh * P[1] + z2 * P[2];
  c[1] = P[3];
  c[2] = P[4] + gh * P[5] + z2 * P[6];
  c[3] = z * P[7] - turn;
  c[4] = z * P[7] + turn;
  if (!equal) {
    const vec *of_D = P + 2 * SD_IMAGE_SYMMETRIC;
    const vec both = all(2.0) * z * apart * D, four = all(4.0) * D * of_D[0];
    c[0] += both * of_D[0];
    c[2] += both * of_D[1];
    c[3] += g * four;
    c[4] -= h * four;
  }
}

/* c1 ... c5 of the image itself */
INLINE void image_whole(const image_pairs *m, vec *c)
{
  const vec g = m->g, h = m->h, A = m->A, B = m->B;
  const vec u = inverse_root(m->r2), u2 = u * u, u3 = u * u2, u5 = u3 * u2, z = g + h, w = A + B, q = A * B;
  const vec e = all(12.0) * z * (A * h + B * g) + all(24.0) * q, Q = all(120.0) * q * z * (u5 * u2);
  const vec s = all(2.0) * (h * g + w), v = all(12.0) * (B - A) * u5, Q2 = Q + Q;
  c[0] = e * u5 - u - s * u3 - Q * z;
  c[1] = u + u + all(4.0) * w * u3 + all(48.0) * q * u5;
  c[2] = (all(3.0) * s - all(5.0) * e * u2) * u5 - u3 + all(7.0) * Q * z * u2;
  c[3] = g * (u3 + u3 + v) - Q2;
  c[4] = h * (u3 + u3 - v) - Q2;
}

/* u += image of a force F, seen from it by r; c4, c5: of this direction of the pair */
INLINE void image_add(const vec *c, vec c4, vec c5, const vec r[3], const vec *F, vec *u)
{
  const vec x = r[0], y = r[1], z = r[2];
  const vec p = x * F[0] + y * F[1] - z * F[2], along = c[2] * p - c4 * F[2];
  u[0] += c[0] * F[0] + along * x;
  u[1] += c[0] * F[1] + along * y;
  u[2] += c5 * p - (c[1] + c[0]) * F[2] + along * z;
}

COPIED void near_images(int equal, int degree, const sd_image_part *p)
{
  const vec range2 = all(p->range2), twice = all(2.0 / p->range2), one = all(1.0);
  const vec sixth = all(1.0 / 6.0), ref = all(p->ref2 / 6.0), none = all(0.0);
  double mine[(2 * SD_IMAGE_SYMMETRIC + 2) * SD_RADIAL_TERMS];
  if (equal && p->rows > 0)
    image_polynomials_of_all(p, (p->row[3] * p->row[3] - p->ref2) / 6.0, degree, mine);
  for (int i = 0; i < p->targets; i++) {
    const double *own = p->row + 8 * (long) i;
    const vec x = all(own[0]), y = all(own[1]), g = all(own[2]), A = all(own[3] * own[3] / 6.0);
    const vec G[3] = {all(own[4]), all(own[5]), all(own[6])}, me = all(own[7]);
    if (!equal) image_polynomials_of_target(p, (own[3] * own[3] - p->ref2) / 6.0, degree, mine);
    vec u[3] = {none, none, none};
    for (long k = p->first[i]; k < p->first[i + 1]; k += LANES) {
      const int *j = p->neighbor + k;
      vec at[4], F[4], c[5], smooth[5], v[4] = {none, none, none, none};
      gather(p->row, 8, j, at);
      gather(p->row + 4, 8, j, F);
      const vec h = at[2], B = at[3] * at[3] * sixth, r[3] = {x - at[0], y - at[1], g + h};
      const vec back[3] = {-r[0], -r[1], r[2]};
      const vec r2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2], t = smaller(r2, range2) * twice - one;
      const image_pairs m = {r2, g, h, A, B};
      image_whole(&m, c);
      image_smooth(equal, degree, mine, t, B - ref, &m, smooth);
#pragma GCC unroll 5
      for (int f = 0; f < 5; f++) c[f] -= smooth[f];
      image_add(c, c[3], c[4], r, F, u);
      image_add(c, c[4], c[3], back, G, v);
      const yes_no self = F[3] == me;
#pragma GCC unroll 3
      for (int d = 0; d < 3; d++) v[d] = where(self, none, v[d]);
      add_to_rows(p->u, 4, j, v);
    }
    double *out = p->u + 4 * (long) i;
#pragma GCC unroll 3
    for (int d = 0; d < 3; d++) out[d] += total(u[d]);
  }
}

#define OF_DEGREE(d)                                  \
  static void images_equal_##d(const sd_image_part *p) \
  {                                                   \
    near_images(1, d, p);                             \
  }                                                   \
  static void images_any_##d(const sd_image_part *p)   \
  {                                                   \
    near_images(0, d, p);                             \
  }
SD_NEAR_DEGREES(OF_DEGREE)
#undef OF_DEGREE

static void image_part(const sd_image_part *p)
{
#define OF_DEGREE(d)        \
  if (p->degree == (d)) {   \
    if (p->equal)           \
      images_equal_##d(p);  \
    else                    \
      images_any_##d(p);    \
    return;                 \
  }
  SD_NEAR_DEGREES(OF_DEGREE)
#undef OF_DEGREE
}
