/* A box that is periodic in two directions and not in the third: spheres above a floor, in a
 * slit between two walls, or in a layer with nothing above and below but fluid. How their sum
 * over all images is split.
 *
 * M is the Green's function of the geometry averaged over the surfaces of both spheres, summed
 * over the cells: Rotne-Prager-Yamakawa with its overlaps, images in each wall (sd_wall.h), and
 * what two walls do together, which is smooth. So it is positive definite for every overlap
 * while no sphere cuts a wall; where one does, the whole matrix is that of heights within a ...
 * H - a.
 *
 *   M = near pairs [RPY - D] + near images in each wall [images - smooth part]
 *     + waves of a periodic box a little taller + columns (sd_columns.h) + means (below)
 *
 * D and the smooth part of images are those of sd_radial.h and sd_image_wave.h; the waves are
 * those of a periodic box, whose copies across the walls the columns take away, and put the
 * walls in.
 *
 * Mean along the walls, of a force F on an area S (waves k = 0), z: height above the first wall:
 *   layer            -|z - z'| F/(2S)
 *   floor            min(z, z') F/S
 *   slit             z_< (H - z_>) F/(S H)                         no mean pressure gradient
 *   slit, no flux    that - 3 z (H - z) z' (H - z') F/(S H^3)       no net flux along the walls
 * for spheres z^2 is z^2 + 2 a^2/6, and for each of its ends z (H - z) is z (H - z) - 2 a^2/6. A
 * force across moves nothing on average. In a layer the forces along it must add up to 0: else
 * the fluid above and below is sheared without end, and M is not positive. Source: own
 * derivation (sd_slab_wave.h); errors: unittest/bench/bench_slab.c. */
#ifndef SD_SLAB_H
#define SD_SLAB_H

#include "sd_ewald.h"
#include "sd_status.h"
#include "sd_wall.h"

SD_BEGIN_C

typedef enum { SD_SLAB_LAYER, SD_SLAB_FLOOR, SD_SLAB_SLIT } sd_slab_kind;

/* Where the walls are. Heights are counted from the first one into the fluid; those of a layer
 * from its `at` along the axis, with sign 1. */
typedef struct {
  sd_slab_kind kind;
  sd_wall wall[2];
  /* slit: distance of the walls, length; no net flux along them? */
  double height;
  int no_flux;
} sd_slab_walls;

/* What an engine is made from. Ready after sd_slab_choose. */
typedef struct {
  sd_slab_walls walls;
  /* the taller box, periodic, and images without a wall; count 0: no spheres, and the rest is
   * not read */
  sd_ewald ewald;
  /* heights that centres may have, of the lowest plane of the grid, and from plane to plane */
  double lo, hi, first, spacing;
} sd_slab;

/* Radii up to this ratio: the sum has one level */
static const double SD_SLAB_RATIO = 10.0;

/* Walls without anything else. A floor: one; a slit: the one that looks up and the one that
 * looks down; a layer: across axis. */
sd_slab_walls sd_slab_layer(int axis);
sd_slab_walls sd_slab_floor(const sd_wall *wall);
sd_slab_walls sd_slab_slit(int axis, double lo, double hi, int no_flux);

/* 0, 1 or 2 */
static inline int sd_slab_many_walls(const sd_slab_walls *walls)
{
  return (int) walls->kind;
}

static inline double sd_slab_height(const sd_slab_walls *walls, const double x[3])
{
  return sd_wall_height(walls->wall, x);
}

/* x, or where a sphere of radius a touches the wall that it cuts */
void sd_slab_keep_off(const sd_slab_walls *walls, const double x[3], double a, double out[3]);

/* The spheres that take part, of all ranks: how many of which size, the smallest radius, and heights of
 * the lowest and the highest centre; length */
typedef struct {
  sd_ewald_sizes sizes;
  double smallest, lo, hi;
} sd_slab_spheres;

/* The splitting, by a rule, the same on every rank. A floor and a layer have room for what spheres then
 * move, and the room of the last splitting if it is not too large.
 *   box        origin and edges along the walls; no tilt. Across them it is not read
 *   tolerance  rms error of U over rms of F/(6 pi eta a), as of sd_ewald_choose
 * SD_OK; SD_ENOTFINITE as sd_ewald_choose; SD_ENOMEMORY for a grid of more than 2^31 points.
 * *out may be the present splitting, or zero. */
sd_status sd_slab_choose(const sd_slab_walls *walls, const sd_ewald_box *box,
                         const sd_slab_spheres *spheres, double tolerance, sd_slab *out);

/* Do tables made for one serve the other? */
int sd_slab_same_tables(const sd_slab *made, const sd_slab *wanted);

/* Between walls without net flux the mean pressure gradient that keeps it at 0, of the forces of n
 * spheres on the fluid:
 *   gradient += 6/(S H^3) sum over spheres of (z (H - z) - 2 a^2/6) F,   along the walls; else += 0
 *   edge [3]      of the box, along the walls         length
 *   x, F [3n]     centres, forces                     length, force
 *   a [n]         radii; one that cuts a wall counts where it touches it
 *   gradient [3]  pressure/length */
void sd_slab_add_pressure_gradient(const sd_slab_walls *walls, const double edge[3], long n,
                                   const double *x, const double *a, const double *F,
                                   double gradient[3]);

SD_END_C
#endif
