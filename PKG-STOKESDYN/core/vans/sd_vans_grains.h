/* The mesh of a stream, and the grains in it: what the stream does to them, and their averages over slices.
 * sd_vans.h says what slices, arrays and rules are. */
#ifndef SD_VANS_GRAINS_H
#define SD_VANS_GRAINS_H

#include "sd_drag.h"
#include "sd_status.h"

#include <stdint.h>

SD_BEGIN_C

typedef enum { SD_VANS_CONSISTENT, SD_VANS_YADE } sd_vans_rules;

/* ---- mesh ------------------------------------------------------------------------------------ */

typedef struct {
  /* N >= 2 */
  int ncell;
  /* height of the bottom */
  double z_ref;
  /* > 0: all slices alike, e_n = n dz; 0: the edges say */
  double dz;
  /* [N+1] heights above z_ref, also for equal slices */
  const double *edge;
} sd_vans_mesh;

/* Slice of the height z: -1 below the mesh, N above it. */
int sd_vans_slice_of(const sd_vans_mesh *mesh, double z);

static inline double sd_vans_height(const sd_vans_mesh *mesh, int n)
{
  return mesh->dz > 0.0 ? mesh->dz : mesh->edge[n + 1] - mesh->edge[n];
}

/* ---- grains ---------------------------------------------------------------------------------- */

typedef struct {
  int n;
  /* [n][3], [n][3], [n] */
  const double *x, *v, *a;
  /* [n][3] u', added to the velocity of the water; NULL: none */
  const double *fluctuation;
  /* [n] share of each sphere that counts (overlaps), in averages and forces; NULL: all of it */
  const double *weight;
  /* [n] 0 leaves a sphere out; NULL: all take part */
  const unsigned char *take;
  /* [n][3] for the added mass; NULL: none */
  const double *acceleration;
} sd_vans_grains;

/* Volume of the grains that take part, of each its share */
double sd_vans_volume_of_grains(const sd_vans_grains *grains);

/* The slices that a sphere reaches, from the first one on, >= 0, none with count 0; V[k] is its volume in
 * slice first + k */
typedef struct {
  int first, count;
  double *V;
} sd_vans_reach;

/* Volume of a sphere in each slice that it reaches: differences of one primitive, so that the parts
 * of any cut sum to 4/3 pi a^3 up to rounding.
 *   point   1: all of it is where its centre is
 *   z       height of its centre (not above z_ref: as LAMMPS has it)
 *   V       [N] room for that of what is returned
 * What lies outside the mesh is not in V. Yade's rule mirrors the slices at that of the centre and
 * cuts each only on its far side: for a/dz < 5 the volume is not conserved. */
sd_vans_reach sd_vans_slices(const sd_vans_mesh *mesh, sd_vans_rules rules, int point, double z,
                             double a, double *V);

typedef struct {
  /* density and dynamic viscosity of the fluid, > 0 */
  double rho, eta;
  /* of hindrance, n: drag * (1 - phi)^-n; 3.1 */
  double exponent;
  /* gravity */
  double g[3];
  /* 0: steady stream, no buoyancy along x; 1: fluid at rest */
  int rest;
  /* C_l; 0: none */
  double lift;
  /* [N] a force along x, taken off every grain of the slice; NULL: none */
  const double *convective;
  /* 0: a grain feels the water at its centre, and its drag is spread over the slices by volume.
   * 1: each slice of a grain feels the water there, in proportion to its volume, and gives the
   * drag back there: the grain feels the mean over its volume (of a drag linear in U, the mean
   * of U), and what water and grains exchange is symmetric slice by slice. Not with Yade's rule. */
  int felt_by_volume;
  sd_vans_rules rules;
  /* pressure gradient along x, which pushes a grain by its volume times that */
  double dpdx;
  /* which drag; zeros: Yade's */
  sd_drag_law drag;
  /* C: C rho V (dU/dt - dv/dt) with dU/dt [N+1] along x, at the centre of a grain; NULL: none */
  double added_mass;
  const double *rate;
  /* velocity of the water along z: [N] of the slices, and outside the mesh; NULL: none */
  const double *upward;
  double flux;
} sd_vans_force_law;

/* The stream as grains feel it: U [N+1] velocity of the water, hindrance [N] of sd_hindrance_of */
typedef struct {
  const sd_vans_mesh *mesh;
  const sd_vans_force_law *law;
  const double *U, *hindrance;
} sd_vans_ambient;

/* Force of the stream on the grains that take part, 0 on the others. Of members that overlap each
 * has its share of all of it, so that the buoyancy of a clump is that of its union.
 *   F       [n][3] out: drag, added mass, buoyancy, pressure gradient, lift, convective
 *   drag_x  [n] out or NULL: the part that the water takes back, drag and added mass along x
 * Returns the number of spheres with their centre outside the mesh. They feel the top (or bottom)
 * values: above U[N] and the phi of the last slice, below U[0] = 0 and the phi of the first. Yade's
 * rule: no force at all. */
int sd_vans_forces(const sd_vans_ambient *stream, const sd_vans_grains *grains, double *F, double *drag_x);

/* For the added mass: the velocity of a grain when it was seen last, and how much of a step lies between that
 * and the next one; 0: nothing is known */
typedef struct {
  double v[3], span;
} sd_vans_motion;
/* A run begins with the velocity of its step, half a step before the next that is seen. */
static inline void sd_vans_motion_begin(sd_vans_motion *m, const double v[3])
{
  for (int d = 0; d < 3; d++) m->v[d] = v[d];
  m->span = 0.5;
}
/* After a step of dt: dv/dt, which stays as it is where nothing is known */
static inline void sd_vans_motion_step(sd_vans_motion *m, const double v[3], double dt,
                                       double acceleration[3])
{
  for (int d = 0; d < 3; d++) {
    if (m->span > 0.0) acceleration[d] = (v[d] - m->v[d]) / (m->span * dt);
    m->v[d] = v[d];
  }
  m->span = 1.0;
}

/* The largest rate of the motion of a grain towards the water, and which grain: a step of velocity Verlet
 * must be shorter than 2/rate. Added mass has the acceleration of the step before, and so leaves less of the
 * grain's own inertia: with s = dF/dw dt/m and r = C rho V/m the velocities of steps have
 *   v'' = (1 - s - r) v' + r v,  stable for r < 1 and s < 2 (1 - r):  rate = dF/dw/(m - C rho V)
 * HUGE_VAL where that is nothing: no step is short enough. mass [n]. 0 if no grain takes part. */
double sd_vans_stiffest(const sd_vans_ambient *stream, const sd_vans_grains *grains, const double *mass,
                        int *stiffest);

/* Rows of a profile; in sums over grains the first is the volume, the others are volume times (vx,
 * vy, vz, drag along x). */
enum { SD_VANS_PHI, SD_VANS_VX, SD_VANS_VY, SD_VANS_VZ, SD_VANS_DRAG, SD_VANS_ROWS };

typedef struct {
  /* 1: all the volume of a grain in the slice of its centre */
  int point;
  /* size classes; 0: none */
  int nclass;
  /* [nclass]; a grain belongs to the class of exactly its radius, or, with bins, of its bin */
  const double *class_radius;
  /* [2][N] out, added to: force of the drag along x and along z in each slice, of grains of any
   * sizes; NULL: not wanted */
  double *density;
  /* [nclass+1] limits of bins, that rise; NULL: the classes are no bins */
  const double *class_limit;
} sd_vans_averaging;

/* The class of radius a: the one of exactly this radius, since radii are names (a grain that has
 * grown belongs to none: -1); with bins the one with limit_c <= a < limit_(c+1), where the first and
 * the last have all that is smaller and larger. */
int sd_vans_class_of(const sd_vans_averaging *how, double a);

/* Limits [n+1] of n bins of equal ratio from radius lo to radius hi, lo (hi/lo)^(c/n), as sieves
 * have them. 0 < lo <= hi. */
void sd_vans_bins(double lo, double hi, int n, double *limit);

/* Adds a^3 and a^2 of the grains to the sums [nclass][2] of their classes. */
void sd_vans_class_sums(const sd_vans_averaging *how, const sd_vans_grains *grains, double *sums);

/* Radius and volume [nclass] of bins from those sums: sum a^3 / sum a^2, Sauter's mean, with which
 * phi/V_c spheres have the volume and the surface of the grains; of an empty bin its geometric
 * middle and 0. */
void sd_vans_class_means(int nclass, const double *limit, const double *sums, double *radius,
                         double *volume);

/* Adds grains to the sums [1 + nclass][N][ROWS]: of all, then of each class. The drag is that of
 * the law, with the hindrance of the phi before this call, 0 for a grain with its centre
 * outside the mesh; with felt_by_volume in every slice that of the slip there. scratch [2 N], or
 * [3 N] with density.
 * Returns -1, or the index of the first sphere that belongs to no class.
 * Yade's rule: mirrored slices; the velocities of a class all in the slice of the centre. */
int sd_vans_average(const sd_vans_ambient *stream, const sd_vans_averaging *how,
                    const sd_vans_grains *grains, double *sums, double *scratch);

/* A profile from its sums [N][ROWS]: phi = V / (area * height of the slice), the others divided by
 * V, 0 where there is no grain. */
void sd_vans_profiles(const sd_vans_mesh *mesh, double area, const double *sums, double *profile);

/* The same of forces [2][N] in each slice (sd_vans_averaging): per volume of mixture */
void sd_vans_force_density(const sd_vans_mesh *mesh, double area, const double *forces, double *density);

/* Spreads one value of each sphere over the slices by their share of its volume: out [N] += value.
 * What belongs to the part of a sphere outside the mesh goes to the lowest or the highest slice, so
 * that the sum over slices grows by the sum over spheres. */
void sd_vans_spread(const sd_vans_mesh *mesh, int point, const sd_vans_grains *grains,
                    const double *value, double *out);

/* The integral of a density per volume of grains over each sphere: out [n] = sum over slices of V_k
 * density_k, times weight (or 1). */
void sd_vans_gather(const sd_vans_mesh *mesh, int point, const sd_vans_grains *grains,
                    const double *density, double *out);

/* Share of sphere i's volume that counts when n spheres that overlap are one body: its part of the
 * union, cut off from the others by their radical planes, over its volume. The sum over the spheres
 * is the volume of the union: exact while no three spheres overlap in one place, to 1e-6 of the
 * sphere otherwise. As many spheres may cut it as there are. x [n][3], a [n]. -1: out of memory. */
double sd_vans_union_share(int n, const double *x, const double *a, int i);
/* Are two of n spheres nearer than `part` of the sum of their radii? x [n][3] ascends along x, a [n] */
int sd_vans_any_nearer(int n, const double *x, const double *a, double part);

SD_END_C
#endif
