/* Gathers of a varying number of things over all ranks. */
#ifndef SD_RANKS_H
#define SD_RANKS_H

#include <mpi.h>

#include <cstring>
#include <type_traits>
#include <vector>

namespace StokesDyn {

/* What the ranks have, one rank after the other: the same vector on all of them. T travels by its bytes, so that no MPI type
 * is needed (LAMMPS's own MPI for a single rank lacks those of fixed width). At most 2 GB in all. */
template <class T> std::vector<T> from_all(MPI_Comm world, const std::vector<T> &mine)
{
  static_assert(std::is_trivially_copyable<T>::value, "travels by its bytes");
  int nprocs, total = 0, size = (int) (mine.size() * sizeof(T));
  MPI_Comm_size(world, &nprocs);
  std::vector<int> sizes(nprocs), at(nprocs);
  MPI_Allgather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, world);
  for (int p = 0; p < nprocs; p++) {
    at[p] = total;
    total += sizes[p];
  }
  std::vector<T> all(total / sizeof(T));
  MPI_Allgatherv(const_cast<T *>(mine.data()), size, MPI_BYTE, all.data(), sizes.data(), at.data(),
                 MPI_BYTE, world);
  return all;
}

}    // namespace StokesDyn
#endif
