/* The near part of an Ewald sum: pairs up to the range, the tensor of a pair less its wave part in
 * open space (sd_radial.h), and what that wave part is at no distance, for the sphere itself.
 *
 *   u_i = sum_j [ RPY_ij(r) - D_ij(r) ] F_j - D_ii(0) F_i         all spheres j within range of i,
 *                                                                images among them
 * Pairs that overlap beyond the range count too. */
#ifndef SD_EWALD_PAIRS_H
#define SD_EWALD_PAIRS_H

#include "sd_ewald_internal.h"
#include "sd_status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Zero-initialise; sd_ewald_pairs_free in the end. */
typedef struct {
  const struct sd_ewald_kernels *kernels;
  sd_ewald ewald;
  int width, degree;
  double coefficient[SD_RADIALS][SD_RADIAL_TERMS], origin[SD_RADIALS], scale;
  sd_spheres spheres;
  /* of the spheres with radius, ours and ghosts, in order of cells: their number, [rows] which */
  int rows, *sphere;
  /* all radii are a_ref */
  int equal;
  /* our own among them: [n] rows in order of cells, [n + 1] their neighbours */
  int n, *target;
  long *first;
  int *neighbor;
  /* pairs (target, row) that overlap beyond the range: [2 wides] */
  int wides, *wide;
  double *row, *torque_row, *u;
  /* capacities: spheres, neighbours, wide pairs, doubles */
  int room, wide_room;
  long neighbor_room;
  /* cells: [cells + 1] first row of each, and centres [3][rows] in order */
  int cell_room, *cell_first;
  double *centre;
} sd_ewald_pairs;

/* Polynomials for a splitting. */
void sd_ewald_pairs_create(sd_ewald_pairs *p, const sd_ewald *e,
                           const struct sd_ewald_kernels *kernels, int width);

/* n spheres of ours and the ghosts after them, n_all together. SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_pairs_place(sd_ewald_pairs *p, const sd_spheres *s, int n, int n_all);

/* F [width n] of ours and ghosts [width (n_all - n)] -> u [width n]; 0 for spheres without radius */
void sd_ewald_pairs_apply(sd_ewald_pairs *p, int n, const double *F, const double *ghosts,
                          double *u);

void sd_ewald_pairs_free(sd_ewald_pairs *p);

#ifdef __cplusplus
}
#endif
#endif
