/* Velocities of bodies without inertia from the forces on them, and forces from velocities: free
 * spheres and rigid bodies of points in one cloud, all of which feel each other.
 *
 *   M' l - K V = -u,   K^T l = F           l: forces of the points on the fluid, V: velocities
 *   M' = D^-1 + Omega + K dN K^T           of the bodies, u: the undisturbed fluid, F: the loads
 *
 * K V: velocities of the points, K^T l: forces of the bodies; a free sphere of one point has K = 1,
 * and then V = u + M F. dN: sd_body_shape.h. It is the stationary point of l.M' l / 2 + l.u under
 * the second line, and has one solution, as M' > 0. Held bodies have a given V, and no second line:
 * their F is part of the answer. All held, this is the resistance problem M' l = K V - u. Bodies that
 * are spun have a given W, and of the second line the forces alone: their torque is part of it. Those
 * that are pinned have a given U, and the torques alone.
 *
 * Solved by conjugate gradients inside the constraint. The preconditioner is the same system with
 * M' replaced by the blocks M_b' of the bodies alone, in which every body is for itself:
 *
 *   pre(r, f):  z = M_b'^-1 r,   V = N (f - K^T z),   l = z + M_b'^-1 K V,   N = (K^T M_b'^-1 K)^-1
 *               held: V as given, in the loop 0; spun: W, and U from R_UU U = (f - K^T z)_F - R_UW W;
 *               pinned: likewise W from U
 *   start:      (l, V) = pre(-u, F),   r = K V - u - M' l
 *   repeat:     (z, dV) = pre(r, 0);   stop when sqrt(r.z / e) < tolerance
 *               p = z + beta p,  q = dV + beta q,  w = M' p - K q,  alpha = r.p / p.w
 *               l += alpha p,  V += alpha q,  r -= alpha w
 *   answer:     l + z, V + dV
 *
 * K^T l = F holds from the start, so K^T p = 0. r.z = z.M_b' z >= 0 and p.w = p.M p, so that this
 * is conjugate gradients with all that is known of them (sd_cg.h). r must be updated with K q in
 * it: without, digits are lost near 1e-7. Free spheres need one product and no loop
 * (sd_free_spheres.h). e is the power spent as it stands: l.(K V - u), or that of the loads,
 * F.(V + dV - V_u), V_u the velocities with which the flow carries bodies alone, whichever is larger.
 * Bodies that fall together spend many times what they would alone. The tolerance is about an energy
 * norm, and V + dV is ten times better than it, a hundred times where all fall together.
 *
 * With lubrication L between spheres of different bodies (a tie, sd_tie.h)
 *
 *   K^T l + K_s^T L (K_s V - V_inf) = F    K_s V: velocities of the spheres
 *                                          L V_inf: sd_lubrication.h
 *
 * and the loop is the same: pre(r, f) then takes M_b'^-1 + X in the place of M_b'^-1, X what
 * close spheres resist by M itself (sd_tie_approach.h), and H = N^-1 + K_s^T (X + L) K_s in that of
 * N^-1. What is stiff is in H, so that gaps may be as small as they like. K^T l + K_s^T L K_s V = f
 * holds whatever H V is solved to, since l is made from what the second line leaves. A few digits
 * of the first V will do and less than one of the last, since beta makes the next direction
 * conjugate to the last one all the same. Here, but for X, r.z = z.M_b' z + dV.L dV and p.w = p.M p
 * + q.L q; of the power spent L has a part, so that l.(K V - u) is less than that of the loads. */
#ifndef SD_BODIES_H
#define SD_BODIES_H

#include "sd_body.h"

SD_BEGIN_C

typedef struct {
  /* [points] velocity, for width 6 and angular velocity, of the undisturbed fluid at the points */
  const double *u;
  /* [spheres] forces, for width 6 and torques, on the spheres, each about its own centre. Those of
   * held bodies are not read, nor torques on those that are spun, nor forces on those pinned */
  const double *F;
  /* [6 bodies] velocities of those held, W of those spun, U of those pinned; others' are not read.
   * NULL: they rest */
  const double *velocities;
  /* does l (with a tie, and v_with_l) hold a guess? Any will do: what it lacks of F is made up */
  int warm;
  /* max_iter: of products */
  double tolerance;
  int max_iter;
} sd_bodies_problem;

/* What comes out, in arrays of the caller */
typedef struct {
  /* [points] forces on the fluid. Of bodies of which some are held they are as the last product left them:
   * as a guess they give the same V again. Where all are free they are a part of a step of the
   * preconditioner further. Scratch on the way, also where the solve fails */
  double *l;
  /* with a tie, [spheres]: the velocities that go with l in a guess */
  double *v_with_l;
  /* [6 bodies] U of the centre, W; [spheres] velocities of the spheres */
  double *V, *v;
  /* [spheres] what each sphere exerts on the fluid in all, through its points and by lubrication:
   * over the spheres of a body it adds up to the load, or to what holds it */
  double *exerted;
} sd_bodies_answer;

typedef struct {
  /* with M; residual: sqrt(r.z / e) */
  int products;
  double residual;
  /* smallest p.w / p.D^-1 p met; 1: none */
  double curvature;
} sd_bodies_report;

/* Doubles of scratch. */
long sd_bodies_work(const sd_bodies *A);

/* work [sd_bodies_work]. On all ranks together. SD_OK; SD_EMAXITER: the answer is the best that there
 * is; SD_EINDEFINITE: p.w <= 0, as a cut-off makes it; SD_ENOTFINITE; that of sd_tie.h, or of a
 * function of the caller. */
sd_status sd_bodies_solve(const sd_bodies *A, const sd_bodies_problem *problem,
                          const sd_bodies_answer *answer, double *work, sd_bodies_report *report);

/* What keeps each sphere in its place on its body, f [3 spheres]: what it exerts on the fluid less its load
 * F, but for random forces of films in that, `random` [spheres] (NULL: none), which come from nowhere. Over a
 * body that is free it adds up to these. */
void sd_bodies_bonds(const sd_bodies *A, const double *exerted, const double *F, const double *random,
                     double *f);

/* Clumps with shells are carried by a strain otherwise than as spheres: adds K dE E to the flow u
 * [points] at their points. gradient [9 shaped]: of the fluid velocity over each body of a shape.
 * work [6 bodies + 6 spheres + rows]. */
void sd_bodies_carry(const sd_bodies *A, const double *gradient, double *work, double *u);

SD_END_C
#endif
