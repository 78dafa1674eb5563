/* Kernels of the near part: the block of a pair (sd_pair_kernel.h) less the wave part of the same
 * pair in open space, polynomials in t = 2 r^2/range^2 - 1. Included by sd_ewald_kernel.h. */

/* The lanes beyond the end, of other rows, are cut off; centres have room for them. */
static long search(const double *centre, long stride, int begin, int end, const double *x,
                   double distance2, int *list)
{
  const double *px = centre, *py = px + stride, *pz = py + stride;
  const vec x0 = SET1(x[0]), y0 = SET1(x[1]), z0 = SET1(x[2]), most = SET1(distance2);
  long many = 0;
  for (int j = begin; j < end; j += LANES) {
    const vec dx = load_any(px + j) - x0, dy = load_any(py + j) - y0, dz = load_any(pz + j) - z0;
    unsigned hit = BITS(LE(dx * dx + dy * dy + dz * dz, most));
    if (end - j < LANES) hit &= (1u << (end - j)) - 1;
#if LANES == 8
    const __m256i row = _mm256_add_epi32(_mm256_set1_epi32(j),
                                         _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
    _mm256_storeu_si256((__m256i *) (list + many), _mm256_maskz_compress_epi32((__mmask8) hit, row));
    many += __builtin_popcount(hit);
#else
    for (int l = 0; l < LANES; l++) { /* without a branch: half of them are hits */
      list[many] = j + l;
      many += hit >> l & 1;
    }
#endif
  }
  return many;
}

/* COUNT polynomials of one degree at once: coefficient [COUNT][stride] */
INLINE void horner(int count, int degree, const double *coefficient, int stride, vec t, vec *value)
{
#pragma GCC unroll 8
  for (int f = 0; f < count; f++) value[f] = SET1(coefficient[f * stride + degree]);
#pragma GCC unroll 40
  for (int k = degree - 1; k >= 0; k--)
#pragma GCC unroll 8
    for (int f = 0; f < count; f++) value[f] = value[f] * t + SET1(coefficient[f * stride + k]);
}

/* A = I_0 - (b_i + b_j) I_1 + b_i b_j I_2 = (I_0 - b_i I_1) - b_j (I_1 - b_i I_2), and the same of J:
 * four polynomials for a target, out [4][SD_RADIAL_TERMS]. */
INLINE void polynomials_of_target(const sd_near_part *p, double b, int degree, double *out)
{
  for (int l = 0; l < 2; l++)
    for (int k = 0; k <= degree; k++) {
      const double c0 = p->coefficient[SD_I0 + l][k], c1 = p->coefficient[SD_I1 + l][k];
      const double c2 = p->coefficient[SD_I2 + l][k];
      out[l * SD_RADIAL_TERMS + k] = c0 - b * c1;
      out[(2 + l) * SD_RADIAL_TERMS + k] = c1 - b * c2;
    }
}

/* Forces. equal: all radii are a_ref, and two polynomials do. */
INLINE void near_forces(int equal, int degree, const sd_near_part *p)
{
  const vec range2 = SET1(p->range2), twice = SET1(2.0 / p->range2), one = SET1(1.0);
  const vec sixth = SET1(1.0 / 6.0), ref2 = SET1(p->ref2);
  for (int i = 0; i < p->n; i++) {
    const double *own = p->row + 8 * (long) p->target[i];
    const vec x = SET1(own[0]), y = SET1(own[1]), z = SET1(own[2]), a = SET1(own[3]);
    const vec a2 = a * a;
    double mine[4 * SD_RADIAL_TERMS];
    const double *c = p->coefficient[0];
    if (!equal) {
      polynomials_of_target(p, (own[3] * own[3] - p->ref2) / 6.0, degree, mine);
      c = mine;
    }
    vec u0 = SET1(0.0), u1 = u0, u2 = u0;
    const long end = p->first[i + 1];
    for (long k = p->first[i]; k < end; k += LANES) {
      const int *j = p->neighbor + k;
      vec xj, yj, zj, aj, F0, F1, F2, f, h, D[4];
      ROWS(p->row, j, xj, yj, zj, aj, F0, F1, F2);
      const vec dx = x - xj, dy = y - yj, dz = z - zj, r2 = dx * dx + dy * dy + dz * dz;
      const vec t = SELECT(LE(r2, range2), r2, range2) * twice - one;
      block(SD_TENSOR_RPY, SD_TAPER_NONE, one, r2, a, aj, a2 + aj * aj, &f, &h);
      horner(equal ? 2 : 4, degree, c, SD_RADIAL_TERMS, t, D);
      if (equal) {
        f -= D[0];
        h -= D[1];
      } else {
        const vec b = (aj * aj - ref2) * sixth;
        f -= D[0] - b * D[2];
        h -= D[1] - b * D[3];
      }
      const vec e = h * (dx * F0 + dy * F1 + dz * F2);
      u0 = (u0 + f * F0) + e * dx;
      u1 = (u1 + f * F1) + e * dy;
      u2 = (u2 + f * F2) + e * dz;
    }
    p->u[0][i] = total(u0);
    p->u[1][i] = total(u1);
    p->u[2][i] = total(u2);
  }
}

/* With torques all eight, whatever the radii. */
INLINE void near_torques(int degree, const sd_near_part *p)
{
  const vec range2 = SET1(p->range2), twice = SET1(2.0 / p->range2), one = SET1(1.0);
  const vec quarter = SET1(0.25), sixth = SET1(1.0 / 6.0), ref2 = SET1(p->ref2);
  for (int i = 0; i < p->n; i++) {
    const double *own = p->row + 8 * (long) p->target[i];
    const vec x = SET1(own[0]), y = SET1(own[1]), z = SET1(own[2]), a = SET1(own[3]);
    const vec bi = (a * a - ref2) * sixth;
    vec u[6];
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) u[k] = SET1(0.0);
    const long end = p->first[i + 1];
    for (long k = p->first[i]; k < end; k += LANES) {
      const int *j = p->neighbor + k;
      vec xj, yj, zj, aj, F[6], D[SD_RADIALS];
      grand b;
      ROWS(p->row, j, xj, yj, zj, aj, F[0], F[1], F[2]);
      TORQUES(p->torque_row, j, F[3], F[4], F[5]);
      const vec dx = x - xj, dy = y - yj, dz = z - zj, r2 = dx * dx + dy * dy + dz * dz;
      const vec t = SELECT(LE(r2, range2), r2, range2) * twice - one;
      grand_block(SD_TAPER_NONE, one, r2, a, aj, a * a + aj * aj, &b);
      horner(SD_RADIALS, degree, p->coefficient[0], SD_RADIAL_TERMS, t, D);
      const vec bj = (aj * aj - ref2) * sixth, sum = bi + bj, product = bi * bj;
      b.f -= D[SD_I0] - sum * D[SD_I1] + product * D[SD_I2];
      b.h -= D[SD_J0] - sum * D[SD_J1] + product * D[SD_J2];
      b.cij -= D[SD_K0] - bj * D[SD_K1];
      b.cji -= D[SD_K0] - bi * D[SD_K1];
      b.k -= quarter * D[SD_I1];
      b.e -= quarter * D[SD_J1];
      grand_add(&b, b.cji, b.cij, dx, dy, dz, F, u);
    }
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) p->u[k][i] = total(u[k]);
  }
}

/* A copy of each for each degree: loops of a length that is not known cost twice as much. */
#define OF_DEGREE(d)                                                          \
  static void near_equal_##d(const sd_near_part *p) { near_forces(1, d, p); } \
  static void near_any_##d(const sd_near_part *p) { near_forces(0, d, p); }   \
  static void near_torques_##d(const sd_near_part *p) { near_torques(d, p); }
SD_NEAR_DEGREES(OF_DEGREE)
#undef OF_DEGREE

static void near_part(const sd_near_part *p)
{
#define OF_DEGREE(d)                                        \
  if (p->degree == (d)) {                                   \
    if (p->width == 6) near_torques_##d(p);                 \
    else if (p->equal) near_equal_##d(p);                   \
    else near_any_##d(p);                                   \
    return;                                                 \
  }
  SD_NEAR_DEGREES(OF_DEGREE)
#undef OF_DEGREE
}
