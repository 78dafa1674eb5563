/* Bodies of fluid, drops or the water of a tank: particles that are nearer than 2 h to each other are in
 * one. A drop that touches nothing must keep its momentum, while the sum of the forces of surface tension on
 * it is 0 only to some thousandths of the sum of their sizes. The same acceleration of the whole drop takes
 * that away; in the frame of the drop it changes nothing. */
#ifndef SD_SPH_DROPS_H
#define SD_SPH_DROPS_H

#include "sd_cells.h"
#include "sd_sph_tension.h"

SD_BEGIN_C

/* parent [all]: each particle, also those that are only neighbours, becomes part of the tree of its drop:
 * particles nearer to each other than reach are in one. Returns how many trees there are. Of f nothing but
 * surface, x4 and wall is read. cells: created for `all` points or more.
 * Trees of a smaller reach are parts of those of a larger one. So if there are as many with 2 h - a and
 * 2 h + a, they are the same, and stay so while no distance changes by a. */
int sd_sph_find_drops(const sd_sph_film *f, double reach, sd_cells *cells, int *parent);

/* One round of the names of drops on several ranks: the smallest name [all] of the particles of a tree here
 * becomes that of all of them; before the first each particle has a name of its own. Returns whether one has
 * changed: then names of ghosts are asked for, and the next round follows. */
int sd_sph_name_drops(int all, int *parent, double *name);

/* A drop, or the part of it on one rank: its name, volume, the sum of forces, and 1 where it touches what
 * takes its forces */
typedef struct {
  double name, V, F[3], held;
} sd_sph_drop;

/* The trees among the particles below list->n that are fluid: out, at most list->n, with names and volumes;
 * returns their number. of [all]: of each such particle the place of its drop, -1 of walls and others. */
int sd_sph_list_drops(const sd_sph_film *f, int *parent, const double *name, int *of, sd_sph_drop *out);

/* Their forces, of F [3 n], which is 0 of those that are deep, and whether one of their particles is held
 * [n]; NULL: nobody is. */
void sd_sph_sum_drops(const sd_sph_film *f, const int *of, const char *held, const double *F, int count,
                      sd_sph_drop *drops);

/* Of the parts of drops of all ranks: sorts them and adds them up by name; returns the number of drops. sum
 * [3]: the force on those that are held, which keep it. */
int sd_sph_join_drops(int parts, sd_sph_drop *drops, double sum[3]);

/* mine [here]: of sd_sph_sum_drops. F of each becomes the force per volume that the whole drop among drops
 * [count] has too much: all of it, or 0 where it is held. */
void sd_sph_find_excess(int count, const sd_sph_drop *drops, int here, sd_sph_drop *mine);

/* Takes that from F [3 list->n]: the same acceleration for all, since V is m over one density. */
void sd_sph_keep_momentum(const sd_sph_film *f, const int *of, const sd_sph_drop *excess, double *F);

SD_END_C
#endif
