/* Every body for itself, by the blocks M_b': the preconditioner of sd_bodies.h without what ties
 * them. V, f [6 bodies], r, l [rows]; scratch [2 x the rows of the largest body]. */
#ifndef SD_BODIES_ALONE_H
#define SD_BODIES_ALONE_H

#include "sd_body.h"

/* What is left of the two lines of sd_bodies.h, r and f; NULL: 0. bears: what sd_bodies_alone_bear made of
 * r; NULL: not known */
typedef struct {
  const double *r, *bears, *f;
} sd_bodies_left;

/* pre(r, f): l and V. Of held bodies V is read. */
void sd_bodies_alone(const sd_bodies *A, const sd_bodies_left *left, double *scratch, double *l, double *V);
/* f [6 bodies] = K^T M_b'^-1 r */
void sd_bodies_alone_bear(const sd_bodies *A, const double *r, double *scratch, double *f);
/* f = N^-1 V; V = N f */
void sd_bodies_alone_resist(const sd_bodies *A, const double *V, double *f);
void sd_bodies_alone_move(const sd_bodies *A, const double *f, double *V);
/* Has any body a dN? */
int sd_bodies_shells(const sd_bodies *A);
/* w = M' l - K V; shells: sd_bodies_shells(). Scratch: bodies [12 bodies], on_spheres [6 spheres].
 * SD_OK or that of A->apply. */
sd_status sd_bodies_product(const sd_bodies *A, int shells, const double *l, const double *V,
                            double *bodies, double *on_spheres, double *w);
/* N^-1 of one body */
void sd_body_resistance_block(const sd_body *b, double B[36]);

#endif
