/* Parts of the rule of sd_ewald.h that a sum of two levels and the flow at points are made of. */
#ifndef SD_EWALD_RULE_INTERNAL_H
#define SD_EWALD_RULE_INTERNAL_H

#include "sd_ewald_chosen.h"
#include "sd_ewald_sizes.h"
#include "sd_status.h"

/* Waves that fall as a Gaussian, for the spheres s; width as in sd_ewald_choose, tolerance within
 * its limits. SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_gaussian(const sd_ewald_box *box, const sd_ewald_class *s, int width,
                            double tolerance, sd_ewald *out);

/* The same where xi is not chosen: it is `times` over the largest radius, or less where two of the
 * largest that overlap would be beyond the range. */
sd_status sd_ewald_gaussian_at(const sd_ewald_box *box, const sd_ewald_class *s, int width,
                               double times, double tolerance, sd_ewald *out);

/* Everything but the splitting, of a box and spheres that may not be sound; *some: are there spheres to
 * split for? SD_OK or SD_ENOTFINITE */
sd_status sd_ewald_prepare(const sd_ewald_box *box, const sd_ewald_class *all, double tolerance,
                           sd_ewald *out, int *some);

/* A grid whose spacing is at most h; an open box has room for the windows of spheres at its faces, and the
 * grid around it is twice as large. SD_OK or SD_ENOMEMORY */
sd_status sd_ewald_lay_grid(const sd_ewald_box *box, double h, int points, double *spacing, int *grid);

/* Rounded, so that ranks whose sums differ in the last bits have the same number, but for the rare one that
 * lies on the border; the caller hands out sums that are equal anyway. */
double sd_ewald_six_digits(double value);

#endif
