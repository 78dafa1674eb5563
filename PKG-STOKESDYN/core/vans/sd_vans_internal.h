/* What the files of this room share and nobody else needs. */
#ifndef SD_VANS_INTERNAL_H
#define SD_VANS_INTERNAL_H

#include "sd_constants.h"
#include "sd_vans.h"

#include <math.h>

/* Volume of a sphere between its equator and the height s, |s| <= a: integral of pi (a^2 - s^2). */
static inline double primitive(double a2, double s)
{
  return SD_PI * s * (a2 - s * s / 3.0);
}

/* A sphere cut by the slices, part by part from its lowest point up. */
typedef struct {
  /* slice of the part, -1: below the mesh, N: above it; its volume */
  int n;
  double V;
  /* its upper end above the centre, and the primitive there; height of the centre above z_ref */
  double top, sum, height;
} sd_vans_part;

/* The part in which the lowest point is has no volume yet: sd_vans_next_part gives it. */
static inline sd_vans_part sd_vans_lowest_part(const sd_vans_mesh *mesh, double z, double a)
{
  return (sd_vans_part){sd_vans_slice_of(mesh, z - a) - 1, 0.0, -a, primitive(a * a, -a),
                        z - mesh->z_ref};
}

/* 0: that was the last one. */
static inline int sd_vans_next_part(const sd_vans_mesh *mesh, double a, sd_vans_part *part)
{
  if (!(part->top < a)) return 0;
  part->n++;
  part->top = part->n < mesh->ncell ? mesh->edge[part->n + 1] - part->height : a;
  const double sum = primitive(a * a, part->top < a ? part->top : a);
  part->V = sum > part->sum ? sum - part->sum : 0.0; /* rounding must not make it < 0 */
  part->sum = sum > part->sum ? sum : part->sum;
  return 1;
}

/* The water at a height: velocity along x and z, hindrance. */
typedef struct {
  double u, w, hindrance;
} sd_vans_water;

static inline double speed_of(const double w[3])
{
  return sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
}

/* Of slice n; n < 0: below the mesh, n >= N: above it. */
static inline sd_vans_water sd_vans_water_in(const sd_vans_ambient *stream, int n)
{
  const sd_vans_mesh *mesh = stream->mesh;
  const sd_vans_force_law *law = stream->law;
  const int N = mesh->ncell, seen = n < 0 ? 0 : n < N ? n : N - 1;
  const double upward = !law->upward ? 0.0 : n >= 0 && n < N ? law->upward[n] : law->flux;
  return (sd_vans_water){stream->U[n < 0 ? 0 : seen + 1], upward, stream->hindrance[seen]};
}

/* Velocity past grain i, size of it out. */
static inline double velocity_past(const sd_vans_grains *grains, int i, sd_vans_water water,
                                   double w[3])
{
  const double *v = grains->v + 3 * (long) i;
  w[0] = water.u - v[0];
  w[1] = -v[1];
  w[2] = water.w - v[2];
  if (grains->fluctuation)
    for (int d = 0; d < 3; d++) w[d] += grains->fluctuation[3 * (long) i + d];
  return speed_of(w);
}

/* F += share times the drag of grain i, were it all in this water. */
static inline void sd_vans_add_drag(const sd_vans_force_law *law, const sd_vans_grains *grains,
                                    int i, sd_vans_water water, double share, double F[3])
{
  double w[3];
  const double speed = velocity_past(grains, i, water, w);
  const double factor =
      sd_drag_factor(law->drag, law->rho, law->eta, grains->a[i], water.hindrance, speed);
  for (int d = 0; d < 3; d++) F[d] += share * factor * w[d];
}

#define SD_VANS_SMOOTH 0.32 /* of the laws of smooth walls */

/* --- sd_vans_series.c: series in s of the friction of the walls ------------------------------- */

/* Terms of ln(1 + s) */
extern const double sd_vans_log_series[SD_VANS_FRICTION_TERMS];

/* What the terms below n add to n q_n r_0 = n r_n - sum k q_k r_(n-k), the series q = ln r. */
double sd_vans_lower_terms(int n, const double *q, const double *r);

/* The series of r^-2 from those of r and q = ln r, as far as the next term is below 1e-14 f_0. */
void sd_vans_inverse_square(const double *r, const double *q, sd_vans_friction *near);

#endif
