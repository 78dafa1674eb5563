/* Do particles fill space, and are walls as thick as the kernel: lattices of spacing 0.1, h of two spacings. */
#include "sd_sph_filling.h"
#include "sd_sph_order.h"
#include "sd_sph_probe.h"

#include "check.h"

#include <string.h>

enum { WIDE = 13, HIGH = 13, N = WIDE * HIGH };
static const double DX = 0.1;

/* Rows 0 .. HIGH - 1 upwards; the lowest ones are wall. All pairs in a half list. */
typedef struct {
  double x[3 * N], rho[N + 1], x4[4 * (N + 1)], rows[4 * (N + 1)], M[6 * (N + 1)];
  int phase[N + 1], first[N], count[N], flat[N * N], *neighbor[N];
  sd_sph_coefficients pair;
  sd_sph_model model;
  sd_sph_list list;
  sd_sph_particles p;
} lattice;

/* volume: of a particle, in units of its cell; begin .. floor - 1: the rows of wall that there are */
static void build(lattice *s, double volume, int begin, int floor)
{
  memset(s, 0, sizeof(*s));
  s->model = (sd_sph_model){.kernel = SD_SPH_WENDLAND, .dimension = 2, .nclasses = 1, .pair = &s->pair};
  s->pair = sd_sph_coefficients_of(&s->model, &(sd_sph_parameters){.h = 2.0 * DX, .c = 20.0});
  int *next = s->flat, n = 0;
  for (int k = 0; k < N; k++) {
    if (k / WIDE < begin) continue;
    s->x[3 * n] = DX * (k % WIDE);
    s->x[3 * n + 1] = DX * (k / WIDE);
    s->rho[n] = 1000.0;
    s->phase[n] = k / WIDE < floor ? -1 : 0;
    n++;
  }
  for (int i = 0; i < n; i++) {
    s->first[i] = i;
    s->neighbor[i] = next;
    s->count[i] = n - 1 - i;
    for (int j = i + 1; j < n; j++) *next++ = j;
  }
  s->list = (sd_sph_list){n, ~0, s->first, s->count, s->neighbor};
  s->p = (sd_sph_particles){.n = n, .x4 = s->x4, .mass = volume * 1000.0 * DX * DX, .phase = s->phase};
  sd_sph_pack_x(n, s->x, NULL, NULL, 0.0, s->x4);
  sd_sph_pack_volumes(&s->model, &s->p, s->rho, s->x4);
}

/* of the particle in the middle of a row; how many rows below it are missing */
static int middle(int row, int missing)
{
  return (row - missing) * WIDE + WIDE / 2;
}

static double filled(const lattice *s, int i)
{
  return sd_sph_filled(&s->model, &s->p, i, s->rows + 4 * i, s->M + 6 * i);
}

static void a_lattice_fills_space_by_its_volumes(void **state)
{
  (void) state;
  static lattice s;
  const double volumes[] = {1.0, 0.1, 2.0};
  for (int k = 0; k < 3; k++) {
    build(&s, volumes[k], 0, 0);
    sd_sph_surroundings(&s.model, &s.list, &s.p, s.rows);
    sd_sph_moments(&s.model, &s.list, &s.p, s.M);
    CHECK_NEAR(filled(&s, middle(HIGH / 2, 0)), volumes[k], 2e-3 * volumes[k]);
    assert_true(filled(&s, middle(HIGH - 1, 0)) == 0.0); /* at the surface */
    assert_true(filled(&s, 0) == 0.0);                   /* in the corner */
  }
}

/* One row of a sheet is filled by a third, and is no place inside a fluid; nor is the middle one of three. */
static void a_sheet_tells_nothing(void **state)
{
  (void) state;
  static lattice s;
  for (int rows = 1; rows <= 3; rows += 2) {
    build(&s, 1.0, HIGH - rows, 0);
    sd_sph_surroundings(&s.model, &s.list, &s.p, s.rows);
    sd_sph_moments(&s.model, &s.list, &s.p, s.M);
    CHECK_NEAR(s.rows[4 * middle(rows / 2, 0)], 0.0, 1e-12);
    assert_true(filled(&s, middle(rows / 2, 0)) == 0.0);
  }
}

/* The fluid stands on k rows of wall; the fourth row is at the end of the support. */
static void water_sees_past_one_or_two_rows(void **state)
{
  (void) state;
  static lattice s;
  for (int k = 1; k <= 5; k++) {
    build(&s, 1.0, 5 - k, 5);
    const int i = middle(5, 5 - k);
    sd_sph_toward_walls(&s.model, &s.list, &s.p, s.rows);
    CHECK_NEAR(s.rows[4 * i], 0.0, 1e-12);
    assert_true(s.rows[4 * i + 1] < 0.0);
    sd_sph_reach_of_walls(&s.model, &s.list, &s.p, s.rows);
    const double reach = s.rows[4 * i + 3];
    CHECK_NEAR(reach, DX * (k < 4 ? k : 3), 1e-12);
    assert_true(sd_sph_sees_past(&s.model, &s.p, i, reach) == (k < 3));
    assert_true(s.rows[4 * middle(9, 5 - k) + 3] == 0.0); /* out of its reach */
    assert_true(s.rows[4 * middle(4, 5 - k) + 3] == 0.0); /* of the wall itself */
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_lattice_fills_space_by_its_volumes),
      cmocka_unit_test(a_sheet_tells_nothing),
      cmocka_unit_test(water_sees_past_one_or_two_rows),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
