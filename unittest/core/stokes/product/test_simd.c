/* The packed product against the sum of the blocks of pairs (plain.h), for every instruction set that this machine
   runs. */
#include "scene.h"

#include <string.h>

static const sd_isa isas[] = {SD_ISA_BEST, SD_ISA_PLAIN, SD_ISA_BASELINE, SD_ISA_AVX2,
                              SD_ISA_AVX512};
static const double TOLERANCE = 1e-14; /* of the sum of the absolute contributions to a target */

static double size_of(const double v[3])
{
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Sum of what could reach target i, an upper bound of |U_i| (bound [0]) and |W_i| (bound [1]) term by term. */
static void reach(const scene *s, int m, int i, const double *F, double bound[2])
{
  bound[0] = bound[1] = 0.0;
  for (int j = 0; j < s->n && s->a[i] > 0.0; j++) {
    if (j == i || s->a[j] == 0.0) continue;
    double r[3];
    for (int d = 0; d < 3; d++) r[d] = s->x[3 * i + d] - s->x[3 * j + d];
    const double near = fmax(size_of(r), fmax(s->a[i], s->a[j]));
    const double c = s->w[i] * s->w[j] / (4.0 * SD_PI * near), force = size_of(F + m * j),
                 torque = m == 6 ? size_of(F + m * j + 3) : 0.0;
    bound[0] += c * (force + torque / near);
    bound[1] += c / near * (force + torque / near);
  }
}

static void compare(const scene *s, int m, const double *F, const double *u, const double *expected,
                    const char *what)
{
  for (int i = 0; i < s->n; i++) {
    double bound[2];
    reach(s, m, i, F, bound);
    for (int d = 0; d < m; d++) {
      const double off = fabs(u[m * i + d] - expected[m * i + d]);
      if (!(off <= TOLERANCE * bound[d / 3]))
        fail_msg("%s, sphere %d, component %d: off by %.2g of %.2g", what, i, d, off,
                 bound[d / 3]);
    }
  }
}

/* All laws, all instruction sets: all pairs, shares of them, and a list. m: 3, with torques 6 numbers a sphere. */
static void check_width(const scene *s, double range, int m)
{
  const size_t size = (size_t) m * (size_t) s->n;
  double *F = malloc(size * sizeof(double)), *u = malloc(size * sizeof(double)),
         *sum = malloc(size * sizeof(double)), *expected = malloc(size * sizeof(double));
  long *first = malloc(((size_t) s->n + 1) * sizeof(long));
  int *neighbor = malloc((size_t) s->n * (size_t) s->n * sizeof(int));
  long pairs = 0;
  for (int i = 0; i < s->n; i++) {
    first[i] = pairs;
    for (int j = 0; j < s->n; j++)
      if (j != i) neighbor[pairs++] = j;
  }
  first[s->n] = pairs;
  const sd_pairs list = {s->n, first, neighbor};
  const sd_spheres spheres = {s->x, s->a, s->w};
  uint64_t seed = 77;
  double largest = 0.0;
  for (int i = 0; i < s->n; i++) largest = fmax(largest, s->a[i]);
  for (size_t i = 0; i < size; i++)
    F[i] = uniform(&seed, -1, 1) * (i % m < 3 ? 1.0 : largest); /* torques in the scene's units */

  for (int taper = SD_TAPER_NONE; taper <= SD_TAPER_SPHERICAL; taper++) {
    const sd_law law = {.tensor = s->kind, .taper = taper, .range = range};
    plain_all(&law, &spheres, s->n, m, F, expected);
    for (size_t k = 0; k < sizeof(isas) / sizeof(isas[0]); k++) {
      char what[80];
      if (!sd_isa_supported(isas[k])) continue;
      snprintf(what, sizeof(what), "%s, width %d, tensor %d, taper %d", isa_name(isas[k]), m,
               s->kind, taper);
      sd_packed p = {0};
      assert_int_equal(sd_packed_all(&p, isas[k], &law, &spheres, s->n, m), SD_OK);
      for (int again = 0; again < 2; again++) { /* a second product finds nothing of the first */
        sd_packed_share(&p, 0, 1, F, u);
        compare(s, m, F, u, expected, what);
      }
      for (int parts = 2; parts <= 3; parts++) {
        memset(sum, 0, size * sizeof(double));
        for (int part = 0; part < parts; part++) {
          sd_packed_share(&p, part, parts, F, u);
          for (size_t i = 0; i < size; i++) sum[i] += u[i];
        }
        compare(s, m, F, sum, expected, what);
      }
      assert_int_equal(sd_packed_list(&p, isas[k], &law, &spheres, s->n, m), SD_OK);
      sd_packed_pairs(&p, &list, F, NULL, u);
      compare(s, m, F, u, expected, what);
      sd_packed_free(&p);
    }
  }
  free(neighbor);
  free(first);
  free(expected);
  free(sum);
  free(u);
  free(F);
}

static void check_scene(const scene *s, double range)
{
  check_width(s, range, 3);
  if (s->kind == SD_TENSOR_RPY) check_width(s, range, 6);
}

/* n spheres in a cube; radii spread over the ratio, two viscosities and more */
static scene cloud(int n, double side, double smallest, double largest, uint64_t seed)
{
  scene s = scene_create(n);
  for (int i = 0; i < n; i++)
    scene_set(&s, i, uniform(&seed, 0, side), uniform(&seed, 0, side), uniform(&seed, 0, side),
              exp(uniform(&seed, log(smallest), log(largest))), uniform(&seed, 0.3, 4.0));
  return s;
}

/* Numbers of spheres around whole vectors and chunks; far apart, overlapping, hidden. */
static void every_size_and_overlap(void **state)
{
  (void) state;
  const int sizes[] = {1, 2, 3, 7, 8, 9, 15, 16, 17, 63, 255, 256, 257, 300};
  for (size_t k = 0; k < sizeof(sizes) / sizeof(sizes[0]); k++)
    for (int dense = CHECK_SIZE(0, 1); dense < 2; dense++) {
      scene s = cloud(sizes[k], dense ? 4.0 : 60.0, 0.4, 1.6, 10 + k);
      for (int kind = SD_TENSOR_RPY; kind <= SD_TENSOR_OSEEN; kind++) {
        s.kind = kind;
        check_scene(&s, dense ? 3.0 : 40.0);
      }
      scene_free(&s);
    }
}

static void radii_of_one_to_a_thousand(void **state)
{
  (void) state;
  scene s = cloud(200, 300.0, 1.0, 1000.0, 5);
  check_scene(&s, 500.0);
  scene_free(&s);
}

/* Spheres without radius stand at the place of others and at zero: nobody feels them and they feel nothing. */
static void spheres_that_take_no_part(void **state)
{
  (void) state;
  scene s = cloud(150, 12.0, 0.3, 1.2, 6);
  for (int i = 0; i < s.n; i += 4) {
    s.a[i] = s.w[i] = 0.0;
    if (i % 8 == 0) memcpy(s.x + 3 * i, s.x + 3 * i + 3, 3 * sizeof(double));
  }
  check_scene(&s, 5.0);
  for (int i = 0; i < s.n; i++) s.a[i] = s.w[i] = 0.0;
  check_scene(&s, 5.0);
  scene_free(&s);
}

/* All at one point; pairs at one point; a small sphere in the middle of a large one; exact contact and one bit beside
   it. */
static void coincident_and_touching(void **state)
{
  (void) state;
  scene s = cloud(20, 1.0, 0.3, 1.2, 7);
  memset(s.x, 0, sizeof(double) * 3 * (size_t) s.n);
  check_scene(&s, 5.0);
  scene_free(&s);

  s = scene_lattice(4, 4, 4, 2.0, 0.7, 1.3);
  check_scene(&s, 5.0);
  scene_free(&s);

  s = cloud(40, 10.0, 0.3, 1.2, 8);
  for (int i = 0; i < s.n; i += 2) {
    const double contact = s.a[i] + s.a[i + 1], inside = fabs(s.a[i] - s.a[i + 1]);
    const double distance[] = {contact,
                               nextafter(contact, 0),
                               nextafter(contact, 9),
                               inside,
                               nextafter(inside, 0),
                               nextafter(inside, 9),
                               0.0,
                               1e-160,
                               1e-12 + contact};
    memcpy(s.x + 3 * i + 3, s.x + 3 * i, 3 * sizeof(double));
    s.x[3 * i + 3] = s.x[3 * i] + distance[i / 2 % 9];
  }
  check_scene(&s, 5.0);
  scene_free(&s);
}

/* Micrometres in metres, kilometres, and lengths beyond single precision's range, where plain C takes over. */
static void any_unit_of_length(void **state)
{
  (void) state;
  const double units[] = {1e-6, 1e3, 1e-30, 1e30, 1e-150, 1e120};
  for (size_t k = 0; k < sizeof(units) / sizeof(units[0]); k++) {
    scene s = cloud(60, 12.0, 0.3, 1.2, 9);
    for (int i = 0; i < s.n; i++) {
      s.a[i] *= units[k];
      for (int d = 0; d < 3; d++) s.x[3 * i + d] *= units[k];
    }
    check_width(&s, 5.0 * units[k], 3);
    if (fabs(log10(units[k])) < 100.0) check_width(&s, 5.0 * units[k], 6); /* 1/a^3 is a number */
    scene_free(&s);
  }
  scene s = cloud(30, 12.0, 0.3, 1.2, 9);
  s.x[0] = 1e17; /* beyond the range of the fast product */
  s.a[7] = 1e-16;
  check_scene(&s, 5.0);
  scene_free(&s);
}

static void not_a_number_comes_through(void **state)
{
  (void) state;
  scene s = cloud(30, 12.0, 0.3, 1.2, 9);
  const sd_spheres spheres = {s.x, s.a, s.w};
  const sd_law law = {.tensor = SD_TENSOR_RPY};
  double F[90], u[90];
  for (int bad = 0; bad < 2; bad++)
    for (size_t k = 0; k < sizeof(isas) / sizeof(isas[0]); k++) {
      if (!sd_isa_supported(isas[k])) continue;
      for (int i = 0; i < 90; i++) F[i] = 1.0;
      if (bad == 0)
        F[17] = NAN;
      else
        s.x[17] = NAN;
      sd_packed p = {0};
      assert_int_equal(sd_packed_all(&p, isas[k], &law, &spheres, s.n, 3), SD_OK);
      sd_packed_share(&p, 0, 1, F, u);
      assert_true(isnan(u[0]) && isnan(u[89]));
      sd_packed_free(&p);
    }
  scene_free(&s);
}

/* The matrix that the kernels stand for is symmetric: F.(Omega G) = G.(Omega F), to the rounding of the sums. */
static void the_product_is_symmetric(void **state)
{
  (void) state;
  scene s = cloud(256, 12.0, 0.3, 1.2, 11);
  const sd_spheres spheres = {s.x, s.a, s.w};
  const sd_law law = {.tensor = SD_TENSOR_RPY, .taper = SD_TAPER_WENDLAND, .range = 6.0};
  double F[768], G[768], uF[768], uG[768], one = 0.0, other = 0.0;
  uint64_t seed = 12;
  for (int i = 0; i < 768; i++) {
    F[i] = uniform(&seed, 0, 1);
    G[i] = uniform(&seed, 0, 1);
  }
  sd_packed p = {0};
  assert_int_equal(sd_packed_all(&p, SD_ISA_BEST, &law, &spheres, s.n, 3), SD_OK);
  sd_packed_share(&p, 0, 1, F, uF);
  sd_packed_share(&p, 0, 1, G, uG);
  for (int i = 0; i < 768; i++) {
    one += G[i] * uF[i];
    other += F[i] * uG[i];
  }
  CHECK_NEAR(one / other, 1.0, 1e-14);
  sd_packed_free(&p);
  scene_free(&s);
}

/* The closed forms, and where they end. */
static void tapers(void **state)
{
  (void) state;
  const sd_law none = {.tensor = SD_TENSOR_RPY},
               wendland = {.tensor = SD_TENSOR_RPY, .taper = SD_TAPER_WENDLAND, .range = 1.7},
               spherical = {.tensor = SD_TENSOR_RPY, .taper = SD_TAPER_SPHERICAL, .range = 1.7};
  CHECK_NEAR(sd_taper_factor(&none, 1e9), 1.0, 0.0);
  for (double q = 0.0; q <= 1.0; q += 0.125) {
    CHECK_NEAR(sd_taper_factor(&wendland, 1.7 * q), pow(1 - q, 4) * (1 + 4 * q), 1e-15);
    CHECK_NEAR(sd_taper_factor(&spherical, 1.7 * q), 1 - 1.5 * q + 0.5 * q * q * q, 1e-15);
  }
  CHECK_NEAR(sd_taper_factor(&wendland, 1.8), 0.0, 0.0);
  CHECK_NEAR(sd_taper_factor(&spherical, 1.8), 0.0, 0.0);
}

/* Touching 5^3 spheres, seen up to 6.1 radii: the plain cut-off leaves negative eigenvalues, Wendland's taper lifts all
 * of them above 0.358 of the diagonal (dense eigenvalues: +0.358). */
static void taper_keeps_the_matrix_positive_definite(void **state)
{
  (void) state;
  enum { N = 125 };
  scene s = scene_lattice(5, 5, 5, 2.0, 0.7, 1.3);
  const sd_spheres spheres = {s.x, s.a, s.w};
  double *M = malloc(sizeof(double) * 9 * N * N), *copy = malloc(sizeof(double) * 9 * N * N);
  double F[3 * N] = {0}, u[3 * N];
  for (int taper = SD_TAPER_NONE; taper <= SD_TAPER_SPHERICAL; taper++) {
    const sd_law law = {.tensor = SD_TENSOR_RPY, .taper = taper, .range = 6.1 * 0.7};
    sd_neighbors list = {0};
    assert_int_equal(sd_neighbors_cutoff(&list, s.x, N, N, law.range ? law.range : 1.0), SD_OK);
    sd_packed p = {0};
    assert_int_equal(sd_packed_list(&p, SD_ISA_BEST, &law, &spheres, N, 3), SD_OK);
    for (int k = 0; k < 3 * N; k++) {
      F[k] = 1.0;
      sd_packed_pairs(&p, &list.pairs, F, NULL, u);
      F[k] = 0.0;
      for (int i = 0; i < 3 * N; i++) M[3 * N * i + k] = s.drag[0] * u[i] + (i == k ? 1.0 : 0.0);
    }
    memcpy(copy, M, sizeof(double) * 9 * N * N);
    assert_int_equal(positive_definite(copy, 3 * N, 0.0), taper != SD_TAPER_NONE);
    if (taper == SD_TAPER_WENDLAND) {
      memcpy(copy, M, sizeof(double) * 9 * N * N);
      assert_true(positive_definite(copy, 3 * N, 0.357));
      assert_false(positive_definite(M, 3 * N, 0.359));
    }
    sd_packed_free(&p);
    sd_neighbors_free(&list);
  }
  free(copy);
  free(M);
  scene_free(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_size_and_overlap),
      cmocka_unit_test(radii_of_one_to_a_thousand),
      cmocka_unit_test(spheres_that_take_no_part),
      cmocka_unit_test(coincident_and_touching),
      cmocka_unit_test(any_unit_of_length),
      cmocka_unit_test(not_a_number_comes_through),
      cmocka_unit_test(the_product_is_symmetric),
      cmocka_unit_test(tapers),
      cmocka_unit_test(taper_keeps_the_matrix_positive_definite),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
