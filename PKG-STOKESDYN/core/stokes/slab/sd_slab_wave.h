/* What a slab is for one wave number k > 0 along it, in closed form: windows that fall
 * exponentially across it, the walls' answer to a flow, and what filtered images lack near a
 * wall.
 *
 * Directions: l along k, t along the slab and across k, z across the slab. With z~ = i z (u_z~ =
 * i u_z, f_z~ = i f_z) all coefficients are real; t goes alone.
 *
 * A force on plane z' drives on plane z, y = k |z - z'|, s = sign(z - z'), viscosity 1:
 *   e^-y/(4k) [[1 - y, -s y], [s y, 1 + y]] on (l, z~),   e^-y/(2k) on t                       (1)
 * and with the image in one wall at z = 0 also, c = k z, x = k z'; of spheres, and through windows, each is
 * longer by `shift` (below),
 *   -e^-(c + x)/(4k) [[1 - c - x + 2 c x, x - c - 2 c x], [c - x - 2 c x, 1 + c + x + 2 c x]],
 *   -e^-(c + x)/(2k) on t, the exponents without shift                                             (2)
 * Source: own derivation; test_slab_tables has numbers of an independent code. */
#ifndef SD_SLAB_WAVE_H
#define SD_SLAB_WAVE_H

#include "sd_slab.h"

SD_BEGIN_C

/* --- windows --- */

/* Of a window across the slab, at the imaginary wave number i k: W, so that the sum over its
 * planes of e^-kz/W is e^-kz of its middle, and -k W'(k)/W - a_ref^2 k^2/3, which goes with k z */
typedef struct {
  double W, shift;
} sd_slab_window;

sd_slab_window sd_slab_window_at(const sd_slab *slab, double k);

/* --- two walls --- */

/* Forces on the walls that stop a flow u on them, in order (l, z~) of the lower one, (l, z~) of
 * the upper one: Q u times 4k, t: T u times 2k,
 *   Q = half of [even on (u_l + u'_l, u_z - u'_z)] and [odd on (u_l - u'_l, u_z + u'_z)],
 *   even = [[1 - E(1 + K), E K], [E K, 1 + E(1 - K)]]/(1 - E^2 - 2 K E),
 *   odd = [[1 + E(1 + K), -E K], [-E K, 1 - E(1 - K)]]/(1 - E^2 + 2 K E),
 *   T = [[1, -E], [-E, 1]]/(1 - E^2),      K = k H,   E = e^-K
 * even, odd [3]: 11, 12, 22. To 1e-10 for K above 0.05; below, wide slits lose digits in what is
 * multiplied with them. */
typedef struct {
  double even[3], odd[3], E, t;
} sd_slab_stops;

sd_slab_stops sd_slab_stops_at(double k, double height);

/* --- the corner at a wall --- */

/* Images that the near part takes filtered (sd_image_wave.h) less the unfiltered ones that
 * columns make: for planes at heights z, z' above that wall, Z = z + z',
 *   entry = alpha(Z) + z z' beta(Z) + (z - z') zeta(Z)
 * of ll, lz~ = (z~l of the transposed), z~z~ and tt, in this order. ends at Z = the range of
 * images and, with a taper, as many planes on as windows have points: cut sharply there it would
 * be in error. */
enum {
  SD_CORNER_LL,
  SD_CORNER_LZ,
  SD_CORNER_ZZ,
  SD_CORNER_T,
  SD_CORNER_ZZ_LL,
  SD_CORNER_ZZ_LZ,
  SD_CORNER_ZZ_ZZ,
  SD_CORNER_DIFFERENCE,
  SD_CORNERS
};

/* Sums over waves across the slab, which have a period, long enough for it not to matter. Zero-
 * initialise; sd_slab_corner_free in the end. */
typedef struct {
  const sd_slab *slab;
  /* values of Z: 2 first + m spacing; waves q > 0 across, and the period */
  int sums, waves;
  double period;
  /* [waves + 1] q, 1/w^2 over the period, gamma of sd_image_kernel.h; [sums] taper; [sums][waves
   * + 1] cos and sin of q Z; [4 (waves + 1)] at work */
  double *q, *window, *gamma, *taper, *cosine, *sine, *work;
} sd_slab_corner;

/* SD_OK or SD_ENOMEMORY. slab outlives it. */
sd_status sd_slab_corner_create(sd_slab_corner *c, const sd_slab *slab);
/* value [sums][stride]: SD_CORNERS numbers, `stride / SD_CORNERS` apart */
void sd_slab_corner_at(sd_slab_corner *c, double k, double *value, long stride);
/* k = 0: alpha of the directions along the wall; alpha, beta across it: [sums] each */
void sd_slab_corner_of_mean(sd_slab_corner *c, double *along, double *across, double *beta);
void sd_slab_corner_free(sd_slab_corner *c);

SD_END_C
#endif
