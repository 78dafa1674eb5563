#include "sd_bodies.h"

#include <math.h>
#include <string.h>

#include "sd_bodies_alone.h"
#include "sd_bodies_loop.h"
#include "sd_bodies_start.h"
#include "sd_free_spheres.h"
#include "sd_tie.h"

static long largest_body(const sd_bodies *A)
{
  long m = 0;
  for (int b = 0; b < A->shaped; b++)
    if (A->body[b].shape->m > m) m = A->body[b].shape->m;
  return A->points.width * m;
}

/* The scratch of a tie by bodies, where forces have fewer rows */
static long beside_forces(const sd_bodies *A)
{
  const long wanted = SD_TIE_OF_BODY * (long) sd_bodies_count(A);
  return A->tie && sd_bodies_unknowns(A) < wanted ? wanted : 0;
}

/* Are there points that no body has, hidden within other spheres? Nobody writes their rows. */
static int hides_points(const sd_bodies *A)
{
  long there = A->lone;
  for (int b = 0; b < A->shaped; b++) there += A->body[b].shape->m;
  return there < A->points.n;
}

long sd_bodies_work(const sd_bodies *A)
{
  return 4 * sd_bodies_unknowns(A) + 9 * 6 * (long) sd_bodies_count(A) + SD_TIE_OF_SPHERE * (long) A->spheres.n +
      2 * largest_body(A) + beside_forces(A) + 1;
}

static sd_status bodies_precondition(void *ctx, const double *r, double *z)
{
  sd_bodies_loop *c = ctx;
  memset(sd_bodies_motion_of(c, z), 0, sizeof(double) * (size_t) sd_bodies_motions(c));
  return sd_bodies_pre(c, r, NULL, 0, z, sd_bodies_motion_of(c, z));
}

/* p.D^-1 p of the forces */
static double bodies_square(void *ctx, const double *p)
{
  const sd_bodies *A = ((sd_bodies_loop *) ctx)->A;
  double sum = 0.0;
  for (long j = 0; j < sd_bodies_unknowns(A); j++) sum += p[j] * p[j] / A->D[j];
  return sum;
}

/* --- when to stop --- */

enum { NOISE, FORCES, LOADS };

/* r.D r, r.z's rounding: z is what pre leaves of r, whose rigid part it cancels; l.(K V - u);
 * F.(V + dV) */
static void bodies_measure(void *ctx, const sd_cg_vectors *v, double own[SD_CG_OWN])
{
  const sd_bodies_loop *c = ctx;
  const sd_bodies *A = c->A;
  const double *V = sd_bodies_motion_of(c, v->x), *moved = sd_bodies_move_spheres(A, V, c->on_spheres);
  double noise[3] = {0.0}, forces[3] = {0.0};    /* three of each, which do not wait for each other */
  for (sd_bodies_part part = {0}; sd_bodies_next(A, moved, &part);)
    for (long j = part.begin; j < part.end; j += 3)
      for (int d = 0; d < 3; d++) {
        noise[d] += A->D[j + d] * v->r[j + d] * v->r[j + d];
        forces[d] += v->x[j + d] * (part.v[j + d - part.begin] - c->problem->u[j + d]);
      }
  own[NOISE] = noise[0] + noise[1] + noise[2];
  own[FORCES] = forces[0] + forces[1] + forces[2];
  own[LOADS] = sd_bodies_spent(c, V) + sd_bodies_spent(c, sd_bodies_motion_of(c, v->z));
}

/* Of the first r of a guess. V takes what it lacks at once where the guess is so good that r is K
 * times what neighbours add to V, and r.z close to its noise; not with a tie, where l goes with V. A
 * guess that leaves more than bodies would spend alone is dropped. */
static sd_bodies_verdict judge_guess(sd_bodies_loop *c, double rz)
{
  const int settle = c->guess_is_new && !c->A->tie && rz < 1e4 * c->power.noise;
  c->guess_is_new = 0;
  if (settle) return SETTLE;
  return rz > c->power.alone ? BEGIN_ANEW : GO_ON;
}

/* r.z is blind to what the solution of the tie lacks. Where a push from far away moves a close pair as one, that is
 * far more than r.z, which it may make negative. Then the tie is solved more closely in all of the solve, which costs
 * products with L and the directions so far, but no product with the mobility. */
static int needs_closer_tie(sd_bodies_loop *c, double rz)
{
  const struct sd_tie *tie = c->A->tie;
  const sd_bodies_powers *power = &c->power;
  const double enough = fmax(power->floor, c->problem->tolerance * c->problem->tolerance * power->spent);
  if (!tie || c->tie_tolerance < 1e-9) return 0;
  c->closer = rz < -fmax(power->floor, power->noise) ? tie->anew : rz <= enough && tie->left > enough;
  if (c->closer) c->closest = c->tie_tolerance *= 0.01;
  return c->closer;
}

/* r.z is the power of what is still wrong, by the blocks of the bodies: below the floor it is
 * rounding of velocities that are the stream's own. */
static sd_status bodies_judge(void *ctx, const sd_cg_state *now, int *done)
{
  sd_bodies_loop *c = ctx;
  sd_bodies_powers *power = &c->power;
  sd_bodies_report *report = c->report;
  *done = 1;
  power->noise = sd_bodies_rounding * now->own[NOISE];
  power->spent = fmax(fabs(now->own[FORCES]), now->own[LOADS] - power->carried);
  if (now->steps > 0 && now->pp > 0.0)
    report->curvature = fmin(report->curvature, now->pw / now->pp);
  if (now->steps == 0 && c->verdict == GO_ON && c->problem->warm && c->closest == 1.0 &&
      (c->verdict = judge_guess(c, now->rz)) != GO_ON)
    return SD_OK;
  if (needs_closer_tie(c, now->rz)) return SD_OK;
  if (now->rz < -fmax(power->floor, power->noise)) return SD_EINDEFINITE;
  /* nothing is spent yet: a guess of no forces on bodies that are all held */
  const double wrong = fmax(now->rz, 0.0);
  report->residual = power->spent > 0.0 ? sqrt(wrong / power->spent) : wrong > power->floor;
  if (now->rz <= power->floor || report->residual < c->problem->tolerance) return SD_OK;
  if (report->products >= c->problem->max_iter) return SD_EMAXITER;
  c->tie_tolerance = sd_bodies_tie_tolerance(c, now->rz);
  *done = 0;
  return SD_OK;
}

/* V takes what it lacks. */
static void take_motion(sd_bodies_loop *c)
{
  double *V = sd_bodies_motion_of(c, c->v.x);
  const double *dV = sd_bodies_motion_of(c, c->v.z);
  for (long j = 0; j < sd_bodies_motions(c); j++) V[j] += dV[j];
}

static sd_status settle(sd_bodies_loop *c)
{
  take_motion(c);
  double *moved = c->v.w;
  sd_bodies_move(c->A, sd_bodies_motion_of(c, c->v.z), c->on_spheres, moved);
  for (long j = 0; j < sd_bodies_unknowns(c->A); j++) c->v.r[j] += moved[j];
  return SD_OK;
}

static sd_status bodies_iterate(sd_bodies_loop *c)
{
  const sd_cg cg = {.size = sd_bodies_unknowns(c->A) + sd_bodies_motions(c),
                    .paired = sd_bodies_unknowns(c->A),
                    .ctx = c,
                    .apply = sd_bodies_multiply,
                    .precondition = bodies_precondition,
                    .measure = bodies_measure,
                    .judge = bodies_judge,
                    .square = bodies_square,
                    .world = &c->A->world};
  sd_cg_state state;
  sd_status status = SD_OK;
  do {
    const sd_bodies_verdict last = c->verdict;
    if (last != GO_ON) status = last == SETTLE ? settle(c) : sd_bodies_start_cold(c);
    if (last == SETTLE) c->verdict = GO_ON;
    for (c->closer = 1; status == SD_OK && c->closer;) {
      c->closer = 0;
      status = sd_cg_run(&cg, &c->v, &state);
    }
    if (last == BEGIN_ANEW) break;
  } while (status == SD_OK && c->verdict != GO_ON);
  return status == SD_ESINGULAR ? SD_EINDEFINITE : status;
}

/* The norm in which the tie is solved is that of its factor. One that was kept may be blind to a film that was stiff
 * and is not now, so that r.z is negative: of what is left forces are made by bodies alone. Then it says nothing of the
 * mobility, and the solve begins anew with a factor of now. */
static sd_status bodies_iterate_tied(sd_bodies_loop *c)
{
  struct sd_tie *tie = c->A->tie;
  sd_status status = bodies_iterate(c);
  if (status != SD_EINDEFINITE || !tie || tie->anew) return status;
  tie->keep = 0;
  c->verdict = BEGIN_ANEW;
  status = sd_tie_make(c->A, sd_bodies_lend(c, c->v.p));
  return status == SD_OK ? bodies_iterate(c) : status;
}

/* --- what comes of it --- */

/* K^T l + K_s^T L K_s V = F + K_s^T L V_inf. Torques on those that are spun are not read, nor forces on
 * those that are pinned. */
static void take_loads(sd_bodies_loop *c)
{
  const sd_bodies *A = c->A;
  sd_rigid_collect(&A->spheres, c->problem->F, sd_bodies_count(A), c->loads);
  for (int b = 0; b < sd_bodies_count(A); b++) {
    const sd_body_known known = sd_bodies_known(A, b);
    if (known == SD_BODY_SPUN || known == SD_BODY_PINNED)
      memset(c->loads + 6 * (long) b + (known == SD_BODY_SPUN ? 3 : 0), 0, 3 * sizeof(double));
  }
  memcpy(c->f, c->loads, sizeof(double) * (size_t) sd_bodies_motions(c));
  if (!A->tie) return;
  const sd_rigid films = sd_bodies_films(A);
  sd_rigid_collect(&films, A->tie->L->carried, sd_bodies_count(A), c->bodies);
  for (long j = 0; j < sd_bodies_motions(c); j++) c->f[j] += c->bodies[j];
}

/* What the next guess takes of the last z, where it will be on the line through two answers. Errors of answers
 * live on in such a guess: e' = g (2 e - e_before) with g = 1 - part lambda, lambda an eigenvalue of the
 * preconditioned matrix. With part 0 they grow from step to step until a product of its own takes them away. They
 * fade for g between -1/3 and 1, so for lambda up to 4 / (3 part). Free bodies have lambda up to about 4.5 (films,
 * volume fraction 0.45); those that are held disturb each other from afar, and lambda grows with their number.
 * Source: the predictor that is always stable of Kolafa, J. Comput. Chem. 25, 335 (2004). */
static const double taken_up = 0.25;

static void leave_guess(const sd_bodies_loop *c, const sd_bodies_answer *answer)
{
  const sd_bodies *A = c->A;
  const double part = A->known ? 0.0 : taken_up;
  const double *V = sd_bodies_motion_of(c, c->v.x), *dV = sd_bodies_motion_of(c, c->v.z);
  for (long j = 0; j < sd_bodies_unknowns(A); j++) answer->l[j] = c->v.x[j] + part * c->v.z[j];
  if (!A->tie) return;
  for (long j = 0; j < sd_bodies_motions(c); j++) c->bodies[j] = V[j] + part * dV[j];
  sd_rigid_move(&A->spheres, c->bodies, answer->v_with_l);
}

/* The last pre(r, 0) is free, and without it free spheres would have their lone velocities. */
static sd_status finish(sd_bodies_loop *c, const sd_bodies_answer *answer)
{
  const sd_bodies *A = c->A;
  const long rows = sd_bodies_unknowns(A), loads = sd_bodies_loads(A);
  double *V = sd_bodies_motion_of(c, c->v.x), *l = c->v.r;
  leave_guess(c, answer);
  take_motion(c);
  memcpy(answer->V, V, sizeof(double) * (size_t) sd_bodies_motions(c));
  sd_rigid_move(&A->spheres, V, answer->v);
  for (long j = 0; j < rows; j++) l[j] = c->v.x[j] + c->v.z[j];
  if (A->points.whole)
    sd_rigid_collect(&A->points, l, A->spheres.n, answer->exerted);
  else
    memcpy(answer->exerted, l, sizeof(double) * (size_t) loads);
  if (!A->tie) return SD_OK;
  const sd_rigid films = sd_bodies_films(A);
  const double *there = sd_rigid_moved(&films, V, c->on_spheres + loads);
  const sd_status status = sd_lubrication_apply(A->tie->L, there, c->on_spheres);
  for (long j = 0; j < loads; j++)
    answer->exerted[j] += c->on_spheres[j] - A->tie->L->carried[j];
  return status;
}

sd_status sd_bodies_solve(const sd_bodies *A, const sd_bodies_problem *problem,
                          const sd_bodies_answer *answer, double *work, sd_bodies_report *report)
{
  int only;
  sd_status status = sd_free_spheres_only(A, &only);
  if (status != SD_OK) return status;
  if (only) return sd_free_spheres_solve(A, problem, answer, report);
  const long rows = sd_bodies_unknowns(A), bodies = 6 * (long) sd_bodies_count(A), size = rows + bodies;
  double *r = work + 3 * size, *by_bodies = r + rows, *on_spheres = by_bodies + 6 * bodies;
  sd_bodies_loop c = {
      .A = A,
      .problem = problem,
      .v = {work, work + size, work + 2 * size, r, answer->l},
      .loads = by_bodies,
      .f = by_bodies + bodies,
      .bodies = by_bodies + 2 * bodies,
      .on_spheres = on_spheres,
      .alone = on_spheres + SD_TIE_OF_SPHERE * (long) A->spheres.n,
      .shells = sd_bodies_shells(A),
      .hides = hides_points(A),
      .guess_is_new = problem->warm,
      .closest = 1.0,
      .report = report,
  };
  if (beside_forces(A) > 0) c.tied = c.alone + 2 * largest_body(A);
  *report = (sd_bodies_report){.curvature = 1.0};
  if (c.hides) memset(work, 0, sizeof(double) * (size_t) (2 * size));
  if (problem->warm) memcpy(c.v.x, answer->l, sizeof(double) * (size_t) rows);
  if (A->tie && (status = sd_tie_make(A, sd_bodies_lend(&c, c.v.p))) != SD_OK) return status;
  take_loads(&c);
  status = problem->warm ? sd_bodies_start_warm(&c, answer->v_with_l) : sd_bodies_start_cold(&c);
  if (status == SD_OK) status = bodies_iterate_tied(&c);
  if (status != SD_OK && status != SD_EMAXITER) return status;
  const sd_status last = finish(&c, answer);
  return last == SD_OK ? status : last;
}

void sd_bodies_bonds(const sd_bodies *A, const double *exerted, const double *F, const double *random,
                     double *f)
{
  for (long k = 0; k < A->spheres.n; k++)
    for (int d = 0; d < 3; d++) {
      const long at = A->spheres.width * k + d;
      f[3 * k + d] = exerted[at] - F[at] + (random ? random[at] : 0.0);
    }
}
