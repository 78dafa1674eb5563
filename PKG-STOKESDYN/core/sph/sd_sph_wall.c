#include "sd_sph_wall.h"

#include "sd_linear.h"
#include "sd_sph_class.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* D (s^4 - s^2) with s = r0 / r: a Lennard-Jones force without its attraction, 0 at r0 with a jump
 * of the slope. */
double sd_sph_repulsion(double D, double r0, double r)
{
  if (!(r < r0)) return 0.0;
  const double s2 = (r0 / r) * (r0 / r);
  return D * (s2 * s2 - s2);
}

/* - m_a m_b (A_a + A_b) W' with the particle's own image as b: both have the same A. */
double sd_sph_mirror(double m, double P, double rho, double dW)
{
  return -m * m * 2.0 * P / (rho * rho) * dW;
}

void sd_sph_pack_fluid(const sd_sph_particles *p, const double *pressure, double *q)
{
  memset(q, 0, 8 * sizeof(double) * (size_t) (p->n + 1));
  for (int i = 0; i < p->n; i++) {
    if (p->phase[i] < 0) continue;
    const double *v4 = p->v4 + 4 * (size_t) i;
    double *row = q + 8 * (size_t) i;
    row[0] = 1.0;
    row[1] = pressure[i];
    row[2] = v4[3];
    memcpy(row + 4, v4, 3 * sizeof(double));
  }
}

void sd_sph_wall_acceleration(const double v[3], double dt, double tau, double before[3],
                              double a[3])
{
  for (int d = 0; d < 3; d++) {
    a[d] += (v[d] - before[d] - dt * a[d]) / (dt + tau);
    before[d] = v[d];
  }
}

/* A wall particle and a fluid particle within the support: d = x_w - x_f. */
typedef struct {
  int wall, fluid;
  double d[3];
} meeting;
typedef void with_meeting(const sd_sph_model *model, const sd_sph_particles *p, const meeting *two,
                          double *out);

static void each_meeting(const sd_sph_model *model, const sd_sph_list *list,
                         const sd_sph_particles *p, with_meeting *meet, double *out)
{
  for (int k = 0; k < list->n; k++) {
    const int i = list->first[k], i_is_wall = p->phase[i] < 0;
    for (int m = 0; m < list->count[i]; m++) {
      const int j = list->neighbor[i][m] & list->mask;
      if ((p->phase[j] < 0) == i_is_wall) continue;
      meeting two = {.wall = i_is_wall ? i : j, .fluid = i_is_wall ? j : i};
      sd_minus(p->x4 + 4 * (size_t) two.wall, p->x4 + 4 * (size_t) two.fluid, two.d);
      const double support = sd_sph_of_pair(model, p, i, j)->support;
      if (sd_dot(two.d, two.d) < support * support) meet(model, p, &two, out);
    }
  }
}

static void wall_compare(const sd_sph_model *model, const sd_sph_particles *p, const meeting *two,
                         double *likeness)
{
  const int wall = two->wall, fluid = two->fluid;
  if (~p->phase[wall] != p->phase[fluid]) return;
  const double ratio = sd_sph_mass(model, p, wall) / sd_sph_mass(model, p, fluid);
  likeness[wall] = fmax(likeness[wall], -fabs(log(ratio)));
}

void sd_sph_likeness(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                     double *likeness)
{
  each_meeting(model, list, p, wall_compare, likeness);
}

static void add_motion(const sd_sph_model *model, const sd_sph_particles *p, const meeting *two,
                       double *sums)
{
  (void) model;
  const double *d = two->d;
  double u[3], across[3], *row = sums + SD_SPH_MOTION * (size_t) two->fluid;
  sd_minus(p->v4 + 4 * (size_t) two->wall, p->v4 + 4 * (size_t) two->fluid, u);
  sd_cross(d, u, across);
  row[0] += 1.0;
  for (int c = 0; c < 3; c++) {
    row[1 + c] += d[c];
    row[4 + c] += u[c];
    row[7 + c] += across[c];
    row[10 + c] += d[c] * d[c];
  }
  row[13] += d[0] * d[1];
  row[14] += d[0] * d[2];
  row[15] += d[1] * d[2];
  row[16] += sd_dot(u, u);
}

void sd_sph_motion_of_walls(const sd_sph_model *model, const sd_sph_list *list,
                            const sd_sph_particles *p, double *sums)
{
  each_meeting(model, list, p, add_motion, sums);
}

/* J w = L for the moments of inertia of the wall particles. Those of one row, about which J is singular,
 * do not tell the part of w along it: it is 0. */
static void least_squares(const double J[9], const double L[3], double w[3])
{
  double columns[3][3];
  for (int c = 0; c < 3; c++) sd_cross(J + 3 * ((c + 1) % 3), J + 3 * ((c + 2) % 3), columns[c]);
  const double det = sd_dot(J, columns[0]), mean = (J[0] + J[4] + J[8]) / 3.0;
  if (det > 1e-9 * mean * mean * mean) {
    for (int c = 0; c < 3; c++)
      w[c] = (columns[0][c] * L[0] + columns[1][c] * L[1] + columns[2][c] * L[2]) / det;
    return;
  }
  double values[3], axes[9];
  sd_eigen(3, J, values, axes);
  w[0] = w[1] = w[2] = 0.0;
  for (int k = 0; k < 3; k++) {
    if (!(values[k] > 1e-9 * values[0])) continue;
    const double along = (axes[k] * L[0] + axes[3 + k] * L[1] + axes[6 + k] * L[2]) / values[k];
    for (int c = 0; c < 3; c++) w[c] += along * axes[3 * c + k];
  }
}

/* Least squares: u - <u> = w x (d - <d>) gives J w = L with the moments about the mean place, and what
 * is left of the squares of u - <u> is their sum - w.L. */
double sd_sph_spin(const double sums[SD_SPH_MOTION], double w[3], double *shear)
{
  const double n = sums[0], *d = sums + 1, *u = sums + 4, *dd = sums + 10;
  *shear = w[0] = w[1] = w[2] = 0.0;
  if (n < 6.0) return 0.0; /* fewer may be of two walls and fit a rotation by chance */
  const double squares = sums[16] - sd_dot(u, u) / n;
  if (squares < 1e-26 * sums[16]) return 0.0; /* one velocity, and rounding */
  double of_means[3], L[3];
  sd_cross(d, u, of_means);
  for (int c = 0; c < 3; c++) L[c] = sums[7 + c] - of_means[c] / n;
  const double xx = dd[0] - d[0] * d[0] / n, yy = dd[1] - d[1] * d[1] / n,
               zz = dd[2] - d[2] * d[2] / n, xy = dd[3] - d[0] * d[1] / n,
               xz = dd[4] - d[0] * d[2] / n, yz = dd[5] - d[1] * d[2] / n;
  const double J[9] = {yy + zz, -xy, -xz, -xy, xx + zz, -yz, -xz, -yz, xx + yy};
  least_squares(J, L, w);
  double at_fluid[3], slip[3];
  sd_cross(w, d, at_fluid);
  sd_minus(u, at_fluid, slip);
  *shear = sqrt(sd_dot(slip, slip) / (n * (dd[0] + dd[1] + dd[2])));
  if (squares - sd_dot(w, L) < 1e-6 * squares) return sqrt(sd_dot(w, w));
  *shear = w[0] = w[1] = w[2] = 0.0;
  return 0.0;
}

/* The density is what carries the pressure on: ghosts of the wall get it as that of any particle,
 * and the equation of state makes the same pressure of it on every rank. */
double sd_sph_wall_particle(const sd_sph_wall *wall, const double s[8], const double v[3],
                            const double b[3], double row[4])
{
  /* No slip: the wall shows the fluid the velocity that makes the mean of the two that of the wall,
   * v - (fluid - v). With slip it shows the fluid its own. */
  const int alone = s[0] == 0.0;
  double P = alone ? wall->state->P0 : (s[1] + sd_dot(b, s + 2)) / s[0];
  if (!wall->suction && P < 0.0) P = 0.0;
  if (!alone || wall->state->kind != SD_SPH_ABSOLUT) row[0] = sd_sph_density_of(wall->state, P);
  for (int d = 0; d < 3; d++) {
    const double ahead = alone ? 0.0 : s[5 + d] / s[0] - v[d];
    row[1 + d] = wall->slip ? ahead : -ahead;
  }
  return P;
}

double sd_sph_arrangement(const sd_sph_model *model, double h, double spacing, double P, double V)
{
  if (sd_sph_corrects(model)) return 0.0;
  const double pi = 3.14159265358979323846;
  const int wendland = model->kernel == SD_SPH_WENDLAND;
  const double width = (wendland ? 2.0 : 1.3) * spacing / h;
  const double part = !wendland ? 0.07 : model->dimension == 3 ? 0.014 : 0.01;
  const double left = model->scheme == SD_SPH_SHIFT_PLIANT ? 0.2 : 1.0, G = left * part * P * width * width * width;
  return model->dimension == 3 ? 6.0 * pi * G * cbrt(3.0 * V / (4.0 * pi)) : 2.0 * pi * G;
}
