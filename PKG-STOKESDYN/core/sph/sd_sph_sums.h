/* Sums over the neighbours, beside the forces of sd_sph_pair.h and with its notation. */
#ifndef SD_SPH_SUMS_H
#define SD_SPH_SUMS_H

#include "sd_sph_pair.h"

SD_BEGIN_C

/* How much the pass in the middle of a step sums. Each level has the columns of those before it. */
typedef enum {
  SD_SPH_RATE,
  SD_SPH_GRADIENT,
  SD_SPH_DISORDER,
  SD_SPH_VELOCITY,
  SD_SPH_MIXTURE
} sd_sph_level;
sd_sph_level sd_sph_level_of(const sd_sph_model *model);

/* Columns of a row of sums: 1, 12, 16, 24, 32; and the one that is no sum but a maximum, -1: none.
 *   rate       0      sum m_b g v.d, the density rate
 *   gradient   1-3    sum V_b (rho_b - rho_a) g d
 *              4-9    M = - sum V_b g d d^T: xx yy zz xy xz yz, the unit matrix in the bulk
 *   disorder   10-12  s = sum V_b (1 + 0.2 f^4) g d: 0 in order; 0.2 f^4 against pairing, Monaghan
 *                     2000
 *              13     U = max |v.d| / r over fluid neighbours
 *   velocity   14-22  G = - sum V_b (v_a - v_b) g d^T, by rows
 *   mixture    24-29  M over the particles of all fluids
 * Of two fluids (volume), gradient and M are over particles of the same fluid only. */
int sd_sph_sum_columns(sd_sph_level level);
enum { SD_SPH_MAXIMUM = 13 };

/* Neighbours both ways, each pair from both its sides: those of particle i < n are neighbor[i][0 ..
 * count[i] - 1], and the first own[i] of them are those that the half list gives to i. The far-away
 * particle fills up count to a multiple of SD_SPH_LANES. */
enum { SD_SPH_LANES = 8 };
typedef struct {
  int n, **neighbor, *own, *count;
} sd_sph_both;

/* How many entries the pool of a list both ways of n particles needs. */
size_t sd_sph_both_size(const sd_sph_list *half, int n);

/* Makes it of a half list in which particles from n on (ghosts) are only neighbours, and have no
 * list of their own here: their pairs with i stand in the list of i, whoever owns them. pool
 * [sd_sph_both_size] and the arrays of out are the caller's. */
void sd_sph_both_ways(const sd_sph_list *half, int filler, int *pool, sd_sph_both *out);

/* Room for the pairs closer than 2 h + margin, in the pool: as many entries as the list that they
 * are picked from has, and SD_SPH_LANES more; as sd_sph_both. A half list fills own and count. */
typedef struct {
  double margin;
  int *pool, **neighbor, *own, *count;
} sd_sph_near;

/* Of such pairs, found over the half list `half` or both ways, those with one particle or two of the
 * flow (phase >= 0). fill: rows are filled up with the far-away particle, as of a list both ways.
 * Room in the pool of out: as many entries as in, and SD_SPH_LANES more a particle. */
void sd_sph_pairs_of_flow(const sd_sph_particles *p, const sd_sph_list *half, const sd_sph_near *in,
                          int fill, const sd_sph_near *out);

/* Adds to rate [n+1] over a half list, for SD_SPH_RATE, and finds the near pairs. */
void sd_sph_rates(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                  double *rate, const sd_sph_near *near);

/* The rows of sums of the particles below list->n for the levels above, and the near pairs. */
void sd_sph_middle(const sd_sph_model *model, const sd_sph_both *list, const sd_sph_particles *p,
                   double *sums, const sd_sph_near *near);

/* Adds delta-SPH, Antuono et al. 2010, to rate [list->n]: with psi_ab = 2 (rho_b - rho_a) d_ba /
 * r^2 - (grad rho_a + grad rho_b), d_ba = x_b - x_a,
 *   delta h c sum_b V_b psi_ab . grad_a W
 * The corrected gradients come from slope; of two fluids, pairs of the same fluid only. */
void sd_sph_diffusion(const sd_sph_model *model, const sd_sph_both *list, const sd_sph_particles *p,
                      double *rate);

/* The forces of sd_sph_pair.h with correction, and what it says of sd_sph_forces: of the particles
 * below list->n, rows Fx Fy Fz 0 of f4; each: F_a, for every entry of the list. */
double sd_sph_corrected_forces(const sd_sph_model *model, const sd_sph_both *list,
                               const sd_sph_particles *p, double *f4, double *each);

/* What the gradient of the velocity of each particle needs, over a half list: adds to the rows of sums
 * [SD_SPH_GRADIENTS (n+1)]
 *   0-5 M: xx yy zz xy xz yz   6-14 G = - sum V_b (v_a - v_b) g d^T, by rows   15 0
 * over all neighbours, also those of other fluids and walls, which have the velocity that friction sees.
 * grad v = G M^-1. */
enum { SD_SPH_GRADIENTS = 16 };
void sd_sph_velocity_gradients(const sd_sph_model *model, const sd_sph_list *list,
                               const sd_sph_particles *p, double *sums);

/* Adds sum_b W q_b to the rows of sums, both [4 (n+1)]; row n of q is 0. */
void sd_sph_weigh(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                  const double *q, double *sums);

/* Adds to the rows of wall particles w, sums [8 (n+1)], over the particles f of their fluid, as
 * phase says, with d = x_w - x_f and rows 1, P, rho, 0, v, 0 of q [8 (n+1)], row n of which is 0:
 *   0 sum W    1 sum W P_f    2-4 sum W rho_f d    5-7 sum W (v_f + w_f x d)
 * spins [4 (n+1)]: rows w, 0 of sd_sph_spin (sd_sph_wall.h); null: all 0. */
void sd_sph_before_walls(const sd_sph_model *model, const sd_sph_list *list,
                         const sd_sph_particles *p, const double *q, const double *spins,
                         double *sums);

SD_END_C
#endif
