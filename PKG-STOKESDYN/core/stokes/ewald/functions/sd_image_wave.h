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
 *                                       or, waves that end at K: x = R (K - sqrt(K^2 - k^2))
 *
 * and of spheres as free Ewald sums have it, S = 1 + b lap at either end, b = (a^2 - a_ref^2)/6; there
 * a height h stands for h S + 2 (b + a_ref^2/6 S) d_z. (What a_ref leaves out of the Laplacians of L
 * is near only.) In the form of sd_wall.h, with D = B - A and eight functions P of the distance alone:
 *
 *   c1 = P0 + gh P1 + z^2 P2 + 2 z (g - h) D P8     c2 = P3,   z = g + h
 *   c3 = P4 + gh P5 + z^2 P6 + 2 z (g - h) D P9
 *   c4 = z P7 - (g - h) P1/2 + 4 g D P8             c5 = z P7 + (g - h) P1/2 - 4 h D P8
 *   P = P[0] + (b_i + b_j) P[1] + b_i b_j P[2],     but P8, P9 = P[0] alone
 *
 * Source: the wall's terms as harmonic sums, Gimbutas, Greengard & Veerapaneni 2015; the symmetric
 * form and its filters are our own. */
#ifndef SD_IMAGE_WAVE_H
#define SD_IMAGE_WAVE_H

#include "sd_radial.h"

SD_BEGIN_C

enum { SD_IMAGE_SYMMETRIC = 8, SD_IMAGE_FUNCTIONS = 10 };

/* x of a wave; INFINITY: it is beyond the band */
double sd_image_exponent(const sd_ewald_images *images, double k2);

/* P [SD_IMAGE_FUNCTIONS][3] at a distance */
void sd_image_wave(const sd_ewald *e, double r, double (*P)[3]);

/* Polynomials on [0, range of the images] in t = 2 (r/range)^2 - 1, coefficients of 1, t, t^2 ...
 * Returns their degree: the smallest with which what they add to a velocity is right to a tenth of the
 * tolerance, relative to what the filtered G is at no distance. */
int sd_image_fit(const sd_ewald *e, double (*coefficient)[3][SD_RADIAL_TERMS]);

SD_END_C
#endif
