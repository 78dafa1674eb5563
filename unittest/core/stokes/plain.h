/* The product in plain C without an object to keep, for comparison. */
#ifndef PLAIN_H
#define PLAIN_H

#include "check.h"

#include "sd_product.h"

static inline const char *isa_name(sd_isa isa)
{
  static const char *const names[] = {"best", "plain C", "baseline", "AVX2", "AVX-512"};
  return names[isa];
}

/* Every one of n spheres with every other: F [width n] -> u [width n] */
static inline void plain_all(const sd_law *law, const sd_spheres *s, int n, int width,
                             const double *F, double *u)
{
  sd_packed p = {0};
  assert_int_equal(sd_packed_all(&p, SD_ISA_PLAIN, law, s, n, width), SD_OK);
  sd_packed_share(&p, 0, 1, F, u);
  sd_packed_free(&p);
}

/* F [width n], those of ghosts behind those of the targets -> u [width pairs->n] */
static inline void plain_list(const sd_law *law, const sd_spheres *s, int n, int width,
                              const sd_pairs *pairs, const double *F, double *u)
{
  sd_packed p = {0};
  assert_int_equal(sd_packed_list(&p, SD_ISA_PLAIN, law, s, n, width), SD_OK);
  sd_packed_pairs(&p, pairs, F, F + (long) width * pairs->n, u);
  sd_packed_free(&p);
}

#endif
