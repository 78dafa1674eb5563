/* The mean resistance of two shells of points, as shipped: what is left of it as a film (sd_film.h)
 * without that of two spheres of the Rotne-Prager-Yamakawa model, over the scales below. Radii
 * a1 <= a2. */
#ifndef SD_FILM_TABLE_INTERNAL_H
#define SD_FILM_TABLE_INTERNAL_H

#include "sd_film.h"

enum { SD_FILM_KINDS = 4, SD_FILM_SCALARS = 5 };

/* Spheres that are all alike, of 12 points, 12 with the addition, 42, 42 with it: by kind, nodes of the
 * ratio, of the gap, and A_n A_t B11 B12 B22. Made by make_film_table. */
extern const double sd_film_table[SD_FILM_KINDS][SD_FILM_RATIOS][SD_FILM_GAPS][SD_FILM_SCALARS];

/* Nodes in (0, 1) (sd_two_sphere_node) stand for
 *   v = (a2 - a1)/(a2 + a1) over its largest value,   q = (xi/SD_FILM_LARGEST_XI)^(1/2) */
#define SD_FILM_LARGEST_V ((SD_FILM_LARGEST_RATIO - 1.0) / (SD_FILM_LARGEST_RATIO + 1.0))

/* v of a ratio >= 1 */
static inline double sd_film_v(double ratio)
{
  return (ratio - 1.0) / (ratio + 1.0);
}

/* Shells by radius, the larger sphere's of `large` points (sd_multiblob_half.h); two of 12 points are in the
 * table above. Each kind has its own range of ratios, with a few nodes in
 *   v between those of its ends,   q = (xi_h/SD_FILM_LARGEST_XI)^(1/2)
 * where xi_h is the gap over the harmonic mean of the radii. */
typedef struct {
  int large, small, ratios;
  double lowest, highest;
} sd_film_kind;
enum { SD_FILM_HALF_KINDS = 9, SD_FILM_HALF_ROWS = 56 };
extern const sd_film_kind sd_film_kinds[SD_FILM_HALF_KINDS];

/* Rows of all kinds, one for each node of the ratio; of the points alone, and with the addition. Made by
 * make_film_table half. */
extern const double sd_film_half_table[SD_FILM_HALF_ROWS][2][SD_FILM_GAPS][SD_FILM_SCALARS];

/* xi over xi_h, from the gap over the mean radius to that over the harmonic mean */
static inline double sd_film_harmonic(double a1, double a2)
{
  return 4.0 * a1 * a2 / ((a1 + a2) * (a1 + a2));
}

/* 6 pi h_1, 8 pi h_3, 8 pi (a_p a_q)^1.5; 1/h_k = 1/a1^k + 1/a2^k */
void sd_film_scales(double a1, double a2, double scale[SD_FILM_SCALARS]);

/* Both eigenvalues of the symmetric (p q; q r) clipped at 0: it keeps the part of the larger one,
 * m m^T with m along its eigenvector, or nothing. */
void sd_film_clip(double *p, double *q, double *r);

#endif
