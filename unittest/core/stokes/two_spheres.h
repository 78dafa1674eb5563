/* The functions of two spheres exactly, which take longer to make than most scenes to solve. */
#ifndef TWO_SPHERES_H
#define TWO_SPHERES_H

#include "check.h"

#include "sd_two_sphere.h"

/* Up to a ratio of radii; each is made once in a program, and stays */
static inline const sd_two_sphere *two_spheres(double largest_ratio)
{
  enum { RATIOS = 8 };
  static struct {
    double largest_ratio;
    sd_two_sphere *functions;
  } made[RATIOS];
  int k = 0;
  while (k < RATIOS && made[k].functions && made[k].largest_ratio != largest_ratio) k++;
  assert_true(k < RATIOS);
  if (!made[k].functions) assert_int_equal(sd_two_sphere_create(largest_ratio, &made[k].functions), SD_OK);
  made[k].largest_ratio = largest_ratio;
  return made[k].functions;
}

#endif
