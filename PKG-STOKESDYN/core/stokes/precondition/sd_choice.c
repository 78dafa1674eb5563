#include "sd_choice.h"

#include <math.h>

/* Solves of which means are taken, and after which a ratio counts as measured. */
static const double TRIAL = 8.0;
/* Of iterations: a change for less is not worth it. */
static const double HARDLY = 3.0;

static sd_sparse_size size_of(const sd_rows *rows)
{
  sd_sparse_size size = {0.0, 0.0, 0.0};
  for (int k = 0; k < rows->columns; k++) {
    const double m = (double) (rows->first[k + 1] - rows->first[k]);
    size.blocks += m;
    size.squares += m * m;
    size.cubes += m * m * m;
  }
  return size;
}

sd_sparse_size sd_sparse_sized(const sd_sparse *f)
{
  return size_of(&f->rows);
}

sd_status sd_sparse_count(const sd_spheres *s, int n, double rho, int part, int parts,
                          sd_sparse_size *size)
{
  *size = (sd_sparse_size){0.0, 0.0, 0.0};
  sd_rows rows = {0};
  const sd_status status = sd_rows_find(&rows, s, n, rho, part, parts);
  if (status == SD_OK) *size = size_of(&rows);
  sd_rows_free(&rows);
  return status;
}

/* Measured: 0.75 ns a pair, with torques 1.85 ns; the rest of an iteration goes by spheres. */
static double iteration(double n, int width)
{
  return width == 3 ? 0.75 * n * n + 90.0 * n : 1.85 * n * n + 150.0 * n;
}

sd_costs sd_costs_sparse(int n, int width, const sd_sparse_size *z)
{
  sd_costs k = {.without = iteration(n, width), .ratio = 0.25};
  if (width == 3) {
    k.with = k.without + 3.1 * z->blocks + 40.0 * n;
    k.set_up = 4000.0 * n + 80.0 * z->blocks + 22.0 * z->squares + 0.053 * z->cubes;
  } else {
    k.with = k.without + 15.5 * z->blocks + 80.0 * n;
    k.set_up = 4000.0 * n + 200.0 * z->blocks + 80.0 * z->squares + 0.61 * z->cubes;
  }
  return k;
}

sd_costs sd_costs_blocks(int n, int width, int blocks, const long *first, int kept)
{
  sd_costs k = {.without = iteration(n, width), .ratio = 0.15};
  double make = 0.0;
  k.with = k.without + (width == 3 ? 80.0 : 120.0) * n;
  for (int b = 0; b < blocks; b++) {
    const double size = width * (double) (first[b + 1] - first[b]);
    make += (9.0 + 0.025 * size) * size * size;
    k.with += 0.2 * size * size;
  }
  k.every = 150.0 * blocks * fmin(blocks, 80.0) + (kept ? 0.0 : make);
  k.set_up = kept ? make : 0.0;
  return k;
}

/* Measured: 2.2 ns a pair, with torques 4.1 ns. */
sd_costs sd_costs_by_list(int n, double pairs, int width, int blocks, const long *first,
                          const double *share, int whole)
{
  sd_costs k = {.ratio = whole ? 0.05 : 0.4};
  k.without = width == 3 ? 2.2 * pairs + 90.0 * n : 4.1 * pairs + 150.0 * n;
  k.with = k.without + (width == 3 ? 80.0 : 120.0) * n;
  for (int b = 0; b < blocks; b++) {
    const double size = width * (double) (first[b + 1] - first[b]);
    k.with += share[b] * 0.2 * size * size;
    k.every += share[b] * (9.0 + 0.025 * size) * size * size;
  }
  return k;
}

static double cost_without(const sd_costs *k, double iterations)
{
  return iterations * k->without;
}

static double cost_with(const sd_costs *k, double iterations)
{
  return iterations > 0.0 ? iterations * k->with + k->every : 0.0;
}

/* Iterations with, from those without: one at least. */
static double fewer(double iterations, double ratio)
{
  return iterations > 0.0 ? fmax(1.0, ratio * iterations) : 0.0;
}

void sd_choice_begin(sd_choice *c, const sd_costs *k, double tolerance)
{
  /* Scenes that are worth it take 7 iterations a digit or more. */
  const double expected = 7.0 * fmax(0.0, -log10(tolerance));
  *c = (sd_choice){.begun = 1.0, .ratio = k->ratio};
  c->with = k->set_up + cost_with(k, fewer(expected, k->ratio)) < cost_without(k, expected);
}

void sd_choice_learn(sd_choice *c, const sd_costs *k, int iterations, int made)
{
  c->solves++;
  c->iterations += (iterations - c->iterations) / fmin(c->solves, 2.0 * TRIAL);
  if (c->solves == TRIAL && c->other > 0.0 && c->iterations > 0.0) {
    const double ratio = c->with ? c->iterations / c->other : c->other / c->iterations;
    c->ratio = fmin(fmax(ratio, 0.02), 1.0);
  }
  if (c->with) {
    c->gain += cost_with(k, iterations) - cost_without(k, iterations / c->ratio);
    if (made) c->gain += k->set_up;
    c->gain = fmax(c->gain, -k->set_up); /* what it has earned pays for the next one */
  } else
    c->gain = fmax(
        0.0, c->gain + cost_without(k, iterations) - cost_with(k, fewer(iterations, c->ratio)));
  if (c->gain < HARDLY * k->without + (c->with ? 0.5 : 1.0) * k->set_up) return;
  c->other = c->iterations;
  c->with = !c->with;
  c->solves = c->iterations = c->gain = 0.0;
}

int sd_wear_learn(sd_wear *w, const sd_costs *k, int iterations)
{
  w->solves++;
  if (w->solves <= TRIAL)
    w->fresh += (iterations - w->fresh) / w->solves;
  else
    w->excess = fmax(0.0, w->excess + iterations - w->fresh);
  return w->excess * k->with > k->set_up;
}
