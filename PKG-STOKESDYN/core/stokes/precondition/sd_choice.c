#include "sd_choice.h"

#include <math.h>

#include "sd_ewald_cost.h"

/* Solves of which means are taken. */
static const double TRIAL = 8.0;
/* Iterations with over those without, before they are known. */
static const double GUESS = 0.25;
/* Scenes that are worth a preconditioner take as many for each digit. */
static const double PER_DIGIT = 7.0;
/* Set-ups of blocks by list that a change must have been worth: the first warm starts are poor. */
static const double PATIENCE = 4.0;

/* Operations, all in pairs of a product by list. A pair of a cloud serves both of its spheres and
 * reads no list; vectors cost by spheres, in an iteration and in a preconditioner; a stored block
 * that is applied costs what a pair costs, as "with = 1 + stored blocks / pairs" says. Blocks of a
 * matrix that is factored have their tensor evaluated by itself, and an inverse in double precision
 * takes more than a factor in single. Each column of the sparse factor has its neighbours found and
 * its memory taken, whatever its length: in a cloud of ten spheres that is nearly all. Measured
 * within a factor of 1.5 (bench_solve), which is enough: what decides in the end is iterations. */
static const double CLOUD_PAIR = 1.0 / 3.0, SPHERE = 40.0, SPHERE_APPLIED = 20.0, FACTORED = 15.0,
                    INVERTED = 40.0, COLUMN = 1800.0;
/* Blocks a sphere in the sparse factor of a large compact cloud, rho 3; a small one has half of its
 * pairs. */
static const double REACH = 42.0;

/* Of the long waves, likewise: a sphere in an application, without and with torques; in the set-up
 * each row of Z, and the factor of G. The product by FFT counts in pairs of a large
 * cloud, which are faster than those of small ones. */
static const double EWALD_PAIR = 1.0 / 6.0, WITH_TORQUES = 2.5, WAVES_APPLIED[2] = {80.0, 110.0},
                    WAVES_ROW = 800.0, WAVES_FACTOR = 2e5;

static double product(double n, double pairs)
{
  return pairs + SPHERE * n;
}

static double column(double n)
{
  return 1.0 / (1.0 / REACH + 2.0 / (n + 1.0));
}

sd_cost sd_cost_sparse(double n, int width)
{
  const double one = product(n, CLOUD_PAIR * n * n), m = column(n), heavy = width / 3.0;
  return (sd_cost){.iteration = 1.0 + (heavy * m + SPHERE_APPLIED) * n / one,
                   .make = (heavy * FACTORED * m * m + COLUMN) * n / one};
}

sd_cost sd_cost_blocks(double n, int width, double clumps, double stored)
{
  const double one = product(n, CLOUD_PAIR * n * n), m = column(clumps), heavy = width / 3.0;
  return (sd_cost){.iteration = 1.0 + (heavy * stored + m * clumps + SPHERE_APPLIED * n) / one,
                   .make = heavy * INVERTED * stored / one,
                   .solve = FACTORED * m * m * clumps / one};
}

sd_cost sd_cost_blocks_by_list(double n, int width, double pairs, double stored)
{
  const double one = product(n, pairs), heavy = width / 3.0;
  return (sd_cost){.iteration = 1.0 + (heavy * stored + SPHERE_APPLIED * n) / one,
                   .solve = heavy * INVERTED * stored / one};
}

/* The blocks are applied twice. */
sd_cost sd_cost_waves(const sd_ewald *e, int width, double stored)
{
  if (!(e->count > 0.0)) return (sd_cost){.iteration = 1.0};
  const double one = EWALD_PAIR * sd_ewald_cost(e) * (width == 6 ? WITH_TORQUES : 1.0);
  const double heavy = width / 3.0;
  const double applied = WAVES_APPLIED[width == 6] * e->count + 2.0 * heavy * stored;
  const double made = WAVES_ROW * width * e->count + INVERTED * heavy * stored + WAVES_FACTOR;
  return (sd_cost){.iteration = 1.0 + applied / one, .make = made / one};
}

static double cost_with(const sd_cost *k, double iterations)
{
  return iterations > 0.0 ? k->solve + iterations * k->iteration : 0.0;
}

/* As far as it is not known: one iteration at least */
static double guess_with(const sd_cost *k, double iterations)
{
  return iterations > 0.0 ? cost_with(k, fmax(1.0, GUESS * iterations)) : 0.0;
}

static double price(const sd_cost *k)
{
  return k->make + PATIENCE * k->solve;
}

/* Conjugate gradients end after as many iterations as there are unknowns. */
int sd_choice_at_once(const sd_cost *k, double tolerance, double unknowns)
{
  const double expected = fmin(unknowns, PER_DIGIT * fmax(0.0, -log10(tolerance)));
  return k->make + guess_with(k, expected) < expected;
}

/* Both ways have been gone, one after the other: the means are those of neighbouring solves. */
static void measure(sd_choice *c)
{
  if (!(c->other > 0.0 && c->mean > 0.0)) return;
  c->ratio = c->with != SD_WITHOUT ? c->mean / c->other : c->other / c->mean;
  c->other = 0.0;
}

/* Begin anew, on this way or the other. */
static void begin(sd_choice *c, sd_way way)
{
  if (c->with != way) {
    measure(c);
    c->other = c->mean;
  }
  c->with = way;
  c->spent = c->solves = c->mean = 0.0;
}

/* What a solve without would cost, of one with */
static double without(const sd_choice *c, double paid)
{
  if (c->with == SD_WITH_FOR_GOOD) return INFINITY;
  if (c->other > 0.0) return c->other;
  return paid / (c->ratio > 0.0 ? c->ratio : GUESS);
}

/* A life of the preconditioner ends, and `solves` of them have paid for it and for its wear. The
 * next way: by its costs a solve against those without. */
static sd_way after_life(const sd_choice *c, const sd_cost *k)
{
  const double life = c->mean + (k->make + c->spent) / fmax(1.0, c->solves);
  return life < without(c, c->mean) ? (sd_way) c->with : SD_WITHOUT;
}

void sd_choice_lost(sd_choice *c, const sd_cost *k)
{
  if (c->with != SD_WITHOUT && c->solves > 0.0) begin(c, after_life(c, k));
}

/* Two ways are known by one number each: the ratio of their costs in successive solves, and this
 * one's latest mean. With: a solve may cost what it did when the preconditioner was new, or what
 * one without would, if that is less; what it costs more is spent. Without: what it costs more than
 * one with. */
int sd_choice_learn(sd_choice *c, const sd_cost *k, int iterations)
{
  const int with = c->with != SD_WITHOUT;
  const double paid = with ? cost_with(k, iterations) : iterations;
  c->solves++;
  if (!with)
    c->mean += (paid - c->mean) / fmin(c->solves, 2.0 * TRIAL);
  else if (c->solves <= TRIAL)
    c->mean += (paid - c->mean) / c->solves;
  if (c->solves == TRIAL) measure(c);

  double better = c->ratio > 0.0 ? c->ratio * paid : guess_with(k, iterations);
  if (with) better = c->solves > TRIAL ? fmin(c->mean, without(c, paid)) : without(c, paid);
  c->spent = fmax(0.0, c->spent + paid - better);
  if (c->spent < price(k)) return 0;
  begin(c, with ? after_life(c, k) : SD_WITH);
  return with && c->with != SD_WITHOUT;
}
