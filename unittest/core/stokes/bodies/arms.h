/* Arms of the points of a body, in space axes. */
#ifndef ARMS_H
#define ARMS_H

#include "sd_body.h"
#include "sd_linear.h"

/* arm [3 shape->m] = a R X_k */
static inline void arms_of(const sd_body *b, double *arm)
{
  for (int k = 0; k < b->shape->m; k++, arm += 3) {
    sd_multiply3(b->R, b->shape->x + 3 * k, arm);
    for (int d = 0; d < 3; d++) arm[d] *= b->a;
  }
}

#endif
