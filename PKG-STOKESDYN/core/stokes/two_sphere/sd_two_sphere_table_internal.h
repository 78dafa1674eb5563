/* The exact two-sphere functions at a set of ratios and gaps, as shipped, and how they are put
 * together again. Radii a1 <= a2, l = a2/a1, and instead of the gap
 *
 *   mu = alpha + beta of the bispherical coordinates:  cosh mu - 1 = (1 + l)^2/l xi (4 + xi)/8
 *
 * in which near contact (mu^2 like the gap over a1) and far away (mu like twice the logarithm of
 * the distance) take about equal parts of the range, whatever the ratio. */
#ifndef SD_TWO_SPHERE_TABLE_INTERNAL_H
#define SD_TWO_SPHERE_TABLE_INTERNAL_H

#include "sd_pair_resistance.h"
#include "sd_two_sphere.h"

enum {
  /* Chebyshev nodes in ln l and in mu over its largest value; functions in the order of
   * sd_pair_resistance */
  SD_TWO_SPHERE_RATIOS = 20,
  SD_TWO_SPHERE_GAPS = 32,
  SD_TWO_SPHERE_FUNCTIONS = 16
};

/* What is left of the exact functions without sd_two_sphere_near and without what each sphere
 * resists alone, over the scales below. Made by make_two_sphere_table. */
extern const double sd_two_sphere_table[SD_TWO_SPHERE_RATIOS][SD_TWO_SPHERE_GAPS]
                                       [SD_TWO_SPHERE_FUNCTIONS];

/* Node 0 <= k < n of n in (0, 1), largest first */
double sd_two_sphere_node(int n, int k);

/* Weights [n] of the values at these nodes for that at t in [0, 1]: barycentric formula; n is at most
 * SD_TWO_SPHERE_GAPS */
void sd_two_sphere_weights(int n, double t, double *w);

/* The same where many t have the same nodes: node [n], root [n] of these, and the weights */
void sd_two_sphere_nodes(int n, double *node, double *root);
void sd_two_sphere_weights_at(int n, const double *node, const double *root, double t, double *w);

/* Weights of values at so many even steps around the place at >= 0 among n of them, and the first one */
enum { SD_TWO_SPHERE_STENCIL = 6 };
int sd_two_sphere_stencil(double at, int n, double w[SD_TWO_SPHERE_STENCIL]);

/* mu of a gap; mu of SD_TWO_SPHERE_LARGEST_XI */
double sd_two_sphere_mu(double ratio, double xi);
double sd_two_sphere_largest_mu(double ratio);

/* The table's unit of each function: the smaller sphere gives the force, the torques have the arms
 * of their own spheres. */
void sd_two_sphere_scales(double a1, double a2, double scale[SD_TWO_SPHERE_FUNCTIONS]);

/* Stokes drags of both, by themselves */
sd_pair_resistance sd_two_sphere_alone(double a1, double a2);

#endif
