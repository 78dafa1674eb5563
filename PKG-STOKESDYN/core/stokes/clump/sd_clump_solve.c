#include "sd_clump_internal.h"

#include "sd_clump_strain.h"
#include "sd_linear.h"
#include "sd_product.h"
#include "sd_solve.h"
#include "sd_sparse.h"
#include "sd_wall.h"

#include <stdlib.h>
#include <string.h>

/* Of the sparse factor, which then has up to BLOCKS blocks a point: surfaces have fewer than
 * clouds. */
static const double REACH = 3.0, BLOCKS = 50.0;

/* Matrix and right-hand sides */
static double dense_bytes(double unknowns)
{
  return sizeof(double) * (unknowns * unknowns + SD_CLUMP_COLUMNS * unknowns);
}

/* A block of the factor and its row number: 52 bytes for 3 unknowns, 148 for 6 */
static double iterative_bytes(double unknowns, int width)
{
  const double block = width == 3 ? 18.0 : 25.0;
  return (sizeof(double) * (SD_CLUMP_COLUMNS + 14) + block * BLOCKS) * unknowns;
}

int sd_clump_width(const sd_clump_options *o)
{
  return o->shell == 1 && o->rotation ? 6 : 3;
}

sd_status sd_clump_check_need(double points, const sd_clump_options *o, sd_clump_need *need)
{
  need->points = (long) points;
  need->dense = dense_bytes(points * sd_clump_width(o));
  need->iterative = iterative_bytes(points * sd_clump_width(o), sd_clump_width(o));
  return fmin(need->iterative, need->dense) <= o->memory ? SD_OK : SD_ENOMEMORY;
}

/* Before anything is made: nothing is hidden yet, so this is an upper bound. */
sd_status sd_clump_needs(const sd_shape *shape, const sd_clump_options *o, sd_clump_need *need)
{
  const int n = sd_shell_size(o->shell);
  double points = shape->n;
  if (n > 1) {
    int *count = malloc(sizeof(int) * (size_t) shape->n);
    if (!count) return SD_ENOMEMORY;
    sd_surface_share(shape, n, NULL, count);
    points = 0.0;
    for (int i = 0; i < shape->n; i++) points += count[i];
    free(count);
  }
  return sd_clump_check_need(points, o, need);
}

/* Slip of the unit column at y: velocity s, angular velocity w. Three translations e_c; three
 * rotations w = e, s = e x y; six strains, in which s = E y with E_pq = E_qp = 1 (on the diagonal
 * once). */
static void unit_slip(int column, const double y[3], double s[3], double w[3])
{
  for (int d = 0; d < 3; d++) s[d] = w[d] = 0.0;
  if (column < 3)
    s[column] = 1.0;
  else if (column < 6) {
    w[column - 3] = 1.0;
    sd_cross(w, y, s);
  } else
    sd_clump_unit_strain(column - 6, y, s);
}

/* The matrix of all points and its Cholesky factor for all twelve columns at once. Viscosity 1: the
 * resistance is proportional to it. */
static sd_status solve_dense(const sd_surface *s, int m, double *B)
{
  const size_t N = (size_t) m * s->n;
  double *A = malloc(sizeof(double) * N * N);
  if (!A) return SD_ENOMEMORY;
  sd_wall_matrix(NULL, s->n, m, s->x, s->a, A);
  const sd_status status = sd_cholesky_solve((int) N, A, SD_CLUMP_COLUMNS, B);
  free(A);
  return status;
}

/* u = Omega F among the points, with a word to the caller before every product: a large surface
 * takes minutes. */
typedef struct {
  const sd_clump_options *o;
  sd_packed packed;
  int solve, solves, products;
} operator;

static sd_status clump_solve_apply(void *ctx, const double *F, double *u)
{
  operator* op = ctx;
  if (op->o->progress) op->o->progress(op->o->progress_ctx, op->solve, op->solves, op->products++);
  sd_packed_share(&op->packed, 0, 1, F, u);
  return SD_OK;
}

/* Twelve right-hand sides pay for a sparse factor; where it cannot be made, the diagonal serves. */
static sd_status solve_iterative(const sd_surface *s, const sd_clump_options *o, double *B, int *iterations)
{
  const int m = sd_clump_width(o), n = s->n;
  const size_t N = (size_t) m * n;
  double *F = malloc(sizeof(double) * (N + (size_t) SD_SOLVE_WORK(n, m) + 3 * (size_t) n));
  if (!F) return SD_ENOMEMORY;
  double *work = F + N, *drag = work + SD_SOLVE_WORK(n, m), *spin = drag + n, *ones = spin + n;
  for (int i = 0; i < n; i++) {
    drag[i] = 6.0 * SD_PI * s->a[i];
    spin[i] = 8.0 * SD_PI * s->a[i] * s->a[i] * s->a[i];
    ones[i] = 1.0;
  }
  const sd_precondition_case points = {
      .law = {.tensor = SD_TENSOR_RPY}, .spheres = {s->x, s->a, ones}, .n = n, .width = m, .parts = 1};
  operator op = {.o = o, .solves = SD_CLUMP_COLUMNS * sd_surface_orientations(sd_shell_size(o->shell))};
  sd_system A = {
      .n = n, .drag = drag, .spin = m == 6 ? spin : NULL, .apply = clump_solve_apply, .apply_ctx = &op};
  sd_sparse factor;
  if (sd_sparse_create(&factor, &points, REACH) == SD_OK) {
    A.precondition = sd_sparse_apply;
    A.precondition_ctx = &factor;
  }
  sd_status status = sd_packed_all(&op.packed, SD_ISA_BEST, &points.law, &points.spheres, n, m);
  for (int c = 0; c < SD_CLUMP_COLUMNS && status == SD_OK; c++) {
    sd_solve_report report;
    op.solve = SD_CLUMP_COLUMNS * s->number + c;
    op.products = 0;
    status =
        sd_solve_gradients(&A, B + N * (size_t) c, o->tolerance, o->max_iter, F, work, &report);
    if (report.iterations > *iterations) *iterations = report.iterations;
    memcpy(B + N * (size_t) c, F, sizeof(double) * N);
  }
  sd_sparse_free(&factor);
  sd_packed_free(&op.packed);
  free(F);
  return status;
}

/* The dense way wherever it fits: it takes no tolerance, and twelve columns cost hardly more than
 * one. */
sd_status sd_clump_solve(const sd_surface *s, const sd_clump_options *o, const sd_clump_need *need,
                         double *B, int *iterations)
{
  const int m = sd_clump_width(o);
  for (int c = 0; c < SD_CLUMP_COLUMNS; c++)
    for (int i = 0; i < s->n; i++) {
      double u[3], w[3], *b = B + (size_t) m * ((size_t) s->n * c + i);
      unit_slip(c, s->x + 3 * (size_t) i, u, w);
      memcpy(b, u, sizeof(u));
      if (m == 6) memcpy(b + 3, w, sizeof(w));
    }
  return need->dense <= o->memory ? solve_dense(s, m, B) : solve_iterative(s, o, B, iterations);
}
