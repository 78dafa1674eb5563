/* Gradients of a flow, row-major: G[3 p + q] = d u_p / d x_q. */
#ifndef SD_FLOW_H
#define SD_FLOW_H

#ifdef __cplusplus
extern "C" {
#endif

/* Angular velocity of a fluid element, half the vorticity: w_d = (d u_f/d x_e - d u_e/d x_f) / 2
 * for d, e, f in cyclic order. */
void sd_flow_rotation(const double G[9], double w[3]);

/* The same piece by piece: adds to w [3n] what is due to slope [n] = d u_p / d x_q, p != q. */
void sd_flow_add_rotation(int n, int p, int q, const double *slope, double *w);

/* Puts the given vorticity (2 w) in place of that of G; the rate of strain stays. */
void sd_flow_set_vorticity(const double vorticity[3], double G[9]);

/* Central difference of one component over +-a: exact for a linear field, to order a^2 for others.
 * 0 where a = 0. All [n]. */
void sd_flow_slope(int n, const double *ahead, const double *behind, const double *a,
                   double *slope);

/* The flow that takes a cell along: G = (dH/dt) H^-1, H = (xx xy xz; 0 yy yz; 0 0 zz) with the
 * edges as columns. h and rate [6]: xx yy zz yz xz xy of H, > 0 the first three, and of dH/dt. The
 * same for every choice of the edges of one lattice, as long as h and rate are of one choice. */
void sd_flow_of_cell(const double h[6], const double rate[6], double G[9]);

#ifdef __cplusplus
}
#endif
#endif
