/* The flow around spheres on a grid: against sums over all spheres, closed forms, and what a sphere of no size would
   do. */
#include "../ewald/periodic.h"

#include "around.h"

#include "sd_linear.h"

enum { SPHERES = 30, N0 = 9, N1 = 7, N2 = 6, POINTS = N0 * N1 * N2 };

/* Spheres of two sizes in a box of 10 x 9 x 8, that may overlap; forces and torques; a grid that is wider than the
   box */
typedef struct {
  double x[3 * SPHERES], a[SPHERES], F[3 * SPHERES], T[3 * SPHERES];
  sd_field_sources s;
  sd_field_grid g;
  sd_ewald_box box;
} scene;

static void make(scene *c, int periodic, int turns, double tilt)
{
  uint64_t seed = 11;
  *c = (scene){.box = {.periodic = periodic, .origin = {-1.0, 0.5, 2.0}, .edge = {10, 9, 8},
                       .tilt = {tilt, -0.5 * tilt, 0.7 * tilt}}};
  for (int i = 0; i < SPHERES; i++) {
    c->a[i] = i % 3 ? 0.6 : 1.1;
    for (int d = 0; d < 3; d++) {
      c->x[3 * i + d] = c->box.origin[d] + uniform(&seed, 0, c->box.edge[d]);
      c->F[3 * i + d] = uniform(&seed, -1, 1) + (d == 2);
      c->T[3 * i + d] = uniform(&seed, -1, 1);
    }
  }
  c->s = (sd_field_sources){SPHERES, c->x, c->a, c->F, turns ? c->T : NULL};
  c->g = (sd_field_grid){{-3.0, 0.1, 1.0}, {1.7, 1.6, 1.5}, {N0, N1, N2}, 0, N2};
}

static void point_of(const sd_field_grid *g, int k, double *x)
{
  x[0] = g->lo[0] + k % g->n[0] * g->step[0];
  x[1] = g->lo[1] + k / g->n[0] % g->n[1] * g->step[1];
  x[2] = g->lo[2] + k / g->n[0] / g->n[1] * g->step[2];
}

static void flow(sd_field *f, sd_field_sum how, const scene *c, double tolerance, double *u)
{
  memset(u, 0, 3 * sizeof(double) * sd_field_points(&c->g));
  assert_int_equal(add_flow(f, how, &c->box, tolerance, &c->s, &c->g, u), SD_OK);
}

/* Largest difference over the largest value */
static double off(const double *u, const double *v, int n)
{
  double worst = 0.0, most = 0.0;
  for (int k = 0; k < n; k++) worst = fmax(worst, fabs(u[k] - v[k])), most = fmax(most, fabs(v[k]));
  return worst / most;
}

/* The formulas of the header, viscosity 1 */
static void closed_form(const scene *c, const double *x, double *u)
{
  for (int d = 0; d < 3; d++) u[d] = 0.0;
  for (int i = 0; i < SPHERES; i++) {
    const double a = c->a[i], *F = c->F + 3 * i, *T = c->s.T ? c->T + 3 * i : NULL;
    const double r[3] = {x[0] - c->x[3 * i], x[1] - c->x[3 * i + 1], x[2] - c->x[3 * i + 2]};
    const double R = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]), rF = r[0] * F[0] + r[1] * F[1] + r[2] * F[2];
    for (int d = 0; d < 3; d++) {
      const int e = (d + 1) % 3, f = (d + 2) % 3;
      const double turned = T ? T[e] * r[f] - T[f] * r[e] : 0.0;
      if (R <= a)
        u[d] += F[d] / (6 * SD_PI * a) + turned / (8 * SD_PI * a * a * a);
      else
        u[d] += (F[d] / R + r[d] * rF / pow(R, 3) + a * a / 3 * (F[d] / pow(R, 3) - 3 * r[d] * rF / pow(R, 5)) +
                 turned / pow(R, 3)) /
                (8 * SD_PI);
    }
  }
}

static void open_flow_is_the_sum_over_all_spheres(void **state)
{
  (void) state;
  static const sd_field_sum how[] = {SD_FIELD_DIRECT, SD_FIELD_SPLIT, SD_FIELD_AUTO};
  for (int turns = 0; turns < 2; turns++)
    for (int k = 0; k < 3; k++) {
      scene c;
      sd_field f = {0};
      double u[3 * POINTS], expected[3 * POINTS], x[3];
      make(&c, 0, turns, 0.0);
      flow(&f, how[k], &c, 1e-12, u);
      for (int p = 0; p < POINTS; p++) {
        point_of(&c.g, p, x);
        closed_form(&c, x, expected + 3 * p);
      }
      CHECK_NEAR(off(u, expected, 3 * POINTS), 0.0, k == 0 ? 1e-14 : 1e-11);
      sd_field_free(&f);
    }
}

static void all_equal(scene *c, double a)
{
  for (int i = 0; i < SPHERES; i++) c->a[i] = a;
}

/* The product of sd_mobility.h, whose sphere of radius 1e-7 moves with the fluid, to its square */
static void check_against_tiny_spheres(scene *c)
{
  enum { ALL = SPHERES + POINTS };
  sd_field f = {0};
  const int m = c->s.T ? 6 : 3;
  double u[3 * POINTS], expected[3 * POINTS], x[3 * ALL], a[ALL], F[6 * ALL] = {0}, v[6 * ALL];
  flow(&f, SD_FIELD_AUTO, c, 1e-12, u);
  for (int i = 0; i < ALL; i++) {
    a[i] = i < SPHERES ? c->a[i] : 1e-7;
    if (i >= SPHERES) point_of(&c->g, i - SPHERES, x + 3 * i);
    for (int d = 0; d < 3 && i < SPHERES; d++) {
      x[3 * i + d] = c->x[3 * i + d];
      F[m * i + d] = c->F[3 * i + d];
      if (m == 6) F[m * i + 3 + d] = c->T[3 * i + d];
    }
  }
  periodic p;
  const sd_ewald how = periodic_choose(&c->box, a, SPHERES, m, 1e-13);
  periodic_place(&p, x, a, NULL, ALL, m, &how);
  assert_int_equal(sd_mobility_apply(&p.omega, F, v), SD_OK);
  for (int k = 0; k < POINTS; k++)
    for (int d = 0; d < 3; d++) expected[3 * k + d] = v[m * (SPHERES + k) + d];
  CHECK_NEAR(off(u, expected, 3 * POINTS), 0.0, 1e-10);
  periodic_free(&p);
  sd_field_free(&f);
}

static void periodic_flow_is_that_of_a_tiny_sphere(void **state)
{
  (void) state;
  for (int turns = 0; turns < 2; turns++)
    for (int oblique = 0; oblique < 2; oblique++)
      for (int equal = 0; equal < 2; equal++) {
        scene c;
        make(&c, 1, turns, oblique ? 2.1 : 0.0);
        if (equal) all_equal(&c, 0.9);
        check_against_tiny_spheres(&c);
      }
}

/* Points that are closer to each other than those of the waves' grid, beside them in each direction, in a few spheres
   and around */
static void flow_in_a_part_of_the_box_is_that_of_a_tiny_sphere(void **state)
{
  (void) state;
  for (int equal = 0; equal < 2; equal++) {
    scene c;
    make(&c, 1, equal, -1.3);
    if (equal) all_equal(&c, 0.7);
    c.g = (sd_field_grid){{2.17, 3.31, 4.07}, {0.213, 0.171, 0.237}, {N0, N1, N2}, 0, N2};
    check_against_tiny_spheres(&c);
  }
}

static void error_of_a_split_sum_is_below_the_tolerance(void **state)
{
  (void) state;
  static const double tolerance[] = {1e-2, 1e-3, 1e-4, 1e-6, 1e-8};
  for (int periodic = 0; periodic < 2; periodic++)
    for (int k = 0; k < 4; k += CHECK_SIZE(1, 3)) {
      scene c;
      double u[3 * POINTS], exact[3 * POINTS], rms = 0.0;
      make(&c, periodic, k % 2, 0.0);
      if (k > 1) all_equal(&c, 0.9);
      for (int i = 0; i < SPHERES; i++)
        for (int d = 0; d < 3; d++) rms += pow(c.F[3 * i + d] / (6 * SD_PI * c.a[i]), 2) / SPHERES;
      sd_field f = {0};
      flow(&f, SD_FIELD_SPLIT, &c, 1e-12, exact);
      for (int l = 0; l < 5; l += CHECK_SIZE(1, 2)) {
        double sum = 0.0;
        flow(&f, SD_FIELD_SPLIT, &c, tolerance[l], u);
        for (int p = 0; p < 3 * POINTS; p++) sum += pow(u[p] - exact[p], 2) / POINTS;
        CHECK_NEAR(sqrt(sum / rms), 0.0, tolerance[l]);
      }
      sd_field_free(&f);
    }
}

static void far_from_the_origin_single_precision_keeps_its_digits(void **state)
{
  (void) state;
  scene c;
  double here[3 * POINTS], far_away[3 * POINTS];
  sd_field f = {0};
  make(&c, 1, 1, 0.0);
  flow(&f, SD_FIELD_AUTO, &c, 1e-3, here);
  for (int d = 0; d < 3; d++) {
    const double shift = (d + 1) * 1e5;
    c.box.origin[d] += shift;
    c.g.lo[d] += shift;
    for (int i = 0; i < SPHERES; i++) c.x[3 * i + d] += shift;
  }
  flow(&f, SD_FIELD_AUTO, &c, 1e-3, far_away);
  CHECK_NEAR(off(far_away, here, 3 * POINTS), 0.0, 1e-6);
  sd_field_free(&f);
}

/* Stokes: u = F/(6 pi a) on the sphere, in front of it U (3a/2r - a^3/2r^3), beside it U (3a/4r + a^3/4r^3) */
static void lone_sphere_has_the_flow_of_stokes(void **state)
{
  (void) state;
  const double a = 0.8, x[3] = {0.1, 0.2, 0.3}, F[3] = {0, 0, 2.5}, U = F[2] / (6 * SD_PI * a);
  const sd_field_sources s = {1, x, &a, F, NULL};
  const sd_field_grid g = {{0.1, 0.2, 0.3}, {1.0, 0.8, 0.8}, {1, 21, 21}, 0, 21};
  const sd_ewald_box open = {0};
  double u[3 * 441] = {0.0};
  sd_field f = {0};
  assert_int_equal(add_flow(&f, SD_FIELD_AUTO, &open, 1e-3, &s, &g, u), SD_OK);
  CHECK_NEAR(u[2], U, 1e-15);
  for (int k = 1; k < 21; k++) {
    const double r = k, *beside = u + 3 * k, *ahead = u + 3 * 21 * k;
    CHECK_NEAR(beside[2], U * (0.75 / r + 0.25 / (r * r * r)), 1e-15);
    CHECK_NEAR(ahead[2], U * (1.5 / r - 0.5 / (r * r * r)), 1e-15);
  }
  sd_field_free(&f);
}

/* What ParaView draws between the points: the error of linear interpolation falls by four where the spacing is
   halved. */
static void between_points_the_error_is_of_second_order(void **state)
{
  (void) state;
  double error[3];
  for (int level = 0; level < 3; level++) {
    scene c;
    make(&c, 1, 0, 0.0);
    const int n = (8 << level) + 1;
    const double h = 2.0 / (n - 1);
    c.g = (sd_field_grid){{15.0, 0.5, 2.0}, {h, h, h}, {n, n, n}, 0, n};
    for (int i = 0; i < SPHERES; i++) c.a[i] *= 0.5;
    for (int i = 0; i < SPHERES; i++) c.x[3 * i] = -1.0 + 0.4 * (c.x[3 * i] + 1.0); /* the grid is in free fluid */
    double *u = malloc(sizeof(double) * 3 * (size_t) n * (size_t) n * (size_t) n);
    sd_field f = {0};
    flow(&f, SD_FIELD_AUTO, &c, 1e-9, u);
    error[level] = 0.0;
    for (int k = 0; k + 2 < n; k += 2) /* midpoints of the grid twice as coarse, between eight of its points */
      for (int j = 0; j + 2 < n; j += 2)
        for (int i = 0; i + 2 < n; i += 2)
          for (int d = 0; d < 3; d++) {
            double mean = 0.0;
            for (int corner = 0; corner < 8; corner++)
              mean += 0.125 * u[3 * (((k + 2 * (corner / 4)) * n + j + 2 * (corner / 2 % 2)) * n + i +
                                     2 * (corner % 2)) + d];
            error[level] = fmax(error[level], fabs(mean - u[3 * (((k + 1) * n + j + 1) * n + i + 1) + d]));
          }
    free(u);
    sd_field_free(&f);
  }
  assert_true(error[0] > 1e-5);
  CHECK_NEAR(log2(error[0] / error[1]), 2.0, 0.15);
  CHECK_NEAR(log2(error[1] / error[2]), 2.0, 0.05);
}

static void planes_of_several_ranks_are_those_of_one(void **state)
{
  (void) state;
  for (int periodic = 0; periodic < 2; periodic++) {
    scene c;
    double u[3 * POINTS], part[3 * POINTS];
    sd_field f = {0};
    make(&c, periodic, 1, 0.0);
    flow(&f, SD_FIELD_AUTO, &c, 1e-4, u);
    c.g.from = 2;
    c.g.to = 5;
    flow(&f, SD_FIELD_AUTO, &c, 1e-4, part);
    CHECK_NEAR(off(part, u + 3 * N0 * N1 * 2, 3 * N0 * N1 * 3), 0.0, 1e-14);
    sd_field_free(&f);
  }
}

static void tables_are_made_anew_where_the_box_is_another(void **state)
{
  (void) state;
  scene c;
  double u[3 * POINTS], fresh[3 * POINTS];
  sd_field f = {0}, other = {0};
  make(&c, 1, 1, 0.0);
  flow(&f, SD_FIELD_AUTO, &c, 1e-6, u);
  make(&c, 1, 0, 0.9);
  flow(&f, SD_FIELD_AUTO, &c, 1e-6, u);
  flow(&other, SD_FIELD_AUTO, &c, 1e-6, fresh);
  CHECK_NEAR(off(u, fresh, 3 * POINTS), 0.0, 0.0);
  sd_field_free(&f);
  sd_field_free(&other);
}

/* A lattice of spheres, as a sphere in a tilted box has it, each layer faster than the one below */
static void within_a_sphere_the_flow_is_that_of_the_sphere(void **state)
{
  (void) state;
  const double a = 1.3, V[6] = {0.3, -0.2, 0.5, 0.7, -0.4, 0.9};
  const sd_field_grid g = {{-10, -10, -10}, {0.5, 0.5, 0.5}, {41, 41, 41}, 0, 41};
  double x[3 * 75], radius[75], v[6 * 75];
  for (int i = 0; i < 75; i++) {
    const int up = i / 25 - 1;
    x[3 * i] = 10 * (i % 5 - 2) + 3.0 * up;
    x[3 * i + 1] = 10 * (i / 5 % 5 - 2);
    x[3 * i + 2] = 10 * up;
    radius[i] = a;
    for (int d = 0; d < 6; d++) v[6 * i + d] = V[d] + (d == 0 ? 2.5 * up : 0.0);
  }
  const sd_field_bodies b = {75, x, radius, v};
  double *u = malloc(sizeof(double) * 3 * sd_field_points(&g));
  unsigned char *inside = malloc(sd_field_points(&g));
  for (size_t k = 0; k < 3 * sd_field_points(&g); k++) u[k] = 77.0;
  assert_int_equal(sd_field_inside(&b, &g, u, inside), SD_OK);
  for (int p = 0; p < (int) sd_field_points(&g); p++) {
    double at[3];
    point_of(&g, p, at);
    const double up = round(at[2] / 10), r[3] = {at[0] - 3 * up - 10 * round((at[0] - 3 * up) / 10),
                                                 at[1] - 10 * round(at[1] / 10), at[2] - 10 * up};
    const int within = sd_dot(r, r) <= a * a;
    assert_int_equal(inside[p], within);
    for (int d = 0; d < 3; d++) {
      const int e = (d + 1) % 3, h = (d + 2) % 3;
      const double rigid = V[d] + V[3 + e] * r[h] - V[3 + h] * r[e] + (d == 0 ? 2.5 * up : 0.0);
      CHECK_NEAR(u[3 * p + d], within ? rigid : 77.0, 1e-13);
    }
  }
  free(u);
  free(inside);
}

static void where_spheres_overlap_the_nearer_one_has_the_point(void **state)
{
  (void) state;
  const double x[6] = {0, 0, 0, 1, 0, 0}, a[2] = {1.0, 0.5}, V[12] = {1, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0};
  const sd_field_grid g = {{0, 0, 0}, {0.1, 1, 1}, {21, 1, 1}, 0, 1};
  const sd_field_bodies b = {2, x, a, V};
  double u[3 * 21] = {0.0};
  unsigned char inside[21];
  assert_int_equal(sd_field_inside(&b, &g, u, inside), SD_OK);
  for (int i = 0; i < 21; i++) {
    assert_int_equal(inside[i], i <= 15);
    CHECK_NEAR(u[3 * i], i <= 6 ? 1.0 : i <= 15 ? 2.0 : 0.0, 0.0); /* x < |x - 1|/0.5 up to 2/3 */
  }
}

/* u is added to what is there, and nothing comes of no sources. */
static void a_flow_is_added(void **state)
{
  (void) state;
  scene c;
  double u[3 * POINTS], twice[3 * POINTS];
  sd_field f = {0};
  make(&c, 0, 1, 0.0);
  flow(&f, SD_FIELD_DIRECT, &c, 1e-3, u);
  flow(&f, SD_FIELD_DIRECT, &c, 1e-3, twice);
  assert_int_equal(add_flow(&f, SD_FIELD_DIRECT, &c.box, 1e-3, &c.s, &c.g, twice), SD_OK);
  for (int k = 0; k < 3 * POINTS; k++) CHECK_NEAR(twice[k], 2.0 * u[k], 1e-14);
  c.s.n = 0;
  flow(&f, SD_FIELD_AUTO, &c, 1e-3, u);
  for (int k = 0; k < 3 * POINTS; k++) CHECK_NEAR(u[k], 0.0, 0.0);
  make(&c, 0, 0, 0.0);
  c.F[4] = NAN;
  assert_int_equal(add_flow(&f, SD_FIELD_AUTO, &c.box, 1e-3, &c.s, &c.g, u), SD_ENOTFINITE);
  sd_field_free(&f);
}

/* Every rank has some of the sources: what each knows of its own adds up, and so do the flows. */
static void sources_in_pieces_make_the_flow_of_all(void **state)
{
  (void) state;
  scene c;
  sd_field f = {0};
  double u[3 * POINTS], parts[3 * POINTS] = {0.0}, range;
  sd_field_cloud all, some;
  make(&c, 0, 1, 0.0);
  flow(&f, SD_FIELD_DIRECT, &c, 1e-3, u);
  sd_field_measure(&c.s, &all);
  assert_int_equal(sd_field_plan(&f, SD_FIELD_DIRECT, &c.box, 1e-3, &all, &c.g, &range), SD_OK);
  assert_true(isinf(range));
  double count = 0.0, squares = 0.0, torque = 0.0;
  for (int from = 0; from < SPHERES; from += 7) {
    const int n = from + 7 < SPHERES ? 7 : SPHERES - from;
    const sd_field_sources piece = {n, c.x + 3 * from, c.a + from, c.F + 3 * from, c.T + 3 * from};
    sd_field_measure(&piece, &some);
    count += some.all.count;
    squares += some.all.squares;
    torque += some.torque;
    for (int d = 0; d < 3; d++) assert_true(some.lo[d] >= all.lo[d] && some.hi[d] <= all.hi[d]);
    assert_int_equal(sd_field_add_all(&f, &piece, &c.g, parts), SD_OK);
  }
  CHECK_NEAR(off(parts, u, 3 * POINTS), 0.0, 1e-14);
  CHECK_NEAR(count, SPHERES, 0.0);
  CHECK_NEAR(squares, all.all.squares, 1e-12);
  CHECK_NEAR(torque, all.torque, 1e-12);
  sd_field_free(&f);
}

/* Points without radius are point forces, Oseen's tensor. */
static void a_source_without_radius_is_a_point_force(void **state)
{
  (void) state;
  for (int periodic = 0; periodic < 2; periodic++) {
    scene c;
    double u[3 * POINTS], small[3 * POINTS];
    sd_field f = {0};
    make(&c, periodic, 0, 0.0);
    for (int i = 0; i < SPHERES; i++) c.a[i] = 1e-7;
    flow(&f, SD_FIELD_AUTO, &c, 1e-12, small);
    for (int i = 0; i < SPHERES; i++) c.a[i] = 0.0;
    flow(&f, SD_FIELD_AUTO, &c, 1e-12, u);
    CHECK_NEAR(off(u, small, 3 * POINTS), 0.0, 1e-11);
    sd_field_free(&f);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(open_flow_is_the_sum_over_all_spheres),
      cmocka_unit_test(periodic_flow_is_that_of_a_tiny_sphere),
      cmocka_unit_test(flow_in_a_part_of_the_box_is_that_of_a_tiny_sphere),
      cmocka_unit_test(error_of_a_split_sum_is_below_the_tolerance),
      cmocka_unit_test(far_from_the_origin_single_precision_keeps_its_digits),
      cmocka_unit_test(lone_sphere_has_the_flow_of_stokes),
      cmocka_unit_test(between_points_the_error_is_of_second_order),
      cmocka_unit_test(planes_of_several_ranks_are_those_of_one),
      cmocka_unit_test(tables_are_made_anew_where_the_box_is_another),
      cmocka_unit_test(within_a_sphere_the_flow_is_that_of_the_sphere),
      cmocka_unit_test(where_spheres_overlap_the_nearer_one_has_the_point),
      cmocka_unit_test(a_flow_is_added),
      cmocka_unit_test(sources_in_pieces_make_the_flow_of_all),
      cmocka_unit_test(a_source_without_radius_is_a_point_force),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
