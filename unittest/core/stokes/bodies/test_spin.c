/* Who is overloaded among the spheres that a field spins (sd_spin.h). */
#include "check.h"

#include "sd_spin.h"

/* About (2, 1, -2)/3, at 1.5, with a largest torque of 0.8 */
static const sd_spin_field field = {{1.0, 0.5, -1.0}, {2.0 / 3.0, 1.0 / 3.0, -2.0 / 3.0}, 0.8};

/* Along the axis of the field */
static double overload(const sd_spin_field *of, double now, double speed, double by_fluid, double others)
{
  double W[3], T[3], F[3];
  for (int d = 0; d < 3; d++) {
    W[d] = speed * of->axis[d];
    T[d] = by_fluid * of->axis[d];
    F[d] = others * of->axis[d];
  }
  return sd_spin_overload(of, now, W, T, F);
}

/* The field has to make up for the torques of the fluid and of all others, in either direction. */
static void more_than_the_largest_torque_overloads(void **state)
{
  (void) state;
  assert_true(overload(&field, 0, 1.5, -0.79, 0) == 0 && overload(&field, 0, 1.5, -0.81, 0) == 1);
  assert_true(overload(&field, 0, 1.5, -0.79, -0.02) == 1 && overload(&field, 0, 1.5, -0.9, 0.2) == 0);
  assert_true(overload(&field, 0, 1.5, 0.5, 0.31) == -1);
  const double W[3] = {1.0, 0.5, -1.0}, across[3] = {0.6, 0.0, 0.6}, none[3] = {0.0};
  assert_true(sd_spin_overload(&field, 0, W, across, none) != 0);    // no torque is only along the axis
}

/* A slow one until it is as fast as the field, a fast one until it is as slow */
static void an_overloaded_sphere_catches_up(void **state)
{
  (void) state;
  assert_true(overload(&field, 1, 1.49, 0, 0) == 1 && overload(&field, 1, 1.51, 0, 0) == 0);
  assert_true(overload(&field, -1, 1.51, 0, 0) == -1 && overload(&field, -1, 1.49, 0, 0) == 0);
  assert_true(overload(&field, 1, 1.49, -5, -5) == 1 && overload(&field, -1, 1.51, -5, -5) == -1);
}

static void a_field_without_a_limit_overloads_nobody(void **state)
{
  (void) state;
  sd_spin_field strong = field;
  strong.most = 0.0;
  assert_true(overload(&strong, 0, 1.5, -1e9, 0) == 0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(more_than_the_largest_torque_overloads),
      cmocka_unit_test(an_overloaded_sphere_catches_up),
      cmocka_unit_test(a_field_without_a_limit_overloads_nobody),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
