/* Spheres, free or in rigid clumps, as shells of points for the loop of sd_bodies.h: open or in a
 * periodic cube or above a wall, with films or without. */
#ifndef BLOB_FLOCK_H
#define BLOB_FLOCK_H

#include "blobs.h"

#include "sd_bodies.h"
#include "sd_multiblob_shape.h"
#include "sd_multiblob_wall.h"
#include "sd_tie.h"

enum { MOST = 40, POINTS = 42 * MOST };

/* Spheres, free or members of clumps of one shape, which come first */
typedef struct {
  blobs *s;
  int clumps, m;
  sd_shape clump;
  sd_multiblob_shape lone, shape;
  sd_packed packed;
  periodic p;
  sd_tie tie;
  sd_multiblob_additions own_ones;
  sd_faces_pattern pattern;
  sd_faces faces;
  /* of an open scene; sign 0: none */
  sd_wall wall;
  char whole_shell[MOST];
  sd_body body[MOST];
  int whole[MOST], sphere[POINTS], row[POINTS];
  double arm[3 * MOST], D[3 * POINTS], w[POINTS], pose[9 * MOST], centre[3 * MOST];
  double V[6 * MOST], v[6 * MOST], exerted[6 * MOST], before[6 * MOST], l[3 * POINTS],
      u[3 * POINTS];
  sd_bodies_report report;
} blob_flock;

static inline sd_status all_pairs(void *ctx, const double *f, double *u)
{
  sd_packed_share(ctx, 0, 1, f, u);
  return SD_OK;
}

/* All free, at x */
static inline blob_flock *free_spheres(int points, int n, const double *x, const double *a)
{
  blob_flock *f = calloc(1, sizeof(blob_flock));
  f->s = blobs_create(points, 1, n, x, a);
  assert_int_equal(sd_multiblob_shape_create(&f->s->m, NULL, NULL, &f->lone), SD_OK);
  return f;
}

static inline void blob_flock_free(blob_flock *f)
{
  sd_multiblob_shape_free(&f->lone);
  sd_multiblob_shape_free(&f->shape);
  sd_packed_free(&f->packed);
  if (f->s->side > 0.0) periodic_free(&f->p);
  sd_tie_free(&f->tie);
  if (f->m) sd_shape_free(&f->clump);
  blobs_free(f->s);
  free(f);
}

/* Clumps of m unit spheres at X with poses R, centre [3]; free spheres none */
static inline blob_flock *clumps_at(int points, int clumps, int m, const double *X, const double *R,
                        const double *centre)
{
  static const double ones[8] = {1, 1, 1, 1, 1, 1, 1, 1};
  double x[3 * MOST], a[MOST];
  blob_flock *f = calloc(1, sizeof(blob_flock));
  assert_int_equal(sd_shape_create(m, X, ones, &f->clump), SD_OK);
  for (int i = 0; i < clumps * m; i++) {
    a[i] = 1.0;
    sd_multiply3(R + 9 * (i / m), f->clump.x + 3 * (i % m), x + 3 * i);
    for (int d = 0; d < 3; d++) x[3 * i + d] += centre[3 * (i / m) + d];
  }
  f->s = blobs_create(points, 1, clumps * m, x, a);
  f->clumps = clumps, f->m = m;
  memcpy(f->pose, R, sizeof(double) * 9 * (size_t) clumps);
  memcpy(f->centre, centre, sizeof(double) * 3 * (size_t) clumps);
  assert_int_equal(sd_multiblob_shape_create(&f->s->m, &f->clump, NULL, &f->shape), SD_OK);
  assert_int_equal(sd_multiblob_shape_create(&f->s->m, NULL, NULL, &f->lone), SD_OK);
  for (int i = 0; i < clumps * m; i++) {
    f->s->mask[i] = f->shape.mask[i % m];
    f->s->body[i] = 1 + i / m;
    double pose[9];
    sd_multiblob_shape_stand(&f->shape, R + 9 * (i / m), pose, f->s->turn + 9 * i);
    memcpy(f->pose + 9 * (i / m), pose, sizeof pose);
  }
  return f;
}

/* The bodies for the core; tolerance: of the engine in a cube */
static inline sd_bodies place(blob_flock *f, double side, double tolerance)
{
  blobs *s = f->s;
  const sd_law law = {.tensor = SD_TENSOR_RPY, .wall = f->wall};
  const int own = s->m.n, points = own * s->n;
  for (int k = 0; k < 3 * s->n && side > 0.0; k++) s->x[k] -= side * floor(s->x[k] / side);
  if (!s->r) blobs_expand(s);
  f->own_ones = (sd_multiblob_additions){
      .model = &s->m, .spheres = {s->x, s->a, s->turn, s->mask, s->n}, .w = s->w, .r = s->r};
  for (int k = 0; k < points; k++) f->w[k] = 1.0;
  if (side > 0.0) {
    sd_ewald split;
    const sd_ewald_box box = {.periodic = 1, .edge = {side, side, side}};
    const sd_ewald_sizes sizes = periodic_sizes(s->b, points);
    assert_int_equal(sd_ewald_choose(&box, &sizes, 3, tolerance, &split), SD_OK);
    periodic_place(&f->p, s->at, s->b, NULL, points, 3, &split);
    s->side = side;
  } else {
    const sd_spheres spheres = {s->at, s->b, f->w};
    assert_int_equal(sd_packed_all(&f->packed, SD_ISA_BEST, &law, &spheres, points, 3), SD_OK);
  }
  int bodies = 0;
  for (int i = 0; i < s->n; i += f->m ? f->m : 1, bodies++) {
    const sd_multiblob_shape *shape = f->m ? &f->shape : &f->lone;
    f->body[bodies] = (sd_body){
        &shape->points, {1, 0, 0, 0, 1, 0, 0, 0, 1}, f->m ? 1.0 : s->a[i], 1.0, f->row + own * i};
    if (f->m) memcpy(f->body[bodies].R, f->pose + 9 * bodies, 9 * sizeof(double));
    for (int k = 0; k < shape->points.m; k++) f->row[own * i + k] = own * i + shape->row[k];
    for (int k = i; k < i + shape->spheres; k++) {
      f->whole[k] = bodies;
      for (int d = 0; d < 3 && f->m; d++) { /* though the sphere may be across a face of the cube */
        double *arm = f->arm + 3 * k + d;
        *arm = s->x[3 * k + d] - f->centre[3 * bodies + d];
        if (side > 0.0) *arm -= side * rint(*arm / side);
      }
    }
  }
  for (int k = 0; k < points; k++) {
    f->sphere[k] = k / own;
    for (int d = 0; d < 3; d++) f->D[3 * k + d] = s->b[k] > 0.0 ? 6.0 * SD_PI * s->b[k] : 1.0;
  }
  for (int i = 0; i < s->n; i++) f->whole_shell[i] = (char) sd_multiblob_mask_is_whole(s->mask + i);
  f->pattern = (sd_faces_pattern){own, f->lone.faces};
  f->faces = (sd_faces){&f->pattern, s->turn, f->whole_shell, NULL, NULL};
  return (sd_bodies){.shaped = bodies,
                     .body = f->body,
                     .spheres = {s->n, 6, f->whole, f->arm},
                     .points = {points, 3, f->sphere, s->r},
                     .faces = &f->faces,
                     .D = f->D,
                     .apply = side > 0.0 ? sd_mobility_apply : all_pairs,
                     .apply_ctx = side > 0.0 ? (void *) &f->p.omega : &f->packed,
                     .add = sd_multiblob_add,
                     .add_ctx = &f->own_ones};
}

static inline void tie_with_films(blob_flock *f, sd_bodies *A)
{
  blobs *s = f->s;
  s->R = calloc((size_t) s->size * (size_t) s->size, sizeof(double));
  blobs_add_films(s, 1.0, NULL);
  for (int i = 0; i < s->n && f->wall.sign != 0; i++) {
    double B[36], E[6];
    const sd_multiblob_sphere sphere = {&s->m, s->x + 3 * i, s->a[i], s->r + 3 * s->m.n * i,
                                        s->m.delta != 0.0};
    assert_int_equal(sd_multiblob_wall_film(&sphere, &f->wall, s->floor, 1.0, NULL, B, E), SD_OK);
    sd_lubrication_add_own(&s->L, i, B, E);
  }
  f->tie.L = &s->L;
  A->tie = &f->tie;
}

static inline sd_status move(blob_flock *f, const sd_bodies *A, const double *F, int warm,
                             double tolerance)
{
  const sd_bodies_problem problem = {f->u, F, NULL, warm, tolerance, 200};
  const sd_bodies_answer answer = {f->l, f->before, f->V, f->v, f->exerted};
  double *work = malloc(sizeof(double) * (size_t) sd_bodies_work(A));
  for (long j = 0; j < sd_bodies_work(A); j++) work[j] = NAN; /* nobody may read it */
  const sd_status status = sd_bodies_solve(A, &problem, &answer, work, &f->report);
  free(work);
  return status;
}

#endif
