/* Who is near whom: each pair once, whether rows are asked about one by one or in bunches. */
#include "ewald/periodic.h"

#include "sd_ewald_pairs.h"

enum { N = 400, MOST = 4 };

typedef struct {
  const sd_ewald_cells *cells;
  int next, bunches;
  /* [N][N] rows: how often j was found behind the row i */
  unsigned char found[N][N];
} seen;

static double apart(const sd_ewald_cells *c, int i, int j, double *most)
{
  double x[3], y[3];
  sd_ewald_cells_at(c, i, x);
  sd_ewald_cells_at(c, j, y);
  *most = fmax(fabs(x[0] - y[0]), fmax(fabs(x[1] - y[1]), fabs(x[2] - y[2])));
  return sqrt(pow(x[0] - y[0], 2) + pow(x[1] - y[1], 2) + pow(x[2] - y[2], 2));
}

static sd_status see(void *ctx, int row, int end, int ranges, long room)
{
  seen *s = ctx;
  double most;
  assert_int_equal(row, s->next);
  assert_true(end > row && end <= row + MOST);
  s->next = end;
  s->bunches++;
  for (int i = row; i < end; i++)
    for (int j = row; j < i; j++) {
      apart(s->cells, i, j, &most);
      assert_true(most <= s->cells->reach);
    }
  for (int k = 0; k < ranges; k++)
    for (int j = s->cells->range[2 * k]; j < s->cells->range[2 * k + 1]; j++, room--)
      for (int i = row; i < end && i < j; i++) s->found[i][j]++;
  assert_true(room >= 0);
  return SD_OK;
}

/* Places in a box of so many reaches, half of them in clusters */
static void check(double box, int most, int turn)
{
  static double x[3 * N], centre[3 * N + SD_FULL];
  static seen s;
  uint64_t seed = 3;
  for (int i = 0; i < 3 * N; i++) x[i] = i % 6 < 3 || i < 6 ? uniform(&seed, 0, box) : x[i - 6] +
      uniform(&seed, -0.4, 0.4);
  sd_ewald_cells c = {0};
  assert_int_equal(sd_ewald_cells_sort(&c, x, NULL, N, 1.0, turn, centre), SD_OK);
  if (most > 1) sd_ewald_cells_order(&c);
  memset(&s, 0, sizeof(s));
  s.cells = &c;
  assert_int_equal(sd_ewald_cells_walk(&c, most, see, &s), SD_OK);
  assert_int_equal(s.next, N);
  assert_true(most == 1 ? s.bunches == N : s.bunches < N);
  for (int k = 0; k < N; k++)
    for (int d = 0; d < 3; d++) assert_true(centre[d * N + k] == x[3 * c.place[k] + (d + turn) % 3]);
  for (int k = 1; k < N; k++) /* planes of cells along the first direction of the frame, one after the other */
    assert_true((int) ((centre[k] - c.lo[0]) * c.inverse) >= (int) ((centre[k - 1] - c.lo[0]) * c.inverse));
  for (int i = 0; i < N; i++)
    for (int j = i + 1; j < N; j++) {
      double along;
      assert_true(s.found[i][j] <= 1);
      if (apart(&c, i, j, &along) <= 1.0) assert_int_equal(s.found[i][j], 1);
    }
  sd_ewald_cells_free(&c);
}

static void each_pair_is_found_once(void **state)
{
  (void) state;
  for (int most = 1; most <= MOST; most++) {
    check(2.5, most, 0);
    check(6.0, most, most % 3);
    check(1000.0, most, 2);
  }
}

/* Floats measure places modulo four ranges: of a row of spheres those that are so far apart are not taken together. */
static void spheres_far_apart_in_a_column_do_not_meet(void **state)
{
  (void) state;
  enum { ROW = 24 };
  const sd_ewald_box box = {.periodic = 1, .edge = {100, 100, 100}};
  const sd_groups none = {0};
  double x[3 * ROW] = {0}, a[ROW], F[3 * ROW], expected[3 * ROW], u[3 * ROW];
  uint64_t seed = 8;
  for (int i = 0; i < ROW; i++) a[i] = 1.0;
  for (int i = 0; i < 3 * ROW; i++) F[i] = uniform(&seed, -1, 1);
  const sd_ewald how = periodic_choose(&box, a, ROW, 3, 1e-3);
  assert_true(how.single);
  for (int i = 0; i < ROW; i++) x[3 * i + 2] = 0.97 * how.range * i;
  const sd_isa isa = sd_isa_of(SD_ISA_BEST);
  for (int single = 0; single < 2; single++) {
    sd_ewald_pairs p = {0};
    sd_ewald_pairs_create(&p, &how, single ? SD_KERNELS_OF(sd_ewald_single, plain, isa) :
                          SD_KERNELS_OF(sd_ewald, plain, isa), 3);
    assert_int_equal(sd_ewald_pairs_place(&p, &(sd_spheres){x, a, a}, &none, ROW, ROW, 0), SD_OK);
    assert_int_equal(sd_ewald_pairs_load(&p, ROW, F, NULL, NULL, NULL), SD_OK);
    sd_ewald_pairs_apply(&p);
    sd_ewald_pairs_take(&p, ROW, F, NULL, NULL, NULL, single ? u : expected);
    sd_ewald_pairs_free(&p);
  }
  for (int i = 0; i < 3 * ROW; i++) CHECK_NEAR(u[i], expected[i], 1e-6);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(each_pair_is_found_once),
      cmocka_unit_test(spheres_far_apart_in_a_column_do_not_meet),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
