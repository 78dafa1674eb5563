/* Between the sums of SPH and their loops, of which each instruction set has its own build. */
#ifndef SD_SPH_INTERNAL_H
#define SD_SPH_INTERNAL_H

#include "sd_isa.h"
#include "sd_sph_sums.h"

/* The loops of one instruction set */
typedef struct {
  double (*forces)(const sd_sph_model *, const sd_sph_list *, const sd_sph_particles *, int,
                   double *, double *);
  double (*slopes)(const sd_sph_model *, const sd_sph_both *, const sd_sph_particles *, double *,
                   double *);
  void (*rates)(const sd_sph_model *, const sd_sph_list *, const sd_sph_particles *, double *,
                const sd_sph_near *);
  void (*middle)(const sd_sph_model *, const sd_sph_both *, const sd_sph_particles *, double *,
                 const sd_sph_near *);
  void (*diffusion)(const sd_sph_model *, const sd_sph_both *, const sd_sph_particles *, double *);
  void (*gradients)(const sd_sph_model *, const sd_sph_list *, const sd_sph_particles *, double *);
  void (*weigh)(const sd_sph_model *, const sd_sph_list *, const sd_sph_particles *, const double *,
                double *);
  void (*before_walls)(const sd_sph_model *, const sd_sph_list *, const sd_sph_particles *,
                       const double *, const double *, double *);
} sd_sph_loops;
SD_KERNEL_TABLES(sd_sph_loops, sd_sph_loops);

#endif
