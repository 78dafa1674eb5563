/* Products of all pairs in floats against those in doubles: the same digits to the tolerance wherever the spheres are,
 * a matrix that is as symmetric as its blocks, and solves of hardly more products. */
#include <float.h>
#include <string.h>

#include "clouds.h"

enum { MOST = 1100 };

static const sd_isa sets[] = {SD_ISA_PLAIN, SD_ISA_BASELINE, SD_ISA_AVX2, SD_ISA_AVX512};
static const sd_law RPY = {.tensor = SD_TENSOR_RPY};

typedef struct {
  double F[6 * MOST], single[6 * MOST], exact[6 * MOST];
} numbers;

/* Radii from 1 to `ratio` at volume fraction phi, in two viscosities and more */
static scene cloud(int n, double phi, double ratio, uint64_t seed)
{
  scene s = scene_create(n);
  double volume = 0.0;
  for (int i = 0; i < n; i++) {
    s.a[i] = i == 0 ? ratio : exp(uniform(&seed, 0.0, log(ratio) + 1e-300));
    volume += 4.0 / 3.0 * SD_PI * pow(s.a[i], 3);
  }
  const double side = cbrt(volume / phi);
  for (int i = 0; i < n; i++)
    scene_set(&s, i, uniform(&seed, 0, side), uniform(&seed, 0, side), uniform(&seed, 0, side), s.a[i],
              uniform(&seed, 0.3, 4.0));
  return s;
}

static void random_forces(const scene *s, int m, uint64_t seed, double *F)
{
  for (int i = 0; i < m * s->n; i++) F[i] = uniform(&seed, -1, 1) * pow(s->a[i / m], i % m < 3 ? 1 : 2);
}

typedef sd_status pack(sd_packed *, sd_isa, const sd_law *, const sd_spheres *, int, int);

/* The product in so many shares */
static void product(pack *packing, sd_isa isa, const sd_law *law, const scene *s, int m, int parts, const double *F,
                    double *u)
{
  const sd_spheres spheres = {s->x, s->a, s->w};
  static double share[6 * MOST];
  sd_packed p = {0};
  assert_int_equal(packing(&p, isa, law, &spheres, s->n, m), SD_OK);
  for (int i = 0; i < m * s->n; i++) u[i] = 0.0;
  for (int part = 0; part < parts; part++) {
    sd_packed_share(&p, part, parts, F, share);
    for (int i = 0; i < m * s->n; i++) u[i] += share[i];
  }
  sd_packed_free(&p);
}

/* Times lengths, over velocities of spheres alone, in rms; spheres without a radius have no velocity. */
static double difference(const scene *s, int m, const double *F, const double *u, const double *v)
{
  double off = 0.0, bare = 0.0;
  for (int i = 0; i < m * s->n; i++) {
    const double a = s->a[i / m], w = s->w[i / m], length = i % m < 3 ? 1.0 : a;
    if (!(a > 0.0)) {
      assert_true(u[i] == 0.0);
      continue;
    }
    const double own = i % m < 3 ? 6.0 * SD_PI * a : 8.0 * SD_PI * a * a * a;
    off += pow(length * (u[i] - v[i]), 2);
    bare += pow(length * w * w * F[i] / own, 2);
  }
  return bare > 0.0 ? sqrt(off / bare) : 0.0;
}

/* floats: are they taken? */
static void check_law(const scene *s, const sd_law *law, int m, int floats)
{
  static numbers k;
  random_forces(s, m, 7, k.F);
  for (size_t set = 0; set < sizeof(sets) / sizeof(sets[0]); set++) {
    if (!sd_isa_supported(sets[set])) continue;
    product(sd_packed_all, sets[set], law, s, m, 1, k.F, k.exact);
    for (int parts = 1; parts <= 3; parts++) {
      product(sd_packed_all_single, sets[set], law, s, m, parts, k.F, k.single);
      for (int i = 0; i < m * s->n; i++) assert_true(isfinite(k.single[i]));
      const double off = difference(s, m, k.F, k.single, k.exact);
      if (getenv("STOKESDYN_SHOW"))
        printf("%s, %d spheres, width %d, taper %d: %.1e\n", isa_name(sets[set]), s->n, m, law->taper, off);
      assert_true(off <= 0.15 * SD_PRODUCT_SINGLE);
      if (s->n > 2 && parts == 1 && law->taper == SD_TAPER_NONE)
        assert_int_equal(off > 0.0, floats);
    }
  }
}

/* Tapers as far as half of the scene, and some radii where all stand at one place. What they do in a vector has no
 * part in where vectors are: with sanitizers small scenes have them. */
static void check_scene(const scene *s, int floats)
{
  double across = 10.0;
  for (int i = 0; i < 3 * s->n; i++) across = fmax(across, s->x[i] - s->x[i % 3]);
  const int last = CHECK_SIZE(SD_TAPER_SPHERICAL, s->n < 100 ? SD_TAPER_SPHERICAL : SD_TAPER_NONE);
  for (int m = 3; m <= 6; m += 3)
    for (int taper = SD_TAPER_NONE; taper <= last; taper++)
      check_law(s, &(sd_law){.tensor = SD_TENSOR_RPY, .taper = taper, .range = 0.5 * across}, m, floats);
}

/* Numbers of spheres around whole vectors, chunks and what is held of their sums */
static void every_size_and_overlap(void **state)
{
  (void) state;
  const int sizes[] = {1, 2, 3, 15, 16, 17, 33, 63, 65, 255, 257, 511, 513, 700};
  for (size_t k = 0; k < sizeof(sizes) / sizeof(sizes[0]); k++) {
    scene s = cloud(sizes[k], k % 2 ? 0.8 : 0.1, 1.0 + (k % 3), 10 + k);
    check_scene(&s, 1);
    scene_free(&s);
  }
}

static void radii_of_one_to_a_hundred(void **state)
{
  (void) state;
  scene s = cloud(200, 0.2, 100.0, 5);
  for (int d = 0; d < 3; d++) s.x[6 + d] = s.x[3 + d] + (d == 0) * (s.a[1] + s.a[2]); /* two in touch */
  check_scene(&s, 1);
  scene_free(&s);
}

/* All at one point, pairs at one point, in touch, one inside another, and spheres that take no part */
static void one_place_for_two(void **state)
{
  (void) state;
  scene s = cloud(80, 0.1, 3.0, 6);
  for (int i = 0; i < 80; i += 2) {
    const double sum = s.a[i] + s.a[i + 1], less = fabs(s.a[i] - s.a[i + 1]);
    const double distance[] = {0.0, sum, nextafter(sum, 0.0), less, 0.5 * less, 1e-9};
    memcpy(s.x + 3 * i + 3, s.x + 3 * i, 3 * sizeof(double));
    s.x[3 * i + 3] += distance[i / 2 % 6];
  }
  check_scene(&s, 1);
  for (int i = 0; i < 80; i += 5) s.a[i] = s.w[i] = 0.0;
  s.x[0] = 1e9; /* who takes no part may be anywhere */
  check_scene(&s, 1);
  for (int i = 0; i < 80; i++) memset(s.x + 3 * i, 0, 3 * sizeof(double));
  check_scene(&s, 1);
  for (int i = 0; i < 80; i++) s.a[i] = 0.0;
  check_scene(&s, 0);
  scene_free(&s);
}

/* Floats alone would know no distance below 8 radii there. */
static void far_from_the_origin(void **state)
{
  (void) state;
  scene s = cloud(300, 0.2, 1.0, 8);
  for (int i = 0; i < 3 * s.n; i++) s.x[i] += 1e8;
  check_scene(&s, 1);
  scene_free(&s);
}

/* Where floats would not know the gap of a pair in touch, doubles go on, and bits are theirs. */
static void a_huge_box(void **state)
{
  (void) state;
  scene s = cloud(20, 1e-17, 1.0, 9);
  for (int d = 0; d < 3; d++) s.x[3 + d] = s.x[d] + 2.0 * (d == 1);
  check_scene(&s, 0);
  scene_free(&s);
  s = cloud(20, 2e-9, 1.0, 9); /* 3500 radii */
  for (int d = 0; d < 3; d++) s.x[3 + d] = s.x[d] + 2.0 * (d == 1);
  check_scene(&s, 1);
  scene_free(&s);
}

static void any_unit_of_length_and_force(void **state)
{
  (void) state;
  static numbers k;
  for (int m = 3; m <= 6; m += 3)
    for (int unit = -30; unit <= 30; unit += 10) {
      scene s = cloud(100, 0.2, 2.0, 12);
      const double length = pow(10.0, unit / 5), power[] = {-290, -45, -9, 9, 45, 290};
      for (int i = 0; i < s.n; i++) {
        s.a[i] *= length;
        for (int d = 0; d < 3; d++) s.x[3 * i + d] *= length;
      }
      for (size_t p = 0; p < sizeof(power) / sizeof(power[0]); p++) {
        random_forces(&s, m, 3, k.F);
        for (int i = 0; i < m * s.n; i++) k.F[i] *= pow(10.0, power[p]);
        product(sd_packed_all, SD_ISA_BEST, &RPY, &s, m, 1, k.F, k.exact);
        product(sd_packed_all_single, SD_ISA_BEST, &RPY, &s, m, 1, k.F, k.single);
        for (int i = 0; i < m * s.n; i++) { /* squares must be numbers */
          k.F[i] /= pow(10.0, power[p]);
          k.exact[i] /= pow(10.0, power[p]);
          k.single[i] /= pow(10.0, power[p]);
        }
        assert_true(difference(&s, m, k.F, k.single, k.exact) < 1e-6);
      }
      scene_free(&s);
    }
}

static void not_a_number_comes_through(void **state)
{
  (void) state;
  static numbers k;
  scene s = cloud(40, 0.2, 1.0, 13);
  random_forces(&s, 3, 3, k.F);
  k.F[17] = NAN;
  product(sd_packed_all_single, SD_ISA_BEST, &RPY, &s, 3, 1, k.F, k.single);
  assert_true(isnan(k.single[0]) && isnan(k.single[119]));
  random_forces(&s, 3, 3, k.F);
  s.x[17] = NAN;
  product(sd_packed_all_single, SD_ISA_BEST, &RPY, &s, 3, 1, k.F, k.single);
  assert_true(isnan(k.single[0]) && isnan(k.single[119]));
  scene_free(&s);
}

/* Column by column: a pair's block and its transpose differ by the rounding of three products alone, also of pairs
 * within one vector, which are computed twice. The block itself is farther from that of doubles. */
static void blocks_are_those_of_both_spheres(void **state)
{
  (void) state;
  enum { N = 40 };
  for (int m = 3; m <= 6; m += 3) {
    scene s = cloud(N, 0.5, 2.0, 14);
    const int all = m * N;
    double *M = calloc((size_t) (all * all), sizeof(double)), F[6 * N] = {0};
    for (int c = 0; c < all; c++) {
      F[c] = 1.0;
      product(sd_packed_all_single, SD_ISA_BEST, &RPY, &s, m, 1, F, M + c * all);
      F[c] = 0.0;
    }
    for (int r = 0; r < all; r++)
      for (int c = 0; c < r; c++) {
        double block = 0.0;
        for (int k = 0; k < m * m; k++) {
          const int row = r / m * m + k / m, column = c / m * m + k % m;
          if (row % m / 3 == r % m / 3 && column % m / 3 == c % m / 3)
            block = fmax(block, fabs(M[column * all + row]));
        }
        CHECK_NEAR(M[c * all + r], M[r * all + c], 4.0 * FLT_EPSILON * block);
      }
    free(M);
    scene_free(&s);
  }
}

/* Many terms of one sign: sums over spheres go on in doubles. What one group of targets adds in floats
 * leaves 2e-8 to 2e-7, by the width of the vectors. */
static void all_forces_along(void **state)
{
  (void) state;
  static numbers k;
  scene s = cloud(MOST, 0.05, 1.0, 15);
  for (int i = 0; i < s.n; i++)
    for (int d = 0; d < 3; d++) k.F[3 * i + d] = 1.0;
  product(sd_packed_all, SD_ISA_BEST, &RPY, &s, 3, 1, k.F, k.exact);
  product(sd_packed_all_single, SD_ISA_BEST, &RPY, &s, 3, 1, k.F, k.single);
  double off = 0.0, size = 0.0;
  for (int i = 0; i < 3 * s.n; i++) {
    off += pow(k.single[i] - k.exact[i], 2);
    size += pow(k.exact[i], 2);
  }
  if (getenv("STOKESDYN_SHOW")) printf("forces along: %.1e\n", sqrt(off / size));
  assert_true(sqrt(off / size) < 2.0 * FLT_EPSILON);
  scene_free(&s);
}

/* Products of a solve, of floats or of doubles; forces to the caller */
static int solve(scene *s, pack *packing, double tolerance, const double *slip, double **F)
{
  const sd_spheres spheres = {s->x, s->a, s->w};
  sd_status status;
  sd_solve_report report;
  s->fast = 1;
  s->products = 0;
  assert_int_equal(packing(&s->packed, SD_ISA_BEST, &RPY, &spheres, s->n, 3), SD_OK);
  *F = scene_solve(s, sd_solve_gradients, slip, tolerance, 300, &status, &report);
  assert_int_equal(status, SD_OK);
  return s->products;
}

/* Conjugate gradients lose the conjugacy of their directions to rounding as soon as the largest eigenvalues have
 * converged, and then find these once more (Paige; Greenbaum, Iterative Methods, chapter 4): in floats that is so early
 * that it costs products. */
static void solves_take_a_few_more_products(void **state)
{
  (void) state;
  scene scenes[] = {scene_lattice(6, 6, 6, 2.0, 0.7, 1.3), cloud_dense(300, 0.45, 1.0, 1.0, 1.3, 3),
                    cloud_flocs(10, 20, 1.5, 60.0, 0, 1.3, 4)};
  for (int k = 0; k < 3; k++) {
    scene *s = scenes + k;
    double *slip = malloc(3 * sizeof(double) * (size_t) s->n);
    uint64_t seed = 5;
    for (int i = 0; i < 3 * s->n; i++) slip[i] = uniform(&seed, -1, 1);
    for (int digits = 1; digits <= 4; digits++) {
      double *F, *G, off = 0.0, size = 0.0;
      const int doubles = solve(s, sd_packed_all, pow(10.0, -digits), slip, &F);
      const int floats = solve(s, sd_packed_all_single, pow(10.0, -digits), slip, &G);
      for (int i = 0; i < 3 * s->n; i++) {
        off += pow(F[i] - G[i], 2);
        size += pow(F[i], 2);
      }
      if (getenv("STOKESDYN_SHOW"))
        printf("scene %d, 1e-%d: %d products in doubles, %d in floats, forces differ by %.1e\n", k, digits, doubles,
               floats, sqrt(off / size));
      assert_true(floats <= 1.25 * doubles + 1.0);
      free(F);
      free(G);
    }
    free(slip);
    scene_free(s);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_size_and_overlap),
      cmocka_unit_test(radii_of_one_to_a_hundred),
      cmocka_unit_test(one_place_for_two),
      cmocka_unit_test(far_from_the_origin),
      cmocka_unit_test(a_huge_box),
      cmocka_unit_test(any_unit_of_length_and_force),
      cmocka_unit_test(not_a_number_comes_through),
      cmocka_unit_test(blocks_are_those_of_both_spheres),
      cmocka_unit_test(all_forces_along),
      cmocka_unit_test(solves_take_a_few_more_products),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
