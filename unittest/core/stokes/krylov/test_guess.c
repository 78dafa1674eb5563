/* What a solve begins from: answers of a sequence of solves, and forces as a guess. */
#include "check.h"

#include "sd_guess.h"

/* Answers of so many solves at t = 0, 1, .. : after them the guess of the next is on the line, or it is not. */
static int line_is_nearer(double (*x)(double t), int solves)
{
  double last = 0.0, before = 0.0;
  sd_guess_answers found = {0};
  for (int k = 0; k < solves; k++) {
    found = (sd_guess_answers){0};
    sd_guess_take(&found, x(k), 0.7, &last, &before);
    assert_true(last == x(k));
    assert_true(before == (k > 0 ? x(k - 1) : 0.0));
  }
  return found.off_line < found.off_last;
}

static double grows(double t)
{
  return 3.0 + 0.4 * t;
}

static double jitters(double t)
{
  return 3.0 + ((int) t % 2 ? 0.1 : -0.1);
}

/* The line through two answers of what grows evenly hits the third, and misses what goes to and fro. */
static void what_grows_evenly_is_on_the_line(void **state)
{
  (void) state;
  assert_true(line_is_nearer(grows, 3));
  assert_false(line_is_nearer(jitters, 3));
  CHECK_NEAR(sd_guess_at(1.0, grows(1), grows(0)), grows(2), 1e-15);
  assert_true(sd_guess_at(0.0, grows(1), grows(0)) == grows(1));
  assert_true(sd_guess_at(1.0, grows(1), 0.0) == grows(1)); /* one answer is no line */
}

/* Where the step is that of the last answer once more, that of before stays: the next line goes through it. */
static void a_step_made_again_counts_once(void **state)
{
  (void) state;
  double last = grows(1), before = grows(0);
  sd_guess_answers found = {.again = 1};
  sd_guess_take(&found, grows(1) + 1e-3, 0.7, &last, &before);
  assert_true(before == grows(0));
  assert_true(last == grows(1) + 1e-3);
  /* the answer is hardly another one, and the line from here would go on by 0.4 */
  CHECK_NEAR(found.off_line, 1e-6 / (0.7 * 0.7), 1e-15);
  CHECK_NEAR(found.off_last, 0.16 / (0.7 * 0.7), 1e-14);
}

/* Units say how much a torque is beside a force. */
static void misses_are_measured_in_units(void **state)
{
  (void) state;
  double last = 2.0, before = 1.5;
  sd_guess_answers small = {0}, large = {0};
  sd_guess_take(&small, 2.3, 1.0, &last, &before);
  last = 2.0, before = 1.5;
  sd_guess_take(&large, 2.3, 0.1, &last, &before);
  CHECK_NEAR(large.off_last / small.off_last, 100.0, 1e-11);
  CHECK_NEAR(large.off_line / small.off_line, 100.0, 1e-11);
}

/* Forces of before, as what others add, are the same forces in the same slip, and the drag D s' - F_others in
 * another one: of a sphere that nobody disturbs that is exact. */
static void forces_as_a_guess_have_the_slip_of_now(void **state)
{
  (void) state;
  const double D[2] = {2.3, 0.9}, s[2] = {0.4, -0.7}, now[2] = {1.1, 0.3}, alone[2] = {-2.3 * 0.4, 0.9 * 0.7};
  const double exerted[2] = {1.7, -0.2};
  double v[2], none[2];
  sd_guess_perturbation(2, D, s, exerted, v);
  sd_guess_exerted(2, D, s, v);
  for (int j = 0; j < 2; j++) CHECK_NEAR(v[j], exerted[j], 1e-15);
  sd_guess_perturbation(2, D, s, exerted, v);
  sd_guess_exerted(2, D, now, v);
  for (int j = 0; j < 2; j++) CHECK_NEAR(v[j], exerted[j] - D[j] * (now[j] - s[j]), 1e-15);
  sd_guess_perturbation(2, D, s, alone, none);
  for (int j = 0; j < 2; j++) CHECK_NEAR(none[j], 0.0, 1e-15);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(what_grows_evenly_is_on_the_line),
                                     cmocka_unit_test(a_step_made_again_counts_once),
                                     cmocka_unit_test(misses_are_measured_in_units),
                                     cmocka_unit_test(forces_as_a_guess_have_the_slip_of_now)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
