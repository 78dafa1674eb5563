#include "sd_squirmer.h"

#include <math.h>

#include "sd_constants.h"
#include "sd_linear.h"

/* The parts of the slip at x = r/a, each of strength 1 */
typedef struct {
  double uniform[3], source[3], tangential[3], strain[3], twist[3];
} parts;

static parts parts_at(const sd_multiblob *m, const double e[3], const double x[3])
{
  const double square = sd_dot(x, x), along = sd_dot(e, x), inverse = 1.0 / sqrt(square);
  const double c = along * inverse, faxen = (m->point * m->point - 1.0) / 6.0;
  double across[3];
  parts p;
  sd_cross(e, x, across);
  for (int d = 0; d < 3; d++) {
    p.uniform[d] = e[d];
    p.source[d] = 0.1 * (2.0 * square * e[d] - along * x[d]) + faxen * e[d];
    p.tangential[d] = -c * (e[d] - c * x[d] * inverse);
    p.strain[d] = along * e[d] - x[d] / 3.0;
    p.twist[d] = c * across[d] * inverse;
  }
  return p;
}

/* What the lone shell answers to a slip v: forces M^-1 v, of which f.e, e.(r f).e and (e.r)(e.(r x f))
 * are added up. In a direction e these are all that the symmetry of the icosahedron allows. */
typedef struct {
  double force, moment, twist;
} answer;

static answer answer_of(const sd_multiblob *m, const sd_body_shape *lone, const double e[3],
                        const double *v)
{
  double forces[3 * SD_MULTIBLOB_MOST] = {0.0};
  answer sum = {0.0, 0.0, 0.0};
  sd_body_shape_answer(lone, v, forces);
  for (int k = 0; k < m->n; k++) {
    const double *r = m->r + 3 * k, *f = forces + 3 * k;
    double turning[3];
    sd_cross(r, f, turning);
    sum.force += sd_dot(e, f);
    sum.moment += sd_dot(e, r) * sd_dot(e, f) - sd_dot(r, f) / 3.0;
    sum.twist += sd_dot(e, r) * sd_dot(e, turning);
  }
  return sum;
}

void sd_squirmer_create(const sd_multiblob *m, const sd_body_shape *lone, sd_squirmer *out)
{
  const double e[3] = {0.0, 0.0, 1.0}; /* any */
  double v[4][3 * SD_MULTIBLOB_MOST];
  answer a[4];
  for (int k = 0; k < m->n; k++) {
    const parts p = parts_at(m, e, m->r + 3 * k);
    for (int d = 0; d < 3; d++) {
      v[0][3 * k + d] = p.source[d];
      v[1][3 * k + d] = p.tangential[d];
      v[2][3 * k + d] = p.strain[d];
      v[3][3 * k + d] = p.twist[d];
    }
  }
  for (int b = 0; b < 4; b++) a[b] = answer_of(m, lone, e, v[b]);
  /* the lone shell's drag is 6 pi exactly; e.(e e - 1/3).e = 2/3 */
  out->uniform = a[0].force / (6.0 * SD_PI);
  out->tangential = m->n >= 42 ? 1.0 : 0.0;
  out->strain = (-8.0 / 3.0 * SD_PI - out->tangential * a[1].moment) / a[2].moment;
  out->twist = 8.0 / 3.0 * SD_PI / a[3].twist;
}

void sd_squirmer_slip(const sd_multiblob *m, const sd_squirmer *s, const sd_squirmer_stroke *stroke,
                      double a, const double *r, double *u)
{
  const double uniform = stroke->B1 * (10.0 * s->uniform - 2.0 / 3.0), source = -10.0 * stroke->B1;
  const double tangential = stroke->B2 * s->tangential, strain = stroke->B2 * s->strain;
  const double twist = stroke->beta * s->twist;
  for (int k = 0; k < m->n; k++) {
    double x[3];
    for (int d = 0; d < 3; d++) x[d] = r[3 * k + d] / a;
    if (sd_dot(x, x) == 0.0) continue; /* a point that is left out */
    const parts p = parts_at(m, stroke->e, x);
    for (int d = 0; d < 3; d++)
      u[3 * k + d] -= uniform * p.uniform[d] + source * p.source[d] + tangential * p.tangential[d] +
          strain * p.strain[d] + twist * p.twist[d];
  }
}
