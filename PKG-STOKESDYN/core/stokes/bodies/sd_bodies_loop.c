#include "sd_bodies_loop.h"

#include <math.h>
#include <string.h>

#include "sd_bodies_alone.h"
#include "sd_tie.h"

/* Where stiff pairs chain bodies together across ranks, the norm of the sparse system hardly sees that these
 * move as one (sd_tie_factor.h), least of all in a guess: 0.3 left three times the products. */
static const sd_bodies_accuracy whole = {0.003, 0.2, 0.3, 0.1}, severed = {0.002, 0.1, 0.01, 0.01};

const sd_bodies_accuracy *sd_bodies_accuracy_of(const sd_bodies_loop *c)
{
  return c->A->tie && c->A->tie->border.severed ? &severed : &whole;
}

double sd_bodies_tie_tolerance(const sd_bodies_loop *c, double power)
{
  const sd_bodies_accuracy *a = sd_bodies_accuracy_of(c);
  return fmin(c->closest, fmax(a->first, fmin(a->loosest, a->first * sqrt(c->power.spent / power))));
}

sd_status sd_bodies_pre(sd_bodies_loop *c, const double *r, const double *f, int moved, double *l, double *V)
{
  const sd_bodies *A = c->A;
  const long size = sd_bodies_motions(c);
  double *load = c->bodies, *tied = load + size, *borne = tied + size, *bears = borne + size;
  if (!A->tie) {
    const sd_bodies_left all = {r, NULL, f};
    sd_bodies_alone(A, &all, c->alone, l, V);
    return SD_OK;
  }
  if (r) sd_bodies_alone_bear(A, r, c->alone, bears);
  for (long j = 0; j < size; j++) load[j] = (f ? f[j] : 0.0) - (r ? bears[j] : 0.0);
  memcpy(tied, V, sizeof(double) * (size_t) size);
  const sd_tie_problem problem = {load, r, c->tie_tolerance, moved};
  const sd_status status = sd_tie_solve(A, &problem, sd_bodies_lend(c, l), tied, borne);
  if (status != SD_OK) return status;
  if (c->hides) memset(l, 0, sizeof(double) * (size_t) sd_bodies_unknowns(A)); /* the tie has used it */
  for (long j = 0; j < size; j++) load[j] = (f ? f[j] : 0.0) - borne[j];
  const sd_bodies_left left = {r, r ? bears : NULL, load};
  sd_bodies_alone(A, &left, c->alone, l, V);
  for (int b = 0; b < sd_bodies_count(A); b++)
    if (sd_tie_binds(A, b)) memcpy(V + 6 * (long) b, tied + 6 * (long) b, 6 * sizeof(double));
  sd_tie_share(A, l);
  return SD_OK;
}

sd_status sd_bodies_multiply(void *ctx, const double *p, double *w)
{
  sd_bodies_loop *c = ctx;
  const double *V = p + sd_bodies_unknowns(c->A);
  const sd_status status =
      sd_bodies_product(c->A, c->shells, p, V, c->bodies, c->on_spheres, w);
  if (status == SD_OK) c->report->products++;
  return status;
}

double sd_bodies_spent(const sd_bodies_loop *c, const double *V)
{
  double sum[6] = {0.0};    /* six, none of which waits for the others */
  for (int b = 0; b < sd_bodies_count(c->A); b++)
    for (int d = 0; d < 6; d++)
      if (!sd_bodies_velocity_known(c->A, b, d))
        sum[d] += c->loads[6 * (long) b + d] * V[6 * (long) b + d];
  return sum[0] + sum[1] + sum[2] + sum[3] + sum[4] + sum[5];
}
