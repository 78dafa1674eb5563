/* Parts of the rule of sd_ewald.h that a sum of two levels is made of. */
#ifndef SD_EWALD_RULE_INTERNAL_H
#define SD_EWALD_RULE_INTERNAL_H

#include "sd_ewald.h"

/* Waves that fall as a Gaussian, for the spheres s; width as in sd_ewald_choose, tolerance within
 * its limits. SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_gaussian(const sd_ewald_box *box, const sd_ewald_class *s, int width,
                            double tolerance, sd_ewald *out);

/* The same where xi is not chosen: it is `times` over the largest radius, or less where two of the
 * largest that overlap would be beyond the range. */
sd_status sd_ewald_gaussian_at(const sd_ewald_box *box, const sd_ewald_class *s, int width,
                               double times, double tolerance, sd_ewald *out);

void sd_ewald_add_class(sd_ewald_class *sum, const sd_ewald_class *s);

#endif
