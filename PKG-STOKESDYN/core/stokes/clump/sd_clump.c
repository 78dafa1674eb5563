#include "sd_clump.h"

#include "sd_clump_internal.h"
#include "sd_linear.h"
#include "sd_tensor.h"

#include <stdlib.h>
#include <string.h>

enum { RIGID = 6 };

/* --- the table -------------------------------------------------------------------------------- */

/* Response of one sphere to a slip given in columns: forces are linear in it */
static void clump_respond(const double *table, const double in[SD_CLUMP_COLUMNS], double out[6])
{
  for (int p = 0; p < 6; p++) out[p] = 0.0;
  for (int c = 0; c < SD_CLUMP_COLUMNS; c++)
    for (int p = 0; p < 6; p++) out[p] += table[6 * c + p] * in[c];
}

static double determinant(const double g[9])
{
  double c[3];
  sd_cross(g, g + 3, c);
  return sd_dot(c, g + 6);
}

/* Average over the symmetries of the shape: turn slip with g, read the forces of the image, turn
 * them back. Torque and angular velocity change sign under reflections. */
static sd_status symmetrize(const sd_shape *s, double *table)
{
  const size_t size = sizeof(double) * 6 * SD_CLUMP_COLUMNS * (size_t) s->n;
  double *old = malloc(size);
  if (!old) return SD_ENOMEMORY;
  memcpy(old, table, size);
  memset(table, 0, size);
  for (int m = 0; m < s->symmetries; m++) {
    const double *g = s->g + 9 * m, hand = determinant(g) < 0.0 ? -1.0 : 1.0;
    const double back_g[9] = {g[0], g[3], g[6], g[1], g[4], g[7], g[2], g[5], g[8]};
    for (int c = 0; c < SD_CLUMP_COLUMNS; c++) {
      double in[SD_CLUMP_COLUMNS] = {0.0}, turned[SD_CLUMP_COLUMNS], E[9], W[3];
      in[c] = 1.0;
      sd_multiply3(g, in, turned);
      sd_multiply3(g, in + 3, turned + 3);
      for (int d = 3; d < 6; d++) turned[d] *= hand;
      sd_clump_strain_matrix(in + 6, E);
      sd_clump_split_gradient(back_g, E, W, turned + 6);
      for (int k = 0; k < s->n; k++) {
        double out[6], back[6];
        clump_respond(old + 6 * SD_CLUMP_COLUMNS * (size_t) s->perm[(size_t) s->n * m + k], turned, out);
        sd_multiply3t(g, out, back);
        sd_multiply3t(g, out + 3, back + 3);
        double *t = table + 6 * (SD_CLUMP_COLUMNS * (size_t) k + c);
        for (int d = 0; d < 3; d++) {
          t[d] += back[d] / s->symmetries;
          t[d + 3] += hand * back[d + 3] / s->symmetries;
        }
      }
    }
  }
  free(old);
  return SD_OK;
}

/* Forces of the points -> force and torque of every sphere about its own centre */
static void clump_gather(const sd_shape *shape, const sd_surface *s, int m, const double *B,
                         double *table)
{
  const size_t N = (size_t) m * s->n;
  memset(table, 0, sizeof(double) * 6 * SD_CLUMP_COLUMNS * (size_t) shape->n);
  for (int c = 0; c < SD_CLUMP_COLUMNS; c++)
    for (int i = 0; i < s->n; i++) {
      const double *f = B + N * c + (size_t) m * i;
      double *t = table + 6 * (SD_CLUMP_COLUMNS * (size_t) s->sphere[i] + c), arm[3], torque[3];
      sd_minus(s->x + 3 * i, shape->x + 3 * s->sphere[i], arm);
      sd_cross(arm, f, torque);
      for (int d = 0; d < 3; d++) {
        t[d] += f[d];
        t[d + 3] += torque[d] + (m == 6 ? f[d + 3] : 0.0);
      }
    }
}

/* Stokes: 6 pi a against translation, 8 pi a^3 against rotation; strain moves no lone sphere. */
static void lone_sphere(double a, double *table)
{
  memset(table, 0, sizeof(double) * 6 * SD_CLUMP_COLUMNS);
  for (int d = 0; d < 3; d++) {
    table[6 * d + d] = 6.0 * SD_PI * a;
    table[6 * (3 + d) + 3 + d] = 8.0 * SD_PI * a * a * a;
  }
}

/* --- what follows from the table -------------------------------------------------------------- */

/* Sums over the clump about its centroid: 6 rows, 12 columns */
static void clump_add_up(const sd_shape *s, const double *table, double sum[6][SD_CLUMP_COLUMNS])
{
  memset(sum, 0, sizeof(double) * 6 * SD_CLUMP_COLUMNS);
  for (int k = 0; k < s->n; k++)
    for (int c = 0; c < SD_CLUMP_COLUMNS; c++) {
      const double *t = table + 6 * (SD_CLUMP_COLUMNS * (size_t) k + c);
      double torque[3];
      sd_cross(s->x + 3 * k, t, torque);
      for (int d = 0; d < 3; d++) {
        sum[d][c] += t[d];
        sum[d + 3][c] += t[d + 3] + torque[d];
      }
    }
}

void sd_resistance_shift(const double R[36], const double d[3], double out[36])
{
  /* About P = c + d: velocity of c is U_P + d x W, i.e. (U, W)_c = S^T (U, W)_P; torque about P is
   * T_c - d x F: out = S R S^T with S = [1 0; -[d] 1], on the columns of R and then on its rows. */
  double SR[36];
  for (int q = 0; q < 6; q++) {
    const double F[3] = {R[q], R[6 + q], R[12 + q]};
    double moment[3];
    sd_cross(d, F, moment);
    for (int p = 0; p < 3; p++) {
      SR[6 * p + q] = F[p];
      SR[6 * (p + 3) + q] = R[6 * (p + 3) + q] - moment[p];
    }
  }
  for (int p = 0; p < 6; p++) {
    double moment[3];
    sd_cross(d, SR + 6 * p, moment);
    for (int q = 0; q < 3; q++) {
      out[6 * p + q] = SR[6 * p + q];
      out[6 * p + q + 3] = SR[6 * p + q + 3] - moment[q];
    }
  }
}

/* Where the coupling block is symmetric. M: 3x3 blocks translation (tt) and coupling (cc: rotation
 * rows, translation columns) about the present point. Moving it by d changes cc by sign [d] tt; the
 * antisymmetric parts cancel if (tr tt - tt) d = sign vec cc, vec_i = e_ijk cc_jk. Degenerate
 * directions (no translation) stay where they are. */
static void symmetric_coupling(const double tt[9], const double cc[9], double sign, double d[3])
{
  const double trace = tt[0] + tt[4] + tt[8], v[3] = {cc[5] - cc[7], cc[6] - cc[2], cc[1] - cc[3]};
  double A[9], w[3], V[9];
  for (int i = 0; i < 9; i++) A[i] = (i % 4 == 0 ? trace : 0.0) - tt[i];
  sd_eigen(3, A, w, V);
  for (int p = 0; p < 3; p++) d[p] = 0.0;
  for (int k = 0; k < 3; k++) {
    if (!(w[k] > 1e-9 * w[0])) continue;
    const double e[3] = {V[k], V[3 + k], V[6 + k]}, s = sign * sd_dot(e, v) / w[k];
    for (int p = 0; p < 3; p++) d[p] += s * e[p];
  }
}

/* Resistance about the centroid and about the centre of resistance (where coupling is symmetric),
 * its inverse, and the radius of the sphere that would diffuse as fast: D = k T tr(mobility)/3. */
static void derive(const sd_shape *s, sd_clump *clump)
{
  double sum[6][SD_CLUMP_COLUMNS], tt[9], cc[9];
  clump_add_up(s, clump->table, sum);
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 6; q++) {
      clump->R[6 * p + q] = 0.5 * (sum[p][q] + sum[q][p]);
      clump->strain[6 * p + q] = sum[p][q + 6];
    }
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      tt[3 * p + q] = clump->R[6 * p + q];
      cc[3 * p + q] = clump->R[6 * (p + 3) + q];
    }
  symmetric_coupling(tt, cc, -1.0, clump->centre); /* cc about c + d: cc - [d] tt */
  sd_resistance_shift(clump->R, clump->centre, clump->R_centre);
  sd_pseudo_inverse6(clump->R_centre, clump->mobility);
  /* Mobility about another point at d: velocity there is U + W x d, so tt - [d] (rotation rows,
   * translation columns) + ... ; the trace is least at the centre of mobility. With rr the rotation
   * block: tr = tr tt - v.d + d.(tr rr - rr) d, v = 2 vec. */
  double rr[9], *d = clump->mobility_centre;
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      rr[3 * p + q] = clump->mobility[6 * (p + 3) + q + 3];
      cc[3 * p + q] = clump->mobility[6 * (p + 3) + q];
    }
  symmetric_coupling(rr, cc, 1.0, d);
  double mu = clump->mobility[0] + clump->mobility[7] + clump->mobility[14];
  const double v[3] = {cc[5] - cc[7], cc[6] - cc[2], cc[1] - cc[3]};
  mu -= fabs(sd_dot(v, d));
  clump->radius = 3.0 / (6.0 * SD_PI * mu);
}

/* --- create, forces --------------------------------------------------------------------------- */

/* Two equal spheres at one point: the force is split between them in no particular way. */
static int coincident(const sd_shape *s)
{
  const double tolerance = SD_SHAPE_TOLERANCE * s->size;
  for (int i = 0; i < s->n; i++)
    for (int j = i + 1; j < s->n; j++)
      if (fabs(s->a[i] - s->a[j]) <= tolerance &&
          sd_distance_squared(s->x + 3 * i, s->x + 3 * j) <= tolerance * tolerance)
        return 1;
  return 0;
}

/* Table for the forces on the points of one surface */
static sd_status solve_surface(const sd_shape *shape, const sd_surface *s,
                               const sd_clump_options *o, const sd_clump_need *need,
                               sd_clump *clump, double *table)
{
  const int m = sd_clump_width(o);
  double *B = malloc(sizeof(double) * SD_CLUMP_COLUMNS * m * (size_t) s->n);
  if (!B) return SD_ENOMEMORY;
  const sd_status status = sd_clump_solve(s, o, need, B, &clump->iterations);
  if (status == SD_OK) clump_gather(shape, s, m, B, table);
  free(B);
  return status;
}

/* The mean table of all orientations of the shells, with the symmetry of the shape */
static sd_status solve_shells(const sd_shape *shape, const sd_clump_options *o, sd_shells *cache,
                              sd_clump *clump, sd_clump_need *need)
{
  const int n = sd_shell_size(o->shell), times = sd_surface_orientations(n);
  const size_t size = 6 * SD_CLUMP_COLUMNS * (size_t) shape->n;
  double *fraction = malloc(sizeof(double) * (size_t) shape->n),
         *one = malloc(sizeof(double) * size);
  int *count = malloc(sizeof(int) * (size_t) shape->n);
  sd_status status = fraction && one && count ? sd_surface_exposed(shape, cache, fraction)
                                              : SD_ENOMEMORY;
  if (status == SD_OK) sd_surface_share(shape, n, fraction, count);
  memset(clump->table, 0, sizeof(double) * size);
  for (int k = 0; k < times && status == SD_OK; k++) {
    sd_surface s;
    status = sd_surface_of_shells(shape, count, k, cache, &s);
    if (status == SD_OK) status = sd_clump_check_need(s.n, o, need);
    if (status == SD_OK) status = solve_surface(shape, &s, o, need, clump, one);
    if (k == 0) clump->points = s.n;
    for (size_t i = 0; i < size && status == SD_OK; i++) clump->table[i] += one[i] / times;
    sd_surface_free(&s);
  }
  if (status == SD_OK) status = symmetrize(shape, clump->table);
  free(fraction);
  free(one);
  free(count);
  return status;
}

/* A lone sphere has a closed form, unless it is asked for as a mere point without torques; shell 1
 * are the centres as they are; everything else is shells of points. */
sd_status sd_clump_create(const sd_shape *shape, const sd_clump_options *o, sd_shells *cache,
                          sd_clump *clump, sd_clump_need *need)
{
  sd_clump_need own;
  if (!need) need = &own;
  *clump = (sd_clump){.n = shape->n, .points = shape->n};
  sd_status status = sd_clump_needs(shape, o, need);
  if (status != SD_OK) return status;
  if (coincident(shape)) return SD_ESINGULAR;
  clump->table = malloc(sizeof(double) * 6 * SD_CLUMP_COLUMNS * (size_t) shape->n);
  if (!clump->table) return SD_ENOMEMORY;

  if (shape->n == 1 && (o->shell != 1 || o->rotation)) {
    clump->points = sd_shell_size(o->shell);
    lone_sphere(shape->a[0], clump->table);
  } else if (o->shell == 1) {
    sd_surface s;
    status = sd_surface_of_centres(shape, &s);
    if (status == SD_OK) status = solve_surface(shape, &s, o, need, clump, clump->table);
    sd_surface_free(&s);
  } else
    status = solve_shells(shape, o, cache, clump, need);

  if (status == SD_OK)
    derive(shape, clump);
  else
    sd_clump_free(clump);
  return status;
}

void sd_clump_free(sd_clump *clump)
{
  free(clump->table);
  *clump = (sd_clump){0};
}

/* F_k = eta R table_k in, for the first columns; in is scaled */
static inline void evaluate(const sd_clump_placed *placed, double *in, int columns, const sd_clump_rows *out)
{
  const double *R = placed->pose;
  double *restrict F = out->F, *restrict T = out->T;
  for (int c = 0; c < columns; c++) in[c] *= placed->eta;
  for (int k = 0; k < placed->clump->n; k++) {
    const double *restrict t = placed->clump->table + 6 * SD_CLUMP_COLUMNS * (size_t) k;
    double f[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    for (int c = 0; c < columns; c++)
      for (int p = 0; p < 6; p++) f[p] += t[6 * c + p] * in[c];
    sd_multiply3(R, f, F + (long) out->width * k);
    if (T) sd_multiply3(R, f + 3, T + (long) out->width * k);
  }
}

void sd_clump_forces_rigid(const sd_clump_placed *placed, const double s0[3], const double W[3],
                           const sd_clump_rows *out)
{
  double in[RIGID];
  sd_multiply3t(placed->pose, s0, in);
  sd_multiply3t(placed->pose, W, in + 3);
  evaluate(placed, in, RIGID, out);
}

/* Slip s0 + A x into the axes of the shape */
void sd_clump_forces(const sd_clump_placed *placed, const double s0[3], const double A[9],
                     const sd_clump_rows *out)
{
  double W[3], in[SD_CLUMP_COLUMNS];
  sd_clump_split_gradient(placed->pose, A, W, in + 6);
  sd_multiply3t(placed->pose, s0, in);
  sd_multiply3t(placed->pose, W, in + 3);
  evaluate(placed, in, SD_CLUMP_COLUMNS, out);
}
