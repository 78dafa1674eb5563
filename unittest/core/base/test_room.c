/* Arrays that grow. */
#define _DEFAULT_SOURCE
#include <string.h>
#include <unistd.h>

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

/* Of the memory at this place Linux knows that its pages should be large; -1: this kernel has none */
static int is_in_large_pages(const void *place)
{
  char line[512];
  int here = 0, asked = 0;
  FILE *maps = fopen("/proc/self/smaps", "r");
  if (!maps || access("/sys/kernel/mm/transparent_hugepage/enabled", F_OK)) asked = -1;
  while (maps && asked == 0 && fgets(line, sizeof(line), maps)) {
    unsigned long from, to;
    if (sscanf(line, "%lx-%lx ", &from, &to) == 2) here = (uintptr_t) place >= from && (uintptr_t) place < to;
    if (here && strncmp(line, "VmFlags:", 8) == 0) asked = strstr(line, " hg") != NULL;
  }
  if (maps) fclose(maps);
  return asked;
}

static void large_arrays_are_in_large_pages(void **state)
{
  (void) state;
  const size_t page = (size_t) 2 << 20, most = 9 * page / 4;
  char *array = NULL;
  size_t room = 0;
  assert_true(sd_reserve(&array, 1, most, &room));
  if (is_in_large_pages(array) < 0) skip();
  assert_int_equal((uintptr_t) array % page, 0);
  assert_true(is_in_large_pages(array) && is_in_large_pages(array + 2 * page - 1));
  assert_false(is_in_large_pages(array + most - 1)); /* a quarter of a page is not worth a whole one */
  memset(array, 1, most);
  assert_true(sd_grow(&array, 1, 8 * page));
  assert_int_equal(array[most - 1], 1);
  assert_true(is_in_large_pages(array + 4 * page));
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
      cmocka_unit_test(large_arrays_are_in_large_pages),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
