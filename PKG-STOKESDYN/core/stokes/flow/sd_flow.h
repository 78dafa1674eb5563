/* Gradients of a flow, row-major: G[3 p + q] = d u_p / d x_q, and its second derivatives:
 * H[6 p + e] = d2 u_p / d x_q d x_r with qr = xx yy zz xy xz yz for e = 0 to 5. */
#ifndef SD_FLOW_H
#define SD_FLOW_H

#include "sd_extern_c.h"

SD_BEGIN_C

/* Angular velocity of a fluid element, half the vorticity: w_d = (d u_f/d x_e - d u_e/d x_f) / 2
 * for d, e, f in cyclic order. */
void sd_flow_rotation(const double G[9], double w[3]);

/* Puts the given vorticity (2 w) in place of that of G; the rate of strain stays. */
void sd_flow_set_vorticity(const double vorticity[3], double G[9]);

/* Central difference of one component over +-a: exact for a linear field, to order a^2 for others.
 * 0 where a = 0. */
double sd_flow_slope(double ahead, double behind, double a);

/* Where a flow is asked for its second derivatives: at x + h d and x - h d, d the rows of
 * sd_flow_around, h = SD_FLOW_STEP of a radius, so that all places are inside of the sphere. */
enum { SD_FLOW_DIRECTIONS = 6, SD_FLOW_SECOND = 18 };
#define SD_FLOW_STEP 0.5
extern const double sd_flow_around[SD_FLOW_DIRECTIONS][3];

/* H [6] of one component, from bend [6] = u(x + h d) + u(x - h d) - 2 u(x), h > 0. Exact for a
 * cubic flow, to order h^2 for others. */
void sd_flow_curvature(const double bend[SD_FLOW_DIRECTIONS], double h, double H[6]);

/* out [3] += r.H r/2 + (b^2/6) tr H: what curvature adds to the velocity with which the flow
 * carries a sphere of radius b at r from where H is (Faxen's law). */
void sd_flow_bend(const double H[SD_FLOW_SECOND], const double r[3], double b, double out[3]);

/* The flow that takes a cell along: G = (dH/dt) H^-1, H = (xx xy xz; 0 yy yz; 0 0 zz) with the
 * edges as columns. h and rate [6]: xx yy zz yz xz xy of H, > 0 the first three, and of dH/dt. The
 * same for every choice of the edges of one lattice, as long as h and rate are of one choice. */
void sd_flow_of_cell(const double h[6], const double rate[6], double G[9]);

SD_END_C
#endif
