#include "sd_sph_filling.h"

#include "sd_linear.h"
#include "sd_sph_class.h"
#include "sd_sph_probe.h"

#include <math.h>

static double filling_volume(const sd_sph_particles *p, int i)
{
  return fabs(p->x4[4 * (size_t) i + 3]);
}

static double filling_distance(const sd_sph_two *two)
{
  return sqrt(two->r2) * two->pair->inv_h;
}

static double filling_weight(const sd_sph_model *model, const sd_sph_two *two)
{
  return two->pair->weight * sd_sph_K(model->kernel, filling_distance(two));
}

static void add_surroundings(const sd_sph_model *model, const sd_sph_particles *p, const sd_sph_two *two,
                             double *sums)
{
  const double g = two->pair->grad * sd_sph_G(model->kernel, filling_distance(two)), W = filling_weight(model, two);
  const double Vi = filling_volume(p, two->i), Vj = filling_volume(p, two->j);
  double *of_i = sums + 4 * (size_t) two->i, *of_j = sums + 4 * (size_t) two->j;
  for (int c = 0; c < 3; c++) {
    of_i[c] += Vj * g * two->d[c];
    of_j[c] -= Vi * g * two->d[c];
  }
  of_i[3] += Vj * W;
  of_j[3] += Vi * W;
}

void sd_sph_surroundings(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                         double *sums)
{
  sd_sph_each_pair(model, list, p, add_surroundings, sums);
}

double sd_sph_filled(const sd_sph_model *model, const sd_sph_particles *p, int i, const double sums[4],
                     const double M[6])
{
  const sd_sph_coefficients *own = sd_sph_of_pair(model, p, i, i);
  const double filled = sums[3] + filling_volume(p, i) * own->weight * sd_sph_K(model->kernel, 0.0);
  const double mean = (M[0] + M[1] + (model->dimension == 3 ? M[2] : 0.0)) / model->dimension;
  if (sqrt(sd_dot(sums, sums)) > 0.2 * filled * own->inv_h) return 0.0;
  return sd_sph_least_eigenvalue(model->dimension, M) < 0.7 * mean ? 0.0 : filled;
}

/* Of two particles one of which is of a wall: the other one, and x_w - x_f = sign d. -1: both are, or none. */
static int before_wall(const sd_sph_particles *p, const sd_sph_two *two, double *sign)
{
  const int i_is_wall = p->phase[two->i] < 0, j_is_wall = p->phase[two->j] < 0;
  if (i_is_wall == j_is_wall) return -1;
  *sign = i_is_wall ? 1.0 : -1.0;
  return i_is_wall ? two->j : two->i;
}

static void add_toward(const sd_sph_model *model, const sd_sph_particles *p, const sd_sph_two *two, double *rows)
{
  double sign;
  const int fluid = before_wall(p, two, &sign);
  if (fluid < 0) return;
  const double W = sign * filling_weight(model, two);
  for (int c = 0; c < 3; c++) rows[4 * (size_t) fluid + c] += W * two->d[c];
}

void sd_sph_toward_walls(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                         double *rows)
{
  sd_sph_each_pair(model, list, p, add_toward, rows);
}

static void find_reach(const sd_sph_model *model, const sd_sph_particles *p, const sd_sph_two *two, double *rows)
{
  (void) model;
  double sign;
  const int fluid = before_wall(p, two, &sign);
  if (fluid < 0) return;
  double *row = rows + 4 * (size_t) fluid;
  const double length = sqrt(sd_dot(row, row));
  if (length > 0.0) row[3] = fmax(row[3], sign * sd_dot(two->d, row) / length);
}

void sd_sph_reach_of_walls(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                           double *rows)
{
  sd_sph_each_pair(model, list, p, find_reach, rows);
}

int sd_sph_sees_past(const sd_sph_model *model, const sd_sph_particles *p, int i, double reach)
{
  const double spacing = pow(filling_volume(p, i), 1.0 / model->dimension);
  return reach + 1.5 * spacing < sd_sph_of_pair(model, p, i, i)->support * (1.0 - 1e-9);
}
