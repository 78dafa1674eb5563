/* Rigid clumps and free spheres in one cloud for the tests of sd_bodies.h: one rank, all pairs. */
#ifndef FLOCK_H
#define FLOCK_H

#include "arms.h"
#include "check.h"

#include "plain.h"

#include "sd_bodies.h"
#include "sd_linear.h"
#include "sd_pose.h"

#include <string.h>

enum { FLOCK_MOST = 400 };

/* Clumps of one shape come first, then free spheres. R [9], c [3] of each body. */
typedef struct {
  int clumps, free, n, m;
  sd_shape shape;
  sd_clump shells;
  sd_body_shape body;
  double eta, a_free;
  double pose[12 * FLOCK_MOST];
  /* rows */
  double x[3 * FLOCK_MOST], a[FLOCK_MOST], w[FLOCK_MOST], drag[FLOCK_MOST], spin[FLOCK_MOST];
  /* for sd_bodies, whose numbers are those of free spheres first */
  int row[FLOCK_MOST], whole[FLOCK_MOST], loner[FLOCK_MOST];
  sd_body clump[FLOCK_MOST];
  double arm[3 * FLOCK_MOST], D[6 * FLOCK_MOST];
  char known[FLOCK_MOST];
  double l[6 * FLOCK_MOST], v[6 * FLOCK_MOST], u[6 * FLOCK_MOST], F[6 * FLOCK_MOST],
      before[6 * FLOCK_MOST], exerted[6 * FLOCK_MOST], velocities[6 * FLOCK_MOST];
  /* V: of the clumps, behind the free spheres' in all_V */
  double all_V[6 * FLOCK_MOST], *V;
  sd_packed packed;
  sd_bodies_report report;
} flock;

/* m spheres at X with radii a; shell 1: none. The poses are the caller's to set. */
static inline flock *flock_create(int m, const double *X, const double *a, int shell, int clumps,
                                  int others, double eta)
{
  flock *f = calloc(1, sizeof(flock));
  f->clumps = clumps, f->free = others, f->n = clumps * m + others, f->m = m;
  f->eta = eta, f->a_free = 1.0;
  assert_true(f->n <= FLOCK_MOST);
  if (clumps > 0) {
    assert_int_equal(sd_shape_create(m, X, a, &f->shape), SD_OK);
    if (shell > 1) {
      sd_clump_options options = SD_CLUMP_OPTIONS;
      sd_shells cache = {0};
      options.shell = shell;
      assert_int_equal(sd_clump_create(&f->shape, &options, &cache, &f->shells, NULL), SD_OK);
      sd_shells_free(&cache);
    }
    assert_int_equal(sd_body_shape_create(&f->shape, shell > 1 ? &f->shells : NULL, &f->body),
                     SD_OK);
  }
  for (int b = 0; b < clumps + others; b++)
    for (int d = 0; d < 3; d++) f->pose[12 * b + 4 * d] = 1.0;
  return f;
}

static inline void flock_free(flock *f)
{
  sd_shape_free(&f->shape);
  sd_clump_free(&f->shells);
  sd_body_shape_free(&f->body);
  sd_packed_free(&f->packed);
  free(f);
}

static inline sd_status flock_apply(void *ctx, const double *F, double *u)
{
  flock *f = ctx;
  sd_packed_share(&f->packed, 0, 1, F, u);
  return SD_OK;
}

/* Spheres where the poses say */
static inline sd_bodies flock_place(flock *f, int width)
{
  const sd_law law = {.tensor = SD_TENSOR_RPY};
  for (int i = 0; i < f->n; i++) {
    const int b = i < f->m * f->clumps ? i / f->m : i - f->m * f->clumps + f->clumps;
    const double *p = f->pose + 12 * b;
    double *x = f->x + 3 * i, origin[3] = {0.0};
    sd_multiply3(p, b < f->clumps ? f->shape.x + 3 * (i % f->m) : origin, x);
    for (int d = 0; d < 3; d++) x[d] += p[9 + d];
    f->a[i] = b < f->clumps ? f->shape.a[i % f->m] : f->a_free;
    f->w[i] = 1.0 / sqrt(f->eta);
    f->drag[i] = 6.0 * SD_PI * f->eta * f->a[i];
    f->spin[i] = 8.0 * SD_PI * f->eta * pow(f->a[i], 3);
    f->row[i] = i;
    f->whole[i] = b < f->clumps ? f->free + b : b - f->clumps;
    for (int d = 0; d < width; d++) f->D[width * i + d] = (d < 3 ? f->drag : f->spin)[i];
  }
  memset(f->arm, 0, sizeof(f->arm));
  for (int b = 0; b < f->clumps; b++) {
    f->clump[b] =
        (sd_body){.shape = &f->body, .a = 1.0, .eta = f->eta, .row = f->row + f->m * b};
    memcpy(f->clump[b].R, f->pose + 12 * b, 9 * sizeof(double));
    arms_of(f->clump + b, f->arm + 3 * f->m * b);
  }
  for (int k = 0; k < f->free; k++) f->loner[k] = f->m * f->clumps + k;
  f->V = f->all_V + 6 * f->free;
  const sd_spheres spheres = {f->x, f->a, f->w};
  assert_int_equal(sd_packed_all(&f->packed, SD_ISA_BEST, &law, &spheres, f->n, width), SD_OK);
  return (sd_bodies){.lone = f->free,
                     .loner = f->loner,
                     .shaped = f->clumps,
                     .body = f->clump,
                     .known = f->known,
                     .spheres = {f->n, width, f->whole, f->arm},
                     .points = {f->n, width, NULL, NULL},
                     .D = f->D,
                     .apply = flock_apply,
                     .apply_ctx = f};
}

static inline sd_status flock_solve(flock *f, const sd_bodies *A, int warm, double tolerance,
                                    int max_iter)
{
  const sd_bodies_problem problem = {f->u, f->F, f->velocities, warm, tolerance, max_iter};
  const sd_bodies_answer answer = {f->l, f->before, f->all_V, f->v, f->exerted};
  double *work = malloc(sizeof(double) * (size_t) sd_bodies_work(A));
  for (long j = 0; j < sd_bodies_work(A); j++) work[j] = NAN; /* nobody may read it */
  const sd_status status = sd_bodies_solve(A, &problem, &answer, work, &f->report);
  free(work);
  return status;
}

static inline sd_status flock_move(flock *f, int width, int warm, double tolerance, int max_iter)
{
  const sd_bodies A = flock_place(f, width);
  return flock_solve(f, &A, warm, tolerance, max_iter);
}

/* A weight on every sphere, along -z */
static inline void flock_weigh(flock *f, double weight)
{
  memset(f->F, 0, sizeof(f->F));
  for (int i = 0; i < f->n; i++) f->F[6 * i + 2] = -weight;
}

/* Clumps at random in a cube, spheres of different clumps at least 0.01 apart, at volume fraction
 * phi */
static inline void flock_scatter(flock *f, double phi, uint64_t seed)
{
  const double side = cbrt(f->n * 4.0 * SD_PI / 3.0 / phi);
  for (int b = 0, tries = 0; b < f->clumps + f->free; tries++) {
    double *p = f->pose + 12 * b, q[4], norm = 0.0, x[3 * FLOCK_MOST];
    assert_true(tries < 1000000);
    for (int d = 0; d < 4; d++) { /* Box and Muller: even over the rotations */
      const double r = sqrt(-2.0 * log(uniform(&seed, 0, 1)));
      q[d] = r * cos(2.0 * SD_PI * uniform(&seed, 0, 1));
      norm += q[d] * q[d];
    }
    norm = sqrt(norm);
    const double angle = 2.0 * acos(q[0] / norm), s = angle / sin(0.5 * angle) / norm;
    const double rotation[3] = {s * q[1], s * q[2], s * q[3]};
    sd_rotation(rotation, p);
    for (int d = 0; d < 3; d++) p[9 + d] = uniform(&seed, 0, side);
    const int m = b < f->clumps ? f->m : 1;
    const int first = b < f->clumps ? b * f->m : f->clumps * f->m + b - f->clumps;
    int apart = 1;
    for (int k = 0; k < m; k++) {
      const double origin[3] = {0.0};
      sd_multiply3(p, b < f->clumps ? f->shape.x + 3 * k : origin, x + 3 * k);
      for (int d = 0; d < 3; d++) x[3 * k + d] += p[9 + d];
      for (int j = 0; j < first && apart; j++) {
        double sq = 0.0;
        for (int d = 0; d < 3; d++) sq += pow(x[3 * k + d] - f->x[3 * j + d], 2);
        apart = sq > 2.01 * 2.01;
      }
    }
    if (!apart) continue;
    memcpy(f->x + 3 * first, x, sizeof(double) * 3 * (size_t) m);
    b++;
  }
}

static inline double flock_distance(const double *a, const double *b, int n)
{
  double sum = 0.0, all = 0.0;
  for (int k = 0; k < n; k++) {
    sum += pow(a[k] - b[k], 2);
    all += b[k] * b[k];
  }
  return sqrt(sum / all);
}

#endif
