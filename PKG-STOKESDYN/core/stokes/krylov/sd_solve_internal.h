/* What both solvers of sd_solve.h share: scaled residuals and their norms. */
#ifndef SD_SOLVE_INTERNAL_H
#define SD_SOLVE_INTERNAL_H

#include "sd_solve.h"

/* Unknowns of a sphere */
static inline int sd_solve_width(const sd_system *A)
{
  return A->spin ? 6 : 3;
}

/* D in row k of sphere i; 0: the sphere takes no part */
static inline double sd_solve_diagonal(const sd_system *A, long i, int k)
{
  return k < 3 ? A->drag[i] : A->spin[i];
}

/* Two norms of a scaled residual z = D (s - M F), whose rows are forces and torques:
 *   plain     sum of D_F/D z^2, D_F the drag of the row's sphere: 1 for a force, and a torque is
 *             made a force by the length sqrt(4/3) a. The tolerance is about this one.
 *   natural   z.D^-1 z, the power that z dissipates. Conjugate gradients and the factor by which
 *             substitution converges are about this one. */
typedef struct {
  double plain, natural;
} sd_solve_squares;

/* F [width n] = D slip, the drag of spheres that do not see each other, and its squares over all ranks */
sd_status sd_solve_free_draining(const sd_system *A, const double *slip, double *F, sd_solve_squares *of);

/* out [width n] = D (slip - M F) = D (slip - Omega F) - F, given Omega F in out, and its squares over all
 * ranks */
sd_status sd_solve_residual(const sd_system *A, const double *slip, const double *F, double *out,
                            sd_solve_squares *of);

#endif
