#include "sd_tie_approach.h"

#include <math.h>
#include <string.h>

#include "sd_room.h"

/* B += s s^T, on translations */
static void add_square(const float s[3], double B[36])
{
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) B[6 * p + q] += (double) s[p] * s[q];
}

sd_status sd_tie_approach_make(const sd_bodies *A)
{
  sd_tie *t = A->tie;
  const sd_lubrication *L = t->L;
  if (!sd_reserve(&t->spring, sizeof(*t->spring), (size_t) L->count + 1, &t->most_springs))
    return SD_ENOMEMORY;
  if (!sd_reserve(&t->stiff, sizeof(double), 36 * ((size_t) L->n + 1), &t->most_stiff))
    return SD_ENOMEMORY;
  memcpy(t->stiff, L->diagonal, sizeof(double) * 36 * (size_t) L->n);
  if (!L->model) return SD_OK;
  for (long k = 0; k < L->count; k++)
    for (int e = 0; e < 3; e++) t->spring[k][e] = (float) (sqrt(L->model[k]) * L->link[k].d[e]);
  for (long k = 0; k < L->count; k++) {
    const int i = L->pair[k][0], j = L->pair[k][1];
    if (j == i) continue;
    add_square(t->spring[k], t->stiff + 36 * (long) i);
    if (j < L->n) add_square(t->spring[k], t->stiff + 36 * (long) j);
  }
  return SD_OK;
}

void sd_tie_approach_add(const sd_bodies *A, const double *v, double *out)
{
  const sd_lubrication *L = A->tie->L;
  for (long k = 0; L->model && k < L->count; k++) {
    const int i = L->pair[k][0], j = L->pair[k][1];
    const float *s = A->tie->spring[k];
    const double *vi = v + 6 * (long) i;
    const double *vj = j < L->n ? v + 6 * (long) j : L->others + 6 * (long) (j - L->n);
    double approach = 0.0;
    for (int e = 0; e < 3; e++) approach += s[e] * (vi[e] - vj[e]);
    for (int e = 0; e < 3; e++) out[6 * (long) i + e] += approach * s[e];
    if (j >= L->n) continue;
    for (int e = 0; e < 3; e++) out[6 * (long) j + e] -= approach * s[e];
  }
}
