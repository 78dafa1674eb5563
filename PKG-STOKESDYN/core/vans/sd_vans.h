/* A one-dimensional, volume-averaged turbulent stream over a granular bed: slice averages of the
 * grains, the force of the stream on a grain, turbulence closures, and the implicit solve of the
 * momentum of the water. No LAMMPS, no MPI, no files: the caller sums the slice averages over
 * ranks.
 *
 * Mesh. N = ncell slices, edges e_0 = 0 < e_1 < ... < e_N (heights above z_ref). The water fills
 * the M = N-1 lower slices; the last slice lies above the surface at H = e_M. Arrays and their
 * places:
 *   U   [N+1]                  velocity of the water: U[0] = 0 on the bottom, U[n+1] in the middle
 *                              of slice n < M, U[N] on the surface
 *   phi, v, drag, b, ...  [N]  one a slice
 *   nut, stress, length   [N]  at the lower edge (node) of each slice
 *   profile  [SD_VANS_ROWS][N] averages of the grains: phi, vx, vy, vz, drag
 *   classes  [nclass] profiles one after the other, one a size class; NULL: all are one class
 * A grain whose centre is in slice p sees U[p+1] and phi[p], nothing is interpolated; or, with
 * felt_by_volume, those of every slice that it reaches.
 *
 * Rules. SD_VANS_CONSISTENT is the physics. SD_VANS_YADE repeats Yade 2023.02a with its defects,
 * for those who must repeat a published run; where the two differ the functions below say so.
 *
 * Units: any in which force is mass times acceleration. Yade's two limits are in SI: the caller
 * converts them.
 *
 * Sources: Jackson 2000 (equations); Revil-Baudard & Chauchat 2013 (GJI 192) and Maurin, Chauchat,
 * Chareyre & Frey 2015 (Phys. Fluids 27, 113302) for this model; Li & Sawamoto 1995; Dallavalle
 * 1948 and Richardson & Zaki 1954 (drag); Graf & Altinakar 1998 (side walls). */
#ifndef SD_VANS_H
#define SD_VANS_H

#include "sd_vans_grains.h"

SD_BEGIN_C

/* ---- closures -------------------------------------------------------------------------------- */

typedef enum {
  SD_VANS_LAMINAR,
  SD_VANS_KZ,
  SD_VANS_PARABOLIC,
  SD_VANS_LI_SAWAMOTO,
  SD_VANS_PORE,
  SD_VANS_ROUSSEAU,
  SD_VANS_NI_CAPART,
  SD_VANS_PIPE
} sd_vans_turbulence;
typedef enum { SD_VANS_CONSTANT, SD_VANS_EINSTEIN, SD_VANS_POWER } sd_vans_viscosity;

typedef struct {
  double rho, eta;
  /* gravity along x, pressure gradient */
  double gx, dpdx;
  sd_vans_turbulence turbulence;
  double kappa, phi_max, phi_bed;
  /* 1: no eddy viscosity where z u_star / nu < 11.3 */
  int sublayer;
  sd_vans_viscosity viscosity;
  /* 0: free surface; 1: the surface moves at u_top */
  int driven;
  double u_top;
  /* 1: what drives the stream follows from the volume of water that passes per width and time; free
   * surface */
  int held;
  double discharge;
  /* side walls: distance, a factor on the friction, k_s; width 0: none */
  double width, wall_coef, wall_roughness;
  /* 1: mixing lengths are at most kappa width/2 */
  int narrow;
  /* mixing lengths are at least this many diameters where there are grains; 0: as the law has it */
  double bed_mixing;
  /* of the grains, in the exchange term */
  double radius;
  /* size classes of the exchange term and of the pore length; 0: one class of that radius */
  int nclass;
  const double *class_radius;
  /* [nclass] volume of the grains of each class, in the packed bed of rousseau; NULL: as many grains
   * of each */
  const double *class_volume;
  /* Yade's least slip in the exchange term, 1e-5 m/s, and longest life of an eddy, 10 s; for rules
   * yade only */
  double least_slip, longest_life;
  sd_vans_rules rules;
  /* of the grains, for what the exchange foresees; zeros: Yade's */
  sd_drag_law drag;
} sd_vans_fluid;

/* What drives the stream, an acceleration: gx - dpdx/rho. Yade's rule: |gx| for gx. */
double sd_vans_drive(const sd_vans_fluid *fluid);

/* What the laws of the mixing length ask of water and grains */
typedef struct {
  /* [N+1] velocity of the water (rousseau) */
  const double *U;
  /* [N] phi; and of each class, rows of SD_VANS_ROWS N, NULL: one class */
  const double *phi, *classes;
  /* [N] the (time-averaged) phi that marks the bed (ni_capart) */
  const double *bed;
} sd_vans_mixture;

/* Mixing length at every node, [N]; at least bed_mixing times the mean diameter of the grains in the
 * slices on both sides of the node, but for that on the bottom; between narrow walls at most
 * kappa width/2. scratch [2 N]
 * kz           kappa z
 * parabolic    kappa z sqrt(1 - z/H)
 * li_sawamoto  l_j = l_(j-1) + kappa dz (phi_max - p)/phi_max, p = phi of slice j-1 but phi_max
 *              everywhere below the highest slice that reaches it
 * pore         kappa times the distance down to where it outgrows half the pore length
 * rousseau     van Driest with the height made of pores, plus half the pore length of the packed
 *              bed
 * ni_capart    max(min(pore/2, 0.2 D), kappa (z - z_bed))
 * pipe         min(li_sawamoto, kappa (H - z))
 * Yade's rule: the slice that exceeds phi_max takes some length away (li_sawamoto, pipe). */
void sd_vans_mixing_length(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid,
                           const sd_vans_mixture *now, double *length, double *scratch);

/* Effective kinematic viscosity at a node of solid fraction phi: eta/rho times 1 (constant),
 * 1 + 2.5 phi (Einstein), (1 - phi)^-2.8 (power: Krieger & Dougherty's form). Yade's rule has
 * Einstein's at the node on the bottom, where `bottom` is 1, in place of the power. */
double sd_vans_effective_viscosity(const sd_vans_fluid *fluid, double phi, int bottom);

/* The friction factor near a Reynolds number: f(Re (1 + s)) = sum f_k s^k for |s| <= reach. Zeros:
 * nothing is known. */
enum { SD_VANS_FRICTION_TERMS = 4 };
typedef struct {
  /* 1/Re */
  double inverse;
  double reach;
  double f[SD_VANS_FRICTION_TERMS];
  /* k_s over the hydraulic radius, set by the caller; 0: smooth */
  double roughness;
} sd_vans_friction;

/* The length of the Reynolds number of the side walls, |U| length/nu: the hydraulic radius, area
 * over wetted perimeter. The law below has its 0.32 for that one; on the hydraulic diameter, four
 * times as long, it would be 0.32 - 2 log10(4) = -0.88 (smooth pipes: -0.8). A slice of water
 * touches the walls alone, what it passes to its neighbours is in the solve: width dz over 2 dz.
 * Yade's rule: the width. */
static inline double sd_vans_wall_length(const sd_vans_fluid *fluid)
{
  return fluid->rules == SD_VANS_YADE ? fluid->width : 0.5 * fluid->width;
}

/* Below this Reynolds number the law of turbulent streams between smooth walls is below 24/Re, that
 * of a laminar one: sqrt(Re/24) = log10(24 Re) + 0.32. Re on the hydraulic diameter: 1824. */
#define SD_VANS_WALL_TRANSITION 456.0724176307417
/* Friction of water at rest is that at this Reynolds number. */
#define SD_VANS_LEAST_RE 1e-10

/* Friction factor f of a side wall, tau = rho f/8 U^2; Re > 0:
 *   laminar    24/Re (between parallel walls: U = g width^2/(12 nu)), wherever that is the larger
 *   turbulent  1/sqrt(f) = -2 log10(k_s/(14.8 R_h) + 10^-0.16/(Re sqrt(f)))
 * Smooth walls, k_s = 0: 1/sqrt(f) = 2 log10(Re sqrt(f)) + 0.32 (Graf & Altinakar). Rough ones:
 * Colebrook's form, k_s of Nikuradse's sand (14.8 = 4 times 3.7). Smooth: by Halley's method
 * to rounding, with the terms of its series; rough: Newton's, anew every time.
 *   near  in: as it was for a Reynolds number near by, or zeros; out: about Re
 * Yade's rule: smooth and turbulent only, a natural logarithm, by substitution from 0.32^-2 until f
 * changes by less than 1 %, at most 100 times, then 0: a function with jumps, which no series
 * crosses. */
double sd_vans_wall_friction_anew(sd_vans_rules rules, double Re, sd_vans_friction *near);

/* The same from the series as far as it reaches (an error of 1e-13), otherwise anew: the streams of
 * two time steps are so near each other that few slices need that. */
static inline double sd_vans_wall_friction(sd_vans_rules rules, double Re, sd_vans_friction *near)
{
  const double s = Re * near->inverse - 1.0, *f = near->f;
  if (!(s <= near->reach && s >= -near->reach)) return sd_vans_wall_friction_anew(rules, Re, near);
  return f[0] + s * (f[1] + s * (f[2] + s * f[3]));
}

/* ---- exchange and solve ---------------------------------------------------------------------- */

/* What the exchange asks of the means over grains */
typedef struct {
  const double *profile, *classes;
  /* [N] force of the drag per volume of mixture, of grains of any sizes; NULL: not known */
  const double *density;
} sd_vans_means;

/* Exchange coefficient of every slice, divided by rho (1/s): b = n<f> / (U - v) / rho, in [0, 1/(10
 * dt)].
 *   n<f> = density, or, if that is not known, phi / (4/3 pi a^3) drag or the sum of that over classes
 *   b    [N] out
 *   cut  out: [0] force per area that the limit keeps from the water, [1] all drag
 * Yade's rule: the size of the slip, at least least_slip, and nothing in the lowest slice. */
void sd_vans_exchange(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, double dt,
                      const double *U, const sd_vans_means *grains, double *b, double cut[2]);

/* The largest rate at which the law of drag brings the water of a slice to the speed of its grains,
 * all of the fluid's radius, and the slice. 1/rate is the time that couplings must resolve. */
double sd_vans_drag_rate(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const double *U,
                         const double *hindrance, const double *profile, int *slice);

/* The exchange without a quotient of drag and slip: b is what the law of drag has for the mean slip
 * in the slice, so that it is never negative nor cut off, and what that is too much at the start of
 * a solve is added to the water as a source:  b [N] out (1/s);  rest [N] out, b (U - v) - n<f>/rho.
 * Together they are the drag to rounding, and close to it while U changes. */
void sd_vans_exchange_by_law(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const double *U,
                             const double *hindrance, const sd_vans_means *grains, double *b,
                             double *rest);

/* Time steps in a solve of length T with steps of about dt. Consistent: the least number of equal
 * steps no longer than dt (to 1e-9), and dt is made to fit. Yade's rule: dt stays and is added up
 * until the sum reaches T, which rounding often makes one step too many. */
int64_t sd_vans_steps(sd_vans_rules rules, double T, double *dt);

/* What stays during a solve; [N] each. */
typedef struct {
  const double *phi, *vx, *b, *length;
  /* acceleration per volume of mixture; NULL: none */
  const double *source;
} sd_vans_column;

/* The stream: U [N+1]; nut, stress [N] = rho e nut dU/dz. */
typedef struct {
  double *U, *nut, *stress;
} sd_vans_flow;

/* What passed during a solve: momentum along x per area of the bed. */
typedef struct {
  /* [N] what each slice of water gave to its grains, by b (U - v) and by the viscous stress on the
   * volume of the grains */
  double *moved;
  /* [N] the latter alone */
  double *shear;
  /* what the water received from outside; driving: gravity and pressure gradient */
  double driving, bottom, walls, surface;
  /* acceleration by gravity and pressure gradient in the last step, found where the discharge is
   * held */
  double drive;
} sd_vans_books;

typedef struct sd_vans_solver sd_vans_solver;
/* The mesh must outlive the solver. NULL: out of memory. */
sd_vans_solver *sd_vans_solver_create(const sd_vans_mesh *mesh);
void sd_vans_solver_free(sd_vans_solver *solver);

/* Solve, e = 1 - phi,
 *   e dU/dt = e d/dz nu d/dz (e U + phi v) + d/dz e nut dU/dz - b (U - v) + e (g - dpdx/rho) - wall
 *   + source
 * by nsteps implicit steps of dt (nut and wall friction from the velocity before each step).
 *   flow   U in and out; nut of the last step, stress with the new U
 *   books  out or NULL. Water gains driving + bottom + walls + surface - sum of moved + source, to
 *          rounding.
 * SD_OK or SD_ENOTFINITE.
 * With the discharge held each step finds the g - dpdx/rho for which sum e U' dz = discharge: U' is
 * linear in it.
 * wall = e 2/width coef f/8 (1/2 |U| U' + 1/2 |U| U), Re = |U| sd_vans_wall_length/nu.
 * Yade's rule: (1/2 U^2 U' + 1/2 U^2), and |g| for g. */
sd_status sd_vans_solve(sd_vans_solver *solver, const sd_vans_fluid *fluid,
                        const sd_vans_column *column, int64_t nsteps, double dt,
                        const sd_vans_flow *flow, sd_vans_books *books);

/* Eddy viscosity and stress of a velocity profile, without a step. */
void sd_vans_stress(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const double *phi,
                    const double *length, const sd_vans_flow *flow);

/* Momentum of the water per area of the bed, rho sum (1 - phi) U dz. */
double sd_vans_momentum(const sd_vans_mesh *mesh, double rho, const double *phi, const double *U);

/* Volume of the water per area, sum (1 - phi) dz. */
double sd_vans_volume(const sd_vans_mesh *mesh, const double *phi);

/* A surface between the edges of a mesh: the mesh of the water alone, whose slices are those of the
 * mesh but for the one below the surface, which ends there (it is 0.01 to 1.01 of its height).
 *   volume  of water per area, that fills the mesh up to the surface; or, with phi NULL, the height
 *           of the surface above z_ref
 *   edge    [N+1] out: edges of the slices of water, then one slice above the surface
 * Returns how many slices there are with that one, or 0 if the mesh does not hold the water. */
int sd_vans_fill(const sd_vans_mesh *mesh, const double *phi, double volume, double *edge);

/* The grains have moved: phi_old became phi_new. They displace water, which keeps its order over
 * the height and takes its momentum along. Changes U [N+1] (not U[0], U[N]) so that the momentum is
 * conserved but for what passes the surface; returns that, per area, gained by the water. from, to:
 * one mesh, or two of sd_vans_fill where the surface has moved. scratch [2 (N+1)] */
double sd_vans_displace(const sd_vans_mesh *from, const sd_vans_mesh *to, double rho,
                        const double *phi_old, const double *phi_new, double *U, double *scratch);

/* The volume of the water per area after the time T, in a reach of this length into which `comes` flows per
 * width and time, and from which `passes`, at the mean speed of the water: dV/dt = (comes - passes)/reach,
 * implicit in the speed, for any T. */
double sd_vans_inflow(double volume, double comes, double passes, double reach, double T);

/* Water and grains together rise with the flux q, e w + phi v = q: w = q + phi (w - v), upward [N] in
 * and out. With the w of before on the right this is the solution after a few couplings, whose mean v
 * lags behind the grains: where grains follow the water at once, phi/e times their last velocity
 * would swing. first: there is no w of before, and the equation is solved. */
void sd_vans_rise(const sd_vans_mesh *mesh, const double *profile, double flux, int first,
                  double *upward);

/* What the water bears besides its own weight, in the middle of the slices: dp/dz = -force [N] per
 * volume of mixture on the grains, from the surface down. pressure [N] out */
void sd_vans_borne(const sd_vans_mesh *mesh, const double *force, double *pressure);

/* ---- what the profiles tell ------------------------------------------------------------------ */

/* Volume of grains that passes a line across the stream, per width and time: sum phi vx dz. */
double sd_vans_transport(const sd_vans_mesh *mesh, const double *profile);

/* Where its grains are in the mean, above z_ref: sum phi z dz / sum phi dz; 0 without grains. */
double sd_vans_mean_height(const sd_vans_mesh *mesh, const double *phi);

/* The one of the largest size, with its sign. */
double sd_vans_largest_stress(const sd_vans_mesh *mesh, const double *stress);

/* Height of the lowest slice in units of nu/u_star, where no grains are in it: dz u_star/nu with the stress
 * that viscosity has between its middle and the bottom, rho u_star^2 = eta |U_1|/(dz/2). Without a wall law
 * that is all that the bottom can take from the water. U [N+1] */
double sd_vans_bottom_slice(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const double *U);

/* Elevation of the bed: middle of the highest slice under water where phi has a maximum above 0.5;
 * 0 if there is none. */
double sd_vans_bed_elevation(const sd_vans_mesh *mesh, const double *phi);

/* The part of what drives the clear water (phi < 0.1) that smooth side walls take by the side wall
 * correction of Einstein, Vanoni and Brooks: the section is shared out between walls and bed, and
 * each part has the mean speed U and the slope of the whole. Of a stream between parallel walls,
 *   2 R_w/width,  R_w = f_w(U R_w/nu) U^2/(8 drive)
 * 0 without walls or where nothing drives, at most 1. */
double sd_vans_wall_share(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const double *phi,
                          const double *U, double drive);

/* The largest rate at which side walls take momentum from a slice, 2/width coef f/8 |U|; 0 without walls.
 * U [N+1] */
double sd_vans_wall_rate(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const double *U);

/* Depth of the water above the bed over the size of its mean velocity there; 0 at rest. */
double sd_vans_depth_over_velocity(const sd_vans_mesh *mesh, const double *U, double bed);

SD_END_C
#endif
