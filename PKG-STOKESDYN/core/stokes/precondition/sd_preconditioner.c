#include "sd_preconditioner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_hash.h"

static const double FAR = 0.5;

static const long nobody[1] = {0};

void sd_preconditioner_free(sd_preconditioner *p)
{
  if (p->state) p->kind->free(p->state);
  free(p->state);
  free(p->scratch);
  memset(p, 0, sizeof(*p));
}

/* Eight bytes at a time, each of them with all before it */
static uint64_t preconditioner_hash(uint64_t before, const void *from, size_t bytes)
{
  for (size_t at = 0; at < bytes; at += 8) {
    uint64_t word = 0;
    memcpy(&word, (const char *) from + at, bytes - at < 8 ? bytes - at : 8);
    before = sd_hash_mix(before + SD_HASH_STEP) ^ word;
  }
  return sd_hash_mix(before);
}

/* Two cases of one hash are the same but for one in 2^64. */
static uint64_t fingerprint(const sd_precondition_case *c)
{
  const size_t n = (size_t) c->n, clumps = (size_t) c->clumps;
  const int sizes[3] = {c->n, c->width, c->clumps};
  uint64_t h = preconditioner_hash(0, sizes, sizeof(sizes));
  h = preconditioner_hash(h, c->spheres.x, 3 * n * sizeof(double));
  h = preconditioner_hash(h, c->spheres.a, n * sizeof(double));
  if (c->box) h = preconditioner_hash(h, c->box->edge, sizeof(c->box->edge));
  if (c->box) h = preconditioner_hash(h, c->box->tilt, sizeof(c->box->tilt));
  if (clumps == 0) return h;
  h = preconditioner_hash(h, c->first, (clumps + 1) * sizeof(long));
  return preconditioner_hash(h, c->member, (size_t) c->first[clumps] * sizeof(int));
}

static sd_status pr_begin(sd_preconditioner *p, const sd_precondition_kind *kind,
                       const sd_precondition_case *c, uint64_t made_of)
{
  sd_preconditioner_free(p);
  *p = (sd_preconditioner){.wanted = kind,
                           .kind = kind,
                           .state = calloc(1, kind->size),
                           .made_of = made_of,
                           .n = c->n,
                           .width = c->width};
  p->scratch = malloc(sizeof(double) * ((size_t) c->width * (size_t) c->n + 1));
  return p->state && p->scratch ? SD_OK : SD_ENOMEMORY;
}

/* D: blocks without a clump. It stands in the place of what could not be made, and is tried again
 * only when that would be made of something else. */
static sd_status make_diagonal(sd_preconditioner *p, sd_precondition_case alone)
{
  alone.clumps = 0;
  alone.first = nobody;
  free(p->state);
  p->kind = &sd_precondition_blocks;
  p->state = calloc(1, p->kind->size);
  const sd_status status = sd_world_agree(&alone.world, p->state ? SD_OK : SD_ENOMEMORY);
  return status == SD_OK ? p->kind->make(p->state, &alone) : status;
}

/* Of viscosity 1: w of all spheres is 1, for which the scratch is free. */
sd_status sd_preconditioner_make(sd_preconditioner *p, const sd_precondition_kind *kind,
                                 const sd_precondition_case *c)
{
  const uint64_t made_of = fingerprint(c);
  double others = !(p->state && p->wanted == kind && p->made_of == made_of);
  sd_status status = sd_world_sum(&c->world, &others, 1);
  if (status != SD_OK || others == 0.0) return status;
  status = sd_world_agree(&c->world, pr_begin(p, kind, c, made_of));
  if (status == SD_OK) {
    sd_precondition_case own = *c;
    for (int i = 0; i < c->n; i++) p->scratch[i] = 1.0;
    own.spheres.w = p->scratch;
    if (c->clumps == 0) own.first = nobody;
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
double sd_moved_far(const double s[SD_MOVED])
{
  const double common = s[1] * s[1] + s[2] * s[2] + s[3] * s[3];
  return s[0] > 0.0 ? sqrt(fmax(s[4] - common / s[0], 0.0) / s[5]) : 0.0;
}

int sd_moved_too_far(const double s[SD_MOVED])
{
  return sd_moved_far(s) > FAR;
}
