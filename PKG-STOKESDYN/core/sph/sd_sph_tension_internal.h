/* Between surface tension and its loops, of which each instruction set has its own build. Rows of particles
 * that a loop passes over, as those that are deep, are left as they are. */
#ifndef SD_SPH_TENSION_INTERNAL_H
#define SD_SPH_TENSION_INTERNAL_H

#include "sd_isa.h"
#include "sd_sph_tension.h"

/* Those that are not deep; the k-th is i. */
#define NEAR_COUNT(f) ((f)->near ? (f)->count : (f)->list->n)
#define EACH_NEAR(f, k, i) (int k = 0, i; k < NEAR_COUNT(f) && (i = (f)->near ? (f)->near[k] : k, 1); k++)

/* Are its sums asked for only where the surface is in reach, inwards? Where there are walls, sums say first
 * who is beside one. */
static inline int sd_sph_sums_wait(const sd_sph_film *f, int i)
{
  return !f->wall && f->x4[4 * (size_t) i + 3] < 0.0;
}

typedef struct {
  /* sums [8 n], without the particle itself; of the skin neighbor and count, of all that are near */
  void (*sums)(const sd_sph_film *, double *sums, const sd_sph_skin *);
  /* of fluid with Sw > 0: adds to beside */
  void (*wet_walls)(const sd_sph_film *, const double *contact, const sd_sph_film_rows *);
  /* the skin of w > 0, all of it */
  void (*turns)(const sd_sph_film *, const sd_sph_film_rows *, const double *v4, sd_sph_skin *);
  /* <k> of the skin */
  void (*means)(const sd_sph_skin *, const double *k, double *mean);
  /* of fluid with w = 0, by ks in rows of the surface: mean k, 0 where no surface is in reach; the rest of
   * whole */
  void (*inwards)(const sd_sph_film *, const sd_sph_film_rows *, double *mean);
} sd_sph_film_loops;
SD_KERNEL_TABLES(sd_sph_film_loops, sd_sph_film_loops);

#endif
