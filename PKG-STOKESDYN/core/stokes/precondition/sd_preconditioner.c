#include "sd_preconditioner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double FAR = 0.5;

static void drop(sd_preconditioner *p)
{
  if (p->state) p->kind->free(p->state);
  free(p->state);
  p->state = NULL;
}

void sd_preconditioner_free(sd_preconditioner *p)
{
  drop(p);
  free(p->x);
  free(p->first);
  free(p->member);
  free(p->one);
  free(p->scratch);
  memset(p, 0, sizeof(*p));
}

/* What waves are made of; 0: no box */
static void edges_of(const sd_precondition_case *c, double edges[6])
{
  memset(edges, 0, 6 * sizeof(double));
  if (!c->box) return;
  memcpy(edges, c->box->edge, 3 * sizeof(double));
  memcpy(edges + 3, c->box->tilt, 3 * sizeof(double));
}

static int made_of(const sd_preconditioner *p, const sd_precondition_kind *kind,
                   const sd_precondition_case *c)
{
  const size_t n = (size_t) c->n, clumps = (size_t) c->clumps;
  double edges[6];
  edges_of(c, edges);
  return p->state && p->wanted == kind && p->n == c->n && p->width == c->width &&
      p->clumps == c->clumps && !memcmp(p->edges, edges, sizeof(edges)) &&
      (n == 0 || (!memcmp(p->x, c->spheres.x, 3 * n * sizeof(double)) &&
                  !memcmp(p->x + 3 * n, c->spheres.a, n * sizeof(double)))) &&
      (clumps == 0 ||
       (!memcmp(p->first, c->first, (clumps + 1) * sizeof(long)) &&
        !memcmp(p->member, c->member, (size_t) c->first[clumps] * sizeof(int))));
}

static sd_status copy(sd_preconditioner *p, const sd_precondition_kind *kind,
                      const sd_precondition_case *c)
{
  const size_t n = (size_t) c->n, clumps = (size_t) c->clumps;
  const size_t members = clumps ? (size_t) c->first[clumps] : 0;
  sd_preconditioner_free(p);
  p->kind = p->wanted = kind;
  p->n = c->n;
  p->width = c->width;
  p->clumps = c->clumps;
  edges_of(c, p->edges);
  p->x = malloc(sizeof(double) * (4 * n + 1));
  p->first = calloc(clumps + 1, sizeof(long));
  p->member = malloc(sizeof(int) * (members + 1));
  p->one = malloc(sizeof(double) * (n + 1));
  p->scratch = malloc(sizeof(double) * ((size_t) c->width * n + 1));
  p->state = calloc(1, kind->size);
  if (!p->x || !p->first || !p->member || !p->one || !p->scratch || !p->state) return SD_ENOMEMORY;
  if (n) memcpy(p->x, c->spheres.x, 3 * n * sizeof(double));
  if (n) memcpy(p->x + 3 * n, c->spheres.a, n * sizeof(double));
  if (clumps) memcpy(p->first, c->first, (clumps + 1) * sizeof(long));
  if (clumps) memcpy(p->member, c->member, members * sizeof(int));
  for (size_t i = 0; i < n; i++) p->one[i] = 1.0;
  return SD_OK;
}

/* D: blocks without a clump. It stands in the place of what could not be made, and is tried again
 * only when that would be made of something else. */
static sd_status make_diagonal(sd_preconditioner *p, sd_precondition_case alone)
{
  static const long first[1] = {0};
  alone.clumps = 0;
  alone.first = first;
  free(p->state);
  p->kind = &sd_precondition_blocks;
  p->state = calloc(1, p->kind->size);
  const sd_status status = sd_world_agree(&alone.world, p->state ? SD_OK : SD_ENOMEMORY);
  return status == SD_OK ? p->kind->make(p->state, &alone) : status;
}

sd_status sd_preconditioner_make(sd_preconditioner *p, const sd_precondition_kind *kind,
                                 const sd_precondition_case *c)
{
  double others = !made_of(p, kind, c);
  sd_status status = sd_world_sum(&c->world, &others, 1);
  if (status != SD_OK || others == 0.0) return status;
  status = sd_world_agree(&c->world, copy(p, kind, c));
  if (status == SD_OK) {
    sd_precondition_case own = *c;
    own.spheres = (sd_spheres){p->x, p->x + 3 * (size_t) p->n, p->one};
    own.first = p->first;
    own.member = p->member;
    status = kind->make(p->state, &own);
    if (status != SD_OK) status = make_diagonal(p, own);
  }
  if (status != SD_OK) sd_preconditioner_free(p);
  return status;
}

sd_status sd_preconditioner_apply(sd_preconditioner *p, const double *w, const double *r, double *z)
{
  const long width = p->width, size = width * p->n;
  for (long j = 0; j < size; j++)
    p->scratch[j] = w[j / width] > 0.0 ? r[j] / w[j / width] : 0.0;
  const sd_status status = p->kind->apply(p->state, p->scratch, z);
  for (long j = 0; j < size && status == SD_OK; j++)
    z[j] = w[j / width] > 0.0 ? z[j] / w[j / width] : 0.0;
  return status;
}

void sd_moved_add(double sums[SD_MOVED], const double d[3], double a)
{
  sums[0]++;
  for (int k = 0; k < 3; k++) {
    sums[1 + k] += d[k];
    sums[4] += d[k] * d[k];
  }
  sums[5] += a * a;
}

/* sum |d - mean d|^2 = sum d.d - |sum d|^2/n */
int sd_moved_too_far(const double s[SD_MOVED])
{
  const double common = s[1] * s[1] + s[2] * s[2] + s[3] * s[3];
  return s[0] > 0.0 && s[4] - common / s[0] > FAR * FAR * s[5];
}
