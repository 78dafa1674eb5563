/* Between surface tension and its loops, of which each instruction set has its own build. Rows of particles
 * that a loop passes over, as those that are deep, are left as they are. */
#ifndef SD_SPH_TENSION_INTERNAL_H
#define SD_SPH_TENSION_INTERNAL_H

#include "sd_isa.h"
#include "sd_sph_tension.h"

/* Those that are not deep; the k-th is i. */
#define NEAR_COUNT(f) ((f)->near ? (f)->count : (f)->list->n)
#define EACH_NEAR(f, k, i) (int k = 0, i; k < NEAR_COUNT(f) && (i = (f)->near ? (f)->near[k] : k, 1); k++)

typedef struct {
  /* sums [8 n], without the particle itself; without walls 0 of those inside */
  void (*sums)(const sd_sph_film *, double *sums);
  /* of fluid with Sw > 0: adds to beside */
  void (*wet_walls)(const sd_sph_film *, const double *contact, const sd_sph_film_rows *);
  /* turns of w > 0; and fills the skin */
  void (*turns)(const sd_sph_film *, const sd_sph_film_rows *, const double *v4, const sd_sph_skin *);
  /* sum w V W k [n] of w > 0, without itself; 0 of others that are not deep */
  void (*means)(const sd_sph_film *, const sd_sph_skin *, const double *k, double *sums);
  /* of fluid with w = 0: mean [n] of k, 0 where no surface is in reach; sum w V W to its turns; and G to
   * whole, where sums have passed over it */
  void (*inwards)(const sd_sph_film *, const sd_sph_film_rows *, const double *k, double *mean);
} sd_sph_film_loops;
SD_KERNEL_TABLES(sd_sph_film_loops, sd_sph_film_loops);

#endif
