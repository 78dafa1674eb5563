/* What a tolerance asks of a splitting: how far the near part must reach, how fine the grid is, how wide the
 * windows are, in measures of each other. Between the parts of the rule of sd_ewald.h. */
#ifndef SD_EWALD_SPLITTING_INTERNAL_H
#define SD_EWALD_SPLITTING_INTERNAL_H

#include "sd_ewald_chosen.h"
#include "sd_ewald_sizes.h"

/* How H falls: as a Gaussian, or to 0 at a band (sd_radial.h). For the same error a band needs less than
 * half of the grid. The functions of a Gaussian are known in closed form, which a wall in an open box and two
 * levels (sd_ewald_levels.h) want. */
typedef enum { GAUSSIAN, BAND } fall;

/* What a splitting must know of the spheres and of what is asked */
typedef struct {
  fall fall;
  sd_ewald_class spheres;
  /* all radii are alike; windows are differentiated, for unlike radii and for torques */
  int width, equal, slopes;
  /* that of H; of xi times the largest radius */
  double a_ref, most;
  /* in a slab, else 0: the longest range that saves anything; gap of sd_ewald_choose_in_slab; the range
   * that is tried over that of a cube; is the slab a tower? */
  double farthest, gap, times;
  int tall;
  /* is the box open? Are there images in a wall of it? */
  int open, at_wall;
  /* unlike spheres with windows of five points (sd_splitting_five_do) */
  int five;
} splitting;

/* The tolerance t after what large spheres and torques lose: those larger than 1/xi have large wave and near
 * parts that cancel. y = xi range, which is smaller for a band, and its windows mistake more. The functions
 * below take t. */
double sd_splitting_tightened(const splitting *by, double tolerance, double xi_y);

/* The t with which y and spacing keep what is left beyond the range below the tolerance, whichever spheres
 * bear the forces; t: what xi and the range are from. Gaussians leave no more than is asked for: t */
double sd_splitting_beyond(const sd_ewald *e, const splitting *by, double t);

/* y; that of a Gaussian, whose near part falls as exp(-y^2) */
double sd_splitting_y(const sd_ewald_box *box, const splitting *by, double t);
double sd_splitting_gaussian_y(const sd_ewald_box *box, double t);

/* Of a band, xi with which H leaves least beyond the range */
double sd_splitting_xi(const sd_ewald *e);

/* The range of a band in spacings. And the largest spacing, for e->xi and e->range; that of a Gaussian */
double sd_splitting_band_spacings(const sd_ewald_box *box, const splitting *by, double t);
double sd_splitting_spacing(const sd_ewald *e, const splitting *by, double t, double y);
double sd_splitting_gaussian_spacing(double xi, double y);

/* How much finer the grid is where windows mistake more than elsewhere: range and band stay */
double sd_splitting_finer(const splitting *by);

/* The window: its points, and beta for these */
int sd_splitting_points(double t);
int sd_splitting_points_of(const splitting *by, double tolerance, double xi_y, double t);
double sd_splitting_beta(const splitting *by, int points);

/* Between two walls: is the range not much shorter than the gap? */
int sd_splitting_narrow(const sd_ewald *e, const splitting *by);

/* Of e, whose grid is laid and whose waves end at a band: the bend of the window and a smaller beta with
 * which equal spheres on one plane, which all have the same place on the grid across it, mistake least under
 * equal forces. Points, grid and range stay. */
void sd_splitting_fit_planes(sd_ewald *e, const splitting *by);

/* Where the rule asks for six points: would five do, and what came of these, is it within the tolerance? */
int sd_splitting_five_may_do(const sd_ewald *e, const splitting *by);
int sd_splitting_five_do(const sd_ewald *e);

/* What this window mistakes of the flow that all spheres of an open box have in common under equal forces,
 * over F/(6 pi eta a): it grows as N^(1/3). 0 in a periodic box, where such a flow is that of k = 0 alone */
double sd_splitting_common_flow(const sd_ewald *e);

#endif
