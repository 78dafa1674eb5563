/* Transforms, in place, of a box of real numbers that are even or odd about both ends of each direction. Of
 * the n numbers x of a line, half a period of 2 (n - 1):
 *   even   y[k] = x[0] + (-1)^k x[n-1] + 2 sum_{0<j<n-1} x[j] cos(pi j k/(n - 1))
 *   odd    y[k] = 2 sum_{0<j<n-1} x[j] sin(pi j k/(n - 1)); both ends are left as they are
 * Done twice, each is 2 (n - 1) times what was there.
 * Two lines are the real and the imaginary part of a complex one of a whole period, and several of these go
 * together in vectors. That has twice the multiplications of FFTW's own transforms of these kinds, which go
 * line by line, and takes 0.4 to 0.7 of their time. */
#ifndef SD_PADDED_LINES_H
#define SD_PADDED_LINES_H

typedef struct sd_padded_lines sd_padded_lines;

/* For lines of n > 2 numbers; NULL: there is no memory */
sd_padded_lines *sd_padded_lines_create(int n);
void sd_padded_lines_free(sd_padded_lines *t);

/* Of a box of size [3], z fastest, all whole lines along d that are from `from` to before `end` [3] in the
 * other two directions. size [d] is the n of `t`. */
void sd_padded_lines_apply(const sd_padded_lines *t, int odd, int d, const int *size, const int *from,
                           const int *end, double *field);

#endif
