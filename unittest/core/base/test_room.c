/* Arrays that grow. */
#include "check.h"

#include "sd_room.h"

/* A sanitizer would rather end the program than say that there is no memory. */
const char *__asan_default_options(void);
__attribute__((visibility("default"))) const char *__asan_default_options(void)
{
  return "allocator_may_return_null=1";
}

static void grown_array_keeps_what_it_holds(void **state)
{
  (void) state;
  double(*pair)[2] = NULL;
  for (int n = 1; n <= 3000; n = 3 * n + 1) {
    assert_true(sd_grow(&pair, sizeof(*pair), (size_t) n));
    for (int i = n / 3; i < n; i++) pair[i][0] = pair[i][1] = 0.5 * i;
    for (int i = 0; i < n; i++) assert_true(pair[i][0] == 0.5 * i && pair[i][1] == 0.5 * i);
  }
  free(pair);
}

static void array_without_memory_to_grow_is_as_before(void **state)
{
  (void) state;
  int *array = NULL;
  assert_true(sd_grow(&array, sizeof(int), 1));
  int *const before = array;
  *array = 37;
  assert_false(sd_grow(&array, sizeof(int), SIZE_MAX / 8));
  assert_ptr_equal(array, before);
  assert_int_equal(*array, 37);
  free(array);
}

static void extended_array_keeps_what_it_holds_and_grows_by_a_quarter(void **state)
{
  (void) state;
  int *array = NULL;
  size_t room = 0, moves = 0;
  for (int n = 0; n < 100000; n++) {
    const size_t before = room;
    assert_true(sd_extend(&array, sizeof(int), (size_t) n + 1, &room));
    assert_true(room > (size_t) n && (room == before || room >= before + before / 4));
    moves += room != before;
    array[n] = n;
  }
  for (int n = 0; n < 100000; n++) assert_int_equal(array[n], n);
  assert_true(moves < 35);
  int *const before = array;
  const size_t there = room;
  assert_false(sd_extend(&array, sizeof(int), SIZE_MAX / 8, &room));
  assert_ptr_equal(array, before);
  assert_int_equal(room, there);
  free(array);
}

static void reserved_array_moves_only_when_it_must(void **state)
{
  (void) state;
  long *array = NULL;
  size_t room = 0;
  assert_true(sd_reserve(&array, sizeof(long), 80, &room));
  assert_int_equal(room, 80);
  long *const before = array;
  assert_true(sd_reserve(&array, sizeof(long), 0, &room));
  assert_true(sd_reserve(&array, sizeof(long), 80, &room));
  assert_ptr_equal(array, before);
  assert_true(sd_reserve(&array, sizeof(long), 160, &room));
  assert_int_equal(room, 180); /* once more than at first: an eighth to spare */
  array[room - 1] = 7;
  assert_false(sd_reserve(&array, sizeof(long), SIZE_MAX / 16, &room));
  assert_null(array);
  assert_int_equal(room, 0);
}

static void nothing_is_an_array_too(void **state)
{
  (void) state;
  char *array = NULL;
  size_t room = 0;
  assert_true(sd_reserve(&array, 1, 0, &room));
  assert_non_null(array);
  free(array);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(grown_array_keeps_what_it_holds),
      cmocka_unit_test(array_without_memory_to_grow_is_as_before),
      cmocka_unit_test(extended_array_keeps_what_it_holds_and_grows_by_a_quarter),
      cmocka_unit_test(reserved_array_moves_only_when_it_must),
      cmocka_unit_test(nothing_is_an_array_too),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
