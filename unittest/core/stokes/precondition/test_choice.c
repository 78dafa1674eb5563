/* Which way the automatic choice of a preconditioner goes: bounds of what it costs, for any costs. */
#include "check.h"

#include "sd_choice.h"
#include "sd_constants.h"

#include <string.h>

/* A run: products paid, changes of way, sets made. */
typedef struct {
  double paid;
  int changes, made;
} run;

/* A solve that takes `without` or `with` iterations */
static void solve(sd_choice *c, const sd_cost *k, double without, double with, run *r)
{
  const int way = c->with != SD_WITHOUT;
  const double iterations = way ? with : without;
  r->paid += !way ? without : with > 0.0 ? k->solve + with * k->iteration : 0.0;
  const int worn = sd_choice_learn(c, k, (int) iterations);
  const int changed = (c->with != SD_WITHOUT) != way;
  r->changes += changed;
  if (worn || (changed && !way)) {
    r->made++;
    r->paid += k->make;
  }
}

static double cost_of(const sd_cost *k, int with, double iterations)
{
  return !with ? iterations : iterations > 0.0 ? k->solve + iterations * k->iteration : 0.0;
}

/* Costs and iterations over decades. Steady solves: no more than twice the better way, which pays for its
 * set-up, and what it takes to try the other once; in the end, after many, the better way; and never more
 * than there and back. */
static void steady_solves_cost_twice_the_better_way_at_most(void **state)
{
  (void) state;
  uint64_t seed = 3;
  int tried = 0, stayed = 0;
  for (int trial = 0; trial < 2000; trial++) {
    const sd_cost k = {.iteration = 1.0 + exp(uniform(&seed, -4, 1)),
                       .make = trial % 3 ? exp(uniform(&seed, 0, 6)) : 0.0,
                       .solve = trial % 3 == 1 ? 0.0 : exp(uniform(&seed, -2, 3))};
    const int without = 1 + (int) exp(uniform(&seed, 0, 5)),
              with = 1 + (int) (without * uniform(&seed, 0.02, 1.1));
    const double price = k.make + 4.0 * k.solve, each[2] = {cost_of(&k, 0, without),
                                                            cost_of(&k, 1, with)};
    sd_choice c = {0};
    run r = {0};
    for (int s = 1; s <= 3000; s++) {
      solve(&c, &k, without, with, &r);
      const double best = fmin(s * each[0], k.make + s * each[1]);
      /* solves are whole: the last one before a change may go beyond the price */
      if (r.paid > 2.0 * best + price + each[0] + each[1])
        fail_msg("trial %d: after %d solves %g, best %g, price %g", trial, s, r.paid, best, price);
    }
    assert_true(r.changes <= 2);
    const int here = c.with != SD_WITHOUT;
    tried += r.changes > 0;
    stayed += r.changes == 1;
    /* both known: a way that is dearer is left when that has cost the price of a change */
    if (r.changes > 0) assert_true((each[here] - each[!here]) * 2000 <= price);
  }
  assert_true(tried > 1000 && stayed > 500); /* the bounds were put to the test */
}

/* Iterations scatter, as those of moving spheres do; both ways cost nearly alike. */
static void it_does_not_oscillate(void **state)
{
  (void) state;
  const sd_cost k = {.iteration = 1.2, .make = 60.0};
  for (int with = 8; with <= 18; with += 5) { /* better, alike, worse than 15 without */
    uint64_t seed = 7;
    sd_choice c = {0};
    run r = {0};
    for (int s = 0; s < 20000; s++) {
      const double scatter = floor(uniform(&seed, -3, 4));
      solve(&c, &k, 15 + scatter, with + scatter, &r);
    }
    assert_true(r.changes <= 2);
    const double best = fmin(15.0, 1.2 * with) * 20000;
    assert_true(r.paid < 1.05 * best);
    assert_int_equal(c.with != SD_WITHOUT, with == 8);
  }
}

static void cheap_ones_are_taken_at_once(void **state)
{
  (void) state;
  const sd_cost cheap = {.iteration = 1.2, .solve = 5.0}, dear = {.iteration = 1.2, .make = 100.0};
  assert_true(sd_choice_at_once(&cheap, 1e-6, INFINITY));
  assert_false(sd_choice_at_once(&cheap, 0.3, INFINITY));
  assert_false(sd_choice_at_once(&dear, 1e-6, INFINITY));
  assert_false(sd_choice_at_once(&cheap, 1e-6, 1.0)); /* one iteration is all that it takes without */
}

static void solves_that_take_nothing_change_nothing(void **state)
{
  (void) state;
  const sd_cost k = {.iteration = 1.2, .make = 60.0};
  for (int way = SD_WITHOUT; way <= SD_WITH_FOR_GOOD; way++) {
    sd_choice c = {.with = way};
    run r = {0};
    for (int s = 0; s < 10000; s++) solve(&c, &k, 0, 0, &r);
    assert_true(r.changes == 0 && r.made == 0 && r.paid == 0.0);
  }
}

/* The iterations go up by one every `period` solves until it is made anew: then another is made about
 * when the wear has cost as much as it does. Where even new ones are lost soon, it goes without. */
static void worn_ones_are_made_anew_while_they_earn_it(void **state)
{
  (void) state;
  const sd_cost k = {.iteration = 1.2, .make = 60.0};
  for (int good = 0; good < 2; good++) {
    sd_choice c = {.with = good ? SD_WITH_FOR_GOOD : SD_WITH};
    run r = {0};
    int age = 0;
    for (int s = 0; s < 4000; s++) {
      const int made = r.made;
      solve(&c, &k, 40, 10 + age++ / 20, &r);
      if (r.made > made) {
        assert_true(age > 30 && age < 70); /* 20 (1 + 2) and some of 3 iterations more: 60/1.2 */
        age = 0;
      }
    }
    assert_true(r.made > 50 && r.changes == 0);
  }
}

static void every_set_up_must_be_earned(void **state)
{
  (void) state;
  const sd_cost k = {.iteration = 1.2, .make = 100.0};
  for (int period = 2; period <= 40; period += 38) { /* solves that a factor lives */
    sd_choice c = {0};
    run r = {0};
    int without = 0;
    for (int s = 0; s < 4000; s++) {
      solve(&c, &k, 20, 5, &r);
      if (s % period == 0 && c.with != SD_WITHOUT) {
        sd_choice_lost(&c, &k);
        if (c.with != SD_WITHOUT) r.paid += k.make;
      }
      without += c.with == SD_WITHOUT;
    }
    assert_true(period == 2 ? without > 2000 : without < 400);
    assert_true(r.paid < (period == 2 ? 2.2 : 0.7) * 20 * 4000);
  }
}

static void saved_numbers_go_on_alike(void **state)
{
  (void) state;
  const sd_cost k = {.iteration = 1.2, .make = 60.0};
  for (int at = 0; at < 40; at++) {
    sd_choice c = {0}, d = {0};
    uint64_t seed = 8;
    for (int s = 0; s < 60; s++) {
      const int its = (int) uniform(&seed, 0, c.with != SD_WITHOUT ? 5 : 12);
      if (s == at) memcpy(&d, &c, sizeof(c));
      if (s >= at) sd_choice_learn(&d, &k, its);
      sd_choice_learn(&c, &k, its);
    }
    assert_memory_equal(&c, &d, sizeof(c));
  }
}

/* What is counted against what sd_product and the preconditioners take (bench_product, bench_solve), in products: a
 * factor of 2 at most. The lattice of 1000, 50 clumps of 20 spheres, with torques too. */
static void counted_costs_are_those_measured(void **state)
{
  (void) state;
  const sd_cost sparse = sd_cost_sparse(1000, 3), torques = sd_cost_sparse(1000, 6),
                blocks = sd_cost_blocks(1000, 3, 50, 50 * 400),
                list = sd_cost_blocks_by_list(2000, 3, 2000 * 19, 100 * 400);
  const struct {
    double counted, measured;
  } costs[] = {{sparse.iteration - 1, 0.20}, {sparse.make, 75.0},         {torques.iteration - 1, 0.36},
               {torques.make, 125.0},        {blocks.iteration - 1, 0.14}, {blocks.make, 2.3},
               {list.iteration - 1, 0.9},    {list.solve, 14.5}};
  for (int i = 0; i < 8; i++)
    if (!(costs[i].counted > 0.5 * costs[i].measured && costs[i].counted < 2.0 * costs[i].measured))
      fail_msg("cost %d: %g, measured %g", i, costs[i].counted, costs[i].measured);
}

/* Of the waves beside the engine's product, 10^5 equal spheres, phi 0.2 (reference, ewald.md section 9: 0.051 s at 1e-3 and 0.18 s
 * at 1e-6, where bench_solve waves has 0.02 s an application and 0.55 s a set-up): 0.4 and 0.1 of a product, ten and three of them.
 * A solve from zero to 1e-3 pays for both; one of ten spheres does not. */
static void waves_are_cheap_beside_a_product_by_fft(void **state)
{
  (void) state;
  for (int k = 0; k < 2; k++) {
    const double side = cbrt(1e5 * 4.0 / 3.0 * SD_PI / 0.2);
    const sd_ewald_box box = {.periodic = 1, .edge = {side, side, side}};
    const sd_ewald_sizes sizes = {.all = {1e5, 1e5, 1e5, 1.0}};
    sd_ewald e;
    assert_int_equal(sd_ewald_choose(&box, &sizes, 3, k ? 1e-6 : 1e-3, &e), SD_OK);
    const sd_cost c = sd_cost_waves(&e, 3, 0.0);
    CHECK_NEAR(c.iteration, k ? 1.1 : 1.4, k ? 0.05 : 0.15);
    CHECK_NEAR(c.make, k ? 3.0 : 10.6, k ? 1.5 : 5.0);
    assert_true(sd_cost_waves(&e, 6, 0.0).iteration < c.iteration);
    assert_true(sd_cost_waves(&e, 3, 1e8).make > c.make);
    assert_true(sd_choice_at_once(&c, k ? 1e-6 : 1e-3, 3e5));
  }
  const sd_ewald_box box = {.periodic = 1, .edge = {9.0, 9.0, 9.0}};
  const sd_ewald_sizes sizes = {.all = {10.0, 10.0, 10.0, 1.0}}, none = {0};
  sd_ewald e;
  assert_int_equal(sd_ewald_choose(&box, &sizes, 3, 1e-3, &e), SD_OK);
  const sd_cost few = sd_cost_waves(&e, 3, 0.0);
  assert_false(sd_choice_at_once(&few, 1e-3, 30.0));
  assert_int_equal(sd_ewald_choose(&box, &none, 3, 1e-3, &e), SD_OK);
  assert_true(sd_cost_waves(&e, 3, 0.0).make == 0.0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(steady_solves_cost_twice_the_better_way_at_most),
      cmocka_unit_test(it_does_not_oscillate),
      cmocka_unit_test(cheap_ones_are_taken_at_once),
      cmocka_unit_test(solves_that_take_nothing_change_nothing),
      cmocka_unit_test(worn_ones_are_made_anew_while_they_earn_it),
      cmocka_unit_test(every_set_up_must_be_earned),
      cmocka_unit_test(saved_numbers_go_on_alike),
      cmocka_unit_test(counted_costs_are_those_measured),
      cmocka_unit_test(waves_are_cheap_beside_a_product_by_fft),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
