/* Transforms of lines that are even or odd about both ends: against the sums that define them, along each direction of
 * a box whose sides differ, a part of its lines, and numbers of lines that fill no bunch. */
#include "check.h"

#include "sd_constants.h"
#include "sd_padded_lines.h"

#include <string.h>

enum { X = 5, Y = 11, Z = 7, ALL = X * Y * Z };
static const int SIZE[3] = {X, Y, Z};
static const long STEP[3] = {Y * Z, Z, 1};

static double sum_at(const double *x, long stride, int n, int odd, int k)
{
  const double end = k % 2 ? -x[(n - 1) * stride] : x[(n - 1) * stride];
  double sum = odd ? 0.0 : x[0] + end;
  for (int j = 1; j < n - 1; j++) {
    const double angle = SD_PI * j * k / (n - 1);
    sum += 2.0 * x[j * stride] * (odd ? sin(angle) : cos(angle));
  }
  return sum;
}

static void fill(double *x)
{
  for (int i = 0; i < ALL; i++) x[i] = sin(1.0 + 0.37 * i * i);
}

/* Is a place on a line along d of those from `from` to before `end`? */
static int is_within(const int *at, int d, const int *from, const int *end)
{
  for (int c = 0; c < 3; c++)
    if (c != d && (at[c] < from[c] || at[c] >= end[c])) return 0;
  return 1;
}

static void lines_are_the_sums(int d, int odd)
{
  const int from[3] = {1, 2, 0}, end[3] = {4, 11, 5}, n = SIZE[d];
  double before[ALL], after[ALL];
  fill(before);
  memcpy(after, before, sizeof(before));
  sd_padded_lines *t = sd_padded_lines_create(n);
  assert_non_null(t);
  sd_padded_lines_apply(t, odd, d, SIZE, from, end, after);
  sd_padded_lines_free(t);
  for (int i = 0; i < ALL; i++) {
    const int at[3] = {i / (Y * Z), i / Z % Y, i % Z}, k = at[d], is_end = k == 0 || k == n - 1;
    const int stays = !is_within(at, d, from, end) || (odd && is_end);
    const double wanted = stays ? before[i] : sum_at(before + i - k * STEP[d], STEP[d], n, odd, k);
    CHECK_NEAR(after[i], wanted, stays ? 0.0 : 1e-13);
  }
}

static void each_direction_has_its_sums(void **state)
{
  (void) state;
  for (int d = 0; d < 3; d++)
    for (int odd = 0; odd < 2; odd++) lines_are_the_sums(d, odd);
}

static void twice_is_the_period_times_what_was_there(void **state)
{
  (void) state;
  const int from[3] = {0, 0, 0};
  double before[ALL], after[ALL];
  fill(before);
  memcpy(after, before, sizeof(before));
  sd_padded_lines *t = sd_padded_lines_create(Y);
  assert_non_null(t);
  for (int k = 0; k < 2; k++) sd_padded_lines_apply(t, 0, 1, SIZE, from, SIZE, after);
  sd_padded_lines_free(t);
  for (int i = 0; i < ALL; i++) CHECK_NEAR(after[i], 2.0 * (Y - 1) * before[i], 1e-13);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(each_direction_has_its_sums),
      cmocka_unit_test(twice_is_the_period_times_what_was_there),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
