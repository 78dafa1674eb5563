/* u = Omega F for spheres where they stand: the pair part of the mobility, whatever sums it.
 *
 * An engine is a table of functions. A new one is a file in this folder that defines the table, and
 * its declaration here.
 * Whoever uses an engine knows it by this header alone: solvers, preconditioners, bodies. The
 * caller never asks which engine it has; it asks the table what the engine needs.
 *
 * The core knows no ranks. This rank has n spheres, whose rows go in as F and come out as u; what
 * an engine must know of others it asks of its caller, through sd_world. */
#ifndef SD_MOBILITY_H
#define SD_MOBILITY_H

#include <stddef.h>

#include "sd_ewald_levels.h"
#include "sd_product.h"
#include "sd_random.h"
#include "sd_slab.h"
#include "sd_status.h"
#include "sd_world.h"

SD_BEGIN_C

/* Which spheres an engine sees:
 *   LIST   this rank's n, then the ghosts around them; pairs within the engine's reach, one row for
 *          each of the n
 *   NEAR   this rank's n, then the ghosts around them, periodic images of its own among them; the
 *          engine finds the pairs itself
 *   ALL    those of all ranks in one order, the same on every rank; no ghosts, no pairs */
typedef enum { SD_VIEW_LIST, SD_VIEW_NEAR, SD_VIEW_ALL } sd_view;

/* How the spheres interact: what is known before they are placed. law.range: of the taper. width 3
 * or 6 as in sd_product.h. ewald, slab: of the engines that split the sum, which have no other law than
 * RPY without taper, and walls of their own; second: of that with two levels. tolerance: error of a product
 * of all pairs that does no harm, over the rms of F/(6 pi eta a); from SD_PRODUCT_SINGLE on it may be of
 * floats. 0: none */
typedef struct {
  sd_law law;
  int width;
  const sd_ewald *ewald;
  const sd_ewald_level *second;
  const sd_slab *slab;
  double tolerance;
} sd_mobility_how;

/* The spheres of one solve. All that it points to outlives the solve, but for the groups, which view NEAR
 * may make use of: of n_all spheres, and none has both some of the n and ghosts; and for spheres.x where the
 * engine reads that once. */
typedef struct {
  sd_mobility_how how;
  int n, n_all;
  sd_spheres spheres;
  sd_groups groups;
  const sd_pairs *pairs;
  /* view NEAR. 1: of a pair across a border one side alone has the other sphere as a ghost, and sends what
   * this ghost feels to its rank by world.reduce; only Ewald sums of one level without walls can. 0: each
   * side has the other's */
  int one_sided;
  sd_world world;
} sd_mobility_scene;

typedef struct {
  /* as error messages call it */
  const char *name;
  /* bytes of its own struct, zero before the first place */
  size_t state;
  sd_view view;
  /* does it read where spheres stand in place() alone, and no more in products? */
  int reads_places_once;
  /* the spheres have moved: once before the products of a solve. SD_OK, SD_ENOMEMORY or what a
   * function of sd_world said */
  sd_status (*place)(void *state, const sd_mobility_scene *scene);
  /* F [width n] -> u [width n]. A sphere without radius gets 0 and its F is not read. SD_OK or as
   * place */
  sd_status (*apply)(void *state, const double *F, double *u);
  void (*free)(void *state);
  /* For random numbers of covariance M: is M, as it stands, a sum of two positive matrices, one of
   * which needs no products? Then apply_rest is apply of the other one, and draw gives u [width n] of
   * the covariance of the first, which depends on the key alone. NULL, all three: it never is */
  int (*divides)(const void *state);
  sd_status (*apply_rest)(void *state, const double *F, double *u);
  sd_status (*draw)(void *state, const sd_random_key *key, double *u);
} sd_mobility_engine;

/* Every sphere of all ranks with every other: cost n_all^2 / ranks, nothing depends on how the
 * spheres are dealt to the ranks. */
extern const sd_mobility_engine sd_mobility_all_pairs;
/* The pairs that the caller lists: within a cut-off, or of one clump. */
extern const sd_mobility_engine sd_mobility_list;
/* Every sphere with every other and with all periodic images, in a periodic or an open box, by FFT:
 * cost about n. how.ewald is its splitting, the same on every rank; place() makes its tables anew
 * when that has changed, and otherwise only reads positions; SD_ENOTFINITE on all ranks if a sphere
 * is nowhere, or outside of an open box. */
extern const sd_mobility_engine sd_mobility_ewald;
/* The same where few spheres are far larger than the rest (sd_ewald_levels.h): it holds the one
 * above for the small spheres, and adds what the large ones do and feel. how.second: its second
 * level. */
extern const sd_mobility_engine sd_mobility_levels;
/* The same in a box that is periodic in two directions, above a floor, in a slit or with nothing beyond:
 * how.slab, width 3; SD_ENOTFINITE on all ranks if a sphere is nowhere, or at a height that how.slab has no
 * room for. */
extern const sd_mobility_engine sd_mobility_slab;

/* An engine with its state. Zero-initialise; sd_mobility_free in the end. */
typedef struct {
  const sd_mobility_engine *engine;
  void *state;
} sd_mobility;

/* The same engine as before keeps its memory. SD_OK or SD_ENOMEMORY, or as place. */
sd_status sd_mobility_place(sd_mobility *m, const sd_mobility_engine *engine,
                            const sd_mobility_scene *scene);

/* In the solver's signature sd_apply: ctx is an sd_mobility. */
sd_status sd_mobility_apply(void *ctx, const double *F, double *u);

/* As said of the engine; the last two only where it divides. ctx is an sd_mobility. */
int sd_mobility_divides(const sd_mobility *m);
sd_status sd_mobility_apply_rest(void *ctx, const double *F, double *u);
sd_status sd_mobility_draw(sd_mobility *m, const sd_random_key *key, double *u);

void sd_mobility_free(sd_mobility *m);

SD_END_C
#endif
