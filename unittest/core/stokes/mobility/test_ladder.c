/* One ladder of tests for every engine of engines.h: the same rungs t000 ... t120 by name, and a table engine x rung
 * with the error of each, or why an engine does not claim it. All errors are those of velocities over that of the
 * pushed sphere alone. */
#include "climb.h"

/* An error within its bound; or what the row does not claim */
typedef struct {
  double error, bound;
  const char *cannot;
} verdict;

static verdict within(double error, double bound)
{
  return (verdict){error, bound, NULL};
}

static verdict cannot(const char *why)
{
  return (verdict){0.0, 0.0, why};
}

/* --- the rungs --- */

/* Hasimoto 1959, and the flux of the mixture: exact in this model until images overlap */
static double alone_in_cube(double a_over_L)
{
  return 1.0 - 2.837297479480619 * a_over_L + 4.0 / 3.0 * SD_PI * pow(a_over_L, 3);
}

/* What a lone sphere does in each direction under a force or a torque, over what it does in free space. Wall: Swan &
 * Brady 2007 and for torques Jeffrey & Onishi 1984 */
static double alone_at(const climber *row, const cast *s, int i, int number)
{
  const double a = s->a[i], h = a / (s->x[3 * i + 2] - wall_at);
  if (row->edge > 0.0) return number < 3 ? alone_in_cube(a / row->edge) : 1.0 - 4.0 / 3.0 * SD_PI *
      pow(a / row->edge, 3);
  if (!row->wall) return 1.0;
  if (number >= 3) return 1.0 - (number == 5 ? 1.0 / 8.0 : 5.0 / 16.0) * pow(h, 3);
  return number == 2 ? 1.0 - (9.0 * h - 4.0 * pow(h, 3) + pow(h, 5)) / 8.0 : 1.0 -
      (9.0 * h - 2.0 * pow(h, 3) + pow(h, 5)) / 16.0;
}

/* In an oblique box and between walls the lattice decides, by closed_forms.h. Others are there, but are not pushed. */
static verdict t000_lone_sphere(const climber *row)
{
  cast s = {.width = widest(row)};
  add(&s, 3.0, 4.0, row->wall ? wall_at + 5.0 * 0.8 : 2.0, 0.8);
  if (row->ratio > 1.0) add(&s, 30.0, 25.0, 20.0, 0.8 * row->ratio);
  const int by_lattice = row->tilt[0] != 0.0 || in_slab(row);
  double *S = matrix(row, &s), worst = 0.0, M[9];
  for (int i = 0; i < s.n; i++) {
    if (by_lattice) expected(row, &s, i, i, M);
    for (int p = 0; p < s.width; p++)
      for (int q = 0; q < s.width; q++) {
        double wanted = p == q ? alone_at(row, &s, i, p) : 0.0;
        if (by_lattice && p < 3 && q < 3) wanted = M[3 * p + q] * drag_of(&s, s.width * i);
        if (by_lattice && p >= 3 && q >= 3) continue;
        if (row->wall && (p < 3) != (q < 3)) continue; /* a wall couples them */
        worst = fmax(worst, fabs(S[(s.width * i + p) * numbers_of(&s) + s.width * i + q] - wanted));
      }
  }
  free(S);
  return within(worst, row->tolerance);
}

/* Where some are large, two small ones too */
static verdict t010_pair_at_a_distance(const climber *row)
{
  const double b = large_of(row);
  cast s = pair_of(row, 0.8, b, 1.25 * (0.8 + b) + 3.0);
  if (row->ratio > 1.0) add(&s, s.x[0] - 1.7, s.x[1] + 2.1, s.x[2] - 0.9, 1.1);
  return within(error_of_pairs(row, &s), row->tolerance);
}

static verdict t020_overlapping_pair(const climber *row)
{
  if (!(row->can & OVERLAPS)) return cannot("no overlaps");
  const double b = large_of(row), part[3] = {0.98, 0.5, 0.02};
  double worst = 0.0;
  for (int k = 0; k < 3; k++) {
    const cast s = pair_of(row, 0.8, b, part[k] * (0.8 + b));
    worst = fmax(worst, error_of_pairs(row, &s));
  }
  return within(worst, row->tolerance);
}

/* Beyond a cut-off nothing */
static verdict beyond_the_cut(const climber *row)
{
  const cast s = pair_of(row, 0.8, 1.3, 1.01 * row->cut);
  double *S = matrix(row, &s), worst = 0.0;
  for (int p = 0; p < 3; p++)
    for (int q = 3; q < 6; q++) worst = fmax(worst, fabs(S[6 * p + q]));
  free(S);
  return within(worst, 0.0);
}

/* Above a wall 12 h g/(8 pi eta rho^3) along the line between the spheres (Blake 1971), and less across it */
static verdict far_above_a_wall(const climber *row)
{
  cast s = {.width = 3};
  const double h = 4.0, g = 5.0, rho = 130.0;
  add(&s, 0.0, 0.0, wall_at + h, 0.8);
  add(&s, rho, 0.0, wall_at + g, 1.3);
  double *S = matrix(row, &s);
  const double scale = sqrt(drag_of(&s, 0) * drag_of(&s, 3)),
               far = 12.0 * h * g / (8.0 * SD_PI * eta_of(&s, 0, 1) * pow(rho, 3)) * scale;
  const double error = fmax(fabs(S[3] - far), fabs(S[6 + 4])) / far;
  free(S);
  return within(error, row->shell ? 0.04 : 0.02);
}

/* A pair far away is two points: Oseen's tensor. In a cube that is far larger than the pair, what its images add is one
 * number (Hasimoto 1959), with an error of R^2/L^3. */
static verdict t030_far_pair(const climber *row)
{
  if (!(row->can & FAR)) return beyond_the_cut(row);
  if (row->wall && row->edge == 0.0) return far_above_a_wall(row);
  if (row->ratio > 1.0 || in_slab(row)) { /* beyond the ranges of both levels, and in a box as far as can be */
    const cast s = pair_of(row, 0.8, large_of(row), row->edge > 0.0 ? 0.6 * row->edge : 70.0);
    return within(error_of_pairs(row, &s), row->tolerance);
  }
  const double small = row->edge > 0.0 ? 0.02 : 0.8, b = small / 0.8 * 1.3;
  const double R = row->edge > 0.0 ? 1.5 * (small + b) : 40.0 * fmax(small, b);
  const cast s = pair_of(row, small, b, R);
  const double eta = eta_of(&s, 0, 1);
  double *S = matrix(row, &s), M[9], r[3], worst = 0.0;
  const double scale = sqrt(drag_of(&s, 0) * drag_of(&s, 3));
  for (int d = 0; d < 3; d++) r[d] = s.x[d] - s.x[3 + d];
  if (row->tilt[0] != 0.0) expected(row, &s, 0, 1, M);
  else if (row->edge > 0.0) pair_tensor(r, small, b, eta, M);
  else block_of(1.0 / (8.0 * SD_PI * eta * R), 1.0 / (8.0 * SD_PI * eta * R), r, M);
  const double images = row->edge > 0.0 && row->tilt[0] == 0.0 ? 2.837297479480619 /
      (6.0 * SD_PI * eta * row->edge) : 0.0;
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++)
      worst = fmax(worst, fabs(S[6 * p + 3 + q] - (M[3 * p + q] - (p == q ? images : 0.0)) * scale));
  free(S);
  const double sizes = (small * small + b * b) / (R * R) * scale / (8.0 * SD_PI * eta * R);
  const double beyond = row->edge > 0.0 ? 3.0 * sqrt(small * b) * R * R / pow(row->edge, 3) : sizes;
  return within(worst, (row->shell && row->edge > 0.0 ? 0.05 : row->tolerance) + beyond);
}

/* F.u' = F'.u: the matrix is its own transpose, to rounding, also where sums have a tolerance. */
static verdict t040_reciprocity(const climber *row)
{
  double worst = 0.0;
  for (int width = 3; width <= widest(row); width += 3) {
    const cast s = crowd(row, many_of(row), width, side_of(row), 11);
    double *S = matrix(row, &s);
    const int n = numbers_of(&s);
    for (int p = 0; p < n; p++)
      for (int q = 0; q < p; q++) worst = fmax(worst, fabs(S[p * n + q] - S[q * n + p]));
    free(S);
  }
  return within(worst, 1e-11 + row->rounding);
}

/* Three spheres in a row of which the first and the last do not see each other: 1 - sqrt(2) c, c > 0.71 of those that
   overlap */
static cast one_between_two(const climber *row)
{
  cast s = {.width = 3};
  for (int i = 0; i < 3; i++) add(&s, row->cut / 1.5 * i, 0.0, row->wall ? 10.0 * row->cut : 0.0, row->cut / 1.2);
  return s;
}

/* The least eigenvalue of spheres that overlap as they like is positive; or it is not, and there is a scene that shows
   it. */
static verdict t050_positivity(const climber *row)
{
  const int claims = row->can & POSITIVE;
  const cast s = claims ? crowd(row, row->shell ? 4 : 8, widest(row), 0.3 * side_of(row), 5) : one_between_two(row);
  double *S = matrix(row, &s);
  const double least = least_eigenvalue(S, numbers_of(&s));
  free(S);
  if (!claims) return least < 0.0 ? cannot("not positive") : within(1.0, 0.0);
  return within(least > 0.0 ? 0.0 : -least, 0.0);
}

/* [9] a turn that the boundary allows: any, about the normal of a wall, that of a cube; 0: none */
static int turn_for(const climber *row, double T[9])
{
  const double c = cos(0.7), d = sin(0.7), about_z[9] = {c, -d, 0, d, c, 0, 0, 0, 1},
               cycle[9] = {0, 0, 1, 1, 0, 0, 0, 1, 0};
  const double about_x[9] = {1, 0, 0, 0, 0.8, -0.6, 0, 0.6, 0.8}, quarter[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1};
  if (row->tilt[0] != 0.0 || row->shell) return 0;
  if (row->edge > 0.0) memcpy(T, row->wall ? quarter : cycle, 9 * sizeof(double));
  else if (row->wall) memcpy(T, about_z, sizeof(about_z));
  else sd_product3(about_z, about_x, T);
  return 1;
}

/* Largest difference of two matrices of which the second has spheres in the opposite order, turned by T */
static double difference(const double *S, const double *B, const cast *s, const double T[9])
{
  const int n = numbers_of(s), blocks = n / 3;
  double worst = 0.0;
  for (int p = 0; p < blocks; p++)
    for (int q = 0; q < blocks; q++) {
      const int half = s->width / 3, other_p = half * (s->n - 1 - p / half) + p % half,
                other_q = half * (s->n - 1 - q / half) + q % half;
      double block[9], TB[9], turned[9], back[9];
      for (int e = 0; e < 9; e++) block[e] = S[(3 * p + e / 3) * n + 3 * q + e % 3];
      for (int e = 0; e < 9; e++) back[e] = T[3 * (e % 3) + e / 3];
      sd_product3(T, block, TB);
      sd_product3(TB, back, turned);
      for (int e = 0; e < 9; e++)
        worst = fmax(worst, fabs(turned[e] - B[(3 * other_p + e / 3) * n + 3 * other_q + e % 3]));
    }
  return worst;
}

/* The scene moved as a whole (along a wall), turned as its boundary allows, its spheres numbered the other way round */
static verdict t060_moved_turned_renumbered(const climber *row)
{
  double T[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  turn_for(row, T);
  const cast s = crowd(row, many_of(row), widest(row), side_of(row), 21);
  cast moved = {.width = s.width};
  for (int i = s.n - 1; i >= 0; i--) {
    double x[3];
    sd_multiply3(T, s.x + 3 * i, x);
    add(&moved, x[0] + 31.7, x[1] - 8.4, x[2] + (row->wall ? 0.0 : 5.9), s.a[i]);
    moved.w[moved.n - 1] = s.w[i];
  }
  double *S = matrix(row, &s), *B = matrix(row, &moved);
  const double worst = difference(S, B, &s, T);
  free(S), free(B);
  return within(worst, fmax(1e-11, (row->shell ? 1.0 : 4.0) * row->tolerance));
}

static verdict t070_linearity(const climber *row)
{
  cast s = crowd(row, 9, row->shell ? 3 : widest(row), side_of(row), 31);
  double F[3][6 * 9], u[3][6 * 9], worst = 0.0;
  uint64_t seed = 4;
  for (int k = 0; k < numbers_of(&s); k++) {
    F[0][k] = uniform(&seed, -1, 1);
    F[1][k] = uniform(&seed, -1, 1);
    F[2][k] = 2.0 * F[0][k] - 3.0 * F[1][k];
  }
  alone e;
  place_alone(&e, row, &s);
  for (int l = 0; l < 3; l++) assert_int_equal(sd_mobility_apply(&e.p.m, F[l], u[l]), SD_OK);
  free_alone(&e);
  for (int k = 0; k < numbers_of(&s); k++)
    worst = fmax(worst, fabs(u[2][k] - 2.0 * u[0][k] + 3.0 * u[1][k]) * drag_of(&s, k));
  return within(worst, 1e-12 + row->rounding);
}

typedef struct {
  const climber *row;
  const cast *s;
  const double *F;
} task;

static void product_on(rank *r, const void *ctx)
{
  const task *t = ctx;
  const int width = t->s->width;
  placed p;
  place_on(&p, t->row, t->s, r);
  double *F = calloc((size_t) (width * r->n) + 1, sizeof(double)), *u = calloc((size_t) (width * r->n) + 1,
                                                                               sizeof(double));
  for (int i = 0; i < r->n; i++) memcpy(F + width * i, t->F + width * r->number[i], sizeof(double) * (size_t) width);
  if (sd_mobility_apply(&p.m, F, u) != SD_OK) r->all->failed = 1;
  for (int i = 0; i < r->n; i++) memcpy(r->all->u + width * r->number[i], u + width * i, sizeof(double) * (size_t)
    width);
  free(F), free(u);
  place_free(&p, r);
}

/* Dealt in turn to three of four ranks: the last has none */
static verdict t080_ranks(const climber *row)
{
  if (!(row->can & RANKS)) return cannot("by its base");
  const cast s = crowd(row, 12, widest(row), side_of(row), 41);
  double F[6 * 12], one[6 * 12], worst = 0.0;
  uint64_t seed = 7;
  for (int k = 0; k < numbers_of(&s); k++) F[k] = uniform(&seed, -1, 1);
  const task t = {row, &s, F};
  for (int ranks = 1; ranks <= RANKS_MOST; ranks += RANKS_MOST - 1) {
    shared *all = on_ranks(ranks, product_on, &t);
    if (ranks == 1) memcpy(one, all->u, sizeof(one));
    for (int k = 0; k < numbers_of(&s); k++) worst = fmax(worst, fabs(all->u[k] - one[k]) * drag_of(&s, k));
    munmap(all, sizeof(shared));
  }
  return within(worst, 1e-11 + row->rounding);
}

/* What is drawn has the covariance of what the product has more than the rest: of white numbers L^-1 u, L its Cholesky
 * factor, the mean squares and products are 1 and 0, within six deviations. The rest, with what each sphere does
 * itself, is positive. */
static verdict t090_noise(const climber *row)
{
  enum { N = 3, MOST = 6 * N, DRAWS = 800 };
  const cast s = crowd(row, N, 3, 0.5 * side_of(row), 51);
  const int n = numbers_of(&s);
  alone e;
  place_alone(&e, row, &s);
  if (!(row->can & DIVIDES)) {
    const int divides = sd_mobility_divides(&e.p.m);
    free_alone(&e);
    return divides ? within(1.0, 0.0) : cannot("does not divide");
  }
  assert_true(sd_mobility_divides(&e.p.m));
  double C[MOST * MOST], rest[MOST * MOST], F[MOST] = {0.0}, u[MOST], v[MOST], sum[MOST * MOST] = {0.0}, worst = 0.0;
  for (int q = 0; q < n; q++) {
    F[q] = 1.0;
    assert_int_equal(sd_mobility_apply(&e.p.m, F, u), SD_OK);
    assert_int_equal(sd_mobility_apply_rest(&e.p.m, F, v), SD_OK);
    F[q] = 0.0;
    for (int p = 0; p < n; p++) C[p * n + q] = u[p] - v[p];
    for (int p = 0; p < n; p++) rest[p * n + q] = (v[p] + (p == q ? 1.0 / drag_of(&s, p) : 0.0)) *
        sqrt(drag_of(&s, p) * drag_of(&s, q));
  }
  if (!(least_eigenvalue(rest, n) > 0.0)) worst = 1.0;
  assert_int_equal(sd_cholesky(n, C), SD_OK); /* C[p + n q], p >= q: L */
  for (int k = 0; k < DRAWS; k++) {
    const sd_random_key key = {5, SD_RANDOM_SPHERE, (uint64_t) k};
    assert_int_equal(sd_mobility_draw(&e.p.m, &key, u), SD_OK);
    for (int p = 0; p < n; p++) {
      for (int q = 0; q < p; q++) u[p] -= C[p + n * q] * u[q];
      u[p] /= C[p + n * p];
    }
    for (int p = 0; p < n * n; p++) sum[p] += u[p / n] * u[p % n] / DRAWS;
  }
  for (int p = 0; p < n; p++)
    for (int q = 0; q < n; q++) worst = fmax(worst, fabs(sum[p * n + q] - (p == q)) / (p == q ? sqrt(2.0) : 1.0));
  free_alone(&e);
  return within(worst, 6.0 / sqrt(DRAWS));
}

/* Velocity [3] and spin [3] of sphere 0 where it is moved by `by` along d, from a force and a torque on sphere 1 */
static void moved_by(const climber *row, const cast *s, int d, double by, double *answer)
{
  static cast there;
  there = *s;
  there.x[d] += by;
  double F[12] = {0.0}, u[12];
  const double a = s->a[1], push[6] = {0.6, -1.0, 0.8, 0.9 * a, 0.5 * a, -0.7 * a};
  memcpy(F + 6, push, sizeof(push));
  alone e;
  place_alone(&e, row, &there);
  assert_int_equal(sd_mobility_apply(&e.p.m, F, u), SD_OK);
  free_alone(&e);
  memcpy(answer, u, 6 * sizeof(double));
}

/* A sphere spins as the fluid does: by half the curl of the velocity that it has where it stands (Faxen), which is
 * taken by differences of fourth order. */
static verdict t100_torques(const climber *row)
{
  if (!(row->can & TORQUES)) return cannot("no torques");
  if (row->shell) return cannot("spin in t000");
  if (row->taper) return cannot("no flow field");
  const double b = large_of(row), step = 0.04;
  cast s = pair_of(row, 0.8, b, 1.25 * (0.8 + b) + 1.0);
  s.width = 6;
  double slope[3][3], here[6], worst = 0.0;
  for (int d = 0; d < 3; d++) {
    double u[4][6];
    for (int k = 0; k < 4; k++) moved_by(row, &s, d, step * (k < 2 ? k - 2 : k - 1), u[k]);
    for (int c = 0; c < 3; c++) slope[d][c] = (u[0][c] - 8.0 * u[1][c] + 8.0 * u[2][c] - u[3][c]) / (12.0 * step);
  }
  moved_by(row, &s, 0, 0.0, here);
  for (int d = 0; d < 3; d++) {
    const int p = (d + 1) % 3, q = (d + 2) % 3;
    const double half_curl = 0.5 * (slope[p][q] - slope[q][p]);
    worst = fmax(worst, fabs(here[3 + d] - half_curl) * 6.0 * SD_PI * eta_of(&s, 0, 1) * s.a[1] * s.a[0]);
  }
  return within(worst, 1e-6 + row->tolerance / step);
}

/* Radii of 1 : 3 to 1 : 30, apart, through each other, one in the other. A tolerance is of the rms of all, this the
   largest number. */
static verdict t110_unlike_radii(const climber *row)
{
  double worst = 0.0;
  for (int k = 0; k < 2; k++) {
    const double times[2] = {3, 30}, part[3] = {1.1, 0.9, 0.3}, b = row->ratio > 1.0 ? 26.0 : 2.5;
    const double a = b / times[k] * (row->ratio > 1.0 ? 0.3 : 1.0);
    if (row->shell && k > 0) continue;
    for (int l = 0; l < (row->shell ? 1 : 3); l++) {
      const cast s = pair_of(row, a, b, (row->shell ? 2.0 : part[l]) * (a + b));
      worst = fmax(worst, error_of_pairs(row, &s));
    }
  }
  return within(worst, row->shell ? 0.05 : 3.0 * row->tolerance);
}

/* Each sphere may be given by any of its images: the torn scene is the same. */
static verdict t120_torn_box(const climber *row)
{
  if (!(row->edge > 0.0)) return cannot("no lattice");
  const cast s = crowd(row, many_of(row), widest(row), side_of(row), 61);
  static cast torn;
  double edge[3][3], worst = 0.0;
  const sd_ewald_box box = box_of(row, &s);
  periodic_edges(&box, edge);
  torn = s;
  for (int i = 0; i < s.n; i++)
    for (int d = 0; d < 3; d++) torn.x[3 * i + d] += (i % 3 - 1) * edge[i % 2][d] + (i % 4 - 2) *
        edge[row->wall ? 1 : 2][d];
  double *S = matrix(row, &s), *B = matrix(row, &torn);
  for (int k = 0; k < numbers_of(&s) * numbers_of(&s); k++) worst = fmax(worst, fabs(S[k] - B[k]));
  free(S), free(B);
  return within(worst, 1e-10 + row->rounding);
}

typedef struct {
  const char *name;
  verdict (*climb)(const climber *row);
} rung;

static const rung rungs[] = {
    {"t000 lone sphere", t000_lone_sphere},
    {"t010 pair at a distance", t010_pair_at_a_distance},
    {"t020 overlapping pair", t020_overlapping_pair},
    {"t030 far pair", t030_far_pair},
    {"t040 reciprocity", t040_reciprocity},
    {"t050 positivity", t050_positivity},
    {"t060 moved, turned, renumbered", t060_moved_turned_renumbered},
    {"t070 linearity", t070_linearity},
    {"t080 ranks", t080_ranks},
    {"t090 noise", t090_noise},
    {"t100 torques", t100_torques},
    {"t110 unlike radii", t110_unlike_radii},
    {"t120 torn box", t120_torn_box},
};
enum { RUNGS = sizeof(rungs) / sizeof(rungs[0]) };

typedef struct {
  const climber *row;
  const rung *step;
  verdict said;
} cell;

static cell cells[CLIMBERS][RUNGS];

static void climb(void **state)
{
  cell *c = *state;
  c->said = c->step->climb(c->row);
  if (!c->said.cannot && !(c->said.error <= c->said.bound))
    fail_msg("%s: %s: %.2g, at most %.2g is allowed", c->row->name, c->step->name, c->said.error, c->said.bound);
}

static int print_table(void **state)
{
  (void) state;
  printf("%-20s", "");
  for (int k = 0; k < RUNGS; k++) printf(" %-15.4s", rungs[k].name);
  printf("\n");
  for (int i = 0; i < CLIMBERS; i++) {
    printf("%-20s", climbers[i].name);
    for (int k = 0; k < RUNGS; k++) {
      char said[32];
      snprintf(said, sizeof(said), "%.0e", cells[i][k].said.error);
      printf(" %-15s", cells[i][k].said.cannot ? cells[i][k].said.cannot : said);
    }
    printf("\n");
  }
  return 0;
}

int main(void)
{
  static char names[CLIMBERS * RUNGS][80];
  static struct CMUnitTest tests[CLIMBERS * RUNGS];
  for (int i = 0; i < CLIMBERS; i++)
    for (int k = 0; k < RUNGS; k++) {
      const int at = i * RUNGS + k;
      cells[i][k] = (cell){climbers + i, rungs + k, {0.0, 0.0, "not run"}};
      snprintf(names[at], sizeof(names[at]), "%s: %s", rungs[k].name, climbers[i].name);
      tests[at] = (struct CMUnitTest){names[at], climb, NULL, NULL, &cells[i][k]};
    }
  return cmocka_run_group_tests(tests, NULL, print_table);
}
