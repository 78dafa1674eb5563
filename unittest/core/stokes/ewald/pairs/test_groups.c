/* The near part where points stand in groups: the same as point by point, whatever the groups are; so are the whole
 * products of the engines. */
#include "ewald/periodic.h"

#include "sd_ewald_pairs.h"
#include "sd_multiblob_points.h"

enum { SPHERES = 40, GHOSTS = 15, ALL = SPHERES + GHOSTS, N = 12 * SPHERES, N_ALL = 12 * ALL };

static const sd_isa sets[] = {SD_ISA_PLAIN, SD_ISA_BASELINE, SD_ISA_AVX2, SD_ISA_AVX512};

/* Shells of 12 of two radii, some of which overlap */
typedef struct {
  double x[3 * N_ALL], a[N_ALL], w[N_ALL], F[3 * N_ALL];
  int first[ALL + 1], form[ALL];
} cloud;

static cloud make(double small)
{
  static sd_multiblob m;
  static cloud c;
  double X[3 * ALL], A[ALL];
  uint64_t seed = 11;
  assert_int_equal(sd_multiblob_create(12, 1, &m), SD_OK);
  for (int i = 0; i < ALL; i++) {
    for (int d = 0; d < 3; d++) X[3 * i + d] = uniform(&seed, 0, 9);
    A[i] = i % 2 ? 1.0 : small;
    c.form[i] = i % 2;
    for (int k = 0; k < 12; k++) c.w[12 * i + k] = 1.0 + 0.1 * (i % 3);
  }
  const sd_multiblob_spheres s = {.x = X, .a = A, .n = ALL};
  sd_multiblob_expand(&m, &s, NULL, c.x, c.a);
  for (int i = 0; i <= ALL; i++) c.first[i] = 12 * i;
  for (int i = 0; i < 3 * N_ALL; i++) c.F[i] = uniform(&seed, -1, 1);
  return c;
}

static void near_product(sd_ewald_pairs *p, const cloud *c, const sd_groups *groups, int turn, double *u)
{
  const sd_spheres spheres = {c->x, c->a, c->w};
  assert_int_equal(sd_ewald_pairs_place(p, &spheres, groups, N, N_ALL, turn), SD_OK);
  assert_int_equal(sd_ewald_pairs_load(p, N, c->F, c->F + 3 * N, NULL, NULL), SD_OK);
  sd_ewald_pairs_apply(p);
  sd_ewald_pairs_take(p, N, c->F, NULL, NULL, NULL, u);
}

static void near_part_at(const cloud *c, double origin, const sd_groups *groups, const struct sd_ewald_kernels *kernels,
                         double *u)
{
  const sd_ewald_box box = {.periodic = 1, .origin = {origin, origin, origin}, .edge = {12, 12, 12}};
  const sd_ewald how = periodic_choose(&box, c->a, N, 3, 1e-4);
  sd_ewald_pairs p = {0};
  sd_ewald_pairs_create(&p, &how, kernels, 3);
  for (int again = 0; again < 2; again++) near_product(&p, c, groups, 0, u); /* and with what the first has left */
  sd_ewald_pairs_free(&p);
}

static void near_part(const cloud *c, const sd_groups *groups, const struct sd_ewald_kernels *kernels, double *u)
{
  near_part_at(c, 0.0, groups, kernels, u);
}

static void check(const cloud *c, const sd_groups *groups, sd_isa isa)
{
  static double expected[3 * N], u[3 * N];
  const sd_groups none = {0};
  double scale = 0.0;
  near_part(c, &none, SD_KERNELS_OF(sd_ewald, plain, isa), expected);
  near_part(c, groups, SD_KERNELS_OF(sd_ewald, plain, isa), u);
  for (int i = 0; i < 3 * N; i++) scale = fmax(scale, fabs(expected[i]));
  assert_true(scale > 0.0);
  for (int i = 0; i < 3 * N; i++) CHECK_NEAR(u[i], expected[i], 1e-13 * scale);
  near_part(c, groups, SD_KERNELS_OF(sd_ewald_single, plain, isa), u);    /* sums of floats */
  for (int i = 0; i < 3 * N; i++) CHECK_NEAR(u[i], expected[i], 1e-6 * scale);
}

/* Of all, of some, of none with a form; radii alike and not; each set of instructions */
static void forms_change_nothing(void **state)
{
  (void) state;
  for (int k = 0; k < 4; k++)
    for (int unlike = 0; unlike < 2; unlike++) {
      if (!sd_isa_supported(sets[k])) continue;
      cloud c = make(unlike ? 0.7 : 1.0);
      check(&c, &(sd_groups){ALL, c.first, c.form}, sets[k]);
      check(&c, &(sd_groups){ALL, c.first, NULL}, sets[k]);
      for (int i = 0; i < ALL; i += 3) c.form[i] = -1;
      check(&c, &(sd_groups){ALL, c.first, c.form}, sets[k]);
    }
}

/* Points that take no part, whole groups of them, groups of one to twelve, and one that is too large */
static void any_groups_will_do(void **state)
{
  (void) state;
  cloud c = make(0.7);
  for (int i = 0; i < ALL; i++) c.form[i] = -1;
  for (int i = 0; i < N_ALL; i += 5) c.a[i] = 0.0;
  for (int i = 24; i < 48; i++) c.a[i] = 0.0;
  int first[N_ALL + 1], n = 0;
  for (int at = 0, size = 1; at < N_ALL; at += size, size = size % 12 + 1) {
    const int end = at < N ? N : N_ALL;
    first[n++] = at;
    if (at + size > end) size = end - at;
  }
  first[n] = N_ALL;
  int two[ALL + 1] = {0};
  for (int k = 0; k < ALL; k++) two[k] = k == 0 ? 0 : c.first[k + 1];
  two[ALL - 1] = N_ALL;
  for (int k = 0; k < 4; k++) {
    if (!sd_isa_supported(sets[k])) continue;
    check(&c, &(sd_groups){ALL, c.first, c.form}, sets[k]);
    check(&c, &(sd_groups){n, first, NULL}, sets[k]);
    check(&c, &(sd_groups){ALL - 1, two, NULL}, sets[k]);
  }
}

/* Every shell goes by a step of its own, of at most `far` each way. */
static void go(cloud *c, double far)
{
  uint64_t seed = 5;
  for (int i = 0; i < ALL; i++) {
    double step[3];
    for (int d = 0; d < 3; d++) step[d] = uniform(&seed, -far, far);
    for (int k = 0; k < 36; k++) c->x[36 * i + k] += step[k % 3];
  }
}

/* While nobody moves a point goes, another one instead, both are there, and all of a shell go. */
static void change(cloud *c, int step)
{
  double *one = c->a + 12 * 3 + 5, *other = c->a + 12 * 5 + 2;
  const double a = c->a[12 * 3];
  if (step == 10) *one = 0.0;
  if (step == 11) *other = 0.0;
  if (step == 11) *one = a;
  if (step == 12) *other = a;
  if (step == 13) for (int i = 0; i < 12; i++) c->a[12 * 9 + i] = 0.0;
}

static void same_as_anew(sd_ewald_pairs *p, const cloud *c, const sd_groups *groups, int turn)
{
  static double kept[3 * N], anew[3 * N];
  double scale = 0.0;
  sd_ewald_pairs other = {0};
  sd_ewald_pairs_create(&other, &p->ewald, p->kernels, 3);
  near_product(p, c, groups, turn, kept);
  near_product(&other, c, groups, turn, anew);
  sd_ewald_pairs_free(&other);
  for (int i = 0; i < 3 * N; i++) scale = fmax(scale, fabs(anew[i]));
  for (int i = 0; i < 3 * N; i++) CHECK_NEAR(kept[i], anew[i], (p->bytes == sizeof(double) ? 1e-13 : 1e-6) * scale);
}

/* Lists hold over small steps, as middles of their making say, and are made anew when one shell goes far, others
 * are ours, the frame turns, or other points are there: they change no velocity, whatever their age. */
static void lists_of_any_age_are_as_good_as_new(void **state)
{
  (void) state;
  const sd_ewald_box box = {.periodic = 1, .edge = {12, 12, 12}};
  for (int k = 0; k < 8; k++) {
    const sd_isa isa = sets[k / 2];
    if (!sd_isa_supported(isa)) continue;
    const struct sd_ewald_kernels *kernels = k % 2 ? SD_KERNELS_OF(sd_ewald_single, plain, isa)
                                                   : SD_KERNELS_OF(sd_ewald, plain, isa);
    cloud c = make(0.7);
    const sd_ewald how = periodic_choose(&box, c.a, N, 3, 1e-4);
    const sd_groups groups = {ALL, c.first, c.form};
    int made_anew = 0;
    sd_ewald_pairs p = {0};
    sd_ewald_pairs_create(&p, &how, kernels, 3);
    const sd_spheres spheres = {c.x, c.a, c.w};
    assert_int_equal(sd_ewald_pairs_place(&p, &spheres, &groups, N - 12, N_ALL, 0), SD_OK);
    same_as_anew(&p, &c, &groups, 0);
    for (int step = 0; step < 14; step++) {
      const double stood = p.groups.middle[0];
      if (step < 9) go(&c, 0.1);
      else change(&c, step);
      if (step == 8) for (int i = 0; i < 36; i++) c.x[36 * 7 + i] += 3.0;
      same_as_anew(&p, &c, &groups, step < 9 ? 0 : 1);
      made_anew += p.groups.middle[0] != stood;
    }
    assert_in_range(made_anew, 3, 10);
    sd_ewald_pairs_free(&p);
  }
}

/* A form is one block: the near part is as symmetric as before. */
static void near_part_is_symmetric(void **state)
{
  (void) state;
  cloud c = make(0.7);
  static double F[3 * N_ALL], u[3 * N], v[3 * N];
  double uF = 0.0, vG = 0.0, size = 0.0;
  const sd_groups groups = {ALL, c.first, c.form};
  uint64_t seed = 3;
  for (int i = 3 * N; i < 3 * N_ALL; i++) c.F[i] = 0.0;
  near_part(&c, &groups, SD_KERNELS_OF(sd_ewald, plain, SD_ISA_PLAIN), u);
  memcpy(F, c.F, sizeof(F));
  for (int i = 0; i < 3 * N; i++) c.F[i] = uniform(&seed, -1, 1);
  near_part(&c, &groups, SD_KERNELS_OF(sd_ewald, plain, SD_ISA_PLAIN), v);
  for (int i = 0; i < 3 * N; i++) {
    uF += u[i] * c.F[i];
    vG += v[i] * F[i];
    size += fabs(v[i] * F[i]);
  }
  CHECK_NEAR(uF, vG, 1e-13 * size);
}

/* A hundred million radii from the origin, shells of 1 : 100, two at one point and two in touch: in floats and by
 * groups the digits of doubles, point by point */
static void hard_places_have_the_same_digits(void **state)
{
  (void) state;
  static double expected[3 * N], u[3 * N];
  for (int far = 0; far < 2; far++)
    for (int unlike = 0; unlike < 2; unlike++) {
      cloud c = make(unlike ? 0.01 : 1.0);
      const double origin = far ? 1e8 : 0.0;
      const sd_groups groups = {ALL, c.first, c.form}, none = {0};
      double scale = 0.0;
      memcpy(c.x + 3 * 24, c.x, 3 * 12 * sizeof(double));        /* shell 2 where shell 0 is */
      for (int k = 0; k < 36; k++) c.x[3 * 48 + k] = c.x[k] + 2.0 * (k % 3 == 0) * (unlike ? 0.01 : 1.0);
      for (int i = 0; i < 3 * N_ALL; i++) c.x[i] += origin;
      near_part_at(&c, origin, &none, SD_KERNELS_OF(sd_ewald, plain, SD_ISA_PLAIN), expected);
      for (int i = 0; i < 3 * N; i++) scale = fmax(scale, fabs(expected[i]));
      for (int k = 0; k < 4; k++) {
        if (!sd_isa_supported(sets[k])) continue;
        near_part_at(&c, origin, &groups, SD_KERNELS_OF(sd_ewald_single, plain, sets[k]), u);
        for (int i = 0; i < 3 * N; i++) CHECK_NEAR(u[i], expected[i], 1e-6 * scale);
      }
    }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(forms_change_nothing),
      cmocka_unit_test(any_groups_will_do),
      cmocka_unit_test(lists_of_any_age_are_as_good_as_new),
      cmocka_unit_test(near_part_is_symmetric),
      cmocka_unit_test(hard_places_have_the_same_digits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
