/* What ranks tell each other: one number of each, gathers of a varying number of things, questions to
 * those who know, and rows for a few partners. */
#ifndef SD_RANKS_H
#define SD_RANKS_H

#include "atom.h"
#include "lammps.h"
#include "lmptype.h"
#include <mpi.h>

#include <algorithm>
#include <climits>
#include <new>
#include <type_traits>
#include <vector>

#ifdef MPI_STUBS
/* LAMMPS's own MPI for a single rank, to which nobody writes, lacks this. */
inline int MPI_Probe(int, int, MPI_Comm, MPI_Status *) { return 0; }
#endif

namespace StokesDyn {

/* A count as MPI takes it: what does not fit is more than a message holds, so there is no memory
 * for it (std::bad_alloc). */
inline int mpi_count(double count)
{
  if (!(count <= INT_MAX)) throw std::bad_alloc();
  return (int) count;
}

inline MPI_Datatype type_of(double) { return MPI_DOUBLE; }
inline MPI_Datatype type_of(int) { return MPI_INT; }
inline MPI_Datatype type_of(LAMMPS_NS::bigint) { return MPI_LMP_BIGINT; }

/* One number of each rank; the same answer on all of them. */
template <class T> T among_all(MPI_Comm world, T mine, MPI_Op op)
{
  T all;
  MPI_Allreduce(&mine, &all, 1, type_of(mine), op, world);
  return all;
}
template <class T> T sum_of_all(MPI_Comm world, T mine) { return among_all(world, mine, MPI_SUM); }
template <class T> T largest_of_all(MPI_Comm world, T mine) { return among_all(world, mine, MPI_MAX); }
template <class T> T smallest_of_all(MPI_Comm world, T mine) { return among_all(world, mine, MPI_MIN); }

/* The lowest ID of the atoms for which this holds, 0: there is none; the same on all ranks. */
template <class Test> LAMMPS_NS::tagint first_atom(LAMMPS_NS::LAMMPS *lmp, const Test &test)
{
  const LAMMPS_NS::Atom *atom = lmp->atom;
  LAMMPS_NS::tagint mine = MAXTAGINT;
  for (int i = 0; i < atom->nlocal; i++)
    if (test(i)) mine = std::min(mine, atom->tag[i]);
  const LAMMPS_NS::tagint first = smallest_of_all(lmp->world, mine);
  return first == MAXTAGINT ? 0 : first;
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
  /* The partners by how many rows go to each rank; from all ranks to all. */
  void address(const std::vector<int> &to)
  {
    std::vector<int> from(to);
    // LAMMPS without MPI has stubs that take what is sent without const.
    if (ranks > 1) MPI_Alltoall(const_cast<int *>(to.data()), 1, MPI_INT, from.data(), 1, MPI_INT, world);
    partners.clear();
    for (int p = 0; p < ranks; p++)
      if (to[p] || from[p]) partners.push_back({p, to[p], from[p]});
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
    const double *own = send(out, width, 1, under_way);
    if (count) std::copy_n(own, count, there);
    wait(under_way);
  }
  /* The same where nobody knows yet how many rows come: sets `in`. Every partner hears of every other,
   * if only that there is nothing. */
  std::vector<double> deliver(const double *out, int width)
  {
    std::vector<MPI_Request> under_way;
    std::vector<double> in;
    const double *own = send(out, width, 0, under_way);
    for (Partner &p : partners)
      if (p.rank == me) {
        in.insert(in.end(), own, own + (size_t) width * p.out);
        p.in = p.out;
      } else
        p.in = receive(p.rank, in) / width;
    wait(under_way);
    return in;
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

  /* Sends every other partner its rows, if there are so many at least; where this rank's own are, nullptr:
   * nowhere */
  const double *send(const double *out, int width, int least, std::vector<MPI_Request> &under_way) const
  {
    const double *own = nullptr;
    for (const Partner &p : partners) {
      const size_t numbers = (size_t) width * p.out;
      if (p.rank == me)
        own = out;
      else if (p.out >= least)
        MPI_Isend(const_cast<double *>(out), mpi_count(numbers), MPI_DOUBLE, p.rank, TAG, world,
                  add(under_way));
      out += numbers;
    }
    return own;
  }
  /* What comes next from this rank, behind `in`; how many numbers */
  int receive(int rank, std::vector<double> &in) const
  {
    MPI_Status status;
    int numbers = 0;
    const size_t before = in.size();
    MPI_Probe(rank, TAG, world, &status);
    MPI_Get_count(&status, MPI_DOUBLE, &numbers);
    in.resize(before + numbers);
    MPI_Recv(in.data() + before, numbers, MPI_DOUBLE, rank, TAG, world, &status);
    return numbers;
  }
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

/* Sends every item to the rank that home(item) names, where answer(items), given all that came
 * there, may change them in place; they come back in the order of `mine`. So ranks settle together
 * what none of them knows alone, without a list of all on each. */
template <class T, class Home, class Answer>
void ask_homes(MPI_Comm world, std::vector<T> &mine, const Home &home, const Answer &answer)
{
  constexpr int width = sizeof(T) / sizeof(double);
  static_assert(std::is_trivially_copyable<T>::value && sizeof(T) == width * sizeof(double),
                "travels as so many numbers");
  Post post(world);
  std::vector<size_t> order(mine.size());
  std::vector<int> to(post.ranks, 0);
  for (size_t k = 0; k < mine.size(); k++) {
    order[k] = k;
    to[home(mine[k])]++;
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t p, size_t q) { return home(mine[p]) < home(mine[q]); });
  std::vector<T> out, in;
  for (size_t k : order) out.push_back(mine[k]);
  post.address(to);
  in.resize(post.rows_in());
  post.carry((const double *) out.data(), (double *) in.data(), width);
  answer(in);
  post.reversed().carry((const double *) in.data(), (double *) out.data(), width);
  for (size_t k = 0; k < mine.size(); k++) mine[order[k]] = out[k];
}

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
