/* Equations of state P(rho) of weakly compressible SPH and their inverses.
 *   absolut   P = B^2 rho
 *   relativ   P = B (rho - rho0) + P0
 *   Tait      P = B ((rho / rho0)^gamma - 1) + P0
 * B: velocity (absolut), velocity^2 (relativ), pressure (Tait: c^2 rho0 / gamma for a speed of
 * sound c).
 * Without tension P is P0 below rho0: a fluid in open air comes apart and leaves a gap there, in
 * place of pulling. */
#ifndef SD_SPH_PRESSURE_H
#define SD_SPH_PRESSURE_H

#include "sd_extern_c.h"

SD_BEGIN_C

typedef enum { SD_SPH_ABSOLUT, SD_SPH_RELATIV, SD_SPH_TAIT } sd_sph_state_kind;

typedef struct {
  sd_sph_state_kind kind;
  double B, rho0, gamma, P0;
  /* 1: P is P0 below rho0; not for absolut */
  int no_tension;
} sd_sph_state;

/* P of a density > 0. */
double sd_sph_pressure(const sd_sph_state *state, double rho);

/* The density > 0 that has the pressure P; 0 if there is none. Without tension rho0 of all P below P0. */
double sd_sph_density_of(const sd_sph_state *state, double P);

/* sqrt(dP / drho) of a density > 0. */
double sd_sph_speed_of_sound(const sd_sph_state *state, double rho);

/* The pressure of no density at all: those of all densities are above it. */
double sd_sph_least_pressure(const sd_sph_state *state);

/* Without tension: densities [n] of the particles i with mask[i] & bit are SD_SPH_THINNEST rho0 at
 * least. Nothing pulls on a particle that has come off, and the rate of its density, which counts all
 * that goes away from it as room for itself, would make it thinner and larger without an end. But spray
 * must become as thin as it is before it comes together: what it lacks of that it takes for compression,
 * and pushes before it is one fluid again. */
static const double SD_SPH_THINNEST = 0.3;
void sd_sph_keep_size(const sd_sph_state *state, int n, double *rho, const int *mask, int bit);

/* That of the water in a particle of the density rho: without tension one that is thinner than rho0 is
 * water that has come apart, with air in between. */
double sd_sph_density_of_water(const sd_sph_state *state, double rho);

/* P [n] of the particles i with mask[i] & bit; the others keep theirs. */
void sd_sph_pressures(const sd_sph_state *state, int n, const double *rho, const int *mask, int bit,
                      double *P);

SD_END_C
#endif
