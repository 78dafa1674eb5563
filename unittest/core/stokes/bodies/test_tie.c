/* Bodies with lubrication between them: sd_bodies.h with sd_tie.h, against the dense solution of its
 * system, at gaps of nothing, and in as many products as the page says. */
#include "settling.h"
#include "tied_flock.h"

#include "sd_tie_approach.h"

static const double P6 = 6.0 * SD_PI;
static const double doublet[6] = {0, 0, -1, 0, 0, 1};
static const double ones[8] = {1, 1, 1, 1, 1, 1, 1, 1}, unequal[2] = {1, 0.6};

/* Clumps and free spheres pushed together until gaps are small: towards the middle, as far as they
 * go */
static void crowd(flock *f, double phi, uint64_t seed)
{
  flock_scatter(f, phi, seed);
  const int bodies = f->clumps + f->free;
  for (int sweep = 0; sweep < 30; sweep++)
    for (int b = 0; b < bodies; b++) {
      double *c = f->pose + 12 * b + 9, old[3] = {c[0], c[1], c[2]}, part = 0.3;
      for (int half = 0; half < 6; half++, part *= 0.3) {
        for (int d = 0; d < 3; d++) c[d] = old[d] * (1.0 - part);
        flock_place(f, 6);
        double gap = INFINITY;
        for (int i = 0; i < f->n; i++)
          for (int j = 0; j < i; j++) {
            const int bi = i < f->m * f->clumps ? i / f->m : -i, bj = j < f->m * f->clumps ? j / f->m : -j;
            if (bi != bj)
              gap = fmin(gap, sqrt(sd_distance_squared(f->x + 3 * i, f->x + 3 * j)) - f->a[i] - f->a[j]);
          }
        if (gap > 1e-5) break;
        memcpy(c, old, sizeof(old));
      }
    }
  flock_place(f, 6);
}

/* K^T rows, by bodies: clumps about their centroids, then free spheres */
static void onto_bodies(const flock *f, const double *rows, double *out)
{
  for (int b = 0; b < f->clumps + f->free; b++) {
    double *to = out + 6 * b;
    memset(to, 0, 6 * sizeof(double));
    const int first = b < f->clumps ? f->m * b : f->m * f->clumps + b - f->clumps;
    for (int k = 0; k < (b < f->clumps ? f->m : 1); k++) {
      const double *F = rows + 6 * (first + k);
      double arm[3], couple[3];
      sd_minus(f->x + 3 * (first + k), f->pose + 12 * b + 9, arm);
      sd_cross(arm, F, couple);
      for (int d = 0; d < 3; d++) {
        to[d] += F[d];
        to[3 + d] += F[3 + d] + couple[d];
      }
    }
  }
}

/* out = M l by spheres (without shells) */
static void multiply_dense(const tied_flock *t, const double *l, double *out)
{
  const int N = 6 * t->f->n;
  double *M = dense_mobility(&t->near.s);
  for (int i = 0; i < N; i++) {
    out[i] = 0.0;
    for (int j = 0; j < N; j++) out[i] += M[N * i + j] * l[j];
  }
  free(M);
}

/* The system (3) line by line, from its definition: free spheres and doublets in a shear flow, loads at
 * random; then a sphere and a doublet are held and move as they are told, then they are spun and
 * do so about their centres alone, which their turning loads where spheres are unequal, in the end they
 * are pinned and turn as they like. */
static void both_lines_hold(void **state)
{
  (void) state;
  for (int e = 0; e < 5; e++) {
    flock *f = flock_create(2, doublet, e >= 3 ? unequal : ones, 1, e ? 5 : 0, 12, 1.3);
    crowd(f, 0.2, 5 + e);
    const int N = 6 * f->n, bodies = f->clumps + f->free;
    uint64_t seed = 7;
    for (int j = 0; j < N; j++) f->F[j] = uniform(&seed, -10, 10);
    for (int i = 0; i < f->n; i++) {
      f->u[6 * i] = 0.3 * f->x[3 * i + 1];
      f->u[6 * i + 5] = -0.15;
    }
    const int clump = 1, sphere = 3;
    const sd_body_known known[5] = {SD_BODY_FREE, SD_BODY_FREE, SD_BODY_HELD, SD_BODY_SPUN, SD_BODY_PINNED};
    const int first = e == 3 ? 3 : e < 2 ? 6 : 0, last = e == 4 ? 3 : 6; /* of what is given */
    f->known[f->free + clump] = f->known[sphere] = (char) known[e];
    for (int j = 0; j < 6 * bodies; j++) f->velocities[j] = uniform(&seed, -1, 1);
    tied_flock *t = tie_flock(f, 1e-4);
    assert_int_equal(tied_move(t, 0, 1e-12, 400), SD_OK);
    double *Ml = malloc(sizeof(double) * (size_t) N), *L = near_dense(&t->near);
    /* loads: K^T (l + L (K V - V_inf)) = F, the sum of which is exerted */
    double lubrication[6 * FLOCK_MOST], total[6 * FLOCK_MOST], got[6 * FLOCK_MOST], want[6 * FLOCK_MOST];
    for (int i = 0; i < N; i++) {
      lubrication[i] = -t->near.L.carried[i];
      for (int j = 0; j < N; j++) lubrication[i] += L[N * i + j] * f->v[j];
      total[i] = f->exerted[i];
    }
    onto_bodies(f, total, got);
    onto_bodies(f, f->F, want);
    for (int j = 0; j < 6 * bodies; j++) {
      const int one = j / 6 == clump || j / 6 == f->clumps + sphere;
      if (!one || j % 6 < first || j % 6 >= last) CHECK_NEAR(got[j], want[j], 1e-7);
    }
    for (int j = first; j < last; j++) {
      assert_true(f->V[6 * clump + j] == f->velocities[6 * (f->free + clump) + j]);
      assert_true(f->all_V[6 * sphere + j] == f->velocities[6 * sphere + j]);
    }
    for (int i = 0; i < N; i++) total[i] -= lubrication[i]; /* what goes through the fluid of all */
    multiply_dense(t, total, Ml);
    double worst = 0.0, largest = 0.0;
    for (int i = 0; i < N; i++) {
      worst = fmax(worst, fabs(Ml[i] - f->v[i] + f->u[i]));
      largest = fmax(largest, fabs(f->v[i]));
    }
    assert_true(worst < 1e-8 * largest);
    free(Ml), free(L);
    untie(t);
  }
}

/* Without a pair within the range nothing is changed. */
static void far_spheres_are_as_without(void **state)
{
  (void) state;
  flock *f = flock_create(0, NULL, NULL, 1, 0, 5, 1.7), *g = flock_create(0, NULL, NULL, 1, 0, 5, 1.7);
  for (int b = 0; b < 5; b++) f->pose[12 * b + 9] = g->pose[12 * b + 9] = 5.0 * b;
  flock_weigh(f, P6), flock_weigh(g, P6);
  tied_flock *t = tie_flock(f, 1e-4);
  assert_int_equal(tied_move(t, 0, 1e-3, 50), SD_OK);
  assert_int_equal(flock_move(g, 6, 0, 1e-3, 50), SD_OK);
  assert_int_equal(f->report.products, 1);
  for (int j = 0; j < 30; j++) CHECK_NEAR(f->v[j], g->v[j], 1e-14);
  untie(t);
  flock_free(g);
}

/* Shells: dN of a doublet of 42 points and lubrication of its spheres. A clump alone keeps its own
 * mobility; two at rest against each other in a far field move as one where the gap is nothing. */
static void shells_and_lubrication_go_together(void **state)
{
  (void) state;
  flock *alone = flock_create(2, doublet, ones, 42, 1, 0, 0.6), *f = flock_create(2, doublet, ones, 42, 2, 0, 0.6);
  tied_flock *t = tie_flock(alone, 1e-4);
  flock_weigh(alone, P6);
  assert_int_equal(tied_move(t, 0, 1e-8, 50), SD_OK);
  CHECK_NEAR(alone->V[2] * alone->body.resistance[14] * 0.6, -2.0 * P6, 1e-9);
  untie(t);

  /* One doublet above the other, pushed together: what is left is the film between them. */
  double squeeze[2];
  for (int k = 0; k < 2; k++) {
    f->pose[12 + 11] = 4.0 + (k ? 1e-2 : 1e-4);
    memset(f->F, 0, sizeof(f->F));
    f->F[6 * 1 + 2] = P6, f->F[6 * 2 + 2] = -P6;
    t = tie_flock(f, 1e-5);
    assert_int_equal(tied_move(t, 0, 1e-9, 100), SD_OK);
    squeeze[k] = f->V[2] - f->V[8];
    sd_tie_free(&t->tie);
    near_free(&t->near);
    free(t);
  }
  /* 6 pi eta a^2/(4 gap) resists, beside logarithms */
  assert_true(squeeze[0] > 0.0);
  CHECK_NEAR(squeeze[1] / squeeze[0], 100.0, 20.0);
  flock_free(f);
}

/* A guess of (l, V) as the last solve left it gives the same answer at once. */
static void a_guess_is_taken_up(void **state)
{
  (void) state;
  flock *f = flock_create(2, doublet, ones, 12, 4, 10, 1.3);
  crowd(f, 0.2, 9);
  tied_flock *t = tie_flock(f, 1e-4);
  flock_weigh(f, P6);
  for (int j = 0; j < 6 * f->n; j++) f->l[j] = f->before[j] = 0.1 * cos(j); /* any guess will do */
  assert_int_equal(tied_move(t, 1, 1e-4, 100), SD_OK);
  const int cold = f->report.products;
  double v[6 * FLOCK_MOST];
  memcpy(v, f->v, sizeof(v));
  assert_int_equal(tied_move(t, 1, 1e-4, 100), SD_OK);
  assert_int_equal(f->report.products, 1);
  assert_true(cold > 5);
  assert_true(flock_distance(f->v, v, 6 * f->n) < 1e-8);
  untie(t);
}

/* --- how many products --- */

/* The gap does not matter, and velocities are far better than the tolerance. */
static void products_do_not_depend_on_the_gap(void **state)
{
  (void) state;
  static const double phi[] = {0.1, 0.3, 0.5};
  for (int k = 0; k < 3; k++) {
    int products[3];
    for (int e = 0; e < 3; e++) {
      settling *s = settling_create(200, phi[k], pow(10.0, -2 - 2 * e));
      settling_solve(s, 0, 1e-8);
      double *reference = malloc(sizeof(double) * 1200);
      memcpy(reference, s->v, sizeof(double) * 1200);
      settling_solve(s, 0, 1e-3);
      products[e] = s->report.products;
      assert_true(products[e] <= 20);
      assert_true(s->tie.products <= 3 * products[e]);
      assert_true(settling_error(s, reference) < 1e-4);
      free(reference);
      settling_free(s);
    }
    assert_true(abs(products[2] - products[0]) <= 3);
  }
}

/* --- what the model resists --- */

/* out [rows] = X v */
static void resist_approach(const sd_bodies *A, const double *v, double *out)
{
  memset(out, 0, sizeof(double) * (size_t) sd_bodies_unknowns(A));
  sd_tie_approach_see(A, v);
  assert_int_equal(sd_tie_approach_push(A, NULL, NULL, NULL), SD_OK);
  sd_tie_approach_add(A, out);
}

/* X of a crowd of unequal spheres: a sum of squares, zero for whatever moves all alike, and nothing but
 * translations; `stiff` is its diagonal. */
static void model_resists_approach_alone(void **state)
{
  (void) state;
  static const double a[8] = {1.0, 1.4, 0.6, 1.0, 0.8, 1.2, 1.0, 0.7};
  flock *f = flock_create(0, NULL, NULL, 1, 0, 8, 1.3);
  memcpy(f->a, a, sizeof(a));
  crowd(f, 0.3, 11);
  tied_flock *t = tie_flock(f, 1e-3);
  flock_weigh(f, P6);
  assert_int_equal(tied_move(t, 0, 1e-3, 100), SD_OK);
  sd_bodies A = flock_place(f, 6);
  A.tie = &t->tie;
  enum { N = 48 };
  double X[N][N], together[N] = {0.0}, out[N];
  for (int j = 0; j < N; j++) {
    double unit[N] = {0.0};
    unit[j] = 1.0;
    resist_approach(&A, unit, X[j]);
    if (j % 6 == 1) together[j] = 1.0;
  }
  resist_approach(&A, together, out);
  double largest = 0.0;
  for (int p = 0; p < N; p++)
    for (int q = 0; q < N; q++) {
      CHECK_NEAR(X[p][q], X[q][p], 1e-14);
      if (p % 6 > 2 || q % 6 > 2) assert_true(X[p][q] == 0.0);
      largest = fmax(largest, X[p][q]);
      if (p / 6 != q / 6) continue;
      const double *own = t->tie.springs.own + 6 * (p / 6);
      if (p % 6 < 3 && q % 6 < 3) CHECK_NEAR(own[sd_symmetric3_at(p % 6, q % 6)], X[p][q], 1e-12 * largest);
    }
  assert_true(largest > 0.5 * P6);
  for (int j = 0; j < N; j++) CHECK_NEAR(out[j], 0.0, 1e-14 * largest);
  uint64_t seed = 3;
  for (int k = 0; k < 100; k++) {
    double v[N], w[N], power = 0.0;
    for (int j = 0; j < N; j++) v[j] = uniform(&seed, -1, 1);
    resist_approach(&A, v, w);
    for (int j = 0; j < N; j++) power += v[j] * w[j];
    assert_true(power > 0.0);
  }
  untie(t);
}

/* A weight, and unlike forces. The blocks of lone spheres alone would take 28 for these; and all that
 * fall together need no more than unlike forces do, if the tolerance is of the power that is spent. */
static void dense_clouds_take_few_products(void **state)
{
  (void) state;
  static const double error[2] = {1e-4, 1e-3};
  int products[2];
  const int n = CHECK_SIZE(2000, 400);
  const size_t size = sizeof(double) * 6 * (size_t) n;
  settling *s = settling_create(n, 0.5, 1e-6);
  double *reference = malloc(size);
  for (int k = 0; k < 2; k++) {
    settling_solve(s, 0, 1e-6);
    memcpy(reference, s->v, size);
    settling_solve(s, 0, 1e-3);
    products[k] = s->report.products;
    assert_true(products[k] <= 20);
    assert_true(s->tie.products <= 5 * products[k]);
    assert_true(settling_error(s, reference) < error[k]);
    settling_shake(s, 5);
  }
  assert_true(products[0] <= products[1] + 1);
  free(reference);
  settling_free(s);
}

/* Nor does that of products with L: with less than one digit for each product, and one for the guess, a step from the
 * last one takes a half of what a hundredth of each would. */
static void products_within_are_few(void **state)
{
  (void) state;
  double reference[1200], l[1200], before[1200];
  for (int e = 0; e < 3; e++) {
    settling *s = settling_create(200, 0.3, pow(10.0, -2 - 2 * e));
    settling_solve(s, 0, 1e-5);
    memcpy(l, s->l, sizeof(l));
    memcpy(before, s->before, sizeof(before));
    for (int j = 0; j < 600; j++) s->near.s.x[j] += 0.003 * s->v[6 * (j / 3) + j % 3];
    settling_place(s);
    settling_solve(s, 0, 1e-9);
    memcpy(reference, s->v, sizeof(reference));
    memcpy(s->l, l, sizeof(l));
    memcpy(s->before, before, sizeof(before));
    settling_solve(s, 1, 1e-6);
    assert_true(s->report.products > 3);
    assert_true(s->tie.products <= 3 * s->report.products);
    assert_true(settling_error(s, reference) < 1e-7);
    settling_free(s);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(both_lines_hold),
      cmocka_unit_test(far_spheres_are_as_without),
      cmocka_unit_test(shells_and_lubrication_go_together),
      cmocka_unit_test(a_guess_is_taken_up),
      cmocka_unit_test(products_do_not_depend_on_the_gap),
      cmocka_unit_test(model_resists_approach_alone),
      cmocka_unit_test(dense_clouds_take_few_products),
      cmocka_unit_test(products_within_are_few),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
