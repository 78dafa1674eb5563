/* Velocities from forces: sd_bodies.h against dense solutions, against limits that are known, and
 * the number of products that it takes. */
#include "flock.h"

#include "sd_free_spheres.h"
#include "sd_tensor.h"

static const double P6 = 6.0 * SD_PI;
static const double chain5[15] = {0, 0, -4, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 0, 4};
static const double ones[8] = {1, 1, 1, 1, 1, 1, 1, 1};
#define T 0.70710678118654752440
static const double tetrahedron[12] = {T, T, T, T, -T, -T, -T, T, -T, -T, -T, T};

/* M' = D^-1 + Omega + K dN K^T in full, and K [6n][6 clumps] */
static void dense(const flock *f, double *M, double *K)
{
  const int N = 6 * f->n, C = 6 * f->clumps;
  for (int i = 0; i < f->n; i++)
    for (int j = 0; j < f->n; j++) {
      const double *x = f->x + 3 * i, *y = f->x + 3 * j;
      const double r[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
      double block[36];
      sd_tensor_grand(r, f->a[i], f->a[j], f->eta, block);
      for (int p = 0; p < 6; p++)
        for (int q = 0; q < 6; q++) M[(6 * i + p) * N + 6 * j + q] = block[6 * p + q];
    }
  memset(K, 0, sizeof(double) * (size_t) (N * C));
  for (int i = 0; i < f->m * f->clumps; i++) {
    const int b = i / f->m;
    const double *c = f->pose + 12 * b + 9, *x = f->x + 3 * i;
    const double r[3] = {x[0] - c[0], x[1] - c[1], x[2] - c[2]};
    const double cross[9] = {0, r[2], -r[1], -r[2], 0, r[0], r[1], -r[0], 0};
    for (int p = 0; p < 6; p++) K[(6 * i + p) * C + 6 * b + p] = 1.0;
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++) K[(6 * i + p) * C + 6 * b + 3 + q] = cross[3 * p + q];
  }
  for (int b = 0; b < f->clumps; b++) {
    const double *R = f->pose + 12 * b;
    double dN[36];
    for (int p = 0; p < 6; p++)
      for (int q = 0; q < 6; q++) {
        double sum = 0.0;
        for (int e = 0; e < 3; e++)
          for (int g = 0; g < 3; g++)
            sum += R[3 * (p % 3) + e] * R[3 * (q % 3) + g] *
                f->body.shell[6 * (3 * (p / 3) + e) + 3 * (q / 3) + g];
        dN[6 * p + q] = sum / f->eta;
      }
    for (int i = 6 * f->m * b; i < 6 * f->m * (b + 1); i++)
      for (int j = 6 * f->m * b; j < 6 * f->m * (b + 1); j++)
        for (int p = 0; p < 6; p++)
          for (int q = 0; q < 6; q++)
            M[i * N + j] += K[i * C + 6 * b + p] * dN[6 * p + q] * K[j * C + 6 * b + q];
  }
}

/* V of clumps alone by (K^T M'^-1 K) V = F + K^T M'^-1 u */
static void dense_velocities(const flock *f, double *V)
{
  const int N = 6 * f->n, C = 6 * f->clumps;
  double *M = malloc(sizeof(double) * (size_t) (N * N)),
         *K = malloc(sizeof(double) * (size_t) (N * C));
  double *B = malloc(sizeof(double) * (size_t) (N * (C + 1))),
         *H = calloc((size_t) (C * C), sizeof(double));
  dense(f, M, K);
  for (int j = 0; j < N; j++) {
    for (int c = 0; c < C; c++) B[c * N + j] = K[j * C + c];
    B[C * N + j] = f->u[j];
  }
  assert_int_equal(sd_cholesky_solve(N, M, C + 1, B), SD_OK);
  for (int p = 0; p < C; p++) {
    V[p] = 0.0;
    for (int j = 0; j < N; j++) {
      V[p] += K[j * C + p] * (f->F[j] + B[C * N + j]);
      for (int q = 0; q < C; q++) H[p * C + q] += K[j * C + p] * B[q * N + j];
    }
  }
  assert_int_equal(sd_cholesky_solve(C, H, 1, V), SD_OK);
  free(M), free(K), free(B), free(H);
}

static void shear(flock *f, double rate)
{
  for (int i = 0; i < f->n; i++) {
    memset(f->u + 6 * i, 0, 6 * sizeof(double));
    f->u[6 * i] = rate * f->x[3 * i + 1];
    f->u[6 * i + 5] = -0.5 * rate;
  }
}

/* Without clumps V = u + M F, and that is one product. */
static void free_spheres_take_one_product(void **state)
{
  (void) state;
  for (int width = 3; width <= 6; width += 3) {
    flock *f = flock_create(0, NULL, NULL, 1, 0, 40, 1.7);
    flock_scatter(f, 0.2, 11);
    uint64_t seed = 5;
    for (int j = 0; j < width * f->n; j++) {
      f->F[j] = uniform(&seed, -1, 1);
      f->u[j] = uniform(&seed, -1, 1);
    }
    assert_int_equal(flock_move(f, width, 0, 1e-3, 50), SD_OK);
    assert_int_equal(f->report.products, 1);
    double Omega[6 * FLOCK_MOST];
    flock_apply(f, f->F, Omega);
    for (int j = 0; j < width * f->n; j++) {
      const double drag = (j % width < 3 ? f->drag : f->spin)[j / width];
      CHECK_NEAR(f->v[j], f->u[j] + Omega[j] + f->F[j] / drag, 1e-14);
      assert_true(f->l[j] == f->F[j]);
    }
    flock_free(f);
  }
}

/* Sums over two ranks, of which the other has a body of a shape; each counts them. */
static sd_status with_another(void *ctx, double *values, int count)
{
  (void) count;
  ++*(int *) ctx;
  values[0] += 1.0;
  return SD_OK;
}

static void ranks_that_know_of_no_shapes_do_not_ask(void **state)
{
  (void) state;
  int asked = 0, only = -1;
  sd_bodies A = {.lone = 1, .world = {.ctx = &asked, .sum = with_another}};
  assert_int_equal(sd_free_spheres_only(&A, &only), SD_OK);
  assert_int_equal(asked, 1);
  assert_int_equal(only, 0);
  A.none_shaped = 1;
  assert_int_equal(sd_free_spheres_only(&A, &only), SD_OK);
  assert_int_equal(asked, 1);
  assert_int_equal(only, 1);
}

/* A lone clump has the mobility of its shells, in whatever pose; and as spheres, their own. */
static void a_lone_clump_has_its_own_mobility(void **state)
{
  (void) state;
  for (int shell = 1; shell <= 42; shell += 41) {
    flock *f = flock_create(5, chain5, ones, shell, 1, 0, 0.6);
    flock_scatter(f, 0.1, 3);
    uint64_t seed = 5;
    double sum[6] = {0}, N[36], expected[6], R6[36];
    flock_place(f, 6);
    for (int i = 0; i < f->n; i++) {
      double couple[3], r[3];
      for (int d = 0; d < 6; d++) f->F[6 * i + d] = uniform(&seed, -1, 1);
      for (int d = 0; d < 3; d++) r[d] = f->x[3 * i + d] - f->pose[9 + d];
      sd_cross(r, f->F + 6 * i, couple);
      for (int d = 0; d < 6; d++) sum[d] += f->F[6 * i + d] + (d < 3 ? 0.0 : couple[d - 3]);
    }
    if (shell == 1) {
      sd_clump_options o = SD_CLUMP_OPTIONS;
      o.rotation = 1;
      assert_int_equal(sd_clump_create(&f->shape, &o, NULL, &f->shells, NULL), SD_OK);
    }
    memcpy(R6, f->shells.R, sizeof(R6));
    sd_pseudo_inverse6(R6, N);
    double body[6], out[6] = {0};
    sd_multiply3t(f->pose, sum, body);
    sd_multiply3t(f->pose, sum + 3, body + 3);
    for (int p = 0; p < 6; p++)
      for (int q = 0; q < 6; q++) out[p] += N[6 * p + q] * body[q] / f->eta;
    sd_multiply3(f->pose, out, expected);
    sd_multiply3(f->pose, out + 3, expected + 3);
    assert_int_equal(flock_move(f, 6, 0, 1e-3, 50), SD_OK);
    assert_int_equal(f->report.products, 1);
    for (int d = 0; d < 6; d++) CHECK_NEAR(f->V[d], expected[d], 1e-13);
    flock_free(f);
  }
}

/* Against the dense solution, with and without shells, weights, random loads, in shear. */
static void clumps_move_as_the_dense_solution_says(void **state)
{
  (void) state;
  const int clumps[3] = {2, 10, 50};
  for (int shell = 1; shell <= 42; shell += 41)
    for (int e = 0; e < 3; e++) {
      flock *f = flock_create(4, tetrahedron, ones, shell, clumps[e], 0, 1.3);
      flock_scatter(f, 0.1, 17 + e);
      flock_weigh(f, P6);
      uint64_t seed = 7;
      for (int j = 0; e != 1 && j < 6 * f->n; j++) f->F[j] += uniform(&seed, -10, 10);
      flock_place(f, 6);
      shear(f, 0.2);
      assert_int_equal(flock_move(f, 6, 0, 1e-10, 100), SD_OK);
      double V[6 * FLOCK_MOST];
      dense_velocities(f, V);
      assert_true(flock_distance(f->V, V, 6 * f->clumps) < 1e-8);
      flock_free(f);
    }
}

/* Bodies and free spheres at once: the residual of the system, from its definition */
static void spheres_and_clumps_solve_the_system(void **state)
{
  (void) state;
  flock *f = flock_create(5, chain5, ones, 12, 6, 20, 0.9);
  f->a_free = 1.0;
  flock_scatter(f, 0.15, 4);
  flock_weigh(f, P6);
  flock_place(f, 6);
  shear(f, 0.1);
  assert_int_equal(flock_move(f, 6, 0, 1e-11, 100), SD_OK);
  const int N = 6 * f->n, C = 6 * f->clumps;
  double *M = malloc(sizeof(double) * (size_t) (N * N)),
         *K = malloc(sizeof(double) * (size_t) (N * C)), f_body[6 * 6] = {0};
  dense(f, M, K);
  for (int i = 0; i < N; i++) {
    double Ml = 0.0, KV = i < 6 * f->m * f->clumps ? 0.0 : f->v[i];
    for (int j = 0; j < N; j++) Ml += M[i * N + j] * f->l[j];
    for (int c = 0; c < C; c++) {
      KV += K[i * C + c] * f->V[c];
      f_body[c] += K[i * C + c] * (f->l[i] - f->F[i]);
    }
    CHECK_NEAR(Ml - KV, -f->u[i], 1e-9);
    CHECK_NEAR(KV, f->v[i], 1e-13);
  }
  for (int c = 0; c < C; c++) CHECK_NEAR(f_body[c], 0.0, 1e-10);
  free(M), free(K);
  flock_free(f);
}

/* Products of a prototype in Python for weights to 1e-3 and 1e-6 (in clouds of its own, hence one more
 * allowed), and how good V is then. */
static void products_are_few(void **state)
{
  (void) state;
  static const struct {
    int chain, clumps;
    double phi;
    int most[2];
    double error;
  } rows[] = {{1, 2, 0.1, {4, 8}, 1e-4},   {1, 10, 0.02, {3, 6}, 1e-4}, {1, 10, 0.1, {5, 9}, 1e-4},
              {1, 10, 0.2, {5, 10}, 1e-4}, {1, 50, 0.1, {6, 11}, 1e-4}, {0, 10, 0.2, {5, 9}, 1e-4},
              {0, 50, 0.2, {6, 10}, 1e-4}};
  for (size_t e = 0; e < sizeof(rows) / sizeof(rows[0]); e++)
    for (int shell = 1; shell <= 42; shell += 41) {
      const int m = rows[e].chain ? 5 : 4;
      flock *f = flock_create(m, rows[e].chain ? chain5 : tetrahedron, ones, shell, rows[e].clumps,
                              0, 1.0);
      flock_scatter(f, rows[e].phi, 1);
      flock_weigh(f, P6);
      assert_int_equal(flock_move(f, 6, 0, 1e-12, 100), SD_OK);
      double V[6 * FLOCK_MOST];
      memcpy(V, f->V, sizeof(V));
      for (int t = 0; t < 2; t++) {
        assert_int_equal(flock_move(f, 6, 0, t ? 1e-6 : 1e-3, 100), SD_OK);
        const double error = flock_distance(f->V, V, 6 * f->clumps);
        assert_in_range(f->report.products, 2, rows[e].most[t] + 1);
        assert_true(error < (t ? 1e-3 : 1.0) * rows[e].error);
      }
      flock_free(f);
    }
}

/* The forces of a solve as a guess give the same velocities again, in one product; those of a
 * neighbouring place save products; and a guess that is nonsense does no harm. */
static void a_guess_saves_products(void **state)
{
  (void) state;
  flock *f = flock_create(5, chain5, ones, 42, 10, 5, 1.0);
  flock_scatter(f, 0.1, 9);
  flock_weigh(f, P6);
  assert_int_equal(flock_move(f, 6, 0, 1e-4, 100), SD_OK);
  const int cold = f->report.products;
  double V[6 * FLOCK_MOST];
  memcpy(V, f->V, sizeof(V));
  assert_int_equal(flock_move(f, 6, 1, 1e-4, 100), SD_OK);
  assert_int_equal(f->report.products, 1);
  assert_true(flock_distance(f->V, V, 60) < 1e-13);
  for (int b = 0; b < 15; b++) f->pose[12 * b + 9] += 1e-3 * (b % 3);
  assert_int_equal(flock_move(f, 6, 1, 1e-4, 100), SD_OK);
  assert_true(f->report.products <= cold / 2);
  uint64_t seed = 2;
  for (int j = 0; j < 6 * f->n; j++) f->l[j] = uniform(&seed, -1e4, 1e4);
  assert_int_equal(flock_move(f, 6, 1, 1e-10, 100), SD_OK);
  memcpy(V, f->V, sizeof(V));
  assert_int_equal(flock_move(f, 6, 0, 1e-10, 100), SD_OK);
  assert_true(flock_distance(f->V, V, 60) < 1e-9);
  flock_free(f);
}

/* The answer itself as a guess is found to be right, however tight the tolerance. */
static void the_answer_is_a_guess_that_ends_the_loop(void **state)
{
  (void) state;
  for (int seed = 1; seed <= 10; seed++) {
    flock *f = flock_create(5, chain5, ones, 1, 6, 3, 1.0);
    flock_scatter(f, 0.1, seed);
    flock_weigh(f, P6);
    assert_int_equal(flock_move(f, 6, 0, 1e-13, 100), SD_OK);
    assert_int_equal(flock_move(f, 6, 1, 1e-11, 100), SD_OK);
    assert_int_equal(f->report.products, 1);
    flock_free(f);
  }
}

/* Nothing acts, or a uniform stream carries all: that is no reason to iterate. */
static void who_is_only_carried_costs_one_product(void **state)
{
  (void) state;
  flock *f = flock_create(4, tetrahedron, ones, 42, 5, 3, 1.0);
  flock_scatter(f, 0.1, 9);
  assert_int_equal(flock_move(f, 6, 0, 1e-6, 100), SD_OK);
  assert_int_equal(f->report.products, 1);
  for (int j = 0; j < 6 * f->n; j++) assert_true(f->v[j] == 0.0);
  for (int i = 0; i < f->n; i++) f->u[6 * i + 1] = 0.3;
  assert_int_equal(flock_move(f, 6, 0, 1e-6, 100), SD_OK);
  assert_int_equal(f->report.products, 1);
  for (int j = 0; j < 6 * f->n; j++) CHECK_NEAR(f->v[j], j % 6 == 1 ? 0.3 : 0.0, 1e-14);
  flock_free(f);
}

/* Two clumps of shell points, all of them in the loop of a dense solution: V of a weight */
static void all_points(const flock *f, double *V)
{
  sd_shell shell;
  assert_int_equal(sd_shell_create(42, &shell), SD_OK);
  const int points = 42 * f->n, N = 3 * points;
  double *x = malloc(sizeof(double) * (size_t) N), *M = malloc(sizeof(double) * (size_t) N * N),
         *B = malloc(sizeof(double) * (size_t) N * 12), H[144] = {0};
  for (int i = 0; i < f->n; i++)
    for (int k = 0; k < 42; k++) {
      double p[3];
      sd_multiply3(f->pose + 12 * (i / f->m), shell.p + 3 * k, p);
      for (int d = 0; d < 3; d++) x[3 * (42 * i + k) + d] = f->x[3 * i + d] + shell.radius * p[d];
    }
  for (int i = 0; i < points; i++)
    for (int j = 0; j < points; j++) {
      double block[9], r[3];
      for (int d = 0; d < 3; d++) r[d] = x[3 * i + d] - x[3 * j + d];
      sd_tensor_uf(SD_TENSOR_RPY, r, shell.point, shell.point, f->eta, block);
      for (int p = 0; p < 3; p++)
        for (int q = 0; q < 3; q++) M[(size_t) (3 * i + p) * N + 3 * j + q] = block[3 * p + q];
    }
  memset(B, 0, sizeof(double) * (size_t) N * 12);
  for (int i = 0; i < points; i++) {
    const int b = i / 42 / f->m;
    double r[3], e[3] = {0}, v[3];
    for (int d = 0; d < 3; d++) r[d] = x[3 * i + d] - f->pose[12 * b + 9 + d];
    for (int c = 0; c < 3; c++) {
      e[0] = c == 0, e[1] = c == 1, e[2] = c == 2;
      sd_cross(e, r, v);
      B[(size_t) (6 * b + c) * N + 3 * i + c] = 1.0;
      for (int d = 0; d < 3; d++) B[(size_t) (6 * b + 3 + c) * N + 3 * i + d] = v[d];
    }
  }
  double *K = malloc(sizeof(double) * (size_t) N * 12);
  memcpy(K, B, sizeof(double) * (size_t) N * 12);
  assert_int_equal(sd_cholesky_solve(N, M, 12, B), SD_OK);
  for (int p = 0; p < 12; p++)
    for (int q = 0; q < 12; q++)
      for (int j = 0; j < N; j++) H[12 * p + q] += K[(size_t) p * N + j] * B[(size_t) q * N + j];
  for (int p = 0; p < 12; p++) V[p] = p % 6 == 2 ? -P6 * f->m : 0.0;
  assert_int_equal(sd_cholesky_solve(12, H, 1, V), SD_OK);
  free(x), free(M), free(B), free(K);
  sd_shell_free(&shell);
}

/* Two clumps side by side as spheres, with the 6x6 of shell 42, against shell 42 everywhere: 0.5 %
 * from a gap of two diameters on, 0.03 % at ten radii. (Axes 6 and 10 radii apart: two chains.) */
static void far_clumps_are_as_shells_everywhere(void **state)
{
  (void) state;
  const double distance[2] = {6.0, 10.0}, most[2] = {5e-3, 3e-4};
  for (int e = 0; e < 2; e++) {
    flock *f = flock_create(5, chain5, ones, 42, 2, 0, 1.0), *plain;
    f->pose[12 + 9] = distance[e];
    flock_weigh(f, P6);
    assert_int_equal(flock_move(f, 6, 0, 1e-8, 100), SD_OK);
    double V[12], with = 0.0, without = 0.0;
    all_points(f, V);
    plain = flock_create(5, chain5, ones, 1, 2, 0, 1.0);
    plain->pose[12 + 9] = distance[e];
    flock_weigh(plain, P6);
    assert_int_equal(flock_move(plain, 6, 0, 1e-8, 100), SD_OK);
    for (int b = 0; b < 2; b++)
      for (int d = 0; d < 3; d++) {
        with = fmax(with, fabs(f->V[6 * b + d] / V[2] - V[6 * b + d] / V[2]));
        without = fmax(without, fabs(plain->V[6 * b + d] / V[2] - V[6 * b + d] / V[2]));
      }
    assert_true(with < most[e]);
    assert_true(without > 0.01);
    flock_free(f), flock_free(plain);
  }
}

/* What keeps the members of free clumps in their places adds up to nothing over a clump; of the load that is random
 * it adds up to that, which nothing else on the clump bears. */
static void bonds_add_up_over_a_free_body(void **state)
{
  (void) state;
  flock *f = flock_create(4, tetrahedron, ones, 1, 3, 4, 1.3);
  flock_scatter(f, 0.2, 21);
  uint64_t seed = 6;
  double random[6 * FLOCK_MOST], bond[3 * FLOCK_MOST];
  for (int j = 0; j < 6 * f->n; j++) {
    f->F[j] = uniform(&seed, -1, 1);
    random[j] = uniform(&seed, -1, 1);
  }
  const sd_bodies A = flock_place(f, 6);
  assert_int_equal(flock_solve(f, &A, 0, 1e-8, 100), SD_OK);
  for (int noisy = 0; noisy < 2; noisy++) {
    double largest = 0.0;
    sd_bodies_bonds(&A, f->exerted, f->F, noisy ? random : NULL, bond);
    for (int j = 0; j < 3 * f->m * f->clumps; j++) largest = fmax(largest, fabs(bond[j]));
    assert_true(largest > 0.1);
    for (int b = 0; b < f->clumps; b++)
      for (int d = 0; d < 3; d++) {
        double sum = 0.0, of_noise = 0.0;
        for (int i = f->m * b; i < f->m * (b + 1); i++) {
          sum += bond[3 * i + d];
          of_noise += random[6 * i + d];
        }
        CHECK_NEAR(sum, noisy ? of_noise : 0.0, 1e-12);
      }
  }
  flock_free(f);
}

/* What makes the curvature negative is an error, not an answer: here a product with the wrong sign
 */
static sd_status wrong_sign(void *ctx, const double *F, double *u)
{
  flock *f = ctx;
  flock_apply(f, F, u);
  for (int j = 0; j < 6 * f->n; j++) u[j] *= -30.0;
  return SD_OK;
}

static void negative_curvature_is_refused(void **state)
{
  (void) state;
  flock *f = flock_create(4, tetrahedron, ones, 1, 5, 3, 1.0);
  flock_scatter(f, 0.1, 9);
  flock_weigh(f, P6);
  sd_bodies A = flock_place(f, 6);
  A.apply = wrong_sign;
  assert_int_equal(flock_solve(f, &A, 0, 1e-6, 100), SD_EINDEFINITE);
  assert_int_equal(flock_move(f, 6, 0, 1e-12, 3), SD_EMAXITER);
  assert_int_equal(f->report.products, 3);
  flock_free(f);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(free_spheres_take_one_product),
      cmocka_unit_test(ranks_that_know_of_no_shapes_do_not_ask),
      cmocka_unit_test(a_lone_clump_has_its_own_mobility),
      cmocka_unit_test(clumps_move_as_the_dense_solution_says),
      cmocka_unit_test(spheres_and_clumps_solve_the_system),
      cmocka_unit_test(products_are_few),
      cmocka_unit_test(a_guess_saves_products),
      cmocka_unit_test(the_answer_is_a_guess_that_ends_the_loop),
      cmocka_unit_test(who_is_only_carried_costs_one_product),
      cmocka_unit_test(far_clumps_are_as_shells_everywhere),
      cmocka_unit_test(bonds_add_up_over_a_free_body),
      cmocka_unit_test(negative_curvature_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
