/* Velocities of bodies without inertia from the forces on them: free spheres and rigid clumps of
 * spheres in one cloud, all of which feel each other.
 *
 *   M' l - K V = -u,   K^T l = F           l: forces of the spheres on the fluid, V: velocities
 *   M' = D^-1 + Omega + K dN K^T           of the bodies, u: the undisturbed fluid, F: the loads
 *
 * K V: velocities of the spheres, K^T l: forces of the bodies; a free sphere is its own body, K =
 * 1, and then V = u + M F. dN: sd_body_shape.h. It is the stationary point of l.M' l / 2 + l.u
 * under the second line, and has one solution, as M' > 0.
 *
 * Solved by conjugate gradients inside the constraint. The preconditioner is the same system with
 * M' replaced by the blocks M_b' of the bodies alone, in which every body is for itself:
 *
 *   pre(r, f):  z = M_b'^-1 r,   V = N (f - K^T z),   l = z + M_b'^-1 K V,   N = (K^T M_b'^-1 K)^-1
 *   start:      (l, V) = pre(-u, F),   r = K V - u - M' l
 *   repeat:     (z, dV) = pre(r, 0);   stop when sqrt(r.z / e) < tolerance
 *               p = z + beta p,  q = dV + beta q,  w = M' p - K q,  alpha = r.z / p.w
 *               l += alpha p,  V += alpha q,  r -= alpha w
 *   answer:     V + dV
 *
 * K^T l = F holds from the start, so K^T p = 0, and of dN only K dN F is ever seen. r.z = z.M_b' z
 * >= 0 and p.w = p.M p, so that this is conjugate gradients with all that is known of them. r must
 * be updated with K q in it: without, digits are lost near 1e-7. Free spheres leave after their one
 * product with the exact answer. e is the power spent as it stands: l.(K V - u), or that of the
 * loads, F.(K (V + dV) - u) by spheres, whichever is larger; of the answer both are the same.
 * Bodies that fall together spend many times what they would alone. The tolerance is about an
 * energy norm, and V + dV is ten times better than it, a hundred times where all fall together.
 *
 * With lubrication L between spheres of different bodies (a tie, sd_tie.h)
 *
 *   K^T (l + L (K V - V_inf)) = F          L V_inf: sd_lubrication.h
 *
 * and the loop is the same: pre(r, f) then takes M_b'^-1 + X in the place of M_b'^-1, X what
 * close spheres resist by M itself (sd_tie_approach.h), and H = N^-1 + K^T (X + L) K in that of
 * N^-1. What is stiff is in H, so that gaps may be as small as they like. K^T l + K^T L K V = f
 * holds whatever H V is solved to, since l is made from V. A few digits of the first V will do and
 * less than one of the last, since beta makes the next direction conjugate to the last one all the
 * same. Here, but for X, r.z = z.M_b' z + dV.L dV and p.w = p.M p + q.L q; of the power spent L has
 * a part, so that l.(K V - u) is less than that of the loads. */
#ifndef SD_BODIES_H
#define SD_BODIES_H

#include "sd_bodies_rigid.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  /* [width n] velocity and angular velocity of the undisturbed fluid at the spheres */
  const double *u;
  /* [width n] forces and torques on the spheres, each about its own centre */
  const double *F;
  /* does l (with a tie, and before) hold a guess? Any will do: what it lacks of F is made up */
  int warm;
  /* max_iter: of products */
  double tolerance;
  int max_iter;
} sd_bodies_problem;

typedef struct {
  /* [width n] forces of the spheres on the fluid, as the last product left them: as a guess they
   * give the same V again */
  double *l;
  /* [width n] velocities of the spheres */
  double *v;
  /* [6 clumps] U of the centroid and W of the clumps */
  double *V;
  /* with a tie, [width n]: the velocities that go with l in a guess; and what the spheres exert on
   * the fluid by lubrication, l for the guess and `near` adding up to all that they exert */
  double *before, *near;
} sd_bodies_motion;

typedef struct {
  /* with M; residual: sqrt(r.z / e) */
  int products;
  double residual;
} sd_bodies_report;

/* Doubles of scratch for n spheres and what else is in A. */
long sd_bodies_work(const sd_bodies *A);

/* work [sd_bodies_work]. SD_OK; SD_EMAXITER: motion is the best that there is; SD_EINDEFINITE: p.w
 * <= 0, as a cut-off makes it; SD_ENOTFINITE; that of sd_tie.h, or of a function of the caller. */
sd_status sd_bodies_velocities(const sd_bodies *A, const sd_bodies_problem *problem,
                               const sd_bodies_motion *motion, double *work,
                               sd_bodies_report *report);

#ifdef __cplusplus
}
#endif
#endif
