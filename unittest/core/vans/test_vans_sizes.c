/* Grains of many sizes in bins: limits, volume and surface, sums that are those of all grains, and
 * the mixing length of bins beside that of the radii themselves. */
#include "column.h"

enum { N = 41, GRAINS = 300, BINS = 7 };
static double x[3 * GRAINS], v[3 * GRAINS], a[GRAINS], limit[BINS + 1];
static sd_vans_grains grains = {GRAINS, x, v, a, NULL, NULL, NULL, NULL};
static column *c;

static int set_up(void **state)
{
  (void) state;
  uint64_t seed = 17;
  for (int i = 0; i < GRAINS; i++) {
    a[i] = 0.001 * pow(5.0, uniform(&seed, 0.0, 1.0));
    for (int d = 0; d < 3; d++) {
      x[3 * i + d] = uniform(&seed, 0.01, 0.06);
      v[3 * i + d] = uniform(&seed, -0.3, 0.5);
    }
  }
  a[4] = 0.001;
  a[9] = 0.005;
  sd_vans_bins(0.001, 0.005, BINS, limit);
  c = column_create(N, 0.08, 0.0);
  return 0;
}

static int tear_down(void **state)
{
  (void) state;
  column_free(c);
  return 0;
}

static void bins_are_sieves(void **state)
{
  (void) state;
  const sd_vans_averaging how = {.nclass = BINS, .class_limit = limit};
  assert_true(limit[0] == 0.001 && limit[BINS] == 0.005);
  for (int b = 0; b < BINS; b++) {
    CHECK_NEAR(limit[b + 1] / limit[b], pow(5.0, 1.0 / BINS), 1e-15 * 2.0);
    assert_int_equal(sd_vans_class_of(&how, limit[b]), b);
    assert_int_equal(sd_vans_class_of(&how, sqrt(limit[b] * limit[b + 1])), b);
  }
  /* what is larger or smaller than the sieves stays in the last */
  assert_int_equal(sd_vans_class_of(&how, 0.005), BINS - 1);
  assert_int_equal(sd_vans_class_of(&how, 0.1), BINS - 1);
  assert_int_equal(sd_vans_class_of(&how, 1e-9), 0);
  const double radii[2] = {0.004, 0.002};
  const sd_vans_averaging exact = {.nclass = 2, .class_radius = radii};
  assert_int_equal(sd_vans_class_of(&exact, 0.002), 1);
  assert_int_equal(sd_vans_class_of(&exact, 0.0020000001), -1);
}

/* phi/V of Sauter's radius spheres have the volume and the surface of the grains of the bin. */
static void bins_keep_volume_and_surface(void **state)
{
  (void) state;
  const sd_vans_averaging how = {.nclass = BINS, .class_limit = limit};
  double sums[2 * BINS] = {0.0}, radius[BINS], volume[BINS], V = 0.0, S = 0.0, of_bins[2] = {0.0, 0.0};
  sd_vans_class_sums(&how, &grains, sums);
  sd_vans_class_means(BINS, limit, sums, radius, volume);
  for (int i = 0; i < GRAINS; i++) {
    V += 4.0 / 3.0 * SD_PI * pow(a[i], 3);
    S += 4.0 * SD_PI * a[i] * a[i];
  }
  for (int b = 0; b < BINS; b++) {
    assert_true(radius[b] >= limit[b] && radius[b] <= limit[b + 1]);
    of_bins[0] += volume[b];
    of_bins[1] += 3.0 * volume[b] / radius[b];
  }
  CHECK_NEAR(of_bins[0], V, 1e-13 * V);
  CHECK_NEAR(of_bins[1], S, 1e-13 * S);
  const double none[2] = {0.0, 0.0};
  sd_vans_class_means(1, limit, none, radius, volume);
  CHECK_NEAR(radius[0], sqrt(limit[0] * limit[1]), 1e-18);
  assert_true(volume[0] == 0.0);
}

/* Volume, momentum and drag of all bins are those of all grains, slice by slice. */
static void bins_add_up_to_all_grains(void **state)
{
  (void) state;
  const sd_vans_force_law law = {.rho = 1000, .eta = 1e-3, .exponent = 3.1, .g = {0.1, 0.0, -9.81}};
  double hindrance[N], U[N + 1], scratch[2 * N];
  static double sums[(1 + BINS) * N * SD_VANS_ROWS];
  for (int n = 0; n <= N; n++) U[n] = 0.02 * n;
  sd_hindrance_of(law.drag, N, c->phi, law.exponent, hindrance);
  const sd_vans_averaging how = {.nclass = BINS, .class_limit = limit};
  const sd_vans_ambient stream = {&c->mesh, &law, U, hindrance};
  assert_int_equal(sd_vans_average(&stream, &how, &grains, sums, scratch), -1);
  for (int k = 0; k < N * SD_VANS_ROWS; k++) {
    double of_bins = 0.0, size = 0.0;
    for (int b = 0; b < BINS; b++) {
      of_bins += sums[(1 + b) * N * SD_VANS_ROWS + k];
      size += fabs(sums[(1 + b) * N * SD_VANS_ROWS + k]);
    }
    CHECK_NEAR(of_bins, sums[k], 1e-13 * size);
  }
}

/* Rousseau's pore length: of bins with their volumes that of all grains, whatever the bins, also
 * empty ones; without volumes that of as many grains of each radius. */
static void pores_of_bins_are_those_of_the_grains(void **state)
{
  (void) state;
  double V = 0.0, S = 0.0, radius[3 * BINS], volume[3 * BINS], fine[3 * BINS + 1];
  for (int i = 0; i < GRAINS; i++) {
    V += pow(a[i], 3) / 3.0;
    S += a[i] * a[i];
  }
  for (int bins = 1; bins <= 3 * BINS; bins += 10) {
    double sums[6 * BINS] = {0.0};
    sd_vans_bins(0.0005, 0.01, bins, fine); /* some are empty */
    const sd_vans_averaging how = {.nclass = bins, .class_limit = fine};
    sd_vans_class_sums(&how, &grains, sums);
    sd_vans_class_means(bins, fine, sums, radius, volume);
    const sd_vans_fluid fluid = {.rho = 1000, .eta = 1e-3, .kappa = 0.4, .phi_max = 0.6, .turbulence = SD_VANS_ROUSSEAU,
                                 .nclass = bins, .class_radius = radius, .class_volume = volume};
    find_lengths(c, &fluid, NULL);
    /* at rest van Driest's part is 0 */
    CHECK_NEAR(c->length[9], 0.5 * 0.4 / 0.6 * V / S, 1e-14 * V / S);
  }
}

static void the_mean_height_is_that_of_the_volume(void **state)
{
  (void) state;
  double phi[N] = {0.0};
  assert_true(sd_vans_mean_height(&c->mesh, phi) == 0.0);
  phi[3] = 0.2;
  phi[13] = 0.6;
  CHECK_NEAR(sd_vans_mean_height(&c->mesh, phi), (0.25 * 3.5 + 0.75 * 13.5) * c->mesh.dz, 1e-17);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bins_are_sieves),
      cmocka_unit_test(bins_keep_volume_and_surface),
      cmocka_unit_test(bins_add_up_to_all_grains),
      cmocka_unit_test(pores_of_bins_are_those_of_the_grains),
      cmocka_unit_test(the_mean_height_is_that_of_the_volume),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
