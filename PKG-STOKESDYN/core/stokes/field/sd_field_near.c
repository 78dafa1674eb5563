/* The near part of a field, block by block: which sources are near, what they do, and where it goes. */
#include "sd_field_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
  const sd_ewald_cells *c;
  const sd_field_part *p;
  /* of the lengths of the part */
  double scale;
  void (*kernel)(const sd_field_part *p, sd_field_block *b);
  sd_near_search *search;
  sd_field_block *block;
  /* room for ranges and lists of sources */
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

static int along(const sd_ewald_cells *c, int d, double x)
{
  const double at = (x - c->lo[d]) * c->inverse;
  return (int) fmax(0.0, fmin(c->n[d] - 1, at));
}

/* Cells within reach of a place, as ranges of sources; how many */
static int ranges_near(const blocks *q, const double *x, double reach)
{
  const sd_ewald_cells *c = q->c;
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

static void sources_near(const blocks *q, const double *middle, double reach)
{
  sd_field_block *b = q->block;
  const double x[3] = {middle[0] / q->scale, middle[1] / q->scale, middle[2] / q->scale};
  const double within = reach / q->scale;
  const sd_near_ranges cells = {q->c->centre, q->c->rows, q->range, ranges_near(q, x, within)};
  b->n = (int) q->search(&cells, x, 1, within * within, q->list);
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

static int near_make_room(blocks *q)
{
  const sd_ewald_cells *c = q->c;
  q->block = aligned_alloc(64, (sizeof(sd_field_block) + 63) / 64 * 64);
  q->range = malloc(2 * sizeof(int) * (size_t) c->n[0] * (size_t) c->n[1]);
  q->list = malloc(sizeof(int) * ((size_t) c->rows + SD_FULL));
  return q->block && q->range && q->list;
}

sd_status sd_field_near(sd_field *f, const sd_field_part *p, const struct sd_field_kernels *kernels)
{
  const struct sd_ewald_kernels *ewald = SD_KERNELS_OF(sd_ewald, plain, sd_isa_of(SD_ISA_BEST));
  blocks q = {.c = &f->cells, .p = p, .scale = f->how.scale, .search = ewald->search};
  q.kernel = f->floats ? kernels->near_floats : kernels->near;
  const int ok = near_make_room(&q);
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
