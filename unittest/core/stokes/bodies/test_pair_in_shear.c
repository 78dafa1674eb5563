/* A pair of spheres with a film, tied by a spring, in shear, by the steps of fix stokes_dynamics/overdamped
 * with noise: random slip and forces of the film (sd_bodies_noise.h, sd_lubrication_noise.h), two half steps
 * (sd_drifter.h), one solve, the displacement in the half-way frame. Its means against those of the steady
 * Fokker-Planck equation with this model's own pair functions (pair_density.h), and how they come nearer as
 * the step becomes shorter: steps h and h/2 with the same noise differ by little noise. SD_PAIR_STEPS in the
 * environment: a table, of so many thousand steps h. */
#include "pair_density.h"
#include "tied_flock.h"

#include "sd_bodies_noise.h"
#include "sd_drifter.h"
#include "sd_lubrication_noise.h"
#include "sd_random.h"

/* Two free spheres, with what a step needs */
typedef struct {
  flock *f;
  tied_flock *films;
  sd_bodies_noise noise;
  double flow[12];
} pair;

static pair pair_create(void)
{
  pair p = {.f = flock_create(1, NULL, NULL, 1, 0, 2, 1.0)};
  p.f->pose[9] = -1.5, p.f->pose[21] = 1.5;
  p.films = tie_flock(p.f, 1e-3);
  return p;
}

static void pair_free(pair *p)
{
  sd_bodies_noise_free(&p->noise);
  untie(p->films);
}

/* Velocity of the fluid, and half its curl, at two places [6] */
static void flow_at(const double *x, double rate, double u[12])
{
  memset(u, 0, 12 * sizeof(double));
  for (int i = 0; i < 2; i++) u[6 * i] = rate * x[3 * i + 1], u[6 * i + 5] = -0.5 * rate;
}

/* Points at one pair of places, films at another */
static sd_bodies stand(pair *p, const double *points, const double *films, double rate)
{
  flow_at(films, rate, p->flow);
  p->films->near.u = p->flow;
  memcpy(p->films->near.s.x, films, 6 * sizeof(double));
  near_place(&p->films->near);
  for (int i = 0; i < 6; i++) p->f->pose[12 * (i / 3) + 9 + i % 3] = points[i];
  flow_at(points, rate, p->f->u);
  sd_bodies A = flock_place(p->f, 6);
  A.tie = &p->films->tie;
  return A;
}

/* to = x + part V */
static void gone(const double *x, const double *V, double part, double *to)
{
  for (int i = 0; i < 6; i++) to[i] = x[i] + part * V[6 * (i / 3) + i % 3];
}

/* Force on the second sphere of the spring, on the first its opposite */
static void pull(const sheared_pair *s, const double *x, double F[12])
{
  double d[3];
  sd_minus(x + 3, x, d);
  const double r = sqrt(sd_dot(d, d));
  memset(F, 0, 12 * sizeof(double));
  for (int i = 0; i < 3; i++) F[i] = s->k * (r - s->r0) * d[i] / r, F[6 + i] = -F[i];
}

static int normals_of_film(void *ctx, int i, int at, double g[12])
{
  memcpy(g, ctx, 12 * sizeof(double));
  return i < at;
}

/* Where a pair is, and its last force */
typedef struct {
  double x[6], old[12];
} walker;

/* normals: 12 of the points, 12 of the film */
static void step(pair *p, const sheared_pair *s, double dt, double *normals, walker *at)
{
  const double size = sqrt(2.0 / dt);
  double F[12], load[12], y[12], f[12] = {0.0}, of_points[12], of_films[12], points[6], films[6],
                                 work[120 + 24];
  const sd_bodies_blocks blocks = {NULL, NULL};
  const sd_drifter d = {NULL, NULL};
  sd_noise_report report;
  pull(s, at->x, F);
  for (int j = 0; j < 12; j++) load[j] = 1.5 * F[j] - 0.5 * at->old[j];
  memcpy(at->old, F, sizeof F);
  const sd_bodies now = stand(p, at->x, at->x, s->rate);
  assert_int_equal(sd_tie_make(&now, (sd_tie_room){work, work + 120}), SD_OK);
  assert_int_equal(sd_bodies_draw(&p->noise, &now, &blocks, normals, 1e-9, y, &report), SD_OK);
  assert_int_equal(sd_lubrication_noise(now.tie->L, normals_of_film, normals + 12, f), SD_OK);
  for (int j = 0; j < 12; j++) y[j] *= size, f[j] *= size;
  const sd_drifter_push push = {p->f->u, y, load, f, NULL, 1e-9};
  assert_int_equal(sd_drifter_move(&now, &d, &push, work, of_points, of_films), SD_OK);
  gone(at->x, of_points, 0.5 * dt, points);
  gone(at->x, of_films, 0.5 * dt, films);
  const sd_bodies half = stand(p, points, films, s->rate);
  for (int j = 0; j < 12; j++) p->f->u[j] += y[j], p->f->F[j] = load[j] + f[j];
  assert_int_equal(flock_solve(p->f, &half, 0, 1e-9, 200), SD_OK);
  double *V = p->f->all_V, u[12], middle[6];
  flow_at(points, s->rate, u);
  for (int j = 0; j < 12; j++) V[j] -= u[j];
  flow_at(at->x, s->rate, u);
  for (int j = 0; j < 12; j++) u[j] += V[j];
  gone(at->x, u, 0.5 * dt, middle);
  flow_at(middle, s->rate, u);
  for (int j = 0; j < 12; j++) u[j] += V[j];
  gone(at->x, u, dt, at->x);
}

/* Of a pair alone, by four solves */
static pair_functions functions_at(void *ctx, double r)
{
  pair *p = ctx;
  const double x[6] = {-0.5 * r, 0, 0, 0.5 * r, 0, 0}, c = 0.5 * r * sqrt(0.5),
               slanted[6] = {-c, -c, 0, c, c, 0};
  double mobility[2];
  pair_functions out;
  for (int d = 0; d < 2; d++) {
    const sd_bodies A = stand(p, x, x, 0.0);
    memset(p->f->F, 0, 12 * sizeof(double));
    p->f->F[d] = -1.0, p->f->F[6 + d] = 1.0;
    assert_int_equal(flock_solve(p->f, &A, 0, 1e-11, 200), SD_OK);
    mobility[d] = p->f->all_V[6 + d] - p->f->all_V[d];
  }
  memset(p->f->F, 0, 12 * sizeof(double));
  const sd_bodies across = stand(p, x, x, 1.0);
  assert_int_equal(flock_solve(p->f, &across, 0, 1e-11, 200), SD_OK);
  out.B = -2.0 * (p->f->all_V[7] - p->f->all_V[1]) / r;
  const sd_bodies along = stand(p, slanted, slanted, 1.0);
  assert_int_equal(flock_solve(p->f, &along, 0, 1e-11, 200), SD_OK);
  const double *V = p->f->all_V;
  out.A = 1.0 - 2.0 * sqrt(0.5) * (V[6] - V[0] + V[7] - V[1]) / r;
  out.along = mobility[0], out.across = mobility[1];
  return out;
}

/* What the means are of */
static void observe(const sheared_pair *s, const walker *at, double now[PAIR_MOMENTS])
{
  double d[3];
  sd_minus(at->x + 3, at->x, d);
  const double r = sqrt(sd_dot(d, d));
  now[PAIR_R] = r, now[PAIR_SPREAD] = (r - s->r0) * (r - s->r0), now[PAIR_XY] = d[0] * d[1];
  now[PAIR_STRESS] = s->k * (r - s->r0) * d[0] * d[1] / r;
}

enum { BLOCKS = 20 };

/* Means in steps dt and dt/2 that have the same noise, over blocks: of both and of the difference, and their
 * standard errors */
typedef struct {
  double mean[3][PAIR_MOMENTS], error[3][PAIR_MOMENTS];
} compared;

static void add_block(const double *sum, double count, compared *c)
{
  for (int m = 0; m < PAIR_MOMENTS; m++) {
    const double value[3] = {sum[m] / count, sum[PAIR_MOMENTS + m] / count,
                             (sum[m] - sum[PAIR_MOMENTS + m]) / count};
    for (int k = 0; k < 3; k++)
      c->mean[k][m] += value[k] / BLOCKS, c->error[k][m] += value[k] * value[k] / BLOCKS;
  }
}

static compared compare(pair *p, const sheared_pair *s, double dt, long steps)
{
  walker whole = {{0.0}, {0.0}}, halves;
  compared c = {.mean = {{0.0}}};
  const double start[3] = {0.6, 0.6, sqrt(0.28)};
  for (int d = 0; d < 3; d++) whole.x[3 + d] = s->r0 * start[d];
  pull(s, whole.x, whole.old);
  halves = whole;
  for (long block = -1, t = 0; block < BLOCKS; block++) { /* the first one is not counted */
    double sum[2 * PAIR_MOMENTS] = {0.0}, now[PAIR_MOMENTS];
    for (long k = 0; k < steps / BLOCKS; k++, t++) {
      double normals[72];
      const sd_random_key key = {20, SD_RANDOM_SPHERE, (uint64_t) t};
      sd_random_normals(&key, 1, 48, normals + 24);
      for (int j = 0; j < 24; j++) normals[j] = sqrt(0.5) * (normals[24 + j] + normals[48 + j]);
      step(p, s, dt, normals, &whole);
      for (int half = 0; half < 2; half++) step(p, s, 0.5 * dt, normals + 24 * (1 + half), &halves);
      observe(s, &whole, now);
      for (int m = 0; m < PAIR_MOMENTS; m++) sum[m] += now[m];
      observe(s, &halves, now);
      for (int m = 0; m < PAIR_MOMENTS; m++) sum[PAIR_MOMENTS + m] += now[m];
    }
    if (block >= 0) add_block(sum, (double) (steps / BLOCKS), &c);
  }
  for (int k = 0; k < 3; k++)
    for (int m = 0; m < PAIR_MOMENTS; m++)
      c.error[k][m] = sqrt(fmax(c.error[k][m] - c.mean[k][m] * c.mean[k][m], 0.0) / (BLOCKS - 1));
  return c;
}

static pair_functions apart(void *ctx, double r)
{
  (void) ctx, (void) r;
  return (pair_functions){0.0, 0.0, 0.7, 0.7};
}

/* At 1.5 rates of relaxation: <xy> = 1.5/(2 k), <xx> = (1 + 1.5^2/2)/k */
static void the_density_has_the_moments_of_a_hookean_spring(void **state)
{
  (void) state;
  double mean[PAIR_MOMENTS];
  const sheared_pair s = {.k = 2.0, .rate = 1.5 * 2.0 * 0.7, .at = apart};
  pair_density_moments(&s, 200, mean);
  CHECK_NEAR(mean[PAIR_XY], 0.375, 2e-4);
  CHECK_NEAR(mean[PAIR_SPREAD], 2.0625, 5e-4);
  CHECK_NEAR(mean[PAIR_STRESS], 0.75, 4e-4);
}

/* A bond of 2.4 radii that varies by 0.1, in a shear of a twentieth of its rate of relaxation along the line
 * of centres */
static sheared_pair bond(pair *p)
{
  sheared_pair s = {.k = 100.0, .r0 = 2.4, .least = 2.0005, .at = functions_at, .ctx = p};
  s.rate = 0.05 * s.k * functions_at(p, s.r0).along;
  return s;
}

/* h: the step in times of relaxation */
static compared compare_at(pair *p, const sheared_pair *s, double h, long steps)
{
  return compare(p, s, 0.05 * h / s->rate, steps);
}

static void print_table(pair *p, const sheared_pair *s, const double exact[PAIR_MOMENTS],
                        long steps)
{
  printf("exact %.5f %.5f %.5f %.5f\n", exact[0], exact[1], exact[2], exact[3]);
  for (double h = 0.4; h > 0.04; h *= 0.5) {
    const compared c = compare_at(p, s, h, steps);
    printf("h %g: mean less exact, mean at h less that at h/2\n", h);
    for (int m = 0; m < PAIR_MOMENTS; m++)
      printf("  %8.5f +- %.5f  %8.5f +- %.5f\n", c.mean[0][m] - exact[m], c.error[0][m],
             c.mean[2][m], c.error[2][m]);
    fflush(stdout);
  }
}

/* At h = 0.4 the spread is a tenth too large, at 0.1 0.3 %; without the drift, or with loads that are not
 * extrapolated, differences are others. */
static void steps_have_the_means_of_the_density(void **state)
{
  (void) state;
  pair p = pair_create();
  const sheared_pair s = bond(&p);
  const char *many = getenv("SD_PAIR_STEPS");
  double exact[PAIR_MOMENTS];
  pair_density_moments(&s, CHECK_SIZE(150, 50), exact);
  if (many) print_table(&p, &s, exact, 1000 * atol(many));
  const compared c = compare_at(&p, &s, 0.4, CHECK_SIZE(12000, 400));
  const double longer[PAIR_MOMENTS] = {0.001, 0.00107, 0.002, 0.04};
  for (int m = 0; m < PAIR_MOMENTS; m++) {
    CHECK_NEAR(c.mean[1][m], exact[m], 4.0 * c.error[1][m]);
    CHECK_NEAR(c.mean[2][m], longer[m], 4.0 * c.error[2][m]);
    assert_true(c.error[2][m] < 0.4 * c.error[0][m]);
  }
  pair_free(&p);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_density_has_the_moments_of_a_hookean_spring),
      cmocka_unit_test(steps_have_the_means_of_the_density),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
