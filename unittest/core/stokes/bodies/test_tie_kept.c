/* The factor of films that stays while they hardly change (sd_tie_kept.h): answers are those of a new one, in as many
 * products. */
#include "settling.h"

static void move(settling *s, double far)
{
  for (int j = 0; j < 3 * s->A.lone; j++) s->near.s.x[j] += far * s->v[6 * (j / 3) + j % 3];
  settling_place(s);
}

/* A step of less than a thousandth of a radius against each other; then one of a tenth */
static void a_kept_factor_answers_as_a_new_one(void **state)
{
  (void) state;
  enum { N = 400 };
  static double kept[6 * N], l[6 * N], before[6 * N];
  for (int e = 0; e < 2; e++) {
    settling *s = settling_create(N, 0.3, e ? 1e-2 : 1e-3);
    settling_solve(s, 0, 1e-8);
    assert_true(s->tie.anew);
    move(s, 3e-4);
    memcpy(l, s->l, sizeof(l));
    memcpy(before, s->before, sizeof(before));
    s->tie.keep = 1;
    settling_solve(s, 1, 1e-8);
    assert_false(s->tie.anew);
    const int products = s->report.products;
    memcpy(kept, s->v, sizeof(kept));
    s->tie.keep = 0;
    memcpy(s->l, l, sizeof(l));
    memcpy(s->before, before, sizeof(before));
    settling_solve(s, 1, 1e-8);
    assert_true(s->tie.anew);
    assert_true(abs(s->report.products - products) <= 1);
    assert_true(settling_error(s, kept) < 1e-8);
    s->tie.keep = 1;
    move(s, 0.05);
    settling_solve(s, 1, 1e-3);
    assert_true(s->tie.anew);
    settling_free(s);
  }
}

/* Two spheres that part, and two that meet: what was stiff then says as little of now as what is stiff now. */
static void parting_and_meeting_films_are_seen(void **state)
{
  (void) state;
  settling *s = settling_create(2, 0.1, 1e-6);
  double *x = s->near.s.x;
  static const double gap[4] = {1e-3, 1.01e-3, 1e-2, 1e-3};
  static const int anew[4] = {1, 0, 1, 1};
  for (int k = 0; k < 4; k++) {
    for (int d = 0; d < 6; d++) x[d] = 0.0;
    x[3] = 2.0 + gap[k];
    settling_place(s);
    settling_solve(s, 0, 1e-6);
    assert_int_equal(s->tie.anew, anew[k]);
    s->tie.keep = 1;
  }
  settling_free(s);
}

/* Spheres that hardly have a gap turn together: a factor is blind to which of their motions are soft now. */
static void very_stiff_films_have_a_new_one_each_time(void **state)
{
  (void) state;
  settling *s = settling_create(200, 0.5, 1e-6);
  for (int k = 0; k < 2; k++) {
    settling_solve(s, 0, 1e-3);
    assert_true(s->tie.anew);
    s->tie.keep = 1;
  }
  settling_free(s);
}

/* Nor that of other bodies, whatever the caller says */
static void a_factor_of_fewer_bodies_does_not_stay(void **state)
{
  (void) state;
  settling *s = settling_create(60, 0.3, 1e-3);
  settling_solve(s, 0, 1e-6);
  s->tie.keep = 1;
  s->A.lone = s->A.spheres.n = s->A.points.n = 59;
  s->near.s.n = 59;
  settling_place(s);
  settling_solve(s, 0, 1e-6);
  assert_true(s->tie.anew);
  settling_free(s);
}

static void spread(settling *s, double by)
{
  for (int j = 0; j < 3 * s->A.lone; j++) s->near.s.x[j] *= by;
  settling_place(s);
}

/* Leaves so much between the closest two */
static void set_gap(settling *s, const int pair[2], const double d[3], double gap)
{
  for (int c = 0; c < 3; c++) s->near.s.x[3 * pair[1] + c] = s->near.s.x[3 * pair[0] + c] + (2.0 + gap) * d[c];
  settling_place(s);
}

/* One in a thousand may change as it likes. The norm of the factor does not see that a film which was stiff is soft
 * now, and r.z is negative: the solve begins anew with a factor of now. */
static void a_film_that_opens_makes_nothing_indefinite(void **state)
{
  (void) state;
  enum { N = 3000 };
  settling *s = settling_create(N, 0.2, 1e-6);
  spread(s, 1.01);
  long closest = 0;
  for (long k = 0; k < s->near.L.count; k++)
    if (fabs(s->near.L.link[k].XA) > fabs(s->near.L.link[closest].XA)) closest = k;
  int pair[2];
  double d[3];
  memcpy(pair, s->near.L.pair[closest], sizeof(pair));
  memcpy(d, s->near.L.link[closest].d, sizeof(d));
  settling_shake(s, 5);
  set_gap(s, pair, d, 1e-6);
  settling_solve(s, 0, 1e-6);
  s->tie.keep = 1;
  set_gap(s, pair, d, 0.02);
  settling_solve(s, 0, 0.5);
  assert_false(s->tie.anew);
  settling_solve(s, 0, 1e-10);
  assert_true(s->tie.anew);
  settling_free(s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_kept_factor_answers_as_a_new_one),
      cmocka_unit_test(parting_and_meeting_films_are_seen),
      cmocka_unit_test(very_stiff_films_have_a_new_one_each_time),
      cmocka_unit_test(a_factor_of_fewer_bodies_does_not_stay),
      cmocka_unit_test(a_film_that_opens_makes_nothing_indefinite),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
