#include "sd_multiblob_shape.h"

#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_linear.h"

/* M [(3 count)^2] += the addition of each sphere that has it, and so all of its points, one after the
 * other; row [count]: which points these are, in ascending order, r [3 all] from the centres of their
 * spheres */
static void add_one_body(const sd_multiblob *m, const sd_multiblob_spheres *s, const double *r,
                         const int *row, int count, double *M)
{
  const size_t N = 3 * (size_t) count;
  int p = 0;
  for (long i = 0; i < s->n; i++) {
    const sd_multiblob *of = sd_multiblob_of(m, s, i);
    const long first = sd_multiblob_first(m, s, i);
    while (p < count && row[p] < first) p++;
    if (of->delta != 0.0 && sd_multiblob_is_whole(s, i))
      sd_multiblob_one_body_matrix(of, s->a[i], r + 3 * first, N, M + 3 * (size_t) p * (N + 1));
  }
}

static size_t points_of(const sd_multiblob *m, const sd_multiblob_spheres *s)
{
  return (size_t) sd_multiblob_first(m, s, s->n);
}

/* A shell of so many points has its inverse in blocks: 4 MB in place of 30, and an eighth of the time. With
 * fewer both are small, and noise has use for the root of all of it. */
enum { MIRRORED = 642 };

/* Of all points r, x and b of the body those that are there, and in row [all], become the shape. wall NULL: there
 * is none. mirrors: it is a lone shell in open space */
static sd_status make_shape(const sd_multiblob *m, const sd_wall *wall, int mirrors, const sd_multiblob_spheres *s,
                            const double centre[3], int *row, sd_body_shape *out)
{
  const size_t all = points_of(m, s);
  double *r = malloc(sizeof(double) * 7 * all);
  if (!r) return SD_ENOMEMORY;
  double *x = r + 3 * all, *b = x + 3 * all, axes[9];
  int count = 0;
  sd_multiblob_expand(m, s, r, x, b);
  for (size_t k = 0; k < all; k++) {
    if (!(b[k] > 0.0)) continue;
    memmove(x + 3 * count, x + 3 * k, 3 * sizeof(double));
    b[count] = b[k];
    row[count++] = (int) k;
  }
  double *M = malloc(sizeof(double) * 9 * (size_t) count * (size_t) count);
  sd_status status = M ? SD_OK : SD_ENOMEMORY;
  if (status == SD_OK) {
    sd_wall_matrix(wall, count, 3, x, b, M);
    add_one_body(m, s, r, row, count, M);
    for (int k = 0; k < 3 * count; k++) x[k] -= centre[k % 3];
    sd_multiblob_axes(axes);
    status = mirrors && count >= MIRRORED ? sd_body_shape_mirrored(count, x, b, axes, M, out)
                                          : sd_body_shape_of(count, 3, x, b, M, out);
  }
  free(M);
  free(r);
  return status;
}

/* A right-handed frame that only its first axis says; generic, so that nothing special happens to a
 * line along an axis of space or between two */
static void along_line(const double u[3], double E[9])
{
  const double some[3] = {0.52, -0.31, 0.79};
  double v[3], w[3];
  sd_cross(u, some, v);
  if (sd_dot(v, v) < 1e-12) sd_across(u, v);
  sd_normalize(v);
  sd_cross(u, v, w);
  for (int d = 0; d < 3; d++) {
    E[3 * d] = u[d];
    E[3 * d + 1] = v[d];
    E[3 * d + 2] = w[d];
  }
}

/* turn of a shell whose mirrors are across the columns of E. There are two such turns, a quarter turn apart. With
 * this one a chain of five that moves along a wall, a tenth of a radius from it, is off by 0.3 % with 12 points,
 * with the other by 3.4 %; two clumps that are pushed apart by 1.4 % at most (3.2 %). */
static void by_mirrors(const double E[9], double turn[9])
{
  double A[9], back[9];
  sd_multiblob_axes(A);
  for (int d = 0; d < 3; d++) {
    back[d] = -A[3 * d + 1];
    back[3 + d] = A[3 * d];
    back[6 + d] = A[3 * d + 2];
  }
  sd_product3(E, back, turn);
}

void sd_multiblob_shape_stand(const sd_multiblob_shape *s, const double R[9], double pose[9],
                              double turn[9])
{
  const double unity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, *T = s->turn;
  if (s->rank == 2) {
    memcpy(pose, R, 9 * sizeof(double));
    sd_product3(R, T, turn);
    return;
  }
  memcpy(turn, unity, sizeof unity);
  if (s->rank == 1) {
    double u[3], E[9];
    sd_multiply3(R, s->line, u);
    sd_normalize(u);
    along_line(u, E);
    by_mirrors(E, turn);
  }
  const double back[9] = {T[0], T[3], T[6], T[1], T[4], T[7], T[2], T[5], T[8]};
  sd_product3(turn, back, pose);
}

/* By the symmetry of the icosahedron uniform motions, rotations and strains of the lone sphere do not
 * know each other: R of them is 6 pi and, of strains, that of the lone shell. */
static sd_status find_faces(const sd_multiblob *m, sd_multiblob_shape *s)
{
  const int N = 3 * m->n;
  double stresslet = 0.0;
  s->faces = calloc(SD_FACES_WIDTH * (size_t) N, sizeof(double));
  if (!s->faces) return SD_ENOMEMORY;
  double *force = malloc(sizeof(double) * 2 * (size_t) N), *unit = force + N;
  if (!force) return SD_ENOMEMORY;
  memset(unit, 0, sizeof(double) * (size_t) N);
  for (int j = 0; j < N; j++) { /* force: of the points, for a unit velocity of one */
    memset(force, 0, sizeof(double) * (size_t) N);
    unit[j] = 1.0;
    sd_body_shape_answer(&s->points, unit, force);
    unit[j] = 0.0;
    for (int k = 0; k < m->n; k++) {
      const double *f = force + 3 * k;
      double moment[6] = {0.0};
      sd_add_deviator(1.0, m->r + 3 * k, f, moment);
      for (int d = 0; d < 3; d++) s->faces[d * N + j] += f[d] / (6.0 * SD_PI);
      for (int e = 0; e < 6; e++) s->faces[(3 + e) * N + j] += moment[e];
    }
  }
  free(force);
  /* of the strain xy + yx, whose moment is in row xy */
  for (int j = 0; j < N; j++)
    stresslet += s->faces[6 * N + j] * (j % 3 == 2 ? 0.0 : m->r[3 * (j / 3) + 1 - j % 3]);
  for (int j = 3 * N; j < SD_FACES_WIDTH * N; j++) s->faces[j] /= stresslet;
  return SD_OK;
}

/* How the shells of a clump stand in its own axes. The mirrors of its icosahedra are the planes across its
 * main axes, or across the line: then a clump that half a turn or one of these mirrors maps onto itself has
 * points that they map onto points. Else its frame says which of its images counts, by the order of the
 * spheres. */
static void take_frame(const sd_shape *clump, sd_multiblob_shape *out)
{
  const double unity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  double E[9];
  out->rank = clump ? clump->rank : 0;
  memcpy(out->turn, unity, sizeof unity);
  if (out->rank == 0) return;
  for (int d = 0; d < 3; d++) out->line[d] = clump->frame[3 * d];
  if (out->rank == 1)
    along_line(out->line, E);
  else if (!sd_shape_main_axes(clump, E))
    memcpy(E, clump->frame, sizeof E);
  by_mirrors(E, out->turn);
}

/* mask and first, and the shape of the spheres s, whose turn [9 spheres] and kinds stand */
static sd_status fill_shape(const sd_multiblob *m, const sd_shape *clump,
                            const sd_multiblob_spheres *s, sd_multiblob_shape *out)
{
  const double origin[3] = {0.0};
  if (clump)
    sd_multiblob_masks(m, s->kind, clump, out->turn, out->mask);
  else
    out->mask[0] = sd_multiblob_whole(m);
  out->row = malloc(sizeof(int) * points_of(m, s));
  sd_status status = out->row ? make_shape(m, NULL, !clump, s, origin, out->row, &out->points) : SD_ENOMEMORY;
  out->points.turns = out->rank == 2 ? SD_BODY_ALONG : out->rank == 1 ? SD_BODY_OTHERWISE : SD_BODY_STILL;
  return status == SD_OK && !clump ? find_faces(m, out) : status;
}

sd_status sd_multiblob_shape_create(const sd_multiblob *m, const sd_shape *clump, const int *kind,
                                    sd_multiblob_shape *out)
{
  const double origin[3] = {0.0}, one = 1.0;
  const size_t n = clump ? (size_t) clump->n : 1;
  *out = (sd_multiblob_shape){.spheres = (int) n};
  take_frame(clump, out);
  out->mask = malloc(n * sizeof *out->mask);
  out->first = malloc((n + 1) * sizeof *out->first);
  double *turn = malloc(n * sizeof out->turn);
  sd_status status = out->mask && out->first && turn ? SD_OK : SD_ENOMEMORY;
  if (status == SD_OK) {
    out->first[0] = 0;
    for (size_t i = 0; i < n; i++) {
      memcpy(turn + 9 * i, out->turn, sizeof out->turn);
      out->first[i + 1] = out->first[i] + m[kind ? kind[i] : 0].n;
    }
    const sd_multiblob_spheres s = {clump ? clump->x : origin, clump ? clump->a : &one, turn,
                                    out->mask, (int) n, kind, out->first};
    status = fill_shape(m, clump, &s, out);
  }
  free(turn);
  if (status != SD_OK) sd_multiblob_shape_free(out);
  return status;
}

sd_status sd_multiblob_wall_shape(const sd_multiblob *m, const sd_wall *wall,
                                  const sd_multiblob_spheres *s, const double centre[3],
                                  sd_body_shape *out)
{
  int *row = malloc(sizeof(int) * points_of(m, s));
  *out = (sd_body_shape){0};
  const sd_status status = row ? make_shape(m, wall, 0, s, centre, row, out) : SD_ENOMEMORY;
  free(row);
  return status;
}

void sd_multiblob_shape_free(sd_multiblob_shape *s)
{
  free(s->faces);
  free(s->mask);
  free(s->row);
  free(s->first);
  sd_body_shape_free(&s->points);
  *s = (sd_multiblob_shape){0};
}
