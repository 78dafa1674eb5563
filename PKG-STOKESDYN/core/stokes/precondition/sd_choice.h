/* Does a preconditioner pay? Counted in products of the mobility matrix, an iteration without a
 * preconditioner being one, and decided as whoever rents skis decides when to buy them: go on until
 * what would have been saved has paid for the change. No clock is read, so that every machine, any
 * number of ranks and a restarted run choose alike.
 *
 * Where solves stay as they are, no run pays more than twice what the better way would have cost
 * from the start, and one set-up; a long one goes the better way. */
#ifndef SD_CHOICE_H
#define SD_CHOICE_H

#include "sd_ewald.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a preconditioner costs, in products */
typedef struct {
  /* of an iteration with it, > 1 */
  double iteration;
  /* of a set-up that many solves share */
  double make;
  /* of each solve that iterates */
  double solve;
} sd_cost;

/* The sparse factor of n spheres that all see one another. width: 3, with rotation 6 */
sd_cost sd_cost_sparse(double n, int width);

/* Blocks of `clumps` clumps of m spheres, `stored` the sum of m^2: coupled ones in such a cloud. */
sd_cost sd_cost_blocks(double n, int width, double clumps, double stored);

/* The same by list, of `pairs` pairs, made anew in every solve and not coupled. */
sd_cost sd_cost_blocks_by_list(double n, int width, double pairs, double stored);

/* The long waves of a periodic box (sd_waves.h) beside the product that e splits, for its e->count
 * spheres; stored: sum of m^2 of the clumps whose blocks go with them, or 0. Who cannot keep the
 * waves from solve to solve moves `make` into `solve`. */
sd_cost sd_cost_waves(const sd_ewald *e, int width, double stored);

typedef enum { SD_WITHOUT, SD_WITH, SD_WITH_FOR_GOOD } sd_way;

/* Numbers only, the caller's to save: the same numbers go on alike. */
typedef struct {
  /* the next solve is without a preconditioner, with it, with it whatever it costs: sd_way */
  double with;
  /* Products beyond those of the better way, as far as it is known, since the last change */
  double spent;
  /* since the last change, solves and mean cost: of the first ones with, of the last ones
   * without */
  double solves, mean;
  /* that of the other way when it was left, until this one's is known well enough for the ratio */
  double other;
  /* cost of a solve with over that without; 0: not yet measured */
  double ratio;
} sd_choice;

/* Would a solve of so many unknowns that begins from zero pay for a set-up of its own? */
int sd_choice_at_once(const sd_cost *k, double tolerance, double unknowns);

/* After a solve. Returns 1 if the preconditioner, which stays, is worn: to be made anew. */
int sd_choice_learn(sd_choice *c, const sd_cost *k, int iterations);

/* What had been made is lost, as spheres have come or gone: is it worth another set-up? If not, c
 * goes on without. */
void sd_choice_lost(sd_choice *c, const sd_cost *k);

#ifdef __cplusplus
}
#endif
#endif
