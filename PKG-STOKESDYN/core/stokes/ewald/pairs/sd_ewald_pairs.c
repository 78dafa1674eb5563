#include "sd_ewald_pairs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_ewald_groups.h"
#include "sd_ewald_rows.h"
#include "sd_isa.h"
#include "sd_room.h"

void sd_ewald_pairs_create(sd_ewald_pairs *p, const sd_ewald *e,
                           const struct sd_ewald_kernels *kernels, int width)
{
  p->kernels = kernels;
  p->bytes = kernels->bytes;
  p->doubles = p->bytes == sizeof(double) ? kernels : SD_KERNELS_OF(sd_ewald, plain, sd_isa_of(SD_ISA_BEST));
  p->numbers = p->bytes == sizeof(double) ? &sd_ewald_rows_doubles : &sd_ewald_rows_floats;
  p->full = (int) (SD_FULL * sizeof(double) / p->bytes);
  p->ewald = *e;
  p->width = width;
  p->most = width > 3 ? 1 : e->largest == e->a_ref ? kernels->bunch : kernels->bunch_unlike;
  p->unit = 1.0;
  p->degree = sd_near_degree(sd_radial_fit(e, width, p->coefficient[0]));
  sd_radial(e, 0.0, p->origin);
}

void sd_ewald_pairs_free(sd_ewald_pairs *p)
{
  free(p->sphere);
  free(p->target);
  free(p->begin);
  free(p->first);
  free(p->neighbor);
  free(p->memory);
  sd_ewald_cells_free(&p->cells);
  sd_ewald_groups_free(&p->groups);
  memset(p, 0, sizeof(*p));
}

/* --- rows in order of cells --- */

static size_t numbers_of_sum(const sd_ewald_pairs *p)
{
  return p->width == 6 ? 8 : 4;
}

/* The last centres are read in whole vectors. groups: that kernels look at */
static int ep_make_room(sd_ewald_pairs *p, int n, int groups)
{
  const size_t rows = (size_t) n + SD_EMPTY_ROWS, all = (numbers_of_sum(p) + (size_t) p->width) * p->bytes;
  const size_t centre = 3 * sizeof(double), in_rows = 8 * p->bytes * rows;
  const size_t turns = p->width == 6 ? 4 * p->bytes * rows : 0;
  const size_t of_rows = (all > centre ? all : centre) * rows + SD_FULL * sizeof(double);
  const size_t of_groups = 3 * SD_GROUP_LANES * sizeof(float) * (size_t) groups;
  const size_t in_u = of_rows > of_groups ? of_rows : of_groups;
  p->row = sd_reserve_lines(&p->memory, (in_rows + turns + in_u) / sizeof(double) + 1, &p->room);
  if (!p->row || !sd_reserve(&p->sphere, sizeof(int), rows, &p->sphere_room) ||
      !sd_reserve(&p->target, sizeof(int), rows, &p->target_room))
    return 0;
  p->torque_row = turns > 0 ? (char *) p->row + in_rows : NULL;
  p->u = (char *) p->row + in_rows + turns;
  p->waves = (char *) p->u + numbers_of_sum(p) * p->bytes * rows;
  return 1;
}

/* The targets are ours. */
static sd_status sort_spheres(sd_ewald_pairs *p, int n, int n_all)
{
  const sd_status status =
      sd_ewald_cells_sort(&p->cells, p->spheres.x, p->spheres.a, n_all, p->ewald.range, p->turn, p->u);
  if (status != SD_OK) return status;
  if (p->most > 1) sd_ewald_cells_order(&p->cells);
  p->rows = p->cells.rows;
  memcpy(p->sphere, p->cells.place, sizeof(int) * (size_t) p->rows);
  p->n = 0;
  for (int k = 0; k < p->rows; k++)
    if (p->sphere[k] < n) p->target[p->n++] = k;
  return SD_OK;
}

/* The unit of lengths in rows, and whether all radii are a_ref */
static void measure_radii(sd_ewald_pairs *p, int n_all)
{
  double largest = 0.0;
  int unlike = 0;
  for (int i = 0; i < n_all; i++) {
    const double a = p->spheres.a[i];
    largest = a > largest ? a : largest;
    unlike |= a > 0.0 && a != p->ewald.a_ref;
  }
  p->equal = !unlike;
  p->scale = largest > 0.0 ? ldexp(1.0, -ilogb(largest)) : 1.0;
}

/* Spheres may be anywhere in memory: those of the next rows are fetched while these are at work. */
static void fetch_spheres(const sd_ewald_pairs *p, int begin, int end)
{
  for (int k = begin; k < end && k < p->rows; k++) {
    const long i = p->sphere[k];
    sd_fetch(p->spheres.x + 3 * i);
    sd_fetch(p->spheres.x + 3 * i + 2);
    sd_fetch(p->spheres.a + i);
    sd_fetch(p->spheres.w + i);
  }
}

static void stand_rows(sd_ewald_pairs *p)
{
  enum { TOGETHER = 12 };
  for (int begin = 0, end = 0; end < p->rows || begin == 0; begin += TOGETHER) {
    end = begin + TOGETHER < p->rows ? begin + TOGETHER : p->rows;
    fetch_spheres(p, end, end + TOGETHER);
    p->numbers->stand(p, begin, end);
  }
}

/* --- neighbours --- */

/* Of the neighbours of ghosts, from `begin` on, those that are ours; nothing in place of the first, which are of
 * the same bunch. Returns their end. */
static long keep_ours(sd_ewald_pairs *p, int n, long begin, int same, long end)
{
  long ours = begin + same;
  for (long k = ours; k < end; k++) {
    const int row = p->neighbor[k];
    if (row < p->rows && p->sphere[row] < n) p->neighbor[ours++] = row;
  }
  if (ours == begin + same) return begin;
  for (long k = begin; k < begin + same; k++) p->neighbor[k] = p->rows;
  while ((ours - begin) % p->full) p->neighbor[ours++] = p->rows;
  return ours;
}

typedef struct {
  sd_ewald_pairs *pairs;
  int n;
  long many;
} finder;

static int ep_is_ghost(const finder *f, int row)
{
  return f->pairs->sphere[row] >= f->n;
}

/* Ghosts and spheres of ours are bunches of their own: nobody wants pairs of ghosts. */
static sd_status visit_bunch(void *ctx, int row, int end, int ranges, long room)
{
  finder *f = ctx;
  sd_ewald_pairs *p = f->pairs;
  for (int next; row < end; row = next) {
    const int ghosts = ep_is_ghost(f, row);
    for (next = row + 1; next < end && ep_is_ghost(f, next) == ghosts;) next++;
    if (!sd_extend(&p->neighbor, sizeof(int), (size_t) (f->many + room + 3 * SD_FULL), &p->neighbor_room))
      return SD_ENOMEMORY;
    p->begin[p->bunches] = row;
    p->first[p->bunches++] = f->many;
    p->cells.range[0] = row + 1;
    const long last = sd_ewald_pairs_near(p, row, next, ranges, p->cells.range, f->many);
    f->many = ghosts ? keep_ours(p, f->n, f->many, next - row - 1, last) : last;
  }
  return SD_OK;
}

static sd_status find_bunches(sd_ewald_pairs *p, int n)
{
  finder f = {p, n, 0};
  p->bunches = 0;
  const sd_status status = sd_ewald_cells_walk(&p->cells, p->most, visit_bunch, &f);
  p->begin[p->bunches] = p->rows;
  p->first[p->bunches] = f.many;
  return status;
}

sd_status sd_ewald_pairs_place(sd_ewald_pairs *p, const sd_spheres *s, const sd_groups *groups, int n,
                               int n_all, int turn)
{
  const int grouped = sd_ewald_groups_serve(p, groups);
  p->spheres = *s;
  p->turn = turn;
  if (!grouped) p->groups.reach = 0.0; /* the rows will be others */
  p->by_groups = grouped && p->kernels->near_groups;
  if (!ep_make_room(p, n_all, p->by_groups ? groups->n : 0)) return SD_ENOMEMORY;
  measure_radii(p, n_all);
  sd_status status = grouped ? sd_ewald_groups_sort(p, groups, n) : sort_spheres(p, n, n_all);
  if (status != SD_OK) return status;
  if (!grouped) stand_rows(p);
  p->groups.own = 0;
  if (!p->by_groups && (!sd_reserve(&p->begin, sizeof(int), (size_t) p->rows + 1, &p->begin_room) ||
                        !sd_reserve(&p->first, sizeof(long), (size_t) p->rows + 1, &p->first_room)))
    return SD_ENOMEMORY;
  status = grouped ? sd_ewald_groups_find(p, groups, n) : find_bunches(p, n);
  return status == SD_OK && grouped ? sd_ewald_groups_make_blocks(p, groups, n) : status;
}

/* --- product --- */

/* For forces whose sizes have this sum, so that all are at most 1; where floats hold them anyway, 1, which
 * leaves their digits alone. */
static double ep_unit(double sizes)
{
  enum { HELD = 60 };
  if (!(sizes > 0.0 && sizes < INFINITY)) return 1.0;
  const int power = ilogb(sizes);
  return abs(power) <= HELD ? 1.0 : ldexp(1.0, power < -1022 ? 1022 : -power);
}

sd_status sd_ewald_pairs_load(sd_ewald_pairs *p, int n, const double *F, const double *ghosts,
                              const sd_world *world, double *sums)
{
  double own[SD_EWALD_SUMS];
  p->unit = 1.0;
  p->numbers->load(p, n, F, ghosts, own);
  if (!sums) return SD_OK;
  memcpy(sums, own, sizeof(own));
  const sd_status status = sd_world_sum(world, sums, SD_EWALD_SUMS);
  if (status != SD_OK || p->bytes == sizeof(double)) return status;
  p->unit = ep_unit(sums[SD_EWALD_SIZES]);
  if (p->unit != 1.0) p->numbers->load(p, n, F, ghosts, own);
  return SD_OK;
}

void sd_ewald_pairs_apply(sd_ewald_pairs *p)
{
  const sd_near_part k = sd_ewald_pairs_part(p);
  memset(p->u, 0, p->bytes * numbers_of_sum(p) * ((size_t) p->rows + SD_EMPTY_ROWS));
  if (p->by_groups) {
    const sd_near_groups groups = sd_ewald_groups_near(p);
    p->kernels->near_groups(&k, &groups);
  } else
    p->kernels->near_part(&k);
}

void *sd_ewald_pairs_rows(sd_ewald_pairs *p)
{
  p->numbers->of_targets(p, p->waves);
  return p->waves;
}

void sd_ewald_pairs_take(const sd_ewald_pairs *p, int n, const double *F, const void *rows,
                         const double *tail, const double *sums, double *u)
{
  if (p->n < n) memset(u, 0, sizeof(double) * (size_t) p->width * (size_t) n); /* some have no radius */
  enum { TOGETHER = 8 };    /* so few that their velocities are still in the cache when their blocks follow */
  const sd_ewald_groups *g = &p->groups;
  long done = 0;
  for (int k = 0; k < g->own; k += TOGETHER) {
    const int end = g->own - k < TOGETHER ? g->own : k + TOGETHER;
    p->numbers->take(p, done, g->end[end - 1], rows, tail, sums, u);
    done = g->end[end - 1];
    sd_ewald_groups_apply(p, k, end, F, u);
  }
  p->numbers->take(p, done, p->n, rows, tail, sums, u);
}

void sd_ewald_pairs_of_ghosts(const sd_ewald_pairs *p, int n, int n_all, double *u)
{
  memset(u, 0, sizeof(double) * (size_t) p->width * (size_t) (n_all - n)); /* some have no radius */
  p->numbers->of_ghosts(p, n, u);
}
