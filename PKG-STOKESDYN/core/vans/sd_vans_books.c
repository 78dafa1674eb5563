#include "sd_vans_books.h"

/* Share of what is outstanding that goes back in one solve. All of it at once would hand the noise
 * of single couplings to slices thinner than a grain; a tenth is a mean over ten of them, and what
 * is on its way stays below ten couplings' worth. */
static const double RETURNED = 0.1;

/* What is in slices above the water, which are M, goes to the highest one of these. */
static void fold_above(int M, int all, double *momentum)
{
  for (int n = M; n < all; n++) {
    momentum[M - 1] += momentum[n];
    momentum[n] = 0.0;
  }
}

void sd_vans_share_out(const sd_vans_mesh *mesh, const double *phi, double momentum, double *back)
{
  const double volume = sd_vans_volume(mesh, phi);
  for (int n = 0; n < mesh->ncell - 1; n++)
    back[n] += momentum / volume * (1.0 - phi[n]) * sd_vans_height(mesh, n);
}

double sd_vans_give_back(const sd_vans_mesh *mesh, int all, double rho_area, double T, double *back,
                         double *outstanding, double *source)
{
  const int M = mesh->ncell - 1;    // the slice above the surface has no water
  double returned = 0.0;
  fold_above(M, all, back);
  fold_above(M, all, outstanding);
  for (int n = 0; n < M; n++) {
    outstanding[n] += back[n];
    const double share = RETURNED * outstanding[n];
    outstanding[n] -= share;
    returned += share;
    source[n] = share / (rho_area * sd_vans_height(mesh, n) * T);
  }
  source[M] = 0.0;
  return returned;
}

void sd_vans_take_out_rest(const sd_vans_mesh *mesh, double rho, double T, const double *rest,
                           sd_vans_books *books)
{
  for (int n = 0; n < mesh->ncell - 1; n++) books->moved[n] -= rho * sd_vans_height(mesh, n) * T * rest[n];
}

void sd_vans_hand_over(const sd_vans_mesh *mesh, const double *phi, double T,
                       const sd_vans_books *books, double *shear, double *foreseen)
{
  const int M = mesh->ncell - 1;
  /* books: per area of the bed; phi dz: volume of grains per area of the bed */
  for (int n = 0; n <= M; n++) {
    const double solid = n < M ? phi[n] * sd_vans_height(mesh, n) : 0.0;
    shear[n] = solid > 0.0 ? books->shear[n] / (T * solid) : 0.0;
    foreseen[n] = solid > 0.0 ? (books->moved[n] - books->shear[n]) / solid : 0.0;
  }
}

void sd_vans_ledger_solve(sd_vans_ledger *ledger, double area, int all, const sd_vans_books *books,
                          int accounted)
{
  double *taken = accounted ? &ledger->transit : &ledger->others;
  for (int n = 0; n < all; n++) *taken += area * books->moved[n];
  ledger->driving += area * books->driving;
  ledger->bottom += area * books->bottom;
  ledger->walls += area * books->walls;
  ledger->surface += area * books->surface;
}
