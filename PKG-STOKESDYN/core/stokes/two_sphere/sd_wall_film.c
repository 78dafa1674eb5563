#include "sd_wall_film.h"

#include <math.h>

#include "sd_constants.h"
#include "sd_film_table_internal.h"
#include "sd_linear.h"

enum { NORMAL, PARALLEL, COUPLING, ROLL, SPIN, FLOW_FORCE, FLOW_TORQUE, SCALARS };
enum { DEGREE = 9 };

/* The remainder of sd_wall_film.h */
typedef struct {
  double A, B, c1, c2, p[DEGREE + 1];
} remainder_fit;

/* Least squares over exact - model at gaps from 1e-6 to 100 radii. */
static const remainder_fit fits[SCALARS] = {
    {1.0,
     1.0 / 5.0,
     0.81469757788629,
     0.73953445407352,
     {-0.47265660236882, -1.567656673616, 1.6334583515127, 0.23575881333328, 0.10722984269488,
      1.865340841641, -5.1000804153054, 8.608716963617, -8.2006781687251, 2.8619618068711}},
    {0.0,
     8.0 / 15.0,
     2.2943152218614,
     4.9003688241542,
     {0.17580042842668, -7.5316937322368, 8.2366881396029, -1.7645903272682, 1.8043773460398,
      -6.9975545287047, 13.411803595085, -15.690988583413, 9.9926808867722, -2.7528137597574}},
    {0.0,
     -1.0 / 10.0,
     -0.56748273876963,
     -1.3273024427553,
     {-1.198332196084e-05, 2.0835687595416, -2.1963741613384, 0.55417191195013, -1.1439090923726,
      4.2764707436129, -8.375470811143, 9.811973196666, -6.2540377747271, 1.718923198497}},
    {0.0,
     2.0 / 5.0,
     2.1168472844833,
     5.322800406766,
     {2.2040858619121e-05, -7.8412885506108, 8.9399714677386, -1.9683980740446, 1.9828071402081,
      -7.8075041952273, 15.101072659502, -17.723645131224, 11.283743170636, -3.1017659287086}},
    {0.0,
     0.0,
     -0.49573326172356,
     -2.2287659514322,
     {-7.3204643338265e-06, 2.7250418025183, -3.6037491707397, 0.7951749903662, -0.603705629292,
      2.5244843995253, -4.7927738634573, 5.5586931669178, -3.4879462477995, 0.94398622923365}},
    /* these two with the factors s^3 and s^4, and six coefficients */
    {0.0,
     0.0,
     -0.031598602092463,
     -0.69222110093153,
     {-0.3125, 0.72349518153407, -0.69975686226542, 0.054961404203224, -0.028885265868221,
      0.081183158944422}},
    {0.0,
     0.0,
     0.012590423859206,
     0.3524349347726,
     {-0.15625, -0.27724398686953, 0.71167009122382, -0.32184078078698, 0.076229362482826,
      -0.031233017337733}}};

/* rest = 1 - s and l = -ln(1 - s) come from the gap: 1 - s would lose their digits near contact */
static double remainder_at(const remainder_fit *c, double s, double rest, double l)
{
  double sum = 0.0;
  for (int m = DEGREE; m >= 0; m--) sum = sum * s + c->p[m];
  return c->A / rest + l * (c->B + rest * (c->c1 + rest * c->c2)) + sum;
}

/* D [SCALARS]: exact less model, over Stokes drags */
static void beyond_model(double gap, double D[SCALARS])
{
  const double s = 1.0 / (1.0 + gap), rest = gap * s, l = log1p(1.0 / gap);
  const double s3 = s * s * s, s4 = s3 * s;
  for (int k = 0; k < SCALARS; k++)
    D[k] = (k == FLOW_FORCE ? s3 : s4) * remainder_at(&fits[k], s, rest, l);
}

/* D += the model's, the inverse of its mobility above the wall. In shear it rests in the velocity h
 * and the angular velocity 1/2 of the fluid. */
static void add_model(double gap, double D[SCALARS])
{
  const double s = 1.0 / (1.0 + gap), s3 = s * s * s, s5 = s3 * s * s;
  const double p = 1.0 - 9.0 / 16.0 * s + s3 / 8.0 - s5 / 16.0, q = 3.0 / 32.0 * s3 * s,
               r = 0.75 * (1.0 - 5.0 / 16.0 * s3), det = p * r - q * q;
  const double parallel = r / det, coupling = -0.75 * q / det, roll = 0.75 * p / det;
  D[NORMAL] += 1.0 / (1.0 - 9.0 / 8.0 * s + s3 / 2.0 - s5 / 8.0);
  D[PARALLEL] += parallel;
  D[COUPLING] += coupling;
  D[ROLL] += roll;
  D[SPIN] += 1.0 / (1.0 - s3 / 8.0);
  D[FLOW_FORCE] += parallel + 2.0 / 3.0 * s * coupling;
  D[FLOW_TORQUE] += coupling + 0.5 * s * roll;
}

static sd_wall_film with_units(double a, const double D[SCALARS])
{
  const double force = 6.0 * SD_PI * a, torque = 8.0 * SD_PI * a * a;
  return (sd_wall_film){.normal = force * D[NORMAL],
                        .parallel = force * D[PARALLEL],
                        .coupling = torque * D[COUPLING],
                        .roll = torque * a * D[ROLL],
                        .spin = torque * a * D[SPIN],
                        .flow_force = force * D[FLOW_FORCE],
                        .flow_torque = torque * D[FLOW_TORQUE]};
}

sd_wall_film sd_wall_film_at(double a, double height, double floor)
{
  double D[SCALARS];
  beyond_model(fmax(height / a - 1.0, floor), D);
  /* (parallel, coupling; coupling, roll), all over 6 pi a with lengths in a */
  D[COUPLING] *= 4.0 / 3.0;
  D[ROLL] *= 4.0 / 3.0;
  sd_film_clip(&D[PARALLEL], &D[COUPLING], &D[ROLL]);
  D[COUPLING] *= 0.75;
  D[ROLL] *= 0.75;
  D[NORMAL] = fmax(D[NORMAL], 0.0);
  D[SPIN] = fmax(D[SPIN], 0.0);
  return with_units(a, D);
}

sd_wall_film sd_wall_film_exact(double a, double height, double floor)
{
  const double gap = fmax(height / a - 1.0, floor);
  double D[SCALARS];
  beyond_model(gap, D);
  add_model(gap, D);
  return with_units(a, D);
}

void sd_wall_film_matrix(const sd_wall_film *film, const double e[3], double eta, double B[36])
{
  const double across = eta * film->parallel, along = eta * (film->normal - film->parallel);
  const double roll = eta * film->roll, spin = eta * (film->spin - film->roll);
  const double c = eta * film->coupling;
  const double turn[9] = {0.0, -e[2], e[1], e[2], 0.0, -e[0], -e[1], e[0], 0.0}; /* e x */
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      const double ee = e[p] * e[q], same = p == q;
      B[6 * p + q] = across * same + along * ee;
      B[6 * p + q + 3] = -c * turn[3 * p + q];
      B[6 * (p + 3) + q] = c * turn[3 * p + q];
      B[6 * (p + 3) + q + 3] = roll * same + spin * ee;
    }
}

void sd_wall_film_flow(const sd_wall_film *film, const double e[3], double eta, const double u[3],
                       double E[6])
{
  const double normal = sd_dot(e, u);
  double turned[3];
  sd_cross(e, u, turned);
  for (int d = 0; d < 3; d++) {
    E[d] = eta * film->flow_force * (u[d] - normal * e[d]);
    E[3 + d] = eta * film->flow_torque * turned[d];
  }
}
