/* The mean resistance of two shells of points, as shipped: what is left of it as a film (sd_film.h)
 * without that of two spheres of the Rotne-Prager-Yamakawa model, over the scales below. Radii
 * a1 <= a2. */
#ifndef SD_FILM_TABLE_INTERNAL_H
#define SD_FILM_TABLE_INTERNAL_H

#include "sd_film.h"

enum { SD_FILM_KINDS = 4, SD_FILM_SCALARS = 5 };

/* 12 points, 12 with the addition, 42, 42 with it: by kind, nodes of the ratio, of the gap, and
 * A_n A_t B11 B12 B22. Made by make_film_table. */
extern const double sd_film_table[SD_FILM_KINDS][SD_FILM_RATIOS][SD_FILM_GAPS][SD_FILM_SCALARS];

/* Nodes in (0, 1) (sd_two_sphere_node) stand for
 *   v = (a2 - a1)/(a2 + a1) over its largest value,   q = (xi/SD_FILM_LARGEST_XI)^(1/2) */
#define SD_FILM_LARGEST_V ((SD_FILM_LARGEST_RATIO - 1.0) / (SD_FILM_LARGEST_RATIO + 1.0))

/* 6 pi h_1, 8 pi h_3, 8 pi (a_p a_q)^1.5; 1/h_k = 1/a1^k + 1/a2^k */
void sd_film_scales(double a1, double a2, double scale[SD_FILM_SCALARS]);

/* Both eigenvalues of the symmetric (p q; q r) clipped at 0: it keeps the part of the larger one,
 * m m^T with m along its eigenvector, or nothing. */
void sd_film_clip(double *p, double *q, double *r);

#endif
