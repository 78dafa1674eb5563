/* Solvers of the resistance problem: the force on every sphere from its slip velocity.
 *
 *   M F = s,   M = D^-1 + Omega,   D = diag(6 pi eta_i a_i),   s = u_inf - v
 *
 * With rotation the unknowns of a sphere are force and torque (F T), the right-hand side is slip
 * velocity and slip angular velocity, and D has 8 pi eta a^3 in the rows of the torque. D = 0: the
 * sphere takes no part, F = 0.
 *
 * Both solvers stop by the same number, the residual of this system with the rows of each sphere
 * scaled by its own 6 pi eta a (torques by 8 pi eta a^3 and the length sqrt(4/3) a, which makes
 * them forces):
 *
 *   residual = |D (s - M F)| / |D s|     (Euclidean norms over all spheres of all ranks;
 *                                        radii 1:100 count alike)
 *
 * The core knows no ranks: the caller's functions do. No allocation; nothing is printed; the same
 * operations in the same order for the same input. */
#ifndef SD_SOLVE_H
#define SD_SOLVE_H

#include "sd_status.h"
#include "sd_world.h"

SD_BEGIN_C

/* The caller's functions return SD_OK or why they failed, and never throw: a solver that gets
 * another status returns it at once and calls no other of them. One that fails on a single rank
 * leaves the others waiting: its caller has to end them. */

/* u = Omega F, the pair part of M: F, u [width n] of this rank's spheres. Refreshes whatever
 * ghosts it needs. */
typedef sd_status sd_apply(void *ctx, const double *F, double *u);
/* z = P r, P an approximation of the inverse of M: symmetric, positive definite, the same in all
 * calls of one solve. r [width n] are velocities, z forces; 0 for spheres that take no part
 * (sd_sparse.h and sd_blocks.h have one each). */
typedef sd_status sd_precondition(void *ctx, const double *r, double *z);

typedef struct {
  /* spheres of this rank */
  int n;
  /* [n] 6 pi eta a; 0: the sphere takes no part */
  const double *drag;
  /* [n] 8 pi eta a^3; NULL: no rotation. Unknowns of a sphere (width): 3, with rotation 6 */
  const double *spin;
  sd_apply *apply;
  void *apply_ctx;
  /* sum */
  sd_world world;
  /* gradients; NULL: D, the diagonal */
  sd_precondition *precondition;
  void *precondition_ctx;
  /* gradients: F holds a guess when the solver is called */
  int warm;
} sd_system;

typedef struct {
  int iterations;
  /* of the F returned, computed from its definition */
  double residual;
  /* substitution: last factor of the residual from one iteration to the next */
  double growth;
  /* gradients: smallest p.Mp / p.D^-1 p met, never below the smallest eigenvalue of D M */
  double curvature;
  /* gradients: smallest and largest Ritz value, estimates from inside of the extreme eigenvalues of
   * P M; without preconditioner these are the eigenvalues of the mobility scaled to unit diagonal.
   * They get good as the solver converges. 0: no iteration made */
  double ritz_smallest, ritz_largest;
  /* of the matrix, checks included */
  int products;
} sd_solve_report;

/* Doubles of scratch that either solver needs for n spheres. */
#define SD_SOLVE_WORK(n, width) (7 * (long) (n) * (width))

/* Algorithm 1, successive substitution (Joung, Phan-Thien & Fan 2001): F^0 = D s,
 * F^k = D (s - Omega F^(k-1)).
 *   slip [width n] in, F [width n] out, work [SD_SOLVE_WORK(n, width)]
 * Converges if and only if the largest eigenvalue of the mobility matrix scaled to unit diagonal
 * is below 2: not for three touching spheres in a row. The scaled matrix is symmetric, so the
 * factor by which the residual changes in the norm of D^-1 never falls from one iteration to the
 * next: once it is 1, within 1e-9, the iteration can never converge. SD_OK; SD_EMAXITER after
 * max_iter substitutions; SD_EDIVERGED; SD_ESTAGNATED; SD_ENOTFINITE; that of a function of the
 * caller which has failed: F is then the best that the solver had. */
sd_status sd_solve_substitution(const sd_system *A, const double *slip, double tolerance,
                                int max_iter, double *F, double *work, sd_solve_report *report);

/* Algorithm 2, preconditioned conjugate gradients (sd_cg.h). Conjugate gradients minimise the energy norm of
 * the error and their residual goes up and down; the F returned is their iterates after minimal
 * residual smoothing (Schoenauer; Zhou & Walker 1994), whose residual only falls and reaches the
 * tolerance some iterations earlier. The residual is the one above with any preconditioner.
 *
 * Two sums over the ranks an iteration (sd_cg.h).
 *
 * The residual is computed from its definition before the solver says SD_OK, and the iteration
 * goes on from there if rounding has led it astray. Warm: one product gives the residual of the
 * guess, and when that is below the tolerance F is left as it is. A guess that is worse than F = 0
 * is dropped.
 *
 * Where M is singular (equal spheres at one point) and the slip allows an answer, this is one of
 * many: only the total of such spheres means anything. A preconditioner blows up rounding along
 * those directions; when only that is left the solver goes on without it. SD_OK; SD_EMAXITER;
 * SD_ESTAGNATED; SD_ENOTFINITE; that of a function of the caller which has failed, as above;
 * SD_EINDEFINITE: a direction of negative curvature p.Mp < 0, as a cut-off makes them: any answer
 * would be noise; SD_ESINGULAR: p.Mp = 0 within rounding, and the slip along p is not: equal
 * spheres at one point with different velocities. */
sd_status sd_solve_gradients(const sd_system *A, const double *slip, double tolerance, int max_iter,
                             double *F, double *work, sd_solve_report *report);

SD_END_C
#endif
