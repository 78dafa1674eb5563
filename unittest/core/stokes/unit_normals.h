/* Unit vectors in the place of the normal numbers of noise, so that covariances need no samples: of the
 * points, then 12 of each pair of spheres i < j. */
#ifndef UNIT_NORMALS_H
#define UNIT_NORMALS_H

typedef struct {
  int spheres, unit;
} unit_normals;

static inline int unit_of_pair(void *ctx, int i, int at, double g[12])
{
  const unit_normals *u = ctx;
  const int a = i < at ? i : at, b = i < at ? at : i, k = u->unit - 12 * (a * u->spheres + b);
  for (int e = 0; e < 12; e++) g[e] = e == k;
  return i < at;
}

#endif
