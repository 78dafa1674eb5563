/* Kernels of the fast product of forces and torques (width 6 in sd_product.h); included by
 * sd_product_kernel.h. */

/* Target i against the vectors of sources from j0 to j1. both: the sources receive from the target
 * as well. */
INLINE void grand_tile(int both, sd_taper kind, const sd_packed *p, int i, int j0, int j1)
{
  const double *restrict px = p->x, *restrict py = p->y, *restrict pz = p->z, *restrict pa = p->a;
  const vec inverse = inverse_range(kind, p);
  const vec x = SET1(px[i]), y = SET1(py[i]), z = SET1(pz[i]), a = SET1(pa[i]);
  vec F[6], u[6];
#pragma GCC unroll 6
  for (int k = 0; k < 6; k++) {
    F[k] = SET1(p->f[k][i]);
    u[k] = SET1(0.0);
  }
  for (int j = j0; j < j1; j += LANES) {
    const vec dx = x - LOAD(px + j), dy = y - LOAD(py + j), dz = z - LOAD(pz + j);
    const vec aj = LOAD(pa + j), r2 = dx * dx + dy * dy + dz * dz;
    vec G[6];
    grand b;
    grand_block(kind, inverse, r2, a, aj, a * a + aj * aj, &b);
    if (!both && i >= j && i < j + LANES) {
      vec f = b.f, k = b.k; /* the others are 0 or multiply r */
      leave_out_self(i - j, &f, &k);
      b.f = f;
      b.k = k;
    }
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) G[k] = LOAD(p->f[k] + j);
    grand_add(&b, b.cji, b.cij, dx, dy, dz, G, u);
    if (both) {
      vec v[6];
#pragma GCC unroll 6
      for (int k = 0; k < 6; k++) v[k] = LOAD(p->u[k] + j);
      /* seen from the source, r is -r and the two cross products change places */
      grand_add(&b, -b.cij, -b.cji, dx, dy, dz, F, v);
#pragma GCC unroll 6
      for (int k = 0; k < 6; k++) STORE(p->u[k] + j, v[k]);
    }
  }
#pragma GCC unroll 6
  for (int k = 0; k < 6; k++) p->u[k][i] += total(u[k]);
}

/* Sixteen columns of so many spheres are 16 KiB, half of a first-level cache. */
enum { GRAND_CHUNK = 128 };

INLINE void grand_symmetric(sd_taper kind, const sd_packed *p, int part, int parts)
{
  for (int c = 0; c < p->padded; c += GRAND_CHUNK) {
    const int end = c + GRAND_CHUNK < p->padded ? c + GRAND_CHUNK : p->padded;
    for (int i = 0; i < end; i += LANES) {
      if (!mine(i / LANES, part, parts)) continue;
      const int from = i + LANES > c ? i + LANES : c;
      for (int t = i; t < i + LANES; t++) {
        if (i >= c) grand_tile(0, kind, p, t, i, i + LANES);
        if (from < end) grand_tile(1, kind, p, t, from, end);
      }
    }
  }
}

INLINE void grand_list(sd_taper kind, const sd_packed *p, const sd_pairs *pairs)
{
  const vec inverse = inverse_range(kind, p);
  for (int i = 0; i < pairs->n; i++) {
    const double *own = p->row + 8 * (long) i;
    const vec x = SET1(own[0]), y = SET1(own[1]), z = SET1(own[2]), a = SET1(own[3]);
    const long end = pairs->first[i + 1];
    vec u[6];
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) u[k] = SET1(0.0);
    for (long k = pairs->first[i]; k < end; k += LANES) {
      int rest[LANES];
      const int *j = neighbors(pairs, k, end, p->n, rest);
      vec xj, yj, zj, aj, F[6];
      grand b;
      ROWS(p->row, j, xj, yj, zj, aj, F[0], F[1], F[2]);
      TORQUES(p->torque_row, j, F[3], F[4], F[5]);
      const vec dx = x - xj, dy = y - yj, dz = z - zj, r2 = dx * dx + dy * dy + dz * dz;
      grand_block(kind, inverse, r2, a, aj, a * a + aj * aj, &b);
      grand_add(&b, b.cji, b.cij, dx, dy, dz, F, u);
    }
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) p->u[k][i] = total(u[k]);
  }
}

static void run_grand_symmetric(const sd_packed *p, int part, int parts)
{
  TAPERS(grand_symmetric, p, part, parts);
}

static void run_grand_list(const sd_packed *p, const sd_pairs *pairs)
{
  TAPERS(grand_list, p, pairs);
}
