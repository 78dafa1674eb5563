/* Slices of spheres, averages, and the force on one grain against closed forms. */
#include "check.h"

#include "sd_constants.h"
#include "sd_vans_random.h"
#include "yade_drag.h"

#include <string.h>

/* The slices share their cuts, so that only rounding is left: each is one subtraction, 1e-16 of the volume, and there
 * are up to 2000. */
static void slices_sum_to_the_sphere(void **state)
{
  (void) state;
  enum { N = 2100 };
  static double edge[N + 1], V[N];
  static const double ratios[] = {0.01, 0.3, 0.75, 1.0, 1.3, 2.0, 2.3, 3.5, 15.0, 333.3, 1000.0};
  const double dz = 0.0017, z_ref = -0.3;
  for (int n = 0; n <= N; n++) edge[n] = n * dz;
  const sd_vans_mesh mesh = {N, z_ref, dz, edge};
  for (size_t r = 0; r < sizeof ratios / sizeof *ratios; r++)
    for (int k = 0; k <= 40; k++) {
      const double a = ratios[r] * dz,
                   z = z_ref + (1040 + k / 20.0) * dz; /* also on the borders and in the middles */
      const sd_vans_reach reach = sd_vans_slices(&mesh, SD_VANS_CONSISTENT, 0, z, a, V);
      double sum = 0.0;
      for (int i = 0; i < reach.count; i++) {
        assert_true(V[i] >= 0.0);
        sum += V[i];
      }
      const double sphere = 4.0 / 3.0 * SD_PI * a * a * a;
      assert_true(fabs(sum - sphere) <= 1e-13 * sphere);
    }
}

static void slices_of_uneven_mesh_sum_to_the_sphere(void **state)
{
  (void) state;
  enum { N = 60 };
  double edge[N + 1], V[N];
  for (int n = 0; n <= N; n++) edge[n] = 0.001 * n * (1.0 + 0.02 * n);
  const sd_vans_mesh mesh = {N, 0.02, 0.0, edge};
  for (int k = 0; k < 200; k++) {
    const double a = 0.0031, z = 0.02 + a + k * 0.0006;
    const sd_vans_reach reach = sd_vans_slices(&mesh, SD_VANS_CONSISTENT, 0, z, a, V);
    double sum = 0.0;
    for (int i = 0; i < reach.count; i++) sum += V[i];
    assert_true(fabs(sum - 4.0 / 3.0 * SD_PI * a * a * a) <= 1e-13 * 4.2 * a * a * a);
    assert_int_equal(sd_vans_slice_of(&mesh, 0.02 + 0.5 * (edge[reach.first] + edge[reach.first + 1])), reach.first);
  }
}

/* Half a sphere below the bottom, half in the mesh; wholly outside: nothing. */
static void slices_end_at_the_mesh(void **state)
{
  (void) state;
  enum { N = 10 };
  double edge[N + 1], V[N];
  for (int n = 0; n <= N; n++) edge[n] = n * 0.3;
  const sd_vans_mesh mesh = {N, 5.0, 0.3, edge};
  const double a = 0.7, ends[2] = {5.0, 5.0 + edge[N]};
  for (int k = 0; k < 2; k++) {
    const sd_vans_reach reach = sd_vans_slices(&mesh, SD_VANS_CONSISTENT, 0, ends[k], a, V);
    double sum = 0.0;
    for (int i = 0; i < reach.count; i++) sum += V[i];
    assert_true(fabs(sum - 2.0 / 3.0 * SD_PI * a * a * a) <= 1e-13);
  }
  assert_int_equal(sd_vans_slices(&mesh, SD_VANS_CONSISTENT, 0, 4.2, a, V).count, 0);
  assert_int_equal(sd_vans_slices(&mesh, SD_VANS_CONSISTENT, 0, 8.8, a, V).count, 0);
}

/* Yade's slice n holds what belongs to slice 2p - n: seen where the sphere is large enough for its other defect, the
 * one-sided cut, to vanish. */
static void yade_mirrors_the_slices(void **state)
{
  (void) state;
  enum { N = 41 };
  double edge[N + 1], right[N], mirrored[N];
  for (int n = 0; n <= N; n++) edge[n] = n * 0.25;
  const sd_vans_mesh mesh = {N, 0.0, 0.25, edge};
  const double z = 20.3 * 0.25, a = 12.3 * 0.25; /* centre in slice 20; whole slices 9..31 */
  const sd_vans_reach truly = sd_vans_slices(&mesh, SD_VANS_CONSISTENT, 0, z, a, right),
                      of_yade = sd_vans_slices(&mesh, SD_VANS_YADE, 0, z, a, mirrored);
  for (int n = 10; n <= 30; n++)
    assert_true(fabs(mirrored[n - of_yade.first] - right[2 * 20 - n - truly.first]) < 1e-13);
  assert_true(truly.count > 20);
}

static void point_grains_stay_in_one_slice(void **state)
{
  (void) state;
  enum { N = 8 };
  double edge[N + 1], V[2 * N], sums[N * SD_VANS_ROWS] = {0}, U[N + 1] = {0}, hindrance[N],
                                     profile[5 * N];
  for (int n = 0; n <= N; n++) edge[n] = n * 0.5;
  for (int n = 0; n < N; n++) hindrance[n] = 1.0;
  const sd_vans_mesh mesh = {N, 0.0, 0.5, edge};
  const sd_vans_force_law law = {.rho = 1.2, .eta = 0.3, .exponent = 3.1};
  const sd_vans_averaging how = {1, 0, NULL, NULL, NULL};
  const double x[6] = {0, 0, 1.7, 0, 0, 9.0}, v[6] = {0.3, -0.2, 0.5, 1, 1, 1}, a[2] = {0.9, 0.9};
  const sd_vans_ambient stream = {&mesh, &law, U, hindrance};
  assert_int_equal(
      sd_vans_average(&stream, &how, &(sd_vans_grains){.n = 2, .x = x, .v = v, .a = a}, sums, V),
      -1);
  sd_vans_profiles(&mesh, 11.0, sums, profile);
  for (int n = 0; n < N; n++)
    assert_true(fabs(profile[n] - (n == 3 ? 4.0 / 3.0 * SD_PI * 0.729 / 5.5 : 0.0)) < 1e-15);
  assert_true(fabs(profile[N + 3] - 0.3) < 1e-15 && fabs(profile[3 * N + 3] - 0.5) < 1e-15);
}

/* Balance of drag, weight and buoyancy: (0.44 w + 24.4 nu/d) w = 4/3 (s-1) g d, a quadratic equation. */
static void drag_balances_weight_at_terminal_velocity(void **state)
{
  (void) state;
  const double rho = 1030.0, eta = 1.7e-3, rho_s = 2570.0, g = 9.7, a = 0.0011, d = 2 * a,
               nu = eta / rho;
  const double B = 24.4 * nu / d, C = 4.0 / 3.0 * (rho_s / rho - 1.0) * g * d;
  const double w = (-B + sqrt(B * B + 4 * 0.44 * C)) / (2 * 0.44);
  double edge[3] = {0, 1, 2};
  const sd_vans_mesh mesh = {2, 0.0, 1.0, edge};
  const sd_vans_force_law law = {.rho = rho, .eta = eta, .exponent = 3.1, .g = {0, 0, -g}};
  const double U[3] = {0, 0, 0}, hindrance[2] = {1, 1}, x[3] = {0, 0, 0.5}, v[3] = {0, 0, -w};
  double F[3];
  const sd_vans_ambient stream = {&mesh, &law, U, hindrance};
  assert_int_equal(sd_vans_forces(&stream, &(sd_vans_grains){.n = 1, .x = x, .v = v, .a = &a}, F, NULL), 0);
  const double weight = 4.0 / 3.0 * SD_PI * a * a * a * rho_s * g;
  assert_true(fabs(F[2] - weight) < 1e-13 * weight);
}

static void hindrance_has_its_exponent(void **state)
{
  (void) state;
  const double phi[3] = {0.0, 0.3, 0.6};
  double h[3];
  hindrance_of(3, phi, 3.1, h);
  assert_true(h[0] == 1.0);
  assert_true(fabs(log(h[1]) / log(1 - 0.3) + 3.1) < 1e-13 &&
              fabs(log(h[2]) / log(1 - 0.6) + 3.1) < 1e-13);
}

/* 1/2 rho pi a^2 C_l [(U_top - v)^2 - (U_bottom - v)^2], top and bottom floor(a/dz) slices from the centre's; also with
 * edges from a list. 0.6 is three slices of 0.2, though 0.6/0.2 is less than 3 in doubles. */
static void lift_sees_both_ends_of_the_grain(void **state)
{
  (void) state;
  enum { N = 12 };
  double edge[N + 1], U[N + 1], hindrance[N];
  for (int n = 0; n <= N; n++) edge[n] = n * 0.2, U[n] = 0.7 * n + 0.05 * n * n;
  for (int n = 0; n < N; n++) hindrance[n] = 1.0;
  const double x[3] = {0, 0, 1.09}, v[3] = {0.4, 0, 0}, radii[2] = {0.53, 0.6};
  const sd_vans_force_law law = {.rho = 1.3, .eta = 0.1, .lift = 0.27};
  for (int k = 0; k < 4; k++) {
    const sd_vans_mesh mesh = {N, 0.0, k % 2 ? 0.2 : 0.0, edge};
    const double a = radii[k / 2];
    const int slices = 2 + k / 2;
    double F[3];
    const sd_vans_ambient stream = {&mesh, &law, U, hindrance};
    sd_vans_forces(&stream, &(sd_vans_grains){.n = 1, .x = x, .v = v, .a = &a}, F, NULL);
    const double over = U[5 + 1 + slices] - 0.4, under = U[5 + 1 - slices] - 0.4;
    assert_true(fabs(F[2] - 0.5 * 1.3 * SD_PI * a * a * 0.27 * (over * over - under * under)) < 1e-13);
  }
}

static void convective_force_is_taken_off(void **state)
{
  (void) state;
  double edge[3] = {0, 1, 2};
  const sd_vans_mesh mesh = {2, 0.0, 1.0, edge};
  const double convective[2] = {0.3, 0.7}, U[3] = {0}, hindrance[2] = {1, 1}, x[3] = {0, 0, 1.5},
               v[3] = {0}, a = 0.2;
  const sd_vans_force_law law = {.rho = 1.3, .eta = 0.1, .convective = convective};
  double F[3];
  const sd_vans_ambient stream = {&mesh, &law, U, hindrance};
  sd_vans_forces(&stream, &(sd_vans_grains){.n = 1, .x = x, .v = v, .a = &a}, F, NULL);
  assert_true(F[0] == -0.7);
}

/* Above the mesh: the velocity of the surface and the phi of the last slice; below: water at rest and the phi of the
   first. */
static void grains_outside_feel_the_end_values(void **state)
{
  (void) state;
  double edge[4] = {0, 1, 2, 3};
  const sd_vans_mesh mesh = {3, 0.0, 1.0, edge};
  const double U[4] = {0, 0.5, 0.8, 0.9}, hindrance[3] = {3, 2, 1.5}, x[6] = {0, 0, 7, 0, 0, -2},
               v[6] = {0.1, 0, 0, 0.1, 0, 0}, a[2] = {0.2, 0.2};
  const sd_vans_grains grains = {.n = 2, .x = x, .v = v, .a = a};
  sd_vans_force_law law = {.rho = 1.3, .eta = 0.1, .g = {0, 0, -2}};
  double F[6], expected[3];
  const sd_vans_ambient stream = {&mesh, &law, U, hindrance};
  assert_int_equal(sd_vans_forces(&stream, &grains, F, NULL), 2);
  yade_drag(1.3, 0.1, 0.2, 1.5, (double[3]){0.8, 0, 0}, expected);
  assert_true(fabs(F[0] - expected[0]) < 1e-15 &&
              fabs(F[2] - 4.0 / 3.0 * SD_PI * 0.008 * 2.6) < 1e-15);
  yade_drag(1.3, 0.1, 0.2, 3.0, (double[3]){-0.1, 0, 0}, expected);
  assert_true(fabs(F[3] - expected[0]) < 1e-15);
  law.rules = SD_VANS_YADE;
  assert_int_equal(sd_vans_forces(&stream, &grains, F, NULL), 2);
  for (int k = 0; k < 6; k++) assert_true(F[k] == 0.0);
}

/* Moments over u_star^2 of the correlated walk: xx 2, yy 1, zz 1, xz -1; uncorrelated 1, 1, 1, 0. The error of a mean
 * of n = 4e5 is about 1/sqrt(n). */
static void fluctuations_have_their_moments(void **state)
{
  (void) state;
  enum { n = 400000 };
  for (int correlated = 0; correlated < 2; correlated++) {
    double xx = 0, yy = 0, zz = 0, xz = 0, xy = 0, x = 0;
    for (int i = 0; i < n; i++) {
      double normal[3], u[3];
      sd_vans_normal3(4711, i, 3, normal);
      sd_vans_fluctuation(normal, 0.3, correlated, u);
      for (int d = 0; d < 3; d++) u[d] /= 0.3;
      xx += u[0] * u[0] / n, yy += u[1] * u[1] / n, zz += u[2] * u[2] / n, xz += u[0] * u[2] / n,
          xy += u[0] * u[1] / n, x += u[0] / n;
    }
    const double tolerance = 5 / sqrt(n) * 2;
    assert_true(fabs(xx - (correlated ? 2 : 1)) < 2 * tolerance && fabs(yy - 1) < tolerance &&
                fabs(zz - 1) < tolerance);
    assert_true(fabs(xz + correlated) < tolerance && fabs(xy) < tolerance && fabs(x) < tolerance);
  }
}

/* Grain by grain: water moves past it in one slice alone, and what the grain gets is what that slice
 * gives, in proportion to the volume there; nothing in any other. */
static void a_slice_gives_what_its_grain_gets(void **state)
{
  (void) state;
  enum { N = 40 };
  double edge[N + 1], phi[N], hindrance[N], scratch[2 * N], V[N];
  for (int n = 0; n <= N; n++) edge[n] = 0.001 * n * (1.0 + 0.01 * n);
  for (int n = 0; n < N; n++) phi[n] = 0.6 / (1.0 + 0.1 * n);
  const sd_vans_mesh mesh = {N, 0.02, 0.0, edge};
  const sd_vans_force_law law = {.rho = 1030, .eta = 2e-3, .exponent = 3.1, .felt_by_volume = 1};
  hindrance_of(N, phi, law.exponent, hindrance);
  for (int k = 0; k < 50; k++) {
    const double a = 0.0031, x[3] = {0, 0, 0.02 + a + 0.0005 * k}, v[3] = {0.3, 0, 0},
                 whole = 4.0 / 3.0 * SD_PI * a * a * a;
    const sd_vans_grains grain = {1, x, v, &a, NULL, NULL, NULL, NULL};
    const sd_vans_averaging how = {0, 0, NULL, NULL, NULL};
    const sd_vans_reach reach = sd_vans_slices(&mesh, SD_VANS_CONSISTENT, 0, x[2], a, V);
    for (int moves = 0; moves < N; moves++) {
      double U[N + 1], F[3], drag, sums[N * SD_VANS_ROWS] = {0}, whole_drag[3];
      for (int n = 0; n <= N; n++) U[n] = v[0];
      U[moves + 1] += 0.2;
      const sd_vans_ambient stream = {&mesh, &law, U, hindrance};
      sd_vans_forces(&stream, &grain, F, &drag);
      sd_vans_average(&stream, &how, &grain, sums, scratch);
      yade_drag(law.rho, law.eta, a, hindrance[moves], (double[3]){0.2, 0, 0}, whole_drag);
      const int reached = moves >= reach.first && moves < reach.first + reach.count;
      const double expected = reached ? V[moves - reach.first] / whole * whole_drag[0] : 0.0;
      assert_true(fabs(drag - expected) < 1e-15 * whole_drag[0]);
      for (int n = 0; n < N; n++)
        assert_true(fabs(sums[n * SD_VANS_ROWS + SD_VANS_DRAG] / whole - (n == moves ? drag : 0.0)) <
                    1e-15 * whole_drag[0]);
    }
  }
}

/* Stokes' drag in a parabola U = c z^2: the mean over the sphere is c (z^2 + a^2/5). Second order in
 * dz, where the water at the centre alone jumps with the slices, and to 1 % with dz = d/4. */
static void drag_by_volume_converges(void **state)
{
  (void) state;
  const double a = 0.003, c = 700.0, H = 0.06;
  double error[2][5];
  for (int felt = 0; felt < 2; felt++)
    for (int level = 0; level < 5; level++) {
      enum { MOST = 321 };
      const int N = 20 * (1 << level);
      double edge[MOST], U[MOST], hindrance[MOST], largest = 0.0;
      for (int n = 0; n <= N; n++) edge[n] = H * n / N;
      for (int n = 0; n < N; n++) {
        const double middle = 0.5 * (edge[n] + edge[n + 1]);
        U[n + 1] = c * middle * middle;
        hindrance[n] = 1.0;
      }
      U[0] = 0.0;
      const sd_vans_mesh mesh = {N, 0.0, H / N, edge};
      const sd_vans_force_law law = {.rho = 1e-9, .eta = 2e-3, .felt_by_volume = felt};
      for (int k = 0; k < 60; k++) {
        const double z = 0.02 + 0.003 * k / 60.0, x[3] = {0, 0, z}, v[3] = {0};
        const sd_vans_grains grain = {1, x, v, &a, NULL, NULL, NULL, NULL};
        double F[3];
        const sd_vans_ambient stream = {&mesh, &law, U, hindrance};
        sd_vans_forces(&stream, &grain, F, NULL);
        const double exact = 0.5 * SD_PI * a * 12.2 * law.eta * c * (z * z + 0.2 * a * a);
        largest = fmax(largest, fabs(F[0] / exact - 1.0));
      }
      error[felt][level] = largest;
    }
  for (int level = 1; level < 5; level++) {
    const double order = log(error[1][level - 1] / error[1][level]) / log(2.0);
    printf("    dz = d/%d: at the centre %.1e, by volume %.1e, order %.2f\n", 2 << level,
           error[0][level], error[1][level], order);
    assert_true(order > 1.5 && error[1][level] < 0.2 * error[0][level]);
  }
  assert_true(error[1][1] < 0.01);
}

/* Same keys, same numbers; a change of any key changes all. */
static void fluctuations_depend_on_their_keys_alone(void **state)
{
  (void) state;
  double a[3], b[3];
  sd_vans_normal3(1, 2, 3, a);
  sd_vans_normal3(1, 2, 3, b);
  assert_memory_equal(a, b, sizeof a);
  static const uint64_t keys[3][3] = {{2, 2, 3}, {1, 3, 3}, {1, 2, 4}};
  for (int k = 0; k < 3; k++) {
    sd_vans_normal3(keys[k][0], keys[k][1], keys[k][2], b);
    for (int d = 0; d < 3; d++) assert_true(a[d] != b[d]);
  }
}

static void eddies_live_as_long_as_the_length_over_the_velocity(void **state)
{
  (void) state;
  assert_true(fabs(sd_vans_eddy_life(0.2, 1e-6, 0.05, 7.0, 1e-3) - 0.33 * 0.41 * 0.2 / 0.05) < 1e-15);
  assert_true(fabs(sd_vans_eddy_life(-1.0, 1e-6, 0.05, 7.0, 1e-3) - 0.33 * 0.41 * 11.6e-6 / 0.0025) <
              1e-15);
  assert_true(sd_vans_eddy_life(1e9, 1e-6, 0.05, 7.0, 1e-3) == 7.0 &&
              sd_vans_eddy_life(1.0, 1e-6, 0.0, 7.0, 1e-3) == 10e-3);
}

/* Two equal spheres at distance h share a lens of volume pi (4a+h)(2a-h)^2/12; three in a chain; a sphere inside
 * another; three that meet. */
static void overlaps_count_once(void **state)
{
  (void) state;
  const double a = 0.4, h = 0.5, all = 4.0 / 3.0 * SD_PI * a * a * a,
               lens = SD_PI * (4 * a + h) * (2 * a - h) * (2 * a - h) / 12;
  const double chain[9] = {0, 0, 0, h, 0, 0, 2 * h, 0, 0}, radii[3] = {a, a, a};
  assert_true(fabs(sd_vans_union_share(2, chain, radii, 0) - (1 - lens / 2 / all)) < 1e-14);
  assert_true(fabs(sd_vans_union_share(3, chain, radii, 1) - (1 - lens / all)) < 1e-14);
  const double within[6] = {0, 0, 0, 0.1, 0, 0}, unequal[2] = {0.4, 0.2}, same[6] = {0};
  assert_true(sd_vans_union_share(2, within, unequal, 0) == 1.0 &&
              sd_vans_union_share(2, within, unequal, 1) == 0.0);
  assert_true(sd_vans_union_share(2, same, radii, 0) == 1.0 &&
              sd_vans_union_share(2, same, radii, 1) == 0.0);
  /* triangle with a common core, by counting points of a fine lattice: 1e-3 */
  const double side = 0.45, triangle[9] = {0, 0, 0, side, 0, 0, side / 2, side * sqrt(3) / 2, 0};
  double sum = 0.0;
  for (int i = 0; i < 3; i++) sum += sd_vans_union_share(3, triangle, radii, i) * all;
  long inside = 0;
  enum { LATTICE = 160 };
  const double step = 1.4 / LATTICE;
  for (int i = 0; i < LATTICE; i++)
    for (int j = 0; j < LATTICE; j++)
      for (int k = 0; k < LATTICE; k++) {
        const double p[3] = {-0.45 + (i + 0.5) * step, -0.45 + (j + 0.5) * step,
                             -0.7 + (k + 0.5) * step};
        for (int s = 0; s < 3; s++) {
          const double x = p[0] - triangle[3 * s], y = p[1] - triangle[3 * s + 1], z = p[2];
          if (x * x + y * y + z * z < a * a) {
            inside++;
            break;
          }
        }
      }
  assert_true(fabs(sum / (inside * step * step * step) - 1) < 1e-3);
}

/* A pressure gradient pushes each grain by its volume, and that of all by that of all of them. */
static void grains_have_the_volume_that_a_pressure_pushes(void **state)
{
  (void) state;
  enum { N = 3 };
  const double edge[N + 1] = {0, 1, 2, 3}, U[N + 1] = {0}, hindrance[N] = {1, 1, 1}, dpdx = -0.7;
  const double x[9] = {0, 0, 0.5, 0, 0, 1.5, 0, 0, 2.5}, v[9] = {0}, a[3] = {0.3, 0.2, 0.4}, weight[3] = {1, 0.6, 0.9};
  const unsigned char take[3] = {1, 1, 0};
  const sd_vans_mesh mesh = {N, 0, 1, edge};
  const sd_vans_force_law law = {.rho = 1030, .eta = 2e-3, .dpdx = dpdx};
  const sd_vans_ambient stream = {&mesh, &law, U, hindrance};
  const sd_vans_grains grains = {3, x, v, a, NULL, weight, take, NULL};
  double F[9];
  sd_vans_forces(&stream, &grains, F, NULL);
  const double V = 4.0 / 3.0 * SD_PI * (0.027 + 0.6 * 0.008);
  CHECK_NEAR(sd_vans_volume_of_grains(&grains), V, 1e-15);
  CHECK_NEAR(F[0] + F[3], -V * dpdx, 1e-15);
}

/* In a row of spheres that touch nobody is nearer than a contact; whoever is pressed into any other is found, also if
 * a small one stands between them. */
static void who_is_pressed_is_found(void **state)
{
  (void) state;
  double x[15] = {0, 0, 0, 0.9, 1.4, 0, 2, 0, 0, 4, 0, 0, 6, 0, 0}, a[5] = {1, 0.3, 1, 1, 1};
  assert_false(sd_vans_any_nearer(5, x, a, 0.9));
  for (int k = 1; k < 5; k++) {
    double y[15];
    memcpy(y, x, sizeof(y));
    y[3 * k] -= 0.21;
    y[3 * k + 1] -= k == 1 ? 0.5 : 0.0;
    assert_true(sd_vans_any_nearer(5, y, a, 0.9));
    assert_false(sd_vans_any_nearer(5, y, a, 0.6));
  }
}

/* Forces along x, then those along z, of slices of any height. */
static void forces_are_per_volume_of_their_slice(void **state)
{
  (void) state;
  const double edge[4] = {0, 1, 3, 6}, forces[6] = {2, 4, 6, -8, -16, -24};
  const sd_vans_mesh mesh = {3, 0.2, 0.0, edge};
  double density[6];
  sd_vans_force_density(&mesh, 2.0, forces, density);
  for (int k = 0; k < 6; k++) CHECK_NEAR(density[k], k < 3 ? 1.0 : -4.0, 1e-15);
}

/* Of a grain that accelerates evenly the steps of velocity Verlet show that, the first one as well, which is half a
 * step from the velocity that a run begins with; of what nobody has seen nothing is said. */
static void steps_show_the_acceleration(void **state)
{
  (void) state;
  const double dt = 0.02, a[3] = {0.7, -1.1, 9.7}, v[3] = {0.3, 0.2, -0.4};
  sd_vans_motion motion = {{0}, 0.0}, unseen = {{0}, 0.0};
  double now[3], found[3] = {7.0, 7.0, 7.0};
  sd_vans_motion_step(&unseen, v, dt, found);
  for (int d = 0; d < 3; d++) assert_true(found[d] == 7.0 && unseen.v[d] == v[d]);
  sd_vans_motion_begin(&motion, v);
  for (int step = 0; step < 3; step++) {
    for (int d = 0; d < 3; d++) now[d] = v[d] + (step + 0.5) * dt * a[d];
    sd_vans_motion_step(&motion, now, dt, found);
    for (int d = 0; d < 3; d++) CHECK_NEAR(found[d], a[d], 1e-12);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(slices_sum_to_the_sphere),
      cmocka_unit_test(slices_of_uneven_mesh_sum_to_the_sphere),
      cmocka_unit_test(slices_end_at_the_mesh),
      cmocka_unit_test(yade_mirrors_the_slices),
      cmocka_unit_test(point_grains_stay_in_one_slice),
      cmocka_unit_test(who_is_pressed_is_found),
      cmocka_unit_test(forces_are_per_volume_of_their_slice),
      cmocka_unit_test(steps_show_the_acceleration),
      cmocka_unit_test(drag_balances_weight_at_terminal_velocity),
      cmocka_unit_test(hindrance_has_its_exponent),
      cmocka_unit_test(lift_sees_both_ends_of_the_grain),
      cmocka_unit_test(convective_force_is_taken_off),
      cmocka_unit_test(grains_outside_feel_the_end_values),
      cmocka_unit_test(a_slice_gives_what_its_grain_gets),
      cmocka_unit_test(drag_by_volume_converges),
      cmocka_unit_test(fluctuations_have_their_moments),
      cmocka_unit_test(fluctuations_depend_on_their_keys_alone),
      cmocka_unit_test(eddies_live_as_long_as_the_length_over_the_velocity),
      cmocka_unit_test(overlaps_count_once),
      cmocka_unit_test(grains_have_the_volume_that_a_pressure_pushes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
