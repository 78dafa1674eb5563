/* Steps of sd_pose.h: closed forms, and orders against converged paths (data/motion). */
#include "flock.h"

#include "table.h"

#include "sd_clump_motion.h"

static const double P6 = 6.0 * SD_PI;
static const double doublet[6] = {0, 0, -1, 0, 0, 1};
static const double chain5[15] = {0, 0, -4, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 0, 4};
static const double ones[5] = {1, 1, 1, 1, 1};

/* A step of dt with (U, W) = V of the centroid */
static void advance_pose(double pose[12], const double V[6], double dt, int n, const double *X, double turn[9],
                         double *x)
{
  static const double centroid[3] = {0.0};
  double step[6];
  for (int k = 0; k < 6; k++) step[k] = dt * V[k];
  sd_pose_step(pose, centroid, step, n, X, turn, x);
}

static void rotations_are_rotations(void **state)
{
  (void) state;
  uint64_t seed = 3;
  for (double size = 1e-12; size < 20.0; size *= 7.0) {
    double w[3], R[9], back[9], minus[3];
    for (int d = 0; d < 3; d++) {
      w[d] = size * uniform(&seed, -1, 1);
      minus[d] = -w[d];
    }
    sd_rotation(w, R);
    sd_rotation(minus, back);
    const double angle = sqrt(sd_dot(w, w));
    CHECK_NEAR(R[0] + R[4] + R[8], 1.0 + 2.0 * cos(angle), 1e-14);
    for (int p = 0; p < 3; p++) {
      CHECK_NEAR(sd_dot(R + 3 * p, w), w[p], 1e-15 * angle);
      for (int q = 0; q < 3; q++) {
        CHECK_NEAR(sd_dot(R + 3 * p, R + 3 * q), p == q, 4e-16);
        CHECK_NEAR(back[3 * p + q], R[3 * q + p], 1e-16);
      }
    }
    /* R - R^T = 2 sin |w| [w/|w|]x, right-handed */
    CHECK_NEAR(R[3] - R[1], 2.0 * sin(angle) * w[2] / angle, 1e-15);
  }
}

/* A body that turns steadily is exact whatever the step, and keeps its shape. */
static void steady_turn_is_exact(void **state)
{
  (void) state;
  double pose[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, x[15], turn[9], R[9];
  const double V[6] = {0.3, -0.2, 0.1, 0.5, 0.7, -0.4}, w[3] = {5.0, 7.0, -4.0};
  for (int k = 0; k < 10; k++) advance_pose(pose, V, 1.0, 5, chain5, turn, x);
  sd_rotation(w, R);
  for (int d = 0; d < 9; d++) CHECK_NEAR(pose[d], R[d], 1e-14);
  for (int k = 0; k < 5; k++)
    for (int d = 0; d < 3; d++)
      CHECK_NEAR(x[3 * k + d], 10.0 * V[d] + R[3 * d + 2] * chain5[3 * k + 2], 1e-13);
}

/* The velocity at a point of a body is what a short step moves it by, to the square of the step. */
static void points_move_with_their_body(void **state)
{
  (void) state;
  const double dt = 1e-5, start[12] = {0.6, 0, 0.8, 0, 1, 0, -0.8, 0, 0.6, 3, -4, 5};
  const double V[6] = {0.3, -1.1, 0.7, 2.0, 0.5, -1.4}, X[3] = {1.7, -0.4, 2.2};
  double pose[12], turn[9], x[3], arm[3], there[6];
  memcpy(pose, start, sizeof(pose));
  advance_pose(pose, V, dt, 1, X, turn, x);
  sd_multiply3(start, X, arm);
  memcpy(there, V, sizeof(there));
  sd_clump_shift_velocity(arm, there);
  for (int d = 0; d < 3; d++) {
    CHECK_NEAR((x[d] - start[9 + d] - arm[d]) / dt, there[d], 20.0 * dt);
    CHECK_NEAR(there[3 + d], V[3 + d], 0.0);
  }
}

/* A direction that turns by a million small rotations is where one large one takes it, and is as long. */
static void directions_keep_their_length(void **state)
{
  (void) state;
  const double w[3] = {1e-3, -2e-3, 0.5e-3}, length = 1.7e-19;
  const double all[3] = {1e3, -2e3, 0.5e3};
  double R[9], v[3] = {0.6 * length, 0.0, 0.8 * length}, start[3], expected[3];
  double nothing[3] = {0.0, 0.0, 0.0};
  memcpy(start, v, sizeof(start));
  sd_rotation(w, R);
  for (int k = 0; k < 1000000; k++) {
    sd_turn_direction(R, length, v);
    sd_turn_direction(R, length, nothing);
  }
  CHECK_NEAR(sqrt(sd_dot(v, v)) / length, 1.0, 4e-16);
  CHECK_NEAR(sd_dot(nothing, nothing), 0.0, 0.0);
  sd_rotation(all, R);
  sd_multiply3(R, start, expected);
  for (int d = 0; d < 3; d++) CHECK_NEAR(v[d] / length, expected[d] / length, 1e-9);
}

/* By a vector as by its matrix, of any length, on both sides of where series end. */
static void directions_turn_by_vectors_as_by_matrices(void **state)
{
  (void) state;
  uint64_t seed = 6;
  for (double size = 1e-9; size < 10.0; size *= 1.3) {
    double w[3], R[9], v[3], u[3];
    for (int d = 0; d < 3; d++) {
      w[d] = size * uniform(&seed, -1, 1);
      u[d] = v[d] = uniform(&seed, -1, 1);
    }
    const double length = sqrt(sd_dot(v, v));
    sd_rotation(w, R);
    sd_turn_direction(R, length, v);
    sd_turn_direction_by(w, length, u);
    for (int d = 0; d < 3; d++) CHECK_NEAR(u[d], v[d], 1e-15);
  }
}

/* A quaternion that turns is that of the product of the rotations, by any angle about any axis, has length 1
 * to rounding, and turns its body axes as the matrices do; none stays none. */
static void quaternions_turn_as_matrices_do(void **state)
{
  (void) state;
  const double axes[4][3] = {{0.6, 0.0, 0.8}, {-0.36, 0.48, -0.8}, {0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}};
  const double angles[6] = {1e-9, 0.3, 2.0, 3.1415926, SD_PI, 5.5};
  double q[4] = {1.0, 0.0, 0.0, 0.0}, none[4] = {0.0}, all[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (int k = 0; k < 24; k++) {
    double w[3], R[9], before[9], seen[9];
    for (int d = 0; d < 3; d++) w[d] = angles[k % 6] * axes[k / 6][d];
    sd_rotation(w, R);
    memcpy(before, all, sizeof(all));
    sd_product3(R, before, all);
    sd_turn_quaternion(R, q);
    sd_turn_quaternion(R, none);
    sd_quaternion_rotation(q, seen);
    for (int d = 0; d < 9; d++) CHECK_NEAR(seen[d], all[d], 2e-14);
    CHECK_NEAR(q[0] * q[0] + sd_dot(q + 1, q + 1), 1.0, 1e-15);
    CHECK_NEAR(none[0] * none[0] + sd_dot(none + 1, none + 1), 0.0, 0.0);
  }
}

/* Adams and Bashforth's step is exact for velocities linear in time, with steps that change; noise is added to it. */
static void changing_steps_stay_second_order(void **state)
{
  (void) state;
  const double y = -0.7, noise = 0.3;
  double x = 0.0, noisy = 0.0, t = 0.0, before = 0.1, v, v_old = 2.0 - 3.0 * before;
  const double steps[4] = {0.1, 0.2, 0.05, 0.4};
  for (int k = 0; k < 4; k++) {
    const sd_step step = {steps[k], steps[k] / (2.0 * before), noise};
    double move;
    v = 2.0 + 3.0 * t;
    sd_step_move(&step, 1, &v, &v_old, NULL, &move);
    x += move;
    sd_step_move(&step, 1, &v, &v_old, &y, &move);
    noisy += move;
    t += steps[k];
    v_old = v;
    before = steps[k];
    CHECK_NEAR(x, 2.0 * t + 1.5 * t * t, 1e-14);
    CHECK_NEAR(noisy, x + (k + 1) * noise * y, 1e-14);
  }
}

static void next_step_follows_the_fastest(void **state)
{
  (void) state;
  CHECK_NEAR(sd_next_step(0.1, 2.0, 1e-3, 1.0, 0.3), 0.15, 1e-16);
  CHECK_NEAR(sd_next_step(0.1, 1.0, 1e-3, 1.0, 0.3), 0.2, 1e-16);
  CHECK_NEAR(sd_next_step(0.1, 1e9, 1e-3, 1.0, 0.3), 1e-3, 1e-16);
  CHECK_NEAR(sd_next_step(0.9, 0.0, 1e-3, 1.0, 0.3), 1.0, 1e-16);
  CHECK_NEAR(sd_next_step(5.0, 0.0, 1e-3, 1.0, 0.3), 1.0, 1e-16);
}

/* In which step it is said that steps are too long, of a figure that begins with `first`, is multiplied
 * by `factor` in every step and never above `most`; 0: in none of n */
static int said_in(double first, double factor, double most, int n)
{
  sd_growth state = {0};
  double error = first;
  for (int k = 1; k <= n; k++, error = fmin(factor * error, most))
    if (sd_grows(&state, error)) return k;
  return 0;
}

static void growth_is_seen_whatever_its_factor(void **state)
{
  (void) state;
  assert_int_equal(said_in(0.003, 10.0, 1e300, 99), 4);    // 3 in the fourth: before an atom is lost
  assert_int_equal(said_in(0.03, 2.1, 1e300, 99), 4);
  const int slow = said_in(1e-6, 1.2, 1e300, 999);    // when it passes a tenth
  assert_true(slow > log(0.1 / 1e-6) / log(1.2) && slow < 2 + log(0.1 / 1e-6) / log(1.2) + 1);
  assert_int_equal(said_in(0.15, 1.0, 0.15, 99), 20);
}

static void a_jump_and_small_changes_are_no_growth(void **state)
{
  (void) state;
  sd_growth growth = {0};
  for (int k = 0; k < 99; k++) assert_false(sd_grows(&growth, k % 10 ? 0.01 : 5.0));
  growth = (sd_growth){0};
  assert_false(sd_grows(&growth, 0.0));
  for (int k = 1; k < 10; k++) assert_false(sd_grows(&growth, 0.1 + 0.01 * k));
  assert_int_equal(said_in(1e-9, 1.5, 0.09, 999), 0);
  assert_int_equal(said_in(0.5, 0.8, 1.0, 999), 0);
}

/* n steps of a flock under its forces to time t; first step Euler */
static void fall(flock *f, int width, double t, int n, int ab2)
{
  const int bodies = f->clumps + f->free;
  const double dt = t / n;
  double old[6 * FLOCK_MOST];
  for (int k = 0; k < n; k++) {
    double V[6 * FLOCK_MOST] = {0};
    assert_int_equal(flock_move(f, width, 0, 1e-11, 100), SD_OK);
    memcpy(V, f->V, sizeof(double) * 6 * (size_t) f->clumps);
    for (int e = 0; e < f->free; e++)
      memcpy(V + 6 * (f->clumps + e), f->v + width * f->loner[e], sizeof(double) * (size_t) width);
    const sd_step step = {dt, ab2 ? 0.5 : 0.0, 0.0};
    double moves[6 * FLOCK_MOST];
    sd_step_move(&step, 6 * bodies, V, k ? old : V, NULL, moves);
    memcpy(old, V, sizeof(old));
    for (int b = 0; b < bodies; b++) {
      double turn[9], x[3 * 8];
      const int m = b < f->clumps ? f->m : 0;
      advance_pose(f->pose + 12 * b, moves + 6 * b, 1.0, m, f->shape.x, turn, x);
    }
  }
}

/* centre and R of body (from 1) at time t */
static void path(const char *name, const char *level, const char *t, int body, double pose[12])
{
  table rows = table_open("motion/trajectories.csv");
  while (table_next(&rows)) {
    if (strcmp(rows.column[0], name) || strcmp(rows.column[1], level) ||
        strcmp(rows.column[2], t) || (int) table_number(&rows, 3) != body)
      continue;
    double q[4], w[3];
    for (int d = 0; d < 3; d++) pose[9 + d] = table_number(&rows, 4 + d);
    for (int d = 0; d < 4; d++) q[d] = table_number(&rows, 7 + d);
    const double s = sqrt(sd_dot(q + 1, q + 1)), angle = 2.0 * atan2(s, q[0]);
    for (int d = 0; d < 3; d++) w[d] = s > 0.0 ? angle * q[1 + d] / s : 0.0;
    sd_rotation(w, pose);
    fclose(rows.file);
    return;
  }
  fail_msg("no %s %s %s %d", name, level, t, body);
}

/* Largest error of the centres, and of the orientation of the clumps */
static void errors(const flock *f, const char *name, const char *level, const char *t,
                   double error[2])
{
  error[0] = error[1] = 0.0;
  for (int b = 0; b < f->clumps + f->free; b++) {
    double pose[12];
    path(name, level, t, b + 1, pose);
    for (int d = 0; d < 12; d++)
      if (d >= 9 || b < f->clumps)
        error[d < 9] = fmax(error[d < 9], fabs(f->pose[12 * b + d] - pose[d]));
  }
}

static void spheres_fall_along_the_known_path(void **state)
{
  (void) state;
  for (int width = 3; width <= 6; width += 3)
    for (int ab2 = 0; ab2 < 2; ab2++) {
      double error[3][2];
      for (int k = 0; k < 3; k++) {
        flock *f = flock_create(0, NULL, NULL, 1, 0, 3, 1.0);
        for (int i = 0; i < 3; i++) {
          f->pose[12 * i + 9] = i == 0 ? -5.0 : i == 1 ? 0.0 : 7.0;
          f->F[width * i + 2] = -P6;
        }
        fall(f, width, 40.0, 40 << k, ab2);
        errors(f, "three_horizontal", width == 3 ? "TT" : "FT", "40", error[k]);
        flock_free(f);
      }
      CHECK_NEAR(log2(error[1][0] / error[2][0]), ab2 ? 2.0 : 1.0, ab2 ? 0.1 : 0.05);
      assert_true(error[2][0] < (ab2 ? 3e-4 : 4e-2));
    }
}

/* Doublet and sphere: centres and orientation. */
static void clumps_fall_along_the_known_path(void **state)
{
  (void) state;
  for (int ab2 = 0; ab2 < 2; ab2++) {
    double error[3][2];
    for (int k = 0; k < 3; k++) {
      flock *f = flock_create(2, doublet, ones, 1, 1, 1, 1.0);
      const double w[3] = {0.8, 0.0, 0.0}, c[3] = {3.0, 0.5, 1.0};
      sd_rotation(w, f->pose);
      memcpy(f->pose + 12 + 9, c, sizeof(c));
      flock_weigh(f, P6);
      fall(f, 6, 40.0, 100 << k, ab2);
      errors(f, "doublet_and_sphere", "FT", "40", error[k]);
      flock_free(f);
    }
    for (int e = 0; e < 2; e++) {
      CHECK_NEAR(log2(error[1][e] / error[2][e]), ab2 ? 2.0 : 1.0, ab2 ? 0.1 : 0.05);
    }
    if (ab2) assert_true(error[2][0] < 2e-4 && error[2][1] < 2e-5);
  }
}

/* Three chains of five: order of centres and of orientation by the differences of three runs */
static void three_chains_have_order_two(void **state)
{
  (void) state;
  double pose[4][36];
  for (int k = 0; k < 4; k++) {
    flock *f = flock_create(5, chain5, ones, 1, 3, 0, 1.0);
    const double axis[3][3] = {{1, 0, 0}, {0, 1, 0}, {sqrt(0.5), sqrt(0.5), 0}};
    for (int b = 0; b < 3; b++) {
      const double angle = 0.4 * (1.0 + 0.5 * b), place = 2.0 * SD_PI * b / 3.0;
      const double w[3] = {angle * axis[b][0], angle * axis[b][1], 0.0};
      sd_rotation(w, f->pose + 12 * b);
      f->pose[12 * b + 9] = 8.0 / sqrt(3.0) * cos(place);
      f->pose[12 * b + 10] = 8.0 / sqrt(3.0) * sin(place);
    }
    flock_weigh(f, P6);
    fall(f, 6, 20.0, 50 << k, 1);
    memcpy(pose[k], f->pose, sizeof(pose[0]));
    flock_free(f);
  }
  double change[3][2] = {{0}};
  for (int k = 0; k < 3; k++)
    for (int j = 0; j < 36; j++)
      change[k][j % 12 < 9] = fmax(change[k][j % 12 < 9], fabs(pose[k + 1][j] - pose[k][j]));
  for (int e = 0; e < 2; e++) CHECK_NEAR(log2(change[1][e] / change[2][e]), 2.0, 0.05);
}

/* 1e5 steps of tumbling: spheres are where the pose says, so the shape is that of the start. */
static void shapes_stay_rigid(void **state)
{
  (void) state;
  double pose[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, x[15], turn[9];
  for (int k = 0; k < 100000; k++) {
    const double V[6] = {sin(0.1 * k), cos(0.03 * k), 0.1, cos(0.2 * k), 1.0, sin(0.05 * k)};
    advance_pose(pose, V, 0.01, 5, chain5, turn, x);
  }
  for (int i = 0; i < 5; i++)
    for (int j = 0; j < i; j++) {
      double sq = 0.0;
      for (int d = 0; d < 3; d++) sq += pow(x[3 * i + d] - x[3 * j + d], 2);
      CHECK_NEAR(sqrt(sq), 2.0 * (i - j), 1e-11);
    }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rotations_are_rotations),
      cmocka_unit_test(steady_turn_is_exact),
      cmocka_unit_test(points_move_with_their_body),
      cmocka_unit_test(directions_keep_their_length),
      cmocka_unit_test(directions_turn_by_vectors_as_by_matrices),
      cmocka_unit_test(quaternions_turn_as_matrices_do),
      cmocka_unit_test(changing_steps_stay_second_order),
      cmocka_unit_test(next_step_follows_the_fastest),
      cmocka_unit_test(growth_is_seen_whatever_its_factor),
      cmocka_unit_test(a_jump_and_small_changes_are_no_growth),
      cmocka_unit_test(spheres_fall_along_the_known_path),
      cmocka_unit_test(clumps_fall_along_the_known_path),
      cmocka_unit_test(three_chains_have_order_two),
      cmocka_unit_test(shapes_stay_rigid),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
