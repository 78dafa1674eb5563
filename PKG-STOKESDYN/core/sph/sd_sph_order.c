#include "sd_sph_order.h"

#include "sd_sph_class.h"
#include "sd_sph_rheology.h"
#include "sd_sph_symmetric.h"

#include <math.h>
#include <string.h>

void sd_sph_pack_volumes(const sd_sph_model *model, const sd_sph_particles *p, const double *rho,
                         double *x4)
{
  for (int i = 0; i < p->n; i++) {
    const double V = sd_sph_mass(model, p, i) / rho[i];
    x4[4 * (size_t) i + 3] = p->phase && p->phase[i] < 0 ? -V : V;
  }
  x4[4 * (size_t) p->n + 3] = 0.0;
}

/* M of a row of sums, - sum V_b g d d^T. It would be the unit matrix if sums were integrals; what
 * it lacks is what is wrong with a gradient that is summed, and B = M^-1 puts it right. In two
 * dimensions nothing is summed along z: a unit there keeps the inverse two-dimensional. */
static sd_sph_symmetric moment(int dimension, const double *sums)
{
  sd_sph_symmetric M;
  memcpy(M.a, sums, sizeof(M.a));
  if (dimension == 2) {
    M.a[2] = 1.0;
    M.a[4] = M.a[5] = 0.0;
  }
  return M;
}

/* M is about half the unit matrix at a plane surface, and a quarter in two directions along an
 * edge: det > 1/64. Below 1e-3, a tenth in each of three directions, neighbours are so few that the
 * inverse would raise their noise tenfold: 0 then. */
static sd_sph_symmetric inverse(const sd_sph_symmetric *M)
{
  const sd_sph_symmetric cofactor = sd_sph_cofactors(M);
  const double det = sd_sph_determinant(M, &cofactor);
  sd_sph_symmetric B = {{0.0}};
  if (det > 1e-3) {
    const double scale = 1.0 / det;
    for (int k = 0; k < 6; k++) B.a[k] = cofactor.a[k] * scale;
  }
  return B;
}

static void times(const sd_sph_symmetric *M, const double x[3], double y[3])
{
  const double *a = M->a;
  y[0] = a[0] * x[0] + a[3] * x[1] + a[4] * x[2];
  y[1] = a[3] * x[0] + a[1] * x[1] + a[5] * x[2];
  y[2] = a[4] * x[0] + a[5] * x[1] + a[2] * x[2];
}

/* Below 0.9 the support is cut by a free surface: it is 1 in the bulk, disordered or not, and about
 * a half in the first row. */
static const double SURFACE = 0.9;

/* du = - U x with x = 5 R s, R = 2 h the support. s points to where particles are many, in units
 * of 1 / length; R makes it a number, and 5 is where more changes no result (1 to 16 tried).
 * Bounded by the length 1, nobody is moved faster than its neighbours come and go. In two
 * dimensions nobody leaves the plane: beside a body that is 1e-17 off it, z would grow. */
static void order_shift(int dimension, const double *sums, double support, double du[3])
{
  const double s[3] = {sums[10], sums[11], dimension == 2 ? 0.0 : sums[12]};
  const double U = sums[SD_SPH_MAXIMUM];
  const double length = 5.0 * support * sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
  const double scale = -U * 5.0 * support / (length > 1.0 ? length : 1.0);
  for (int d = 0; d < 3; d++) du[d] = scale * s[d];
}

/* With particles that move with v + du and not v, what one particle carries is no longer that of
 * one piece of fluid: D v / D t along the path has (du . grad) v more, and grad v = G B to second
 * order. Returns tr(G B), the divergence; kick = (G B) du. */
static double order_carry(const double *G, const sd_sph_symmetric *B, const double du[3], double kick[3])
{
  double Bdu[3], trace = 0.0;
  times(B, du, Bdu);
  for (int a = 0; a < 3; a++) {
    double row[3];
    times(B, G + 3 * a, row);    // row a of G B, since B is symmetric
    trace += row[a];
    kick[a] = G[3 * a] * Bdu[0] + G[3 * a + 1] * Bdu[1] + G[3 * a + 2] * Bdu[2];
  }
  return trace;
}

/* B of pliant shift, and its rate where it is not 1. */
static void make_pliant(const double *sums, const sd_sph_symmetric *B, int inside, double rho, double *row,
                        double *rate)
{
  static const sd_sph_symmetric UNIT = {{1.0, 1.0, 1.0, 0.0, 0.0, 0.0}};
  static const double rest[3] = {0.0, 0.0, 0.0};
  double unused[3];
  memcpy(row, inside ? B->a : UNIT.a, sizeof(UNIT.a));
  if (inside) *rate = -rho * order_carry(sums + 14, B, rest, unused);
}

double sd_sph_shear_rate(int dimension, const double sums[SD_SPH_GRADIENTS])
{
  const sd_sph_symmetric M = moment(dimension, sums), B = inverse(&M);
  double L[3][3], square = 0.0;
  for (int a = 0; a < 3; a++) times(&B, sums + 6 + 3 * a, L[a]);
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) {
      const double S = 0.5 * (L[a][b] + L[b][a]);
      square += 2.0 * S * S;
    }
  return sqrt(square);
}

/* One particle after the other, each from its own row of sums. What the model does not ask for is
 * not computed; rows of ghosts and of the filler are the caller's. */
int sd_sph_close(const sd_sph_model *model, const sd_sph_particles *p, const sd_sph_closing *c)
{
  const sd_sph_level level = sd_sph_level_of(model);
  const int from = sd_sph_sum_columns(level);
  int stops = -1;
  for (int i = 0; i < c->n; i++) {
    const double *sums = c->sums + (size_t) from * i;
    c->rate[i] = sums[0];
    if (level == SD_SPH_RATE) continue;

    const sd_sph_symmetric M = moment(model->dimension, sums + 4), B = inverse(&M);
    double *row = c->slope + 4 * (size_t) i;
    /* exact for a linear density: sum V_b (rho_b - rho_a) g d = M grad rho then */
    times(&B, sums + 1, row);
    row[3] = p->v4[4 * (size_t) i + 3];
    if (level == SD_SPH_GRADIENT) continue;

    double *du = c->du + 4 * (size_t) i, *matrix = c->B ? c->B + 8 * (size_t) i : NULL;
    const int flows = (c->mask[i] & c->moving) && !(p->phase && p->phase[i] < 0);
    memset(du, 0, 4 * sizeof(double));
    /* what is corrected, and where its surface is, goes by all fluids */
    const sd_sph_symmetric whole = level == SD_SPH_MIXTURE ? moment(model->dimension, sums + 24) : M;
    const int inside = flows && sd_sph_above(&whole, SURFACE);
    if (c->full && flows && stops < 0 && !sd_sph_above(&whole, c->least)) stops = i;
    du[3] = c->whole > 0.0 && inside && sd_sph_above(&whole, c->whole);
    if (inside || (flows && c->full))
      order_shift(model->dimension, sums, sd_sph_of_pair(model, p, i, i)->support, du);
    if (level >= SD_SPH_VELOCITY) {
      memset(matrix, 0, 8 * sizeof(double));
      memset(c->kick + 3 * (size_t) i, 0, 3 * sizeof(double));
      matrix[6] = !flows;
    }
    if (model->scheme == SD_SPH_SHIFT_PLIANT)
      make_pliant(sums, &B, inside, row[3], matrix, &c->rate[i]);
    else if (level >= SD_SPH_VELOCITY) {
      if (!flows) continue;
      const sd_sph_symmetric all = level == SD_SPH_MIXTURE ? inverse(&whole) : B;
      memcpy(matrix, all.a, sizeof(all.a));
      c->rate[i] = -row[3] * order_carry(sums + 14, &all, du, c->kick + 3 * (size_t) i);
    }
    /* the density that the particle finds where it is moved to */
    c->rate[i] += du[0] * row[0] + du[1] * row[1] + du[2] * row[2];
  }
  return stops;
}
