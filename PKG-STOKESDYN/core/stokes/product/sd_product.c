#include "sd_product.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "sd_linear.h"
#include "sd_product_internal.h"
#include "sd_real.h"
#include "sd_room.h"

/* In factors of 1 - q, so that no digits are lost where both go to 0 */
double sd_taper_factor(const sd_law *law, double R)
{
  if (law->taper == SD_TAPER_NONE) return 1.0;
  const double q = R / law->range, s = q < 1.0 ? 1.0 - q : 0.0;
  if (law->taper == SD_TAPER_WENDLAND) return s * s * s * s * (1.0 + 4.0 * q);
  return s * s * (1.0 + 0.5 * q);
}

void sd_packed_free(sd_packed *p)
{
  free(p->memory);
  memset(p, 0, sizeof(*p));
}

/* The spheres that take part, as they stand at the wall */
typedef struct {
  double largest, smallest, lo[3], hi[3];
  /* all places are numbers */
  int sound;
} extent;

static extent extent_of(const sd_packed *p)
{
  const double *a = p->spheres.a;
  extent e = {0.0, INFINITY, {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, 1};
  for (int i = 0; i < p->n; i++) {
    if (!(a[i] > 0.0)) continue;
    if (a[i] > e.largest) e.largest = a[i];
    if (a[i] < e.smallest) e.smallest = a[i];
    double x[3];
    sd_wall_stand(&p->law.wall, p->spheres.x + 3 * (long) i, a[i], x);
    for (int d = 0; d < 3; d++) {
      e.sound = e.sound && fabs(x[d]) < INFINITY;
      if (x[d] < e.lo[d]) e.lo[d] = x[d];
      if (x[d] > e.hi[d]) e.hi[d] = x[d];
    }
  }
  return e;
}

/* Lengths are multiplied by a power of two (exact) that brings the largest radius to 1 ... 2.
 * Returns whether the first guess of a root may then be in single precision: squares of spheres so
 * small or so far away that they leave its range want plain C. */
static int find_scale(sd_packed *p, const extent *e)
{
  p->scale = 1.0;
  if (!e->sound || !(e->largest > 0.0) || !(e->largest < INFINITY)) return 0;
  const int exponent = -ilogb(e->largest);
  if (abs(exponent) > 1000) return 0;
  p->scale = ldexp(1.0, exponent);
  double far = 0.0;
  for (int d = 0; d < 3; d++) far = fmax(far, fmax(fabs(e->lo[d]), fabs(e->hi[d])));
  return far * p->scale < 1e15 && e->smallest * p->scale > 1e-14;
}

/* Do floats hold places and radii? The widest extent has less than 2^31 steps, each a power of two. */
static int find_steps(sd_packed *p, const extent *e)
{
  double across = e->largest;
  for (int d = 0; d < 3; d++) across = fmax(across, e->hi[d] - e->lo[d]);
  if (!e->sound || p->law.wall.sign || !(across <= SD_PRODUCT_MOST_ACROSS * e->smallest)) return 0;
  const double step = ldexp(1.0, ilogb(across * p->scale) - 30);
  if (p->width == 6) p->step = step;
  else p->scale /= step;
  return 1;
}

/* Numbers of a sphere in the axes of the wall */
static void turn_to_wall(sd_packed *p)
{
  const sd_wall *wall = &p->law.wall;
  int axis[3];
  sd_wall_axes(wall, axis);
  for (int k = 0; k < 6; k++) {
    p->from[k] = k - k % 3 + axis[k % 3];
    p->sign[k] = wall->sign < 0 && k % 3 == 2 ? -1.0 : 1.0;
  }
}

enum { DOUBLES, FLOATS_IF_THEY_DO };

/* Which kernel, in which unit of length; where the spheres are */
static extent begin_packing(sd_packed *p, sd_isa isa, const sd_law *law, const sd_spheres *s, int n,
                            int width, int numbers)
{
  p->spheres = *s;
  p->law = *law;
  p->n = n;
  p->width = width;
  p->unit = p->step = 1.0;
  isa = sd_isa_of(isa);
  const extent e = extent_of(p);
  const int in_range = find_scale(p, &e);
  if (!in_range) isa = SD_ISA_PLAIN;
  const struct sd_kernels *kernels = SD_KERNELS_OF(sd_product, plain, isa);
  if (in_range && numbers == FLOATS_IF_THEY_DO && find_steps(p, &e))
    kernels = SD_KERNELS_OF(sd_product_single, plain, isa);
  p->kernel = width == 6 ? &kernels->torques : &kernels->forces;
  kernels = SD_KERNELS_OF(sd_wall, plain, isa);
  p->images = !law->wall.sign ? NULL : width == 6 ? &kernels->torques : &kernels->forces;
  turn_to_wall(p);
  p->law.range *= p->scale;
  p->active = 0;
  for (int i = 0; i < n; i++) p->active += s->a[i] > 0.0;
  return e;
}

/* Columns and rows that stand for nothing: no force, and far from everything. */
static const double nowhere = 1e16;

/* Number k of a column of places: in floats the step from the lowest one on */
static void column_place(const sd_packed *p, void *column, long k, double x, double lowest)
{
  if (p->kernel->bytes == sizeof(double)) {
    ((double *) column)[k] = x * p->scale;
    return;
  }
  const uint32_t steps = (uint32_t) ((x - lowest) * (p->scale / p->step));
  memcpy((float *) column + k, &steps, sizeof(steps));
}

/* A place far from everything; of floats, in a corner that no other is beyond */
static void put_nowhere(const sd_packed *p, void *column, long k)
{
  const uint32_t last_step = 0x7fffffff;
  if (p->kernel->bytes == sizeof(double)) ((double *) column)[k] = nowhere;
  else memcpy((float *) column + k, &last_step, sizeof(last_step));
}

/* Columns, one array for each number, as vectors of several sources are read from them. Spheres
 * that take no part are left out here, which costs those that do nothing; `index` remembers who is
 * who. */
static sd_status pack_columns(sd_packed *p, const extent *e)
{
  const sd_spheres *s = &p->spheres;
  const int lanes = p->kernel->lanes, width = p->width;
  const size_t bytes = p->kernel->bytes;
  p->padded = (p->active + lanes - 1) / lanes * lanes;
  const long column = (p->padded + 7) / 8 * 8; /* whole cache lines */
  double *next = sd_reserve_lines(&p->memory, (size_t) ((5 + 2 * width) * column), &p->room);
  if (!next) return SD_ENOMEMORY;
  void **columns[] = {&p->x, &p->y, &p->z, &p->a};
  for (int k = 0; k < 4; k++, next += column) *columns[k] = next;
  for (int k = 0; k < width; k++, next += column) p->f[k] = next;
  for (int k = 0; k < width; k++, next += column) p->u[k] = next;
  p->index = (int *) next;
  int k = 0;
  for (int i = 0; i < p->n; i++) {
    if (!(s->a[i] > 0.0)) continue;
    p->index[k] = i;
    double x[3];
    sd_wall_stand(&p->law.wall, s->x + 3 * (long) i, s->a[i], x);
    for (int d = 0; d < 3; d++) column_place(p, *columns[d], k, x[d], e->lo[d]);
    sd_put_number(p->a, bytes, k, s->a[i] * p->scale);
    k++;
  }
  for (; k < p->padded; k++) {
    p->index[k] = p->n;
    for (int d = 0; d < 3; d++) put_nowhere(p, *columns[d], k);
    sd_put_number(p->a, bytes, k, 0.0);
    for (int d = 0; d < width; d++) sd_put_number(p->f[d], bytes, k, 0.0);
  }
  return SD_OK;
}

sd_status sd_packed_all(sd_packed *p, sd_isa isa, const sd_law *law, const sd_spheres *s, int n,
                        int width)
{
  const extent e = begin_packing(p, isa, law, s, n, width, DOUBLES);
  return pack_columns(p, &e);
}

sd_status sd_packed_all_single(sd_packed *p, sd_isa isa, const sd_law *law, const sd_spheres *s, int n,
                               int width)
{
  const extent e = begin_packing(p, isa, law, s, n, width, FLOATS_IF_THEY_DO);
  return pack_columns(p, &e);
}

/* Rows of eight numbers, a line of the cache, as neighbours come in no order: what is read of one
 * is read at once. Nobody is left out, since the pairs' indices say where a row is; who takes no
 * part is far away and has no force. */
sd_status sd_packed_list(sd_packed *p, sd_isa isa, const sd_law *law, const sd_spheres *s, int n,
                         int width)
{
  begin_packing(p, isa, law, s, n, width, DOUBLES);
  const long rows = n + 1;
  p->row = sd_reserve_lines(&p->memory, (size_t) ((width == 6 ? 18 : 11) * rows), &p->room);
  if (!p->row) return SD_ENOMEMORY;
  double *next = p->row + 8 * rows;
  if (width == 6) {
    p->torque_row = next;
    next += 4 * rows;
    memset(p->torque_row, 0, 4 * sizeof(double) * (size_t) rows);
  }
  for (int d = 0; d < width; d++, next += rows) p->u[d] = next;
  for (long i = 0; i < n; i++) {
    double *row = p->row + 8 * i;
    const int takes_part = s->a[i] > 0.0;
    double x[3];
    sd_wall_stand(&law->wall, s->x + 3 * i, s->a[i], x);
    for (int d = 0; d < 3; d++) row[d] = takes_part ? x[d] * p->scale : nowhere;
    row[3] = takes_part ? s->a[i] * p->scale : 0.0;
  }
  const double last[8] = {nowhere, nowhere, nowhere};
  memcpy(p->row + 8 * (long) n, last, sizeof(last));
  return SD_OK;
}

/* The kernels' sums are times 8 pi, in scaled lengths and of scaled forces; torques go in times the
 * scale. */
static void take_sums(const sd_packed *p, int i, int k, double *u)
{
  const double unit = p->scale * p->spheres.w[i] / (8.0 * SD_PI) / p->unit, turn = unit * p->scale;
  for (int d = 0; d < 3; d++) u[p->from[d]] = unit * p->sign[d] * p->u[d][k];
  for (int d = 3; d < p->width; d++) u[p->from[d]] = turn * p->sign[d] * p->u[d][k];
}

/* What the kernels read of a force: the sphere's own w = 1/sqrt(eta) goes with its force and its
 * partner's with the sum, together 1/sqrt(eta_i eta_j). */
static double force_of(const sd_packed *p, double w, int d, const double *F)
{
  return (d < 3 ? w : w * p->scale) * p->sign[d] * F[p->from[d]];
}

/* The power of two for floats that brings the largest force to 1 ... 2, where they would not hold its
 * products; else 1, which leaves their digits alone. */
static double unit_of_forces(const sd_packed *p, const double *F)
{
  enum { HELD = 30 };
  double largest = 0.0;
  for (int k = 0; k < p->active; k++)
    for (int d = 0; d < p->width; d++) {
      const long i = p->index[k];
      const double size = fabs(force_of(p, p->spheres.w[i], d, F + p->width * i));
      if (size > largest) largest = size;
    }
  if (!(largest > 0.0 && largest < INFINITY)) return 1.0;
  const int power = ilogb(largest);
  return abs(power) <= HELD ? 1.0 : ldexp(1.0, power < -1022 ? 1022 : -power);
}

/* F of all spheres into the columns, sums to 0 */
static void load_columns(sd_packed *p, const double *F)
{
  const long m = p->width;
  const size_t bytes = p->kernel->bytes;
  p->unit = bytes == sizeof(double) ? 1.0 : unit_of_forces(p, F);
  for (int k = 0; k < p->active; k++) {
    const long i = p->index[k];
    const double w = p->spheres.w[i];
    for (int d = 0; d < m; d++) sd_put_number(p->f[d], bytes, k, p->unit * force_of(p, w, d, F + m * i));
  }
  for (int d = 0; d < m; d++) memset(p->u[d], 0, sizeof(double) * (size_t) p->padded);
}

void sd_packed_share(sd_packed *p, int part, int parts, const double *F, double *u)
{
  load_columns(p, F);
  p->kernel->symmetric(p, part, parts);
  if (p->images) p->images->symmetric(p, part, parts);
  memset(u, 0, sizeof(double) * (size_t) p->width * (size_t) p->n);
  for (int k = 0; k < p->active; k++) take_sums(p, p->index[k], k, u + (long) p->width * p->index[k]);
}

/* Spheres begin ... end - 1; F of the first of them on. One that takes no part has radius 0 in its
 * row, and its F, which may be anything, is not read. */
static void load_rows(sd_packed *p, long begin, long end, const double *F)
{
  const long m = p->width;
  for (long i = begin; i < end; i++, F += m) {
    double *row = p->row + 8 * i;
    const double w = row[3] > 0.0 ? p->spheres.w[i] : 0.0;
    for (int d = 0; d < 3; d++) row[4 + d] = w > 0.0 ? force_of(p, w, d, F) : 0.0;
    for (int d = 3; d < m; d++) p->torque_row[4 * i + d - 3] = w > 0.0 ? force_of(p, w, d, F) : 0.0;
  }
}

void sd_packed_pairs(sd_packed *p, const sd_pairs *pairs, const double *F, const double *ghosts,
                     double *u)
{
  const long m = p->width;
  load_rows(p, 0, pairs->n, F);
  if (ghosts) load_rows(p, pairs->n, p->n, ghosts);
  for (long d = 0; d < m; d++) memset(p->u[d], 0, sizeof(double) * (size_t) pairs->n);
  p->kernel->list(p, pairs);
  if (p->images) p->images->list(p, pairs);
  for (int i = 0; i < pairs->n; i++) {
    if (p->row[8 * (long) i + 3] > 0.0)
      take_sums(p, i, i, u + m * i);
    else
      memset(u + m * i, 0, sizeof(double) * (size_t) m);
  }
}

/* In one pass, since the result can only be shorter than the candidates' own rows. */
void sd_pairs_within(const sd_pairs *candidates, const sd_spheres *s, double cutoff, long *first,
                     int *neighbor)
{
  const double cutsq = cutoff * cutoff;
  long count = 0;
  for (int i = 0; i < candidates->n; i++) {
    first[i] = count;
    if (!(s->a[i] > 0.0)) continue;
    const double *xi = s->x + 3 * (long) i;
    for (long k = candidates->first[i]; k < candidates->first[i + 1]; k++) {
      const int j = candidates->neighbor[k];
      if (s->a[j] > 0.0 && sd_distance_squared(xi, s->x + 3 * (long) j) <= cutsq)
        neighbor[count++] = j;
    }
  }
  first[candidates->n] = count;
}
