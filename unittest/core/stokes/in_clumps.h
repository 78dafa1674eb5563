/* A cloud whose clumps are m consecutive spheres each, as a preconditioner sees it; spheres that are
 * left over are in none. */
#ifndef IN_CLUMPS_H
#define IN_CLUMPS_H

#include "check.h"

#include "sd_blocks.h"
#include "sd_sparse.h"

typedef struct {
  sd_precondition_case c;
  long first[101];
  int member[2000];
} in_clumps;

static inline const sd_precondition_case *clumps_of(in_clumps *k, sd_law law, sd_spheres spheres,
                                                    int n, int width, int m)
{
  const int clumps = n / m;
  assert_true(n <= 2000 && clumps <= 100);
  for (int i = 0; i <= clumps; i++) k->first[i] = (long) m * i;
  for (int i = 0; i < n; i++) k->member[i] = i;
  k->c = (sd_precondition_case){.law = law,
                                .spheres = spheres,
                                .n = n,
                                .width = width,
                                .clumps = clumps,
                                .first = k->first,
                                .member = k->member,
                                .parts = 1};
  return &k->c;
}

#endif
