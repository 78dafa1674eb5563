/* Between surface tension and its loops, of which each instruction set has its own build. Rows of particles
 * that a loop passes over are left as they are. */
#ifndef SD_SPH_TENSION_INTERNAL_H
#define SD_SPH_TENSION_INTERNAL_H

#include "sd_isa.h"
#include "sd_sph_tension.h"

typedef struct {
  /* sums [8 n], without the particle itself */
  void (*sums)(const sd_sph_film *, double *sums);
  /* of fluid with Sw > 0: adds c V W, c V g d | V W cos, V W sin, V W, 0 to rows [8] of more */
  void (*wet_walls)(const sd_sph_film *, const double *contact, const double *sums, double *more);
  /* of w > 0: rows [16] M | N | 0 */
  void (*turns)(const sd_sph_film *, const double *surface, const double *at_wall, double *rows);
  /* of fluid with a w > least: sum v V W k, sum v V W, without itself; carried [2 (all+1)] */
  void (*means)(const sd_sph_film *, const double *surface, double least, const double *carried,
                double *rows);
  /* of w > 0: adds w_a sum w_b V_b g (v.d)/r^2 d, times V_a and this factor, to F [3 n] */
  void (*rubs)(const sd_sph_film *, const double *surface, const double *v4, double factor, double *F);
} sd_sph_film_loops;
SD_KERNEL_TABLES(sd_sph_film_loops, sd_sph_film_loops);

#endif
