#include "sd_bodies_rigid.h"

#include "sd_clump_motion.h"

void sd_bodies_add_rigid(const sd_bodies *A, int b, const double V[6], double *out)
{
  const sd_body_shape *s = A->shape[b];
  for (int k = 0; k < s->m; k++) {
    const int j = A->member[A->first[b] + k];
    if (j >= A->n) continue;
    double v[6], space[6];
    sd_cross(V + 3, s->x + 3 * k, v);
    for (int d = 0; d < 3; d++) {
      v[d] += V[d];
      v[3 + d] = V[3 + d];
    }
    sd_bodies_to_space(A->pose + 9 * (long) b, v, space);
    for (int d = 0; d < 6; d++) out[6 * (long) j + d] += space[d];
  }
}

sd_status sd_bodies_onto_clumps(const sd_bodies *A, const double *rows, double *ghosts, double *f)
{
  const sd_status status = sd_bodies_refresh(A, rows, ghosts);
  if (status != SD_OK) return status;
  for (int b = 0; b < A->clumps; b++) {
    const double *R = A->pose + 9 * (long) b;
    double sum[6] = {0.0};
    for (int k = 0; k < A->shape[b]->m; k++) {
      double F[6], couple[3];
      sd_bodies_to_shape(R, sd_bodies_row(A, rows, ghosts, b, k), F);
      sd_cross(A->shape[b]->x + 3 * k, F, couple);
      for (int d = 0; d < 3; d++) {
        sum[d] += F[d];
        sum[3 + d] += F[3 + d] + couple[d];
      }
    }
    sd_bodies_to_space(R, sum, f + 6 * (long) b);
  }
  return SD_OK;
}

void sd_bodies_carry(const sd_bodies *A, const double *gradient, double *u)
{
  for (int b = 0; b < A->clumps; b++) {
    double W[3], E[6], V[6];
    sd_clump_split_gradient(A->pose + 9 * (long) b, gradient + 9 * (long) b, W, E);
    sd_bodies_multiply6(A->shape[b]->carried, E, V);
    sd_bodies_add_rigid(A, b, V, u);
  }
}

void sd_bodies_shells(const sd_bodies *A, const double *f, double sign, double *out)
{
  for (int b = 0; b < A->clumps; b++) {
    double load[6], V[6];
    sd_bodies_to_shape(A->pose + 9 * (long) b, f + 6 * (long) b, load);
    sd_bodies_multiply6(A->shape[b]->shell, load, V);
    for (int p = 0; p < 6; p++) V[p] *= sign / A->eta[b];
    sd_bodies_add_rigid(A, b, V, out);
  }
}

sd_status sd_bodies_add_shells(const sd_bodies *A, const double *l, double *work, double *out)
{
  double *f = work;
  const sd_status status = sd_bodies_onto_clumps(A, l, work + 6 * (long) A->clumps, f);
  if (status == SD_OK) sd_bodies_shells(A, f, 1.0, out);
  return status;
}
