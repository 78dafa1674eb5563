/* The fastest rate of decay by power iteration. */
#include "check.h"

#include "sd_rate.h"

enum { N = 4 };

/* R = times (1 + 8 b b^T), b.b = 1; counts its products, and says how they ended */
typedef struct {
  double b[N], times;
  int products;
  sd_status fails;
} resistance;

static sd_status apply(void *ctx, const double *v, double *Rv)
{
  resistance *R = ctx;
  double sum = 0.0;
  for (int j = 0; j < N; j++) sum += R->b[j] * v[j];
  for (int j = 0; j < N; j++) Rv[j] = R->times * (v[j] + 8.0 * sum * R->b[j]);
  R->products++;
  return R->fails;
}

static const sd_world alone = {0};

/* W = 3 and R = 1 + 8 b b^T, whose eigenvalues are 1 and 9: the rate is 3, from below, and every product takes the
 * square of 1/9 of what it lacks. */
static void the_stiffest_motion_is_found_from_below(void **state)
{
  (void) state;
  const double W[N] = {3.0, 3.0, 3.0, 3.0};
  double lacks = 0.0;
  for (int products = 1; products < 7; products++) {
    resistance R = {.b = {0.5, -0.5, 0.5, 0.5}, .times = 1.0};
    double v[N] = {1.0, 0.3, -0.2, 0.4}, work[N], rate;
    const sd_decay of = {N, W, apply, &R, &alone};
    assert_int_equal(sd_rate(&of, products, v, work, &rate), SD_OK);
    assert_int_equal(R.products, products);
    assert_true(rate <= 3.0 + 1e-14);
    if (products > 2) CHECK_NEAR((3.0 - rate) / lacks, 1.0 / 81.0, 1e-3);
    lacks = 3.0 - rate;
  }
}

/* Inertias that differ, and rates far from 1: b pulls on the heaviest alone. */
static void the_rate_is_that_of_the_inertias(void **state)
{
  (void) state;
  const double W[N] = {0.5, 2.0, 40.0, 7.0}, times = 1e-100;
  resistance R = {.b = {0.0, 0.0, 1.0, 0.0}, .times = times};
  const sd_decay of = {N, W, apply, &R, &alone};
  double v[N] = {1.0, 1.0, 1.0, 1.0}, work[N], rate;
  assert_int_equal(sd_rate(&of, 60, v, work, &rate), SD_OK);
  CHECK_NEAR(rate / times, 2.0, 1e-12); /* the lightest: 1/0.5; 9/40 is slower */
}

static void nothing_decays_without_a_resistance(void **state)
{
  (void) state;
  const double W[N] = {1.0, 2.0, 3.0, 4.0};
  resistance none = {.times = 0.0}, broken = {.times = 1.0, .fails = SD_ENOMEMORY}, infinite = {.times = INFINITY};
  double v[N] = {1.0, 1.0, 1.0, 1.0}, work[N], rate = 7.0;
  const sd_decay of_none = {N, W, apply, &none, &alone}, of_broken = {N, W, apply, &broken, &alone};
  const sd_decay of_infinite = {N, W, apply, &infinite, &alone};
  assert_int_equal(sd_rate(&of_none, 5, v, work, &rate), SD_OK);
  CHECK_NEAR(rate, 0.0, 0.0);
  assert_int_equal(none.products, 1);
  assert_int_equal(sd_rate(&of_broken, 5, v, work, &rate), SD_ENOMEMORY);
  assert_int_equal(sd_rate(&of_infinite, 5, v, work, &rate), SD_ENOTFINITE);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_stiffest_motion_is_found_from_below),
      cmocka_unit_test(the_rate_is_that_of_the_inertias),
      cmocka_unit_test(nothing_decays_without_a_resistance),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
