/* Random forces of films: their covariance is L of sd_lubrication.h, exactly, since each pair has
 * its own and L is the sum over pairs (sd_pair_resistance.h), and each sphere that of what it resists
 * alone. */
#ifndef SD_LUBRICATION_NOISE_H
#define SD_LUBRICATION_NOISE_H

#include "sd_lubrication.h"

SD_BEGIN_C

/* Twelve standard normal numbers g of the pair of sphere i < n and what stands at `at` < n_all, the
 * same from wherever the pair is seen; `at` = i: what sphere i resists alone. The pair must be the
 * same pair from both of its ends: returned is whether i is its first sphere. */
typedef int sd_lubrication_normals(void *ctx, int i, int at, double g[12]);

/* F [6 n] += forces and torques on the spheres. L has been placed in a noisy scene, and has a
 * periodic image of sphere i on both of its sides, one of which is the first. SD_OK;
 * SD_EINDEFINITE: as of sd_pair_noise. */
sd_status sd_lubrication_noise(const sd_lubrication *L, sd_lubrication_normals *normals, void *ctx,
                               double *F);

SD_END_C
#endif
