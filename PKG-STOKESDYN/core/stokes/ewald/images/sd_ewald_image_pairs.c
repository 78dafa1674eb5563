#include "sd_ewald_image_pairs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_image_wave.h"
#include "sd_room.h"

void sd_ewald_image_pairs_free(sd_ewald_image_pairs *p)
{
  free(p->sphere);
  free(p->order);
  free(p->x);
  free(p->first);
  free(p->pair);
  sd_cells_free(&p->cells);
  memset(p, 0, sizeof(*p));
}

/* --- who is near --- */

/* Side by side along the wall in strips, and within a strip along it: those that see each other are
 * near in memory, too. */
static int by_place(const void *one, const void *other)
{
  const sd_near_image *a = one, *b = other;
  if (a->strip != b->strip) return a->strip < b->strip ? -1 : 1;
  return a->along < b->along ? -1 : a->along > b->along;
}

static void sort_near(sd_ewald_image_pairs *p, int n)
{
  const sd_wall *wall = &p->ewald.images.wall;
  int axis[3];
  sd_wall_axes(wall, axis);
  for (int k = 0; k < p->near; k++) {
    const double *x = p->spheres.x + 3L * p->sphere[k];
    p->order[k] =
        (sd_near_image){floor(2.0 * x[axis[0]] / p->ewald.images.range), x[axis[1]], p->sphere[k]};
  }
  qsort(p->order, (size_t) n, sizeof(*p->order), by_place);
  qsort(p->order + n, (size_t) (p->near - n), sizeof(*p->order), by_place);
  for (int k = 0; k < p->near; k++) {
    const long i = p->sphere[k] = p->order[k].sphere;
    sd_wall_stand(wall, p->spheres.x + 3 * i, p->spheres.a[i], p->x + 3L * k);
  }
}

/* Spheres whose own image is within twice the range: others have none that is */
static sd_status find_near(sd_ewald_image_pairs *p, int n, int n_all)
{
  const sd_wall *wall = &p->ewald.images.wall;
  p->near = p->ours = 0;
  if (!sd_reserve(&p->sphere, sizeof(int), (size_t) n_all, &p->near_room) ||
      !sd_reserve(&p->order, sizeof(sd_near_image), (size_t) n_all, &p->order_room) ||
      !sd_reserve(&p->x, 9 * sizeof(double), (size_t) n_all, &p->x_room))
    return SD_ENOMEMORY;
  for (int i = 0; i < n_all; i++) {
    const double *x = p->spheres.x + 3L * i;
    if (!(p->spheres.a[i] > 0.0) || sd_wall_height(wall, x) > p->ewald.images.range) continue;
    p->sphere[p->near++] = i;
    p->ours += i < n;
  }
  sort_near(p, p->ours);
  p->F = p->x + 3L * p->near;
  p->u = p->F + 3L * p->near;
  return SD_OK;
}

static sd_image_pair pair_of(const sd_ewald_image_pairs *p, int i, int j)
{
  const sd_filter filter = {p->ewald.images.xi, p->ewald.a_ref};
  const double *xi = p->x + 3L * i, *xj = p->x + 3L * j;
  const double a = p->spheres.a[p->sphere[i]], b = p->spheres.a[p->sphere[j]];
  const sd_wall_pair whole = sd_wall_pair_of(xi, a, xj, b);
  sd_image_pair pair = {.other = j};
  sd_image_wave(&filter, xi, a, xj, b, pair.c);
  for (int k = 0; k < 5; k++) pair.c[k] = whole.c[k] - pair.c[k];
  return pair;
}

/* Images within the range of sphere i of ours; those of ours that come earlier have the pair. Returns
 * how many pairs there are then, -1: out of memory. */
static long ip_pairs_of(sd_ewald_image_pairs *p, int i, long many)
{
  const double *x = p->x + 3L * i, range = p->ewald.images.range;
  const double image[3] = {x[0], x[1], -x[2]};
  for (sd_cells_walk w = sd_cells_near(&p->cells, image, range); sd_cells_step(&p->cells, &w);)
    for (int j = w.first; j >= 0; j = p->cells.next[j]) {
      const double *y = p->x + 3L * j;
      const double dx = x[0] - y[0], dy = x[1] - y[1], z = x[2] + y[2];
      if (j < i || dx * dx + dy * dy + z * z > range * range) continue;
      if (!sd_extend(&p->pair, sizeof(sd_image_pair), (size_t) many + 1, &p->room)) return -1;
      p->pair[many++] = pair_of(p, i, j);
    }
  return many;
}

sd_status sd_ewald_image_pairs_place(sd_ewald_image_pairs *p, const sd_ewald *e,
                                     const sd_spheres *s, int n, int n_all)
{
  p->ewald = *e;
  p->spheres = *s;
  sd_status status = find_near(p, n, n_all);
  if (status == SD_OK) status = sd_cells_fill(&p->cells, p->x, p->near, 0.5 * e->images.range);
  if (status == SD_OK &&
      !sd_reserve(&p->first, sizeof(long), (size_t) p->ours + 1, &p->first_room))
    status = SD_ENOMEMORY;
  if (status != SD_OK) return status;
  long many = 0;
  for (int i = 0; i < p->ours && many >= 0; i++) {
    p->first[i] = many;
    many = ip_pairs_of(p, i, many);
  }
  p->first[p->ours] = many;
  return many >= 0 ? SD_OK : SD_ENOMEMORY;
}

/* --- product --- */

/* U += image of a force F; c4, c5: of this direction of the pair */
static void ip_add_image(const double *c, double c4, double c5, const double R[3], const double *F,
                      double *U)
{
  const double p = R[0] * F[0] + R[1] * F[1] - R[2] * F[2];
  const double along = c[2] * p - c4 * F[2], up = c5 * p - c[1] * F[2];
  U[0] += c[0] * F[0] + along * R[0];
  U[1] += c[0] * F[1] + along * R[1];
  U[2] += up - c[0] * F[2] + along * R[2];
}

void sd_ewald_image_pairs_apply(sd_ewald_image_pairs *p, int n, const double *F,
                                const double *ghosts, double *u)
{
  const sd_wall *wall = &p->ewald.images.wall;
  int axis[3];
  sd_wall_axes(wall, axis);
  for (int k = 0; k < p->near; k++) {
    const long i = p->sphere[k];
    const double *from = i < n ? F + 3 * i : ghosts + 3 * (i - n), w = p->spheres.w[i];
    for (int d = 0; d < 3; d++)
      p->F[3L * k + d] = (d == 2 ? wall->sign : 1) * w * from[axis[d]];
  }
  memset(p->u, 0, 3 * sizeof(double) * (size_t) p->near);
  for (int i = 0; i < p->ours; i++)
    for (long k = p->first[i]; k < p->first[i + 1]; k++) {
      const int j = p->pair[k].other;
      const double *xi = p->x + 3L * i, *xj = p->x + 3L * j, *c = p->pair[k].c;
      const double R[3] = {xi[0] - xj[0], xi[1] - xj[1], xi[2] + xj[2]};
      const double back[3] = {-R[0], -R[1], R[2]};
      ip_add_image(c, c[3], c[4], R, p->F + 3L * j, p->u + 3L * i);
      if (j != i) ip_add_image(c, c[4], c[3], back, p->F + 3L * i, p->u + 3L * j);
    }
  for (int k = 0; k < p->ours; k++) {
    const long i = p->sphere[k];
    const double unit = p->spheres.w[i] / (8.0 * SD_PI);
    for (int d = 0; d < 3; d++)
      u[3 * i + axis[d]] += (d == 2 ? wall->sign : 1) * unit * p->u[3L * k + d];
  }
}
