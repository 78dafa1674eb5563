/* What ranks tell each other: gathers of a varying number of things, questions to those who know,
 * and rows for a few partners. */
#ifndef SD_RANKS_H
#define SD_RANKS_H

#include <mpi.h>

#include <algorithm>
#include <climits>
#include <cstring>
#include <new>
#include <type_traits>
#include <vector>

namespace StokesDyn {

/* A count as MPI takes it: what does not fit is more than a message holds, so there is no memory
 * for it (std::bad_alloc). */
inline int mpi_count(double count)
{
  if (!(count <= INT_MAX)) throw std::bad_alloc();
  return (int) count;
}

/* What the ranks have, one rank after the other: the same vector on all of them. T travels by its
 * bytes, so that no MPI type is needed (LAMMPS's own MPI for a single rank lacks those of fixed
 * width). At most 2 GB in all: std::bad_alloc on all ranks. */
template <class T> std::vector<T> from_all(MPI_Comm world, const std::vector<T> &mine)
{
  static_assert(std::is_trivially_copyable<T>::value, "travels by its bytes");
  int nprocs;
  double size = (double) mine.size() * sizeof(T), total = 0.0;
  MPI_Comm_size(world, &nprocs);
  std::vector<double> shares(nprocs);
  std::vector<int> sizes(nprocs), at(nprocs);
  MPI_Allgather(&size, 1, MPI_DOUBLE, shares.data(), 1, MPI_DOUBLE, world);
  for (double share : shares) total += share;
  mpi_count(total);
  for (int p = 0; p < nprocs; p++) {
    sizes[p] = (int) shares[p];
    at[p] = p ? at[p - 1] + sizes[p - 1] : 0;
  }
  std::vector<T> all((size_t) total / sizeof(T));
  MPI_Allgatherv(const_cast<T *>(mine.data()), (int) size, MPI_BYTE, all.data(), sizes.data(),
                 at.data(), MPI_BYTE, world);
  return all;
}

/* Sends every item to the rank that home(item) names, where answer(items), given all that came
 * there, may change them in place; they come back in the order of `mine`. So ranks settle together
 * what none of them knows alone, without a list of all on each. At most 2 GB a rank. */
template <class T, class Home, class Answer>
void ask_homes(MPI_Comm world, std::vector<T> &mine, const Home &home, const Answer &answer)
{
  static_assert(std::is_trivially_copyable<T>::value, "travels by its bytes");
  int nprocs;
  MPI_Comm_size(world, &nprocs);
  mpi_count((double) mine.size() * sizeof(T));
  std::vector<int> sent(nprocs, 0), received(nprocs), sent_at(nprocs, 0), received_at(nprocs, 0);
  for (const T &item : mine) sent[home(item)] += sizeof(T);
  MPI_Alltoall(sent.data(), 1, MPI_INT, received.data(), 1, MPI_INT, world);
  double coming = 0.0;
  for (int p = 0; p < nprocs; p++) {
    sent_at[p] = p ? sent_at[p - 1] + sent[p - 1] : 0;
    received_at[p] = mpi_count(coming);
    coming += received[p];
  }
  std::vector<int> next(sent_at);
  std::vector<T> out(mine.size()), in(mpi_count(coming) / sizeof(T));
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

/* Rows between this rank and its partners, point to point. Both sides know how many rows go and
 * come; a rank may be a partner of its own. */
class Post {
 public:
  explicit Post(MPI_Comm world) : world(world)
  {
    MPI_Comm_rank(world, &me);
    MPI_Comm_size(world, &ranks);
  }
  struct Partner {
    int rank, out, in;
  };
  /* in ascending order of rank: rows go and come one partner after the other */
  std::vector<Partner> partners;
  MPI_Comm world;
  int me, ranks;

  int rows_in() const
  {
    double rows = 0.0;
    for (const Partner &p : partners) rows += p.in;
    return mpi_count(rows);
  }
  /* Each tells its partners how many rows it has for them: sets `in` from their `out`. */
  void tell()
  {
    std::vector<MPI_Request> under_way;
    for (Partner &p : partners)
      if (p.rank == me)
        p.in = p.out;
      else
        MPI_Irecv(&p.in, 1, MPI_INT, p.rank, TAG, world, add(under_way));
    for (Partner &p : partners)
      if (p.rank != me) MPI_Isend(&p.out, 1, MPI_INT, p.rank, TAG, world, add(under_way));
    wait(under_way);
  }
  /* out [width rows] -> in [width rows_in()] */
  void carry(const double *out, double *in, int width) const
  {
    std::vector<MPI_Request> under_way;
    const double *own = nullptr;
    double *there = nullptr;
    size_t count = 0;
    for (const Partner &p : partners) {
      const size_t numbers = (size_t) width * p.in;
      if (p.rank == me) {
        there = in;
        count = numbers;
      } else if (p.in > 0)
        MPI_Irecv(in, mpi_count(numbers), MPI_DOUBLE, p.rank, TAG, world, add(under_way));
      in += numbers;
    }
    for (const Partner &p : partners) {
      const size_t numbers = (size_t) width * p.out;
      if (p.rank == me)
        own = out;
      else if (p.out > 0)
        MPI_Isend(const_cast<double *>(out), mpi_count(numbers), MPI_DOUBLE, p.rank, TAG, world,
                  add(under_way));
      out += numbers;
    }
    if (count) std::copy_n(own, count, there);
    wait(under_way);
  }
  /* The same the other way: rows that came go back. */
  Post reversed() const
  {
    Post back = *this;
    for (Partner &p : back.partners) std::swap(p.out, p.in);
    return back;
  }

 private:
  enum { TAG = 7 };

  static MPI_Request *add(std::vector<MPI_Request> &under_way)
  {
    under_way.emplace_back();
    return &under_way.back();
  }
  static void wait(std::vector<MPI_Request> &under_way)
  {
    for (MPI_Request &request : under_way) MPI_Wait(&request, MPI_STATUS_IGNORE);
  }
};

/* to[p] numbers of `send` to rank p, from[p] of `receive` from it, one rank after the other; only
 * those speak that have something to say. */
inline void exchange_numbers(MPI_Comm world, const double *send, const int *to, double *receive,
                             const int *from)
{
  Post post(world);
  for (int p = 0; p < post.ranks; p++)
    if (to[p] || from[p]) post.partners.push_back({p, to[p], from[p]});
  post.carry(send, receive, 1);
}

}    // namespace StokesDyn
#endif
