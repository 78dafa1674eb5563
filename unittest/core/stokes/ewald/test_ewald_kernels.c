/* Kernels of each instruction set against those in plain C. */
#include "periodic.h"

#include <limits.h>

#include "sd_ewald_pairs.h"
#include "sd_ewald_runs.h"
#include "sd_grid_internal.h"
#include "sd_real.h"

enum { N = 120, SIDE = 40, ROW = 3 * SIDE + 16 };

static const sd_isa sets[] = {SD_ISA_BASELINE, SD_ISA_AVX2, SD_ISA_AVX512};

typedef struct {
  double x[3 * N], a[N], w[N], F[6 * N];
} cloud;

static cloud make(uint64_t seed, int equal)
{
  cloud c;
  for (int i = 0; i < N; i++) {
    for (int d = 0; d < 3; d++) c.x[3 * i + d] = uniform(&seed, 0, 12);
    c.a[i] = equal ? 0.8 : uniform(&seed, 0.3, 1.2); /* some overlap */
    c.w[i] = uniform(&seed, 0.7, 1.3);
    for (int d = 0; d < 6; d++) c.F[6 * i + d] = uniform(&seed, -1, 1);
  }
  return c;
}

/* One sphere is just beyond the range of another, and within that of a third beside it, which may share its list. */
static void put_one_at_the_end(const sd_ewald *how, cloud *c)
{
  for (int d = 0; d < 3; d++) {
    c->x[3 + d] = c->x[d] + (d == 0 ? 0.01 : 0.0);
    c->x[6 + d] = c->x[d] + (d == 0 ? (1.0 + 1e-7) * how->range : 0.0);
  }
}

static void near_parts_agree(void **state)
{
  (void) state;
  const sd_ewald_box box = {.periodic = 1, .edge = {12, 12, 12}};
  const sd_groups none = {0};
  for (int equal = 0; equal < 2; equal++)
    for (int width = 3; width <= 6; width += 3)
      for (int digits = 1; digits <= 12; digits += 3) { /* each has another degree of polynomial */
        cloud c = make(5, equal);
        const sd_spheres spheres = {c.x, c.a, c.w};
        const sd_ewald how = periodic_choose(&box, c.a, N, width, pow(10.0, -digits));
        put_one_at_the_end(&how, &c);
        double expected[6 * N], u[6 * N], scale = 0.0;
        for (int k = -1; k < 3; k++) {
          const sd_isa isa = k < 0 ? SD_ISA_PLAIN : sets[k];
          if (!sd_isa_supported(isa)) continue;
          sd_ewald_pairs p = {0};
          sd_ewald_pairs_create(&p, &how, SD_KERNELS_OF(sd_ewald, plain, isa), width);
          assert_int_equal(sd_ewald_pairs_place(&p, &spheres, &none, N - 20, N, 0), SD_OK); /* the last are ghosts */
          assert_int_equal(sd_ewald_pairs_load(&p, N - 20, c.F, c.F + width * (N - 20), NULL, NULL), SD_OK);
          sd_ewald_pairs_apply(&p);
          sd_ewald_pairs_take(&p, N - 20, c.F, NULL, NULL, NULL, k < 0 ? expected : u);
          sd_ewald_pairs_free(&p);
          for (int i = 0; i < width * (N - 20); i++) {
            if (k < 0) scale = fmax(scale, fabs(expected[i]));
            else CHECK_NEAR(u[i], expected[i], 1e-13 * scale);
          }
        }
        assert_true(scale > 0.0);
      }
}

/* Where spheres stand on a brick (sd_spreading) */
typedef struct {
  int corner[N][3];
  double place[N][4];
} places;

/* Spheres without an order on a brick, with all kinds of windows */
static sd_spreading spheres_on_a_brick(const cloud *c, places *p, const sd_window *w, int terms, int width)
{
  sd_spreading s = {.n = N, .width = width, .terms = terms, .window = w, .place = p->place, .row = ROW,
                    .layer = (long) ROW * SIDE};
  s.corner = (const int(*)[3]) p->corner;
  for (int i = 0; i < N; i++) {
    p->place[i][3] = terms % 2 ? 0.0 : 0.1 * c->a[i];
    for (int d = 0; d < 3; d++) {
      const double at = c->x[3 * i + d] / 12.0 * (SIDE - w->points - 1);
      p->corner[i][d] = (int) at;
      p->place[i][d] = 2.0 * (at - floor(at)) - 1.0;
    }
  }
  for (int d = 0; d < 3; d++) {
    s.gradient[d][d] = 0.9 + 0.1 * d;
    s.metric[d] = 0.8 + 0.1 * d;
    if (terms == 4) s.metric[3 + d] = s.gradient[d][(d + 1) % 3] = 0.2 - 0.1 * d;
  }
  return s;
}

static void spreading_and_interpolation_agree(void **state)
{
  (void) state;
  const size_t numbers = (size_t) SIDE * SIDE * ROW + 64;
  double *expected = malloc(sizeof(double) * numbers), *brick = malloc(sizeof(double) * numbers);
  const cloud c = make(7, 0);
  for (int points = 4; points <= SD_WINDOW_MOST_POINTS; points++)
    for (int terms = 1; terms <= 4; terms++) {
      static sd_window w;
      places p;
      double first[6 * N], F[6 * N];
      const int width = terms == 3 || (terms == 4 && points % 2) ? 6 : 3;
      sd_window_fit(points, 2.25 * points, 0, 0.0, 1e-9, &w);
      for (int k = -1; k < 3; k++) {
        const sd_isa isa = k < 0 ? SD_ISA_PLAIN : sets[k];
        if (!sd_isa_supported(isa)) continue;
        sd_spreading s = spheres_on_a_brick(&c, &p, &w, terms, width);
        double largest = 0.0;
        s.brick = k < 0 ? expected : brick;
        s.F = k < 0 ? first : F;
        memcpy(s.F, c.F, sizeof(c.F));
        memset(s.brick, 0, sizeof(double) * numbers);
        SD_KERNELS_OF(sd_ewald, plain, isa)->spread(&s);
        for (size_t g = 0; g < numbers; g++) largest = fmax(largest, fabs(expected[g]));
        for (size_t g = 0; g < numbers && k >= 0; g++) CHECK_NEAR(brick[g], expected[g], 1e-13 * largest);
        SD_KERNELS_OF(sd_ewald, plain, isa)->interpolate(&s);
        for (int i = 0; i < width * N && k >= 0; i++) CHECK_NEAR(F[i], first[i], 1e-12 * largest * points * points);
      }
    }
  free(expected);
  free(brick);
}

/* Wherever a sphere stands, and so for the slopes: the sums over its points of the window times 1, s and s^2 are the
 * integrals. By the Kaiser-Bessel function alone those of four points differ by 6e-4 and more. */
static void sums_over_points_of_a_window_are_integrals(void **state)
{
  (void) state;
  for (int points = 4; points <= 16; points++) {
    sd_window w;
    const double beta = 2.25 * points, whole = sd_window_transform(points, beta, 0.0), theta = 1e-4;
    sd_window_fit(points, beta, 2, 0.0, 1e-9, &w);
    for (double v = -1.0; v <= 1.0; v += 0.125) {
      double sum[3] = {0.0}, slope = 0.0;
      for (int k = 0; k < points; k++) {
        const double s = k + 1 - 0.5 * (v + 1.0 + points);
        double phi = 0.0;
        for (int m = w.degree; m >= 0; m--) {
          phi += w.coefficient[m][k] * pow(v, m);
          slope += m > 0 ? m * w.coefficient[m][k] * pow(v, m - 1) : 0.0;
        }
        for (int m = 0; m < 3; m++) sum[m] += phi * pow(s, m);
      }
      CHECK_NEAR(sum[0], whole, 1e-11);
      CHECK_NEAR(sum[1], 0.0, 1e-10);
      CHECK_NEAR(sum[2], -whole * sd_window_slope(points, beta, theta) / theta, 1e-6);
      CHECK_NEAR(slope, 0.0, 1e-9);
    }
  }
}

/* A bend adds to what a sphere on a point of the grid spreads of s^2, and takes as much from one between two points;
 * not to the whole. */
static void a_bend_of_a_window_is_opposite_between_points(void **state)
{
  (void) state;
  enum { POINTS = 6 };
  const double beta = 2.25 * POINTS, bend = 1e-4, place[] = {-1.0, -0.5, 0.0, 0.5};
  double changed[4];
  sd_window plain, bent;
  sd_window_fit(POINTS, beta, 2, 0.0, 1e-9, &plain);
  sd_window_fit(POINTS, beta, 2, bend, 1e-9, &bent);
  for (int i = 0; i < 4; i++) {
    double all = 0.0;
    changed[i] = 0.0;
    for (int k = 0; k < POINTS; k++) {
      const double s = k + 1 - 0.5 * (place[i] + 1.0 + POINTS);
      double more = 0.0;
      for (int m = bent.degree; m >= 0; m--) more = more * place[i] + bent.coefficient[m][k] - plain.coefficient[m][k];
      all += more;
      changed[i] += more * s * s;
    }
    CHECK_NEAR(all, 0.0, 1e-12);
  }
  assert_true(changed[0] > 0.1 * bend);
  CHECK_NEAR(changed[2], -changed[0], 1e-2 * changed[0]);
  CHECK_NEAR(changed[1], 0.0, 1e-2 * changed[0]);
  CHECK_NEAR(changed[3], 0.0, 1e-2 * changed[0]);
}

/* Of equal spheres with torques the second term is nothing, in a tilted box too. */
static void three_terms_do_for_equal_spheres_with_torques(void **state)
{
  (void) state;
  const size_t numbers = (size_t) SIDE * SIDE * ROW + 64;
  double *brick[2], F[2][6 * N];
  const cloud c = make(7, 0);
  places p;
  sd_window w;
  sd_window_fit(6, 2.25 * 6, 0, 0.0, 1e-9, &w);
  for (int k = 0; k < 2; k++) {
    brick[k] = calloc(numbers, sizeof(double));
    sd_spreading s = spheres_on_a_brick(&c, &p, &w, 4, 6);
    s.terms = 3 + k;
    for (int i = 0; i < N; i++) p.place[i][3] = 0.0;
    memcpy(F[k], c.F, sizeof(c.F));
    s.brick = brick[k];
    s.F = F[k];
    SD_KERNELS_OF(sd_ewald, plain, SD_ISA_PLAIN)->spread(&s);
    SD_KERNELS_OF(sd_ewald, plain, SD_ISA_PLAIN)->interpolate(&s);
  }
  double largest = 0.0;
  for (int i = 0; i < 6 * N; i++) largest = fmax(largest, fabs(F[1][i]));
  for (size_t g = 0; g < numbers; g++) CHECK_NEAR(brick[0][g], brick[1][g], 1e-14);
  for (int i = 0; i < 6 * N; i++) CHECK_NEAR(F[0][i], F[1][i], 1e-13 * largest);
  assert_true(largest > 0.0);
  for (int k = 0; k < 2; k++) free(brick[k]);
}

/* Kernels of floats, of each instruction set, against those of doubles: pairs, of which some overlap and two are at one
   point */
static void near_parts_of_floats_are_those_of_doubles(void **state)
{
  (void) state;
  const sd_ewald_box box = {.periodic = 1, .edge = {12, 12, 12}};
  for (int equal = 0; equal < 2; equal++)
    for (int width = 3; width <= 6; width += 3)
      for (int digits = 1; digits <= 5; digits++) {
        cloud c = make(5, equal);
        memcpy(c.x + 3, c.x, 3 * sizeof(double));
        const sd_spheres spheres = {c.x, c.a, c.w};
        const sd_groups none = {0};
        const sd_ewald how = periodic_choose(&box, c.a, N, width, pow(10.0, -digits));
        assert_true(how.single);
        double expected[6 * N], u[6 * N], scale = 0.0;
        for (int k = -2; k < 3; k++) {
          const sd_isa isa = k < 0 ? SD_ISA_PLAIN : sets[k];
          if (!sd_isa_supported(isa)) continue;
          sd_ewald_pairs p = {0};
          sd_ewald_pairs_create(&p, &how, k == -2 ? SD_KERNELS_OF(sd_ewald, plain, isa) :
                                SD_KERNELS_OF(sd_ewald_single, plain, isa),
                                width);
          assert_int_equal(sd_ewald_pairs_place(&p, &spheres, &none, N - 20, N, 0), SD_OK); /* the last are ghosts */
          assert_int_equal(sd_ewald_pairs_load(&p, N - 20, c.F, c.F + width * (N - 20), NULL, NULL), SD_OK);
          sd_ewald_pairs_apply(&p);
          sd_ewald_pairs_take(&p, N - 20, c.F, NULL, NULL, NULL, k == -2 ? expected : u);
          sd_ewald_pairs_free(&p);
          for (int i = 0; i < width * (N - 20); i++) {
            if (k == -2) scale = fmax(scale, fabs(expected[i]));
            else CHECK_NEAR(u[i], expected[i], 1e-6 * scale);
          }
        }
        assert_true(scale > 0.0);
      }
}

/* What floats of every set spread and interpolate is as that of plain doubles, which go point by point. */
static void floats_are_as_doubles(sd_spreading *s, const cloud *c, int width)
{
  const size_t numbers = (size_t) ROW * SIDE * SIDE + 64;
  double *expected = calloc(numbers, sizeof(double)), first[6 * N], largest = 0.0, fastest = 0.0;
  float *brick = malloc(sizeof(float) * numbers), F[6 * N], place[4 * N];
  memcpy(first, c->F, sizeof(first));
  s->brick = expected;
  s->F = first;
  SD_KERNELS_OF(sd_ewald, plain, SD_ISA_PLAIN)->spread(s);
  SD_KERNELS_OF(sd_ewald, plain, SD_ISA_PLAIN)->interpolate(s);
  for (size_t g = 0; g < numbers; g++) largest = fmax(largest, fabs(expected[g]));
  for (int i = 0; i < width * N; i++) fastest = fmax(fastest, fabs(first[i]));
  for (int i = 0; i < 4 * N; i++) place[i] = (float) ((const double *) s->place)[i];
  s->place = place;
  s->brick = brick;
  s->F = F;
  for (int k = -1; k < 3; k++) {
    const sd_isa isa = k < 0 ? SD_ISA_PLAIN : sets[k];
    if (!sd_isa_supported(isa)) continue;
    for (int i = 0; i < width * N; i++) F[i] = (float) c->F[i];
    memset(brick, 0, sizeof(float) * numbers);
    SD_KERNELS_OF(sd_ewald_single, plain, isa)->spread(s);
    for (size_t g = 0; g < numbers; g++) CHECK_NEAR(brick[g], expected[g], 1e-6 * largest);
    SD_KERNELS_OF(sd_ewald_single, plain, isa)->interpolate(s);
    for (int i = 0; i < width * N; i++) CHECK_NEAR(F[i], first[i], 1e-6 * fastest);
  }
  free(expected);
  free(brick);
}

static void windows_of_floats_are_those_of_doubles(void **state)
{
  (void) state;
  const cloud c = make(3, 0);
  for (int points = 3; points <= 9; points++)
    for (int terms = 1; terms <= 4; terms++) {
      const int width = terms >= 3 ? 6 : 3;
      sd_window w;
      places p;
      sd_window_fit(points, 2.3 * points, 0, 0.0, 1e-5, &w);
      sd_spreading s = spheres_on_a_brick(&c, &p, &w, terms, width);
      floats_are_as_doubles(&s, &c, width);
    }
}

/* Ten shells of twelve points, the first too wide for a run, the last with a gap in its numbers: all is as that of
 * doubles one by one. */
static void points_side_by_side_are_spread_like_any(void **state)
{
  (void) state;
  const cloud c = make(11, 1);
  for (int points = 4; points <= 8; points++) {
    sd_window w;
    places p;
    sd_ewald_runs runs = {0};
    int sphere[N];
    uint64_t seed = 9;
    sd_window_fit(points, 2.25 * points, 0, 0.0, 1e-5, &w);
    sd_spreading s = spheres_on_a_brick(&c, &p, &w, 1, 3);
    for (int i = 0; i < N; i++) {
      sphere[i] = i + (i >= N - 6); /* the last shell in two halves */
      for (int d = 0; d < 3 && i >= 12; d++)
        p.corner[i][d] = p.corner[i / 12 * 12][d] / 2 + (int) uniform(&seed, 0, SD_RUN_WIDE - points + 0.99);
    }
    for (int d = 0; d < 3; d++) p.corner[0][d] = 0; /* and the first point of the first shell far from all others */
    assert_int_equal(sd_ewald_runs_find(&runs, N, sphere, s.corner, points), SD_OK);
    assert_true(runs.n >= 10);
    for (int k = 0, end = 0; k < runs.n; end = runs.run[k].first + runs.run[k].many, k++) {
      assert_true(runs.run[k].first >= end && runs.run[k].many <= SD_GROUP_POINTS && runs.run[k].first > 0);
      if (k == runs.n - 1) assert_int_equal(runs.run[k].many, 6);
    }
    s.runs = runs.n;
    s.run = runs.run;
    floats_are_as_doubles(&s, &c, 3);
    sd_ewald_runs_free(&runs);
  }
}

/* Spheres of a tilted frame, two of them on a point of the grid, find their corners and how far they are from there;
 * one that is no number, far away or out of bounds is not there. */
static void spheres_find_their_places_on_a_grid(void **state)
{
  (void) state;
  enum { MANY = SD_STAND_MANY - 3, POINTS = 4 };
  const sd_standing frame = {.origin = {0.3, -0.2, 0.1}, .gradient = {{2, 0.3, -0.1}, {0, 1.5, 0.2}, {0, 0, 1.25}},
                             .shift = -0.5 * POINTS, .lo = {-9, -9, -9}, .hi = {9, 9, 9}, .a_ref = 0.7, .equal = 1,
                             .first = {INT_MAX, INT_MAX, INT_MAX}, .last = {INT_MIN, INT_MIN, INT_MIN}};
  for (int k = -2; k < 6; k++) {
    const sd_isa isa = k < 0 ? SD_ISA_PLAIN : sets[k / 2];
    if (!sd_isa_supported(isa)) continue;
    const struct sd_ewald_kernels *kernels = k % 2 ? SD_KERNELS_OF(sd_ewald_single, plain, isa)
                                                   : SD_KERNELS_OF(sd_ewald, plain, isa);
    double place[4 * MANY]; /* of either precision */
    int corner[MANY][3];
    sd_standing s = frame;
    uint64_t seed = 8;
    for (int i = 0; i < MANY; i++)
      for (int d = 0; d < 3; d++) s.x[d][i] = i < 2 ? s.origin[d] - 4.0 * i * (d == 0) : uniform(&seed, -9, 9);
    for (int i = 0; i < MANY; i++) s.a[i] = s.a_ref;
    kernels->stand(&s, MANY, corner, place);
    for (int d = 0; d < 3; d++) {
      int64_t sum = 0;
      for (int i = 0; i < MANY; i++) {
        double at = -0.5 * POINTS;
        for (int c = 0; c < 3; c++) at += s.gradient[d][c] * (s.x[c][i] - s.origin[c]);
        assert_int_equal(corner[i][d], (int) floor(at) + 1);
        CHECK_NEAR(sd_number(place, kernels->bytes, 4 * i + d), 2.0 * (at - floor(at)) - 1.0, 1e-6);
        assert_in_range(corner[i][d] - s.first[d], 0, s.last[d] - s.first[d]);
        sum += corner[i][d];
      }
      assert_int_equal(s.sum[d], sum);
    }
    assert_true(s.equal && sd_number(place, kernels->bytes, 3) == 0.0);
    const double nowhere[] = {NAN, INFINITY, -9.1};
    for (int one = 0; one < 3; one++) {
      sd_standing other = s;
      other.x[1][5] = nowhere[one];
      other.a[7] = 0.8;
      kernels->stand(&other, MANY, corner, place);
      assert_true(other.last[1] > SD_NOT_THERE && !other.equal);
      CHECK_NEAR(sd_number(place, kernels->bytes, 4 * 7 + 3), (0.64 - 0.49) / 6.0, 1e-7);
    }
  }
}

static void rows_of_waves_agree(void **state)
{
  (void) state;
  enum { HALF = 13 };
  uint64_t seed = 4;
  double B[6 * HALF], f[3][2 * HALF], u[2][3][2 * HALF];
  for (int i = 0; i < 6 * HALF; i++) B[i] = uniform(&seed, 0, 1);
  for (int i = 0; i < 6 * HALF; i++) f[i / (2 * HALF)][i % (2 * HALF)] = uniform(&seed, -1, 1);
  B[0] = 0.0;
  const double k[3] = {0.0, 0.0, 0.0};
  for (int l = 0; l < 3; l++)
    for (int open = 0; open < 2 && sd_isa_supported(sets[l]); open++) {
      for (int turn = 0; turn < 2; turn++) {
        void *rows[3] = {u[turn][0], u[turn][1], u[turn][2]};
        const sd_isa isa = turn ? sets[l] : SD_ISA_PLAIN;
        const struct sd_ewald_kernels *kernels = SD_KERNELS_OF(sd_ewald, plain, isa);
        memcpy(u[turn], f, sizeof(f));
        if (open) kernels->open_row(rows, B, -1.0, 1.0, HALF);
        else kernels->periodic_row(rows, B, k, 0.7, HALF);
      }
      for (int i = 0; i < 6 * HALF; i++)
        CHECK_NEAR(u[1][i / (2 * HALF)][i % (2 * HALF)], u[0][i / (2 * HALF)][i % (2 * HALF)], 1e-14);
      if (!open) /* no flow along k, none at k = 0 */
        for (int i = 0; i < 2 * HALF; i++) CHECK_NEAR(u[1][2][i], 0.0, 1e-14);
    }
}

/* The sum over the points of a line, which may be complex, from its definition */
static void transform(int n, const double *re, const double *im, int k, double *wave)
{
  wave[0] = wave[1] = 0.0;
  for (int j = 0; j < n; j++) {
    const double angle = -2.0 * SD_PI * ((long) j * k % n) / n, c = cos(angle), s = sin(angle);
    wave[0] += c * re[j] - (im ? s * im[j] : 0.0);
    wave[1] += s * re[j] + (im ? c * im[j] : 0.0);
  }
}

/* The first waves of two real lines are parted from those of one complex line, and joined to it, whose others are 0. */
static void two_real_lines_are_a_complex_one(void **state)
{
  (void) state;
  enum { MOST = 64 };
  static const int points[] = {2, 3, 8, 9, 31, 40, MOST};
  for (int p = 0; p < 7; p++)
    for (int cut = 0; cut < 3; cut++)
      for (int k = -1; k < 3; k++)
        for (int single = 0; single < 2; single++) {
          const int n = points[p], waves = n / 2 + 1 - cut * n / 8;
          const size_t bytes = single ? sizeof(float) : sizeof(double);
          const sd_isa isa = k < 0 ? SD_ISA_PLAIN : sets[k];
          if (!sd_isa_supported(isa)) continue;
          const struct sd_grid_kernels *kernels =
              single ? SD_KERNELS_OF(sd_grid_single, plain, isa) : SD_KERNELS_OF(sd_grid, plain, isa);
          uint64_t seed = 4;
          double line[2][MOST], wave[2], both[2 * MOST], again[2 * MOST], part[2][2 * MOST];
          for (int j = 0; j < n; j++) line[0][j] = uniform(&seed, -1, 1), line[1][j] = uniform(&seed, -1, 1);
          for (int j = 0; j < n; j++) {
            transform(n, line[0], line[1], j, wave);
            for (int c = 0; c < 2; c++) {
              sd_put_number(both, bytes, 2 * j + c, wave[c]);
              sd_put_number(again, bytes, 2 * j + c, 9.0);
            }
          }
          kernels->part(both, n, waves, part[0], part[1]);
          for (int l = 0; l < 2; l++)
            for (int j = 0; j < waves; j++) {
              transform(n, line[l], NULL, j, wave);
              for (int c = 0; c < 2; c++)
                CHECK_NEAR(sd_number(part[l], bytes, 2 * j + c), wave[c], single ? 2e-5 : 1e-12);
            }
          kernels->join(part[0], part[1], n, waves, again);
          for (int j = 0; j < n; j++)
            for (int c = 0; c < 2; c++)
              CHECK_NEAR(sd_number(again, bytes, 2 * j + c),
                         j < waves || j > n - waves ? sd_number(both, bytes, 2 * j + c) : 0.0, single ? 2e-5 : 1e-12);
        }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(near_parts_agree),
      cmocka_unit_test(spreading_and_interpolation_agree),
      cmocka_unit_test(sums_over_points_of_a_window_are_integrals),
      cmocka_unit_test(a_bend_of_a_window_is_opposite_between_points),
      cmocka_unit_test(three_terms_do_for_equal_spheres_with_torques),
      cmocka_unit_test(near_parts_of_floats_are_those_of_doubles),
      cmocka_unit_test(windows_of_floats_are_those_of_doubles),
      cmocka_unit_test(points_side_by_side_are_spread_like_any),
      cmocka_unit_test(spheres_find_their_places_on_a_grid),
      cmocka_unit_test(rows_of_waves_agree),
      cmocka_unit_test(two_real_lines_are_a_complex_one),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
