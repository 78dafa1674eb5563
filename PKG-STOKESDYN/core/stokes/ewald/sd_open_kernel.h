/* The wave part of a pair in open space, I_0 1 + J_0 hh (sd_radial.h), as what the transform of a
 * padded grid is multiplied with.
 *
 * It is smooth and known in closed form, so it is sampled at the offsets of the grid, beyond which
 * a taper takes it to 0; its transform is freed of the windows (w^ twice); and of the result the
 * offsets within the box are kept. The grid around them is wider than the box by a fixed number of
 * points: long boxes need no more than others. The error is below the window's, down to 1e-13.
 * Source: our own; the usual way, a kernel cut off at a sphere around the box (Vico, Greengard &
 * Ferrando 2016), takes a cube of the box's longest edge. */
#ifndef SD_OPEN_KERNEL_H
#define SD_OPEN_KERNEL_H

#include "sd_ewald.h"
#include "sd_status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* m [3]: half the points of the transform each way, plus 1. y, z [2]: first and end of what is wanted
 * of the octant; table [y][m 0][6][z], out: xx yy zz xy xz yz. SD_OK or SD_ENOMEMORY. */
sd_status sd_open_kernel(const sd_ewald *e, const int *m, const int *y, const int *z, double *table);

/* --- parts of it, for other kernels on padded grids --- */

/* Points that the large grid has beyond the offsets wanted, each way, for windows of so many. Wide
 * windows blow up more of what the taper has at short waves. With these the error is that of the
 * rest from 1e-2 to 1e-13; a quarter fewer cost one to two digits. */
int sd_open_kernel_beyond(int points);
/* So many points beyond what is wanted, of `many`: 1 up to a fifth of the way, then smoothly to 0
 * at the end, where the transform's next period begins */
double sd_open_kernel_taper(int beyond, int many);
/* [n] 1/w^ at waves 0 ... n - 1 of 2 (n - 1), less the last, which has no partner: 0. malloc'ed;
 * NULL: out of memory */
double *sd_open_kernel_inverse(const sd_ewald *e, int n);
/* A direction in which the kernel is even or odd and m - 1 offsets are wanted: points n of the
 * large grid from the first offset on, taper [n] and 1/w^ [n], malloc'ed. Returns 0 without
 * memory. */
int sd_open_kernel_way(const sd_ewald *e, int m, int *n, double **taper, double **inverse);
/* Offsets 0 ... m - 2 each way of the large grid `from` [n 0][n 1][n 2] go to that of the
 * transform, to [m 0][m 1][m 2]; the last, which no two points within the box have, stay 0. */
void sd_open_kernel_keep(const double *from, const int *n, double *to, const int *m);

#ifdef __cplusplus
}
#endif
#endif
