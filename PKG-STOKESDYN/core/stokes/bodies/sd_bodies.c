#include "sd_bodies.h"

#include <math.h>
#include <string.h>

#include "sd_bodies_alone.h"
#include "sd_cg.h"
#include "sd_free_spheres.h"
#include "sd_tie.h"

/* What the loop goes by: what of r.z is rounding, and the power spent as it stands; what the bodies
 * would spend alone, the part of the loads' power that the flow has, and the power of slips that are
 * rounding */
typedef struct {
  double noise, spent, alone, carried, floor;
} powers;

/* What comes of a guess: the loop goes on, r is to lose what V takes at once, or the guess is bad */
typedef enum { GO_ON, SETTLE, BEGIN_ANEW } verdict;

typedef struct {
  const sd_bodies *A;
  const sd_bodies_problem *problem;
  /* x = (l, V), z = pre(r, 0), p: [rows + 6 bodies]; r, w: [rows] */
  sd_cg_vectors v;
  /* [6 bodies] the loads, and those with L V_inf, of the second line */
  double *loads, *f;
  /* scratch: rows; spheres, twice; bodies, three times; of sd_bodies_alone */
  double *rows, *on_spheres, *bodies, *alone;
  int shells, guess_is_new;
  verdict verdict;
  double tie_tolerance;
  powers power;
  sd_bodies_report *report;
} loop;

static long largest_body(const sd_bodies *A)
{
  long m = 0;
  for (int b = 0; b < A->shaped; b++)
    if (A->body[b].shape->m > m) m = A->body[b].shape->m;
  return A->points.width * m;
}

long sd_bodies_work(const sd_bodies *A)
{
  return 6 * sd_bodies_unknowns(A) + 8 * 6 * (long) sd_bodies_count(A) + 12 * (long) A->spheres.n +
      2 * largest_body(A) + 1;
}

static long motions(const loop *c)
{
  return 6 * (long) sd_bodies_count(c->A);
}

/* V behind the forces of a vector of the loop */
static double *motion_of(const loop *c, double *vector)
{
  return vector + sd_bodies_unknowns(c->A);
}

/* --- the preconditioner --- */

/* pre(r, f): l, and V, which holds velocities of the held bodies on entry (moved: not all 0) and 0
 * elsewhere. By the second line tied bodies bear L V less, whatever digits V has. */
static sd_status pre(loop *c, const double *r, const double *f, int moved, double *l, double *V)
{
  const sd_bodies *A = c->A;
  const long size = motions(c);
  double *load = c->bodies, *tied = load + size, *borne = tied + size;
  if (!A->tie) {
    sd_bodies_alone(A, r, f, c->alone, l, V);
    return SD_OK;
  }
  if (f)
    memcpy(load, f, sizeof(double) * (size_t) size);
  else
    memset(load, 0, sizeof(double) * (size_t) size);
  if (r) sd_bodies_alone_bear(A, r, c->alone, load);
  memcpy(tied, V, sizeof(double) * (size_t) size);
  const sd_status status =
      sd_tie_solve(A, load, r, c->tie_tolerance, moved, tied, borne, c->rows);
  if (status != SD_OK) return status;
  for (long j = 0; j < size; j++) load[j] = (f ? f[j] : 0.0) - borne[j];
  sd_bodies_alone(A, r, load, c->alone, l, V);
  for (int b = 0; b < sd_bodies_count(A); b++)
    if (sd_tie_binds(A, b)) memcpy(V + 6 * (long) b, tied + 6 * (long) b, 6 * sizeof(double));
  for (long j = 0; sd_tie_has_springs(A) && j < sd_bodies_unknowns(A); j++) l[j] += c->rows[j];
  return SD_OK;
}

static sd_status bodies_precondition(void *ctx, const double *r, double *z)
{
  loop *c = ctx;
  memset(motion_of(c, z), 0, sizeof(double) * (size_t) motions(c));
  return pre(c, r, NULL, 0, z, motion_of(c, z));
}

/* --- the matrix --- */

/* w = M' l - K V of p = (l, V) */
static sd_status bodies_apply(void *ctx, const double *p, double *w)
{
  loop *c = ctx;
  const double *V = p + sd_bodies_unknowns(c->A);
  const sd_status status =
      sd_bodies_product(c->A, c->shells, p, V, c->bodies, c->on_spheres, c->rows, w);
  if (status == SD_OK) c->report->products++;
  return status;
}

/* p.D^-1 p of the forces */
static double bodies_square(void *ctx, const double *p)
{
  const sd_bodies *A = ((loop *) ctx)->A;
  double sum = 0.0;
  for (long j = 0; j < sd_bodies_unknowns(A); j++) sum += p[j] * p[j] / A->D[j];
  return sum;
}

/* --- when to stop --- */

/* Slips of this part of the velocities are rounding, whatever the tolerance. */
static const double rounding = 1e-14;
/* How well the sparse system in the preconditioner is solved: what is left, of what there was. What
 * the first direction lacks must be made up by directions of its own, but what later ones lack is
 * as small as they are. So it is the first of these parts of sqrt(spent), at most the second of
 * what there is. That takes at most one product in ten more than exact solutions, to 1e-8 as well,
 * and half to three quarters of the products with L that 0.01 all the way takes.
 * Source: van den Eshof & Sleijpen, SIAM J. Matrix Anal. Appl. 26, 125 (2004). */
typedef struct {
  double first, loosest;
  /* that of a guess, and of a start from nothing: the loop takes up their errors */
  double guess, start;
} accuracy;
/* Where stiff pairs chain bodies together across ranks, the norm of the sparse system hardly sees that these
 * move as one (sd_tie_factor.h), least of all in a guess: 0.3 left three times the products. */
static const accuracy whole = {0.003, 0.2, 0.3, 0.1}, severed = {0.002, 0.1, 0.01, 0.01};

static const accuracy *accuracy_of(const loop *c)
{
  return c->A->tie && c->A->tie->severed ? &severed : &whole;
}

/* For pre(r, 0) where r.z is about so much */
static double tie_tolerance(const loop *c, double power)
{
  const accuracy *a = accuracy_of(c);
  return fmax(a->first, fmin(a->loosest, a->first * sqrt(c->power.spent / power)));
}

/* loads.V of what is not known of V */
static double spent_by_loads(const loop *c, const double *V)
{
  double sum[6] = {0.0};    /* six, none of which waits for the others */
  for (int b = 0; b < sd_bodies_count(c->A); b++)
    for (int d = 0; d < 6; d++)
      if (!sd_bodies_velocity_known(c->A, b, d))
        sum[d] += c->loads[6 * (long) b + d] * V[6 * (long) b + d];
  return sum[0] + sum[1] + sum[2] + sum[3] + sum[4] + sum[5];
}

enum { NOISE, FORCES, LOADS };

/* r.D r, r.z's rounding: z is what pre leaves of r, whose rigid part it cancels; l.(K V - u);
 * F.(V + dV) */
static void bodies_measure(void *ctx, const sd_cg_vectors *v, double own[SD_CG_OWN])
{
  const loop *c = ctx;
  const sd_bodies *A = c->A;
  const double *V = motion_of(c, v->x);
  sd_bodies_move(A, V, c->on_spheres, c->rows);
  for (long j = 0; j < sd_bodies_unknowns(A); j++) {
    own[NOISE] += A->D[j] * v->r[j] * v->r[j];
    own[FORCES] += v->x[j] * (c->rows[j] - c->problem->u[j]);
  }
  own[LOADS] = spent_by_loads(c, V) + spent_by_loads(c, motion_of(c, v->z));
}

/* Of the first r of a guess. V takes what it lacks at once where the guess is so good that r is K
 * times what neighbours add to V, and r.z close to its noise; not with a tie, where l goes with V. A
 * guess that leaves more than bodies would spend alone is dropped. */
static verdict judge_guess(loop *c, double rz)
{
  const int settle = c->guess_is_new && !c->A->tie && rz < 1e4 * c->power.noise;
  c->guess_is_new = 0;
  if (settle) return SETTLE;
  return rz > c->power.alone ? BEGIN_ANEW : GO_ON;
}

/* r.z is the power of what is still wrong, by the blocks of the bodies: below the floor it is
 * rounding of velocities that are the stream's own. */
static sd_status bodies_judge(void *ctx, const sd_cg_state *now, int *done)
{
  loop *c = ctx;
  powers *power = &c->power;
  sd_bodies_report *report = c->report;
  *done = 1;
  power->noise = rounding * now->own[NOISE];
  power->spent = fmax(fabs(now->own[FORCES]), now->own[LOADS] - power->carried);
  if (now->steps > 0 && now->pp > 0.0)
    report->curvature = fmin(report->curvature, now->pw / now->pp);
  if (now->steps == 0 && c->verdict == GO_ON && c->problem->warm &&
      (c->verdict = judge_guess(c, now->rz)) != GO_ON)
    return SD_OK;
  if (now->rz < -fmax(power->floor, power->noise)) return SD_EINDEFINITE;
  /* nothing is spent yet: a guess of no forces on bodies that are all held */
  const double wrong = fmax(now->rz, 0.0);
  report->residual = power->spent > 0.0 ? sqrt(wrong / power->spent) : wrong > power->floor;
  if (now->rz <= power->floor || report->residual < c->problem->tolerance) return SD_OK;
  if (report->products >= c->problem->max_iter) return SD_EMAXITER;
  c->tie_tolerance = tie_tolerance(c, now->rz);
  *done = 0;
  return SD_OK;
}

/* --- where it begins --- */

static void hold(const loop *c, double *V)
{
  const double *known = c->problem->velocities;
  memset(V, 0, sizeof(double) * (size_t) motions(c));
  for (long j = 0; known && j < motions(c); j++)
    if (sd_bodies_velocity_known(c->A, (int) (j / 6), j % 6)) V[j] = known[j];
}

/* x = pre(-u, F) of bodies for themselves, and their power; z is scratch */
static sd_status start_alone(loop *c)
{
  const sd_bodies *A = c->A;
  double s[3] = {0.0}, *V = motion_of(c, c->v.x), *still = motion_of(c, c->v.z);
  for (long j = 0; j < sd_bodies_unknowns(A); j++) c->v.r[j] = -c->problem->u[j];
  hold(c, V);
  sd_bodies_alone(A, c->v.r, c->f, c->alone, c->v.x, V);
  sd_bodies_move(A, V, c->on_spheres, c->rows);
  for (long j = 0; j < sd_bodies_unknowns(A); j++) {
    const double u = c->problem->u[j], v = c->rows[j];
    s[0] += c->v.x[j] * (v - u);
    s[1] += A->D[j] * (u * u + v * v);
  }
  sd_bodies_alone_move(A, c->f, still);
  s[2] = spent_by_loads(c, V) - spent_by_loads(c, still);
  const sd_status status = sd_world_sum(&A->world, s, 3);
  c->power.alone = fabs(s[0]);
  c->power.floor = rounding * rounding * s[1];
  c->power.carried = s[2];
  return status;
}

/* The accuracy of the first pre(r, 0): r.z is at most r.D r */
static sd_status expect(loop *c)
{
  const sd_bodies *A = c->A;
  double s[2] = {0.0, 0.0};
  if (!A->tie) return SD_OK;
  for (long j = 0; j < sd_bodies_unknowns(A); j++) s[0] += A->D[j] * c->v.r[j] * c->v.r[j];
  s[1] = spent_by_loads(c, motion_of(c, c->v.x));
  const sd_status status = sd_world_sum(&A->world, s, 2);
  c->power.spent = fmax(c->power.alone, s[1] - c->power.carried);
  c->tie_tolerance = tie_tolerance(c, s[0]);
  return status;
}

/* r = K V - u - M' l of x, which obeys the second line */
static sd_status find_residual(loop *c)
{
  const sd_status status = bodies_apply(c, c->v.x, c->v.w);
  if (status != SD_OK) return status;
  for (long j = 0; j < sd_bodies_unknowns(c->A); j++) c->v.r[j] = -c->problem->u[j] - c->v.w[j];
  return expect(c);
}

/* From x = pre(-u, F) */
static sd_status start_cold(loop *c)
{
  sd_status status = start_alone(c);
  if (status == SD_OK && c->A->tie) {
    c->tie_tolerance = accuracy_of(c)->start;
    hold(c, motion_of(c, c->v.x));
    status = pre(c, c->v.r, c->f, c->problem->velocities != NULL, c->v.x, motion_of(c, c->v.x));
  }
  return status == SD_OK ? find_residual(c) : status;
}

/* V of a guess, that of each body's first sphere */
static void guess_motion(const loop *c, const double *v_with_l, double *V)
{
  const sd_rigid *K = &c->A->spheres;
  hold(c, V);
  for (int i = K->n - 1; i >= 0; i--) {
    const int b = K->whole ? K->whole[i] : i;
    const double *v = v_with_l + 6 * (long) i, *arm = K->arm ? K->arm + 3 * (long) i : NULL;
    double own[6];
    memcpy(own, v, sizeof(own));
    for (int d = 0; d < 3 && arm; d++) {
      const int e = (d + 1) % 3, g = (d + 2) % 3;
      own[d] -= v[3 + e] * arm[g] - v[3 + g] * arm[e];
    }
    for (int d = 0; d < 6; d++)
      if (!sd_bodies_velocity_known(c->A, b, d)) V[6 * (long) b + d] = own[d];
  }
}

/* guess (l, V) += what it lacks of the second line, by pre(0, F - K^T l - K_s^T L K_s V) */
static sd_status repair(loop *c, double *guess)
{
  const sd_bodies *A = c->A;
  const long rows = sd_bodies_unknowns(A);
  double *V = motion_of(c, guess), *dV = motion_of(c, c->v.z), *lacks = motion_of(c, c->v.x);
  sd_bodies_collect(A, guess, c->on_spheres, lacks);
  if (A->tie) {
    double *v = c->on_spheres, *borne = v + 6 * (long) A->spheres.n;
    const sd_rigid films = sd_bodies_films(A);
    sd_rigid_move(&films, V, v);
    const sd_status status = sd_lubrication_apply(A->tie->L, v, borne);
    if (status != SD_OK) return status;
    sd_rigid_collect(&films, borne, sd_bodies_count(A), dV);
    for (long j = 0; j < motions(c); j++) lacks[j] += dV[j];
  }
  for (long j = 0; j < motions(c); j++) lacks[j] = c->f[j] - lacks[j];
  c->tie_tolerance = accuracy_of(c)->guess;
  memset(dV, 0, sizeof(double) * (size_t) motions(c));
  const sd_status status = pre(c, NULL, lacks, 0, c->v.z, dV);
  for (long j = 0; j < rows; j++) guess[j] += c->v.z[j];
  for (long j = 0; A->tie && j < motions(c); j++) V[j] += dV[j];
  return status;
}

/* From the guess, with a tie (l, V) */
static sd_status start_warm(loop *c, const double *v_with_l)
{
  const sd_bodies *A = c->A;
  double *guess = c->v.p;
  memcpy(guess, c->v.x, sizeof(double) * (size_t) sd_bodies_unknowns(A));
  if (A->tie) guess_motion(c, v_with_l, motion_of(c, guess));
  sd_status status = repair(c, guess);
  if (status == SD_OK) status = start_alone(c);
  memcpy(c->v.x, guess, sizeof(double) * (size_t) (sd_bodies_unknowns(A) + (A->tie ? motions(c) : 0)));
  return status == SD_OK ? find_residual(c) : status;
}

/* V takes what it lacks. */
static void take_motion(loop *c)
{
  double *V = motion_of(c, c->v.x);
  const double *dV = motion_of(c, c->v.z);
  for (long j = 0; j < motions(c); j++) V[j] += dV[j];
}

static sd_status settle(loop *c)
{
  take_motion(c);
  sd_bodies_move(c->A, motion_of(c, c->v.z), c->on_spheres, c->rows);
  for (long j = 0; j < sd_bodies_unknowns(c->A); j++) c->v.r[j] += c->rows[j];
  return SD_OK;
}

static sd_status bodies_iterate(loop *c)
{
  const sd_cg cg = {.size = sd_bodies_unknowns(c->A) + motions(c),
                    .paired = sd_bodies_unknowns(c->A),
                    .ctx = c,
                    .apply = bodies_apply,
                    .precondition = bodies_precondition,
                    .measure = bodies_measure,
                    .judge = bodies_judge,
                    .square = bodies_square,
                    .world = &c->A->world};
  sd_cg_state state;
  sd_status status = SD_OK;
  do {
    const verdict last = c->verdict;
    if (last != GO_ON) status = last == SETTLE ? settle(c) : start_cold(c);
    if (last == SETTLE) c->verdict = GO_ON;
    if (status == SD_OK) status = sd_cg_run(&cg, &c->v, &state);
    if (last == BEGIN_ANEW) break;
  } while (status == SD_OK && c->verdict != GO_ON);
  return status == SD_ESINGULAR ? SD_EINDEFINITE : status;
}

/* --- what comes of it --- */

/* K^T l + K_s^T L K_s V = F + K_s^T L V_inf. Torques on those that are spun are not read, nor forces on
 * those that are pinned. */
static void take_loads(loop *c)
{
  const sd_bodies *A = c->A;
  sd_rigid_collect(&A->spheres, c->problem->F, sd_bodies_count(A), c->loads);
  for (int b = 0; b < sd_bodies_count(A); b++) {
    const sd_body_known known = sd_bodies_known(A, b);
    if (known == SD_BODY_SPUN || known == SD_BODY_PINNED)
      memset(c->loads + 6 * (long) b + (known == SD_BODY_SPUN ? 3 : 0), 0, 3 * sizeof(double));
  }
  memcpy(c->f, c->loads, sizeof(double) * (size_t) motions(c));
  if (!A->tie) return;
  const sd_rigid films = sd_bodies_films(A);
  sd_rigid_collect(&films, A->tie->L->carried, sd_bodies_count(A), c->bodies);
  for (long j = 0; j < motions(c); j++) c->f[j] += c->bodies[j];
}

/* What the next guess takes of the last z, where it will be on the line through two answers, as that of shells
 * is. Errors of answers live on in such a guess: e' = g (2 e - e_before) with g = 1 - part lambda, lambda an
 * eigenvalue of the preconditioned matrix. With part 0 they grow from step to step until a product of its own
 * takes them away. They fade for g between -1/3 and 1, so for lambda up to 4 / (3 part). Free bodies have
 * lambda up to about 4.5 (films, volume fraction 0.45); those that are held disturb each other from afar, and
 * lambda grows with their number.
 * Source: the predictor that is always stable of Kolafa, J. Comput. Chem. 25, 335 (2004). */
static const double taken_up = 0.25;

static void leave_guess(const loop *c, const sd_bodies_answer *answer)
{
  const sd_bodies *A = c->A;
  const double part = A->points.whole && !A->known ? taken_up : 0.0;
  const double *V = motion_of(c, c->v.x), *dV = motion_of(c, c->v.z);
  for (long j = 0; j < sd_bodies_unknowns(A); j++) answer->l[j] = c->v.x[j] + part * c->v.z[j];
  if (!A->tie) return;
  for (long j = 0; j < motions(c); j++) c->bodies[j] = V[j] + part * dV[j];
  sd_rigid_move(&A->spheres, c->bodies, answer->v_with_l);
}

/* The last pre(r, 0) is free, and without it free spheres would have their lone velocities. */
static sd_status finish(loop *c, const sd_bodies_answer *answer)
{
  const sd_bodies *A = c->A;
  const long rows = sd_bodies_unknowns(A), loads = sd_bodies_loads(A);
  double *V = motion_of(c, c->v.x);
  leave_guess(c, answer);
  take_motion(c);
  memcpy(answer->V, V, sizeof(double) * (size_t) motions(c));
  sd_rigid_move(&A->spheres, V, answer->v);
  for (long j = 0; j < rows; j++) c->rows[j] = c->v.x[j] + c->v.z[j];
  if (A->points.whole)
    sd_rigid_collect(&A->points, c->rows, A->spheres.n, answer->exerted);
  else
    memcpy(answer->exerted, c->rows, sizeof(double) * (size_t) loads);
  if (!A->tie) return SD_OK;
  const sd_rigid films = sd_bodies_films(A);
  double *there = c->on_spheres + loads;
  sd_rigid_move(&films, V, there);
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
  double *r = work + 3 * size, *by_bodies = r + 3 * rows, *on_spheres = by_bodies + 5 * bodies;
  loop c = {
      .A = A,
      .problem = problem,
      .v = {work, work + size, work + 2 * size, r, r + rows},
      .rows = r + 2 * rows,
      .loads = by_bodies,
      .f = by_bodies + bodies,
      .bodies = by_bodies + 2 * bodies,
      .on_spheres = on_spheres,
      .alone = on_spheres + 12 * (long) A->spheres.n,
      .shells = sd_bodies_shells(A),
      .guess_is_new = problem->warm,
      .report = report,
  };
  *report = (sd_bodies_report){.curvature = 1.0};
  memset(work, 0, sizeof(double) * (size_t) (2 * size));
  if (problem->warm) memcpy(c.v.x, answer->l, sizeof(double) * (size_t) rows);
  if (A->tie && (status = sd_tie_make(A)) != SD_OK) return status;
  take_loads(&c);
  status = problem->warm ? start_warm(&c, answer->v_with_l) : start_cold(&c);
  if (status == SD_OK) status = bodies_iterate(&c);
  if (status != SD_OK && status != SD_EMAXITER) return status;
  const sd_status last = finish(&c, answer);
  return last == SD_OK ? status : last;
}
