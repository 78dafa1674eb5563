/* What ranks tell each other: gathers of a varying number of things, and questions to those who
 * know. */
#ifndef SD_RANKS_H
#define SD_RANKS_H

#include <mpi.h>

#include <cstring>
#include <type_traits>
#include <vector>

namespace StokesDyn {

/* What the ranks have, one rank after the other: the same vector on all of them. T travels by its
 * bytes, so that no MPI type is needed (LAMMPS's own MPI for a single rank lacks those of fixed
 * width). At most 2 GB in all. */
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

/* Sends every item to the rank that home(item) names, where answer(items), given all that came
 * there, may change them in place; they come back in the order of `mine`. So ranks settle together
 * what none of them knows alone, without a list of all on each. */
template <class T, class Home, class Answer>
void ask_homes(MPI_Comm world, std::vector<T> &mine, const Home &home, const Answer &answer)
{
  static_assert(std::is_trivially_copyable<T>::value, "travels by its bytes");
  int nprocs;
  MPI_Comm_size(world, &nprocs);
  std::vector<int> sent(nprocs, 0), received(nprocs), sent_at(nprocs, 0), received_at(nprocs, 0);
  for (const T &item : mine) sent[home(item)] += sizeof(T);
  MPI_Alltoall(sent.data(), 1, MPI_INT, received.data(), 1, MPI_INT, world);
  for (int p = 1; p < nprocs; p++) {
    sent_at[p] = sent_at[p - 1] + sent[p - 1];
    received_at[p] = received_at[p - 1] + received[p - 1];
  }
  std::vector<int> next(sent_at);
  std::vector<T> out(mine.size()), in((received_at.back() + received.back()) / sizeof(T));
  auto slot = [&next, &home](const T &item) {
    int &at = next[home(item)];
    at += sizeof(T);
    return at / sizeof(T) - 1;
  };
  for (const T &item : mine) out[slot(item)] = item;
  MPI_Alltoallv(out.data(), sent.data(), sent_at.data(), MPI_BYTE, in.data(), received.data(),
                received_at.data(), MPI_BYTE, world);
  answer(in);
  MPI_Alltoallv(in.data(), received.data(), received_at.data(), MPI_BYTE, out.data(), sent.data(),
                sent_at.data(), MPI_BYTE, world);
  next = sent_at;
  for (T &item : mine) item = out[slot(item)];
}

}    // namespace StokesDyn
#endif
