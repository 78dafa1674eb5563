#include "sd_ewald_image_pairs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_room.h"

/* Vectors of every instruction set are full with so many neighbours. */
enum { FULL = 8 };

/* A row that stands for nothing: no force, and far from everything. */
static const double far_away = 1e14;

void sd_ewald_image_pairs_create(sd_ewald_image_pairs *p, const sd_ewald *e,
                                 const struct sd_ewald_kernels *kernels)
{
  p->kernels = kernels;
  p->ewald = *e;
  p->scale = ldexp(1.0, -ilogb(e->largest));
  sd_ewald scaled = *e;
  scaled.largest *= p->scale;
  scaled.a_ref *= p->scale;
  scaled.images.xi /= p->scale;
  scaled.images.band /= p->scale;
  scaled.images.range *= p->scale;
  p->part.range2 = scaled.images.range * scaled.images.range;
  p->part.ref2 = scaled.a_ref * scaled.a_ref;
  p->part.degree = sd_near_degree(sd_image_fit(&scaled, p->part.coefficient));
}

void sd_ewald_image_pairs_free(sd_ewald_image_pairs *p)
{
  free(p->sphere);
  free(p->order);
  free(p->strip);
  free(p->memory);
  free(p->first);
  free(p->neighbor);
  memset(p, 0, sizeof(*p));
}

/* --- who is near --- */

static int by_place(const void *one, const void *other)
{
  const sd_near_image *a = one, *b = other;
  if (a->strip != b->strip) return a->strip < b->strip ? -1 : 1;
  return a->along < b->along ? -1 : a->along > b->along;
}

/* Spheres within the range of the wall: others are not in that of any image. Those that see each other are
 * near in memory, too. */
static int list_near(sd_ewald_image_pairs *p, int n, int n_all)
{
  const double range = p->ewald.images.range;
  int axis[3], near = 0, ours = 0;
  if (!sd_reserve(&p->sphere, sizeof(int), (size_t) n_all + 1, &p->sphere_room) ||
      !sd_reserve(&p->order, sizeof(sd_near_image), (size_t) n_all + 1, &p->order_room))
    return 0;
  sd_wall_axes(&p->wall, axis);
  for (int i = 0; i < n_all; i++) {
    const double *x = p->spheres.x + 3L * i;
    if (!(p->spheres.a[i] > 0.0) || sd_wall_height(&p->wall, x) > range) continue;
    p->order[near++] = (sd_near_image){floor(2.0 * x[axis[0]] / range), x[axis[1]], i};
    ours += i < n;
  }
  qsort(p->order, (size_t) ours, sizeof(*p->order), by_place);
  qsort(p->order + ours, (size_t) (near - ours), sizeof(*p->order), by_place);
  for (int k = 0; k < near; k++) p->sphere[k] = p->order[k].sphere;
  p->part.rows = near;
  p->part.targets = ours;
  return 1;
}

/* Centres are read in whole vectors beyond the last. */
static int image_fill_rows(sd_ewald_image_pairs *p)
{
  const size_t rows = (size_t) p->part.rows + 1;
  p->row = sd_reserve_lines(&p->memory, 12 * rows + FULL, &p->room);
  if (!p->row) return 0;
  double *centre = p->row + 8 * rows;
  p->part.equal = 1;
  for (int k = 0; k < p->part.rows; k++) {
    const long i = p->sphere[k];
    const double a = p->spheres.a[i];
    double x[3], *row = p->row + 8L * k;
    sd_wall_stand(&p->wall, p->spheres.x + 3 * i, a, x);
    for (int d = 0; d < 3; d++) {
      row[d] = x[d] * p->scale;
      centre[(long) d * p->part.rows + k] = x[d];
    }
    row[3] = a * p->scale;
    row[7] = k;
    p->part.equal = p->part.equal && row[3] == p->row[3];
  }
  const double last[8] = {far_away, far_away, far_away, 0.0, 0.0, 0.0, 0.0, -1.0};
  memcpy(p->row + 8L * p->part.rows, last, sizeof(last));
  p->part.row = p->row;
  p->part.u = centre;
  return 1;
}

/* --- pairs --- */

static int list_strips(sd_ewald_image_pairs *p, int from, int end)
{
  for (int k = from; k < end; k++) {
    const double strip = p->order[k].strip;
    if (k == from || strip != p->order[k - 1].strip) {
      if (!sd_extend(&p->strip, sizeof(sd_near_strip), (size_t) p->strips + 1, &p->strip_room))
        return 0;
      p->strip[p->strips++] = (sd_near_strip){strip, k, k, k, k};
    }
    p->strip[p->strips - 1].end = k + 1;
  }
  return 1;
}

/* The strips that a strip of ours sees: from itself on, so that each pair comes once, and those of ghosts on
 * both sides; [8] */
static int strips_near(sd_ewald_image_pairs *p, int own, int *ghosts, sd_near_strip **near)
{
  const double strip = p->strip[own].strip;
  int many = 0;
  for (int s = own; s < p->own_strips && p->strip[s].strip <= strip + 2.0; s++)
    near[many++] = p->strip + s;
  while (*ghosts < p->strips && p->strip[*ghosts].strip < strip - 2.0) (*ghosts)++;
  for (int s = *ghosts; s < p->strips && p->strip[s].strip <= strip + 2.0; s++)
    near[many++] = p->strip + s;
  for (int s = 0; s < many; s++) near[s]->lo = near[s]->hi = near[s]->first;
  return many;
}

/* Neighbours of row i after the first `many` of all; returns how many there are then, -1: out of memory */
static long ip_neighbors_of(sd_ewald_image_pairs *p, int i, sd_near_strip **near, int strips, long many)
{
  const double range = p->ewald.images.range, along = p->order[i].along;
  const double *centre = p->part.u;
  const long rows = p->part.rows;
  int ranges[2 * 8];
  long most = many + 2 * FULL;
  for (int s = 0; s < strips; s++) {
    sd_near_strip *at = near[s];
    while (at->lo < at->end && p->order[at->lo].along < along - range) at->lo++;
    while (at->hi < at->end && p->order[at->hi].along <= along + range) at->hi++;
    ranges[2 * s] = s == 0 ? i : at->lo;
    ranges[2 * s + 1] = at->hi;
    most += at->hi - ranges[2 * s];
  }
  if (!sd_extend(&p->neighbor, sizeof(int), (size_t) most, &p->neighbor_room)) return -1;
  const double image[3] = {centre[i], centre[rows + i], -centre[2 * rows + i]};
  const sd_near_ranges seen = {centre, rows, ranges, strips};
  many += p->kernels->search(&seen, image, 1, range * range, p->neighbor + many);
  while (many % FULL) p->neighbor[many++] = p->part.rows;
  return many;
}

static int ip_find_pairs(sd_ewald_image_pairs *p)
{
  const int ours = p->part.targets;
  p->strips = 0;
  if (!list_strips(p, 0, ours)) return 0;
  p->own_strips = p->strips;
  if (!list_strips(p, ours, p->part.rows) ||
      !sd_reserve(&p->first, sizeof(long), (size_t) ours + 1, &p->first_room))
    return 0;
  int ghosts = p->own_strips;
  long many = 0;
  for (int s = 0; s < p->own_strips && many >= 0; s++) {
    sd_near_strip *near[8];
    const int strips = strips_near(p, s, &ghosts, near);
    for (int i = p->strip[s].first; i < p->strip[s].end && many >= 0; i++) {
      p->first[i] = many;
      many = ip_neighbors_of(p, i, near, strips, many);
    }
  }
  p->first[ours] = many;
  p->part.first = p->first;
  p->part.neighbor = p->neighbor;
  return many >= 0;
}

sd_status sd_ewald_image_pairs_place(sd_ewald_image_pairs *p, const sd_wall *wall,
                                     const sd_spheres *s, int n, int n_all)
{
  p->wall = *wall;
  p->spheres = *s;
  return list_near(p, n, n_all) && image_fill_rows(p) && ip_find_pairs(p) ? SD_OK : SD_ENOMEMORY;
}

/* --- product --- */

void sd_ewald_image_pairs_apply(sd_ewald_image_pairs *p, int n, const double *F,
                                const double *ghosts, double *u)
{
  const int sign = p->wall.sign;
  int axis[3];
  sd_wall_axes(&p->wall, axis);
  for (int k = 0; k < p->part.rows; k++) {
    const long i = p->sphere[k];
    const double *from = i < n ? F + 3 * i : ghosts + 3 * (i - n), w = p->spheres.w[i];
    for (int d = 0; d < 3; d++) p->row[8L * k + 4 + d] = (d == 2 ? sign : 1) * w * from[axis[d]];
  }
  memset(p->part.u, 0, 4 * sizeof(double) * ((size_t) p->part.rows + 1));
  p->kernels->image_part(&p->part);
  for (int k = 0; k < p->part.targets; k++) {
    const long i = p->sphere[k];
    const double unit = p->spheres.w[i] * p->scale / (8.0 * SD_PI);
    for (int d = 0; d < 3; d++)
      u[3 * i + axis[d]] += (d == 2 ? sign : 1) * unit * p->part.u[4L * k + d];
  }
}
