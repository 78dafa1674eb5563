/* The random slip of a step in a periodic box, whose sum is split: the near part by Lanczos's process, the waves drawn
 * (test_ewald_noise has that these have exactly the covariance of their product). By unit vectors, without sampling. */
#include "blob_flock.h"

#include "clouds.h"
#include "sd_bodies_noise.h"
#include "sd_lubrication_noise.h"
#include "sd_pose.h"
#include "sd_random.h"

/* A flock in a cube whose sum is split as for noise. near, whole: its matrix of points less the waves, and with them */
typedef struct {
  blob_flock *f;
  sd_bodies near, whole;
  sd_body_root root[MOST];
  const sd_body_root *of[MOST];
} split_scene;

static void split_in_cube(split_scene *s, blob_flock *f, double side, double tolerance)
{
  s->f = f;
  s->whole = place(f, side, tolerance);
  sd_ewald split;
  const sd_ewald_box box = {.periodic = 1, .edge = {side, side, side}};
  const sd_ewald_sizes sizes = periodic_sizes(f->s->b, s->whole.points.n);
  assert_int_equal(sd_ewald_choose_positive(&box, &sizes, 3, tolerance, SD_EWALD_POSITIVE_ADDITION, &split), SD_OK);
  periodic_free(&f->p);
  periodic_place(&f->p, f->s->at, f->s->b, NULL, s->whole.points.n, 3, &split);
  assert_true(sd_mobility_divides(&f->p.omega));
  s->near = s->whole;
  s->near.apply = sd_mobility_apply_rest;
  tie_with_films(f, &s->whole);
  for (int b = 0; b < s->whole.shaped; b++) {
    const sd_body_shape *shape = f->m ? &f->shape.points : &f->lone.points;
    assert_int_equal(sd_body_root_create(shape, f->body[b].a, &split, s->root + b), SD_OK);
    s->of[b] = s->root + b;
  }
}

static void split_free(split_scene *s)
{
  for (int b = 0; b < s->whole.shaped; b++) sd_body_root_free(s->root + b);
  blob_flock_free(s->f);
}

/* Rows that a body has: not those of points within another sphere of the clump */
static int has(const split_scene *s, int row)
{
  return s->f->s->b[row / 3] > 0.0;
}

/* M [rows rows] by unit vectors */
static void matrix_of(const split_scene *s, const sd_bodies *A, double *M)
{
  const int rows = (int) sd_bodies_unknowns(A);
  double *e = calloc((size_t) rows, sizeof(double));
  for (int j = 0; j < rows; j++) {
    e[j] = has(s, j);
    assert_int_equal(A->apply(A->apply_ctx, e, M + (long) rows * j), SD_OK);
    A->add(A->add_ctx, 0, A->spheres.n, e, M + (long) rows * j);
    M[(long) (rows + 1) * j] += has(s, j) / A->D[j];
    e[j] = 0.0;
  }
  free(e);
}

/* Of C and M, in units of the diagonal of M */
static double worst_difference(const split_scene *s, int n, const double *C, const double *M, int of_points)
{
  double worst = 0.0;
  for (int p = 0; p < n; p++)
    for (int q = 0; q < n; q++) {
      if (of_points && (!has(s, p) || !has(s, q))) continue;
      const double unit = sqrt(M[(long) (n + 1) * p] * M[(long) (n + 1) * q]);
      worst = fmax(worst, fabs(C[(long) n * p + q] - M[(long) n * p + q]) / unit);
    }
  return worst;
}

/* Forces and torques F [6 spheres] from number j of a body's load, about its centre */
static void unit_load(const blob_flock *f, int j, double *F)
{
  const int first = (f->m ? f->m : 1) * (j / 6);
  const double e[3] = {j % 6 == 0, j % 6 == 1, j % 6 == 2};
  F[6 * first + j % 6] = 1.0;
  if (j % 6 < 3 && f->m) sd_cross(e, f->arm + 3 * first, F + 6 * first + 3);
}

/* N [6 bodies]^2 and, of each unit load, the forces l of the points: G = N K^T M'^-1, which makes velocities of slip,
 * has these as rows */
static void mobility_of(split_scene *s, double *N, double *G)
{
  const int size = 6 * s->whole.shaped, rows = (int) sd_bodies_unknowns(&s->whole);
  for (int j = 0; j < size; j++) {
    double F[6 * MOST] = {0.0};
    unit_load(s->f, j, F);
    assert_int_equal(move(s->f, &s->whole, F, 0, 1e-10), SD_OK);
    memcpy(N + size * j, s->f->V, sizeof(double) * (size_t) size);
    memcpy(G + (long) rows * j, s->f->l, sizeof(double) * (size_t) rows);
  }
}

static void add_square(int size, const double *V, double *C)
{
  for (int p = 0; p < size; p++)
    for (int q = 0; q < size; q++) C[(long) size * p + q] += V[p] * V[q];
}

/* C += G B G^T, G [size rows] */
static void add_congruent(int size, int rows, const double *G, const double *B, double *C)
{
  double *x = malloc(sizeof(double) * (size_t) rows);
  for (int p = 0; p < size; p++) {
    memset(x, 0, sizeof(double) * (size_t) rows);
    for (int i = 0; i < rows; i++)
      for (int k = 0; k < rows; k++) x[k] += G[(long) rows * p + i] * B[(long) rows * i + k];
    for (int q = 0; q < size; q++)
      for (int k = 0; k < rows; k++) C[size * p + q] += x[k] * G[(long) rows * q + k];
  }
  free(x);
}

/* Unit number e of pair k, which are asked for one after the other */
typedef struct {
  long k, asked;
  int e;
} unit_of_one;

static int unit_of_one_pair(void *ctx, int i, int at, double g[12])
{
  (void) i, (void) at;
  unit_of_one *u = ctx;
  for (int e = 0; e < 12; e++) g[e] = u->asked == u->k && e == u->e;
  u->asked++;
  return 1;
}

/* B [size size] += the covariance of what films do to bodies, by unit numbers */
static void add_films(const split_scene *s, int size, double *B)
{
  const sd_lubrication *L = s->whole.tie->L;
  double F[6 * MOST], on_bodies[6 * MOST];
  assert_true(L->count > 0);
  for (long k = 0; k < L->count; k++)
    for (int e = 0; e < 12; e++) {
      unit_of_one u = {k, 0, e};
      assert_int_not_equal(L->pair[k][0], L->pair[k][1]);
      memset(F, 0, sizeof F);
      assert_int_equal(sd_lubrication_noise(L, unit_of_one_pair, &u, F), SD_OK);
      sd_rigid_collect(&s->whole.spheres, F, s->whole.shaped, on_bodies);
      add_square(size, on_bodies, B);
    }
}

/* V = G y + N f, for one y and one f */
static void check_solve(split_scene *s, const double *N, const double *G)
{
  const int size = 6 * s->whole.shaped, rows = (int) sd_bodies_unknowns(&s->whole);
  double F[6 * MOST] = {0.0}, on_bodies[6 * MOST];
  for (int j = 0; j < rows; j++) s->f->u[j] = has(s, j) * (j * 7 % 11 - 5.0);
  for (int k = 0; k < 6 * s->whole.spheres.n; k++) F[k] = k * 5 % 13 - 6.0;
  sd_rigid_collect(&s->whole.spheres, F, s->whole.shaped, on_bodies);
  assert_int_equal(move(s->f, &s->whole, F, 0, 1e-10), SD_OK);
  double off = 0.0, all = 0.0;
  for (int p = 0; p < size; p++) {
    double V = 0.0;
    for (int j = 0; j < rows; j++) V += G[(long) rows * p + j] * s->f->u[j];
    for (int q = 0; q < size; q++) V += N[size * p + q] * on_bodies[q];
    off += (V - s->f->V[p]) * (V - s->f->V[p]);
    all += V * V;
  }
  assert_true(off < 1e-14 * all);
  memset(s->f->u, 0, sizeof s->f->u);
}

/* Near part: the Gram matrix C of what unit numbers draw is the near matrix. Whole: velocities are G y + N f, the slip
 * y of covariance C + that of the waves' product, so that theirs is G (C + waves) G^T + N (films) N = N. */
static void check_covariance(split_scene *s)
{
  const int size = 6 * s->whole.shaped, rows = (int) sd_bodies_unknowns(&s->whole);
  const size_t square = (size_t) rows * (size_t) rows, small = (size_t) size * (size_t) size;
  double *M = malloc(sizeof(double) * 3 * square), *C = M + square, *whole = C + square;
  double *N = calloc(3 * small, sizeof(double)), *cov = N + small, *films = cov + small;
  double *G = malloc(sizeof(double) * (size_t) size * (size_t) rows);
  double *w = calloc(2 * (size_t) rows, sizeof(double)), *y = w + rows;
  const sd_bodies_blocks blocks = {s->near.body, s->of};
  sd_bodies_noise noise = {0};
  sd_noise_report report;
  matrix_of(s, &s->near, M);
  matrix_of(s, &s->whole, whole);
  memset(C, 0, sizeof(double) * square);
  for (int j = 0; j < rows; j++) {
    if (!has(s, j)) continue;
    w[j] = 1.0;
    assert_int_equal(sd_bodies_draw(&noise, &s->near, &blocks, w, 1e-9, y, &report), SD_OK);
    w[j] = 0.0;
    add_square(rows, y, C);
  }
  const double of_points = worst_difference(s, rows, C, M, 1);
  mobility_of(s, N, G);
  check_solve(s, N, G);
  for (size_t k = 0; k < square; k++) C[k] += whole[k] - M[k];
  add_congruent(size, rows, G, C, cov);
  add_films(s, size, films);
  add_congruent(size, size, N, films, cov);
  const double of_bodies = worst_difference(s, size, cov, N, 0);
  print_message("covariance off by %.1e in the near part, %.1e of the velocities\n", of_points, of_bodies);
  assert_true(of_points < 1e-8 && of_bodies < 1e-6);
  sd_bodies_noise_free(&noise);
  free(M), free(N), free(G), free(w);
}

/* n bodies at random in a cube, each of m spheres at X of radius a[body], turned by R where there is one: none nearer
 * to another than 1 + 1e-2 of the sum of their radii. centre [3 n] */
static void scatter(int n, int m, const double *X, const double *a, const double *R, double side, double *centre)
{
  uint64_t seed = 7;
  double x[3 * MOST], r[3];
  for (int b = 0; b < n; b++)
    for (int apart = 0; !apart;) {
      for (int d = 0; d < 3; d++) centre[3 * b + d] = uniform(&seed, 0, side);
      for (int i = 0; i < m; i++) {
        sd_multiply3(R + 9 * b, X + 3 * i, r);
        for (int d = 0; d < 3; d++) x[3 * (m * b + i) + d] = centre[3 * b + d] + r[d];
      }
      apart = 1;
      for (int k = 3 * m * b; k < 3 * m * (b + 1) && apart; k += 3)
        for (int j = 0; j < 3 * m * b && apart; j += 3) {
          for (int d = 0; d < 3; d++) r[d] = x[k + d] - x[j + d] - side * rint((x[k + d] - x[j + d]) / side);
          apart = sqrt(sd_dot(r, r)) > 1.01 * (a[b] + a[j / (3 * m)]);
        }
    }
}

/* Free spheres, volume fraction phi: the first has a radius of `large`, the others of 0.8 to 1.2. None sees an image of
 * itself by its film. */
static blob_flock *spheres(int n, double large, double phi, double *side)
{
  const double none[3] = {0.0};
  double a[MOST], R[9 * MOST] = {0.0}, centre[3 * MOST], volume = 0.0;
  for (int i = 0; i < n; i++) {
    a[i] = i == 0 ? large : 0.8 + 0.1 * (i % 5);
    volume += 4.0 / 3.0 * SD_PI * pow(a[i], 3);
    for (int d = 0; d < 3; d++) R[9 * i + 4 * d] = 1.0;
  }
  *side = cbrt(volume / phi);
  scatter(n, 1, none, a, R, *side, centre);
  return free_spheres(12, n, centre, a);
}

static void check_spheres(int n, double large, double phi)
{
  double side;
  split_scene s;
  blob_flock *f = spheres(n, large, phi, &side);
  split_in_cube(&s, f, side, 1e-4);
  check_covariance(&s);
  split_free(&s);
}

static void unlike_spheres_with_films(void **state)
{
  (void) state;
  check_spheres(CHECK_SIZE(12, 6), 1.0, 0.3);
}

/* Of four that touch, from their centroid: clumps stand at theirs */
static const double CHAIN[12] = {-1.5, -1, -0.5, 0.5, -1, -0.5, 0.5, 1, -0.5, 0.5, 1, 1.5};

static void crooked_chains_with_films(void **state)
{
  (void) state;
  enum { CHAINS = 3 };
  static const double turn[3 * CHAINS] = {0.3, -0.2, 0.5, -0.9, 0.4, 1.1, 1.7, 0.8, -0.6}, a[CHAINS] = {1, 1, 1};
  const double side = cbrt(4 * CHAINS * 4.0 / 3.0 * SD_PI / 0.15);
  double R[9 * CHAINS], centre[3 * CHAINS];
  split_scene s;
  for (int b = 0; b < CHAINS; b++) sd_rotation(turn + 3 * b, R + 9 * b);
  scatter(CHAINS, 4, CHAIN, a, R, side, centre);
  split_in_cube(&s, clumps_at(12, CHAINS, 4, CHAIN, R, centre), side, 1e-4);
  check_covariance(&s);
  split_free(&s);
}

static void one_sphere_many_times_as_large(void **state)
{
  (void) state;
  check_spheres(CHECK_SIZE(8, 4), 3.0, 0.14);
  check_spheres(CHECK_SIZE(8, 4), 8.0, 0.14);
}

/* The variance of every mode of the mobility as a step has it at the default noise_tolerance of 0.01, by what sharper
 * roots and solves would change in it, with the same numbers */
static void every_mode_is_right_at_the_default_tolerance(void **state)
{
  (void) state;
  enum { DRAWS = 24 };
  double side, sum[6 * MOST] = {0.0}, V[2][6 * MOST], worst = 0.0;
  split_scene s;
  blob_flock *f = spheres(CHECK_SIZE(32, 8), 1.0, 0.3, &side);
  split_in_cube(&s, f, side, 1e-4);
  const int size = 6 * s.whole.shaped, rows = (int) sd_bodies_unknowns(&s.whole);
  double *R = malloc(sizeof(double) * (size_t) (size * size)), *G = malloc(sizeof(double) * (size_t) (size * rows));
  double *w = malloc(sizeof(double) * 2 * (size_t) rows), *waves = w + rows;
  const sd_bodies_blocks blocks = {s.near.body, s.of};
  sd_bodies_noise noise = {0};
  sd_noise_report report;
  mobility_of(&s, R, G);
  assert_int_equal(sd_cholesky(size, R), SD_OK);
  assert_int_equal(sd_cholesky_inverse(size, R), SD_OK);
  assert_int_equal(sd_symmetric_root(size, R), SD_OK);
  for (int k = 0; k < DRAWS; k++) {
    const sd_random_key key = {3, SD_RANDOM_SPHERE, (uint64_t) k}, of_waves = {4, SD_RANDOM_SPHERE, (uint64_t) k};
    double F[6 * MOST] = {0.0};
    sd_random_normals(&key, 1, rows, w);
    assert_int_equal(sd_mobility_draw(&f->p.omega, &of_waves, waves), SD_OK);
    for (int sharp = 0; sharp < 2; sharp++) {
      const double tolerance = sharp ? 1e-7 : 0.01 / 3.0;
      assert_int_equal(sd_bodies_draw(&noise, &s.near, &blocks, w, tolerance, f->u, &report), SD_OK);
      sd_noise_join(rows, 1.0, waves, f->u);
      assert_int_equal(move(f, &s.whole, F, 0, tolerance), SD_OK);
      for (int p = 0; p < size; p++) { /* R^1/2 V has the covariance 1 */
        V[sharp][p] = 0.0;
        for (int q = 0; q < size; q++) V[sharp][p] += R[size * p + q] * f->V[q];
      }
    }
    for (int p = 0; p < size; p++) sum[p] += (V[0][p] * V[0][p] - V[1][p] * V[1][p]) / DRAWS;
  }
  for (int p = 0; p < size; p++) worst = fmax(worst, fabs(sum[p]));
  print_message("worst mode off by %.2f %%, %d products of the root, %d of the solve\n", 100 * worst, report.products,
                f->report.products);
  assert_true(worst < 0.01);
  sd_bodies_noise_free(&noise);
  free(R), free(G), free(w);
  split_free(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(unlike_spheres_with_films),
      cmocka_unit_test(crooked_chains_with_films),
      cmocka_unit_test(one_sphere_many_times_as_large),
      cmocka_unit_test(every_mode_is_right_at_the_default_tolerance),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
