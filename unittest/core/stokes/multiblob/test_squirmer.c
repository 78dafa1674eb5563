/* Squirmers as shells of points: a lone one swims, turns and stirs as the slip of a sphere says; two of them
 * act on each other as two spheres do. */
#include "blob_flock.h"

#include "sd_squirmer.h"

static double at_random(uint64_t *seed, double e[3])
{
  for (int d = 0; d < 3; d++) e[d] = uniform(seed, -1, 1);
  sd_normalize(e);
  return uniform(seed, -2, 2);
}

/* The slip of sphere i of f, at its points */
static void give_stroke(blob_flock *f, const sd_squirmer *s, int i, const sd_squirmer_stroke *stroke)
{
  const long at = 3L * f->s->m.n * i;
  sd_squirmer_slip(&f->s->m, s, stroke, f->s->a[i], f->s->r + at, f->u + at);
}

/* sums of e.f, e.(r x f), of e.(r f).e without the trace, and of (e.r)(e.(r x f)), of sphere i */
typedef struct {
  double force[3], torque[3], moment[6], twist, source[3];
} sums;

static sums sums_of(const blob_flock *f, int i, const double e[3])
{
  const long own = f->s->m.n;
  sums all = {{0}, {0}, {0}, 0, {0}};
  sd_multiblob_moment(own, f->s->r + 3 * own * i, f->l + 3 * own * i, all.moment);
  for (long k = own * i; k < own * (i + 1); k++) {
    const double *r = f->s->r + 3 * k, *l = f->l + 3 * k;
    double turning[3];
    sd_cross(r, l, turning);
    all.twist += sd_dot(e, r) * sd_dot(e, turning);
    for (int d = 0; d < 3; d++) {
      all.force[d] += l[d];
      all.torque[d] += turning[d];
      all.source[d] += 0.1 * (2.0 * sd_dot(r, r) * l[d] - sd_dot(r, l) * r[d]);
    }
  }
  return all;
}

static blob_flock *swimmers(int points, int one_body, int n, const double *x, const double *a)
{
  blob_flock *f = free_spheres(points, n, x, a);
  if (one_body) return f;
  sd_multiblob_shape_free(&f->lone);
  assert_int_equal(sd_multiblob_create(points, 0, &f->s->m), SD_OK);
  assert_int_equal(sd_multiblob_shape_create(&f->s->m, NULL, NULL, &f->lone), SD_OK);
  return f;
}

static void lone_swimmers_are_exact(void **state)
{
  (void) state;
  const double x[3] = {1, 2, 3}, a = 0.7, none[6] = {0};
  uint64_t seed = 4;
  for (int points = 12; points <= 42; points += 30)
    for (int one_body = 0; one_body < 2; one_body++) {
      blob_flock *f = swimmers(points, one_body, 1, x, &a);
      const sd_bodies A = place(f, 0.0, 0.0);
      sd_squirmer s;
      sd_squirmer_stroke stroke;
      sd_squirmer_create(&f->s->m, &f->lone.points, &s);
      if (one_body) CHECK_NEAR(s.uniform, 0.0, 1e-12);
      stroke.B1 = at_random(&seed, stroke.e), stroke.B2 = -1.7, stroke.beta = 0.9;
      give_stroke(f, &s, 0, &stroke);
      assert_int_equal(move(f, &A, none, 0, 1e-12), SD_OK);
      const sums sum = sums_of(f, 0, stroke.e);
      for (int d = 0; d < 3; d++) {
        CHECK_NEAR(f->V[d], 2.0 / 3.0 * stroke.B1 * stroke.e[d], 1e-12);
        CHECK_NEAR(f->V[3 + d], 0.0, 1e-12);
        CHECK_NEAR(sum.force[d], 0.0, 1e-12);
        CHECK_NEAR(sum.torque[d], 0.0, 1e-12);
        if (one_body) CHECK_NEAR(sum.source[d], -4.0 / 3.0 * SD_PI * a * a * a * stroke.B1 * stroke.e[d], 1e-11);
      }
      for (int q = 0; q < 6; q++) {
        static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
        const double ee = stroke.e[row[q]] * stroke.e[column[q]] - (q < 3) / 3.0;
        CHECK_NEAR(sum.moment[q], -4.0 * SD_PI * a * a * stroke.B2 * ee, 1e-11);
      }
      CHECK_NEAR(sum.twist, 8.0 / 3.0 * SD_PI * a * a * a * stroke.beta, 1e-11);
      blob_flock_free(f);
    }
}

/* The velocity of the fluid at y [3], of the forces of all points, viscosity 1 */
static void flow_at(const blob_flock *f, const double y[3], double u[3])
{
  for (int d = 0; d < 3; d++) u[d] = 0.0;
  for (int k = 0; k < f->s->m.n * f->s->n; k++) {
    double r[3];
    sd_minus(y, f->s->at + 3 * k, r);
    const double R = sqrt(sd_dot(r, r)), b = f->s->b[k], *l = f->l + 3 * k, along = sd_dot(r, l) / (R * R);
    for (int d = 0; d < 3; d++)
      u[d] += ((1 + b * b / (3 * R * R)) * l[d] + (1 - b * b / (R * R)) * along * r[d]) / (8 * SD_PI * R);
  }
}

/* Blake's flow around a squirmer of radius 1, in the frame of the fluid at rest */
static void exact_flow(const sd_squirmer_stroke *s, const double y[3], double u[3])
{
  const double r = sqrt(sd_dot(y, y)), c = sd_dot(s->e, y) / r, r3 = r * r * r;
  double across[3];
  sd_cross(s->e, y, across);
  for (int d = 0; d < 3; d++) {
    const double n = y[d] / r, tangent = -(s->e[d] - c * n); /* sin theta e_theta */
    u[d] = s->B1 / 3.0 * (3.0 * c * n - s->e[d]) / r3 +
        s->B2 * ((1.0 / (r3 * r) - 1.0 / (r * r)) * (1.5 * c * c - 0.5) * n + c * tangent / (r3 * r)) +
        s->beta * c * across[d] / (r3 * r);
  }
}

/* Root of the mean square error of the flow over that of the flow, at 1.3, 2 and 3 radii: as the header says */
static void flow_around_is_as_told(void **state)
{
  (void) state;
  static const double told[2][3][3] = {{{0.32, 0.33, 0.20}, {0.47, 0.18, 0.07}, {0.20, 0.11, 0.06}},
                                       {{0.21, 0.05, 0.025}, {0.19, 0.04, 0.017}, {0.06, 0.02, 0.01}}};
  static const double at[3] = {1.3, 2.0, 3.0};
  const double x[3] = {0, 0, 0}, a = 1.0, none[6] = {0};
  uint64_t seed = 9;
  for (int shell = 0; shell < 2; shell++)
    for (int which = 0; which < 3; which++)
      for (int where = 0; where < 3; where++) {
        double off = 0.0, all = 0.0;
        for (int turn = 0; turn < 4; turn++) {
          blob_flock *f = free_spheres(shell ? 42 : 12, 1, x, &a);
          const sd_bodies A = place(f, 0.0, 0.0);
          sd_squirmer s;
          sd_squirmer_stroke stroke = {{0}, which == 0, which == 1, which == 2};
          sd_squirmer_create(&f->s->m, &f->lone.points, &s);
          at_random(&seed, stroke.e);
          give_stroke(f, &s, 0, &stroke);
          assert_int_equal(move(f, &A, none, 0, 1e-12), SD_OK);
          for (int k = 0; k < 100; k++) {
            double y[3], u[3], exact[3];
            at_random(&seed, y);
            for (int d = 0; d < 3; d++) y[d] *= at[where];
            flow_at(f, y, u);
            exact_flow(&stroke, y, exact);
            for (int d = 0; d < 3; d++) {
              off += (u[d] - exact[d]) * (u[d] - exact[d]);
              all += exact[d] * exact[d];
            }
          }
          blob_flock_free(f);
        }
        const double error = sqrt(off / all);
        assert_true(error < 1.15 * told[shell][which][where]);
        assert_true(error > 0.6 * told[shell][which][where]);
      }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lone_swimmers_are_exact),
      cmocka_unit_test(flow_around_is_as_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
