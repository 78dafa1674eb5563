/* Small scenes for the core tests: spheres, the operator of all pairs on one rank, total drag. */
#ifndef SCENE_H
#define SCENE_H

#include "check.h"

#include "plain.h"

#include "sd_neighbor.h"
#include "sd_product.h"
#include "sd_solve.h"

typedef struct {
  int n;
  double *x, *a, *w, *drag;
  sd_tensor kind;
  double cutoff; /* INFINITY: all pairs; else by list */
  sd_neighbors list;
  int products;
  int fast; /* all pairs by the packed product; set it when the spheres stand where they are */
  sd_packed packed;
  sd_precondition *precondition; /* for scene_solve */
  void *precondition_ctx;
} scene;

static inline scene scene_create(int n)
{
  scene s = {.n = n, .kind = SD_TENSOR_RPY, .cutoff = INFINITY};
  s.x = calloc(3 * (size_t) n, sizeof(double));
  s.a = calloc(n, sizeof(double));
  s.w = calloc(n, sizeof(double));
  s.drag = calloc(n, sizeof(double));
  return s;
}

static inline void scene_free(scene *s)
{
  free(s->x);
  free(s->a);
  free(s->w);
  free(s->drag);
  sd_neighbors_free(&s->list);
  sd_packed_free(&s->packed);
}

static inline void scene_set(scene *s, int i, double x, double y, double z, double a, double eta)
{
  s->x[3 * i] = x;
  s->x[3 * i + 1] = y;
  s->x[3 * i + 2] = z;
  s->a[i] = a;
  s->w[i] = 1.0 / sqrt(eta);
  s->drag[i] = 6.0 * SD_PI * eta * a;
}

/* nx x ny x nz spheres, spacing s (in radii) */
static inline scene scene_lattice(int nx, int ny, int nz, double spacing, double a, double eta)
{
  scene s = scene_create(nx * ny * nz);
  int i = 0;
  for (int z = 0; z < nz; z++)
    for (int y = 0; y < ny; y++)
      for (int x = 0; x < nx; x++)
        scene_set(&s, i++, spacing * a * x, spacing * a * y, spacing * a * z, a, eta);
  return s;
}

static inline sd_status scene_apply(void *ctx, const double *F, double *u)
{
  scene *s = ctx;
  const sd_spheres spheres = {s->x, s->a, s->w};
  s->products++;
  const sd_law law = {.tensor = s->kind};
  if (s->fast) {
    if (!s->packed.n)
      assert_int_equal(sd_packed_all(&s->packed, SD_ISA_BEST, &law, &spheres, s->n, 3), SD_OK);
    sd_packed_share(&s->packed, 0, 1, F, u);
  } else if (isinf(s->cutoff))
    plain_all(&law, &spheres, s->n, 3, F, u);
  else {
    if (!s->list.first)
      assert_int_equal(sd_neighbors_cutoff(&s->list, s->x, s->n, s->n, s->cutoff), SD_OK);
    plain_list(&law, &spheres, s->n, 3, &s->list.pairs, F, u);
  }
  return SD_OK;
}

static inline sd_system scene_system(scene *s)
{
  return (sd_system){.n = s->n,
                     .drag = s->drag,
                     .apply = scene_apply,
                     .apply_ctx = s,
                     .precondition = s->precondition,
                     .precondition_ctx = s->precondition_ctx};
}

typedef sd_status solver(const sd_system *, const double *, double, int, double *, double *,
                         sd_solve_report *);

/* Forces [3n] (caller frees) for the slip velocity given */
static inline double *scene_solve(scene *s, solver *solve, const double *slip, double tolerance,
                                  int max_iter, sd_status *status, sd_solve_report *report)
{
  const sd_system A = scene_system(s);
  double *F = malloc(sizeof(double) * 3 * (size_t) s->n),
         *work = malloc(sizeof(double) * SD_SOLVE_WORK(s->n, 3));
  *status = solve(&A, slip, tolerance, max_iter, F, work, report);
  free(work);
  return F;
}

static inline double *scene_uniform_slip(const scene *s, double ux, double uy, double uz)
{
  double *u = malloc(sizeof(double) * 3 * (size_t) s->n);
  for (int i = 0; i < s->n; i++) {
    u[3 * i] = ux;
    u[3 * i + 1] = uy;
    u[3 * i + 2] = uz;
  }
  return u;
}

#endif
