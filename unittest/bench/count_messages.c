/* Counts what the ranks of a program say to each other, and prints it when it ends: of the ranks the
 * most messages, bytes, partners and collective calls. Between the program and MPI by LD_PRELOAD. */
#include <mpi.h>
#include <stdio.h>
#include <string.h>

enum { MESSAGES, BYTES, COLLECTIVES, COLLECTIVE_BYTES, PARTNERS, COUNTS, MOST_RANKS = 4096 };
static double counted[COUNTS];
static char partner[MOST_RANKS];

static double bytes_of(double count, MPI_Datatype type)
{
  int size;
  PMPI_Type_size(type, &size);
  return count * size;
}

static void sent(double count, MPI_Datatype type, int to)
{
  counted[MESSAGES]++;
  counted[BYTES] += bytes_of(count, type);
  if (to >= 0 && to < MOST_RANKS) partner[to] = 1;
}

static void together(double count, MPI_Datatype type)
{
  counted[COLLECTIVES]++;
  counted[COLLECTIVE_BYTES] += bytes_of(count, type);
}

int MPI_Send(const void *b, int n, MPI_Datatype t, int to, int tag, MPI_Comm c)
{
  sent(n, t, to);
  return PMPI_Send(b, n, t, to, tag, c);
}

int MPI_Isend(const void *b, int n, MPI_Datatype t, int to, int tag, MPI_Comm c, MPI_Request *r)
{
  sent(n, t, to);
  return PMPI_Isend(b, n, t, to, tag, c, r);
}

int MPI_Allreduce(const void *s, void *r, int n, MPI_Datatype t, MPI_Op op, MPI_Comm c)
{
  together(n, t);
  return PMPI_Allreduce(s, r, n, t, op, c);
}

int MPI_Allgather(const void *s, int n, MPI_Datatype t, void *r, int m, MPI_Datatype u, MPI_Comm c)
{
  together(n, t);
  return PMPI_Allgather(s, n, t, r, m, u, c);
}

int MPI_Allgatherv(const void *s, int n, MPI_Datatype t, void *r, const int *m, const int *at,
                   MPI_Datatype u, MPI_Comm c)
{
  together(n, t);
  return PMPI_Allgatherv(s, n, t, r, m, at, u, c);
}

int MPI_Alltoall(const void *s, int n, MPI_Datatype t, void *r, int m, MPI_Datatype u, MPI_Comm c)
{
  int ranks;
  PMPI_Comm_size(c, &ranks);
  together((double) n * ranks, t);
  return PMPI_Alltoall(s, n, t, r, m, u, c);
}

int MPI_Alltoallv(const void *s, const int *n, const int *at, MPI_Datatype t, void *r, const int *m,
                  const int *from, MPI_Datatype u, MPI_Comm c)
{
  int ranks;
  double all = 0.0;
  PMPI_Comm_size(c, &ranks);
  for (int p = 0; p < ranks; p++) all += n[p];
  together(all, t);
  return PMPI_Alltoallv(s, n, at, t, r, m, from, u, c);
}

int MPI_Finalize(void)
{
  double most[COUNTS];
  int me;
  PMPI_Comm_rank(MPI_COMM_WORLD, &me);
  for (int p = 0; p < MOST_RANKS; p++) counted[PARTNERS] += p != me && partner[p];
  PMPI_Reduce(counted, most, COUNTS, MPI_DOUBLE, MPI_MAX, 0, MPI_COMM_WORLD);
  if (me == 0)
    printf("COUNTED %.0f %.0f %.0f %.0f %.0f\n", most[MESSAGES], most[BYTES], most[COLLECTIVES],
           most[COLLECTIVE_BYTES], most[PARTNERS]);
  return PMPI_Finalize();
}
