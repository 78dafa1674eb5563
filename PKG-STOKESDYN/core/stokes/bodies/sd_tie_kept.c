#include "sd_tie_kept.h"

#include "sd_linear.h"

/* Of sd_tie_kept.h: one eigenvalue of 1.07 or 0.93. With 0.03 there are up to 1.1 times the products with the mobility,
 * with 0.12 up to 1.4 times (volume fractions 0.3 and 0.4, steps of 0.005 and 0.01 of a radius). */
static const double limit = 0.005, most = 1e-3;
/* In units of the drags: what chains of films leave soft, where bodies turn together, is stiff by the factor of before
 * where one of them is stiffer than this (trace of its block). */
static const double stiffest = 2000.0;

/* Translations in a block, scaled: symmetric, positive definite, xx yy zz xy xz yz */
static void translations_of(const double *block, double B[6])
{
  for (int p = 0; p < 3; p++)
    for (int q = p; q < 3; q++) B[sd_symmetric3_at(p, q)] = block[6 * p + q];
}

/* The adjugate, likewise; returns the determinant */
static double adjugate(const double B[6], double out[6])
{
  const double xx = B[0], yy = B[1], zz = B[2], xy = B[3], xz = B[4], yz = B[5];
  out[0] = yy * zz - yz * yz;
  out[1] = xx * zz - xz * xz;
  out[2] = xx * yy - xy * xy;
  out[3] = xz * yz - xy * zz;
  out[4] = xy * yz - xz * yy;
  out[5] = xy * xz - xx * yz;
  return xx * out[0] + xy * out[3] + xz * out[4];
}

/* tr(A B) */
static double trace_of_product(const double A[6], const double B[6])
{
  return A[0] * B[0] + A[1] * B[1] + A[2] * B[2] + 2.0 * (A[3] * B[3] + A[4] * B[4] + A[5] * B[5]);
}

static double kept_change(const double then[6], const double now[6])
{
  double of_then[6], of_now[6];
  const double det_then = adjugate(then, of_then), det_now = adjugate(now, of_now);
  return trace_of_product(of_then, now) / det_then + trace_of_product(of_now, then) / det_now - 6.0;
}

sd_status sd_tie_kept(const sd_bodies *A, const double *blocks, sd_status mine, int *stays)
{
  const sd_tie *t = A->tie;
  const int bodies = sd_bodies_count(A), same = mine == SD_OK && t->made_for == bodies && t->factor.n >= bodies;
  double changed[3] = {0.0, bodies, !same}, now[6];
  *stays = 0;
  for (int b = 0; b < bodies && same; b++) {
    translations_of(blocks + 36 * (long) b, now);
    if (!(kept_change(t->made_of + 6 * (long) b, now) <= limit) || now[0] + now[1] + now[2] > stiffest) changed[0]++;
  }
  const sd_status status = sd_world_sum(&t->L->world, changed, 3);
  *stays = status == SD_OK && changed[2] == 0.0 && changed[0] <= most * changed[1];
  return status;
}

void sd_tie_note(const sd_bodies *A, const double *blocks)
{
  sd_tie *t = A->tie;
  t->made_for = sd_bodies_count(A);
  for (int b = 0; b < t->made_for; b++) translations_of(blocks + 36 * (long) b, t->made_of + 6 * (long) b);
}
