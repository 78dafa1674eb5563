#include "sd_tie_blocks.h"

#include <math.h>
#include <string.h>

#include "sd_bodies_alone.h"
#include "sd_linear.h"

/* --- H_ii --- */

static int has_arm(const double r[3])
{
  return r[0] != 0.0 || r[1] != 0.0 || r[2] != 0.0;
}

/* B := K_p^T B K_q for spheres at the arms r_p and r_q of their bodies: K = (1, -[r]x; 0, 1) */
static void move_to_centres(const double rp[3], const double rq[3], double B[36])
{
  for (int p = 0; p < 6; p++) { /* columns of W += columns of U, v = W x r */
    double *row = B + 6 * p, couple[3];
    sd_cross(rq, row, couple);
    for (int d = 0; d < 3; d++) row[3 + d] += couple[d];
  }
  for (int q = 0; q < 6; q++) {
    const double F[3] = {B[q], B[6 + q], B[12 + q]};
    double couple[3];
    sd_cross(rp, F, couple);
    for (int d = 0; d < 3; d++) B[6 * (3 + d) + q] += couple[d];
  }
}

const double *sd_tie_arm(const sd_bodies *A, const double *place, int sphere)
{
  static const double none[3] = {0.0};
  const int n = A->spheres.n;
  if (sphere >= n) return place + SD_PLACE * (long) (sphere - n) + SD_PLACE_ARM;
  const double *arm = sd_bodies_films(A).arm;
  return arm ? arm + 3 * (long) sphere : none;
}

static void add_scaled(const double *B, const double *rows, const double *columns, double *out)
{
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 6; q++) out[6 * p + q] += rows[p] * B[6 * p + q] * columns[q];
}

static int is_zero(const double B[36])
{
  for (int e = 0; e < 36; e++)
    if (B[e] != 0.0) return 0;
  return 1;
}

/* H_0 of body b */
static void factor_own_block(const sd_bodies *A, int b, double H[36])
{
  if (b >= A->lone) {
    sd_body_resistance_block(A->body + b - A->lone, H);
    return;
  }
  memset(H, 0, 36 * sizeof(double));
  for (int d = 0; d < 6; d++) H[7 * d] = A->D[6 * (long) A->loner[b] + d];
}

/* L_ii + X_ii of a sphere */
static void films_on(const sd_tie *t, int i, double B[36])
{
  sd_lubrication_own_block(t->L, i, B);
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) B[6 * p + q] += t->springs.own[6 * (long) i + sd_symmetric3_at(p, q)];
}

void sd_tie_find_diagonal(const sd_bodies *A, double *diagonal)
{
  const sd_tie *t = A->tie;
  memset(diagonal, 0, 36 * sizeof(double) * (size_t) sd_bodies_count(A));
  for (int i = 0; i < A->spheres.n; i++) {
    const double *r = sd_tie_arm(A, NULL, i);
    double B[36], *to = diagonal + 36 * (long) sd_rigid_whole(&A->spheres, i);
    films_on(t, i, B);
    if (has_arm(r)) move_to_centres(r, r, B);
    for (int e = 0; e < 36; e++) to[e] += B[e];
  }
  for (int b = 0; b < sd_bodies_count(A); b++) {
    double *block = diagonal + 36 * (long) b, *scale = t->scale + 6 * (long) b, H[36];
    const int out = is_zero(block);
    factor_own_block(A, b, H);
    for (int d = 0; d < 6; d++)
      scale[d] = out || sd_bodies_velocity_known(A, b, d) ? 0.0 : 1.0 / sqrt(H[7 * d]);
    for (int e = 0; e < 36; e++) H[e] += block[e];
    memset(block, 0, 36 * sizeof(double));
    add_scaled(H, scale, scale, block);
    for (int d = 0; d < 6; d++)
      if (scale[d] == 0.0) block[7 * d] = 1.0;
  }
}

/* --- H_ij --- */

/* p, q: largest scales of U and W */
static double strength(const sd_lubrication_link *l, const double p[2], const double q[2])
{
  const double UU = p[0] * q[0], UW = p[0] * q[1], WU = p[1] * q[0], WW = p[1] * q[1];
  return UU * UU * (l->XA * l->XA + 2.0 * l->YA * l->YA) +
      2.0 * (UW * UW * l->YB21 * l->YB21 + WU * WU * l->YB12 * l->YB12) +
      WW * WW * (l->XC * l->XC + 2.0 * l->YC * l->YC);
}

static void largest_scales(const double s[6], double of[2])
{
  for (int w = 0; w < 2; w++, s += 3) {
    of[w] = s[0] > s[1] ? s[0] : s[1];
    of[w] = s[2] > of[w] ? s[2] : of[w];
  }
}

static const double *scales_of_sphere(const sd_bodies *A, const double *place, int sphere)
{
  const int n = A->spheres.n;
  if (sphere >= n) return place + SD_PLACE * (long) (sphere - n) + SD_PLACE_SCALE;
  return A->tie->scale + 6 * (long) sd_rigid_whole(&A->spheres, sphere);
}

double sd_tie_find_block(const sd_bodies *A, const double *place, long k, double weak, double scaled[36])
{
  const sd_tie *t = A->tie;
  const int i = t->L->pair[k][0], j = t->L->pair[k][1];
  const double *rp = sd_tie_arm(A, place, i), *rq = sd_tie_arm(A, place, j);
  const double *sp = scales_of_sphere(A, place, i), *sq = scales_of_sphere(A, place, j);
  const int arms = has_arm(rp) || has_arm(rq);
  sd_lubrication_link both = t->L->link[k];
  double of_p[2], of_q[2], B[36] = {0.0}, sum[6] = {0.0};    /* six, none of which waits for the others */
  both.XA -= t->springs.c[k]; /* L_12 + X_12 */
  largest_scales(sp, of_p);
  largest_scales(sq, of_q);
  if (!arms && strength(&both, of_p, of_q) < weak * weak) return 0.0;
  sd_lubrication_add_block(&both, B);
  if (arms) move_to_centres(rp, rq, B);
  add_scaled(B, sp, sq, scaled);
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 6; q++) sum[q] += scaled[6 * p + q] * scaled[6 * p + q];
  return sum[0] + sum[1] + sum[2] + sum[3] + sum[4] + sum[5];
}
