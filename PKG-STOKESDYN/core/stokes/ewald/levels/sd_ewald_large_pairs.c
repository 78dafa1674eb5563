#include "sd_ewald_large_pairs.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_room.h"
#include "sd_tensor.h"

static int lp_numbers(const sd_ewald_large_pairs *p)
{
  return p->width == 6 ? SD_LARGE_PAIR_TORQUES : SD_LARGE_PAIR;
}

void sd_ewald_large_pairs_create(sd_ewald_large_pairs *p, const sd_ewald_level *second, int width)
{
  p->ewald = second->split;
  p->from = second->from;
  p->width = width;
  p->degree = sd_radial_fit(&p->ewald, width, p->coefficient[0]);
  sd_radial(&p->ewald, 0.0, p->origin);
}

void sd_ewald_large_pairs_free(sd_ewald_large_pairs *p)
{
  free(p->sphere);
  free(p->large);
  free(p->F);
  free(p->image);
  free(p->image_of);
  free(p->begin);
  free(p->other);
  free(p->tensor);
  sd_cells_free(&p->cells);
  memset(p, 0, sizeof(*p));
}

/* --- the large spheres of all ranks --- */

/* How many each rank has, and then who they are: sums, to which each rank adds its own. None goes to
 * a sum before all have the room for it. */
static sd_status share_larges(sd_ewald_large_pairs *p, const sd_spheres *s, const int *list, int n,
                              const sd_world *world)
{
  const int ranks = sd_world_ranks(world), me = sd_world_me(world);
  double *counts = calloc((size_t) ranks, sizeof(double));
  sd_status status = sd_world_agree(world, counts ? SD_OK : SD_ENOMEMORY);
  for (int i = 0; i < n && status == SD_OK; i++) counts[me] += s->a[list[i]] >= p->from;
  if (status == SD_OK) status = sd_world_sum(world, counts, ranks);
  if (status != SD_OK) {
    free(counts);
    return status;
  }
  p->larges = p->first = 0;
  p->ours = (int) counts[me];
  for (int r = 0; r < ranks; r++) {
    if (r == me) p->first = p->larges;
    p->larges += (int) counts[r];
  }
  free(counts);
  const size_t larges = (size_t) p->larges;
  const int room = p->larges <= INT_MAX / 6 &&
      sd_reserve(&p->sphere, sizeof(int), larges, &p->sphere_room) &&
      sd_reserve(&p->large, sizeof(sd_large_sphere), larges, &p->large_room) &&
      sd_reserve(&p->F, 12 * sizeof(double), larges, &p->F_room);
  status = sd_world_agree(world, room ? SD_OK : SD_ENOMEMORY);
  if (status != SD_OK) return status;
  p->u = p->F + 6 * larges;
  memset(p->large, 0, sizeof(sd_large_sphere) * (size_t) p->larges);
  int next = 0;
  for (int i = 0; i < n; i++) {
    const int j = list[i];
    if (!(s->a[j] >= p->from)) continue;
    sd_large_sphere *l = p->large + p->first + next;
    memcpy(l->x, s->x + 3 * (long) j, sizeof(l->x));
    l->a = s->a[j];
    l->w = s->w[j];
    p->sphere[next++] = j;
  }
  return sd_world_sum(world, (double *) p->large, 5 * p->larges);
}

/* --- their images --- */

static int lp_add_image(sd_ewald_large_pairs *p, int large, double x, double y, double z)
{
  const size_t many = (size_t) p->images + 1;
  if (!sd_extend(&p->image, 3 * sizeof(double), many, &p->image_room) ||
      !sd_extend(&p->image_of, sizeof(int), many, &p->image_of_room))
    return 0;
  double *at = p->image + 3 * (long) p->images;
  at[0] = x;
  at[1] = y;
  at[2] = z;
  p->image_of[p->images++] = large;
  return 1;
}

/* Steps of the box along direction d that take x into lo ... hi */
static void steps_into(const sd_ewald_box *b, int d, double x, double lo, double hi, int *from,
                       int *to)
{
  *from = *to = 0;
  if (!b->periodic) return;
  *from = (int) ceil((lo - x) / b->edge[d]);
  *to = (int) floor((hi - x) / b->edge[d]);
}

/* Those that may see one of our spheres: in the box around these, wider by the range. */
static sd_status find_images(sd_ewald_large_pairs *p, const sd_spheres *s, const int *list, int n)
{
  const sd_ewald_box *b = &p->ewald.box;
  double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (int i = 0; i < n; i++)
    for (int d = 0; d < 3; d++) {
      lo[d] = fmin(lo[d], s->x[3 * (long) list[i] + d] - p->ewald.range);
      hi[d] = fmax(hi[d], s->x[3 * (long) list[i] + d] + p->ewald.range);
    }
  p->images = 0;
  for (int l = 0; l < p->larges && n > 0; l++) {
    const double *x = p->large[l].x;
    int from[3], to[3], m[3];
    steps_into(b, 2, x[2], lo[2], hi[2], from + 2, to + 2);
    for (m[2] = from[2]; m[2] <= to[2]; m[2]++) {
      const double z = x[2] + m[2] * b->edge[2], y0 = x[1] + m[2] * b->tilt[2];
      steps_into(b, 1, y0, lo[1], hi[1], from + 1, to + 1);
      for (m[1] = from[1]; m[1] <= to[1]; m[1]++) {
        const double y = y0 + m[1] * b->edge[1];
        const double x0 = x[0] + m[2] * b->tilt[1] + m[1] * b->tilt[0];
        steps_into(b, 0, x0, lo[0], hi[0], from, to);
        for (m[0] = from[0]; m[0] <= to[0]; m[0]++)
          if (!lp_add_image(p, l, x0 + m[0] * b->edge[0], y, z)) return SD_ENOMEMORY;
      }
    }
  }
  sd_cells_free(&p->cells);
  return sd_cells_fill(&p->cells, p->image, p->images, 0.5 * p->ewald.range);
}

/* --- pairs --- */

static double polynomial(const sd_ewald_large_pairs *p, int f, double t)
{
  double value = p->coefficient[f][p->degree];
  for (int k = p->degree - 1; k >= 0; k--) value = value * t + p->coefficient[f][k];
  return value;
}

static void tensor_of(const sd_ewald_large_pairs *p, const double *r, double ai, double aj,
                      double *out)
{
  const double R2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2], R = sqrt(R2), range = p->ewald.range;
  const double bi = sd_ewald_b(&p->ewald, ai), bj = sd_ewald_b(&p->ewald, aj);
  const double over_r = R > 0.0 ? 1.0 / R : 0.0, forces = 1.0 / (6.0 * SD_PI);
  const double torques = 1.0 / (8.0 * SD_PI);
  const int radials = p->width == 6 ? SD_RADIALS : SD_K0;
  double D[SD_RADIALS], f, g;
  for (int k = 0; k < radials; k++) D[k] = polynomial(p, k, 2.0 * R2 / (range * range) - 1.0);
  sd_rpy_radial(R, ai, aj, &f, &g);
  memcpy(out, r, 3 * sizeof(double));
  out[3] = forces * f - (D[SD_I0] - (bi + bj) * D[SD_I1] + bi * bj * D[SD_I2]);
  out[4] = forces * g * over_r * over_r - (D[SD_J0] - (bi + bj) * D[SD_J1] + bi * bj * D[SD_J2]);
  if (p->width < 6) return;
  sd_rpy_radial_wt(R, ai, aj, &f, &g);
  out[5] = torques * over_r * sd_rpy_radial_wf(R, ai, aj) - (D[SD_K0] - bj * D[SD_K1]);
  out[6] = torques * over_r * sd_rpy_radial_wf(R, aj, ai) - (D[SD_K0] - bi * D[SD_K1]);
  out[7] = torques * f - 0.25 * D[SD_I1];
  out[8] = torques * g * over_r * over_r - 0.25 * D[SD_J1];
}

static int lp_add_pair(sd_ewald_large_pairs *p, int other, const double *r, double ai, double aj)
{
  const size_t many = (size_t) p->pairs + 1, doubles = (size_t) lp_numbers(p);
  if (!sd_extend(&p->other, sizeof(int), many, &p->other_room) ||
      !sd_extend(&p->tensor, sizeof(double), many * doubles, &p->tensor_room))
    return 0;
  p->other[p->pairs] = other;
  tensor_of(p, r, ai, aj, p->tensor + lp_numbers(p) * p->pairs++);
  return 1;
}

/* mine: of our large spheres the one that i is, or -1 */
static int lp_pairs_of(sd_ewald_large_pairs *p, const double *x, double a, int mine)
{
  const double range2 = p->ewald.range * p->ewald.range;
  for (sd_cells_walk w = sd_cells_near(&p->cells, x, p->ewald.range); sd_cells_step(&p->cells, &w);)
    for (int k = w.first; k >= 0; k = p->cells.next[k]) {
      const double *y = p->image + 3 * (long) k, r[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
      const double R2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
      const int l = p->image_of[k], itself = mine >= 0 && l == p->first + mine && R2 == 0.0;
      if (R2 > range2 || itself) continue;
      if (!lp_add_pair(p, l, r, a, p->large[l].a)) return 0;
    }
  return 1;
}

sd_status sd_ewald_large_pairs_place(sd_ewald_large_pairs *p, const sd_spheres *s, const int *list,
                                     int n, const sd_world *world)
{
  sd_status status = share_larges(p, s, list, n, world);
  if (status == SD_OK) status = find_images(p, s, list, n);
  if (status != SD_OK) return status;
  if (!sd_reserve(&p->begin, sizeof(long), (size_t) n + 1, &p->begin_room)) return SD_ENOMEMORY;
  p->pairs = 0;
  int large = 0;
  for (int i = 0; i < n; i++) {
    const int j = list[i], mine = s->a[j] >= p->from ? large++ : -1;
    p->begin[i] = p->pairs;
    if (!lp_pairs_of(p, s->x + 3 * (long) j, s->a[j], mine)) return SD_ENOMEMORY;
  }
  p->n = n;
  p->begin[n] = p->pairs;
  return SD_OK;
}

/* --- product --- */

/* u += c a x b */
static void add_cross(double c, const double *a, const double *b, double *u)
{
  u[0] += c * (a[1] * b[2] - a[2] * b[1]);
  u[1] += c * (a[2] * b[0] - a[0] * b[2]);
  u[2] += c * (a[0] * b[1] - a[1] * b[0]);
}

/* u += M F; turned: of the other sphere of the pair, r -> -r and its c instead. */
static void add_pair_product(const double *t, int width, int turned, const double *F, double *u)
{
  const double along = t[4] * (t[0] * F[0] + t[1] * F[1] + t[2] * F[2]);
  for (int d = 0; d < 3; d++) u[d] += t[3] * F[d] + along * t[d];
  if (width < 6) return;
  const double sign = turned ? -1.0 : 1.0, cij = sign * t[turned ? 6 : 5];
  const double cji = sign * t[turned ? 5 : 6];
  const double spin = t[8] * (t[0] * F[3] + t[1] * F[4] + t[2] * F[5]);
  add_cross(cji, F + 3, t, u);
  add_cross(cij, F, t, u + 3);
  for (int d = 0; d < 3; d++) u[3 + d] += t[7] * F[3 + d] + spin * t[d];
}

/* w F of all large spheres */
static sd_status lp_load(sd_ewald_large_pairs *p, const sd_world *world, const double *F)
{
  const long m = p->width;
  memset(p->F, 0, sizeof(double) * 6 * (size_t) p->larges);
  memset(p->u, 0, sizeof(double) * 6 * (size_t) p->larges);
  for (int l = 0; l < p->ours; l++)
    for (int d = 0; d < m; d++)
      p->F[6L * (p->first + l) + d] = p->large[p->first + l].w * F[m * p->sphere[l] + d];
  return sd_world_sum(world, p->F, 6 * p->larges);
}

sd_status sd_ewald_large_pairs_apply(sd_ewald_large_pairs *p, const sd_spheres *s, const int *list,
                                     const sd_world *world, const double *F, double *u)
{
  const long m = p->width, many = lp_numbers(p);
  sd_status status = lp_load(p, world, F);
  if (status != SD_OK) return status;
  for (int i = 0; i < p->n; i++) {
    const long j = list[i];
    const int small = s->a[j] < p->from;
    double own[6] = {0.0}, felt[6] = {0.0};
    for (int d = 0; d < m; d++) own[d] = s->w[j] * F[m * j + d];
    for (long k = p->begin[i]; k < p->begin[i + 1]; k++) {
      add_pair_product(p->tensor + many * k, p->width, 0, p->F + 6L * p->other[k], felt);
      if (small)
        add_pair_product(p->tensor + many * k, p->width, 1, own, p->u + 6L * p->other[k]);
    }
    for (int d = 0; d < m; d++) u[m * j + d] += s->w[j] * felt[d];
  }
  status = sd_world_sum(world, p->u, 6 * p->larges);
  for (int l = 0; l < p->ours && status == SD_OK; l++) {
    const long j = p->sphere[l];
    const double w = s->w[j], b = sd_ewald_b(&p->ewald, s->a[j]), *D = p->origin;
    const double self = D[SD_I0] - 2.0 * b * D[SD_I1] + b * b * D[SD_I2];
    for (int d = 0; d < m; d++) {
      const double own = w * (d < 3 ? self : 0.25 * D[SD_I1]) * F[m * j + d];
      u[m * j + d] += w * (p->u[6L * (p->first + l) + d] - own);
    }
  }
  return status;
}
