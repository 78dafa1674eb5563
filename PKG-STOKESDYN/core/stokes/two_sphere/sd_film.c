#include "sd_film.h"

#include <math.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_film_table_internal.h"
#include "sd_tensor.h"
#include "sd_two_sphere_table_internal.h"

const double sd_film_table[SD_FILM_KINDS][SD_FILM_RATIOS][SD_FILM_GAPS][SD_FILM_SCALARS] = {
#include "sd_film_table.inc"
};

const double sd_film_half_table[SD_FILM_HALF_ROWS][2][SD_FILM_GAPS][SD_FILM_SCALARS] = {
#include "sd_film_half_table.inc"
};

const sd_film_kind sd_film_kinds[SD_FILM_HALF_KINDS] = {
    {42, 12, 8, 1.0, 10.0},
    {162, 12, 7, 5.0 / 3.0, 10.0},
    {642, 12, 6, 10.0 / 3.0, 10.0},
    {42, 42, 8, 1.0, 20.0 / 3.0},
    {162, 42, 7, 1.0, 20.0 / 3.0},
    {642, 42, 6, 2.0, 20.0 / 3.0},
    {162, 162, 6, 1.0, 4.0},
    {642, 162, 5, 1.0, 4.0},
    {642, 642, 3, 1.0, 2.0},
};

enum { RATIOS = SD_FILM_RATIOS, GAPS = SD_FILM_GAPS, SCALARS = SD_FILM_SCALARS, NUMBERS = SD_FILM_NUMBERS };

static double node_of_xi(double xi)
{
  return sqrt(xi / SD_FILM_LARGEST_XI);
}

void sd_film_scales(double a1, double a2, double scale[SCALARS])
{
  const double c1 = a1 * a1 * a1, c2 = a2 * a2 * a2;
  scale[0] = 6.0 * SD_PI * a1 * a2 / (a1 + a2);
  scale[1] = 8.0 * SD_PI * c1 * c2 / (c1 + c2);
  scale[2] = 8.0 * SD_PI * c1;
  scale[3] = 8.0 * SD_PI * sqrt(c1 * c2);
  scale[4] = 8.0 * SD_PI * c2;
}

typedef const double gap_table[GAPS][SCALARS];

/* out: between `count` tables, each `step` behind the last one, at t of their nodes */
static void at_ratio(gap_table *table, int step, int count, double t, double out[GAPS][SCALARS])
{
  double w[RATIOS];
  sd_two_sphere_weights(count, t, w);
  memset(out, 0, sizeof(double) * GAPS * SCALARS);
  for (int i = 0; i < count; i++)
    for (int j = 0; j < GAPS; j++)
      for (int k = 0; k < SCALARS; k++) out[j][k] += w[i] * table[i * step][j][k];
}

static void alike_at_ratio(const sd_films *films, double ratio, double out[GAPS][SCALARS])
{
  at_ratio(films->shells, 1, RATIOS, sd_film_v(ratio) / SD_FILM_LARGEST_V, out);
}

void sd_film_clip(double *p, double *q, double *r)
{
  const double mean = 0.5 * (*p + *r), half = 0.5 * (*p - *r), root = sqrt(half * half + *q * *q);
  const double most = mean + root;
  if (mean - root >= 0.0) return;
  if (!(most > 0.0)) {
    *p = *q = *r = 0.0;
    return;
  }
  /* the projector on the larger one is (1 + (half q; q -half)/root)/2 */
  const double c = half / root, s = *q / root;
  *p = 0.5 * most * (1.0 + c);
  *q = 0.5 * most * s;
  *r = 0.5 * most * (1.0 - c);
}

/* Over sd_film_scales what two spheres resist beyond their shells, not clipped; over the first of these what the
 * shells resist of an approach. shells: the means of two shells at this ratio, node_of_xi of what their gaps stand
 * for; a1 <= a2 */
static sd_status find_numbers(const sd_films *films, const double (*shells)[SCALARS], double node, double a1,
                              double a2, double xi, double out[NUMBERS])
{
  double w[GAPS], sums[SCALARS] = {0.0}, scale[SCALARS];
  sd_pair_resistance R;
  const sd_status status = sd_two_sphere_correction(films->exact, a1, a2, xi, 0.0, 1.0, &R);
  if (status != SD_OK) return status;
  sd_two_sphere_weights_at(GAPS, films->node, films->root, node, w);
  for (int j = 0; j < GAPS; j++)
    for (int k = 0; k < SCALARS; k++) sums[k] += w[j] * shells[j][k];
  sd_film_scales(a1, a2, scale);
  const double beyond[SCALARS] = {R.XA[0], R.XC[0], R.YC[0], R.YC[1], R.YC[2]};
  for (int k = 0; k < SCALARS; k++) out[k] = beyond[k] / scale[k] - sums[k];
  out[SCALARS] = sums[0] + sd_rpy_approach((1.0 + 0.5 * xi) * (a1 + a2), a1, a2, 1.0) / scale[0];
  return SD_OK;
}

static double at_least_0(double x)
{
  return x > 0.0 ? x : 0.0;
}

static sd_film film_from(double number[NUMBERS], double a1, double a2)
{
  double scale[SCALARS];
  sd_film_scales(a1, a2, scale);
  sd_film_clip(&number[2], &number[3], &number[4]);
  return (sd_film){scale[0] * at_least_0(number[0]),
                   scale[1] * at_least_0(number[1]),
                   {scale[2] * number[2], scale[3] * number[3], scale[4] * number[4]},
                   scale[0] * at_least_0(number[SCALARS])};
}

static sd_status film_of(const sd_films *films, const double (*shells)[SCALARS], double node, double a1,
                         double a2, double xi, sd_film *film)
{
  double number[NUMBERS];
  const sd_status status = find_numbers(films, shells, node, a1, a2, xi, number);
  if (status == SD_OK) *film = film_from(number, a1, a2);
  return status;
}

/* Those of equal spheres are held at even steps in the logarithm of xi, a quarter as long as the exact ones: towards
 * the largest gap the means of shells need these. */
static double film_step(void)
{
  return log(SD_FILM_LARGEST_XI / SD_TWO_SPHERE_SMALLEST_XI) / (SD_FILM_STEPS - 1);
}

/* A_n is held times xi. Equal spheres do not know which is 1, to the last bit. */
static sd_status tabulate_equal(sd_films *films)
{
  double shells[GAPS][SCALARS];
  sd_status status = SD_OK;
  alike_at_ratio(films, 1.0, shells);
  for (int c = 0; c < SD_FILM_STEPS && status == SD_OK; c++) {
    const double xi = SD_TWO_SPHERE_SMALLEST_XI * exp(c * film_step());
    double *number = films->equal[c];
    status = find_numbers(films, shells, node_of_xi(xi), 1.0, 1.0, xi, number);
    number[0] *= xi;
    number[2] = number[4] = 0.5 * (number[2] + number[4]);
  }
  return status;
}

sd_status sd_films_create(int n, int one_body, const sd_two_sphere *exact, sd_films *out)
{
  if (n != 12 && n != 42) return SD_EOUTSIDE;
  out->exact = exact;
  out->half = NULL;
  sd_two_sphere_nodes(GAPS, out->node, out->root);
  out->shells = sd_film_table[2 * (n == 42) + (one_body != 0)];
  return tabulate_equal(out);
}

sd_status sd_films_create_by_radius(int one_body, const sd_two_sphere *exact, sd_films *out)
{
  const sd_status status = sd_films_create(12, one_body, exact, out);
  out->half = &sd_film_half_table[0][one_body != 0];
  return status;
}

static sd_film film_of_equal(const sd_films *films, double a, double xi)
{
  double w[SD_TWO_SPHERE_STENCIL], number[NUMBERS] = {0.0};
  const double at = log(xi / SD_TWO_SPHERE_SMALLEST_XI) * (1.0 / film_step());
  const int first = sd_two_sphere_stencil(at, SD_FILM_STEPS, w);
  for (int j = 0; j < SD_TWO_SPHERE_STENCIL; j++)
    for (int k = 0; k < NUMBERS; k++) number[k] += w[j] * films->equal[first + j][k];
  number[0] /= xi;
  return film_from(number, a, a);
}

/* a1 <= a2 */
static sd_status film_alike(const sd_films *films, double a1, double a2, double xi, sd_film *film)
{
  double shells[GAPS][SCALARS];
  if (!(a2 <= SD_FILM_LARGEST_RATIO * (1.0 + 1e-12) * a1)) return SD_EOUTSIDE;
  if (!(xi >= SD_TWO_SPHERE_SMALLEST_XI && xi <= SD_FILM_LARGEST_XI)) return SD_EOUTSIDE;
  if (a1 == a2) {
    *film = film_of_equal(films, a1, xi);
    return SD_OK;
  }
  alike_at_ratio(films, a2 / a1, shells);
  return film_of(films, shells, node_of_xi(xi), a1, a2, xi, film);
}

static void film_exchange(sd_film *film)
{
  const double B = film->B[0];
  film->B[0] = film->B[2];
  film->B[2] = B;
}

sd_status sd_film_at(const sd_films *films, double a1, double a2, double xi, sd_film *film)
{
  const double small = a1 < a2 ? a1 : a2, large = a1 < a2 ? a2 : a1;
  const sd_status status = film_alike(films, small, large, xi, film);
  if (a1 > a2) film_exchange(film);
  return status;
}

/* The kind of these shells, and its first row; NULL: there is none */
static const sd_film_kind *find_kind(int small, int large, int *row)
{
  *row = 0;
  for (int k = 0; k < SD_FILM_HALF_KINDS; k++) {
    const sd_film_kind *kind = sd_film_kinds + k;
    if (kind->small == small && kind->large == large) return kind;
    *row += kind->ratios;
  }
  return NULL;
}

/* Sphere 1 of n1 points, a1 <= a2 */
static sd_status film_by_radius(const sd_films *films, int n1, int n2, double a1, double a2, double xi,
                                sd_film *film)
{
  double shells[GAPS][SCALARS];
  int row;
  const sd_film_kind *kind = find_kind(n1, n2, &row);
  const double ratio = a2 / a1, harmonic = xi / sd_film_harmonic(a1, a2), hair = 1e-9;
  if (!kind || !(ratio >= kind->lowest * (1.0 - hair) && ratio <= kind->highest * (1.0 + hair)))
    return SD_EOUTSIDE;
  if (!(harmonic <= SD_FILM_LARGEST_XI * (1.0 + hair))) return SD_EOUTSIDE;
  const double low = sd_film_v(kind->lowest), high = sd_film_v(kind->highest);
  at_ratio(films->half + 2 * (long) row, 2, kind->ratios, (sd_film_v(ratio) - low) / (high - low), shells);
  if (n1 == n2 && a1 == a2)
    for (int j = 0; j < GAPS; j++) shells[j][2] = shells[j][4] = 0.5 * (shells[j][2] + shells[j][4]);
  return film_of(films, shells, node_of_xi(harmonic), a1, a2, xi, film);
}

sd_status sd_film_between(const sd_films *films, int n1, int n2, double a1, double a2, double xi,
                          sd_film *film)
{
  if (!films->half || (n1 == 12 && n2 == 12)) return sd_film_at(films, a1, a2, xi, film);
  const sd_status status = a1 <= a2 ? film_by_radius(films, n1, n2, a1, a2, xi, film)
                                    : film_by_radius(films, n2, n1, a2, a1, xi, film);
  if (a1 > a2 && status == SD_OK) film_exchange(film);
  return status;
}

/* A velocity of sphere 2 alone turns both against the line of centres by U x d/R, and so bears
 * t_q = (B_q1 + B_q2) U x d/R; one of sphere 1 the opposite. */
sd_pair_resistance sd_film_resistance(const sd_film *film, double distance, double scale)
{
  const double A = scale * film->A_n, C = scale * film->A_t;
  const double B[3] = {scale * film->B[0], scale * film->B[1], scale * film->B[2]};
  const double s1 = (B[0] + B[1]) / distance, s2 = (B[1] + B[2]) / distance;
  const double slide = (s1 + s2) / distance;
  return (sd_pair_resistance){
      {A, -A, A}, {slide, -slide, slide}, {-s1, s1, -s2, s2}, {C, -C, C}, {B[0], B[1], B[2]}};
}
