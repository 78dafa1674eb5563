#include "sd_sphere.h"
#include "sd_vans_internal.h"
#include "sd_vans_yade.h"

#include <stddef.h>

/* A sphere as sd_vans_next_part cuts it, or, with point, in one piece where its centre is. */
static int next_piece(const sd_vans_mesh *mesh, int point, double z, double a, sd_vans_part *part)
{
  if (!point) return sd_vans_next_part(mesh, a, part);
  if (!(part->top < a)) return 0;
  *part = (sd_vans_part){sd_vans_slice_of(mesh, z), sd_sphere_volume(a), a, 0.0, 0.0};
  return 1;
}

sd_vans_reach sd_vans_slices(const sd_vans_mesh *mesh, sd_vans_rules rules, int point, double z, double a,
                             double *V)
{
  if (rules == SD_VANS_YADE && !point) return sd_vans_yade_slices(mesh, z, a, V);
  sd_vans_reach reach = {0, 0, V};
  sd_vans_part part = sd_vans_lowest_part(mesh, z, a);
  while (next_piece(mesh, point, z, a, &part)) {
    if (part.n < 0 || part.n >= mesh->ncell) continue;
    if (reach.count == 0) reach.first = part.n;
    V[reach.count++] = part.V;
  }
  return reach;
}

static inline void grains_add(double *sum, double V, const double *v, double drag)
{
  sum[SD_VANS_PHI] += V;
  sum[SD_VANS_VX] += V * v[0];
  sum[SD_VANS_VY] += V * v[1];
  sum[SD_VANS_VZ] += V * v[2];
  sum[SD_VANS_DRAG] += V * drag;
}

/* Adds one grain in each of its slices with its volume there, the same velocity and the drag of that slice.
 * drag [count] */
static void add_slices(double *sums, const sd_vans_reach *reach, const double *v, const double *drag)
{
  double *sum = sums + (long) reach->first * SD_VANS_ROWS;
  for (int k = 0; k < reach->count; k++) grains_add(sum + k * SD_VANS_ROWS, reach->V[k], v, drag[k]);
}

/* Drag on grain i along x (and z), were all of it in the slice: in each that it reaches, or, if it
 * feels the water at its centre, of that slice p in all of them. */
static void drag_of_slices(const sd_vans_ambient *stream, const sd_vans_grains *grains, int i,
                           const sd_vans_reach *reach, double *along_x, double *along_z)
{
  const sd_vans_mesh *mesh = stream->mesh;
  const sd_vans_force_law *law = stream->law;
  const int p = sd_vans_slice_of(mesh, grains->x[3 * (long) i + 2]);
  const int inside = p >= 0 && p < mesh->ncell;
  double F[3] = {0.0, 0.0, 0.0};
  if (!law->felt_by_volume && inside)
    sd_vans_add_drag(law, grains, i, sd_vans_water_in(stream, p), 1.0, F);
  for (int k = 0, n = reach->first; k < reach->count; k++, n++) {
    if (law->felt_by_volume) {
      F[0] = F[1] = F[2] = 0.0;
      sd_vans_add_drag(law, grains, i, sd_vans_water_in(stream, n), 1.0, F);
    }
    along_x[k] = F[0];
    if (along_z) along_z[k] = F[2];
  }
}

/* Force per volume of mixture: each slice has the part of the grain's drag that it has of its
 * volume. */
static void add_density(double *density, int N, double a, const sd_vans_reach *reach, const double *along_x,
                        const double *along_z)
{
  const double whole = sd_sphere_volume(a);
  for (int k = 0; k < reach->count; k++) {
    density[reach->first + k] += reach->V[k] / whole * along_x[k];
    density[N + reach->first + k] += reach->V[k] / whole * along_z[k];
  }
}

int sd_vans_average(const sd_vans_ambient *stream, const sd_vans_averaging *how,
                    const sd_vans_grains *grains, double *sums, double *scratch)
{
  const sd_vans_mesh *mesh = stream->mesh;
  const sd_vans_force_law *law = stream->law;
  const int N = mesh->ncell;
  double *V = scratch, *drag = scratch + N, *upward = how->density ? scratch + 2 * N : 0;
  for (int i = 0; i < grains->n; i++) {
    if (grains->take && !grains->take[i]) continue;
    const double z = grains->x[3 * (long) i + 2], *v = grains->v + 3 * (long) i, a = grains->a[i];
    const sd_vans_reach reach = sd_vans_slices(mesh, law->rules, how->point, z, a, V);
    /* a share of the sphere is that share of each of its slices */
    if (grains->weight)
      for (int k = 0; k < reach.count; k++) V[k] *= grains->weight[i];
    drag_of_slices(stream, grains, i, &reach, drag, upward);
    add_slices(sums, &reach, v, drag);
    if (how->density) add_density(how->density, N, a, &reach, drag, upward);
    if (how->nclass == 0) continue;

    const int c = sd_vans_class_of(how, a);
    if (c < 0) return i;
    double *class_sums = sums + (long) (1 + c) * N * SD_VANS_ROWS;
    const int p = sd_vans_slice_of(mesh, z), inside = p >= 0 && p < N;
    if (law->rules == SD_VANS_YADE)
      sd_vans_yade_add_slices(class_sums, &reach, v, drag, inside ? class_sums + (long) p * SD_VANS_ROWS : NULL);
    else
      add_slices(class_sums, &reach, v, drag);
  }
  return -1;
}

void sd_vans_profiles(const sd_vans_mesh *mesh, double area, const double *sums, double *profile)
{
  const int N = mesh->ncell;
  /* means over volumes, not over grains: a slice through the edge of a grain counts it little */
  for (int n = 0; n < N; n++) {
    const double *sum = sums + (long) n * SD_VANS_ROWS, V = sum[SD_VANS_PHI];
    profile[n] = V / (area * sd_vans_height(mesh, n));
    for (int k = SD_VANS_VX; k < SD_VANS_ROWS; k++)
      profile[(long) k * N + n] = V != 0.0 ? sum[k] / V : 0.0;
  }
}

void sd_vans_force_density(const sd_vans_mesh *mesh, double area, const double *forces, double *density)
{
  const int N = mesh->ncell;
  for (int k = 0; k < 2 * N; k++) density[k] = forces[k] / (area * sd_vans_height(mesh, k % N));
}

/* The last of the shares is what is left of the value, so that none is lost to rounding. */
void sd_vans_spread(const sd_vans_mesh *mesh, int point, const sd_vans_grains *grains,
                    const double *value, double *out)
{
  const int N = mesh->ncell;
  for (int i = 0; i < grains->n; i++) {
    if (grains->take && !grains->take[i]) continue;
    const double z = grains->x[3 * (long) i + 2], a = grains->a[i],
                 whole = sd_sphere_volume(a);
    sd_vans_part part = sd_vans_lowest_part(mesh, z, a);
    double rest = value[i];
    while (next_piece(mesh, point, z, a, &part)) {
      const double share = part.top < a ? value[i] * (part.V / whole) : rest;
      out[part.n < 0 ? 0 : part.n < N ? part.n : N - 1] += share;
      rest -= share;
    }
  }
}

void sd_vans_gather(const sd_vans_mesh *mesh, int point, const sd_vans_grains *grains,
                    const double *density, double *out)
{
  for (int i = 0; i < grains->n; i++) {
    out[i] = 0.0;
    if (grains->take && !grains->take[i]) continue;
    const double z = grains->x[3 * (long) i + 2], a = grains->a[i];
    sd_vans_part part = sd_vans_lowest_part(mesh, z, a);
    while (next_piece(mesh, point, z, a, &part))
      if (part.n >= 0 && part.n < mesh->ncell) out[i] += part.V * density[part.n];
    if (grains->weight) out[i] *= grains->weight[i];
  }
}
