/* Sums of floats against those of doubles: the same digits to the tolerance wherever the spheres are, and a matrix as
 * symmetric as a solve needs. */
#include "periodic.h"

enum { MOST = 300 };

typedef struct {
  int n;
  double x[3 * MOST], a[MOST];
  sd_ewald_box box;
} scene;

static scene cloud(uint64_t seed, int n, double phi, double ratio)
{
  scene s = {.n = n, .box = {.periodic = 1, .origin = {1, -2, 3}}};
  double V = 0.0;
  for (int i = 0; i < n; i++) {
    s.a[i] = i == 0 ? ratio : exp(uniform(&seed, 0.0, log(ratio) + 1e-300));
    V += 4.0 / 3.0 * SD_PI * pow(s.a[i], 3) / phi;
  }
  for (int d = 0; d < 3; d++) s.box.edge[d] = cbrt(V);
  for (int i = 0; i < 3 * n; i++) s.x[i] = s.box.origin[i % 3] + uniform(&seed, 0, 1) * s.box.edge[i % 3];
  return s;
}

static void forces(const scene *s, int width, uint64_t seed, double *F)
{
  for (int i = 0; i < s->n; i++)
    for (int d = 0; d < width; d++) F[width * i + d] = uniform(&seed, -1, 1) * pow(s->a[i], d < 3 ? 1 : 2);
}

/* The product of a scene at a tolerance, of the numbers that the rule chooses or of doubles */
static void product(const scene *s, int width, double tolerance, int single, const double *F, double *u)
{
  sd_ewald how = periodic_choose(&s->box, s->a, s->n, width, tolerance);
  if (!single) how.single = 0;
  periodic p;
  periodic_place(&p, s->x, s->a, NULL, s->n, width, &how);
  periodic_apply(&p, F, u);
  periodic_free(&p);
}

/* Lengths times velocities, over those of a sphere alone, in rms; spins times radii */
static double difference(const scene *s, int width, const double *F, const double *u, const double *v)
{
  double off = 0.0, bare = 0.0;
  for (int i = 0; i < width * s->n; i++) {
    const double a = s->a[i / width], length = i % width < 3 ? 1.0 : a;
    const double own = i % width < 3 ? 6.0 * SD_PI * a : 8.0 * SD_PI * a * a * a;
    off += pow(length * (u[i] - v[i]), 2);
    bare += pow(length * F[i] / own, 2);
  }
  return sqrt(off / bare);
}

/* Do floats hold what equal forces make of an open box, where they lose 4e-7 of some N a/L? */
static int hold_common_flow(const scene *s, double tolerance)
{
  double squares = 0.0;
  for (int i = 0; i < s->n; i++) squares += s->a[i] * s->a[i] / s->n;
  return s->box.periodic || 4e-7 * s->n * sqrt(squares) / cbrt(sd_ewald_volume(&s->box)) <= 0.5 * tolerance;
}

/* Far below the tolerance; single: does the rule choose floats? */
static void same_digits_in_box(const scene *s, int single)
{
  for (int width = 3; width <= 6; width += 3)
    for (int digits = 2; digits <= 5; digits += CHECK_SIZE(1, 3)) {
      const double tolerance = pow(10.0, -digits);
      double F[6 * MOST], u[6 * MOST], v[6 * MOST];
      forces(s, width, 7, F);
      const int floats = single && hold_common_flow(s, tolerance);
      assert_int_equal(periodic_choose(&s->box, s->a, s->n, width, tolerance).single, floats);
      product(s, width, tolerance, 1, F, u);
      product(s, width, tolerance, 0, F, v);
      for (int i = 0; i < width * s->n; i++) assert_true(isfinite(u[i]));
      const double off = difference(s, width, F, u, v);
      if (getenv("STOKESDYN_SHOW")) printf("%s box, width %d, 1e-%d: %.1e\n", s->box.periodic ? "periodic" : "open",
                                           width, digits, off);
      assert_true(off < 0.1 * tolerance && off < 2e-6);
      if (floats) assert_true(off > 0.0);
    }
}

static void same_digits(const scene *s, int single)
{
  scene open = *s;
  open.box.periodic = 0;
  same_digits_in_box(s, single);
  same_digits_in_box(&open, single);
}

static void clouds(void **state)
{
  (void) state;
  const scene equal = cloud(1, MOST, 0.2, 1.0), unequal = cloud(2, MOST, 0.3, 4.0), dilute = cloud(3, MOST, 1e-3, 1.0);
  scene oblique = cloud(4, MOST, 0.45, 1.0);
  oblique.box.tilt[0] = 0.3 * oblique.box.edge[0];
  same_digits(&equal, 1);
  same_digits(&unequal, 1);
  same_digits(&dilute, 1);
  same_digits_in_box(&oblique, 1);
}

static void radii_of_one_to_a_hundred(void **state)
{
  (void) state;
  scene s = cloud(5, MOST, 0.2, 100.0);
  for (int d = 0; d < 3; d++) s.x[6 + d] = s.x[3 + d] + (d == 0) * (s.a[1] + s.a[2]); /* two in touch */
  same_digits(&s, 1);
}

static void one_sphere_and_two_at_one_point(void **state)
{
  (void) state;
  scene one = cloud(6, 1, 0.05, 1.0), two = cloud(7, 2, 0.05, 1.0);
  for (int d = 0; d < 3; d++) two.x[3 + d] = two.x[d];
  same_digits(&one, 1);
  same_digits(&two, 1);
}

/* Floats alone would know no distance below 10 radii there. */
static void far_from_the_origin(void **state)
{
  (void) state;
  scene s = cloud(8, MOST, 0.2, 1.0);
  for (int i = 0; i < 3 * s.n; i++) s.x[i] += 1e8;
  for (int d = 0; d < 3; d++) s.box.origin[d] += 1e8;
  same_digits(&s, 1);
}

/* A pair in touch in a box of a million radii, whose range is so long that it stays with doubles. */
static void a_huge_box(void **state)
{
  (void) state;
  const double middle = 3e5;
  scene few = {.n = 3, .a = {1, 1, 1}, .box = {.periodic = 1, .edge = {1e6, 1e6, 1e6}}};
  const double at[9] = {middle, middle, middle, middle + 2, middle, middle, 9e5, 1e5, 5e5};
  memcpy(few.x, at, sizeof(at));
  same_digits(&few, 0);
}

/* Forces that no float holds are taken times a power of two; those that floats hold keep their digits. */
static void forces_of_any_size(void **state)
{
  (void) state;
  const scene s = cloud(13, MOST, 0.3, 1.0);
  for (int width = 3; width <= 6; width += 3) {
    const double power[5] = {-300, -45, 9, 45, 300};
    double F[6 * MOST], G[6 * MOST], u[6 * MOST], v[6 * MOST];
    forces(&s, width, 3, F);
    product(&s, width, 1e-3, 1, F, u);
    for (int k = 0; k < 5; k++) {
      const double size = pow(10.0, power[k]);
      for (int i = 0; i < width * s.n; i++) G[i] = size * F[i];
      product(&s, width, 1e-3, 1, G, v);
      for (int i = 0; i < width * s.n; i++) v[i] /= size;
      assert_true(difference(&s, width, F, v, u) < 1e-6);
    }
  }
}

/* F' M F'' = F'' M F', to the rounding of floats: conjugate gradients go on until far below any tolerance that has
   them. */
static void products_are_reciprocal(void **state)
{
  (void) state;
  const scene scenes[2] = {cloud(10, MOST, 0.3, 1.0), cloud(11, MOST, 0.3, 3.0)};
  for (int k = 0; k < 2; k++)
    for (int width = 3; width <= 6; width += 3)
      for (int digits = 1; digits <= 5; digits += 2) {
        const scene *s = scenes + k;
        double F[6 * MOST], G[6 * MOST], u[6 * MOST], v[6 * MOST], Gu = 0.0, Fv = 0.0, all = 0.0;
        forces(s, width, 1, F);
        forces(s, width, 2, G);
        product(s, width, pow(10.0, -digits), 1, F, u);
        product(s, width, pow(10.0, -digits), 1, G, v);
        for (int i = 0; i < width * s->n; i++) {
          Gu += G[i] * u[i];
          Fv += F[i] * v[i];
          all += F[i] * u[i];
        }
        CHECK_NEAR(Gu, Fv, 1e-6 * all);
      }
}

/* Tighter tolerances, and what draws noise, are of doubles. */
static void the_rule(void **state)
{
  (void) state;
  const scene s = cloud(12, MOST, 0.2, 1.0);
  const sd_ewald_sizes sizes = periodic_sizes(s.a, s.n);
  sd_ewald how;
  assert_true(periodic_choose(&s.box, s.a, s.n, 3, 0.1 * 1e-4).single);
  assert_true(!periodic_choose(&s.box, s.a, s.n, 3, 0.99e-5).single);
  assert_int_equal(sd_ewald_choose_positive(&s.box, &sizes, 3, 1e-3, SD_EWALD_POSITIVE, &how), SD_OK);
  assert_true(!how.single);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(clouds),
      cmocka_unit_test(radii_of_one_to_a_hundred),
      cmocka_unit_test(one_sphere_and_two_at_one_point),
      cmocka_unit_test(far_from_the_origin),
      cmocka_unit_test(a_huge_box),
      cmocka_unit_test(forces_of_any_size),
      cmocka_unit_test(products_are_reciprocal),
      cmocka_unit_test(the_rule),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
