/* The inverse of a matrix of points that three mirror planes leave as it is: in eight blocks, of an eighth
 * of the numbers and of the time of a product.
 *
 * Points s x have mirror images for all signs s = (+-1, +-1, +-1), as those of sd_shell.h do, and M commutes
 * with the mirrors. A field of forces of the parity chi, (+-1, +-1, +-1), is
 *
 *   F_c(s x) = chi(s) s_c f_c / sqrt(images of x),    chi(s): product of chi_d over the s_d = -1
 *
 * with f at one point of each set of images, and M takes it to one of the same parity. A component that a
 * mirror through its own point changes the sign of is 0. */
#ifndef SD_MIRRORED_H
#define SD_MIRRORED_H

#include "sd_extern_c.h"
#include "sd_status.h"

SD_BEGIN_C

typedef struct {
  /* points; sets of images */
  int m, sets;
  /* [9] axes of the mirrors, in columns */
  double axes[9];
  /* [8 sets] point of each set by signs, bit d: s_d = -1; the same point again where a mirror goes through
   * it. [sets] different ones among these */
  int *image, *images;
  /* of each parity: unknowns, and [size] which these are, 3 set + c; all of them one after the other */
  int size[8], *unknown;
  /* the blocks of M^-1, one after the other */
  double *inverse;
} sd_mirrored;

/* Of the matrix M [(3 m)^2] of points x [3 m]. The owner frees. SD_OK; SD_ENOMEMORY; SD_EOUTSIDE: these are
 * no mirror images; SD_ESINGULAR. */
sd_status sd_mirrored_create(int m, const double *x, const double axes[9], const double *M,
                             sd_mirrored *out);
/* z [3 m] = M^-1 y, m at most 642; no aliasing */
void sd_mirrored_apply(const sd_mirrored *s, const double *y, double *z);
void sd_mirrored_free(sd_mirrored *s);

SD_END_C
#endif
