/* Films between spheres that are shells of points. */
#include "table.h"
#include "pair_blocks.h"

#include "sd_constants.h"
#include "sd_film_of.h"
#include "sd_film_table_internal.h"
#include "sd_linear.h"
#include "sd_two_sphere_exact.h"

static sd_two_sphere *functions;

static int create(void **state)
{
  (void) state;
  return sd_two_sphere_create(SD_FILM_LARGEST_RATIO, &functions) == SD_OK ? 0 : -1;
}

static int destroy(void **state)
{
  (void) state;
  sd_two_sphere_free(functions);
  return 0;
}

static sd_film film_at(int n, int one_body, double a1, double a2, double xi)
{
  sd_films films;
  sd_film film;
  assert_int_equal(sd_films_create(n, one_body, functions, &films), SD_OK);
  assert_int_equal(sd_film_at(&films, a1, a2, xi, &film), SD_OK);
  return film;
}

/* The exact functions of two spheres as they act on relative motion: film_pair.csv has seven or
 * eight digits. */
static void exact_part(void **state)
{
  (void) state;
  table t = table_open("multiblob/film_pair.csv");
  while (table_next(&t)) {
    const double a2 = table_number(&t, 0), xi = table_number(&t, 1),
                 R = (1.0 + a2) * (1.0 + 0.5 * xi);
    const sd_pair_resistance exact = sd_two_sphere_exact(1.0, a2, 0.5 * xi * (1.0 + a2), NULL);
    const sd_film film = sd_film_of(&exact, 1.0, a2, R);
    const double numbers[5] = {film.A_n, film.A_t, film.B[0], film.B[1], film.B[2]};
    for (int k = 0; k < 5; k++) {
      const double known = table_number(&t, 2 + k);
      CHECK_NEAR(numbers[k], known, 1e-6 * fabs(known) + 1e-7);
    }
  }
}

/* What is left of the exact part is the mean shell: that of film_pair.csv, which has other
 * orientations, within 0.3 % of the shell's, or of the geometric mean of B11 and B22. Where it
 * is stiffer than the spheres the film is clipped. */
static void mean_shells(void **state)
{
  (void) state;
  table t = table_open("multiblob/film_pair.csv");
  double worst = 0.0;
  while (table_next(&t)) {
    const double a2 = table_number(&t, 0), xi = table_number(&t, 1);
    for (int plain = 0; plain < 2; plain++) {
      const sd_film film = film_at(12, !plain, 1.0, a2, xi);
      const double numbers[5] = {film.A_n, film.A_t, film.B[0], film.B[1], film.B[2]};
      for (int k = 0; k < 5; k++) {
        const double exact = table_number(&t, 2 + k),
                     shell = table_number(&t, (plain ? 12 : 7) + k);
        const double scale = k == 3 ? sqrt(table_number(&t, 9) * table_number(&t, 11))
                                    : fabs(shell);
        const double off = fabs(numbers[k] - fmax(exact - shell, k == 3 ? -1e9 : 0.0)) / scale;
        if (off > 3e-3)
          fail_msg("ratio %g, xi %g, plain %d, number %d: off by %.2g of the shell's", a2, xi,
                   plain, k, off);
        worst = fmax(worst, off);
      }
    }
  }
  print_message("mean shells: largest difference %.2g\n", worst);
}

/* --- shells by radius --- */

static sd_films by_radius(int one_body)
{
  sd_films films;
  assert_int_equal(sd_films_create_by_radius(one_body, functions, &films), SD_OK);
  return films;
}

/* Two of 12 points are what they are among spheres that are all alike, and those are read so as well. */
static void twelve_with_twelve(void **state)
{
  (void) state;
  const sd_films radius = by_radius(1);
  sd_films alike;
  assert_int_equal(sd_films_create(42, 0, functions, &alike), SD_OK);
  for (double ratio = 1.0; ratio < 1.5; ratio += 0.23) {
    const sd_film known = film_at(12, 1, 1.0, ratio, 0.03), other = film_at(42, 0, 1.0, ratio, 0.03);
    sd_film film;
    assert_int_equal(sd_film_between(&radius, 12, 12, 1.0, ratio, 0.03, &film), SD_OK);
    assert_memory_equal(&film, &known, sizeof film);
    assert_int_equal(sd_film_between(&alike, 12, 162, 1.0, ratio, 0.03, &film), SD_OK);
    assert_memory_equal(&film, &other, sizeof film);
  }
}

/* A film of every kind of shells, at ratios over all of its range: by number, in 0 to 1, and xi_h */
static sd_film some_film(const sd_films *films, int number, double t, double harmonic, int exchanged)
{
  const sd_film_kind *kind = sd_film_kinds + number;
  const double ratio = kind->lowest * pow(kind->highest / kind->lowest, t), a = 1.0 / ratio,
               xi = harmonic * sd_film_harmonic(1.0, a);
  sd_film film;
  const sd_status status = exchanged
      ? sd_film_between(films, kind->large, kind->small, 1.0, a, xi, &film)
      : sd_film_between(films, kind->small, kind->large, a, 1.0, xi, &film);
  assert_int_equal(status, SD_OK);
  return film;
}

/* Nothing is negative. Near contact the film has the exact one's leading term within 2 %. Far away, at ratios
 * for which points go with the radius, shells with the addition know all that two spheres do: at one harmonic
 * mean the film is 1 % at most, at 1.5 it is 0.2 %, of 6 pi a1 a2/(a1 + a2) for the approach and of 8 pi
 * a1^1.5 a2^1.5 for the turns. */
static void half_shells(void **state)
{
  (void) state;
  static const double rule[SD_FILM_HALF_KINDS] = {2.5, 5, 10, 5.0 / 3, 10.0 / 3, 20.0 / 3, 2, 4, 2};
  double far[2] = {0.0};
  for (int with = 0; with < 2; with++) {
    const sd_films films = by_radius(with);
    for (int number = 0; number < SD_FILM_HALF_KINDS; number++)
      for (double t = 0.0; t < 1.01; t += 0.1)
        for (double xi = 1e-6; xi < 2.0; xi *= 1.5) {
          const sd_film film = some_film(&films, number, t, xi, 0);
          const sd_film_kind *kind = sd_film_kinds + number;
          const double a = pow(kind->lowest / kind->highest, t) / kind->lowest, h = a / (1.0 + a);
          const double b1 = film.B[0] / pow(a, 3), b2 = film.B[2];
          assert_true(film.A_n >= 0.0 && film.A_t >= 0.0 && b1 >= 0.0 && b2 >= 0.0);
          assert_true(b1 * b2 - film.B[1] * film.B[1] / pow(a, 3) >= -1e-14 * (b1 + b2) * (b1 + b2)); /* rounding */
          if (xi < 2e-6) CHECK_NEAR(film.A_n * xi * 2.0 * h / (6.0 * SD_PI * h * h), 1.0, 2e-2);
          const double worst = fmax(film.A_n / (6.0 * SD_PI * h), fabs(film.B[1]) / (8.0 * SD_PI * pow(a, 1.5)));
          if (!with || a * rule[number] < 1.0) continue;
          if (xi > 1.0) far[0] = fmax(far[0], worst);
          if (xi > 1.5) far[1] = fmax(far[1], worst);
        }
  }
  print_message("half shells: film beyond 1, 1.5 harmonic means %.2g %.2g\n", far[0], far[1]);
  CHECK_NEAR(far[0], 0.0, 1e-2);
  CHECK_NEAR(far[1], 0.0, 2e-3);
}

/* Which sphere is the first does not matter, nor the unit of length; two equal ones are alike. */
static void either_half_shell_first(void **state)
{
  (void) state;
  const sd_films films = by_radius(1);
  for (int number = 0; number < SD_FILM_HALF_KINDS; number++) {
    const sd_film one = some_film(&films, number, 0.4, 0.02, 0), two = some_film(&films, number, 0.4, 0.02, 1);
    assert_true(one.A_n == two.A_n && one.A_t == two.A_t && one.B[0] == two.B[2] && one.B[1] == two.B[1] &&
                one.B[2] == two.B[0]);
  }
  sd_film equal, large;
  assert_int_equal(sd_film_between(&films, 162, 162, 1.0, 1.0, 0.1, &equal), SD_OK);
  assert_true(equal.B[0] == equal.B[2]);
  assert_int_equal(sd_film_between(&films, 162, 162, 3.0, 3.0, 0.1, &large), SD_OK);
  CHECK_NEAR(large.A_n / equal.A_n, 3.0, 1e-12);
  CHECK_NEAR(large.B[1] / equal.B[1], 27.0, 1e-11);
}

/* No means: the larger sphere has fewer points, or a ratio, gap or number that no table has */
static void outside_of_half_shells(void **state)
{
  (void) state;
  const sd_films films = by_radius(1);
  sd_film film;
  assert_int_equal(sd_film_between(&films, 42, 12, 1.0, 2.0, 0.1, &film), SD_EOUTSIDE);
  assert_int_equal(sd_film_between(&films, 12, 162, 1.0, 1.2, 0.1, &film), SD_EOUTSIDE);
  assert_int_equal(sd_film_between(&films, 642, 642, 1.0, 2.1, 0.1, &film), SD_EOUTSIDE);
  assert_int_equal(sd_film_between(&films, 12, 92, 1.0, 2.0, 0.1, &film), SD_EOUTSIDE);
  assert_int_equal(sd_film_between(&films, 12, 642, 1.0, 9.0, 0.75, &film), SD_EOUTSIDE);
  assert_int_equal(sd_film_between(&films, 12, 642, 1.0, 9.0, 0.71, &film), SD_OK);
}

/* Forces are opposite and no torque is left; a rigid motion of the pair is not resisted: nor by
 * a film of unequal spheres. */
static void rigid_motion_is_free(void **state)
{
  (void) state;
  uint64_t seed = 4;
  for (int trial = 0; trial < 50; trial++) {
    const double a1 = exp(uniform(&seed, 0.0, log(9.9))), a2 = 1.0,
                 xi = exp(uniform(&seed, log(1e-4), log(2.0)));
    const double distance = (a1 + a2) * (1.0 + 0.5 * xi);
    double d[3], B[3][36], V[12], f[12] = {0.0}, size = 0.0, arm[3], U[3], W[3];
    for (int e = 0; e < 3; e++)
      d[e] = uniform(&seed, -1, 1), U[e] = uniform(&seed, -1, 1), W[e] = uniform(&seed, -1, 1);
    sd_normalize(d);
    const sd_film film = film_at(trial % 2 ? 12 : 42, trial % 3 != 0, a1, a2, xi);
    const sd_pair_resistance R = sd_film_resistance(&film, distance, 1.3);
    pair_blocks(&R, d, B[0], B[1], B[2]);
    for (int rigid = 0; rigid < 2; rigid++) {
      for (int e = 0; e < 12; e++) V[e] = uniform(&seed, -1, 1);
      if (rigid)
        for (int e = 0; e < 3; e++) arm[e] = distance * d[e];
      if (rigid) {
        double turn[3];
        sd_cross(W, arm, turn);
        for (int e = 0; e < 3; e++)
          V[e] = U[e], V[6 + e] = U[e] + turn[e], V[3 + e] = V[9 + e] = W[e];
      }
      for (int p = 0; p < 6; p++) {
        f[p] = f[6 + p] = 0.0;
        for (int q = 0; q < 6; q++) {
          f[p] += B[0][6 * p + q] * V[q] + B[1][6 * p + q] * V[6 + q];
          f[6 + p] += B[1][6 * q + p] * V[q] + B[2][6 * p + q] * V[6 + q];
        }
      }
      if (!rigid) size = 0.0;
      for (int p = 0; p < 12; p++) {
        if (rigid)
          CHECK_NEAR(f[p] / size, 0.0, 1e-12);
        else
          size = fmax(size, fabs(f[p]));
      }
      double couple[3];
      for (int e = 0; e < 3; e++) arm[e] = distance * d[e];
      sd_cross(arm, f + 6, couple);
      for (int e = 0; e < 3; e++) {
        CHECK_NEAR((f[e] + f[6 + e]) / size, 0.0, 1e-12);
        CHECK_NEAR((f[3 + e] + f[9 + e] + couple[e]) / (size * distance), 0.0, 1e-12);
      }
    }
  }
}

/* Nothing is negative, at any gap and ratio; close to contact the film is the exact one's
 * leading term, 3 pi/2 of the reduced radius squared over the gap, within 1 %. */
static void definite_and_singular(void **state)
{
  (void) state;
  for (int n = 12; n <= 42; n += 30)
    for (double ratio = 1.0; ratio < 10.0; ratio *= 1.23)
      for (double xi = 1e-6; xi < 2.0; xi *= 1.17) {
        const sd_film film = film_at(n, 1, 1.0, ratio, xi);
        assert_true(film.A_n >= 0.0 && film.A_t >= 0.0 && film.B[0] >= 0.0 && film.B[2] >= 0.0);
        const double det = film.B[0] * film.B[2] - film.B[1] * film.B[1];
        assert_true(det >= -1e-12 * film.B[0] * film.B[2]);
        if (xi < 1e-5) {
          const double h = ratio / (1.0 + ratio);
          CHECK_NEAR(film.A_n * 0.5 * xi * (1.0 + ratio) / (6.0 * SD_PI * h * h), 1.0, 1e-2);
        }
      }
}

/* The first sphere is the second one of the pair turned round. */
static void either_sphere_first(void **state)
{
  (void) state;
  const sd_film one = film_at(12, 1, 1.0, 3.7, 0.02), two = film_at(12, 1, 3.7, 1.0, 0.02),
                large = film_at(12, 1, 2.0, 7.4, 0.02);
  assert_true(one.A_n == two.A_n && one.A_t == two.A_t && one.B[0] == two.B[2] &&
              one.B[1] == two.B[1]);
  CHECK_NEAR(large.A_n / one.A_n, 2.0, 1e-12);
  CHECK_NEAR(large.B[1] / one.B[1], 8.0, 1e-12);
  const sd_film equal = film_at(42, 1, 1.0, 1.0, 0.02);
  CHECK_NEAR(equal.B[0] / equal.B[2], 1.0, 1e-14);
}

/* Equal spheres have a table of their own: they are the limit of others within 4e-8 Stokes drags up to a gap of one
 * radius, towards the largest gap, where the means of shells vary, within 2e-6. */
static void equal_spheres_are_the_limit(void **state)
{
  (void) state;
  for (int kind = 0; kind < 4; kind++)
    for (double xi = 1.001e-8; xi < 2.0; xi *= 1.0137) {
      const int n = kind < 2 ? 12 : 42;
      const sd_film one = film_at(n, kind % 2, 1.0, 1.0, xi), other = film_at(n, kind % 2, 1.0, 1.0 + 2e-13, xi);
      const double tolerance = xi < 1.0 ? 4e-8 : 2e-6, drag = 6.0 * SD_PI, spin = 8.0 * SD_PI;
      CHECK_NEAR(one.A_n, other.A_n, tolerance * fmax(drag, one.A_n));
      CHECK_NEAR(one.A_t, other.A_t, tolerance * spin);
      CHECK_NEAR(one.B[1], other.B[1], tolerance * spin);
      CHECK_NEAR(one.B[0], 0.5 * (other.B[0] + other.B[2]), tolerance * spin);
      CHECK_NEAR(one.shells_approach, other.shells_approach, tolerance * drag);
      assert_true(one.B[0] == one.B[2]);
    }
}

static void outside(void **state)
{
  (void) state;
  sd_films films;
  sd_film film;
  assert_int_equal(sd_films_create(32, 1, functions, &films), SD_EOUTSIDE);
  assert_int_equal(sd_films_create(12, 1, functions, &films), SD_OK);
  assert_int_equal(sd_film_at(&films, 1.0, 10.1, 0.1, &film), SD_EOUTSIDE);
  assert_int_equal(sd_film_at(&films, 1.0, 1.0, 2.1, &film), SD_EOUTSIDE);
  assert_int_equal(sd_film_at(&films, 1.0, 1.0, 0.0, &film), SD_EOUTSIDE);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(exact_part),           cmocka_unit_test(mean_shells),
      cmocka_unit_test(rigid_motion_is_free), cmocka_unit_test(definite_and_singular),
      cmocka_unit_test(either_sphere_first),  cmocka_unit_test(outside),
      cmocka_unit_test(twelve_with_twelve),   cmocka_unit_test(half_shells),
      cmocka_unit_test(either_half_shell_first), cmocka_unit_test(outside_of_half_shells),
      cmocka_unit_test(equal_spheres_are_the_limit),
  };
  return cmocka_run_group_tests(tests, create, destroy);
}
