/* The mean resistance of two shells of points over how they stand to each other, for the tables of
 * sd_film_table_internal.h. A failure ends the program. */
#ifndef SD_SHELL_PAIR_H
#define SD_SHELL_PAIR_H

#include "sd_film_table_internal.h"
#include "sd_shell_ways.h"

/* Of radius 1: points r [3n] from the centre, their radius, and the constants of the one-body addition
 * (sd_multiblob.h, sd_multiblob_half.h). The owner frees r. */
typedef struct {
  int n;
  double *r, point;
  double alpha, beta, delta, strain, rotation;
} sd_shell_blob;

/* Of free spheres that are all alike, 12 or 42 points, in their orientation */
sd_shell_blob sd_shell_blob_alike(int n);
/* 12 points, or a half shell of 42, 162 or 642, mirror planes as sd_shell_ways_of_icosahedra has them */
sd_shell_blob sd_shell_blob_by_radius(int n);

/* Modes of a sphere in units of its radius, in this order: velocity 3, g_k V of sd_multiblob.h 3, radius times
 * angular velocity 3, radius times strain 5: 1/sqrt 2 in xy = yx, xz, yz and xx = -yy, (-1 -1 2)/sqrt 6 */
enum { SD_SHELL_TURN = 6, SD_SHELL_STRAIN = 9, SD_SHELL_MODES = 14, SD_SHELL_BOTH = 2 * SD_SHELL_MODES };

typedef struct sd_shell_pair sd_shell_pair;

/* Sphere 1, the smaller one, and 2, which outlive it */
sd_shell_pair *sd_shell_pair_create(const sd_shell_blob *one, const sd_shell_blob *two);
void sd_shell_pair_free(sd_shell_pair *p);

/* Radii 1/ratio and 1, the gap xi mean radii: the resistance G of the modes of both in one way, with the
 * addition, in the axes of shell 2 */
void sd_shell_pair_resistance(sd_shell_pair *p, double ratio, double xi, const sd_shell_way *way,
                              double G[SD_SHELL_BOTH * SD_SHELL_BOTH]);

/* ... the means over ways [count] of the points alone, and with the
 * addition, without the resistance of two spheres of the Rotne-Prager-Yamakawa model, as films (sd_film.h)
 * over sd_film_scales. */
void sd_shell_pair_means(sd_shell_pair *p, double ratio, double xi, int count, const sd_shell_way *ways,
                         double value[2][SD_FILM_SCALARS]);

#endif
