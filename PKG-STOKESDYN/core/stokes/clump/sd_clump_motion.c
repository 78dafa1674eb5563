#include "sd_clump_motion.h"

#include "sd_linear.h"

#include <string.h>

/* sum_m e_m (e_m.b) / d_m over the main axes e of the shape, turned by R: the solution of a
 * symmetric system that is diagonal there. An axis with d = 0 is left out, as a pseudo-inverse
 * does. */
static void motion_divide(const sd_shape *s, const double R[9], const double d[3], const double b[3],
                          double out[3])
{
  double body[3], x[3] = {0.0, 0.0, 0.0};
  sd_multiply3t(R, b, body);
  for (int m = 0; m < 3; m++) {
    if (!(d[m] > 0.0)) continue;
    const double *e = s->axes + 3 * m, part = sd_dot(e, body) / d[m];
    for (int p = 0; p < 3; p++) x[p] += part * e[p];
  }
  sd_multiply3(R, x, out);
}

void sd_clump_velocity(const sd_shape *s, const sd_clump_motion *m, const double R[9],
                       const double c[3], double U[3], double W[3])
{
  /* v_k = U + W x r_k with the least sum of squares: U is the mean, since the r_k add up to 0, and
   *   sum (r.r I - r r) W = sum r x v.
   * Along main axis e_m the matrix is the sum of the squares along the other two. */
  const double share = 1.0 / s->n, *q = s->squares;
  const double across[3] = {q[1] + q[2], q[2] + q[0], q[0] + q[1]};
  double sum[3] = {0.0, 0.0, 0.0}, L[3] = {0.0, 0.0, 0.0};
  for (int k = 0; k < s->n; k++) {
    const double *v = m->v + 3 * k;
    double r[3], moment[3];
    sd_minus(m->x + 3 * k, c, r);
    sd_cross(r, v, moment);
    for (int d = 0; d < 3; d++) {
      sum[d] += v[d];
      L[d] += moment[d];
    }
  }
  for (int d = 0; d < 3; d++) U[d] = share * sum[d];
  motion_divide(s, R, across, L, W);
  if (!m->omega || s->rank == 2) return;

  /* On a line with direction e the spheres' own spins tell what is along it, in a point all. */
  double spin[3] = {0.0, 0.0, 0.0}, e[3];
  for (int k = 0; k < s->n; k++)
    for (int d = 0; d < 3; d++) spin[d] += share * m->omega[3 * k + d];
  sd_multiply3(R, s->axes, e);
  const double about = sd_dot(spin, e);
  for (int d = 0; d < 3; d++) W[d] = s->rank == 0 ? spin[d] : W[d] + about * e[d];
}

void sd_clump_flow(const sd_shape *s, const sd_clump_motion *m, const double R[9],
                   const double c[3], double u[3], double G[9])
{
  const double share = 1.0 / s->n;
  memset(G, 0, sizeof(double) * 9);
  memcpy(u, m->u_uniform, sizeof(double) * 3);
  if (!m->u) return;
  for (int d = 0; d < 3; d++) u[d] = 0.0;
  for (int k = 0; k < s->n; k++) {
    for (int d = 0; d < 3; d++) u[d] += share * m->u[3 * k + d];
    for (int d = 0; d < 9; d++) G[d] += share * m->gradient[9 * k + d];
  }
  /* The rest, u_k - u - G r_k = D r_k with the least sum of squares: D sum r r = sum (u_k - u - G
   * r_k) r, row by row. */
  double B[9] = {0.0};
  for (int k = 0; k < s->n; k++) {
    const double *uk = m->u + 3 * k;
    double r[3], Gr[3];
    sd_minus(m->x + 3 * k, c, r);
    sd_multiply3(G, r, Gr);
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++) B[3 * p + q] += (uk[p] - u[p] - Gr[p]) * r[q];
  }
  for (int p = 0; p < 3; p++) {
    double D[3];
    motion_divide(s, R, s->squares, B + 3 * p, D);
    for (int q = 0; q < 3; q++) G[3 * p + q] += D[q];
  }
}

/* Slip of the fluid, which has u at the centroid and the gradient G (strains: one that is not 0), against the
 * rigid motion: u - U there, and G less the antisymmetric matrix of w, whose product with r is w x r. */
static void drag_of_slip(const sd_clump_placed *placed, int strains, const double u[3], const double G[9],
                         const double U[3], const double w[3], const sd_clump_rows *out)
{
  const double minus_w[3] = {-w[0], -w[1], -w[2]};
  const double spin[9] = {0.0, -w[2], w[1], w[2], 0.0, -w[0], -w[1], w[0], 0.0};
  double slip[3], A[9];
  sd_minus(u, U, slip);
  for (int d = 0; d < 9; d++) A[d] = G[d] - spin[d];
  if (strains)
    sd_clump_forces(placed, slip, A, out);
  else
    sd_clump_forces_rigid(placed, slip, minus_w, out);
}

void sd_clump_drag(const sd_clump_placed *placed, const sd_clump_motion *m, const sd_clump_rows *out)
{
  const double *R = placed->pose, *c = placed->pose + 9;
  double U[3], w[3], u[3], G[9];
  sd_clump_velocity(placed->shape, m, R, c, U, w);
  sd_clump_flow(placed->shape, m, R, c, u, G);
  drag_of_slip(placed, m->u != NULL, u, G, U, w, out);
}

/* G NULL: the flow is uniform */
static void free_velocity(const sd_clump_placed *placed, const double load[6], const double u[3],
                          const double *G, double V[6])
{
  const sd_clump *clump = placed->clump;
  const double *R = placed->pose;
  double E[6], f[6], v[6], shift[3];
  memcpy(V, u, 3 * sizeof(double));
  memset(V + 3, 0, 3 * sizeof(double));
  if (G) sd_clump_split_gradient(R, G, V + 3, E);
  sd_multiply3t(R, load, f);
  sd_multiply3t(R, load + 3, f + 3);
  for (int p = 0; p < 6; p++) {
    f[p] /= placed->eta;
    for (int e = 0; e < 6 && G; e++) f[p] += clump->strain[6 * p + e] * E[e];
  }
  /* mobility is about the centre of reaction, load and V are about the centroid */
  sd_cross(clump->centre, f, shift);
  for (int d = 0; d < 3; d++) f[3 + d] -= shift[d];
  for (int p = 0; p < 6; p++) {
    v[p] = 0.0;
    for (int q = 0; q < 6; q++) v[p] += clump->mobility[6 * p + q] * f[q];
  }
  sd_cross(v + 3, clump->centre, shift);
  for (int d = 0; d < 3; d++) v[d] -= shift[d];
  double U[3], W[3];
  sd_multiply3(R, v, U);
  sd_multiply3(R, v + 3, W);
  for (int d = 0; d < 3; d++) {
    V[d] += U[d];
    V[3 + d] += W[d];
  }
}

void sd_clump_move_alone(const sd_clump_placed *placed, const sd_clump_motion *m, const double *load,
                         double V[6], const sd_clump_rows *out)
{
  double u[3], G[9];
  sd_clump_flow(placed->shape, m, placed->pose, placed->pose + 9, u, G);
  if (load) free_velocity(placed, load, u, m->u ? G : NULL, V);
  for (int k = 0; k < placed->shape->n; k++) {
    double arm[3], *of = out->v + (long) out->width * k;
    sd_multiply3(placed->pose, placed->shape->x + 3 * k, arm);
    memcpy(of, V, 6 * sizeof(double));
    sd_clump_shift_velocity(arm, of);
  }
  drag_of_slip(placed, m->u != NULL, u, G, V, V + 3, out);
}
