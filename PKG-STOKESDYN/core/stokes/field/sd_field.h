/* The flow around spheres at the points of a regular grid, from the forces and torques on them.
 *
 *   u(x) = sum_j [ (1 + a_j^2/6 lap) G(x - x_j) F_j + 1/(8 pi) T_j x (x - x_j)/|x - x_j|^3 ] / eta
 *
 * G: Oseen's tensor, over all periodic images where the box is periodic (then against zero flux of
 * the mixture). It is the mobility of sd_tensor.h with a sphere of radius 0 for the point: within a
 * sphere its overlapping form, F/(6 pi eta a) + T x (x - x_j)/(8 pi eta a^3), so that nothing
 * jumps. What flows without the spheres is not in it.
 *
 * Points are a grid, because then a window is interpolated one direction after the other and the
 * near part goes by blocks of points: 10^6 points cost as much as two products of 10^5 spheres.
 *
 * Every rank has the points of some planes, and needs the sources that are near to these; the
 * transforms are shared. */
#ifndef SD_FLOW_FIELD_H
#define SD_FLOW_FIELD_H

#include "sd_ewald.h"
#include "sd_ewald_cells.h"
#include "sd_ewald_waves.h"
#include "sd_status.h"
#include "sd_world.h"

SD_BEGIN_C

/* Point (i, j, k) at lo + (i, j, k) step; ours are those of the planes from <= k < to.
 *   lo [3], step [3]   length, step > 0 */
typedef struct {
  double lo[3], step[3];
  int n[3], from, to;
} sd_field_grid;

/* How many points are ours */
static inline size_t sd_field_points(const sd_field_grid *g)
{
  return (size_t) g->n[0] * (size_t) g->n[1] * (size_t) (g->to - g->from);
}

/* Spheres, or points of their shells.
 *   x [3n]        centres                                 length
 *   a [n]         radii >= 0; 0: a point force            length
 *   F, T [3n]     on the fluid, over its viscosity        length velocity, length^2 velocity
 *                 T NULL: there are none */
typedef struct {
  int n;
  const double *x, *a, *F, *T;
} sd_field_sources;

/* What the choice of a sum must know of the sources of all ranks */
typedef struct {
  /* radii may be 0 */
  sd_ewald_class all;
  /* sums of |T|, and of every number of a source: no number if one is none */
  double torque, check;
  /* [3] where the centres are; none: lo > hi */
  double lo[3], hi[3];
} sd_field_cloud;

/* Of some sources. Of all ranks: the largest, lo and hi of all, and sums of everything else. */
void sd_field_measure(const sd_field_sources *s, sd_field_cloud *out);

/* AUTO: in an open box all pairs or a split sum, whichever costs less, counted */
typedef enum { SD_FIELD_AUTO, SD_FIELD_DIRECT, SD_FIELD_SPLIT } sd_field_sum;

/* How a field is summed */
typedef struct {
  int split, width;
  double tolerance, scale;
  sd_ewald ewald;
} sd_field_how;

/* What is kept between two fields: tables of the split sum and memory. Zero-initialise;
 * sd_field_free in the end. */
typedef struct {
  sd_field_how how;
  /* of the last split sum; the box that an open one was made for */
  sd_ewald ewald;
  int ready, width;
  sd_ewald_waves waves;
  int degree, floats;
  double coefficient[SD_RADIALS][SD_RADIAL_TERMS], tail[3];
  sd_ewald_box around;
  /* sources as the kernels read them */
  double *source, *scratch;
  size_t source_room, scratch_room;
  /* sources in order of cells of a range a side, and what these need */
  sd_ewald_cells cells;
  double *centre;
  size_t centre_room;
} sd_field;

/* The sum for these sources and this grid, before its parts are added: the same on every rank.
 *   tolerance   rms error of a split sum over the rms of F/(6 pi eta a): 1e-13 ... 1e-1
 *   range       out: a split sum, for sd_field_add_split, which must know all sources and images
 *               that are so near to a point of ours; INFINITY: all pairs, for sd_field_add_all
 * SD_OK, SD_ENOMEMORY for a grid of waves that is too large, SD_ENOTFINITE for numbers that are
 * none. */
sd_status sd_field_plan(sd_field *f, sd_field_sum how, const sd_ewald_box *box, double tolerance,
                        const sd_field_cloud *all, const sd_field_grid *g, double *range);

/* The flow u [3 sd_field_points] of some of the sources, x fastest, added to what is there; those
 * of all ranks come one after the other. SD_OK or SD_ENOMEMORY, on this rank alone. */
sd_status sd_field_add_all(sd_field *f, const sd_field_sources *some, const sd_field_grid *g,
                           double *u);

/* The same of all sources, on all ranks together. ours: each source is on one rank; near: within
 * the range of our points, periodic images among them. SD_OK, SD_ENOMEMORY (also on this rank
 * alone) or what world said. */
sd_status sd_field_add_split(sd_field *f, const sd_field_sources *ours,
                             const sd_field_sources *near, const sd_field_grid *g,
                             const sd_world *world, double *u);

void sd_field_free(sd_field *f);

/* Spheres as they move: those that touch our planes, periodic images among them.
 *   x [3n], a [n], V [6n]   centre, radius, velocity and angular velocity */
typedef struct {
  int n;
  const double *x, *a, *V;
} sd_field_bodies;

/* Puts V + W x r in the place of u at our points within a sphere, and a 1 into inside
 * [sd_field_points], 0 elsewhere. Where spheres overlap the point belongs to that of which it is
 * nearest to the centre, in radii. SD_OK or SD_ENOMEMORY. */
sd_status sd_field_inside(const sd_field_bodies *b, const sd_field_grid *g, double *u,
                          unsigned char *inside);

SD_END_C
#endif
