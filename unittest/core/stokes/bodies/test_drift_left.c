/* What one solve leaves of the drift (sd_drifter.h), and for which splitting bodies have roots (sd_body_root.h):
 * closed forms, and that no unit of a shape matters. Whether the drift is right: multiblob/test_drift.c. */
#include "check.h"

#include "sd_body_root.h"
#include "sd_drifter.h"
#include "sd_linear.h"
#include "sd_pose.h"

#include <string.h>

enum { POINTS = 24 };

static int rows[2 * POINTS];

/* A body of no symmetry, in a unit of length; width 3 */
static sd_body_shape lump(double unit)
{
  double x[3 * POINTS], radius[POINTS], *M = calloc(9 * POINTS * POINTS, sizeof(double));
  uint64_t seed = 4;
  for (int k = 0; k < POINTS; k++) {
    for (int d = 0; d < 3; d++) x[3 * k + d] = uniform(&seed, -1.3, 1.3) / unit;
    radius[k] = uniform(&seed, 0.2, 0.4) / unit;
  }
  sd_body_shape s;
  sd_wall_matrix(NULL, POINTS, 3, x, radius, M);
  assert_int_equal(sd_body_shape_of(POINTS, 3, x, radius, M, &s), SD_OK);
  free(M);
  return s;
}

/* Two such bodies, with numbers of points of 3 and of spheres of 6; sphere 2 b + 1 has the first points of body b */
typedef struct {
  sd_body body[2];
  sd_bodies A;
} two_bodies;

static void stand(two_bodies *t, const sd_body_shape *shape, double a, const char *known)
{
  static const int sphere[2 * POINTS] = {[0] = 1, 1, 1, [POINTS] = 3, 3}, body[4] = {0, 0, 1, 1};
  const double turn[2][3] = {{0.3, -0.2, 0.5}, {-0.9, 0.4, 1.1}};
  for (int k = 0; k < 2 * POINTS; k++) rows[k] = k;
  for (int b = 0; b < 2; b++) {
    t->body[b] = (sd_body){.shape = shape, .a = a, .eta = 1.7, .row = rows + POINTS * b};
    sd_rotation(turn[b], t->body[b].R);
  }
  t->A = (sd_bodies){.shaped = 2, .body = t->body, .known = known};
  t->A.spheres = (sd_rigid){4, 6, body, NULL};
  t->A.points = (sd_rigid){2 * POINTS, 3, sphere, NULL};
}

/* Slip [points] and load [24] of two bodies of a shape in this unit of length */
static void own_of(double unit, const char *known, double kT, double *slip, double *load)
{
  sd_body_shape shape = lump(unit);
  sd_body_follow follow;
  two_bodies t;
  assert_int_equal(sd_body_follow_create(&shape, &follow), SD_OK);
  assert_true(follow.exact);
  const sd_body_follow *follows[2] = {&follow, &follow};
  stand(&t, &shape, unit, known);
  const sd_drifter d = {t.body, follows};
  memset(slip, 0, sizeof(double) * 6 * POINTS);
  memset(load, 0, sizeof(double) * 24);
  sd_drifter_add_own(&t.A, &d, kT, slip, load);
  sd_body_follow_free(&follow);
  sd_body_shape_free(&shape);
}

static double largest(int n, const double *v)
{
  double most = 0.0;
  for (int j = 0; j < n; j++) most = fmax(most, fabs(v[j]));
  return most;
}

/* In whatever unit a shape is kept, so that slip has its a^2 */
static void what_bodies_leave_is_theirs_in_any_unit(void **state)
{
  (void) state;
  double slip[2][6 * POINTS], load[2][24];
  own_of(1.0, NULL, 0.3, slip[0], load[0]);
  own_of(2.5, NULL, 0.3, slip[1], load[1]);
  const double of_slip = largest(6 * POINTS, slip[0]);
  assert_true(of_slip > 1e-3);
  for (int j = 0; j < 6 * POINTS; j++) CHECK_NEAR(slip[1][j], slip[0][j], 1e-8 * of_slip);
  for (int j = 0; j < 24; j++) CHECK_NEAR(load[1][j], load[0][j], 1e-12);
}

/* kT/(eta a^2) R s and -kT R t, of the free body alone, on its sphere of the first point */
static void slip_and_torque_turn_with_the_body(void **state)
{
  (void) state;
  const double kT = 0.3, a = 0.8;
  const char known[2] = {SD_BODY_FREE, SD_BODY_SPUN};
  double own[3 * POINTS], slip[6 * POINTS] = {0.0}, load[24] = {0.0}, expected[3];
  uint64_t seed = 9;
  sd_body_shape shape = {.m = POINTS, .width = 3};
  sd_body_follow follow = {.n = 3 * POINTS, .exact = 1, .slip = own, .torque = {0.4, -1.1, 0.7}};
  for (int j = 0; j < 3 * POINTS; j++) own[j] = uniform(&seed, -1, 1);
  const sd_body_follow *follows[2] = {&follow, &follow};
  two_bodies t;
  stand(&t, &shape, a, known);
  const sd_drifter d = {t.body, follows};
  sd_drifter_add_own(&t.A, &d, kT, slip, load);
  for (int k = 0; k < 2 * POINTS; k++) {
    sd_multiply3(t.body[0].R, own + 3 * (k % POINTS), expected);
    for (int p = 0; p < 3; p++)
      CHECK_NEAR(slip[3 * k + p], k < POINTS ? kT / (1.7 * a * a) * expected[p] : 0.0, 1e-15);
  }
  sd_multiply3(t.body[0].R, follow.torque, expected);
  for (int j = 0; j < 24; j++) CHECK_NEAR(load[j], j / 3 == 3 ? -kT * expected[j % 3] : 0.0, 1e-15);
}

/* A lone sphere, a body whose farthest sphere is at 5, one that is smaller than a sphere, and one that is spun; W' W
 * of each motion is g^2 */
static void moves_and_forces_go_together(void **state)
{
  (void) state;
  static const int whole[6] = {0, 1, 1, 2, 2, 3};
  static const double arm[18] = {[3] = 0.2, [6] = 0.0, -3.0, 4.0, [9] = 0.1};
  static const char known[4] = {SD_BODY_FREE, SD_BODY_FREE, SD_BODY_FREE, SD_BODY_SPUN};
  const double smallest = 0.6, s[4] = {0.6, 5.0, 0.6, 0.6};
  const sd_bodies A = {.lone = 1, .shaped = 3, .known = known, .spheres = {6, 6, whole, arm}};
  double g[24], extent[4], moves[24], W[24];
  uint64_t seed = 7;
  for (int j = 0; j < 24; j++) g[j] = uniform(&seed, 0.5, 2);
  for (int dimension = 2; dimension < 4; dimension++) {
    const sd_drifter_random random = {g, smallest, 1, dimension};
    const double e = sd_drifter_moves(&A, &random, extent, moves, W);
    CHECK_NEAR(e, 1e-4 * smallest, 1e-18);
    for (int j = 0; j < 24; j++) {
      const int b = j / 6, d = j % 6, out_of_plane = d == 2 || d == 3 || d == 4;
      const int stays = (d >= 3 && (b == 0 || b == 3)) || (dimension == 2 && out_of_plane);
      CHECK_NEAR(W[j], stays ? 0.0 : g[j] * (d < 3 ? 1.0 : s[b]), 1e-14);
      CHECK_NEAR(moves[j] * W[j], stays ? 0.0 : e * g[j] * g[j], 1e-17);
    }
  }
}

/* The torques of bodies that turn come back when loads are collected; forces and the others' do not. */
static void torques_are_handed_to_one_sphere(void **state)
{
  (void) state;
  static const int whole[5] = {2, 1, 0, 1, 2};
  const sd_bodies A = {.lone = 1, .shaped = 2, .spheres = {5, 6, whole, NULL}};
  double of_bodies[18], before[18], load[30] = {0.0}, f[18];
  for (int j = 0; j < 18; j++) before[j] = of_bodies[j] = 1.5 + j;
  sd_drifter_hand_on(&A, 1, of_bodies, load);
  sd_rigid_collect(&A.spheres, load, 3, f);
  for (int j = 0; j < 18; j++) {
    const int handed = j >= 6 && j % 6 >= 3;
    CHECK_NEAR(f[j], handed ? before[j] : 0.0, 0.0);
    CHECK_NEAR(of_bodies[j], handed ? 0.0 : before[j], 0.0);
  }
  CHECK_NEAR(load[3], before[15], 0.0);
  CHECK_NEAR(load[9], before[9], 0.0);
}

/* A solve has what was drawn and what is left, the slip at points of 3 numbers and loads on spheres of 6. */
static void all_that_is_drawn_is_solved_for(void **state)
{
  (void) state;
  static const int whole[2] = {0, 1}, sphere[3] = {0, 1, 1};
  const sd_bodies A = {.shaped = 2, .spheres = {2, 6, whole, NULL}, .points = {3, 3, sphere, NULL}};
  double slip[9], slip_left[9], load[12], load_left[12], u[10], F[13];
  for (int j = 0; j < 9; j++) slip[j] = 0.5 + j, slip_left[j] = -0.25 * j;
  for (int j = 0; j < 12; j++) load[j] = 7.0 - j, load_left[j] = 0.125 * j;
  for (int j = 0; j < 10; j++) u[j] = 100.0;
  for (int j = 0; j < 13; j++) F[j] = -100.0;
  const sd_drifter_drawn drawn = {slip, load, slip_left, load_left};
  sd_drifter_add(&A, &drawn, u, F);
  for (int j = 0; j < 9; j++) CHECK_NEAR(u[j], 100.5 + 0.75 * j, 0.0);
  for (int j = 0; j < 12; j++) CHECK_NEAR(F[j], -93.0 - 0.875 * j, 0.0);
  CHECK_NEAR(u[9], 100.0, 0.0);
  CHECK_NEAR(F[12], -100.0, 0.0);
}

/* Half a step of 3 % at most off, the same in all units of length, for a body of any size in its own splitting, and
 * whichever of the splittings of these steps comes first: a run that is cut goes on as the whole one */
static void a_root_is_of_a_splitting_over_the_size(void **state)
{
  (void) state;
  double radius[3] = {0.2, 0.7, 0.4}, larger[3] = {0.5, 1.75, 1.0};
  const sd_body_shape shape = {.m = 3, .radius = radius}, in_other_unit = {.m = 3, .radius = larger};
  const double a = 1.9, times = 31.0;
  for (double xi = 0.03; xi < 3.0; xi *= 1.117) {
    const sd_ewald split = {.xi = xi, .band = 6.2 * xi, .range = 3.1 / xi, .a_ref = 0.9};
    sd_ewald scaled = split, alike = split;
    scaled.xi /= times, scaled.a_ref *= times, scaled.range *= times;
    alike.range *= 1.001, alike.band *= 1.001;
    const sd_body_root_steps steps = sd_body_root_steps_of(&shape, a, &split);
    const sd_body_root_steps large = sd_body_root_steps_of(&shape, a * times, &scaled);
    const sd_body_root_steps other = sd_body_root_steps_of(&in_other_unit, a / 2.5, &split);
    assert_true(steps.xi == large.xi && steps.a_ref == large.a_ref);
    assert_true(steps.xi == other.xi && steps.a_ref == other.a_ref);
    const sd_ewald unit = sd_body_root_split(&shape, &steps, &split);
    CHECK_NEAR(log(unit.xi / (split.xi * a)), 0.0, 0.015 * (1.0 + 1e-9));
    CHECK_NEAR(log(unit.a_ref * a / split.a_ref), 0.0, 0.015 * (1.0 + 1e-9));
    CHECK_NEAR(log(unit.xi * unit.range / 3.1), 0.0, 0.015 * (1.0 + 1e-9));
    CHECK_NEAR(unit.band / (2.0 * unit.xi * unit.xi * unit.range), 1.0, 1e-13);
    const sd_body_root_steps near = sd_body_root_steps_of(&shape, a, &alike);
    const sd_ewald same = sd_body_root_split(&shape, &near, &alike);
    assert_true(near.range == steps.range && near.range == large.range && near.range == other.range);
    CHECK_NEAR(same.range / unit.range, 1.0, 1e-14);
    CHECK_NEAR(same.band / unit.band, 1.0, 1e-14);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_bodies_leave_is_theirs_in_any_unit),
      cmocka_unit_test(slip_and_torque_turn_with_the_body),
      cmocka_unit_test(moves_and_forces_go_together),
      cmocka_unit_test(torques_are_handed_to_one_sphere),
      cmocka_unit_test(all_that_is_drawn_is_solved_for),
      cmocka_unit_test(a_root_is_of_a_splitting_over_the_size),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
