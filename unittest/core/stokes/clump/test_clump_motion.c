/* Motion of a clump and flow past it, from its spheres. */
#include "clumps.h"

#include "sd_clump_motion.h"

/* A clump in any pose that moves rigidly in a linear flow; its spheres turn with it. */
typedef struct {
  int n;
  double x[3 * MOST], a[MOST], v[3 * MOST], omega[3 * MOST], u[3 * MOST], gradient[9 * MOST];
  double R[9], c[3], U[3], W[3], u0[3], G[9];
  sd_shape shape;
  sd_clump_motion motion;
} scene;

static void make(scene *s, const char *name, uint64_t *seed)
{
  double X[3 * MOST], Q[9], shift[3];
  *s = (scene){0};
  s->n = table_cluster(name, X, s->a);
  assert_int_equal(sd_shape_create(s->n, X, s->a, &s->shape), SD_OK);
  random_rotation(seed, Q);
  for (int d = 0; d < 3; d++) {
    shift[d] = uniform(seed, -30.0, 30.0);
    s->U[d] = uniform(seed, -1.0, 1.0);
    s->W[d] = uniform(seed, -1.0, 1.0);
    s->u0[d] = uniform(seed, -1.0, 1.0);
  }
  for (int d = 0; d < 9; d++) s->G[d] = uniform(seed, -1.0, 1.0);
  for (int k = 0; k < s->n; k++) {
    double r[3], w[3];
    sd_multiply3(Q, s->shape.x + 3 * k, r);
    sd_cross(s->W, r, w);
    for (int d = 0; d < 3; d++) {
      s->x[3 * k + d] = shift[d] + r[d];
      s->v[3 * k + d] = s->U[d] + w[d];
      s->omega[3 * k + d] = s->W[d];
      s->u[3 * k + d] = s->u0[d] + sd_dot(s->G + 3 * d, r);
    }
    memcpy(s->gradient + 9 * k, s->G, sizeof(s->G));
  }
  s->motion = (sd_clump_motion){s->x, s->v, s->omega, {0.7, -0.4, 0.2}, s->u, s->gradient};
  assert_true(sd_shape_pose(&s->shape, s->x, s->R, s->c) < 1e-13);
}

static void rigid_motion_is_found_exactly(void **state)
{
  (void) state;
  uint64_t seed = 61;
  for (int m = 0; m < N_CLUSTERS; m++)
    for (int trial = 0; trial < 5; trial++) {
      scene s;
      double U[3], W[3];
      make(&s, clusters[m], &seed);
      sd_clump_velocity(&s.shape, &s.motion, s.R, s.c, U, W);
      for (int d = 0; d < 3; d++) {
        CHECK_NEAR(U[d], s.U[d], 1e-13);
        CHECK_NEAR(W[d], s.W[d], 1e-13); /* of lines, from the spheres' own spins as well */
      }
      sd_shape_free(&s.shape);
    }
}

/* Without spins a row of spheres does not show how it turns about itself. */
static void row_without_spins_turns_across_itself_only(void **state)
{
  (void) state;
  uint64_t seed = 67;
  scene s;
  double U[3], W[3], e[3];
  make(&s, "trimer_line", &seed);
  s.motion.omega = NULL;
  sd_clump_velocity(&s.shape, &s.motion, s.R, s.c, U, W);
  for (int d = 0; d < 3; d++) e[d] = s.x[3 + d] - s.x[d];
  const double about = sd_dot(s.W, e) / sd_dot(e, e);
  CHECK_NEAR(sd_dot(W, e), 0.0, 1e-13);
  for (int d = 0; d < 3; d++) CHECK_NEAR(W[d], s.W[d] - about * e[d], 1e-13);
  sd_shape_free(&s.shape);
}

/* The gradient given, or, where it is 0, as far as the centres span it: in space whole; of a sheet and a line what is
   along it. */
static void linear_flow_is_found_exactly(void **state)
{
  (void) state;
  uint64_t seed = 71;
  for (int m = 0; m < N_CLUSTERS; m++)
    for (int given = 0; given < 2; given++) {
      scene s;
      double u[3], G[9];
      make(&s, clusters[m], &seed);
      if (!given) memset(s.gradient, 0, sizeof(s.gradient));
      sd_clump_flow(&s.shape, &s.motion, s.R, s.c, u, G);
      for (int d = 0; d < 3; d++) CHECK_NEAR(u[d], s.u0[d], 1e-12);
      for (int k = 0; k < s.n; k++)
        for (int d = 0; d < 3; d++) {
          const double r[3] = {s.x[3 * k] - s.c[0], s.x[3 * k + 1] - s.c[1], s.x[3 * k + 2] - s.c[2]};
          CHECK_NEAR(u[d] + sd_dot(G + 3 * d, r), s.u[3 * k + d], 1e-12);
        }
      if (given || s.shape.squares[2] > 0.0)
        for (int d = 0; d < 9; d++) CHECK_NEAR(G[d], s.G[d], 1e-12);
      sd_shape_free(&s.shape);
    }
}

/* What is no rigid motion drops out of the fit if it has neither momentum nor angular momentum. */
static void fit_is_the_one_of_least_squares(void **state)
{
  (void) state;
  uint64_t seed = 73;
  for (int m = 2; m < N_CLUSTERS; m++) {
    scene s;
    double U[3], W[3], step[6], best = 0.0;
    make(&s, clusters[m], &seed);
    for (int k = 0; k < 3 * s.n; k++) s.v[k] += uniform(&seed, -0.5, 0.5);
    sd_clump_velocity(&s.shape, &s.motion, s.R, s.c, U, W);
    for (int trial = 0; trial < 30; trial++) {
      double sum = 0.0;
      for (int d = 0; d < 6; d++) step[d] = trial ? uniform(&seed, -1e-2, 1e-2) : 0.0;
      for (int k = 0; k < s.n; k++) {
        const double w[3] = {W[0] + step[3], W[1] + step[4], W[2] + step[5]};
        double r[3], t[3];
        for (int d = 0; d < 3; d++) r[d] = s.x[3 * k + d] - s.c[d];
        sd_cross(w, r, t);
        for (int d = 0; d < 3; d++) {
          const double miss = s.v[3 * k + d] - U[d] - step[d] - t[d];
          sum += miss * miss;
        }
      }
      if (trial == 0) best = sum;
      assert_true(sum >= best);
    }
    sd_shape_free(&s.shape);
  }
}

/* Fluid that moves as the clump does, or not at all about a clump at rest, does nothing; uniform flow is -drag. */
static void drag_is_that_of_the_slip(void **state)
{
  (void) state;
  uint64_t seed = 79;
  scene s;
  double F[3 * MOST], T[3 * MOST], total[3] = {0}, R[9];
  make(&s, "helix4_chiral", &seed);
  double pose[12];
  memcpy(pose, s.R, sizeof(s.R));
  memcpy(pose + 9, s.c, sizeof(s.c));
  sd_clump clump = solve_cluster("helix4_chiral", 12, 0);
  memcpy(s.u, s.v, sizeof(s.u));
  memset(s.gradient, 0, sizeof(s.gradient));
  const sd_clump_placed placed = {&s.shape, &clump, pose, 1.7};
  const sd_clump_rows out = {3, NULL, F, T};
  sd_clump_drag(&placed, &s.motion, &out);
  for (int k = 0; k < 3 * s.n; k++) CHECK_NEAR(F[k], 0.0, 1e-11);
  s.motion.u = NULL;
  for (int k = 0; k < s.n; k++) memcpy(s.v + 3 * k, (double[3]){0.3, 0.5, -0.1}, sizeof(double) * 3);
  sd_clump_drag(&placed, &s.motion, &out);
  for (int k = 0; k < 3 * s.n; k++) total[k % 3] += F[k];
  for (int p = 0; p < 9; p++) R[p] = clump.R[6 * (p / 3) + p % 3];
  double slip[3], body[3], lab[3], expected[3];
  for (int d = 0; d < 3; d++) slip[d] = s.motion.u_uniform[d] - s.v[d];
  sd_multiply3t(s.R, slip, body);
  sd_multiply3(R, body, lab);
  sd_multiply3(s.R, lab, expected);
  for (int d = 0; d < 3; d++) CHECK_NEAR(total[d], 1.7 * expected[d], 1e-10);
  sd_clump_free(&clump);
  sd_shape_free(&s.shape);
}

/* Without inertia the fluid takes up what acts on the clump, and a held one moves as it is told. */
static void the_fluid_balances_what_acts_on_a_clump(void **state)
{
  (void) state;
  uint64_t seed = 83;
  for (int m = 0; m < N_CLUSTERS; m++) {
    scene s;
    sd_clump clump = solve_cluster(clusters[m], 1, 1);
    double on[6 * MOST], rows[12 * MOST], V[6], pose[12];
    double sum[6] = {0.0}, load[6] = {0.0}, about_first[6] = {0.0}, arm[3], told[6] = {0.4, -0.2, 0.7, 0.1, 0.9, -0.5};
    make(&s, clusters[m], &seed);
    memcpy(pose, s.R, sizeof(s.R));
    memcpy(pose + 9, s.c, sizeof(s.c));
    for (int k = 0; k < s.n; k++) {
      for (int d = 0; d < 6; d++) on[6 * k + d] = uniform(&seed, -1.0, 1.0);
      sd_minus(s.x + 3 * k, s.x, arm);
      sd_clump_add_load(arm, on + 6 * k, about_first);
    }
    sd_minus(s.x, s.c, arm);
    sd_clump_add_load(arm, about_first, load);
    const sd_clump_placed placed = {&s.shape, &clump, pose, 1.7};
    const sd_clump_rows out = {12, rows, rows + 6, rows + 9};
    sd_clump_move_alone(&placed, &s.motion, load, V, &out);
    for (int k = 0; k < s.n; k++) {
      const double *v = rows + 12 * k, *F = v + 6, *T = v + 9;
      double left[3], couple[3], turning[3];
      sd_minus(s.x + 3 * k, s.c, arm);
      for (int d = 0; d < 3; d++) left[d] = F[d] + on[6 * k + d];
      sd_cross(arm, left, couple);
      sd_cross(V + 3, arm, turning);
      for (int d = 0; d < 3; d++) {
        sum[d] += left[d];
        sum[3 + d] += couple[d] + T[d] + on[6 * k + 3 + d];
        CHECK_NEAR(v[d], V[d] + turning[d], 1e-12);
        CHECK_NEAR(v[3 + d], V[3 + d], 0.0);
      }
    }
    for (int d = 0; d < 6; d++) CHECK_NEAR(sum[d], 0.0, 1e-9);
    memcpy(V, told, sizeof(V));
    sd_clump_move_alone(&placed, &s.motion, NULL, V, &out);
    for (int d = 0; d < 6; d++) CHECK_NEAR(V[d], told[d], 0.0);
    sd_clump_free(&clump);
    sd_shape_free(&s.shape);
  }
}

/* What the fluid does to a sphere that moves freely under a load it does to one that is made to move so. */
static void a_sphere_that_is_held_bears_what_moves_a_free_one(void **state)
{
  (void) state;
  const double D[6] = {2.3, 2.3, 2.3, 0.7, 0.7, 0.7}, u[6] = {0.4, -0.1, 0.9, 1.3, -0.2, 0.3},
               load[6] = {1.1, 0.6, -0.5, 0.2, -0.8, 0.9};
  for (int width = 3; width <= 6; width += 3) {
    double V[6], F[6], held[6];
    sd_sphere_move_alone(width, D, u, load, V, F);
    for (int d = 0; d < width; d++) CHECK_NEAR(D[d] * (V[d] - u[d]), load[d], 1e-15);
    sd_sphere_move_alone(width, D, u, NULL, V, held);
    for (int d = 0; d < width; d++) {
      assert_true(F[d] == -load[d]);
      CHECK_NEAR(held[d], F[d], 1e-15);
    }
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rigid_motion_is_found_exactly),
      cmocka_unit_test(row_without_spins_turns_across_itself_only),
      cmocka_unit_test(linear_flow_is_found_exactly),
      cmocka_unit_test(fit_is_the_one_of_least_squares),
      cmocka_unit_test(drag_is_that_of_the_slip),
      cmocka_unit_test(a_sphere_that_is_held_bears_what_moves_a_free_one),
      cmocka_unit_test(the_fluid_balances_what_acts_on_a_clump),
  };
  return cmocka_run_group_tests(tests, NULL, free_shells);
}
