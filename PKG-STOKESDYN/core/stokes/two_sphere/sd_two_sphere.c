#include "sd_two_sphere.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_two_sphere_near.h"
#include "sd_two_sphere_table_internal.h"

/* The shipped table is read once, into a finer one from which six neighbours a direction are
 * enough: even steps in the logarithm of the ratio and in x = (mu over its largest value)^(1/2), in
 * which what is left at contact, mu^4 ln mu, is smooth. It holds D less what sd_two_sphere_near
 * has, over sd_two_sphere_scales. */
enum {
  RATIOS = SD_TWO_SPHERE_RATIOS,
  GAPS = SD_TWO_SPHERE_GAPS,
  FUNCTIONS = SD_TWO_SPHERE_FUNCTIONS
};
enum { ROWS = 97, COLUMNS = 97, STENCIL = 6 };

typedef double functions[FUNCTIONS];

struct sd_two_sphere {
  double largest_ratio;
  /* of ratios: 1, or at least STENCIL */
  int rows;
  functions value[][COLUMNS];
};

static double row_step(void)
{
  return log(SD_TWO_SPHERE_LARGEST_RATIO) / (ROWS - 1);
}

/* Weights [n] of the values at n Chebyshev nodes for that at t in [0, 1]: barycentric formula */
static void weights_of_nodes(int n, double t, double *w)
{
  double sum = 0.0;
  for (int k = 0; k < n; k++) {
    const double d = t - sd_two_sphere_node(n, k);
    if (d == 0.0) {
      memset(w, 0, sizeof(double) * (size_t) n);
      w[k] = 1.0;
      return;
    }
    const double node = sd_two_sphere_node(n, k), s = sqrt(node * (1.0 - node));
    sum += w[k] = (k % 2 ? -s : s) / d;
  }
  for (int k = 0; k < n; k++) w[k] /= sum;
}

/* value += what the spheres resist alone less what they do in the RPY model; radii 1 and ratio */
static void take_off_rpy(double ratio, double mu, functions value)
{
  const double xi = sd_two_sphere_xi(ratio, mu);
  const sd_pair_resistance rpy =
      sd_pair_resistance_rpy(1.0, ratio, (1.0 + ratio) * (1.0 + 0.5 * xi));
  const sd_pair_resistance alone = sd_two_sphere_alone(1.0, ratio);
  const sd_pair_resistance rest = sd_pair_resistance_sum(1.0, &alone, -1.0, &rpy);
  functions scale, less;
  sd_two_sphere_scales(1.0, ratio, scale);
  memcpy(less, &rest, sizeof rest);
  for (int k = 0; k < FUNCTIONS; k++) value[k] += less[k] / scale[k];
}

static void fill_row(double ratio, functions row[COLUMNS])
{
  double w[RATIOS > GAPS ? RATIOS : GAPS];
  functions at_ratio[GAPS] = {{0.0}};
  weights_of_nodes(RATIOS, log(ratio) / log(SD_TWO_SPHERE_LARGEST_RATIO), w);
  for (int i = 0; i < RATIOS; i++)
    for (int j = 0; j < GAPS; j++)
      for (int k = 0; k < FUNCTIONS; k++) at_ratio[j][k] += w[i] * sd_two_sphere_table[i][j][k];
  memset(row, 0, COLUMNS * sizeof(functions));
  for (int c = 0; c < COLUMNS; c++) {
    const double x = (double) c / (COLUMNS - 1);
    weights_of_nodes(GAPS, x * x, w);
    for (int j = 0; j < GAPS; j++)
      for (int k = 0; k < FUNCTIONS; k++) row[c][k] += w[j] * at_ratio[j][k];
    take_off_rpy(ratio, x * x * sd_two_sphere_largest_mu(ratio), row[c]);
  }
}

/* Equal spheres do not know which is 1, to the last bit. */
static void make_symmetric(functions value)
{
  sd_pair_resistance R;
  memcpy(&R, value, sizeof R);
  const sd_pair_resistance E = sd_pair_resistance_exchanged(&R);
  R = sd_pair_resistance_sum(0.5, &R, 0.5, &E);
  memcpy(value, &R, sizeof R);
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
  for (int c = 0; c < COLUMNS; c++) make_symmetric(t->value[0][c]);
  *out = t;
  return SD_OK;
}

void sd_two_sphere_free(sd_two_sphere *t)
{
  free(t);
}

/* Lagrange's polynomials of STENCIL even steps around the place at >= 0 among n; the first step */
static int stencil(double at, int n, double w[STENCIL])
{
  static const double inverse[STENCIL] = {-1.0 / 120, 1.0 / 24,  -1.0 / 12,
                                          1.0 / 12,   -1.0 / 24, 1.0 / 120};
  int first = (int) at - STENCIL / 2 + 1;
  if (first > n - STENCIL) first = n - STENCIL;
  if (first < 0) first = 0;
  double below[STENCIL], above = 1.0;
  below[0] = 1.0;
  for (int k = 1; k < STENCIL; k++) below[k] = below[k - 1] * (at - first - (k - 1));
  for (int k = STENCIL - 1; k >= 0; k--) {
    w[k] = below[k] * above * inverse[k];
    above *= at - first - k;
  }
  return first;
}

/* radii 1 and ratio >= 1 */
static void read_table(const sd_two_sphere *t, double ratio, double xi, functions value)
{
  double wr[STENCIL] = {1.0}, wc[STENCIL];
  const double x = sqrt(sd_two_sphere_mu(ratio, xi) / sd_two_sphere_largest_mu(ratio));
  const int rows = t->rows > 1 ? STENCIL : 1;
  const int r = rows > 1 ? stencil(log(ratio) / row_step(), t->rows, wr) : 0;
  const int c = stencil(x * (COLUMNS - 1), COLUMNS, wc);
  memset(value, 0, sizeof(functions));
  for (int i = 0; i < rows; i++)
    for (int j = 0; j < STENCIL; j++)
      for (int k = 0; k < FUNCTIONS; k++) value[k] += wr[i] * wc[j] * t->value[r + i][c + j][k];
}

sd_status sd_two_sphere_correction(const sd_two_sphere *t, double a1, double a2, double xi,
                                   sd_pair_resistance *full, sd_pair_resistance *relative)
{
  if (a1 > a2) {
    sd_pair_resistance f, q;
    const sd_status status = sd_two_sphere_correction(t, a2, a1, xi, &f, &q);
    if (status != SD_OK) return status;
    *full = sd_pair_resistance_exchanged(&f);
    *relative = sd_pair_resistance_exchanged(&q);
    return SD_OK;
  }
  const double ratio = a2 / a1;
  if (!(ratio <= t->largest_ratio * (1.0 + 1e-12))) return SD_EOUTSIDE;
  if (!(xi > 0.0 && xi <= SD_TWO_SPHERE_LARGEST_XI)) return SD_EOUTSIDE;
  functions value, scale;
  read_table(t, ratio, xi, value);
  sd_two_sphere_scales(a1, a2, scale);
  *full = sd_two_sphere_near(a1, a2, xi);
  for (int k = 0; k < FUNCTIONS; k++) value[k] *= scale[k];
  const sd_pair_resistance near = *full;
  memcpy(full, value, sizeof *full);
  *full = sd_pair_resistance_sum(1.0, full, 1.0, &near);
  *relative = sd_pair_resistance_relative(full, a1, a2, (a1 + a2) * (1.0 + 0.5 * xi));
  return SD_OK;
}
