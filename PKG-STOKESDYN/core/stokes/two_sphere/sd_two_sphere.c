#include "sd_two_sphere.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_lagrange.h"
#include "sd_two_sphere_near.h"
#include "sd_two_sphere_table_internal.h"

/* The shipped table is read once, into a finer one of what is wanted, D and Q^T D Q, from which six
 * neighbours a direction are enough: even steps in the logarithms of the ratio and of xi, in which
 * near contact, where D goes like 1/xi and ln xi, is as smooth as far away. Radii 1 and ratio >= 1;
 * XA is held times xi. Reading is linear, so that a combination of the functions that is small has
 * an error as small: that keeps D >= 0. */
enum {
  RATIOS = SD_TWO_SPHERE_RATIOS,
  GAPS = SD_TWO_SPHERE_GAPS,
  FUNCTIONS = SD_TWO_SPHERE_FUNCTIONS
};
enum { ROWS = 97, COLUMNS = 193, STENCIL = SD_TWO_SPHERE_STENCIL };

typedef double functions[FUNCTIONS];

/* D, ordered as sd_pair_resistance, and Q^T D Q, which knows relative motion only: along d one
 * number each; across it the slip s = U_1 - U_2 - h W_1 - g W_2, h and g the parts of the distance
 * in the ratio of the radii, and the relative spin q = W_1 - W_2 resist as ss, sq, qq. All over the
 * scales of XA_11 ... */
typedef struct {
  functions full;
  double XA, XC, ss, sq, qq;
  /* whole registers */
  double none[3];
} entry;

enum { NUMBERS = sizeof(entry) / sizeof(double) };

struct sd_two_sphere {
  double largest_ratio;
  /* of ratios: 1, or at least STENCIL */
  int rows;
  double value[][COLUMNS][NUMBERS];
};

static double row_step(void)
{
  return log(SD_TWO_SPHERE_LARGEST_RATIO) / (ROWS - 1);
}

static double column_step(void)
{
  return log(SD_TWO_SPHERE_LARGEST_XI / SD_TWO_SPHERE_SMALLEST_XI) / (COLUMNS - 1);
}

/* D = what is left in the table + near + alone - model, radii 1 and ratio; at_ratio: the table
 * there */
static sd_pair_resistance correction_at(const functions *at_ratio, double ratio, double xi)
{
  double w[GAPS];
  functions left = {0.0}, scale;
  sd_two_sphere_weights(GAPS, sd_two_sphere_mu(ratio, xi) / sd_two_sphere_largest_mu(ratio), w);
  sd_two_sphere_scales(1.0, ratio, scale);
  for (int j = 0; j < GAPS; j++)
    for (int k = 0; k < FUNCTIONS; k++) left[k] += w[j] * at_ratio[j][k];
  for (int k = 0; k < FUNCTIONS; k++) left[k] *= scale[k];
  sd_pair_resistance D;
  memcpy(&D, left, sizeof D);
  const sd_pair_resistance near = sd_two_sphere_near(1.0, ratio, xi);
  const sd_pair_resistance alone = sd_two_sphere_alone(1.0, ratio);
  const sd_pair_resistance model =
      sd_pair_resistance_rpy(1.0, ratio, (1.0 + ratio) * (1.0 + 0.5 * xi));
  D = sd_pair_resistance_sum(1.0, &D, 1.0, &near);
  D = sd_pair_resistance_sum(1.0, &D, 1.0, &alone);
  return sd_pair_resistance_sum(1.0, &D, -1.0, &model);
}

static void fill_row(double ratio, double row[COLUMNS][NUMBERS])
{
  double w[RATIOS];
  functions at_ratio[GAPS] = {{0.0}}, scale;
  sd_two_sphere_weights(RATIOS, log(ratio) / log(SD_TWO_SPHERE_LARGEST_RATIO), w);
  for (int i = 0; i < RATIOS; i++)
    for (int j = 0; j < GAPS; j++)
      for (int k = 0; k < FUNCTIONS; k++) at_ratio[j][k] += w[i] * sd_two_sphere_table[i][j][k];
  sd_two_sphere_scales(1.0, ratio, scale);
  for (int c = 0; c < COLUMNS; c++) {
    const double xi = SD_TWO_SPHERE_SMALLEST_XI * exp(c * column_step());
    sd_pair_resistance D = correction_at(at_ratio, ratio, xi);
    if (ratio == 1.0) { /* equal spheres do not know which is 1, to the last bit */
      const sd_pair_resistance E = sd_pair_resistance_exchanged(&D);
      D = sd_pair_resistance_sum(0.5, &D, 0.5, &E);
    }
    const double h = 1.0 + 0.5 * xi;
    const sd_pair_resistance Q = sd_pair_resistance_relative(&D, 1.0, ratio, (1.0 + ratio) * h);
    const double ss = Q.YA[0], sq = Q.YB[0] + h * ss, qq = Q.YC[0] + h * (2.0 * sq - h * ss);
    entry e = {.XA = Q.XA[0] / scale[0] * xi,
               .XC = Q.XC[0] / scale[10],
               .ss = ss / scale[3],
               .sq = sq / scale[6],
               .qq = qq / scale[13]};
    memcpy(e.full, &D, sizeof e.full);
    for (int k = 0; k < FUNCTIONS; k++) e.full[k] *= (k < 3 ? xi : 1.0) / scale[k];
    memcpy(row[c], &e, sizeof e);
  }
}

sd_status sd_two_sphere_create(double largest_ratio, sd_two_sphere **out)
{
  *out = NULL;
  if (!(largest_ratio >= 1.0 && largest_ratio <= SD_TWO_SPHERE_LARGEST_RATIO)) return SD_EOUTSIDE;
  int rows = 1;
  if (largest_ratio > 1.0) rows = (int) (log(largest_ratio) / row_step()) + STENCIL;
  if (rows > ROWS) rows = ROWS;
  sd_two_sphere *t = malloc(sizeof *t + sizeof t->value[0] * (size_t) rows);
  if (!t) return SD_ENOMEMORY;
  t->largest_ratio = largest_ratio;
  t->rows = rows;
  for (int r = 0; r < rows; r++) fill_row(exp(r * row_step()), t->value[r]);
  *out = t;
  return SD_OK;
}

void sd_two_sphere_free(sd_two_sphere *t)
{
  free(t);
}

/* Lagrange's polynomials */
int sd_two_sphere_stencil(double at, int n, double w[STENCIL])
{
  static const double inverse[STENCIL] = {-1.0 / 120, 1.0 / 24,  -1.0 / 12,
                                          1.0 / 12,   -1.0 / 24, 1.0 / 120};
  int first = (int) at - STENCIL / 2 + 1;
  if (first > n - STENCIL) first = n - STENCIL;
  if (first < 0) first = 0;
  sd_lagrange(at - first, STENCIL, inverse, w);
  return first;
}

/* Radii 1 and ratio >= 1, both inside. Equal spheres, the commonest, are row 0. */
static entry read_table(const sd_two_sphere *t, double ratio, double xi)
{
  static const double one[STENCIL] = {1.0};
  double wr[STENCIL], wc[STENCIL], value[NUMBERS] = {0.0};
  const int rows = ratio == 1.0 || t->rows == 1 ? 1 : STENCIL;
  const int r = rows > 1 ? sd_two_sphere_stencil(log(ratio) * (1.0 / row_step()), t->rows, wr) : 0;
  const double lowest = log(SD_TWO_SPHERE_SMALLEST_XI);
  const int c = sd_two_sphere_stencil((log(xi) - lowest) * (1.0 / column_step()), COLUMNS, wc);
  for (int i = 0; i < rows; i++)
    for (int j = 0; j < STENCIL; j++) {
      const double w = (rows > 1 ? wr : one)[i] * wc[j], *from = t->value[r + i][c + j];
      for (int k = 0; k < NUMBERS; k++) value[k] += w * from[k];
    }
  entry e;
  memcpy(&e, value, sizeof e);
  return e;
}

/* p D + q Q^T D Q with the radii */
static sd_pair_resistance put_together(const entry *e, double a1, double a2, double xi, double p,
                                       double q)
{
  const double h = a1 * (1.0 + 0.5 * xi), g = a2 * (1.0 + 0.5 * xi);
  functions scale, D;
  sd_two_sphere_scales(a1, a2, scale);
  for (int k = 0; k < FUNCTIONS; k++) D[k] = p * scale[k] * e->full[k];
  const double XA = q * scale[0] * e->XA, XC = q * scale[10] * e->XC, ss = q * scale[3] * e->ss,
               sq = q * scale[6] * e->sq, qq = q * scale[13] * e->qq;
  const double B1 = sq - h * ss, B2 = sq + g * ss;
  const double film = 1.0 / xi;
  return (sd_pair_resistance){
      {film * (D[0] + XA), film * (D[1] - XA), film * (D[2] + XA)},
      {D[3] + ss, D[4] - ss, D[5] + ss},
      {D[6] + B1, D[7] - B1, D[8] - B2, D[9] + B2},
      {D[10] + XC, D[11] - XC, D[12] + XC},
      {D[13] + qq - h * (sq + B1), D[14] - qq + h * sq - g * B1, D[15] + qq + g * (sq + B2)}};
}

sd_status sd_two_sphere_correction(const sd_two_sphere *t, double a1, double a2, double xi,
                                   double p, double q, sd_pair_resistance *R)
{
  const double small = a1 < a2 ? a1 : a2, large = a1 < a2 ? a2 : a1, ratio = large / small;
  if (!(ratio <= t->largest_ratio * (1.0 + 1e-12))) return SD_EOUTSIDE;
  if (!(xi >= SD_TWO_SPHERE_SMALLEST_XI && xi <= SD_TWO_SPHERE_LARGEST_XI)) return SD_EOUTSIDE;
  const entry e = read_table(t, ratio, xi);
  *R = put_together(&e, small, large, xi, p, q);
  if (a1 > a2) *R = sd_pair_resistance_exchanged(R);
  return SD_OK;
}
