/* K and its transpose: motions of bodies and of their spheres, for the loop (sd_bodies.c) and for
 * what ties bodies together (sd_tie.c). ghosts [width ghosts]: scratch. */
#ifndef SD_BODIES_INTERNAL_H
#define SD_BODIES_INTERNAL_H

#include "sd_bodies.h"
#include "sd_linear.h"

/* (force, torque) or (U, W) from space to the axes of a shape, and back */
static inline void sd_bodies_to_shape(const double R[9], const double space[6], double shape[6])
{
  sd_multiply3t(R, space, shape);
  sd_multiply3t(R, space + 3, shape + 3);
}
static inline void sd_bodies_to_space(const double R[9], const double shape[6], double space[6])
{
  sd_multiply3(R, shape, space);
  sd_multiply3(R, shape + 3, space + 3);
}

static inline void sd_bodies_multiply6(const double A[36], const double x[6], double y[6])
{
  for (int p = 0; p < 6; p++) {
    y[p] = 0.0;
    for (int q = 0; q < 6; q++) y[p] += A[6 * p + q] * x[q];
  }
}

/* The row of sphere k of clump b, of whatever rank it is */
static inline const double *sd_bodies_row(const sd_bodies *A, const double *rows,
                                          const double *ghosts, int b, int k)
{
  const int j = A->member[A->first[b] + k];
  return j < A->n ? rows + 6 * (long) j : ghosts + 6 * (long) (j - A->n);
}

/* The ghosts of rows [width n]; SD_OK or that of the caller's function */
static inline sd_status sd_bodies_refresh(const sd_bodies *A, const double *rows, double *ghosts)
{
  return A->refresh ? A->refresh(A->refresh_ctx, rows, ghosts, A->width) : SD_OK;
}

/* out += K V, V in the axes of the shape, in the rows of this rank's spheres of clump b; those of
 * other ranks are written there, by the same arithmetic */
void sd_bodies_add_rigid(const sd_bodies *A, int b, const double V[6], double *out);

/* f [6 clumps] = K^T rows; SD_OK or that of refresh */
sd_status sd_bodies_onto_clumps(const sd_bodies *A, const double *rows, double *ghosts, double *f);

/* out += sign K dN f, f [6 clumps] */
void sd_bodies_shells(const sd_bodies *A, const double *f, double sign, double *out);

#endif
