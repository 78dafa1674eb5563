/* Spheres from coarse to fine, and who is near among those before. */
#ifndef SD_ORDER_H
#define SD_ORDER_H

#include "sd_product.h"
#include "sd_status.h"

/* Spheres in order, each the one farthest from all before it; ties: the smaller index first. Rows
 * of each: sphere k of the order (k % parts == part) itself, then those before it and nearer than
 * rho times its distance from them. Spheres with radius 0 take no part. */
typedef struct {
  int columns;
  /* [columns + 1] into row */
  long *first;
  int *row;
  /* most rows of a column */
  int largest;
} sd_rows;

/* Zero-initialise; sd_rows_free in the end, also after a failure. SD_OK; SD_ENOMEMORY. */
sd_status sd_rows_find(sd_rows *rows, const sd_spheres *s, int n, double rho, int part, int parts);
void sd_rows_free(sd_rows *rows);

#endif
