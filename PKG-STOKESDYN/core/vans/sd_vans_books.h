/* Settlement between water and grains: what the water gives the grains get. */
#ifndef SD_VANS_BOOKS_H
#define SD_VANS_BOOKS_H

#include "sd_vans.h"

SD_BEGIN_C

/* A solve takes `moved` from the water for the grains. Its viscous part is handed to them as a
 * force until the next solve. Its drag is what the exchange coefficient foresees. When the next
 * solve comes each grain has felt its true drag, and the difference goes back to the water as a
 * source in the slices of that grain. So the water gives no more and no less than the grains get,
 * and the drag stays implicit. Grain by grain and not slice by slice: a grain that sees the water
 * at its centre only would take drag from a thin slice beside it that has no momentum left.
 *
 * The account of a grain, along x. */
typedef struct {
  /* drag and viscous force of the last step */
  double force;
  /* impulse that it got by them since the last coupling */
  double impulse;
  /* viscous force now, and before the last coupling */
  double shear, past;
  /* impulse of drag that the last solve took from the water for it */
  double foreseen;
} sd_vans_account;

/* A step of velocity Verlet gives half of its force to the time before it, half to the time
 * after. */
static inline void sd_vans_account_step(sd_vans_account *account, double force, double dt)
{
  account->impulse += 0.5 * dt * (account->force + force);
}

/* What was foreseen for the grain but not taken by it in the time T since the last coupling, steps
 * of dt: impulse less that of the viscous force; the force of the coupling's own step acted for
 * another half step. ratio: time of the water over that of the grains. */
static inline double sd_vans_account_rest(const sd_vans_account *account, double T, double dt,
                                          double ratio)
{
  const double viscous = (T - 0.5 * dt) * account->shear + 0.5 * dt * account->past;
  return account->foreseen - ratio * (account->impulse - viscous);
}

/* The same of a grain that is held and has no steps: drag and viscous force push it over the time T as they
 * do now. impulse: of both, out */
static inline double sd_vans_account_held(const sd_vans_account *account, double drag, double T, double ratio,
                                          double *impulse)
{
  *impulse = T * (drag + account->shear);
  return account->foreseen - ratio * T * drag;
}

/* On its way to the grain when an interval begins: of a solve over the time T, and of the viscous force
 * before it what still acts then. half: half a step, in time of the water; 0 if the grain is held. Nobody
 * settles that with grains that are deleted: what all had less what those have that are left goes back to the
 * water. */
static inline double sd_vans_account_due(const sd_vans_account *account, double T, double half)
{
  return account->foreseen + T * account->shear + half * account->past;
}

/* Adds it to back, evenly over the water between grains, as nobody knows where they were. phi [N] */
void sd_vans_share_out(const sd_vans_mesh *mesh, const double *phi, double momentum, double *back);

/* A tenth of what is outstanding goes back at a time: the differences of single couplings are
 * mostly noise, which would shake the water of a dense bed.
 *   all          slices of the grains, N or more; what is above the surface goes to the slice below it
 *   back         [all] momentum that the grains of each slice have left since the last solve
 *   outstanding  [all] in and out, momentum;   source [N] out, for a solve over the time T
 * Returns the momentum that goes back in this solve. */
double sd_vans_give_back(const sd_vans_mesh *mesh, int all, double rho_area, double T, double *back,
                         double *outstanding, double *source);

/* With b and rest [N] of sd_vans_exchange_by_law a solve over the time T of water of density rho books all of
 * b (U - v) as given to the grains. The part of `rest` is none of theirs, and goes out of `moved`. */
void sd_vans_take_out_rest(const sd_vans_mesh *mesh, double rho, double T, const double *rest,
                           sd_vans_books *books);

/* What the solve took from the water, per volume of grains: shear [N] as a force, foreseen [N] as
 * an impulse. */
void sd_vans_hand_over(const sd_vans_mesh *mesh, const double *phi, double T,
                       const sd_vans_books *books, double *shear, double *foreseen);

/* Momentum along x of a whole stream, numbers that grow from the first step on. What the water has is what it
 * had and got, less transit, others and what grains got. */
typedef struct {
  /* the water has given it, the grains have not got it yet */
  double transit;
  /* the water got it from outside */
  double driving, bottom, walls, surface;
  /* spheres got it that nobody accounts for */
  double others;
} sd_vans_ledger;

/* What passed in a solve over a bed of this area, in `all` slices of `moved`: that is in transit where the
 * momentum of grains is accounted for, or else others have it. */
void sd_vans_ledger_solve(sd_vans_ledger *ledger, double area, int all, const sd_vans_books *books,
                          int accounted);

SD_END_C
#endif
