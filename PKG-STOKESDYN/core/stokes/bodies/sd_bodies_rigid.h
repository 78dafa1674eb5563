/* The bodies of sd_bodies.h, and K and its transpose: their motions and those of their spheres, for
 * the loop and for what ties bodies together (sd_tie.h). ghosts [width ghosts]: scratch. */
#ifndef SD_BODIES_RIGID_H
#define SD_BODIES_RIGID_H

#include "sd_body_shape.h"
#include "sd_linear.h"
#include "sd_mobility.h"
#include "sd_solve.h"

#ifdef __cplusplus
extern "C" {
#endif

struct sd_tie;

/* Rows have `width` numbers a sphere, 3 or 6; with clumps or a tie 6. All is in space axes. */
typedef struct {
  /* spheres of this rank, that is rows; those of other ranks that are in clumps with them */
  int n, ghosts, width;
  /* [n] 6 pi eta a, 8 pi eta a^3 (NULL for width 3) */
  const double *drag, *spin;
  /* [lone] rows of the free spheres */
  int lone;
  const int *loner;
  /* rigid clumps of which this rank has a sphere; a clump is the same, to rounding, on each rank
   * that knows it */
  int clumps;
  /* [clumps + 1] into member: rows of the spheres in the order of the shape, n + g for ghost g */
  const int *first, *member;
  /* [clumps] shape, [9 clumps] pose R (space = R shape), [clumps] viscosity */
  const sd_body_shape *const *shape;
  const double *pose, *eta;
  /* Omega, without the diagonal; sum over the ranks (NULL: one rank) */
  sd_apply *apply;
  void *apply_ctx;
  sd_sum *sum;
  void *sum_ctx;
  /* rows [width n] -> those of the ghosts [width ghosts]; NULL: there are none on any rank */
  sd_status (*refresh)(void *ctx, const double *rows, double *ghosts, int width);
  void *refresh_ctx;
  /* lubrication; NULL: none */
  struct sd_tie *tie;
} sd_bodies;

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

/* 6 pi eta a or 8 pi eta a^3: number d of row i */
static inline double sd_bodies_drag(const sd_bodies *A, long i, int d)
{
  return (d < 3 ? A->drag : A->spin)[i];
}

/* Rows of clump b := 0 */
static inline void sd_bodies_clear(const sd_bodies *A, int b, double *rows)
{
  for (int k = A->first[b]; k < A->first[b + 1]; k++)
    for (int d = 0; d < 6 && A->member[k] < A->n; d++) rows[6 * (long) A->member[k] + d] = 0.0;
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

/* Clumps with shells are carried by a strain otherwise than as spheres: adds K dE E to the flow u
 * [width n] at their spheres. gradient [9 clumps]: of the fluid velocity over each clump. */
void sd_bodies_carry(const sd_bodies *A, const double *gradient, double *u);

/* out [width n] += K dN K^T l, what shells add to D^-1 + Omega; for those who are given velocities
 * and solve M' l = K V - u. work [6 clumps + width ghosts]. SD_OK, or that of refresh. */
sd_status sd_bodies_add_shells(const sd_bodies *A, const double *l, double *work, double *out);

#ifdef __cplusplus
}
#endif
#endif
