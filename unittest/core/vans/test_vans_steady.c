/* The steady state of a series, and its mean with an error. */
#include "check.h"

#include "sd_vans_random.h"
#include "sd_vans_steady.h"

static double noise(int run, int k)
{
  double three[3];
  sd_vans_normal3(4711 + run, k, 0, three);
  return three[0];
}

/* x = 2 + 3 exp(-t/300) + noise of correlation time 50 and size 0.3; the other number is constant. */
static int mean_of_run(int run, int samples, double *mean, double *error)
{
  sd_vans_series series = {0};
  double correlated = 0.0;
  const double keep = exp(-1.0 / 50);
  for (int k = 0; k < samples; k++) {
    correlated = keep * correlated + 0.3 * sqrt(1 - keep * keep) * noise(run, k);
    const double sample[SD_VANS_SERIES] = {2.0 + 3.0 * exp(-k / 300.0) + correlated, 7.0};
    sd_vans_series_add(&series, sample);
  }
  double constant, zero;
  assert_true(sd_vans_series_mean(&series, 1, &constant, &zero) || samples < 16);
  assert_true(constant == 7.0 && (zero == 0.0 || samples < 16));
  return sd_vans_series_mean(&series, 0, mean, error);
}

/* The error of a mean of T samples of that noise is 0.3 sqrt(2 50/T). Over 100 runs the means lie
 * within it as often as a normal number does, or more; the start is not in them. */
static void means_and_errors_of_a_steady_state(void **state)
{
  (void) state;
  enum { RUNS = 100, SAMPLES = 20000 };
  double sum = 0.0, squares = 0.0, said = 0.0;
  int within = 0;
  for (int run = 0; run < RUNS; run++) {
    double mean, error;
    assert_true(mean_of_run(run, SAMPLES, &mean, &error));
    sum += mean - 2.0;
    squares += (mean - 2.0) * (mean - 2.0);
    said += error;
    within += fabs(mean - 2.0) < 2.0 * error;
  }
  const double expected = 0.3 * sqrt(100.0 / SAMPLES), scatter = sqrt(squares / RUNS);
  printf("    bias %.4f, scatter %.4f, error said %.4f, of independent theory %.4f; within two of them: %d of 100\n",
         sum / RUNS, scatter, said / RUNS, expected, within);
  assert_true(fabs(sum / RUNS) < 0.5 * expected);
  assert_true(scatter < 1.3 * expected && said / RUNS > 0.9 * scatter && said / RUNS < 2.0 * scatter);
  assert_true(within >= 90);
}

/* While a number drifts by more than its noise the error is not small, whatever the scatter. */
static void the_way_there_is_not_steady(void **state)
{
  (void) state;
  sd_vans_series series = {0};
  double mean, error;
  assert_false(sd_vans_series_mean(&series, 0, &mean, &error));
  assert_true(mean == 0.0 && error == 0.0);
  for (int k = 0; k < 1000; k++) {
    const double sample[SD_VANS_SERIES] = {0.01 * k, 0.0};
    sd_vans_series_add(&series, sample);
    sd_vans_series_mean(&series, 0, &mean, &error);
    assert_true(error >= 0.1 * mean);
  }
  assert_true(series.blocks < SD_VANS_BLOCKS);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(means_and_errors_of_a_steady_state),
      cmocka_unit_test(the_way_there_is_not_steady),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
