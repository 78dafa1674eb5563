/* Open ends of SPH. */
#ifndef SD_SPH_OPENING_H
#define SD_SPH_OPENING_H

#include "sd_extern_c.h"

SD_BEGIN_C

/* The discharge at a time, linear between n >= 1 rows of increasing times t [n] and discharges q [n];
 * before the first and after the last row it is that of this row. */
double sd_sph_hydrograph(int n, const double *t, const double *q, double time);

/* The flow through a section of a channel, on nodes across it: node (k0, k1) is at lo + k step, k < n, along
 * the two directions across the flow; in two dimensions n[1] = 1. A particle belongs to the nodes around it
 * with weights that are linear in its distance from them; beyond the first and last node to these. */
typedef struct {
  int n[2];
  double lo[2], step[2];
} sd_sph_section;

/* Adds a particle of mass m and speed v to the masses and momenta of the nodes, sums [2 n0 n1]. */
void sd_sph_section_add(const sd_sph_section *s, const double at[2], double m, double v, double *sums);

/* The mass at a place, linear between nodes: that of a node where as much surrounds it on all sides. */
double sd_sph_section_mass(const sd_sph_section *s, const double at[2], const double *sums);

/* The speed of the flow at a place, exact where it is linear in space and a particle stands at every node;
 * `otherwise` where there is none. */
double sd_sph_section_speed(const sd_sph_section *s, const double at[2], const double *sums,
                            double otherwise);

SD_END_C
#endif
