#include "sd_vans_grains.h"

#include "sd_interval.h"

int sd_vans_slice_of(const sd_vans_mesh *mesh, double z)
{
  const int N = mesh->ncell;
  const double height = z - mesh->z_ref;
  if (!(height >= 0.0)) return -1;
  if (mesh->dz > 0.0) {
    const double s = height / mesh->dz;
    return s >= N ? N : (int) s;
  }
  return height >= mesh->edge[N] ? N : sd_interval(mesh->edge, N, height);
}
