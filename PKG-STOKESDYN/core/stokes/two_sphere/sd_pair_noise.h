/* Random forces and torques of two spheres whose covariance is a resistance of the pair
 * (sd_pair_resistance.h), in closed form: it falls into forces along d (2x2), torques along d (2x2) and,
 * across d, forces along e with torques along e x d (4x4), the same for both directions e. */
#ifndef SD_PAIR_NOISE_H
#define SD_PAIR_NOISE_H

#include "sd_pair_resistance.h"
#include "sd_status.h"

/* F [12] += forces and torques on the first sphere, then on the second, of covariance R from standard
 * normal numbers g [12], four vectors in space: only d and these say what comes out, no choice of axes
 * across d, and no unit of length. length: of the pair, such as its mean radius, over which torques are
 * comparable to forces. SD_OK; SD_EINDEFINITE: an eigenvalue below -1e-6 of the largest number of the
 * pair; what is above is rounding and counts as 0. */
sd_status sd_pair_noise(const sd_pair_resistance *R, const double d[3], double length,
                        const double g[12], double F[12]);

#endif
