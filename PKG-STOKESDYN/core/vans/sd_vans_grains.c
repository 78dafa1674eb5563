#include "sd_constants.h"
#include "sd_vans.h"

#include <math.h>

int sd_vans_slice_of(const sd_vans_mesh *mesh, double z)
{
  const int N = mesh->ncell;
  const double height = z - mesh->z_ref;
  if (!(height >= 0.0)) return -1;
  if (mesh->dz > 0.0) {
    const double s = height / mesh->dz;
    return s >= N ? N : (int) s;
  }
  if (height >= mesh->edge[N]) return N;
  int lo = 0, hi = N; /* halved; edge[lo] <= height < edge[hi] */
  while (hi - lo > 1) {
    const int mid = (lo + hi) / 2;
    if (mesh->edge[mid] <= height)
      lo = mid;
    else
      hi = mid;
  }
  return lo;
}

/* Volume between the equator and the height s, |s| <= a: integral of pi (a^2 - s^2). */
static inline double primitive(double a2, double s)
{
  return SD_PI * s * (a2 - s * s / 3.0);
}

double sd_vans_slice_volume(double a, double lo, double hi)
{
  const double s0 = fmin(fmax(lo, -a), a), s1 = fmin(fmax(hi, -a), a);
  return primitive(a * a, s1) - primitive(a * a, s0);
}

/* Yade gives slice n the limits of slice 2p-n, p that of the centre, and cuts the sphere's lower
 * end only off the lower limit and its
 * upper end only off the upper one. */
static int slices_yade(const sd_vans_mesh *mesh, double z, double a, int *first, double *V, int max)
{
  const double height = z - mesh->z_ref, dz = mesh->dz;
  const double centre = floor(height / dz), offset = height - centre * dz;
  const double lowest = fmax(floor((height - a) / dz), 0.0),
               highest = fmin(floor((height + a) / dz), mesh->ncell - 1.0);
  if (!(lowest <= highest)) return 0;
  *first = (int) lowest;
  const int count = (int) (highest - lowest) + 1;
  for (int k = 0; k < count && k < max; k++) {
    const double above = lowest + k - centre;
    double s0 = (above - 1.0) * dz + offset, s1 = above * dz + offset;
    if (s0 < -a) s0 = -a;
    if (s1 > a) s1 = a;
    V[k] = SD_PI * (a * a * (s1 - s0) - (s1 * s1 * s1 - s0 * s0 * s0) / 3.0);
  }
  return count < max ? count : max;
}

int sd_vans_slices(const sd_vans_mesh *mesh, sd_vans_rules rules, double z, double a, int *first,
                   double *V, int max)
{
  if (rules == SD_VANS_YADE) return slices_yade(mesh, z, a, first, V, max);
  const int N = mesh->ncell;
  const double height = z - mesh->z_ref, a2 = a * a;
  int n = sd_vans_slice_of(mesh, z - a);
  if (n >= N || !(height + a > 0.0)) return 0;
  double below; /* primitive at the lower end of the slice */
  if (n < 0) {
    n = 0;
    below = primitive(a2, fmax(-height, -a));
  } else
    below = primitive(a2, -a);
  *first = n;
  int count = 0;
  while (n < N && count < max) {
    const double top = mesh->edge[n + 1] - height;
    const double value = primitive(a2, top < a ? top : a),
                 here = value > below ? value : below; /* rounding must not make V < 0 */
    V[count++] = here - below;
    below = here;
    if (top >= a) break;
    n++;
  }
  return count;
}

/* Richardson & Zaki: in a dense bed the drag on a grain is 20 times that on a lone one. */
void sd_vans_hindrance(int ncell, const double *phi, double exponent, double *hindrance)
{
  for (int n = 0; n < ncell; n++) hindrance[n] = phi[n] == 0.0 ? 1.0 : pow(1.0 - phi[n], -exponent);
}

/* Drag over velocity, 1/2 rho pi a^2 (0.44 |w| + 24.4 nu/2a) with one a taken out: Dallavalle's
 * form, Stokes' law for small |w| but for 24.4 in place of 24, 0.44 the constant of a blunt
 * body. */
static inline double drag_factor(double rho, double eta, double a, double hindrance,
                                 const double w[3])
{
  const double speed = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
  return 0.5 * SD_PI * a * (0.44 * rho * a * speed + 12.2 * eta) * hindrance;
}

void sd_vans_drag(double rho, double eta, double a, double hindrance, const double w[3],
                  double F[3])
{
  const double factor = drag_factor(rho, eta, a, hindrance, w);
  for (int d = 0; d < 3; d++) F[d] = factor * w[d];
}

/* Velocity past grain i of water that moves at u, and the drag on the grain over that velocity. */
static double drag_in(const sd_vans_force_law *law, const sd_vans_grains *grains, int i, double u,
                      double hindrance, double w[3])
{
  const double *v = grains->v + 3 * (long) i;
  w[0] = u - v[0];
  w[1] = -v[1];
  w[2] = -v[2];
  if (grains->fluctuation)
    for (int d = 0; d < 3; d++) w[d] += grains->fluctuation[3 * (long) i + d];
  return drag_factor(law->rho, law->eta, grains->a[i], hindrance, w);
}

/* Adds share V/whole of the drag of grain i in water of velocity u. */
static void add_drag(const sd_vans_force_law *law, const sd_vans_grains *grains, int i, double u,
                     double hindrance, double share, double F[3])
{
  double w[3];
  const double factor = drag_in(law, grains, i, u, hindrance, w);
  for (int d = 0; d < 3; d++) F[d] += share * factor * w[d];
}

/* Drag on grain i slice by slice. What lies outside the mesh sees the values of its ends. */
static void drag_by_volume(const sd_vans_mesh *mesh, const sd_vans_force_law *law, const double *U,
                           const double *hindrance, const sd_vans_grains *grains, int i,
                           double F[3])
{
  const int N = mesh->ncell;
  const double a = grains->a[i], z = grains->x[3 * (long) i + 2], height = z - mesh->z_ref,
               whole = 2.0 * primitive(a * a, a);
  double below = -0.5 * whole; /* primitive at the lower end of the slice */
  int n = sd_vans_slice_of(mesh, z - a);
  F[0] = F[1] = F[2] = 0.0;
  /* what is under the bottom sees water at rest */
  if (n < 0) {
    const double here = primitive(a * a, fmin(-height, a));
    add_drag(law, grains, i, U[0], hindrance[0], (here - below) / whole, F);
    below = here;
    n = 0;
  }
  for (; n < N && mesh->edge[n] - height < a; n++) {
    const double here = primitive(a * a, fmin(mesh->edge[n + 1] - height, a));
    add_drag(law, grains, i, U[n + 1], hindrance[n], (here - below) / whole, F);
    below = here;
  }
  add_drag(law, grains, i, U[N], hindrance[N - 1], 0.5 - below / whole, F);
}

/* Drag on grain i, centre in slice p. */
static void drag_on(const sd_vans_mesh *mesh, const sd_vans_force_law *law, const double *U,
                    const double *hindrance, const sd_vans_grains *grains, int i, int p,
                    double F[3])
{
  const int seen = p < 0 ? 0 : p < mesh->ncell ? p : mesh->ncell - 1;
  F[0] = F[1] = F[2] = 0.0;
  if (law->felt_by_volume)
    drag_by_volume(mesh, law, U, hindrance, grains, i, F);
  else
    add_drag(law, grains, i, p < 0 ? U[0] : U[seen + 1], hindrance[seen], 1.0, F);
}

/* Shear lift: dynamic pressure over the grain less that under it, with the water one radius above
 * and below its centre; nothing where one of the two is outside the water. */
static double lift_force(const sd_vans_mesh *mesh, const sd_vans_force_law *law, const double *U,
                         int p, double a, double vx)
{
  int upper, lower;
  if (mesh->dz > 0.0) {
    const double k = floor(a / mesh->dz);
    if (k > mesh->ncell) return 0.0;
    upper = p + (int) k;
    lower = p - (int) k;
  } else {
    upper = sd_vans_slice_of(mesh, mesh->z_ref + mesh->edge[p] + a);
    lower = sd_vans_slice_of(mesh, mesh->z_ref + mesh->edge[p + 1] - a);
  }
  if (upper >= mesh->ncell || lower <= 0) return 0.0;
  const double over = U[upper + 1] - vx, under = U[lower + 1] - vx;
  return 0.5 * law->rho * SD_PI * a * a * law->lift * (over * over - under * under);
}

int sd_vans_forces(const sd_vans_mesh *mesh, const sd_vans_force_law *law, const double *U,
                   const double *hindrance, const sd_vans_grains *grains, double *F,
                   double *drag_x)
{
  const unsigned char *take = grains->take;
  /* In a steady stream down a slope the pressure falls straight away from the bed: what gravity has
   * along x is carried by the stress, and grains have no buoyancy that way. */
  const double g[3] = {law->rest ? law->g[0] : 0.0, law->g[1], law->g[2]};
  int outside = 0;
  for (int i = 0; i < grains->n; i++) {
    double *Fi = F + 3 * (long) i;
    Fi[0] = Fi[1] = Fi[2] = 0.0; /* also of those that take no part */
    if (drag_x) drag_x[i] = 0.0;
    if (take && !take[i]) continue;
    const int p = sd_vans_slice_of(mesh, grains->x[3 * (long) i + 2]),
              inside = p >= 0 && p < mesh->ncell;
    if (!inside) outside++;
    if (!inside && law->rules == SD_VANS_YADE) continue;
    const double a = grains->a[i], displaced = 4.0 / 3.0 * SD_PI * a * a * a * law->rho;
    drag_on(mesh, law, U, hindrance, grains, i, p, Fi);
    if (drag_x) drag_x[i] = Fi[0];
    for (int d = 0; d < 3; d++) Fi[d] -= displaced * g[d];
    if (inside && law->lift != 0.0)
      Fi[2] += lift_force(mesh, law, U, p, a, grains->v[3 * (long) i]);
    if (inside && law->convective) Fi[0] -= law->convective[p];
  }
  return outside;
}

/* Exactly, since radii are names here: a grain that has grown belongs to no class. */
static int class_of(const sd_vans_averaging *how, double a)
{
  for (int c = 0; c < how->nclass; c++)
    if (how->class_radius[c] == a) return c;
  return -1;
}

static inline void add(double *sum, double V, const double *v, double drag)
{
  sum[SD_VANS_PHI] += V;
  sum[SD_VANS_VX] += V * v[0];
  sum[SD_VANS_VY] += V * v[1];
  sum[SD_VANS_VZ] += V * v[2];
  sum[SD_VANS_DRAG] += V * drag;
}

/* Adds one grain in its slices first to first + count - 1, in each with its volume there, the same
 * velocity and the drag of that slice. V, drag [count] */
static void add_slices(double *sums, int first, int count, const double *V, const double *v,
                       const double *drag)
{
  double *sum = sums + (long) first * SD_VANS_ROWS;
  for (int k = 0; k < count; k++) add(sum + k * SD_VANS_ROWS, V[k], v, drag[k]);
}

/* Yade: volume and drag where they are, velocities all in the slice p of the centre, if it is in
 * the mesh. */
static void add_slices_yade(double *sums, int first, int count, const double *V, const double *v,
                            const double *drag, double *centre)
{
  for (int k = 0; k < count; k++) {
    double *here = sums + (long) (first + k) * SD_VANS_ROWS;
    here[SD_VANS_PHI] += V[k];
    here[SD_VANS_DRAG] += V[k] * drag[k];
    if (!centre) continue;
    for (int d = 0; d < 3; d++) centre[SD_VANS_VX + d] += V[k] * v[d];
  }
}

/* The slices of a grain, or the one of its centre with all of its volume. */
static int slices_of(const sd_vans_mesh *mesh, sd_vans_rules rules, int point, double z, double a,
                     int *first, double *V)
{
  if (!point) return sd_vans_slices(mesh, rules, z, a, first, V, mesh->ncell);
  const int p = sd_vans_slice_of(mesh, z);
  if (p < 0 || p >= mesh->ncell) return 0;
  *first = p;
  V[0] = 4.0 / 3.0 * SD_PI * a * a * a;
  return 1;
}

/* Drag along x of grain i, were all of it in the slice: in each that it reaches, or, if it feels
 * the water at its centre, of that slice p in all of them. */
static void drag_of_slices(const sd_vans_mesh *mesh, const sd_vans_force_law *law, const double *U,
                           const double *hindrance, const sd_vans_grains *grains, int i,
                           const int slices[2], double *drag)
{
  const int p = sd_vans_slice_of(mesh, grains->x[3 * (long) i + 2]);
  double w[3], whole = 0.0;
  if (!law->felt_by_volume && p >= 0 && p < mesh->ncell)
    whole = drag_in(law, grains, i, U[p + 1], hindrance[p], w) * w[0];
  for (int k = 0, n = slices[0]; k < slices[1]; k++, n++) {
    drag[k] = whole;
    if (law->felt_by_volume) drag[k] = drag_in(law, grains, i, U[n + 1], hindrance[n], w) * w[0];
  }
}

int sd_vans_average(const sd_vans_mesh *mesh, const sd_vans_force_law *law,
                    const sd_vans_averaging *how, const double *U, const double *hindrance,
                    const sd_vans_grains *grains, double *sums, double *scratch)
{
  const int N = mesh->ncell;
  double *V = scratch, *drag = scratch + N;
  for (int i = 0; i < grains->n; i++) {
    if (grains->take && !grains->take[i]) continue;
    const double z = grains->x[3 * (long) i + 2], *v = grains->v + 3 * (long) i, a = grains->a[i];
    int slices[2] = {0, 0}; /* the first, how many */
    slices[1] = slices_of(mesh, law->rules, how->point, z, a, &slices[0], V);
    const int first = slices[0], count = slices[1];
    /* a share of the sphere is that share of each of its slices */
    if (grains->weight)
      for (int k = 0; k < count; k++) V[k] *= grains->weight[i];
    drag_of_slices(mesh, law, U, hindrance, grains, i, slices, drag);
    add_slices(sums, first, count, V, v, drag);
    if (how->nclass == 0) continue;

    const int c = class_of(how, a);
    if (c < 0) return i;
    double *class_sums = sums + (long) (1 + c) * N * SD_VANS_ROWS;
    const int p = sd_vans_slice_of(mesh, z), inside = p >= 0 && p < N;
    if (law->rules == SD_VANS_YADE)
      add_slices_yade(class_sums, first, count, V, v, drag,
                      inside ? class_sums + (long) p * SD_VANS_ROWS : 0);
    else
      add_slices(class_sums, first, count, V, v, drag);
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

/* The last of the shares is what is left of the value, so that none is lost to rounding. */
void sd_vans_spread(const sd_vans_mesh *mesh, int point, const sd_vans_grains *grains,
                    const double *value, double *out, double *V)
{
  const int N = mesh->ncell;
  for (int i = 0; i < grains->n; i++) {
    if (grains->take && !grains->take[i]) continue;
    const double z = grains->x[3 * (long) i + 2], ai = grains->a[i], height = z - mesh->z_ref,
                 all = 4.0 / 3.0 * SD_PI * ai * ai * ai;
    int first = 0;
    const int count = slices_of(mesh, SD_VANS_CONSISTENT, point, z, ai, &first, V);
    double inside = 0.0, rest = value[i];
    for (int k = 0; k < count; k++) inside += V[k];
    /* what is neither in the slices nor below them is above the mesh */
    const double below = point ? (height < 0.0 ? all : 0.0)
                               : sd_vans_slice_volume(ai, -ai, -height);
    for (int k = 0; k < count; k++) {
      const double part = value[i] * (V[k] / all);
      out[first + k] += part;
      rest -= part;
    }
    const double part = inside + below >= all * (1.0 - 1e-12) ? rest : value[i] * (below / all);
    out[0] += part;
    out[N - 1] += rest - part;
  }
}

void sd_vans_gather(const sd_vans_mesh *mesh, int point, const sd_vans_grains *grains,
                    const double *density, double *out, double *V)
{
  for (int i = 0; i < grains->n; i++) {
    out[i] = 0.0;
    if (grains->take && !grains->take[i]) continue;
    int first = 0;
    const int count = slices_of(mesh, SD_VANS_CONSISTENT, point, grains->x[3 * (long) i + 2],
                                grains->a[i], &first, V);
    for (int k = 0; k < count; k++) out[i] += V[k] * density[first + k];
    if (grains->weight) out[i] *= grains->weight[i];
  }
}
