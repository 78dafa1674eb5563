/* The near part of a field, block by block: which sources are near, what they do, and where it goes. */
#include "sd_field_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_room.h"

/* --- cells --- */

static int along(const sd_field_cells *c, int d, double x)
{
  const double at = (x - c->lo[d]) * c->inverse;
  return (int) fmax(0.0, fmin(c->n[d] - 1, at));
}

/* Cells of at least this side, and not many more of them than places */
static void near_cut(sd_field_cells *c, const double *x, long stride, int n, double side)
{
  double hi[3], all;
  for (int d = 0; d < 3; d++) {
    hi[d] = c->lo[d] = n > 0 ? x[d] : 0.0;
    for (long i = 1; i < n; i++) {
      c->lo[d] = fmin(c->lo[d], x[stride * i + d]);
      hi[d] = fmax(hi[d], x[stride * i + d]);
    }
  }
  for (c->inverse = side > 0.0 ? 1.0 / side : 0.0;; c->inverse *= 0.7) {
    all = 1.0;
    for (int d = 0; d < 3; d++) all *= floor((hi[d] - c->lo[d]) * c->inverse) + 1.0;
    if (all <= 4.0 * n + 64.0) break;
  }
  for (int d = 0; d < 3; d++) c->n[d] = (int) floor((hi[d] - c->lo[d]) * c->inverse) + 1;
}

int sd_field_sort(sd_field_cells *c, const double *x, long stride, int n, double side)
{
  near_cut(c, x, stride, n, side);
  const size_t all = (size_t) c->n[0] * (size_t) c->n[1] * (size_t) c->n[2];
  if (!sd_reserve(&c->order, sizeof(int), 2 * (size_t) n + 1, &c->order_room) ||
      !sd_reserve(&c->first, sizeof(int), all + 1, &c->first_room))
    return 0;
  int *cell = c->order + n;
  memset(c->first, 0, sizeof(int) * (all + 1));
  for (long i = 0; i < n; i++) {
    cell[i] = 0;
    for (int d = 0; d < 3; d++) cell[i] = cell[i] * c->n[d] + along(c, d, x[stride * i + d]);
    c->first[cell[i]]++;
  }
  for (size_t k = 1; k <= all; k++) c->first[k] += c->first[k - 1];
  for (int i = n - 1; i >= 0; i--) c->order[--c->first[cell[i]]] = i;
  return 1;
}

/* --- blocks --- */

typedef struct {
  const sd_field_cells *c;
  const sd_field_part *p;
  void (*kernel)(const sd_field_part *p, sd_field_block *b);
  sd_near_search *search;
  sd_field_block *block;
  /* columns of the sources in order of cells, and room for ranges and lists of them */
  double *centre;
  int *range, *list;
} blocks;

/* Points first ... first + 7 of each direction, as far as the grid goes; its middle, and half its
 * diagonal */
static double lay_block(const blocks *q, const int *first, double *middle)
{
  const sd_field_part *p = q->p;
  double diagonal = 0.0;
  for (int d = 0; d < 3; d++) {
    const int left = p->points[d] - first[d], points = left < SD_FIELD_BLOCK ? left : SD_FIELD_BLOCK;
    const double size = (points - 1) * p->step[d];
    q->block->lo[d] = p->lo[d] + first[d] * p->step[d];
    q->block->bricks[d] = (points + 1) / 2;
    middle[d] = q->block->lo[d] + 0.5 * size;
    diagonal += size * size;
  }
  return 0.5 * sqrt(diagonal);
}

/* Cells within reach of a place, as ranges of sources; how many */
static int ranges_near(const blocks *q, const double *x, double reach)
{
  const sd_field_cells *c = q->c;
  int from[3], to[3], many = 0;
  for (int d = 0; d < 3; d++) {
    from[d] = along(c, d, x[d] - reach);
    to[d] = along(c, d, x[d] + reach);
  }
  for (int i = from[0]; i <= to[0]; i++)
    for (int j = from[1]; j <= to[1]; j++) {
      const long column = ((long) i * c->n[1] + j) * c->n[2];
      q->range[2 * many] = c->first[column + from[2]];
      q->range[2 * many++ + 1] = c->first[column + to[2] + 1];
    }
  return many;
}

static void sources_near(const blocks *q, const double *x, double reach)
{
  sd_field_block *b = q->block;
  const int ranges = ranges_near(q, x, reach);
  b->n = (int) q->search(q->centre, q->p->n, q->range, ranges, x, reach * reach, q->list);
  for (int k = 0; k < b->n; k++) q->list[k] = q->c->order[q->list[k]];
  b->source = q->list;
}

static void hand_out(const blocks *q, const int *first)
{
  const sd_field_part *p = q->p;
  int end[3];
  for (int d = 0; d < 3; d++) {
    const int left = p->points[d] - first[d];
    end[d] = left < SD_FIELD_BLOCK ? left : SD_FIELD_BLOCK;
  }
  for (int k = 0; k < end[2]; k++)
    for (int j = 0; j < end[1]; j++) {
      const long row = ((long) (first[2] + k) * p->points[1] + first[1] + j) * p->points[0];
      double *u = p->u + 3 * (row + first[0]);
      for (int i = 0; i < end[0]; i++, u += 3) {
        const double(*from)[8] = q->block->u[i / 2 + 4 * (j / 2) + 16 * (k / 2)];
        for (int d = 0; d < 3; d++)
          u[d] += p->unit * from[d][i % 2 + 2 * (j % 2) + 4 * (k % 2)] + p->mean[d];
      }
    }
}

static int near_make_room(sd_field *f, blocks *q)
{
  const sd_field_cells *c = q->c;
  const size_t n = (size_t) q->p->n;
  q->block = aligned_alloc(64, (sizeof(sd_field_block) + 63) / 64 * 64);
  q->range = malloc(2 * sizeof(int) * (size_t) c->n[0] * (size_t) c->n[1]);
  q->list = malloc(sizeof(int) * (n + 8));
  if (!q->block || !q->range || !q->list ||
      !sd_reserve(&f->scratch, sizeof(double), 3 * n + 8, &f->scratch_room))
    return 0;
  q->centre = f->scratch;
  for (size_t k = 0; k < n; k++) {
    const double *x = q->p->source + SD_FIELD_ROW * (size_t) c->order[k];
    for (size_t d = 0; d < 3; d++) q->centre[d * n + k] = x[d];
  }
  for (size_t k = 3 * n; k < 3 * n + 8; k++) q->centre[k] = 0.0;
  return 1;
}

sd_status sd_field_near(sd_field *f, const sd_field_part *p, const struct sd_field_kernels *kernels)
{
  if (!sd_field_sort(&f->cells, p->source, SD_FIELD_ROW, p->n, p->range)) return SD_ENOMEMORY;
  const struct sd_ewald_kernels *ewald = SD_KERNELS_OF(sd_ewald, plain, sd_isa_of(SD_ISA_BEST));
  blocks q = {.c = &f->cells, .p = p, .search = ewald->search};
  q.kernel = f->floats ? kernels->near_floats : kernels->near;
  const int ok = near_make_room(f, &q);
  int first[3];
  for (first[2] = 0; first[2] < p->points[2] && ok; first[2] += SD_FIELD_BLOCK)
    for (first[1] = 0; first[1] < p->points[1]; first[1] += SD_FIELD_BLOCK)
      for (first[0] = 0; first[0] < p->points[0]; first[0] += SD_FIELD_BLOCK) {
        double middle[3];
        const double diagonal = lay_block(&q, first, middle);
        sources_near(&q, middle, p->range + diagonal);
        q.kernel(p, q.block);
        hand_out(&q, first);
      }
  free(q.block);
  free(q.range);
  free(q.list);
  return ok ? SD_OK : SD_ENOMEMORY;
}
