/* Does a preconditioner pay? Decided from operations, counted and weighed with times measured once, and from the iterations that
 * solves have taken: no clock is read, so that every machine, any number of ranks and a restarted run choose alike.
 *
 * Each solve adds to the gain what it would have cost less the other way; when the gain reaches what changing over costs, the
 * next solve goes the other way. So no run pays more than about twice what the better way would have cost from the start, and a
 * long one goes the cheaper way. The iterations of the way not taken are those of the other times a ratio, at first a guess, and
 * measured as soon as both ways have been gone. */
#ifndef SD_CHOICE_H
#define SD_CHOICE_H

#include "sd_sparse.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Costs in ns of one core of a processor with AVX-512 (bench_core; only their ratios matter). */
typedef struct {
  double without; /* of an iteration */
  double with;    /* of an iteration with the preconditioner */
  double set_up;  /* of what is kept over many solves */
  double every;   /* of what is made anew in every solve that iterates */
  double ratio;   /* guess: iterations with over those without */
} sd_costs;

/* Operations that making a sparse factor takes: sums over its columns of blocks of m, m^2, m^3. */
typedef struct {
  double blocks, squares, cubes;
} sd_sparse_size;

/* Of the columns of one part, to be summed over the parts. SD_OK; SD_ENOMEMORY. */
sd_status sd_sparse_count(const sd_spheres *s, int n, double rho, int part, int parts,
                          sd_sparse_size *size);

/* The same of a factor that is there. */
sd_sparse_size sd_sparse_sized(const sd_sparse *f);

/* Of n spheres that all see one another; width 3, with rotation 6. */
sd_costs sd_costs_sparse(int n, int width, const sd_sparse_size *size);
/* Coupled blocks of the clumps first[k] ... first[k+1] - 1. kept: blocks outlive a solve. */
sd_costs sd_costs_blocks(int n, int width, int blocks, const long *first, int kept);

/* Blocks by list, not coupled and made anew in every solve that iterates: this rank's part of the costs, to be summed. pairs: of this
 * rank's n spheres. first: of the blocks that it has; share: how much of each it counts, one over all ranks. whole: are clumps whole? */
sd_costs sd_costs_by_list(int n, double pairs, int width, int blocks, const long *first,
                          const double *share, int whole);

/* Numbers only, the caller's to save: the same numbers go on alike. */
typedef struct {
  double begun;      /* 0: not yet */
  double with;       /* 1: the next solve takes the preconditioner */
  double solves;     /* this way */
  double iterations; /* mean of the latest of them */
  double other;      /* the same of the other way, when it was left; 0: never gone */
  double ratio;
  double gain;
} sd_choice;

/* Before the first solve, which is to reduce the residual by `tolerance` from zero. */
void sd_choice_begin(sd_choice *c, const sd_costs *k, double tolerance);
/* After a solve; costs as they are now. made: a set-up was paid for it that was not the first. */
void sd_choice_learn(sd_choice *c, const sd_costs *k, int iterations, int made);

/* When is a kept factor to be made anew? When the iterations more than in its first solves have cost as much as it does. */
typedef struct {
  double solves; /* with this factor */
  double fresh;  /* mean iterations of the first of them */
  double excess; /* iterations more than that */
} sd_wear;

/* After a solve with the factor: 1 if it is worn. */
int sd_wear_learn(sd_wear *w, const sd_costs *k, int iterations);

#ifdef __cplusplus
}
#endif
#endif
