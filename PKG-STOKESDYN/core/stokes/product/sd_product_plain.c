/* The product in plain C, pair by pair by the functions of sd_tensor.h and sd_wall.h: the same
 * tables as the vector kernels have, with vectors of one lane. Sums are times 8 pi: translation
 * needs 4/3 for its 6 pi, rotation has 8 pi of itself. */
#include <stddef.h>

#include "sd_product_internal.h"

typedef struct {
  double x[3], a;
} sphere;

typedef void pair_sum(const sd_law *law, const sphere *i, const sphere *j, const double *F,
                      double *u);

/* u [3] += f F + g rhat (rhat.F) */
static void add_force(const sd_law *law, const sphere *i, const sphere *j, const double *F,
                      double *u)
{
  const double dx = i->x[0] - j->x[0], dy = i->x[1] - j->x[1], dz = i->x[2] - j->x[2];
  const double R = sqrt(dx * dx + dy * dy + dz * dz), inv = R > 0.0 ? 1.0 / R : 0.0;
  const double hx = dx * inv, hy = dy * inv, hz = dz * inv;
  const double unit = 4.0 / 3.0 * sd_taper_factor(law, R);
  double f, g;
  if (law->tensor == SD_TENSOR_RPY)
    sd_rpy_radial(R, i->a, j->a, &f, &g);
  else
    sd_oseen_radial(R, &f, &g);
  f *= unit;
  const double along = unit * g * (hx * F[0] + hy * F[1] + hz * F[2]);
  u[0] += f * F[0] + along * hx;
  u[1] += f * F[1] + along * hy;
  u[2] += f * F[2] + along * hz;
}

/* u [6] += the block of sd_tensor_grand times (F T) [6]. The sphere i turns under the force on j by
 * cij F x rhat, and moves under the torque on j by cji T x rhat (reciprocity). */
static void add_force_and_torque(const sd_law *law, const sphere *i, const sphere *j,
                                 const double *F, double *u)
{
  const double dx = i->x[0] - j->x[0], dy = i->x[1] - j->x[1], dz = i->x[2] - j->x[2];
  const double R = sqrt(dx * dx + dy * dy + dz * dz), inv = R > 0.0 ? 1.0 / R : 0.0;
  const double hx = dx * inv, hy = dy * inv, hz = dz * inv, t = sd_taper_factor(law, R);
  const double *T = F + 3, unit = 4.0 / 3.0 * t;
  double f, g, fw, gw;
  sd_rpy_radial(R, i->a, j->a, &f, &g);
  sd_rpy_radial_wt(R, i->a, j->a, &fw, &gw);
  f *= unit;
  fw *= t;
  const double cij = t * sd_rpy_radial_wf(R, i->a, j->a), cji = t * sd_rpy_radial_wf(R, j->a, i->a);
  const double along = unit * g * (hx * F[0] + hy * F[1] + hz * F[2]);
  const double twist = t * gw * (hx * T[0] + hy * T[1] + hz * T[2]);
  u[0] += f * F[0] + along * hx + cji * (T[1] * hz - T[2] * hy);
  u[1] += f * F[1] + along * hy + cji * (T[2] * hx - T[0] * hz);
  u[2] += f * F[2] + along * hz + cji * (T[0] * hy - T[1] * hx);
  u[3] += fw * T[0] + twist * hx + cij * (F[1] * hz - F[2] * hy);
  u[4] += fw * T[1] + twist * hy + cij * (F[2] * hx - F[0] * hz);
  u[5] += fw * T[2] + twist * hz + cij * (F[0] * hy - F[1] * hx);
}

static double taper_of(const sd_law *law, const sphere *i, const sphere *j)
{
  const double dx = i->x[0] - j->x[0], dy = i->x[1] - j->x[1], dz = i->x[2] - j->x[2];
  return sd_taper_factor(law, sqrt(dx * dx + dy * dy + dz * dz));
}

/* u [width] += image part */
static void add_image(const sd_law *law, const sphere *i, const sphere *j, int width,
                      const double *F, double *u)
{
  const sd_wall_pair pair = sd_wall_pair_of(i->x, i->a, j->x, j->a);
  const double t = taper_of(law, i, j);
  double tapered[6];
  for (int d = 0; d < width; d++) tapered[d] = t * F[d];
  sd_wall_pair_add(&pair, width, tapered, u);
}

static void add_image_of_force(const sd_law *law, const sphere *i, const sphere *j, const double *F,
                               double *u)
{
  add_image(law, i, j, 3, F, u);
}

static void add_image_of_both(const sd_law *law, const sphere *i, const sphere *j, const double *F,
                              double *u)
{
  add_image(law, i, j, 6, F, u);
}

/* Vectors of `width` numbers; self: a sphere meets itself, as its image */
typedef struct {
  int width, self;
  pair_sum *add;
} rule;

/* A share is a range of targets, so a pair is computed twice, once for each of its spheres. Targets
 * are columns: those without radius have none. */
static void symmetric(const sd_packed *p, int part, int parts, const rule *of)
{
  const long n = p->active;
  for (int i = (int) (n * part / parts); i < n * (part + 1) / parts; i++) {
    const sphere target = {{p->x[i], p->y[i], p->z[i]}, p->a[i]};
    double sum[6] = {0.0}, F[6];
    for (int j = 0; j < p->active; j++) {
      if (j == i && !of->self) continue;
      const sphere source = {{p->x[j], p->y[j], p->z[j]}, p->a[j]};
      for (int d = 0; d < of->width; d++) F[d] = p->f[d][j];
      of->add(&p->law, &target, &source, F, sum);
    }
    for (int d = 0; d < of->width; d++) p->u[d][i] += sum[d];
  }
}

/* What the target gets of the sphere in row j */
static void add_row(const sd_packed *p, const rule *of, const sphere *target, long j, double *sum)
{
  const double *other = p->row + 8 * j;
  double F[6] = {0.0};
  if (!(other[3] > 0.0)) return;
  const sphere source = {{other[0], other[1], other[2]}, other[3]};
  for (int d = 0; d < 3; d++) F[d] = other[4 + d];
  for (int d = 3; d < of->width; d++) F[d] = p->torque_row[4 * j + d - 3];
  of->add(&p->law, target, &source, F, sum);
}

/* The pairs as they are listed; a source may be a ghost, or an image of the target itself. */
static void list(const sd_packed *p, const sd_pairs *pairs, const rule *of)
{
  for (int i = 0; i < pairs->n; i++) {
    const double *own = p->row + 8 * (long) i;
    const sphere target = {{own[0], own[1], own[2]}, own[3]};
    double sum[6] = {0.0};
    if (!(target.a > 0.0)) continue;
    if (of->self) add_row(p, of, &target, i, sum);
    for (long k = pairs->first[i]; k < pairs->first[i + 1]; k++)
      add_row(p, of, &target, pairs->neighbor[k], sum);
    for (int d = 0; d < of->width; d++) p->u[d][i] += sum[d];
  }
}

#define RULE(name, width, self, add)                                          \
  static const rule name = {width, self, add};                                \
  static void name##_symmetric(const sd_packed *p, int part, int parts)       \
  {                                                                           \
    symmetric(p, part, parts, &name);                                         \
  }                                                                           \
  static void name##_list(const sd_packed *p, const sd_pairs *pairs)          \
  {                                                                           \
    list(p, pairs, &name);                                                    \
  }
RULE(forces, 3, 0, add_force)
RULE(torques, 6, 0, add_force_and_torque)
RULE(images, 3, 1, add_image_of_force)
RULE(images_of_both, 6, 1, add_image_of_both)

const struct sd_kernels sd_product_plain = {{1, forces_symmetric, forces_list},
                                            {1, torques_symmetric, torques_list}};
const struct sd_kernels sd_wall_plain = {{1, images_symmetric, images_list},
                                         {1, images_of_both_symmetric, images_of_both_list}};
