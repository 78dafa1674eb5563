/* Free spheres of one point above a wall: images, films of pairs and films of the wall together. */
#include "table.h"
#include "two_spheres.h"

#include "sd_linear.h"
#include "sd_lubrication.h"
#include "sd_tensor.h"
#include "sd_wall.h"
#include "sd_wall_film.h"

enum { N = 2, SIZE = 6 * N };

static const double up[3] = {0.0, 0.0, 1.0};
static const sd_wall ground = {.axis = 2, .sign = 1};

/* M^-1 [SIZE SIZE], M the model's mobility above the wall */
static void resistance_of_model(const double *x, const double *a, double *R)
{
  double M[SIZE * SIZE];
  memset(R, 0, SIZE * SIZE * sizeof(double));
  for (int i = 0; i < N; i++)
    for (int j = 0; j < N; j++) {
      double r[3], apart[36], image[36];
      sd_minus(x + 3 * i, x + 3 * j, r);
      sd_tensor_grand(r, a[i], a[j], 1.0, apart);
      sd_wall_block(&ground, 6, x + 3 * i, a[i], x + 3 * j, a[j], image);
      for (int e = 0; e < 36; e++) M[(6 * i + e / 6) * SIZE + 6 * j + e % 6] = apart[e] + image[e];
    }
  for (int k = 0; k < SIZE; k++) R[k * (SIZE + 1)] = 1.0;
  assert_int_equal(sd_cholesky_solve(SIZE, M, SIZE, R), SD_OK);
}

static void add_pair_films(const double *x, const double *a, double *R)
{
  const double w[N] = {1.0, 1.0};
  sd_lubrication L = {0};
  const sd_lubrication_scene scene = {
      .functions = two_spheres(2.0), .gap = 1e-6, .range = 2.0, .n = N, .n_all = N, .spheres = {x, a, w}};
  assert_int_equal(sd_lubrication_place(&L, &scene), SD_OK);
  for (int j = 0; j < SIZE; j++) {
    double V[SIZE] = {0.0}, f[SIZE];
    V[j] = 1.0;
    assert_int_equal(sd_lubrication_apply(&L, V, f), SD_OK);
    for (int i = 0; i < SIZE; i++) R[i * SIZE + j] += f[i];
  }
  sd_lubrication_free(&L);
}

static void add_wall_films(const double *x, const double *a, double *R)
{
  for (int i = 0; i < N; i++) {
    const sd_wall_film film = sd_wall_film_at(a[i], x[3 * i + 2], 1e-6);
    double B[36];
    sd_wall_film_matrix(&film, up, 1.0, B);
    for (int e = 0; e < 36; e++) R[(6 * i + e / 6) * SIZE + 6 * i + e % 6] += B[e];
  }
}

/* The same model in another code: 1e-6 of the largest. What it is worth against the full flow is up
 * to 8 %, or 16 % where two unequal ones are near contact. */
static void groups(void **state)
{
  (void) state;
  table t = table_open("walls/groups.csv");
  double worst = 0.0, worst_exact = 0.0;
  int rows = 0;
  while (table_next(&t)) {
    double x[3 * N], a[N], V[SIZE] = {0.0}, model[SIZE], exact[SIZE], R[SIZE * SIZE];
    double off = 0.0, most = 0.0, off_exact = 0.0, all = 0.0;
    for (int i = 0; i < N; i++, rows++) {
      if (i > 0) assert_true(table_next(&t));
      a[i] = table_number(&t, 6);
      for (int d = 0; d < 3; d++) {
        x[3 * i + d] = table_number(&t, 3 + d);
        V[6 * i + d] = table_number(&t, 7 + d);
      }
      for (int e = 0; e < 6; e++) {
        exact[6 * i + e] = table_number(&t, 10 + e);
        model[6 * i + e] = table_number(&t, 16 + e);
      }
    }
    resistance_of_model(x, a, R);
    add_pair_films(x, a, R);
    add_wall_films(x, a, R);
    assert_int_equal(sd_cholesky_solve(SIZE, R, 1, V), SD_OK);
    for (int e = 0; e < SIZE; e++) {
      off = fmax(off, fabs(V[e] - model[e]));
      most = fmax(most, fabs(model[e]));
      off_exact += pow(V[e] - exact[e], 2);
      all += pow(exact[e], 2);
    }
    worst = fmax(worst, off / most);
    worst_exact = fmax(worst_exact, sqrt(off_exact / all));
  }
  print_message("model: largest difference %.2g; against the full flow %.3g\n", worst, worst_exact);
  assert_int_equal(rows, 18);
  assert_true(worst < 1e-6 && worst_exact < 0.17);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(groups)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
