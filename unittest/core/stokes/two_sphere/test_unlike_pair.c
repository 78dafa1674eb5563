/* Two spheres of unlike radii alone, as shells by radius with the film between them, in many orientations, against
 * the exact two: under eleven loads. */
#include "table.h"
#include "pair_blocks.h"

#include "sd_linear.h"
#include "sd_shell_pair.h"

enum { MODES = SD_SHELL_MODES, BOTH = SD_SHELL_BOTH, LOADS = 11, WAYS = 12 };

static const char *const names[LOADS] = {"F_l along",  "F_l across", "F_s along", "F_s across",
                                         "T_l along",  "T_l across", "T_s along", "T_s across",
                                         "E along",    "E shear",    "E across"};
/* As the table has them: fluid of a strain along the line, in a plane with it, across it */
static const double strains[3][9] = {
    {0.40824829046386302, 0, 0, 0, 0.40824829046386302, 0, 0, 0, -0.81649658092772603},
    {0, 0, 0.70710678118654752, 0, 0, 0, 0.70710678118654752, 0, 0},
    {0.70710678118654752, 0, 0, 0, -0.70710678118654752, 0, 0, 0, 0}};

/* U and W of the smaller sphere, then of the larger one, in the frame of the pair, z from the first to the second */
typedef struct {
  double V[LOADS][12];
} answers;

/* Rows of unlike_pairs.csv of this ratio and gap */
static answers exact_pair(double ratio, double xi)
{
  answers out = {{{0.0}}};
  int rows = 0;
  table t = table_open("multiblob/unlike_pairs.csv");
  while (table_next(&t)) {
    if (table_number(&t, 0) != ratio || table_number(&t, 1) != xi) continue;
    for (int k = 0; k < LOADS; k++) {
      if (strcmp(t.column[2], names[k])) continue;
      const int along = strstr(names[k], "along") != NULL, U = along ? 2 : 0, W = along ? 5 : 4;
      for (int q = 0; q < 2; q++) {
        out.V[k][6 * q + U] = table_number(&t, q ? 3 : 5);
        out.V[k][6 * q + W] = table_number(&t, q ? 4 : 6);
      }
      rows++;
    }
  }
  assert_int_equal(rows, LOADS);
  return out;
}

/* G [12 22] of U, a W of both and, behind them, a E of both, as columns, in the frame T, its axes as rows */
static void in_frame(const double *G, const double T[9], double R[12][22])
{
  static const int first[4] = {0, SD_SHELL_TURN, MODES, MODES + SD_SHELL_TURN};
  for (int p = 0; p < 12; p++)
    for (int q = 0; q < 12; q++) {
      R[p][q] = 0.0;
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
          R[p][q] += T[3 * (p % 3) + i] * G[BOTH * (first[p / 3] + i) + first[q / 3] + j] * T[3 * (q % 3) + j];
    }
  for (int p = 0; p < 12; p++)
    for (int q = 0; q < 2; q++)
      for (int e = 0; e < 5; e++) {
        double sum = 0.0;
        for (int i = 0; i < 3; i++)
          sum += T[3 * (p % 3) + i] * G[BOTH * (first[p / 3] + i) + MODES * q + SD_SHELL_STRAIN + e];
        R[p][12 + 5 * q + e] = sum;
      }
}

/* Components [5] of the strain E of the frame T in the axes of the shell */
static void components(const double E[9], const double T[9], double c[5])
{
  double S[9] = {0.0};
  for (int k = 0; k < 81; k++) {
    const int p = k / 27, q = k / 9 % 3, i = k / 3 % 3, j = k % 3;
    S[3 * i + j] += T[3 * p + i] * E[3 * p + q] * T[3 * q + j];
  }
  const double half = sqrt(2.0), sixth = sqrt(1.0 / 6.0);
  c[0] = half * S[1], c[1] = half * S[2], c[2] = half * S[5];
  c[3] = (S[0] - S[4]) / half, c[4] = sixth * (2.0 * S[8] - S[0] - S[4]);
}

/* R += the film L, torques over the radii */
static void add_film(const sd_films *films, int small, int large, const double a[2], double xi, double L[12][12],
                     double R[12][22])
{
  const double z[3] = {0, 0, 1}, harmonic = xi / sd_film_harmonic(a[0], a[1]);
  const double s = fmin(fmax(2.0 * harmonic - 1.0, 0.0), 1.0), fading = 1.0 - s * s * (3.0 - 2.0 * s);
  double B[3][36];
  sd_film film;
  memset(L, 0, sizeof(double) * 144);
  if (fading == 0.0) return;
  assert_int_equal(sd_film_between(films, small, large, a[0], a[1], xi, &film), SD_OK);
  const sd_pair_resistance pair = sd_film_resistance(&film, (a[0] + a[1]) * (1.0 + 0.5 * xi), fading);
  pair_blocks(&pair, z, B[0], B[1], B[2]);
  for (int p = 0; p < 12; p++)
    for (int q = 0; q < 12; q++) {
      const double arm = (p % 6 > 2 ? a[p / 6] : 1.0) * (q % 6 > 2 ? a[q / 6] : 1.0);
      const double *block = B[p / 6 + q / 6];
      L[p][q] = (p / 6 > q / 6 ? block[6 * (q % 6) + p % 6] : block[6 * (p % 6) + q % 6]) / arm;
      R[p][q] += L[p][q];
    }
}

static answers shells(sd_shell_pair *p, const sd_films *films, const sd_film_kind *kind, double ratio, double xi,
                      const sd_shell_way *way)
{
  const double a[2] = {1.0 / ratio, 1.0}, distance = (a[0] + a[1]) * (1.0 + 0.5 * xi);
  double G[BOTH * BOTH], T[9], R[12][22], L[12][12], M[144], F[LOADS][12] = {{0.0}};
  answers out;
  sd_shell_pair_resistance(p, ratio, xi, way, G);
  memcpy(T + 6, way->d, 3 * sizeof(double));
  sd_across(T + 6, T);
  sd_normalize(T);
  sd_cross(T + 6, T, T + 3);
  in_frame(G, T, R);
  add_film(films, kind->small, kind->large, a, xi, L, R);
  for (int k = 0; k < 8; k++) {
    const int small = k / 2 % 2, torque = k > 3, component = k % 2 ? (torque ? 1 : 0) : 2;
    F[k][(small ? 0 : 6) + 3 * torque + component] = torque ? 1.0 / a[!small] : 1.0;
  }
  for (int k = 8; k < LOADS; k++) {
    double c[5];
    components(strains[k - 8], T, c);
    for (int e = 0; e < 12; e++) {
      for (int q = 0; q < 10; q++) F[k][e] += R[e][12 + q] * a[q / 5] * c[q % 5];
      /* a film resists what the fluid does to the line of centres as well: velocities are those less the flow */
      for (int d = 0; d < 3; d++) F[k][e] += L[e][d] * distance * strains[k - 8][3 * d + 2];
    }
  }
  for (int e = 0; e < 144; e++) M[e] = R[e / 12][e % 12];
  assert_int_equal(sd_cholesky_solve(12, M, LOADS, F[0]), SD_OK);
  for (int k = 0; k < LOADS; k++)
    for (int e = 0; e < 12; e++) out.V[k][e] = F[k][e] / (e % 6 > 2 ? a[e / 6] : 1.0);
  return out;
}

/* Motion of sphere q, spins as the speed of its surface, in the largest of velocity and spin */
static double size_of(const double V[12], const double W[12], int q, double a)
{
  double sum = 0.0;
  for (int e = 0; e < 6; e++) sum += pow((e > 2 ? a : 1.0) * (V[6 * q + e] - (W ? W[6 * q + e] : 0.0)), 2);
  return sqrt(sum);
}

/* Over the largest exact motion of the smaller sphere by that kind of load, that of a strain at least a/2 */
static double error_of(const answers *found, const answers *exact, int k, double a)
{
  const int first = k < 8 ? k / 2 * 2 : 8, last = k < 8 ? first + 2 : LOADS;
  double scale = k < 8 ? 0.0 : 0.5 * a;
  for (int j = first; j < last; j++) scale = fmax(scale, size_of(exact->V[j], NULL, 0, a));
  return 100.0 * size_of(found->V[k], exact->V[k], 0, a) / scale;
}

/* Per cent, the mean over orientations and the worst one, of the worst load */
static void error_at(sd_shell_pair *p, const sd_films *films, const sd_film_kind *kind, double ratio, double xi,
                     double worst[2])
{
  sd_shell_way ways[WAYS];
  const answers exact = exact_pair(ratio, xi);
  double mean[LOADS] = {0.0};
  sd_shell_ways(WAYS, ways);
  worst[0] = worst[1] = 0.0;
  for (int o = 0; o < WAYS; o++) {
    const answers found = shells(p, films, kind, ratio, xi, ways + o);
    for (int k = 0; k < LOADS; k++) {
      const double error = error_of(&found, &exact, k, 1.0 / ratio);
      mean[k] += error / WAYS;
      worst[1] = fmax(worst[1], error);
    }
  }
  for (int k = 0; k < LOADS; k++) worst[0] = fmax(worst[0], mean[k]);
}

/* The kind of pair of a smaller sphere of 12 points at a ratio by the rule */
static const sd_film_kind *kind_at(double ratio)
{
  static const sd_film_kind twelve = {.large = 12, .small = 12};
  return ratio <= 1.5 ? &twelve : sd_film_kinds + (ratio <= 2.5 ? 0 : ratio <= 5.0 ? 1 : 2);
}

/* Ratios of 1.5 to 10, points by radius, gaps of 0.01 to 1 mean radius: the mean over orientations and the worst
 * of them, per cent. Spheres that are all alike, to 1.5, are as good as equal ones. */
static void shells_by_radius(void **state)
{
  (void) state;
  static const double gaps[] = {0.01, 0.055, 0.1, 0.3, 1.0}, ratios[] = {1.5, 2, 2.5, 3, 4, 5, 7, 10};
  enum { GAPS = sizeof gaps / sizeof *gaps, RATIOS = sizeof ratios / sizeof *ratios };
  sd_two_sphere *functions;
  sd_films films;
  assert_int_equal(sd_two_sphere_create(SD_FILM_LARGEST_RATIO, &functions), SD_OK);
  assert_int_equal(sd_films_create_by_radius(1, functions, &films), SD_OK);
  for (int r = 0; r < RATIOS; r++) {
    const sd_film_kind *kind = kind_at(ratios[r]);
    sd_shell_blob one = sd_shell_blob_by_radius(kind->small), two = sd_shell_blob_by_radius(kind->large);
    sd_shell_pair *p = sd_shell_pair_create(&one, &two);
    for (int g = 0; g < GAPS; g++) {
      double worst[2];
      error_at(p, &films, kind, ratios[r], gaps[g], worst);
      print_message("%4.1f, %3d and 12 points, xi %5.3f: %.2f %%, worst orientation %.2f\n", ratios[r], kind->large,
                    gaps[g], worst[0], worst[1]);
      assert_true(worst[0] < 2.2 && worst[1] < (kind->large == 12 ? 4.0 : 3.3));
      if (gaps[g] == 1.0 && kind->large > 12) assert_true(worst[1] < 0.8);
    }
    sd_shell_pair_free(p);
    free(one.r);
    free(two.r);
  }
  sd_two_sphere_free(functions);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(shells_by_radius)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
