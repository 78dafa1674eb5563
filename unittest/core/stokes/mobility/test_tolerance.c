/* Errors of products in random scenes that once were above the tolerance, and why; more scenes: bench_tolerance. */
#include "random_scene.h"

/* Number k of those of a seed */
static void keeps_it(uint64_t seed, int k, const wish *w)
{
  scene s = random_scene(seed, k, w);
  const errors_over_tolerance e = errors_of(&s);
  if (getenv("STOKESDYN_SHOW"))
    printf("%s, %s: U %.2f W %.2f weights %.2f\n", kinds[s.kind], places[s.place], e.U, e.W, e.weights);
  assert_true(e.U < 1.0 && e.W < 1.0 && e.weights < 1.0 && e.spheres < 1.0);
  scene_release(&s);
}

/* Among scenes of at most 400 spheres that stand evenly, at 1e-1 to 1e-12 */
static void keeps_the_tolerance(uint64_t seed, int k)
{
  const wish any = {.most = 400, .kind = -1, .place = -1, .loosest = 1, .tightest = 12};
  keeps_it(seed, k, &any);
}

/* 1.13 to 1.22: small spheres feel beyond the range that the others are large. */
static void what_large_spheres_leave_of_small_ones(void **state)
{
  (void) state;
  keeps_the_tolerance(48601, 183);
  keeps_the_tolerance(48601, 595);
}

/* 1.02 and 1.20: the mean that unlike spheres leave beyond the range. */
static void what_unlike_spheres_leave_above_a_floor(void **state)
{
  (void) state;
  keeps_the_tolerance(48601, 120);
  keeps_the_tolerance(48601, 137);
}

/* 1.15 in an open box, 1.05 and 1.30 above a floor, where windows mistook a flow that is the same everywhere. */
static void what_windows_mistake_of_a_common_flow(void **state)
{
  (void) state;
  keeps_the_tolerance(48601, 282);
  keeps_the_tolerance(48601, 290);
  keeps_the_tolerance(48601, 564);
}

/* Points of shells with torques, most of which overlap: spins had 1.06. */
static void spins_of_points_that_overlap(void **state)
{
  (void) state;
  keeps_the_tolerance(48601, 74);
}

/* Two large spheres in a narrow slit see their images just beyond the range: 1.13 by a mean over all places. */
static void images_of_large_spheres_in_a_slit(void **state)
{
  (void) state;
  keeps_the_tolerance(48601, 56);
}

/* 2.10 and 1.18 under weights in clusters above a wall of an open box: heights multiply what windows mistake of short
 * waves of images. */
static void short_waves_of_images_above_a_wall(void **state)
{
  (void) state;
  const wish unlike = {.most = 120, .kind = MANY_SIZES, .place = -1, .spread = CLUSTERS, .loosest = 1, .tightest = 12};
  keeps_it(48752, 48, &unlike);
  keeps_it(48752, 331, &unlike);
  /* On one plane: 3.21 and 1.16, 1.83 and 1.13 with a beta of 2.25 points; 4.4 with 2.05 points at 1e-12 */
  const wish plane = {.most = 100, .kind = EQUAL, .place = ABOVE_WALL, .spread = PLANE, .loosest = 1, .tightest = 12};
  const int first[] = {10, 32}, second[] = {12, 26, 42};
  for (int k = 0; k < 2; k++) keeps_it(48902, first[k], &plane);
  for (int k = 0; k < 3; k++) keeps_it(48903, second[k], &plane);
}

/* Spheres on one plane have the same place on the grid across it, and what their windows mistake adds up under equal
 * forces: 1.0 to 1.8 in slabs, 1.1 to 4.8 in oblong boxes, 1.7 and 4.5 in open ones, without the bend of the window. */
static void what_windows_mistake_of_spheres_on_one_plane(void **state)
{
  (void) state;
  const wish any = {.most = 120, .kind = -1, .place = -1, .spread = -1, .loosest = 1, .tightest = 12};
  wish plane = {.most = 100, .kind = EQUAL, .place = SLIT, .spread = PLANE, .loosest = 1, .tightest = 12};
  const int in_any[] = {121, 135, 146, 193}, in_oblong[] = {1, 32, 49}, in_open[] = {20, 32, 37};
  for (int k = 0; k < 4; k++) keeps_it(48752, in_any[k], &any);
  keeps_it(48902, 4, &plane);
  plane.place = FLOOR;
  keeps_it(48902, 20, &plane);
  plane.place = OBLONG;
  for (int k = 0; k < 3; k++) keeps_it(48902, in_oblong[k], &plane);
  plane.place = OBLIQUE; /* 1.3 with a beta of 2.25 points */
  keeps_it(48902, 37, &plane);
  plane.place = OPEN;
  for (int k = 0; k < 3; k++) keeps_it(48902, in_open[k], &plane);
}

/* 1.56 and 1.75 in layers, 1.06 and 1.56 in slits, 1.26 in an open box: windows mistook more of a flow that all have
 * in common than elsewhere, on a grid as coarse. */
static void what_windows_mistake_in_slabs_and_open_boxes(void **state)
{
  (void) state;
  const wish any = {.most = 120, .kind = -1, .place = -1, .spread = -1, .loosest = 1, .tightest = 12};
  wish plane = {.most = 100, .kind = EQUAL, .place = SLIT, .spread = PLANE, .loosest = 1, .tightest = 12};
  keeps_it(48752, 264, &any);
  keeps_it(48752, 297, &any);
  keeps_it(48902, 37, &plane);
  plane.place = LAYER;
  keeps_it(48903, 20, &plane);
  const wish dense = {.most = 1200, .kind = EQUAL, .place = OPEN, .spread = EVEN, .loosest = 10, .tightest = 10};
  keeps_it(48904, 13, &dense);
}

/* 1.03 to 2.13 in clusters in open boxes, 1.12 where nearly all are within the range: what is left beyond it was three
 * times as much at its end, and all of one sign. */
static void what_is_left_beyond_the_range_of_open_boxes(void **state)
{
  (void) state;
  wish open = {.most = 1200, .kind = EQUAL, .place = OPEN, .spread = CLUSTERS, .loosest = 1, .tightest = 12};
  const int above[] = {23, 24, 38, 54};
  for (int k = 0; k < 4; k++) keeps_it(48903, above[k], &open);
  open.spread = EVEN;
  keeps_it(48903, 24, &open);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_large_spheres_leave_of_small_ones),
      cmocka_unit_test(what_unlike_spheres_leave_above_a_floor),
      cmocka_unit_test(what_windows_mistake_of_a_common_flow),
      cmocka_unit_test(spins_of_points_that_overlap),
      cmocka_unit_test(images_of_large_spheres_in_a_slit),
      cmocka_unit_test(short_waves_of_images_above_a_wall),
      cmocka_unit_test(what_windows_mistake_of_spheres_on_one_plane),
      cmocka_unit_test(what_windows_mistake_in_slabs_and_open_boxes),
      cmocka_unit_test(what_is_left_beyond_the_range_of_open_boxes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
