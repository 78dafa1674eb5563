/* Random forces of films: their covariance is L, whichever end a pair is seen from and also through
 * images, without sampling. */
#include "near_scene.h"

#include "multiblob/blobs.h"

#include "sd_lubrication_noise.h"
#include "sd_pair_resistance.h"

/* The first of a pair; of an image of a sphere, the one that stands higher */
typedef struct {
  const double *x;
  int n_all, n, unit;
  const int *owner;
  double side;
} unit_normals;

/* Which pair it is: spheres a <= b and by which image they see each other; numbers of one are 1 */
static int unit_of_pair(void *ctx, int i, int at, double g[12])
{
  const unit_normals *u = ctx;
  const int j = at < u->n ? at : u->owner[at];
  double r[3];
  int image = 0, first = i <= j;
  sd_minus(u->x + 3 * at, u->x + 3 * i, r);
  for (int d = 0; d < 3 && u->side > 0.0; d++) {
    const int step = (int) floor(r[d] / u->side + 0.5123);
    if (i == j && step != 0) first = step > 0;
    image = 3 * image + step;
  }
  if (i == j) image = abs(image);
  if (!first) image = -image;
  const int a = i < j ? i : j, b = i < j ? j : i;
  const int pair = 27 * (u->n * a + b) + image + 13, k = u->unit - 12 * pair;
  for (int e = 0; e < 12; e++) g[e] = e == k;
  return i == at || first;
}

/* Covariance less L, over the largest of L */
static double difference(const sd_lubrication *L, unit_normals u)
{
  const int N = 6 * L->n;
  double *C = calloc((size_t) (N * N), sizeof(double)), *F = calloc(3 * (size_t) N, sizeof(double));
  double *V = F + N, *out = V + N, off = 0.0, most = 0.0;
  for (u.unit = 0; u.unit < 12 * 27 * u.n * u.n; u.unit++) {
    memset(F, 0, sizeof(double) * (size_t) N);
    assert_int_equal(sd_lubrication_noise(L, unit_of_pair, &u, F), SD_OK);
    for (int p = 0; p < N; p++)
      for (int q = 0; q < N && F[p] != 0.0; q++) C[N * p + q] += F[p] * F[q];
  }
  for (int q = 0; q < N; q++) {
    V[q] = 1.0;
    assert_int_equal(sd_lubrication_apply((void *) L, V, out), SD_OK);
    V[q] = 0.0;
    for (int p = 0; p < N; p++) {
      off = fmax(off, fabs(C[N * p + q] - out[p]));
      most = fmax(most, fabs(out[p]));
    }
  }
  free(C), free(F);
  return off / most;
}

static void of_points_that_share_what_they_resist(void **state)
{
  (void) state;
  near_scene q = near_create(scene_create(4), 2.0, 1e-3);
  scene_set(&q.s, 0, 0, 0, 0, 1.0, 1.3);
  scene_set(&q.s, 1, 2.02, 0.1, 0, 1.0, 1.3);
  scene_set(&q.s, 2, 1.0, 2.4, 0.7, 1.5, 1.3);
  scene_set(&q.s, 3, 0.2, -0.4, 2.3, 0.9, 1.3);
  near_place(&q);
  const unit_normals u = {q.s.x, 4, 4, 0, NULL, 0.0};
  assert_int_equal(q.L.count, 6);
  assert_true(difference(&q.L, u) < 1e-7);
  near_free(&q);
}

/* Two spheres so near to images of themselves and of each other that each pair is there several
 * times; and what a wall makes spheres resist alone */
static void of_shells_through_all_images(void **state)
{
  (void) state;
  static const double x[6] = {0.3, 0.4, 0.5, 2.2, 1.5, 1.1}, a[2] = {1.0, 0.9};
  blobs *s = blobs_create(12, 1, 2, x, a);
  const double side = 3.0;
  s->side = side;
  s->R = calloc(144, sizeof(double));
  blobs_add_films(s, 2.0, NULL);
  blob_images *g = blobs_images(s, 2.0, NULL);
  const unit_normals u = {g->x, g->count, 2, 0, g->owner, side};
  assert_true(difference(&s->L, u) < 1e-8);
  double B[36], E[6] = {0.0};
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 6; q++) B[6 * p + q] = (p == q ? 4.0 + p : 0.0) + 0.1 * (p + q);
  sd_lubrication_add_own(&s->L, 1, B, E);
  assert_true(difference(&s->L, u) < 1e-8);
  free(g);
  blobs_free(s);
}

/* Spheres of nanometres in metres: forces go like the root of a length, torques like that of its cube. */
static void units_of_length_do_not_matter(void **state)
{
  (void) state;
  const double d[3] = {0.6, 0.0, 0.8}, unit = 1e-9;
  const sd_pair_resistance R = sd_pair_resistance_rpy(1.0, 1.5, 2.6),
                           S = sd_pair_resistance_rpy(unit, 1.5 * unit, 2.6 * unit);
  double g[12], F[12] = {0.0}, small[12] = {0.0};
  for (int k = 0; k < 12; k++) g[k] = cos(3.0 * k);
  assert_int_equal(sd_pair_noise(&R, d, 1.25, g, F), SD_OK);
  assert_int_equal(sd_pair_noise(&S, d, 1.25 * unit, g, small), SD_OK);
  for (int k = 0; k < 12; k++) {
    const double scale = sqrt(k % 6 < 3 ? unit : unit * unit * unit);
    assert_true(fabs(small[k] / scale - F[k]) < 1e-10);
  }
}

/* A film of shells at the end of its range resists little more than that they roll against each other:
 * what it resists of sliding is rounding, of either sign. */
static void rounding_of_a_part_that_is_not_there_is_no_failure(void **state)
{
  (void) state;
  const double d[3] = {0.6, 0.0, 0.8}, a = 3e-6, slide = -2.5e-25 * a, roll = 3e-14 * a * a * a;
  const sd_pair_resistance R = {.YA = {slide, -slide, slide}, .YC = {roll, -roll, roll}, .XC = {slide * a * a}};
  double g[12], F[12] = {0.0};
  for (int k = 0; k < 12; k++) g[k] = cos(3.0 * k);
  assert_int_equal(sd_pair_noise(&R, d, a, g, F), SD_OK);
  for (int e = 0; e < 3; e++) {
    assert_true(F[e] == 0.0 && fabs(F[3 + e] + F[9 + e]) < 1e-12 * sqrt(roll));
  }
  assert_true(fabs(F[4]) > 0.1 * sqrt(roll));
}

/* Where a film of equal spheres is clipped, nothing is left of what it resists of rolling in step: rounding of its
 * numbers, in which ranks differ, changes no force by more. */
static void rounding_of_a_film_that_is_clipped_is_no_force(void **state)
{
  (void) state;
  const double d[3] = {0.6, 0.0, 0.8}, hair = 3e-16;
  double g[12], F[2][12] = {{0.0}};
  for (int k = 0; k < 12; k++) g[k] = cos(3.0 * k);
  for (int off = 0; off < 2; off++) {
    const sd_film film = {1.3, 0.2, {0.3 * (1.0 + off * hair), 0.3, 0.3 * (1.0 + off * hair)}, 0.0};
    const sd_pair_resistance R = sd_film_resistance(&film, 2.1, 1.0);
    assert_int_equal(sd_pair_noise(&R, d, 1.0, g, F[off]), SD_OK);
  }
  for (int k = 0; k < 12; k++) assert_true(fabs(F[1][k] - F[0][k]) < 1e-14);
}

static int any_numbers(void *ctx, int i, int at, double g[12])
{
  uint64_t *seed = ctx;
  for (int k = 0; k < 12; k++) g[k] = uniform(seed, -1.7, 1.7);
  return i <= at;
}

/* A wall that resists one motion alone pushes along that, and by rounding in no other way. */
static void rounding_of_what_a_wall_does_not_resist_is_no_force(void **state)
{
  (void) state;
  uint64_t seed = 5;
  near_scene q = near_create(scene_create(1), 2.0, 1e-3);
  scene_set(&q.s, 0, 0, 0, 0, 1.0, 1.3);
  for (int k = 0; k < 20; k++) {
    double e[6], B[36], E[6] = {0.0}, F[6] = {0.0}, along = 0.0, square = 0.0;
    for (int p = 0; p < 6; p++) e[p] = uniform(&seed, -1, 1);
    for (int p = 0; p < 36; p++) B[p] = e[p / 6] * e[p % 6];
    near_place(&q);
    sd_lubrication_add_own(&q.L, 0, B, E);
    assert_int_equal(sd_lubrication_noise(&q.L, any_numbers, &seed, F), SD_OK);
    for (int p = 0; p < 6; p++) {
      along += e[p] * F[p];
      square += e[p] * e[p];
    }
    assert_true(fabs(along) > 1e-3);
    for (int p = 0; p < 6; p++) CHECK_NEAR(F[p], along / square * e[p], 1e-13);
  }
  near_free(&q);
}

static void what_is_negative_has_no_root(void **state)
{
  (void) state;
  const sd_pair_resistance R = {.XA = {1.0, 2.0, 1.0}};
  const double d[3] = {0, 0, 1}, g[12] = {0, 0, 1};
  double F[12] = {0.0};
  assert_int_equal(sd_pair_noise(&R, d, 1.0, g, F), SD_EINDEFINITE);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(of_points_that_share_what_they_resist),
      cmocka_unit_test(of_shells_through_all_images),
      cmocka_unit_test(units_of_length_do_not_matter),
      cmocka_unit_test(rounding_of_a_part_that_is_not_there_is_no_failure),
      cmocka_unit_test(rounding_of_a_film_that_is_clipped_is_no_force),
      cmocka_unit_test(rounding_of_what_a_wall_does_not_resist_is_no_force),
      cmocka_unit_test(what_is_negative_has_no_root),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
