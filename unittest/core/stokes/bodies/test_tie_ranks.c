/* Films on several ranks (sd_tie_factor.h). Each has the factor of its own bodies and of some at its borders;
 * the answer is that of one rank, in as many products with the mobility, on two ranks in as many with the
 * films, and on four not in many more. */
#include "on_ranks.h"

#include "settling.h"

enum { N = RANKS_SPHERES, MOST_RANKS = RANKS_MOST };
static const double STEP = 0.02;

/* What is found: rows by the number of their sphere, products with the mobility and with L */
typedef struct {
  double l[6 * N], before[6 * N], v[6 * N];
  int products;
  long within;
  /* by ranks: bodies of others in its factor, of its own in theirs, of its own not in its own, in several */
  int others[MOST_RANKS], lents[MOST_RANKS], aways[MOST_RANKS], shares[MOST_RANKS];
} answer;

/* Who is above: the higher rank, the lower one, or each time the sphere of the odd number */
typedef enum { HIGHER, LOWER, ODD } up;

typedef struct {
  settling *s;
  answer *found;
  int warm;
  double tolerance;
  up above;
} task;

typedef struct {
  rank *r;
  sd_packed packed;
} mobility;

static sd_status product(void *ctx, const double *F, double *u)
{
  mobility *m = ctx;
  static double of_all[6 * N], all[6 * N];
  rank_spread(m->r, F, of_all, 6);
  sd_packed_share(&m->packed, 0, 1, of_all, all);
  for (int i = 0; i < m->r->n; i++) memcpy(u + 6 * i, all + 6 * m->r->number[i], 6 * sizeof(double));
  return SD_OK;
}

/* By the quarters of the cloud */
static int owner(const settling *s, int i, int ranks)
{
  double middle[2] = {0.0};
  for (int k = 0; k < N; k++)
    for (int d = 0; d < 2; d++) middle[d] += s->near.s.x[3 * k + d] / N;
  const double *x = s->near.s.x + 3 * i;
  return ranks == 1 ? 0 : (x[0] > middle[0]) + (ranks > 2 ? 2 * (x[1] > middle[1]) : 0);
}

static void say_above(const rank *r, const settling *s, up who, double *above)
{
  for (int j = r->n; j < r->n_all; j++) {
    const int higher = owner(s, r->number[j], r->ranks) > r->me;
    above[j - r->n] = who == ODD ? r->number[j] % 2 : who == HIGHER ? higher : !higher;
  }
}

/* The spheres of others are all ghosts. */
static void work(rank *r, const void *ctx)
{
  const task *t = ctx;
  settling *s = t->s;
  answer *found = t->found;
  int number[N];
  for (int pass = 0; pass < 2; pass++) {
    for (int i = 0; i < N; i++)
      if ((owner(s, i, r->ranks) == r->me) == (pass == 0)) number[r->n_all++] = i;
    if (pass == 0) r->n = r->n_all;
  }
  r->number = number;
  r->total = N;
  double x[3 * N], a[N], w[N], F[6 * N], l[6 * N], before[6 * N], v[6 * N], V[6 * N], exerted[6 * N], u[6 * N] = {0.0};
  for (int i = 0; i < N; i++) {
    const int k = number[i];
    memcpy(x + 3 * i, s->near.s.x + 3 * k, 3 * sizeof(double));
    a[i] = s->near.s.a[k];
    w[i] = s->near.s.w[k];
    memcpy(F + 6 * i, s->F + 6 * k, 6 * sizeof(double));
    memcpy(l + 6 * i, found->l + 6 * k, 6 * sizeof(double));
    memcpy(before + 6 * i, found->before + 6 * k, 6 * sizeof(double));
  }
  mobility m = {r, s->packed};
  sd_lubrication L = {0};
  double above[N];
  sd_tie tie = {.L = &L, .above = t->above == HIGHER ? NULL : above};
  const sd_lubrication_scene scene = {.functions = s->near.functions, .gap = s->near.gap, .range = s->near.range,
                                      .n = r->n,
                                      .n_all = N, .spheres = {x, a, w}, .world = rank_world(r)};
  say_above(r, s, t->above, above);
  sd_bodies A = s->A;
  A.lone = A.spheres.n = A.points.n = r->n;
  A.apply = product;
  A.apply_ctx = &m;
  A.tie = &tie;
  A.world = rank_world(r);
  const sd_bodies_problem problem = {u, F, NULL, t->warm, t->tolerance, 400};
  const sd_bodies_answer answer = {l, before, V, v, exerted};
  sd_bodies_report report;
  if (sd_lubrication_place(&L, &scene) != SD_OK) r->all->failed = 1;
  if (sd_bodies_solve(&A, &problem, &answer, s->work, &report) != SD_OK) r->all->failed = 1;
  rank_meet(r);
  for (int i = 0; i < r->n; i++)
    for (int d = 0; d < 6; d++) {
      const int to = 6 * number[i] + d;
      found->l[to] = l[6 * i + d];
      found->before[to] = before[6 * i + d];
      found->v[to] = v[6 * i + d];
    }
  found->others[r->me] = tie.border.others;
  found->lents[r->me] = tie.border.lents;
  found->aways[r->me] = tie.border.aways;
  found->shares[r->me] = tie.border.shares;
  if (r->me == 0) {
    found->products = report.products;
    found->within = tie.products;
  }
  sd_tie_free(&tie);
  sd_lubrication_free(&L);
}

static void solve_on(int ranks, settling *s, answer *found, int warm, double tolerance)
{
  const task t = {s, found, warm, tolerance, HIGHER};
  munmap(on_ranks(ranks, work, &t), sizeof(shared));
}

/* All spheres so many steps on, by velocities V */
static void go_on(settling *s, const double *V, double step)
{
  for (int i = 0; i < N; i++)
    for (int d = 0; d < 3; d++) s->near.s.x[3 * i + d] += step * V[6 * i + d];
  sd_packed_free(&s->packed);
  settling_place(s);
}

static void films_of_ranks_are_those_of_one(void **state)
{
  (void) state;
  /* with stiff pairs, and with none: products with L on two ranks and on four, over those of one */
  static const struct {
    double phi, gap, most[2];
  } of[] = {{0.1, 1e-6, {1.1, 1.8}}, {0.5, 1e-6, {1.15, 2.0}}, {0.4, 0.1, {1.1, 1.1}}};
  answer *found = ranks_memory(sizeof(answer));
  for (int e = 0; e < 3; e++) {
    settling *s = settling_create(N, of[e].phi, of[e].gap);
    double *reference = malloc(sizeof(double) * 6 * N);
    int products = 0, later = 0;
    long within = 0;
    solve_on(1, s, found, 0, 1e-9);
    memcpy(reference, found->v, sizeof(double) * 6 * N);
    for (int ranks = 1; ranks <= MOST_RANKS; ranks *= 2) {
      solve_on(ranks, s, found, 0, 1e-9);
      memcpy(s->v, found->v, sizeof(double) * 6 * N);
      assert_true(settling_error(s, reference) < 1e-8);
      solve_on(ranks, s, found, 0, 1e-3);
      memcpy(s->v, found->v, sizeof(double) * 6 * N);
      assert_true(settling_error(s, reference) < 2e-4);
      if (ranks == 1) {
        products = found->products;
        within = found->within;
      }
      print_message("phi %.1f, gaps %g, %d ranks: %d products, %ld with L", of[e].phi, of[e].gap, ranks,
                    found->products, found->within);
      assert_true(found->products <= products + 1);
      assert_true(ranks == 1 || (double) found->within <= of[e].most[ranks > 2] * (double) within);
      solve_on(ranks, s, found, 1, 1e-3); /* as it stands, from what it found */
      print_message("; again %d, %ld", found->products, found->within);
      assert_true(found->products <= 2);
      go_on(s, reference, STEP);
      solve_on(ranks, s, found, 1, 1e-3);
      print_message("; a step later %d, %ld\n", found->products, found->within);
      if (ranks == 1) later = found->products;
      assert_true(found->products <= later + 1);
      go_on(s, reference, -STEP);
    }
    free(reference);
    settling_free(s);
  }
  munmap(found, sizeof(answer));
}

/* A border is in the factor of the rank below it alone; where borders meet, all of it is in that of both. */
static void one_of_two_ranks_factors_their_border(void **state)
{
  (void) state;
  answer *found = ranks_memory(sizeof(answer));
  settling *s = settling_create(N, 0.3, 1e-3);
  task t = {s, found, 0, 1e-6, HIGHER};
  solve_on(1, s, found, 0, 1e-6);
  const long within = found->within;
  for (t.above = HIGHER; t.above <= ODD; t.above++) {
    munmap(on_ranks(2, work, &t), sizeof(shared));
    print_message("%ld products with L, %ld on one rank; in factors of the other rank %d %d\n", found->within, within,
                  found->lents[0], found->lents[1]);
    assert_true(found->within <= within + within / 10 + 1);
    const int below = t.above == LOWER;
    for (int p = 0; p < 2; p++) {
      const int all = t.above == ODD, has = all || p == below;
      assert_int_equal(found->lents[p], found->others[1 - p]);
      assert_int_equal(found->others[p] > 0, has);
      assert_int_equal(found->aways[p], has ? 0 : found->lents[p]);
      assert_int_equal(found->shares[p] > 0, all);
    }
  }
  settling_free(s);
  munmap(found, sizeof(answer));
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(films_of_ranks_are_those_of_one),
                                     cmocka_unit_test(one_of_two_ranks_factors_their_border)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
