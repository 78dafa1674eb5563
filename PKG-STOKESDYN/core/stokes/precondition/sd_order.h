/* Spheres from coarse to fine, and who is near among those before. */
#ifndef SD_ORDER_H
#define SD_ORDER_H

#include "sd_product.h"
#include "sd_status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Each sphere the one farthest from all before it: order [n] spheres that take part, farthest
 * first; distance [n] of order[i] from those before it (INFINITY for the first). Returns their
 * number, or -1 without memory. Ties: the smaller index first. */
int sd_farthest_first(const sd_spheres *s, int n, int *order, double *distance);

/* Rows: of sphere order[k] (k % parts == part) itself, then those before it and nearer than rho
 * times its distance. */
typedef struct {
  int columns;
  /* [columns + 1] into row */
  long *first;
  int *row;
  /* most rows of a column */
  int largest;
} sd_rows;

/* In the order of sd_farthest_first. Zero-initialise; sd_rows_free in the end, also after a
 * failure. SD_OK; SD_ENOMEMORY. */
sd_status sd_rows_find(sd_rows *rows, const sd_spheres *s, int n, double rho, int part, int parts);
void sd_rows_free(sd_rows *rows);

#ifdef __cplusplus
}
#endif
#endif
