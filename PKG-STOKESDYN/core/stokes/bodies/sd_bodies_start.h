/* Where the loop of sd_bodies.h begins: x, r of it, what bodies would spend alone, and how exact the first
 * z needs to be. */
#ifndef SD_BODIES_START_H
#define SD_BODIES_START_H

#include "sd_bodies_loop.h"

SD_BEGIN_C

/* From x = pre(-u, F); from the guess in x, with a tie (l, V). One product. SD_OK or what pre or the product
 * said. */
sd_status sd_bodies_start_cold(sd_bodies_loop *c);
sd_status sd_bodies_start_warm(sd_bodies_loop *c, const double *v_with_l);

SD_END_C
#endif
