/* Images in a plane wall, by Ewald sums: the part of an image that is smooth and goes by FFT.
 *
 * With the letters of sd_wall.h, L = 1/R, G = (lap - grad grad) R and t for what is along the wall,
 * the image of a point force is, times 8 pi eta,
 *
 *   U = -G_tt F_t - G_zz F_z z + 2 g h grad (f.grad L) + (g - h) (z F_t.grad L + F_z grad_t L)  (1)
 *
 * (the half of its two forms, so that it is symmetric term by term: i and j exchanged are h and g,
 * R and -mR). The smooth part is (1) with filtered kernels,
 *
 *   G: H = (1 + x - a_ref^2 k^2/3) exp(-x),   L: exp(-x),   x = k^2/(4 xi^2)
 *
 * and of spheres as free Ewald sums have it, S = 1 + b lap at either end, b = (a^2 - a_ref^2)/6; there
 * a height h stands for h S + 2 (b + a_ref^2/6 S) d_z. (What a_ref leaves out of the Laplacians of L
 * is near only.)
 * Source: the wall's terms as harmonic sums, Gimbutas, Greengard & Veerapaneni 2015; the symmetric
 * form and its filters are our own. */
#ifndef SD_IMAGE_WAVE_H
#define SD_IMAGE_WAVE_H

#include "sd_radial.h"

SD_BEGIN_C

/* The smooth part of a pair in the form of sd_wall.h, c1 ... c5 out. xi, xj: in the axes of the wall,
 * heights at least the radii a, b */
void sd_image_wave(const sd_filter *filter, const double xi[3], double a, const double xj[3],
                   double b, double c[5]);

SD_END_C
#endif
