/* The near part of a block, in vectors of doubles or of floats: included by sd_field_kernels.c once
 * for each, with
 *
 *   REAL, REALS, WIDTH    a number, a vector, how many there are in it
 *   OF(name)              the names of this copy
 *   ALL, LOAD, STORE, LARGER, SMALLER, WITHIN, INVERSE_ROOT    as in sd_lanes.h; WITHIN(a, most, x) is
 *                         x where a <= most, else 0
 *
 * Places are those from the first point of the block, so that floats keep their digits. */

/* Tensor of a source and a point in the vectors of this copy */
INLINE void OF(point_block)(REALS r2, REALS a2, REALS *f, REALS *h, REALS *c)
{
  const REALS y = INVERSE_ROOT(LARGER(r2, a2)), y2 = y * y, y3 = y * y2;
  *f = y + a2 * ALL((REAL) (1.0 / 3.0)) * y3;
  *h = y3 - a2 * y2 * y3;
  *c = y3;
}

/* G: force and torque */
INLINE void OF(add_flow)(int turns, const REALS *G, REALS f, REALS h, REALS c, REALS dx, REALS dy,
                         REALS dz, REALS *u)
{
  const REALS e = h * (dx * G[0] + dy * G[1] + dz * G[2]);
  u[0] = (u[0] + f * G[0]) + e * dx;
  u[1] = (u[1] + f * G[1]) + e * dy;
  u[2] = (u[2] + f * G[2]) + e * dz;
  if (!turns) return;
  u[0] += c * (G[4] * dz - G[5] * dy);
  u[1] += c * (G[5] * dx - G[3] * dz);
  u[2] += c * (G[3] * dy - G[4] * dx);
}

/* value[f] of three polynomials of one degree */
INLINE void OF(horner)(int count, int degree, REALS (*c)[SD_RADIAL_TERMS], REALS t, REALS *value)
{
#pragma GCC unroll 3
  for (int f = 0; f < count; f++) value[f] = c[f][degree];
#pragma GCC unroll 40
  for (int k = degree - 1; k >= 0; k--)
#pragma GCC unroll 3
    for (int f = 0; f < count; f++) value[f] = value[f] * t + c[f][k];
}

/* Of a sphere; a point has b = 0. */
INLINE void OF(polynomials)(const sd_field_part *p, double a, int degree,
                            REALS (*c)[SD_RADIAL_TERMS])
{
  const double b = (a - p->ref) * (a + p->ref) / 6.0;
  for (int k = 0; k <= degree; k++) {
    c[0][k] = ALL((REAL) (p->coefficient[SD_I0][k] - b * p->coefficient[SD_I1][k]));
    c[1][k] = ALL((REAL) (p->coefficient[SD_J0][k] - b * p->coefficient[SD_J1][k]));
    c[2][k] = ALL((REAL) p->coefficient[SD_K0][k]);
  }
}

/* What a source does to the points of the bricks near it: place [3][4][8] along each direction, u
 * [64][3][8] */
INLINE void OF(add_to_bricks)(int turns, int degree, const sd_field_part *p, const double *s,
                              const double *lo, REALS (*c)[SD_RADIAL_TERMS],
                              const REAL (*place)[SD_FIELD_BRICKS][8], uint64_t near,
                              REAL (*u)[3][8])
{
  const double range2 = p->range * p->range;
  const REALS most = ALL((REAL) range2), twice = ALL((REAL) (2.0 / range2)), one = ALL((REAL) 1.0);
  const REALS x = ALL((REAL) (s[0] - lo[0])), y = ALL((REAL) (s[1] - lo[1]));
  const REALS z = ALL((REAL) (s[2] - lo[2])), a2 = ALL((REAL) (s[3] > 1e-12 ? s[3] * s[3] : 1e-24));
  REALS G[6];
  for (int d = 0; d < 6; d++) G[d] = ALL((REAL) s[4 + d]);
  for (; near; near &= near - 1) {
    const unsigned brick = lowest(near);
    const REAL *along_x = place[0][brick % 4], *along_y = place[1][brick / 4 % 4];
    const REAL *along_z = place[2][brick / 16];
    for (int l = 0; l < 8; l += WIDTH) {
      const REALS dx = LOAD(along_x + l) - x, dy = LOAD(along_y + l) - y, dz = LOAD(along_z + l) - z;
      const REALS r2 = dx * dx + dy * dy + dz * dz;
      REAL(*out)[8] = u[brick];
      REALS f, h, g, D[3], sum[3];
      for (int d = 0; d < 3; d++) sum[d] = LOAD(out[d] + l);
      OF(point_block)(r2, a2, &f, &h, &g);
      OF(horner)(turns ? 3 : 2, degree, c, SMALLER(r2, most) * twice - one, D);
      f = WITHIN(r2, most, f - D[0]);
      h = WITHIN(r2, most, h - D[1]);
      if (turns) g = WITHIN(r2, most, g - D[2]);
      OF(add_flow)(turns, G, f, h, g, dx, dy, dz, sum);
      for (int d = 0; d < 3; d++) STORE(out[d] + l, sum[d]);
    }
  }
}

COPIED void OF(near_with)(int turns, int degree, const sd_field_part *p, sd_field_block *b)
{
  const brick_middles middles = middles_of(p, b);
  REALS c[3][SD_RADIAL_TERMS];
  REAL u[BRICKS][3][8] = {{{0}}}, place[3][SD_FIELD_BRICKS][8];
  double a = 0.0;
  for (int d = 0; d < 3; d++)
    for (int k = 0; k < SD_FIELD_BRICKS; k++)
      for (int l = 0; l < 8; l++) place[d][k][l] = (REAL) ((2 * k + (l >> d) % 2) * p->step[d]);
  for (int m = 0; m < b->n; m++) {
    const double *s = p->source + (long) SD_FIELD_ROW * b->source[m];
    if (m + AHEAD < b->n)
      for (int k = 0; k < SD_FIELD_ROW; k += 8)
        sd_fetch(p->source + (long) SD_FIELD_ROW * b->source[m + AHEAD] + k);
    if (m == 0 || s[3] != a) OF(polynomials)(p, s[3], degree, c);
    a = s[3];
    OF(add_to_bricks)(turns, degree, p, s, b->lo, c, (const REAL(*)[SD_FIELD_BRICKS][8]) place,
                      bricks_near(&middles, b, s), u);
  }
  for (int k = 0; k < BRICKS; k++)
    for (int d = 0; d < 3; d++)
      for (int l = 0; l < 8; l++) b->u[k][d][l] = u[k][d][l];
}

/* A copy for each degree, as in sd_ewald_near_kernel.h */
#define OF_DEGREE(d)                                                          \
  static void OF(near_forces_##d)(const sd_field_part *p, sd_field_block *b)  \
  {                                                                           \
    OF(near_with)(0, d, p, b);                                                \
  }                                                                           \
  static void OF(near_torques_##d)(const sd_field_part *p, sd_field_block *b) \
  {                                                                           \
    OF(near_with)(1, d, p, b);                                                \
  }
NEAR_DEGREES(OF_DEGREE)
#undef OF_DEGREE

static void OF(near_part)(const sd_field_part *p, sd_field_block *b)
{
#define OF_DEGREE(d)              \
  if (p->degree == (d)) {         \
    if (p->turns)                 \
      OF(near_torques_##d)(p, b); \
    else                          \
      OF(near_forces_##d)(p, b);  \
    return;                       \
  }
  NEAR_DEGREES(OF_DEGREE)
#undef OF_DEGREE
}

#undef REAL
#undef REALS
#undef WIDTH
#undef OF
#undef ALL
#undef LOAD
#undef STORE
#undef LARGER
#undef SMALLER
#undef WITHIN
#undef INVERSE_ROOT
#undef NEAR_DEGREES
