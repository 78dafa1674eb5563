/* Bodies of fluid, drops or the water of a tank: particles that are nearer than 2 h to each other are in
 * one. A drop that touches nothing must keep its momentum, while the sum of the forces of surface tension on
 * it is 0 only to some thousandths of the sum of their sizes. The same acceleration of the whole drop takes
 * that away; in the frame of the drop it changes nothing. */
#ifndef SD_SPH_DROPS_H
#define SD_SPH_DROPS_H

#include "sd_cells.h"
#include "sd_sph_tension.h"

SD_BEGIN_C

/* parent [all]: each particle, also those that are only neighbours, becomes part of the tree of its drop. Of
 * f nothing but surface, x4 and wall is read. cells: created for `all` points or more. */
void sd_sph_find_drops(const sd_sph_film *f, sd_cells *cells, int *parent);

/* One round of the names of drops on several ranks: the smallest name [all] of the particles of a tree here
 * becomes that of all of them; before the first each particle has a name of its own. Returns whether one has
 * changed: then names of ghosts are asked for, and the next round follows. */
int sd_sph_name_drops(int all, int *parent, double *name);

/* A drop, or the part of it on one rank: its name, the sums of forces and masses, and 1 where it touches what
 * takes its forces */
typedef struct {
  double name, F[3], mass, held;
} sd_sph_drop;

/* The trees among the particles below list->n that are fluid: out, at most list->n; returns their number.
 * place [all]: of the root of each tree. mass [list->n], held [list->n] 0 or 1, F [3 list->n]. */
int sd_sph_sum_drops(const sd_sph_film *f, int *parent, const double *name, const double *mass,
                     const double *held, const double *F, sd_sph_drop *out, int *place);

/* Takes from F [3 list->n] what the drops have too much. mine [count]: of sd_sph_sum_drops; everywhere
 * [all_count]: those of all ranks, which are sorted and added up by name. Returns the number of drops; of all
 * of them, sum [3]: the force that is left, on those that are held. */
int sd_sph_keep_momentum(const sd_sph_film *f, int *parent, const int *place, const double *mass, int count,
                         sd_sph_drop *mine, int all_count, sd_sph_drop *everywhere, double *F, double sum[3]);

SD_END_C
#endif
