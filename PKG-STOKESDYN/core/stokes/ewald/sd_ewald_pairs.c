#include "sd_ewald_pairs.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"

/* Vectors of every instruction set are full with so many neighbours. */
enum { FULL = 8 };

const struct sd_ewald_kernels *sd_ewald_kernels_of(sd_isa isa)
{
  if (isa == SD_ISA_BEST) isa = sd_isa_best();
#if defined(SD_HAS_X86_KERNELS)
  if (isa == SD_ISA_AVX512) return &sd_ewald_avx512;
  if (isa == SD_ISA_AVX2) return &sd_ewald_avx2;
#endif
#if defined(SD_HAS_X86_KERNELS) || defined(SD_HAS_PORTABLE_KERNELS)
  if (isa == SD_ISA_BASELINE) return &sd_ewald_baseline;
#endif
  return &sd_ewald_plain;
}

void sd_ewald_pairs_create(sd_ewald_pairs *p, const sd_ewald *e,
                           const struct sd_ewald_kernels *kernels, int width)
{
  if (width != p->width) sd_ewald_pairs_free(p); /* rows are wider */
  p->kernels = kernels;
  p->ewald = *e;
  p->width = width;
  const int least = sd_radial_fit(e, width, p->coefficient[0]);
  p->degree = SD_RADIAL_TERMS - 1;
#define OF_DEGREE(d) \
  if ((d) >= least && (d) < p->degree) p->degree = d;
  SD_NEAR_DEGREES(OF_DEGREE)
#undef OF_DEGREE
  sd_radial(e, 0.0, p->origin);
}

void sd_ewald_pairs_free(sd_ewald_pairs *p)
{
  free(p->sphere);
  free(p->target);
  free(p->first);
  free(p->neighbor);
  free(p->wide);
  free(p->row);
  free(p->cell_first);
  free(p->centre);
  memset(p, 0, sizeof(*p));
}

/* --- rows in order of cells --- */

/* Doubles on a border of cache lines, for rows of eight; free() takes the pointer. */
static double *lines(size_t doubles)
{
  return aligned_alloc(64, (sizeof(double) * doubles + 63) / 64 * 64);
}

static int make_room(sd_ewald_pairs *p, int n)
{
  if (n <= p->room && p->row) return 1;
  const size_t many = (size_t) n + (size_t) n / 8 + 8;
  free(p->sphere);
  free(p->target);
  free(p->first);
  free(p->row);
  free(p->centre);
  p->sphere = malloc(sizeof(int) * many);
  p->target = malloc(sizeof(int) * many);
  p->first = malloc(sizeof(long) * (many + 1));
  p->row = lines((p->width == 6 ? 18 : 11) * many + 64);
  p->centre = malloc(sizeof(double) * (3 * many + FULL));
  p->room = (int) many;
  if (p->sphere && p->target && p->first && p->row && p->centre) return 1;
  p->room = 0;
  return 0;
}

/* Cells that the spheres stand in: a box around them, cut into n [3] cells of one side */
typedef struct {
  double lo[3], side, inverse;
  int n[3];
} cells;

/* Half the range a side, or more where the spheres are so far apart that most cells would be
 * empty. */
static cells cells_for(const sd_ewald_pairs *p, const sd_spheres *s, int n_all)
{
  double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
  int many = 0;
  for (int i = 0; i < n_all; i++) {
    if (!(s->a[i] > 0.0)) continue;
    many++;
    for (int d = 0; d < 3; d++) {
      lo[d] = fmin(lo[d], s->x[3 * (long) i + d]);
      hi[d] = fmax(hi[d], s->x[3 * (long) i + d]);
    }
  }
  cells c = {.side = 0.5 * p->ewald.range, .inverse = 0.0, .n = {1, 1, 1}};
  if (many == 0) return c;
  for (double wanted = 4.0 * many + 64.0;; c.side *= 1.5) {
    double all = 1.0;
    for (int d = 0; d < 3; d++) all *= floor((hi[d] - lo[d]) / c.side) + 1.0;
    if (all <= wanted) break;
  }
  c.inverse = 1.0 / c.side;
  for (int d = 0; d < 3; d++) {
    c.lo[d] = lo[d];
    c.n[d] = (int) floor((hi[d] - lo[d]) / c.side) + 1;
  }
  return c;
}

static int along(const cells *c, double x, int d)
{
  const int k = (int) ((x - c->lo[d]) * c->inverse);
  return k < c->n[d] ? k : c->n[d] - 1;
}

static int cell_of(const cells *c, const double *x)
{
  return (along(c, x[0], 0) * c->n[1] + along(c, x[1], 1)) * c->n[2] + along(c, x[2], 2);
}

/* Counting sort; the targets are ours. */
static sd_status sort(sd_ewald_pairs *p, const cells *c, int n, int n_all)
{
  const sd_spheres *s = &p->spheres;
  const int all = c->n[0] * c->n[1] * c->n[2];
  if (all > p->cell_room || !p->cell_first) {
    free(p->cell_first);
    p->cell_first = malloc(sizeof(int) * ((size_t) all + 2));
    p->cell_room = p->cell_first ? all : 0;
    if (!p->cell_first) return SD_ENOMEMORY;
  }
  int *first = p->cell_first;
  memset(first, 0, sizeof(int) * ((size_t) all + 2));
  for (int i = 0; i < n_all; i++)
    if (s->a[i] > 0.0) first[cell_of(c, s->x + 3 * (long) i) + 2]++;
  for (int k = 0; k < all; k++) first[k + 2] += first[k + 1];
  for (int i = 0; i < n_all; i++)
    if (s->a[i] > 0.0) p->sphere[first[cell_of(c, s->x + 3 * (long) i) + 1]++] = i;
  p->rows = first[all];
  p->n = 0;
  for (int k = 0; k < p->rows; k++)
    if (p->sphere[k] < n) p->target[p->n++] = k;
  return SD_OK;
}

/* A row that stands for nothing: no force, and far from everything. */
static const double nowhere = 1e16;

static void fill_rows(sd_ewald_pairs *p)
{
  double largest = 0.0;
  for (int k = 0; k < p->rows; k++) largest = fmax(largest, p->spheres.a[p->sphere[k]]);
  p->scale = largest > 0.0 ? ldexp(1.0, -ilogb(largest)) : 1.0;
  p->equal = 1;
  for (int k = 0; k < p->rows; k++) {
    const long i = p->sphere[k];
    double *row = p->row + 8 * (long) k;
    for (int d = 0; d < 3; d++) {
      row[d] = p->spheres.x[3 * i + d] * p->scale;
      p->centre[(long) d * p->room + k] = p->spheres.x[3 * i + d];
    }
    row[3] = p->spheres.a[i] * p->scale;
    p->equal = p->equal && p->spheres.a[i] == p->ewald.a_ref;
  }
  const double last[8] = {nowhere, nowhere, nowhere};
  memcpy(p->row + 8 * (long) p->rows, last, sizeof(last));
  double *next = p->row + 8 * ((long) p->rows + 1);
  if (p->width == 6) {
    p->torque_row = next;
    next += 4 * ((long) p->rows + 1);
    memset(p->torque_row, 0, sizeof(double) * 4 * ((size_t) p->rows + 1));
  }
  p->u = next;
}

/* --- neighbours --- */

static int room_for_neighbors(sd_ewald_pairs *p, long many)
{
  if (many <= p->neighbor_room && p->neighbor) return 1;
  const long room = many + many / 4;
  int *more = realloc(p->neighbor, sizeof(int) * (size_t) room);
  if (!more) return 0;
  p->neighbor = more;
  p->neighbor_room = room;
  return 1;
}

static int add_wide(sd_ewald_pairs *p, int target, int row)
{
  if (p->wides == p->wide_room) {
    const int room = 2 * p->wide_room + 64;
    int *more = realloc(p->wide, sizeof(int) * 2 * (size_t) room);
    if (!more) return 0;
    p->wide = more;
    p->wide_room = room;
  }
  p->wide[2 * (long) p->wides] = target;
  p->wide[2 * (long) p->wides + 1] = row;
  p->wides++;
  return 1;
}

/* Gap between a place and the cells k of a direction; the last reaches as far as its spheres */
static double gap_to(const cells *c, double x, int k, int d)
{
  const double lo = c->lo[d] + k * c->side;
  if (x < lo) return lo - x;
  return k < c->n[d] - 1 && x > lo + c->side ? x - lo - c->side : 0.0;
}

/* The rows of one column of cells, along z, within span of z: begin and end */
static void column(const sd_ewald_pairs *p, const cells *c, long first, double z, double span,
                   int *range)
{
  const double at = (z - c->lo[2]) * c->inverse, low = at - span * c->inverse;
  const double high = at + span * c->inverse;
  const int from = low > 0.0 ? (int) low : 0;
  const int to = high < c->n[2] - 1 ? (int) high : c->n[2] - 1;
  range[0] = range[1] = 0;
  if (from >= c->n[2] || to < 0 || high < 0.0) return;
  range[0] = p->cell_first[first + from];
  range[1] = p->cell_first[first + to + 1];
}

static int wide_pairs(sd_ewald_pairs *p, int target, int begin, int end)
{
  const double *x = p->centre, *y = x + p->room, *z = y + p->room;
  const int row = p->target[target];
  const double own = p->spheres.a[p->sphere[row]], range2 = p->ewald.range * p->ewald.range;
  for (int j = begin; j < end; j++) {
    const double dx = x[j] - x[row], dy = y[j] - y[row], dz = z[j] - z[row];
    const double r2 = dx * dx + dy * dy + dz * dz, sum = own + p->spheres.a[p->sphere[j]];
    if (r2 > range2 && r2 < sum * sum && !add_wide(p, target, j)) return 0;
  }
  return 1;
}

/* Neighbours of a target, after the first `many` of all; -1: no memory */
static long neighbors_of(sd_ewald_pairs *p, const cells *c, int target, double reach, long many)
{
  const int row = p->target[target], wide = reach > p->ewald.range;
  const double range2 = p->ewald.range * p->ewald.range;
  double x[3];
  int low[2], high[2], own = -1;
  for (int d = 0; d < 3; d++) x[d] = p->centre[(long) d * p->room + row];
  for (int d = 0; d < 2; d++) {
    const int steps = (int) ceil(reach / c->side), k = along(c, x[d], d);
    low[d] = k > steps ? k - steps : 0;
    high[d] = k + steps < c->n[d] ? k + steps : c->n[d] - 1;
  }
  for (int cx = low[0]; cx <= high[0]; cx++) {
    const double gap_x = gap_to(c, x[0], cx, 0);
    for (int cy = low[1]; cy <= high[1]; cy++) {
      const double gap_y = gap_to(c, x[1], cy, 1), left = reach * reach - gap_x * gap_x - gap_y * gap_y;
      int range[2];
      if (left < 0.0) continue;
      column(p, c, ((long) cx * c->n[1] + cy) * c->n[2], x[2], sqrt(left), range);
      if (range[0] >= range[1]) continue;
      if (!room_for_neighbors(p, many + range[1] - range[0] + 2 * FULL)) return -1;
      many += p->kernels->search(p->centre, p->room, range[0], range[1], x, range2, p->neighbor + many);
      if (wide && !wide_pairs(p, target, range[0], range[1])) return -1;
    }
  }
  /* the target itself is among them, once */
  const long first = p->first[target];
  for (long k = first; own < 0; k++)
    if (p->neighbor[k] == row) own = (int) (k - first);
  p->neighbor[first + own] = p->neighbor[--many];
  while (many % FULL) p->neighbor[many++] = p->rows;
  return many;
}

static sd_status find_pairs(sd_ewald_pairs *p, const cells *c, double reach)
{
  long many = 0;
  p->wides = 0;
  for (int i = 0; i < p->n; i++) {
    p->first[i] = many;
    many = neighbors_of(p, c, i, reach, many);
    if (many < 0) return SD_ENOMEMORY;
  }
  p->first[p->n] = many;
  return SD_OK;
}

sd_status sd_ewald_pairs_place(sd_ewald_pairs *p, const sd_spheres *s, int n, int n_all)
{
  p->spheres = *s;
  if (!make_room(p, n_all)) return SD_ENOMEMORY;
  const cells c = cells_for(p, s, n_all);
  sd_status status = sort(p, &c, n, n_all);
  if (status != SD_OK) return status;
  fill_rows(p);
  double largest = 0.0;
  for (int k = 0; k < p->rows; k++) largest = fmax(largest, s->a[p->sphere[k]]);
  return find_pairs(p, &c, fmax(p->ewald.range, 2.0 * largest));
}

/* --- product --- */

static void load(sd_ewald_pairs *p, int n, const double *F, const double *ghosts)
{
  const long m = p->width;
  for (long k = 0; k < p->rows; k++) {
    const long i = p->sphere[k];
    const double w = p->spheres.w[i], *from = i < n ? F + m * i : ghosts + m * (i - n);
    double *row = p->row + 8 * k;
    for (int d = 0; d < 3; d++) row[4 + d] = w * from[d];
    for (int d = 3; d < m; d++) p->torque_row[4 * k + d - 3] = w * p->scale * from[d];
  }
}

/* The kernels' table: lengths scaled, and times 8 pi. */
static sd_near_part near_part_of(sd_ewald_pairs *p)
{
  sd_near_part k = {.n = p->n,
                    .width = p->width,
                    .target = p->target,
                    .first = p->first,
                    .neighbor = p->neighbor,
                    .row = p->row,
                    .torque_row = p->torque_row,
                    .degree = p->degree};
  const double s = p->scale, range = p->ewald.range * s, ref = p->ewald.a_ref * s;
  k.range2 = range * range;
  k.ref2 = ref * ref;
  k.equal = p->equal;
  static const int power[SD_RADIALS] = {1, 3, 3, 5, 5, 7, 3, 5};
  for (int f = 0; f < SD_RADIALS; f++) {
    const double unit = 8.0 * SD_PI / pow(s, power[f]);
    for (int m = 0; m <= p->degree; m++) k.coefficient[f][m] = unit * p->coefficient[f][m];
  }
  for (int d = 0; d < p->width; d++) k.u[d] = p->u + (long) d * p->n;
  return k;
}

/* Beyond the range D is what the tensor would be if the two did not overlap. */
static void add_wide_pairs(sd_ewald_pairs *p)
{
  for (long l = 0; l < p->wides; l++) {
    const int i = p->wide[2 * l];
    const double *own = p->row + 8 * (long) p->target[i];
    const double *other = p->row + 8 * (long) p->wide[2 * l + 1];
    const double r[3] = {own[0] - other[0], own[1] - other[1], own[2] - other[2]};
    const double R2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2], y = 1.0 / sqrt(R2);
    const double ai = own[3], aj = other[3], m = (ai * ai + aj * aj) * y * y;
    double M[36], G[6] = {other[4], other[5], other[6]};
    if (p->width == 6)
      memcpy(G + 3, p->torque_row + 4 * (long) p->wide[2 * l + 1], 3 * sizeof(double));
    sd_tensor_grand(r, ai, aj, 1.0, M);
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++) {
        const double hh = r[a] * r[b] * y * y, same = a == b;
        /* e_abc r_c: F x r of component a from F_b */
        const double cross = a == b ? 0.0 : ((b - a + 3) % 3 == 1 ? 1.0 : -1.0) * r[3 - a - b];
        M[6 * a + b] -= y * ((1.0 + m / 3.0) * same + (1.0 - m) * hh) / (8.0 * SD_PI);
        M[6 * a + b + 3] -= y * y * y * cross / (8.0 * SD_PI);
        M[6 * (a + 3) + b] -= y * y * y * cross / (8.0 * SD_PI);
        M[6 * (a + 3) + b + 3] -= y * y * y * (1.5 * hh - 0.5 * same) / (8.0 * SD_PI);
      }
    for (int a = 0; a < p->width; a++)
      for (int b = 0; b < p->width; b++)
        p->u[(long) a * p->n + i] += 8.0 * SD_PI * M[6 * a + b] * G[b];
  }
}

void sd_ewald_pairs_apply(sd_ewald_pairs *p, int n, const double *F, const double *ghosts,
                          double *u)
{
  const long m = p->width;
  load(p, n, F, ghosts);
  const sd_near_part k = near_part_of(p);
  p->kernels->near_part(&k);
  add_wide_pairs(p);
  memset(u, 0, sizeof(double) * (size_t) m * (size_t) n);
  for (int i = 0; i < p->n; i++) {
    const long j = p->sphere[p->target[i]];
    const double w = p->spheres.w[j], unit = w * p->scale / (8.0 * SD_PI);
    const double b = sd_ewald_b(&p->ewald, p->spheres.a[j]);
    const double self = p->origin[SD_I0] - 2.0 * b * p->origin[SD_I1] + b * b * p->origin[SD_I2];
    for (int d = 0; d < 3; d++)
      u[m * j + d] = unit * p->u[(long) d * p->n + i] - w * w * self * F[m * j + d];
    for (int d = 3; d < m; d++)
      u[m * j + d] = unit * p->scale * p->u[(long) d * p->n + i] -
                     0.25 * w * w * p->origin[SD_I1] * F[m * j + d];
  }
}
