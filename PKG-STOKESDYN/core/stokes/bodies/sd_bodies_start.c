#include "sd_bodies_start.h"

#include <math.h>
#include <string.h>

#include "sd_bodies_alone.h"
#include "sd_tie.h"

static void hold(const sd_bodies_loop *c, double *V)
{
  const double *known = c->problem->velocities;
  memset(V, 0, sizeof(double) * (size_t) sd_bodies_motions(c));
  for (long j = 0; known && j < sd_bodies_motions(c); j++)
    if (sd_bodies_velocity_known(c->A, (int) (j / 6), j % 6)) V[j] = known[j];
}

/* r = -u: is it 0 for all points of this rank? */
static int begin_residual(sd_bodies_loop *c)
{
  int rests = 1;
  for (long j = 0; j < sd_bodies_unknowns(c->A); j++) {
    const double u = c->problem->u[j];
    c->v.r[j] = -u;
    rests &= u == 0.0;
  }
  return rests;
}

/* l.(K V - u) of (l, V), l NULL: 0; and the power of drags D (u^2 + v^2) */
static void find_powers(const sd_bodies_loop *c, const double *l, const double *V, double s[2])
{
  const sd_bodies *A = c->A;
  const double *moved = sd_bodies_move_spheres(A, V, c->on_spheres);
  double power[3] = {0.0}, drags[3] = {0.0};    /* three of each, which do not wait for each other */
  for (sd_bodies_part part = {0}; sd_bodies_next(A, moved, &part);)
    for (long j = part.begin; j < part.end; j += 3)
      for (int d = 0; d < 3; d++) {
        const double u = c->problem->u[j + d], v = part.v[j + d - part.begin];
        if (l) power[d] += l[j + d] * (v - u);
        drags[d] += A->D[j + d] * (u * u + v * v);
      }
  s[0] = power[0] + power[1] + power[2];
  s[1] = drags[0] + drags[1] + drags[2];
}

/* x = pre(-u, F) of bodies for themselves, and their power; z is scratch. Where nobody wants their forces l and all
 * are free in a fluid that rests, V is N F and l.K V is F.V. */
static sd_status start_alone(sd_bodies_loop *c, int wanted)
{
  const sd_bodies *A = c->A;
  double s[4], *V = sd_bodies_motion_of(c, c->v.x), *still = sd_bodies_motion_of(c, c->v.z);
  const int rests_here = begin_residual(c), brief = rests_here && !wanted && !A->known;
  const sd_bodies_left all = {rests_here ? NULL : c->v.r, NULL, c->f};
  sd_bodies_alone_move(A, c->f, still);
  hold(c, V);
  if (brief) memcpy(V, still, sizeof(double) * (size_t) sd_bodies_motions(c));
  else sd_bodies_alone(A, &all, c->alone, c->v.x, V);
  find_powers(c, brief ? NULL : c->v.x, V, s);
  for (long j = 0; brief && j < sd_bodies_motions(c); j++) s[0] += c->f[j] * V[j];
  s[2] = sd_bodies_spent(c, V) - sd_bodies_spent(c, still);
  s[3] = !rests_here;
  const sd_status status = sd_world_sum(&A->world, s, 4);
  c->power.alone = fabs(s[0]);
  c->power.floor = sd_bodies_rounding * sd_bodies_rounding * s[1];
  c->power.carried = s[2];
  c->rests = s[3] == 0.0;
  return status;
}

/* The accuracy of the first pre(r, 0): r.z is at most r.D r */
static sd_status expect(sd_bodies_loop *c)
{
  const sd_bodies *A = c->A;
  double s[2], sum[3] = {0.0};
  if (!A->tie) return SD_OK;
  for (long j = 0; j < sd_bodies_unknowns(A); j += 3)
    for (int d = 0; d < 3; d++) sum[d] += A->D[j + d] * c->v.r[j + d] * c->v.r[j + d];
  s[0] = sum[0] + sum[1] + sum[2];
  s[1] = sd_bodies_spent(c, sd_bodies_motion_of(c, c->v.x));
  const sd_status status = sd_world_sum(&A->world, s, 2);
  c->power.spent = fmax(c->power.alone, s[1] - c->power.carried);
  c->tie_tolerance = sd_bodies_tie_tolerance(c, s[0]);
  return status;
}

/* r = K V - u - M' l of x, which obeys the second line */
static sd_status find_residual(sd_bodies_loop *c)
{
  const sd_status status = sd_bodies_multiply(c, c->v.x, c->v.w);
  if (status != SD_OK) return status;
  for (long j = 0; j < sd_bodies_unknowns(c->A); j++) c->v.r[j] = -c->problem->u[j] - c->v.w[j];
  return expect(c);
}

sd_status sd_bodies_start_cold(sd_bodies_loop *c)
{
  sd_status status = start_alone(c, !c->A->tie);
  if (status == SD_OK && c->A->tie) {
    const double *r = c->rests ? NULL : c->v.r;
    c->tie_tolerance = sd_bodies_accuracy_of(c)->start;
    hold(c, sd_bodies_motion_of(c, c->v.x));
    status = sd_bodies_pre(c, r, c->f, c->problem->velocities != NULL, c->v.x, sd_bodies_motion_of(c, c->v.x));
  }
  return status == SD_OK ? find_residual(c) : status;
}

/* V of a guess, that of each body's first sphere */
static void guess_motion(const sd_bodies_loop *c, const double *v_with_l, double *V)
{
  const sd_rigid *K = &c->A->spheres;
  hold(c, V);
  for (int i = K->n - 1; i >= 0; i--) {
    const int b = sd_rigid_whole(K, i);
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
static sd_status repair(sd_bodies_loop *c, double *guess)
{
  const sd_bodies *A = c->A;
  const long rows = sd_bodies_unknowns(A);
  double *V = sd_bodies_motion_of(c, guess), *dV = sd_bodies_motion_of(c, c->v.z);
  double *lacks = sd_bodies_motion_of(c, c->v.x);
  sd_bodies_collect(A, guess, c->on_spheres, lacks);
  if (A->tie) {
    double *borne = c->on_spheres + 6 * (long) A->spheres.n;
    const sd_rigid films = sd_bodies_films(A);
    const double *v = sd_rigid_moved(&films, V, c->on_spheres);
    const sd_status status = sd_lubrication_apply(A->tie->L, v, borne);
    if (status != SD_OK) return status;
    const double *borne_there = sd_rigid_collected(&films, borne, sd_bodies_count(A), dV);
    for (long j = 0; j < sd_bodies_motions(c); j++) lacks[j] += borne_there[j];
  }
  for (long j = 0; j < sd_bodies_motions(c); j++) lacks[j] = c->f[j] - lacks[j];
  c->tie_tolerance = sd_bodies_accuracy_of(c)->guess;
  memset(dV, 0, sizeof(double) * (size_t) sd_bodies_motions(c));
  const sd_status status = sd_bodies_pre(c, NULL, lacks, 0, c->v.z, dV);
  for (long j = 0; j < rows; j++) guess[j] += c->v.z[j];
  for (long j = 0; A->tie && j < sd_bodies_motions(c); j++) V[j] += dV[j];
  return status;
}

sd_status sd_bodies_start_warm(sd_bodies_loop *c, const double *v_with_l)
{
  const sd_bodies *A = c->A;
  double *guess = c->v.p;
  memcpy(guess, c->v.x, sizeof(double) * (size_t) sd_bodies_unknowns(A));
  if (A->tie) guess_motion(c, v_with_l, sd_bodies_motion_of(c, guess));
  sd_status status = repair(c, guess);
  if (status == SD_OK) status = start_alone(c, 0);
  memcpy(c->v.x, guess, sizeof(double) * (size_t) (sd_bodies_unknowns(A) + (A->tie ? sd_bodies_motions(c) : 0)));
  return status == SD_OK ? find_residual(c) : status;
}
