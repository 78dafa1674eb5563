#include "sd_free_spheres.h"

#include <math.h>
#include <string.h>

sd_status sd_free_spheres_only(const sd_bodies *A, int *only)
{
  double others = A->shaped;
  *only = !A->known && !A->tie;
  if (!*only || A->none_shaped) return SD_OK;
  const sd_status status = sd_world_sum(&A->world, &others, 1);
  *only = others == 0.0;
  return status;
}

/* v = u + M' F by rows; their sum, which is finite when all of them are */
static sd_status move_free_spheres(const sd_bodies *A, const sd_bodies_problem *problem, double *v, double *sum)
{
  const double *F = problem->F;
  const sd_status status = A->apply(A->apply_ctx, F, v);
  *sum = 0.0;
  if (status != SD_OK) return status;
  for (long j = 0; j < sd_bodies_unknowns(A); j++) v[j] += problem->u[j] + F[j] / A->D[j];
  for (long j = 0; j < sd_bodies_unknowns(A); j++) *sum += v[j];
  return SD_OK;
}

sd_status sd_free_spheres_solve(const sd_bodies *A, const sd_bodies_problem *problem,
                                const sd_bodies_answer *answer, sd_bodies_report *report)
{
  const int width = A->points.width;
  double sum;
  sd_status status = move_free_spheres(A, problem, answer->v, &sum);
  if (status != SD_OK) return status;
  *report = (sd_bodies_report){.products = 1, .curvature = 1.0};
  memcpy(answer->l, problem->F, sizeof(double) * (size_t) sd_bodies_unknowns(A));
  memcpy(answer->exerted, problem->F, sizeof(double) * (size_t) sd_bodies_loads(A));
  for (long e = 0; e < A->lone; e++) {
    const double *v = answer->v + (long) width * A->loner[e];
    for (int d = 0; d < 6; d++) answer->V[6 * e + d] = d < width ? v[d] : 0.0;
  }
  status = sd_world_sum(&A->world, &sum, 1);
  return status == SD_OK && !isfinite(sum) ? SD_ENOTFINITE : status;
}
