#include "sd_faces.h"

#include <string.h>

#include "sd_linear.h"

enum { WIDTH = SD_FACES_WIDTH };

/* xx yy zz xy xz yz of the symmetric R S R^T; T: of R^T S R. The moments of d.e d have twice the sum
 * beside the diagonal: weight 2 of them, 1 of e. */
static void turn_symmetric(const double R[9], double weight, const double s[6], double out[6])
{
  static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
  const double u = 1.0 / weight,
               S[9] = {s[0],     u * s[3], u * s[4], u * s[3], s[1],
                       u * s[5], u * s[4], u * s[5], s[2]};
  double RS[9];
  sd_product3(R, S, RS);
  for (int e = 0; e < 6; e++)
    out[e] = (e < 3 ? 1.0 : weight) * sd_dot(RS + 3 * row[e], R + 3 * column[e]);
}

/* (vector, symmetric) of a sphere from one set of axes to another */
static void turn_all(const double R[9], double weight, double v[WIDTH])
{
  double turned[WIDTH];
  sd_multiply3(R, v, turned);
  turn_symmetric(R, weight, v + 3, turned + 3);
  memcpy(v, turned, sizeof turned);
}

static int has_faces(const sd_faces *faces, int i)
{
  return !faces->whole || faces->whole[i];
}

static const sd_faces_pattern *pattern_of(const sd_faces *faces, long i)
{
  return faces->kind ? faces->pattern + faces->kind[i] : faces->pattern;
}

static long rows_of(const sd_faces *faces, long i)
{
  return 3 * (faces->first ? faces->first[i] : faces->pattern->n * i);
}

/* Rows of sphere i in the axes of its points: u itself, or in `scratch` */
static const double *in_own_axes(const sd_faces *faces, long i, const double *u, double *scratch)
{
  const double *rows = u + rows_of(faces, i);
  if (!faces->turn) return rows;
  for (int k = 0; k < pattern_of(faces, i)->n; k++)
    sd_multiply3t(faces->turn + 9 * i, rows + 3 * k, scratch + 3 * k);
  return scratch;
}

void sd_faces_read(const sd_faces *faces, int spheres, const double *u, double *v)
{
  double scratch[3 * SD_FACES_MOST];
  memset(v, 0, sizeof(double) * WIDTH * (size_t) spheres);
  for (int i = 0; i < spheres; i++) {
    if (!has_faces(faces, i)) continue;
    const sd_faces_pattern *of = pattern_of(faces, i);
    const double *own = in_own_axes(faces, i, u, scratch);
    const int N = 3 * of->n;
    double *to = v + WIDTH * (long) i, sum[WIDTH] = {0.0};
    for (int j = 0; j < N; j++) /* nine sums, none of which waits for the others */
      for (int e = 0; e < WIDTH; e++) sum[e] += of->G[(long) e * N + j] * own[j];
    memcpy(to, sum, sizeof sum);
    if (faces->turn) turn_all(faces->turn + 9 * (long) i, 1.0, to);
  }
}

void sd_faces_push(const sd_faces *faces, int spheres, const double *f, double *l)
{
  for (int i = 0; i < spheres; i++) {
    if (!has_faces(faces, i)) continue;
    const sd_faces_pattern *of = pattern_of(faces, i);
    const int N = 3 * of->n;
    double own[WIDTH], pushed[3 * SD_FACES_MOST], *to = l + rows_of(faces, i);
    memcpy(own, f + WIDTH * (long) i, sizeof own);
    const double *R = faces->turn ? faces->turn + 9 * (long) i : NULL;
    if (R) {
      const double back[9] = {R[0], R[3], R[6], R[1], R[4], R[7], R[2], R[5], R[8]};
      turn_all(back, 2.0, own);
    }
    for (int j = 0; j < N; j++) {
      double sum = 0.0;
      for (int e = 0; e < WIDTH; e++) sum += of->G[(long) e * N + j] * own[e];
      pushed[j] = sum;
    }
    for (int k = 0; k < of->n; k++) {
      double turned[3];
      if (R)
        sd_multiply3(R, pushed + 3 * k, turned);
      else
        memcpy(turned, pushed + 3 * k, sizeof turned);
      for (int d = 0; d < 3; d++) to[3 * k + d] += turned[d];
    }
  }
}
