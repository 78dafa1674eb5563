/* Do the particles of a scene fill space, and are its walls as thick as the kernel? Asked once a run, so the
 * loops are plain. Notation of sd_sph_pair.h. */
#ifndef SD_SPH_FILLING_H
#define SD_SPH_FILLING_H

#include "sd_sph_pair.h"

SD_BEGIN_C

/* Adds to the rows of sums [4 (n+1)], over the neighbours of each particle but itself,
 *   0-2 sum V_b g d   3 sum V_b W
 * x4 holds volumes as sd_sph_pack_volumes makes them. */
void sd_sph_surroundings(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                         double *sums);

/* The part of space that is filled around particle i, sum V W with itself: 1 if V is the room that a particle
 * has. 0 if, by its rows of these sums and of sd_sph_moments, it is at a surface, which tells nothing: h |sum
 * V g d| above a fifth of sum V W, or an eigenvalue of M below 0.7 of their mean. */
double sd_sph_filled(const sd_sph_model *model, const sd_sph_particles *p, int i, const double sums[4],
                     const double M[6]);

/* Adds to the rows of particles f that are none of a wall, rows [4 (n+1)], sum W (x_w - x_f) over the
 * particles w of walls (phase < 0): where the wall is. */
void sd_sph_toward_walls(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                         double *rows);

/* How far the wall reaches in that direction: column 3 is taken as maximum with (x_w - x_f).n over the same
 * particles, n along columns 0-2. A wall that is thick enough reaches to the end of the support, 2 h, less a
 * spacing. */
void sd_sph_reach_of_walls(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                           double *rows);

/* Does a wall that reaches so far from particle i end within its support? The next row would be a spacing
 * further, and half of one is left for rows that are no lattice. */
int sd_sph_sees_past(const sd_sph_model *model, const sd_sph_particles *p, int i, double reach);

SD_END_C
#endif
