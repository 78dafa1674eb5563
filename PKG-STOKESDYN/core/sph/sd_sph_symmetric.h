/* Symmetric 3 x 3 matrices of neighbours: xx yy zz xy xz yz. For sources only. */
#ifndef SD_SPH_SYMMETRIC_H
#define SD_SPH_SYMMETRIC_H

typedef struct {
  double a[6];
} sd_sph_symmetric;

/* M^-1 = cofactors / determinant. */
static inline sd_sph_symmetric sd_sph_cofactors(const sd_sph_symmetric *M)
{
  const double *a = M->a;
  return (sd_sph_symmetric){{a[1] * a[2] - a[5] * a[5], a[0] * a[2] - a[4] * a[4],
                             a[0] * a[1] - a[3] * a[3], a[4] * a[5] - a[3] * a[2],
                             a[3] * a[5] - a[4] * a[1], a[3] * a[4] - a[0] * a[5]}};
}

static inline double sd_sph_determinant(const sd_sph_symmetric *M, const sd_sph_symmetric *cofactor)
{
  return M->a[0] * cofactor->a[0] + M->a[3] * cofactor->a[3] + M->a[4] * cofactor->a[4];
}

/* Is the smallest eigenvalue above the limit? Exactly where M - limit I is positive definite, that
 * is where all its leading minors are positive: no eigenvalue is computed. */
static inline int sd_sph_above(const sd_sph_symmetric *M, double limit)
{
  sd_sph_symmetric S = *M;
  for (int d = 0; d < 3; d++) S.a[d] -= limit;
  const sd_sph_symmetric cofactor = sd_sph_cofactors(&S);
  return S.a[0] > 0.0 && cofactor.a[2] > 0.0 && sd_sph_determinant(&S, &cofactor) > 0.0;
}

#endif
