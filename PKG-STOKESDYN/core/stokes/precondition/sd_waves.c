#include "sd_waves.h"

#include <stdlib.h>
#include <string.h>

#include "sd_linear.h"
#include "sd_precondition_internal.h"

/* Part of the diagonal that is left when the long waves are taken out of it: 0.5 to 0.7 need about
 * the same iterations from phi 0.01 to 0.45. */
static const double ALPHA = 0.6;

static const struct sd_waves_kernels *kernels(void)
{
  return SD_KERNELS_OF(sd_waves, plain, sd_isa_of(SD_ISA_BEST));
}

/* --- G ---------------------------------------------------------------------------------------- */

/* Spheres whose rows are in memory at once, if there are no larger clumps */
enum { AT_ONCE = 32 };

/* Spheres by themselves: D^1/2 Z of so many of them, and its product with itself. With parts each
 * takes its share of them. */
static void add_lone(const sd_waves *p, int part, int parts, double *rows, double *G)
{
  const int width = p->width;
  int sphere[AT_ONCE], count = 0;
  for (long i = part; i < p->n; i += parts) {
    if (p->near.lone[i]) sphere[count++] = (int) i;
    if (count < AT_ONCE && i + parts < p->n) continue;
    kernels()->rows(p, sphere, count, rows);
    for (int r = 0; r < width * count; r++)
      for (int c = 0; c < SD_WAVES_COLUMNS; c++)
        rows[SD_WAVES_COLUMNS * (long) r + c] *=
            p->near.root[2 * (long) sphere[r / width] + (r % width >= 3)];
    sd_add_gram(SD_WAVES_COLUMNS, width * count, rows, rows, G);
    count = 0;
  }
}

/* Clumps: Z and B Z of one after the other */
static void add_clumps(const sd_waves *p, double *rows, double *G)
{
  const sd_blocks *b = &p->near;
  for (int k = b->part; k < b->blocks; k += b->parts) {
    const int m = (int) (b->first[k + 1] - b->first[k]), size = p->width * m;
    double *product = rows + SD_WAVES_COLUMNS * (long) size;
    kernels()->rows(p, b->member + b->first[k], m, rows);
    sd_blocks_multiply(b, k, SD_WAVES_COLUMNS, rows, product);
    sd_add_gram(SD_WAVES_COLUMNS, size, rows, product, G);
  }
}

/* Columns that only fill up get unity. A viscosity has gone into D and w alike: B Z is theirs. */
static void add_strengths(const sd_waves *p, double *G)
{
  for (int c = 0; c < SD_WAVES_COLUMNS; c++) {
    const double E = p->list.strength[c % SD_WAVES_PADDED];
    G[(SD_WAVES_COLUMNS + 1) * (long) c] += E > 0.0 ? ALPHA / E : 1.0;
  }
}

static long wp_largest_block(const sd_blocks *b)
{
  long largest = AT_ONCE;
  for (int k = 0; k < b->blocks; k++)
    if (b->first[k + 1] - b->first[k] > largest) largest = b->first[k + 1] - b->first[k];
  return largest;
}

/* G of all ranks on each of them, and its factor there: the sums have the same bits everywhere, so
 * the factors have too. */
static sd_status factorize(sd_waves *p, const sd_precondition_case *c)
{
  const size_t matrix = (size_t) SD_WAVES_COLUMNS * SD_WAVES_COLUMNS;
  const size_t rows = (size_t) p->width * (size_t) wp_largest_block(&p->near);
  double *row = malloc(sizeof(double) * 2 * SD_WAVES_COLUMNS * rows);
  p->factor = calloc(matrix, sizeof(double));
  sd_status status = sd_world_agree(&c->world, row && p->factor ? SD_OK : SD_ENOMEMORY);
  if (status == SD_OK) {
    add_lone(p, c->part, c->parts, row, p->factor);
    add_clumps(p, row, p->factor);
    status = sd_world_sum(&c->world, p->factor, (int) matrix);
  }
  if (status == SD_OK) {
    add_strengths(p, p->factor);
    status = sd_cholesky(SD_WAVES_COLUMNS, p->factor);
  }
  free(row);
  return status;
}

/* --- the preconditioner ----------------------------------------------------------------------- */

/* Places along the edges, as phases */
static sd_status set_places(sd_waves *p, const sd_precondition_case *c)
{
  double G[3][3];
  int sound = 1;
  sd_ewald_reciprocal(c->box, G);
  p->phase = malloc(sizeof(double) * (6 * (size_t) c->n + 1));
  p->size = malloc(sizeof(double) * (2 * (size_t) c->n + 1));
  p->scratch = malloc(sizeof(double) * ((size_t) c->width * (size_t) c->n + 1));
  if (!p->phase || !p->size || !p->scratch) return SD_ENOMEMORY;
  for (long i = 0; i < c->n; i++) {
    const int active = c->spheres.a[i] > 0.0;
    double r[3] = {0.0, 0.0, 0.0};
    if (active) sd_minus(c->spheres.x + 3 * i, c->box->origin, r);
    for (int d = 0; d < 3; d++) {
      const double t = sd_dot(G[d], r);
      sound = sound && isfinite(t);
      p->phase[6 * i + 2 * d] = cos(t);
      p->phase[6 * i + 2 * d + 1] = sin(t);
    }
    p->size[2 * i] = active ? c->spheres.a[i] : 0.0;
    p->size[2 * i + 1] = active ? c->spheres.w[i] : 0.0;
  }
  return sound ? SD_OK : SD_ENOTFINITE;
}

/* Ranks agree before every step that sums, so that none waits for one that has given up. */
sd_status sd_waves_make(void *waves, const sd_precondition_case *c)
{
  sd_waves *p = waves;
  static const long none[1] = {0};
  sd_precondition_case near = *c;
  if (c->clumps == 0) near.first = none;
  p->n = c->n;
  p->width = c->width;
  p->world = c->world;
  p->harmonics = sd_wave_list_of(c->box, &p->list);
  sd_status status = p->harmonics < 0 ? SD_ENOMEMORY : SD_OK;
  if (status == SD_OK && p->harmonics > 0) status = set_places(p, c);
  status = sd_world_agree(&c->world, status);
  if (status == SD_OK) status = sd_blocks_make(&p->near, &near);
  if (status == SD_OK && p->harmonics > 0) status = factorize(p, c);
  if (status != SD_OK) sd_waves_free(p);
  return status;
}

void sd_waves_free(void *waves)
{
  sd_waves *p = waves;
  sd_blocks_free(&p->near);
  free(p->phase);
  free(p->size);
  free(p->factor);
  free(p->scratch);
  *p = (sd_waves){0};
}

/* B Z y = B (Z y), so P r = B (r - Z G^-1 Z^T B r)/alpha: twice B, once forth and once back through
 * Z. With parts B r is a share, and so is Z^T B r, which is summed; the second B makes a share of
 * what is then the same in all parts. */
sd_status sd_waves_apply(void *ctx, const double *r, double *z)
{
  sd_waves *p = ctx;
  const long size = (long) p->width * p->n;
  double y[SD_WAVES_COLUMNS];
  sd_status status = sd_blocks_apply(&p->near, r, z);
  if (status != SD_OK || p->harmonics == 0) return status;
  kernels()->multiply(p, z, y);
  status = sd_world_sum(&p->world, y, SD_WAVES_COLUMNS);
  if (status != SD_OK) return status;
  sd_cholesky_apply(SD_WAVES_COLUMNS, p->factor, 1, y);
  memcpy(p->scratch, r, sizeof(double) * (size_t) size);
  kernels()->subtract(p, y, p->scratch);
  status = sd_blocks_apply(&p->near, p->scratch, z);
  for (long j = 0; j < size; j++) z[j] /= ALPHA;
  return status;
}

const sd_precondition_kind sd_precondition_waves = {sizeof(sd_waves), sd_waves_make, sd_waves_apply,
                                                    sd_waves_free};
