/* sd_block_cholesky.h against dense factors. */
#include "check.h"

#include "sd_block_cholesky.h"
#include "sd_linear.h"

#include <string.h>

enum { NODES = 12, SIZE = 6 * NODES };

typedef struct {
  int count, pair[200][2];
  double diagonal[36 * NODES], block[36 * 200], dense[SIZE * SIZE];
} matrix;

/* A = 1 + sum over edges of s g g^T, g a random 12-vector: stiff edges, as gaps make them */
static void add_edge(matrix *A, int p, int q, double stiffness, uint64_t *seed)
{
  double g[12];
  for (int e = 0; e < 12; e++) g[e] = uniform(seed, -1, 1);
  for (int r = 0; r < 12; r++)
    for (int c = 0; c < 12; c++) {
      const int i = 6 * (r < 6 ? p : q) + r % 6, j = 6 * (c < 6 ? p : q) + c % 6;
      const double v = stiffness * g[r] * g[c];
      A->dense[SIZE * i + j] += v;
      if (r < 6 && c < 6) A->diagonal[36 * p + 6 * r + c] += v;
      if (r >= 6 && c >= 6) A->diagonal[36 * q + 6 * (r - 6) + c - 6] += v;
      if (r < 6 && c >= 6) A->block[36 * A->count + 6 * r + c - 6] = v;
    }
  A->pair[A->count][0] = p;
  A->pair[A->count++][1] = q;
}

static matrix *unity(void)
{
  matrix *A = calloc(1, sizeof(matrix));
  for (int i = 0; i < SIZE; i++) A->dense[SIZE * i + i] = 1.0;
  for (int p = 0; p < NODES; p++)
    for (int d = 0; d < 6; d++) A->diagonal[36 * p + 7 * d] = 1.0;
  return A;
}

/* Two pairs in five; some twice, and once the other way round */
static matrix *tangle(double stiffest)
{
  matrix *A = unity();
  uint64_t seed = 5;
  for (int p = 0; p < NODES; p++)
    for (int q = 0; q < p; q++)
      if ((7 * p + 3 * q) % 5 < 2) add_edge(A, p, q, pow(stiffest, uniform(&seed, 0, 1)), &seed);
  add_edge(A, A->pair[0][0], A->pair[0][1], 3.0, &seed);
  add_edge(A, A->pair[1][1], A->pair[1][0], 5.0, &seed);
  return A;
}

static void make(sd_block_cholesky *f, const matrix *A, double drop)
{
  assert_int_equal(sd_block_cholesky_make(f, NODES, A->diagonal, A->count, (const int(*)[2]) A->pair,
                                          A->block, drop),
                   SD_OK);
}

static void without_dropping_it_is_exact(void **state)
{
  (void) state;
  sd_block_cholesky f = {0};
  for (int again = 0; again < 2; again++) { /* made again with what it has */
    matrix *A = tangle(again ? 1e5 : 10.0);
    double b[SIZE], x[SIZE];
    make(&f, A, 0.0);
    for (int i = 0; i < SIZE; i++) b[i] = x[i] = cos(i);
    sd_block_cholesky_apply(&f, x);
    for (int i = 0; i < SIZE; i++) {
      double sum = 0.0;
      for (int j = 0; j < SIZE; j++) sum += A->dense[SIZE * i + j] * x[j];
      CHECK_NEAR(sum, b[i], (again ? 1e5 : 10.0) * 3e-6); /* single precision */
    }
    free(A);
  }
  sd_block_cholesky_free(&f);
}

/* P - A, as the inverse of P^-1 less A, is positive; and it is not zero. */
static void what_is_dropped_makes_it_larger(void **state)
{
  (void) state;
  matrix *A = tangle(1e3);
  sd_block_cholesky f = {0};
  make(&f, A, 100.0);
  double *P = calloc(SIZE * SIZE, sizeof(double)), trace = 0.0;
  for (int i = 0; i < SIZE; i++) {
    P[SIZE * i + i] = 1.0;
    sd_block_cholesky_apply(&f, P + SIZE * i);
  }
  assert_int_equal(sd_cholesky(SIZE, P), SD_OK);
  assert_int_equal(sd_cholesky_inverse(SIZE, P), SD_OK);
  for (int i = 0; i < SIZE * SIZE; i++) P[i] -= A->dense[i];
  for (int i = 0; i < SIZE; i++) trace += P[SIZE * i + i];
  assert_true(trace > 1.0);
  assert_true(positive_definite(P, SIZE, -1e-2)); /* of 1e3, in single precision */
  free(P), free(A);
  sd_block_cholesky_free(&f);
}

/* A chain has no fill whatever the order in which its links are given. */
static void a_chain_has_no_fill(void **state)
{
  (void) state;
  matrix *A = unity();
  uint64_t seed = 3;
  static const int links[NODES - 1] = {5, 0, 9, 3, 7, 1, 10, 4, 8, 2, 6};
  for (int k = 0; k < NODES - 1; k++) add_edge(A, links[k], links[k] + 1, 1e6, &seed);
  sd_block_cholesky f = {0};
  make(&f, A, 0.0);
  assert_int_equal(f.first[NODES], NODES - 1);
  free(A);
  sd_block_cholesky_free(&f);
}

static void what_is_not_positive_is_refused(void **state)
{
  (void) state;
  matrix *A = unity();
  sd_block_cholesky f = {0};
  A->diagonal[36 * 4 + 14] = -1.0;
  assert_int_equal(sd_block_cholesky_make(&f, NODES, A->diagonal, 0, NULL, NULL, 0.1), SD_ESINGULAR);
  A->diagonal[36 * 4 + 14] = NAN;
  assert_int_equal(sd_block_cholesky_make(&f, NODES, A->diagonal, 0, NULL, NULL, 0.1), SD_ENOTFINITE);
  free(A);
  sd_block_cholesky_free(&f);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(without_dropping_it_is_exact),
      cmocka_unit_test(what_is_dropped_makes_it_larger),
      cmocka_unit_test(a_chain_has_no_fill),
      cmocka_unit_test(what_is_not_positive_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
