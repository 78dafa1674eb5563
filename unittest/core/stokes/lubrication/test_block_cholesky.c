/* sd_block_cholesky.h against dense factors. */
#include "check.h"

#include "sd_block_cholesky.h"
#include "sd_block_internal.h"
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

static void add_all(sd_block_cholesky *f, const matrix *A)
{
  for (int p = 0; p < NODES; p++)
    assert_int_equal(sd_block_cholesky_add(f, p, p, A->diagonal + 36 * p), SD_OK);
  for (int k = 0; k < A->count; k++)
    assert_int_equal(sd_block_cholesky_add(f, A->pair[k][0], A->pair[k][1], A->block + 36 * k), SD_OK);
}

static sd_status make(sd_block_cholesky *f, const matrix *A, double drop)
{
  assert_int_equal(sd_block_cholesky_begin(f, NODES), SD_OK);
  add_all(f, A);
  return sd_block_cholesky_factor(f, drop);
}

static void without_dropping_it_is_exact(void **state)
{
  (void) state;
  sd_block_cholesky f = {0};
  for (int again = 0; again < 2; again++) { /* made again with what it has */
    matrix *A = tangle(again ? 1e5 : 10.0);
    double b[SIZE], x[SIZE];
    assert_int_equal(make(&f, A, 0.0), SD_OK);
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

/* P >= A, and not equal: A^-1 - P^-1 is positive semidefinite, and not zero. */
/* The middle of what has been put off: its columns are those of the inverse of what the elimination leaves */
static void note_block(void *ctx, int p, int q, const double B[36])
{
  double *left = ctx;
  for (int e = 0; e < 36; e++) left[SIZE * (6 * p + e / 6) + 6 * q + e % 6] = B[e];
}

static void nodes_can_be_put_off(void **state)
{
  (void) state;
  const int late[] = {2, 7, 10};
  sd_block_cholesky f = {0};
  matrix *A = tangle(10.0);
  double *left = calloc(SIZE * SIZE, sizeof(double)), b[SIZE], x[SIZE], whole[SIZE];
  assert_int_equal(sd_block_cholesky_begin(&f, NODES), SD_OK);
  for (int k = 0; k < 3; k++) sd_block_cholesky_put_off(&f, late[k]);
  add_all(&f, A);
  assert_int_equal(sd_block_cholesky_factor(&f, 0.0), SD_OK);
  for (int k = 0; k < 3; k++) sd_block_cholesky_left(&f, late[k], note_block, left);
  assert_int_equal(sd_block_cholesky_finish(&f, 0.0), SD_OK);
  for (int i = 0; i < SIZE; i++) b[i] = x[i] = whole[i] = cos(i);
  sd_block_cholesky_apply(&f, whole);
  sd_block_cholesky_forth(&f, x);
  double before[SIZE];
  memcpy(before, x, sizeof(x));
  sd_block_cholesky_middle(&f, x);
  for (int k = 0; k < 3; k++) /* S x = what forth has left */
    for (int r = 6 * late[k]; r < 6 * late[k] + 6; r++) {
      double sum = 0.0;
      for (int j = 0; j < SIZE; j++) sum += left[SIZE * r + j] * x[j];
      CHECK_NEAR(sum, before[r], 1e-4);
    }
  sd_block_cholesky_back(&f, x);
  for (int i = 0; i < SIZE; i++) {
    double sum = 0.0;
    for (int j = 0; j < SIZE; j++) sum += A->dense[SIZE * i + j] * x[j];
    CHECK_NEAR(sum, b[i], 1e-4);
    CHECK_NEAR(x[i], whole[i], 1e-5);
  }
  free(A);
  free(left);
  sd_block_cholesky_free(&f);
}

/* One that is left out is neither in the middle nor changed by it: of S the rows and columns of the others count. */
static void nodes_can_be_left_out(void **state)
{
  (void) state;
  enum { OUT = 7, LATE = 4 };
  const int late[LATE] = {2, OUT, 9, 10};
  sd_block_cholesky f = {0};
  matrix *A = tangle(10.0);
  double *left = calloc(SIZE * SIZE, sizeof(double)), x[SIZE], before[SIZE];
  assert_int_equal(sd_block_cholesky_begin(&f, NODES), SD_OK);
  for (int k = 0; k < LATE; k++) sd_block_cholesky_put_off(&f, late[k]);
  add_all(&f, A);
  assert_int_equal(sd_block_cholesky_factor(&f, 0.0), SD_OK);
  for (int k = 0; k < LATE; k++) sd_block_cholesky_left(&f, late[k], note_block, left);
  assert_true(sd_block_cholesky_degree(&f, OUT) > 0);
  sd_block_cholesky_leave_out(&f, OUT);
  assert_int_equal(sd_block_cholesky_finish(&f, 0.0), SD_OK);
  for (int i = 0; i < SIZE; i++) x[i] = cos(i);
  sd_block_cholesky_forth(&f, x);
  memcpy(before, x, sizeof(x));
  sd_block_cholesky_middle(&f, x);
  for (int k = 0; k < LATE; k++)
    for (int r = 6 * late[k]; r < 6 * late[k] + 6; r++) {
      double sum = 0.0;
      for (int j = 0; j < SIZE; j++) sum += j / 6 == OUT ? 0.0 : left[SIZE * r + j] * x[j];
      CHECK_NEAR(late[k] == OUT ? x[r] : sum, before[r], 1e-4);
    }
  free(A);
  free(left);
  sd_block_cholesky_free(&f);
}

static void what_is_dropped_makes_it_larger(void **state)
{
  (void) state;
  matrix *A = tangle(1e3);
  sd_block_cholesky f = {0};
  assert_int_equal(make(&f, A, 100.0), SD_OK);
  double *P = calloc(SIZE * SIZE, sizeof(double)), trace = 0.0;
  assert_int_equal(sd_cholesky(SIZE, A->dense), SD_OK);
  assert_int_equal(sd_cholesky_inverse(SIZE, A->dense), SD_OK);
  for (int i = 0; i < SIZE; i++) {
    P[SIZE * i + i] = 1.0;
    sd_block_cholesky_apply(&f, P + SIZE * i);
    for (int j = 0; j < SIZE; j++) P[SIZE * i + j] = A->dense[SIZE * i + j] - P[SIZE * i + j];
    trace += P[SIZE * i + i];
  }
  assert_true(trace > 0.1);
  assert_true(positive_definite(P, SIZE, -1e-5)); /* of 1, in single precision */
  free(P), free(A);
  sd_block_cholesky_free(&f);
}

/* Stiff in a few directions as no film is: what is left of a diagonal is rounding, and no pivot fails. */
static void rounding_fails_no_pivot(void **state)
{
  (void) state;
  sd_block_cholesky f = {0};
  for (int k = 0; k < 40; k++) {
    matrix *A = unity();
    uint64_t seed = 11 + k;
    for (int p = 0; p < NODES; p++)
      for (int q = 0; q < p; q++)
        if ((5 * p + 3 * q + k) % 4 < 1) add_edge(A, p, q, 3e7, &seed);
    assert_int_equal(make(&f, A, 0.0), SD_OK);
    free(A);
  }
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
  assert_int_equal(make(&f, A, 0.0), SD_OK);
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
  assert_int_equal(make(&f, A, 0.1), SD_ESINGULAR);
  A->diagonal[36 * 4 + 14] = NAN;
  assert_int_equal(make(&f, A, 0.1), SD_ENOTFINITE);
  free(A);
  sd_block_cholesky_free(&f);
}

/* A column of the kernels of each instruction set against those in plain C: what is divided, what it
 * takes from targets of each kind, and what is applied. */
typedef struct {
  float pivot[SD_BLOCK], inverse[SD_BLOCK], column[4 * SD_BLOCK], target[3 * SD_BLOCK], vector[5 * SD_BLOCK_LANES];
  float square;
} worked;

static void fill(float *block, double diagonal, uint64_t *seed)
{
  for (int r = 0; r < 6; r++)
    for (int c = 0; c < 6; c++)
      block[SD_BLOCK_LANES * r + c] = (float) (uniform(seed, -1, 1) + (r == c ? diagonal : 0.0));
}

static worked work_with(const struct sd_block_kernels *kernels)
{
  worked w = {.square = 0.0f};
  uint64_t seed = 9;
  fill(w.pivot, 8.0, &seed);
  for (int k = 0; k < 36; k++) /* as symmetric as the upper triangle says */
    w.pivot[SD_BLOCK_LANES * (k / 6) + k % 6] = w.pivot[SD_BLOCK_LANES * (k / 6 < k % 6 ? k / 6 : k % 6) +
                                                        (k / 6 < k % 6 ? k % 6 : k / 6)];
  for (int k = 0; k < 4; k++) fill(w.column + SD_BLOCK * k, 0.0, &seed);
  for (int k = 0; k < 3; k++) fill(w.target + SD_BLOCK * k, 0.0, &seed);
  for (int k = 0; k < 5; k++)
    for (int d = 0; d < 6; d++) w.vector[SD_BLOCK_LANES * k + d] = (float) uniform(&seed, -1, 1);
  assert_true(kernels->divide(w.pivot, w.inverse, 4, w.column));
  sd_block_target target[3] = {{w.target, SD_BLOCK_NEW, 0.0f},
                               {w.target + SD_BLOCK, SD_BLOCK_TURNED, 0.0f},
                               {w.target + 2 * SD_BLOCK, SD_BLOCK_AS_IT_IS, 0.0f}};
  float pivot[SD_BLOCK];
  memcpy(pivot, w.pivot, sizeof(pivot));
  kernels->subtract(w.column, pivot, 3, target);
  memcpy(w.pivot, pivot, sizeof(pivot));
  w.square = target[0].square;
  int order[5] = {2, 0, 1, 3, 4}, row[4] = {3, 1, 4, 0};
  long first[6] = {0, 4, 4, 4, 4, 4};
  float inverse[6 * SD_BLOCK_KEPT] = {0.0f}, column[5 * SD_BLOCK_KEPT] = {0.0f}; /* and room behind */
  for (int k = 0; k < 5; k++) sd_block_keep(w.inverse, inverse + SD_BLOCK_KEPT * k);
  for (int k = 0; k < 4; k++) sd_block_keep(w.column + SD_BLOCK * k, column + SD_BLOCK_KEPT * k);
  const sd_block_cholesky f = {
      .n = 5, .order = order, .first = first, .row = row, .inverse = inverse, .column = column, .vector = w.vector};
  kernels->forth(&f, 0, 5);
  kernels->back(&f, 0, 5);
  return w;
}

static void kernels_agree(void **state)
{
  (void) state;
  const worked expected = work_with(&sd_block_plain);
  for (sd_isa isa = SD_ISA_BASELINE; isa <= SD_ISA_AVX512; isa++) {
    if (!sd_isa_supported(isa)) continue;
    const worked w = work_with(SD_KERNELS_OF(sd_block, plain, isa));
    const float *a = (const float *) &w, *b = (const float *) &expected;
    for (size_t e = 0; e < sizeof(worked) / sizeof(float); e++) CHECK_NEAR(a[e], b[e], 1e-5);
  }
  assert_true(expected.square > 0.01);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(without_dropping_it_is_exact),
      cmocka_unit_test(nodes_can_be_put_off),
      cmocka_unit_test(nodes_can_be_left_out),
      cmocka_unit_test(what_is_dropped_makes_it_larger),
      cmocka_unit_test(rounding_fails_no_pivot),
      cmocka_unit_test(a_chain_has_no_fill),
      cmocka_unit_test(what_is_not_positive_is_refused),
      cmocka_unit_test(kernels_agree),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
