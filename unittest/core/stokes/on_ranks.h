/* Several ranks in a test: processes that exchange through shared memory what MPI would carry. Include it first. */
#ifndef ON_RANKS_H
#define ON_RANKS_H

#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif

#include "check.h"

#include "sd_world.h"

#include <pthread.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

enum { RANKS_SPHERES = 400, RANKS_WIDEST = 64, RANKS_MOST = 4, RANKS_MESSAGE = 2000000, RANKS_SUM = 4096 };

/* What all processes see: rows by the number of their sphere */
typedef struct {
  pthread_barrier_t barrier;
  double F[RANKS_WIDEST * RANKS_SPHERES], u[6 * RANKS_SPHERES], sum[RANKS_MOST][RANKS_SUM],
  message[RANKS_MOST][RANKS_MESSAGE];
  int count[RANKS_MOST][RANKS_MOST], failed;
} shared;

/* A rank: its own spheres first, then ghosts of the others and images, each with the number of its sphere; in all
   `total` */
typedef struct {
  shared *all;
  int me, ranks, n, n_all, total;
  int *number;
} rank;

static inline void rank_meet(const rank *r)
{
  pthread_barrier_wait(&r->all->barrier);
}

static inline sd_status rank_refresh(void *ctx, const double *rows, double *ghosts, int width)
{
  const rank *r = ctx;
  for (int i = 0; i < r->n; i++)
    memcpy(r->all->F + width * r->number[i], rows + width * i, sizeof(double) * (size_t) width);
  rank_meet(r);
  for (int i = r->n; i < r->n_all; i++)
    memcpy(ghosts + width * (i - r->n), r->all->F + width * r->number[i], sizeof(double) * (size_t) width);
  rank_meet(r);
  return SD_OK;
}

/* Back: rows += those of their ghosts on all ranks */
static inline sd_status rank_reduce(void *ctx, const double *ghosts, double *rows, int width)
{
  const rank *r = ctx;
  memset(r->all->message[r->me], 0, sizeof(double) * (size_t) (width * RANKS_SPHERES));
  for (int i = r->n; i < r->n_all; i++)
    for (int d = 0; d < width; d++) r->all->message[r->me][width * r->number[i] + d] += ghosts[width * (i - r->n) + d];
  rank_meet(r);
  for (int p = 0; p < r->ranks; p++)
    for (int i = 0; i < r->n; i++)
      for (int d = 0; d < width; d++) rows[width * i + d] += r->all->message[p][width * r->number[i] + d];
  rank_meet(r);
  return SD_OK;
}

static inline sd_status rank_spread(void *ctx, const double *rows, double *all, int width)
{
  const rank *r = ctx;
  for (int i = 0; i < r->n; i++)
    memcpy(r->all->F + width * r->number[i], rows + width * i, sizeof(double) * (size_t) width);
  rank_meet(r);
  memcpy(all, r->all->F, sizeof(double) * (size_t) (width * r->total));
  rank_meet(r);
  return SD_OK;
}

static inline sd_status rank_collect(void *ctx, const double *all, double *rows, int width)
{
  const rank *r = ctx;
  memcpy(r->all->message[r->me], all, sizeof(double) * (size_t) (width * r->total));
  rank_meet(r);
  memset(rows, 0, sizeof(double) * (size_t) (width * r->n));
  for (int p = 0; p < r->ranks; p++)
    for (int i = 0; i < r->n; i++)
      for (int d = 0; d < width; d++) rows[width * i + d] += r->all->message[p][width * r->number[i] + d];
  rank_meet(r);
  return SD_OK;
}

static inline sd_status rank_sum(void *ctx, double *values, int count)
{
  const rank *r = ctx;
  if (count > RANKS_SUM) r->all->failed = 1;
  memcpy(r->all->sum[r->me], values, sizeof(double) * (size_t) count);
  r->all->count[r->me][0] = count;
  rank_meet(r);
  if (count != r->all->count[0][0]) r->all->failed = 1;
  for (int k = 0; k < count; k++) {
    values[k] = 0.0;
    for (int p = 0; p < r->ranks; p++) values[k] += r->all->sum[p][k];
  }
  rank_meet(r);
  return SD_OK;
}

static inline sd_status rank_exchange(void *ctx, const double *send, const int *to, double *receive, const int *from)
{
  const rank *r = ctx;
  size_t many = 0;
  for (int p = 0; p < r->ranks; p++) many += (size_t) to[p];
  if (many > RANKS_MESSAGE) r->all->failed = 1;
  else memcpy(r->all->message[r->me], send, sizeof(double) * many);
  memcpy(r->all->count[r->me], to, sizeof(int) * (size_t) r->ranks);
  rank_meet(r);
  for (int p = 0; p < r->ranks; p++) {
    size_t before = 0;
    for (int q = 0; q < r->me; q++) before += (size_t) r->all->count[p][q];
    if (r->all->count[p][r->me] != from[p] || (p == r->me && from[p] != 0)) r->all->failed = 1;
    memcpy(receive, r->all->message[p] + before, sizeof(double) * (size_t) from[p]);
    receive += from[p];
  }
  rank_meet(r);
  return SD_OK;
}

static inline sd_status rank_tell(void *ctx, const int *to, int *from)
{
  const rank *r = ctx;
  memcpy(r->all->count[r->me], to, sizeof(int) * (size_t) r->ranks);
  rank_meet(r);
  for (int p = 0; p < r->ranks; p++) from[p] = r->all->count[p][r->me];
  rank_meet(r);
  return SD_OK;
}

static inline sd_world rank_world(rank *r)
{
  return (sd_world){.ctx = r, .me = r->me, .ranks = r->ranks, .refresh = rank_refresh, .reduce = rank_reduce, .sum =
      rank_sum,
                    .spread = rank_spread, .collect = rank_collect, .exchange = rank_exchange, .tell = rank_tell};
}

/* What all processes see and can write; zero, munmap in the end */
static inline void *ranks_memory(size_t bytes)
{
  return mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
}

/* work(r, ctx) on each of the ranks, all of which must end well; munmap what comes back. */
static inline shared *on_ranks(int ranks, void (*work)(rank *r, const void *ctx), const void *ctx)
{
  shared *all = ranks_memory(sizeof(shared));
  pthread_barrierattr_t attribute;
  pthread_barrierattr_init(&attribute);
  pthread_barrierattr_setpshared(&attribute, PTHREAD_PROCESS_SHARED);
  pthread_barrier_init(&all->barrier, &attribute, (unsigned) ranks);
  pid_t child[RANKS_MOST];
  for (int p = 0; p < ranks; p++) {
    child[p] = fork();
    if (child[p] == 0) {
      alarm(900); /* a rank that waits for one that has died; not one that others leave no core */
      rank r = {.all = all, .me = p, .ranks = ranks};
      work(&r, ctx);
      _exit(0);
    }
  }
  for (int p = 0; p < ranks; p++) {
    int status;
    waitpid(child[p], &status, 0);
    assert_int_equal(status, 0);
  }
  assert_int_equal(all->failed, 0);
  return all;
}

#endif
