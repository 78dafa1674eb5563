#include "sd_vans_grains.h"

int sd_vans_slice_of(const sd_vans_mesh *mesh, double z)
{
  const int N = mesh->ncell;
  const double height = z - mesh->z_ref;
  if (!(height >= 0.0)) return -1;
  if (mesh->dz > 0.0) {
    const double s = height / mesh->dz;
    return s >= N ? N : (int) s;
  }
  if (height >= mesh->edge[N]) return N;
  int lo = 0, hi = N; /* halved; edge[lo] <= height < edge[hi] */
  while (hi - lo > 1) {
    const int mid = (lo + hi) / 2;
    if (mesh->edge[mid] <= height)
      lo = mid;
    else
      hi = mid;
  }
  return lo;
}
