/* The engine slab: errors against its own tightest sums, and what must hold between its runs. */
#include "slab.h"

/* --- random scenes --- */

enum { N = 48 };

typedef struct {
  double x[3 * N], a[N], F[3 * N];
} cloud;

/* In a cell Lx x Ly across axis 2, heights up to `height` above z = 0; radii 1 to `ratio`. Some touch the floor, or cut
 * it; some do that at the other end. */
static cloud make(double Lx, double Ly, double height, double ratio, uint64_t seed)
{
  cloud c;
  for (int i = 0; i < N; i++) {
    const double a = c.a[i] = ratio == 1.0 ? 1.0 : pow(ratio, -uniform(&seed, 0, 1));
    c.x[3 * i] = uniform(&seed, 0, Lx);
    c.x[3 * i + 1] = uniform(&seed, 0, Ly);
    c.x[3 * i + 2] = i % 4 == 0 ? a : i % 8 == 1 ? height - a : uniform(&seed, a, height - a);
    if (i % 12 == 0) c.x[3 * i + 2] -= 0.01;
    for (int d = 0; d < 3; d++) c.F[3 * i + d] = uniform(&seed, -1, 1);
  }
  return c;
}

static double rms(const double *v)
{
  double sum = 0.0;
  for (int k = 0; k < 3 * N; k++) sum += v[k] * v[k];
  return sqrt(sum / (3 * N));
}

/* Of u over rms of F/(6 pi a) */
static double error_of(const cloud *c, const double *F, const double *u, const double *expected)
{
  double off[3 * N], bare[3 * N];
  for (int k = 0; k < 3 * N; k++) {
    off[k] = u[k] - expected[k];
    bare[k] = F[k] / (6.0 * SD_PI * c->a[k / 3]);
  }
  return rms(off) / rms(bare);
}

typedef struct {
  const char *what;
  sd_slab_kind kind;
  double height, L[2], ratio;
} geometry;

static const geometry geometries[] = {
    {"layer", SD_SLAB_LAYER, 10, {14, 15}, 1},      {"layer 1:3", SD_SLAB_LAYER, 10, {14, 15}, 3},
    {"layer 1:10", SD_SLAB_LAYER, 10, {14, 15}, 10}, {"floor", SD_SLAB_FLOOR, 10, {14, 15}, 1},
    {"floor 1:3", SD_SLAB_FLOOR, 10, {14, 15}, 3},   {"floor 1:10", SD_SLAB_FLOOR, 10, {14, 15}, 10},
    {"low", SD_SLAB_FLOOR, 2.5, {18, 19}, 1},        {"low 1:3", SD_SLAB_FLOOR, 2.5, {18, 19}, 3},
    {"tower", SD_SLAB_FLOOR, 60, {9, 10}, 1},        {"tower 1:3", SD_SLAB_FLOOR, 60, {9, 10}, 3},
    {"slit 10", SD_SLAB_SLIT, 10, {14, 15}, 1},      {"slit 10 1:3", SD_SLAB_SLIT, 10, {14, 15}, 3},
    {"slit 10 1:10", SD_SLAB_SLIT, 10, {14, 15}, 10}, {"slit 3", SD_SLAB_SLIT, 3, {18, 19}, 1},
    {"slit 3 1:3", SD_SLAB_SLIT, 3, {18, 19}, 3},    {"slit 3 1:10", SD_SLAB_SLIT, 3, {18, 19}, 10},
    {"slit 2.2", SD_SLAB_SLIT, 2.2, {18, 19}, 1},    {"slit 2.2 1:3", SD_SLAB_SLIT, 2.2, {18, 19}, 3},
    {"slit 2.2 1:10", SD_SLAB_SLIT, 2.2, {18, 19}, 10}, {"slit 60", SD_SLAB_SLIT, 60, {9, 10}, 1},
    {"slit 60 1:3", SD_SLAB_SLIT, 60, {9, 10}, 3},
};
enum { GEOMETRIES = sizeof(geometries) / sizeof(geometries[0]) };

static sd_slab_walls walls_for(const geometry *g)
{
  const sd_wall ground = {2, 1, 0.0};
  return g->kind == SD_SLAB_LAYER ? sd_slab_layer(2)
      : g->kind == SD_SLAB_FLOOR  ? sd_slab_floor(&ground)
                                  : sd_slab_slit(2, 0.0, g->height, 0);
}

/* Random forces, all along, all down. In a layer those along must add up to 0. */
static void errors_are_below_the_tolerance(void **state)
{
  (void) state;
  static const char *const loads[] = {"random", "along", "down"};
  for (int k = 0; k < GEOMETRIES; k++) {
    const geometry *g = geometries + k;
    const sd_slab_walls walls = walls_for(g);
    const sd_ewald_box box = slab_box(2, g->L[0], g->L[1]);
    const cloud c = make(g->L[0], g->L[1], g->height, g->ratio, 17 + k);
    double F[3][3 * N], u[3 * N], expected[3][3 * N];
    for (int i = 0; i < 3 * N; i++) {
      F[0][i] = c.F[i];
      F[1][i] = i % 3 == 0 ? (g->kind == SD_SLAB_LAYER && i / 3 % 2 ? -1.0 : 1.0) : 0.0;
      F[2][i] = i % 3 == 2;
    }
    for (int d = 0; d < 2 && g->kind == SD_SLAB_LAYER; d++) {
      double sum = 0.0;
      for (int i = 0; i < N; i++) sum += F[0][3 * i + d];
      for (int i = 0; i < N; i++) F[0][3 * i + d] -= sum / N;
    }
    for (int l = 0; l < 3; l++)
      slab_velocities(&walls, &box, c.x, c.a, N, 1e-9, F[l], expected[l]);
    for (int digits = 3; digits <= 6; digits += 3) {
      const double tolerance = pow(10.0, -digits);
      slab s;
      slab_place(&s, &walls, &box, c.x, c.a, N, tolerance);
      for (int l = 0; l < 3; l++) {
        slab_apply(&s, F[l], u);
        const double error = error_of(&c, F[l], u, expected[l]);
        if (error < tolerance) continue;
        fail_msg("%s, %s: %.2g at %.0g", g->what, loads[l], error, tolerance);
      }
      slab_free(&s);
    }
  }
}

/* One large sphere among small ones: where waves were Gaussians, polynomials of images were too short, and sums of two
 * tolerances differed by up to 80 of these. */
static void the_tightest_tolerance_is_kept(void **state)
{
  (void) state;
  const double L = 30.0, H = 15.0;
  const sd_slab_walls walls = sd_slab_slit(2, 0.0, H, 0);
  const sd_ewald_box box = slab_box(2, L, L);
  cloud c = make(L, L, H, 1.0, 3);
  double u[2][3 * N];
  c.a[0] = 5.0;
  c.x[2] = 5.5;
  for (int k = 0; k < 2; k++) slab_velocities(&walls, &box, c.x, c.a, N, k ? 1e-13 : 1e-12, c.F, u[k]);
  const double error = error_of(&c, c.F, u[0], u[1]);
  if (getenv("STOKESDYN_SHOW")) printf("tightest: %.2g\n", error);
  assert_true(error < 1e-12);
}

/* --- relations --- */

static const sd_wall ground = {2, 1, 0.0};

static double dot(const double *a, const double *b)
{
  double sum = 0.0;
  for (int k = 0; k < 3 * N; k++) sum += a[k] * b[k];
  return sum;
}

static void check_all(const double *u, const double *expected, double tolerance)
{
  const double unit = rms(expected);
  for (int k = 0; k < 3 * N; k++) CHECK_NEAR(u[k], expected[k], tolerance * unit);
}

/* At any tolerance: F.M G = G.M F */
static void the_matrix_is_symmetric(void **state)
{
  (void) state;
  for (int k = 0; k < GEOMETRIES; k += 4) {
    const geometry *g = geometries + k;
    const sd_slab_walls walls = walls_for(g);
    const sd_ewald_box box = slab_box(2, g->L[0], g->L[1]);
    const cloud c = make(g->L[0], g->L[1], g->height, g->ratio, 5 + k);
    double G[3 * N], u[2][3 * N];
    for (int i = 0; i < 3 * N; i++) G[i] = c.F[(7 * i + 3) % (3 * N)];
    slab s;
    slab_place(&s, &walls, &box, c.x, c.a, N, 1e-2);
    slab_apply(&s, c.F, u[0]);
    slab_apply(&s, G, u[1]);
    slab_free(&s);
    CHECK_NEAR(dot(G, u[0]), dot(c.F, u[1]), 1e-13 * 3 * N * rms(G) * rms(u[0]));
  }
}

/* The smallest eigenvalue of a chain of eight spheres 0.2 a apart, times 6 pi a: 0.0194815 on a floor, 0.0194747 in a
 * slit, in dense sums of another code */
static void chains_on_a_floor_keep_their_smallest_eigenvalue(void **state)
{
  (void) state;
  enum { LONG = 8 };
  double x[3 * LONG] = {0.0}, a[LONG], M[9 * LONG * LONG], copy[9 * LONG * LONG];
  for (int i = 0; i < LONG; i++) {
    x[3 * i] = 0.2 * i + 0.05;
    x[3 * i + 1] = 1.3;
    x[3 * i + 2] = a[i] = 1.0;
  }
  const sd_slab_walls walls[2] = {sd_slab_floor(&ground), sd_slab_slit(2, 0.0, 2.2, 0)};
  const sd_ewald_box box = slab_box(2, 14, 15);
  for (int k = 0; k < 2; k++) {
    slab s;
    slab_place(&s, walls + k, &box, x, a, LONG, 1e-3);
    for (int i = 0; i < 3 * LONG; i++) {
      double F[3 * LONG] = {0.0};
      F[i] = 6.0 * SD_PI;
      slab_apply(&s, F, M + 3 * LONG * i);
    }
    slab_free(&s);
    memcpy(copy, M, sizeof(M));
    assert_true(positive_definite(copy, 3 * LONG, 0.01946));
    assert_false(positive_definite(M, 3 * LONG, 0.01950));
  }
}

/* Random heaps that overlap as they like */
static void heaps_have_positive_matrices(void **state)
{
  (void) state;
  enum { FEW = 12 };
  uint64_t seed = 40;
  for (int k = 0; k < CHECK_SIZE(200, 20); k++) {
    const double H = uniform(&seed, 2.0, 6.0), L = uniform(&seed, 4.0, 9.0);
    const sd_slab_walls walls = k % 2 ? sd_slab_floor(&ground) : sd_slab_slit(2, 0.0, H, k % 4 == 0);
    const sd_ewald_box box = slab_box(2, L, 1.3 * L);
    double x[3 * FEW], a[FEW], M[9 * FEW * FEW];
    for (int i = 0; i < FEW; i++) {
      a[i] = uniform(&seed, 0.3, 1.0);
      for (int d = 0; d < 3; d++) x[3 * i + d] = uniform(&seed, 0.0, d == 2 ? H : 0.5 * L);
    }
    slab s;
    slab_place(&s, &walls, &box, x, a, FEW, 1e-3);
    for (int i = 0; i < 3 * FEW; i++) {
      double F[3 * FEW] = {0.0};
      F[i] = 6.0 * SD_PI;
      slab_apply(&s, F, M + 3 * FEW * i);
    }
    slab_free(&s);
    if (!positive_definite(M, 3 * FEW, 0.0)) fail_msg("scene %d", k);
  }
}

/* All but the mean: z_< (H - z_>)/H against z_< */
static void a_floor_is_a_slit_whose_other_wall_is_far(void **state)
{
  (void) state;
  const double L[2] = {11, 12}, H = 60.0, over = 1.0 / (L[0] * L[1] * H);
  const cloud c = make(L[0], L[1], 8.0, 3.0, 71);
  const sd_slab_walls slit = sd_slab_slit(2, 0.0, H, 0), ground_alone = sd_slab_floor(&ground);
  const sd_ewald_box box = slab_box(2, L[0], L[1]);
  double u[3 * N], expected[3 * N], sum[2] = {0.0};
  slab_velocities(&ground_alone, &box, c.x, c.a, N, 1e-11, c.F, expected);
  slab_velocities(&slit, &box, c.x, c.a, N, 1e-11, c.F, u);
  for (int i = 0; i < 3 * N; i++) /* two spheres that cut the floor stand on it */
    if (i % 3 < 2) sum[i % 3] += fmax(c.x[i / 3 * 3 + 2], c.a[i / 3]) * c.F[i];
  for (int i = 0; i < 3 * N; i++)
    if (i % 3 < 2) u[i] += over * fmax(c.x[i / 3 * 3 + 2], c.a[i / 3]) * sum[i % 3];
  check_all(u, expected, 1e-10);
}

/* Raised far above a floor: all but the mean, min(z, z') against -|z - z'|/2 */
static void a_layer_is_what_is_far_above_a_floor(void **state)
{
  (void) state;
  const double L[2] = {11, 12}, over = 1.0 / (L[0] * L[1]), up = 40.0;
  cloud c = make(L[0], L[1], 8.0, 3.0, 72);
  const sd_slab_walls layer = sd_slab_layer(2), ground_alone = sd_slab_floor(&ground);
  const sd_ewald_box box = slab_box(2, L[0], L[1]);
  double u[3 * N], expected[3 * N], sum[2] = {0.0}, moment[2] = {0.0};
  for (int i = 0; i < N; i++) c.x[3 * i + 2] += up;
  slab_velocities(&ground_alone, &box, c.x, c.a, N, 1e-11, c.F, expected);
  slab_velocities(&layer, &box, c.x, c.a, N, 1e-11, c.F, u);
  for (int i = 0; i < 3 * N; i++)
    if (i % 3 < 2) {
      sum[i % 3] += c.F[i];
      moment[i % 3] += c.x[i / 3 * 3 + 2] * c.F[i];
    }
  for (int i = 0; i < 3 * N; i++)
    if (i % 3 < 2) u[i] += 0.5 * over * (c.x[i / 3 * 3 + 2] * sum[i % 3] + moment[i % 3]);
  check_all(u, expected, 1e-10);
}

/* z -> H - z */
static void a_slit_may_stand_on_its_head(void **state)
{
  (void) state;
  const double H = 4.0;
  const cloud c = make(11, 12, H, 3.0, 73);
  cloud turned = c;
  for (int i = 0; i < N; i++) {
    turned.x[3 * i + 2] = H - c.x[3 * i + 2];
    turned.F[3 * i + 2] = -c.F[3 * i + 2];
  }
  const sd_ewald_box box = slab_box(2, 11, 12);
  for (int flux = 0; flux < 2; flux++) {
    const sd_slab_walls walls = sd_slab_slit(2, 0.0, H, flux);
    double u[3 * N], v[3 * N];
    slab_velocities(&walls, &box, c.x, c.a, N, 1e-3, c.F, u);
    slab_velocities(&walls, &box, turned.x, turned.a, N, 1e-3, turned.F, v);
    for (int i = 0; i < N; i++) v[3 * i + 2] = -v[3 * i + 2];
    check_all(v, u, 1e-11);
  }
}

/* Turned to each axis, and under a ceiling: components and cell go along */
static void walls_may_face_any_way(void **state)
{
  (void) state;
  const cloud c = make(11, 12, 4.0, 3.0, 74);
  const sd_ewald_box box = slab_box(2, 11, 12);
  double u[3 * N], v[3 * N], back[3 * N];
  for (int slit = 0; slit < 2; slit++) {
    const sd_slab_walls walls = slit ? sd_slab_slit(2, 0.0, 4.0, 0) : sd_slab_floor(&ground);
    slab_velocities(&walls, &box, c.x, c.a, N, 1e-3, c.F, u);
    for (int way = 0; way < 6; way++) {
      const int axis = way % 3, sign = way < 3 ? 1 : -1;
      const sd_wall wall = {axis, sign, 2.5};
      const sd_slab_walls there = slit ? sd_slab_slit(axis, 2.5, 6.5, 0) : sd_slab_floor(&wall);
      const sd_ewald_box turned = slab_box(axis, 11, 12);
      cloud t = c;
      for (int i = 0; i < N; i++)
        for (int d = 0; d < 3; d++) {
          const int to = (d + axis + 1) % 3, flip = d == 2 && sign < 0;
          t.x[3 * i + to] = (flip ? (slit ? 4.0 : 0.0) - c.x[3 * i + d] : c.x[3 * i + d]) + (d == 2 ? 2.5 : 0.0);
          t.F[3 * i + to] = flip ? -c.F[3 * i + d] : c.F[3 * i + d];
        }
      slab_velocities(&there, &turned, t.x, t.a, N, 1e-3, t.F, v);
      for (int i = 0; i < 3 * N; i++) {
        const double w = v[i / 3 * 3 + (i + axis + 1) % 3];
        back[i] = i % 3 == 2 && sign < 0 ? -w : w;
      }
      check_all(back, u, 1e-11);
    }
  }
}

/* Two copies side by side in a cell twice as wide */
static void a_cell_is_two_cells(void **state)
{
  (void) state;
  enum { HALF = N / 2 };
  const cloud c = make(11, 12, 4.0, 3.0, 75);
  cloud two = c;
  for (int i = 0; i < HALF; i++) {
    memcpy(two.x + 3 * (HALF + i), c.x + 3 * i, 3 * sizeof(double));
    memcpy(two.F + 3 * (HALF + i), c.F + 3 * i, 3 * sizeof(double));
    two.a[HALF + i] = c.a[i];
    two.x[3 * (HALF + i)] += 11.0;
  }
  const sd_ewald_box one = slab_box(2, 11, 12), both = slab_box(2, 22, 12);
  const sd_slab_walls kinds[2] = {sd_slab_floor(&ground), sd_slab_slit(2, 0.0, 4.0, 1)};
  for (int k = 0; k < 2; k++) {
    double u[3 * N], expected[3 * N];
    slab_velocities(kinds + k, &one, c.x, c.a, HALF, 1e-11, c.F, expected);
    memcpy(expected + 3 * HALF, expected, 3 * HALF * sizeof(double));
    slab_velocities(kinds + k, &both, two.x, two.a, N, 1e-11, two.F, u);
    check_all(u, expected, 1e-10);
  }
}

/* No flux takes the flow between walls away that its pressure gradient drives, for any tolerance. */
static void no_flux_adds_a_poiseuille_flow(void **state)
{
  (void) state;
  const double H = 4.0;
  const cloud c = make(11, 12, H, 3.0, 76);
  const sd_ewald_box box = slab_box(2, 11, 12);
  const sd_slab_walls free_ends = sd_slab_slit(2, 0.0, H, 0), closed = sd_slab_slit(2, 0.0, H, 1);
  double u[3 * N], expected[3 * N], gradient[3] = {0.0};
  slab_velocities(&free_ends, &box, c.x, c.a, N, 1e-3, c.F, expected);
  slab_velocities(&closed, &box, c.x, c.a, N, 1e-3, c.F, u);
  sd_slab_add_pressure_gradient(&free_ends, box.edge, N, c.x, c.a, c.F, gradient);
  assert_true(gradient[0] == 0.0 && gradient[1] == 0.0);
  sd_slab_add_pressure_gradient(&closed, box.edge, N, c.x, c.a, c.F, gradient);
  assert_true(gradient[2] == 0.0);
  for (int i = 0; i < 3 * N; i++) {
    const double a = c.a[i / 3], z = fmin(fmax(c.x[i / 3 * 3 + 2], a), H - a);
    expected[i] -= 0.5 * (z * (H - z) - a * a / 3.0) * gradient[i % 3];
  }
  check_all(u, expected, 1e-12);
}

/* To the tolerance, wherever on the grid it is */
static void nothing_depends_on_a_shift_along_the_walls(void **state)
{
  (void) state;
  cloud c = make(11, 12, 4.0, 3.0, 77);
  const sd_ewald_box box = slab_box(2, 11, 12);
  const sd_slab_walls walls = sd_slab_floor(&ground);
  double u[3 * N], expected[3 * N];
  slab_velocities(&walls, &box, c.x, c.a, N, 1e-6, c.F, expected);
  for (int i = 0; i < N; i++) {
    c.x[3 * i] += 33.7;
    c.x[3 * i + 1] -= 5.21;
  }
  slab_velocities(&walls, &box, c.x, c.a, N, 1e-6, c.F, u);
  assert_true(error_of(&c, c.F, u, expected) < 1e-6);
}

/* As far from the origin as a coordinate keeps seven digits of a radius, with two at one point and two in touch */
static void a_slab_may_stand_far_from_the_origin(void **state)
{
  (void) state;
  cloud c = make(11, 12, 8.0, 10.0, 78);
  const double off = ldexp(1.0, 27);
  const sd_wall there = {2, 1, off};
  const sd_slab_walls near = sd_slab_floor(&ground), far = sd_slab_floor(&there);
  const sd_ewald_box box = slab_box(2, 11, 12);
  double u[3 * N], expected[3 * N];
  memcpy(c.x + 3, c.x, 3 * sizeof(double));
  for (int d = 0; d < 3; d++) c.x[9 + d] = c.x[6 + d] + (d == 0) * (c.a[2] + c.a[3]);
  for (int i = 0; i < 3 * N; i++) c.x[i] = ldexp(rint(ldexp(c.x[i], 24)), -24); /* digits that it keeps there */
  slab_velocities(&near, &box, c.x, c.a, N, 1e-6, c.F, expected);
  for (int i = 0; i < 3 * N; i++) c.x[i] += off;
  slab_velocities(&far, &box, c.x, c.a, N, 1e-6, c.F, u);
  assert_true(error_of(&c, c.F, u, expected) < 1e-6);
}

/* Two in touch on a floor in a cell of a million radii: as above one wall in an open box */
static void a_huge_cell_is_open(void **state)
{
  (void) state;
  const double x[6] = {3e5, 3e5, 1.5, 3e5 + 2.0, 3e5, 1.5}, a[2] = {1, 1}, F[6] = {1, 2, 3, -4, 5, 1};
  const sd_slab_walls walls = sd_slab_floor(&ground);
  const sd_ewald_box box = slab_box(2, 1e6, 1e6);
  const sd_mobility_scene scene = {.how = {.law = {.tensor = SD_TENSOR_RPY, .wall = ground}, .width = 3},
                                   .n = 2, .n_all = 2, .spheres = {x, a, a}};
  sd_mobility m = {0};
  double u[6], expected[6];
  slab_velocities(&walls, &box, x, a, 2, 1e-6, F, u);
  assert_int_equal(sd_mobility_place(&m, &sd_mobility_all_pairs, &scene), SD_OK);
  assert_int_equal(sd_mobility_apply(&m, F, expected), SD_OK);
  sd_mobility_free(&m);
  for (int i = 0; i < 6; i++) CHECK_NEAR(u[i], expected[i] + F[i] / (6.0 * SD_PI), 1e-5);
}

/* A splitting lasts while spheres move within its heights, or cut the floor, and says so when they do not. */
static void a_splitting_lasts_until_spheres_leave_it(void **state)
{
  (void) state;
  cloud c = make(11, 12, 8.0, 1.0, 78);
  const sd_slab_walls walls = sd_slab_floor(&ground);
  const sd_ewald_box box = slab_box(2, 11, 12);
  sd_slab how = {0}, later;
  slab s;
  assert_int_equal(slab_choose(&walls, &box, c.x, c.a, N, 1e-3, &how), SD_OK);
  later = how;
  c.x[5] = how.hi - 0.01;
  c.x[2] = 0.4 * c.a[0];
  assert_int_equal(slab_choose(&walls, &how.ewald.box, c.x, c.a, N, 1e-3, &later), SD_OK);
  assert_true(sd_slab_same_tables(&how, &later));
  c.x[5] = how.hi + 0.01;
  assert_int_equal(slab_try(&s, &how, c.x, c.a, NULL, N), SD_ENOTFINITE);
  slab_free(&s);
  assert_int_equal(slab_choose(&walls, &how.ewald.box, c.x, c.a, N, 1e-3, &later), SD_OK);
  assert_false(sd_slab_same_tables(&how, &later));
  assert_int_equal(slab_try(&s, &later, c.x, c.a, NULL, N), SD_OK);
  slab_free(&s);
  c.x[5] = NAN;
  assert_int_equal(slab_try(&s, &later, c.x, c.a, NULL, N), SD_ENOTFINITE);
  slab_free(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(errors_are_below_the_tolerance),
      cmocka_unit_test(the_tightest_tolerance_is_kept),
      cmocka_unit_test(the_matrix_is_symmetric),
      cmocka_unit_test(chains_on_a_floor_keep_their_smallest_eigenvalue),
      cmocka_unit_test(heaps_have_positive_matrices),
      cmocka_unit_test(a_floor_is_a_slit_whose_other_wall_is_far),
      cmocka_unit_test(a_layer_is_what_is_far_above_a_floor),
      cmocka_unit_test(a_slit_may_stand_on_its_head),
      cmocka_unit_test(walls_may_face_any_way),
      cmocka_unit_test(a_cell_is_two_cells),
      cmocka_unit_test(no_flux_adds_a_poiseuille_flow),
      cmocka_unit_test(nothing_depends_on_a_shift_along_the_walls),
      cmocka_unit_test(a_slab_may_stand_far_from_the_origin),
      cmocka_unit_test(a_huge_cell_is_open),
      cmocka_unit_test(a_splitting_lasts_until_spheres_leave_it),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
