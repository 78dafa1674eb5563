/* The kernel of what the points of a group do to each other: a product with a dense block. Included by
 * sd_ewald_kernels.c. */

/* Sums of so many vectors stay in registers. */
enum { OWN_VECTORS = 5, OWN_NUMBERS = 3 * SD_GROUP_POINTS };

static void own_block(const double *B, double scale, const double *F, double *u)
{
  for (int part = 0; part < OWN_NUMBERS; part += OWN_VECTORS * LANES) {
    double out[OWN_VECTORS * LANES];
    vec sum[OWN_VECTORS];
#pragma GCC unroll 5
    for (int l = 0; l < OWN_VECTORS; l++) sum[l] = all(0.0);
    for (int j = 0; j < OWN_NUMBERS; j++) {
      const double *row = B + SD_GROUP_ROW * j + part;
      const vec f = all(F[j]);
#pragma GCC unroll 5
      for (int l = 0; l < OWN_VECTORS; l++) sum[l] += f * load_any(row + LANES * l);
    }
#pragma GCC unroll 5
    for (int l = 0; l < OWN_VECTORS; l++) store_any(out + LANES * l, sum[l]);
    const int many = OWN_NUMBERS - part < OWN_VECTORS * LANES ? OWN_NUMBERS - part : OWN_VECTORS * LANES;
    for (int i = 0; i < many; i++) u[part + i] += scale * out[i];
  }
}
