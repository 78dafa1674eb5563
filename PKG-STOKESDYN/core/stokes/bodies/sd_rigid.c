#include "sd_rigid.h"

#include <string.h>

#include "sd_linear.h"

void sd_rigid_move(const sd_rigid *K, const double *V, double *v)
{
  for (int i = 0; i < K->n; i++, v += K->width) {
    const double *whole = V + 6 * (long) sd_rigid_whole(K, i);
    memcpy(v, whole, 3 * sizeof(double));    /* of a length that the compiler knows: no call */
    if (K->width > 3) memcpy(v + 3, whole + 3, 3 * sizeof(double));
    if (!K->arm) continue;
    double turning[3];
    sd_cross(whole + 3, K->arm + 3 * (long) i, turning);
    for (int d = 0; d < 3; d++) v[d] += turning[d];
  }
}

void sd_rigid_collect(const sd_rigid *K, const double *parts, int wholes, double *f)
{
  memset(f, 0, sizeof(double) * 6 * (size_t) wholes);
  for (int i = 0; i < K->n; i++, parts += K->width) {
    double *whole = f + 6 * (long) sd_rigid_whole(K, i);
    for (int d = 0; d < K->width; d++) whole[d] += parts[d];
    if (!K->arm) continue;
    double couple[3];
    sd_cross(K->arm + 3 * (long) i, parts, couple);
    for (int d = 0; d < 3; d++) whole[3 + d] += couple[d];
  }
}

static int rigid_is_one(const sd_rigid *K)
{
  return !K->whole && !K->arm && K->width == 6;
}

const double *sd_rigid_moved(const sd_rigid *K, const double *V, double *v)
{
  if (rigid_is_one(K)) return V;
  sd_rigid_move(K, V, v);
  return v;
}

const double *sd_rigid_collected(const sd_rigid *K, const double *parts, int wholes, double *f)
{
  if (rigid_is_one(K)) return parts;
  sd_rigid_collect(K, parts, wholes, f);
  return f;
}
