#include "sd_clump.h"

#include "sd_linear.h"
#include "sd_product.h"
#include "sd_solve.h"
#include "sd_tensor.h"

#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 12, RIGID = 6 };

/* --- shells -------------------------------------------------------------------------------------------------- */

sd_status sd_shells_get(sd_shells *cache, int n, const sd_shell **shell)
{
  const int size = sd_shell_size(n);
  for (int i = 0; i < cache->count; i++)
    if (cache->shell[i].n == size) {
      *shell = cache->shell + i;
      return SD_OK;
    }
  sd_shell *larger = realloc(cache->shell, sizeof(sd_shell) * (size_t) (cache->count + 1));
  if (!larger) return SD_ENOMEMORY;
  cache->shell = larger;
  const sd_status status = sd_shell_create(size, larger + cache->count);
  if (status == SD_OK) *shell = larger + cache->count++;
  return status;
}

void sd_shells_free(sd_shells *cache)
{
  for (int i = 0; i < cache->count; i++) sd_shell_free(cache->shell + i);
  free(cache->shell);
  *cache = (sd_shells){0};
}

/* --- points of the surface ------------------------------------------------------------------------------------- */

/* Points that carry the unknown forces: x [3n], a [n] their radii, sphere [n] whose they are. */
typedef struct {
  int n;
  double *x, *a;
  int *sphere;
} surface;

static void surface_free(surface *s)
{
  free(s->x);
  free(s->a);
  free(s->sphere);
}

/* A point is hidden when it lies deeper inside the shell of another sphere than this, in radii of that shell's points. Along
 * the seam of two spheres both keep what would leave a gap as wide as their spacing; deeper, points of nearly coincident
 * spheres double. 0.4 makes the drag of pairs and rows at any overlap (0.1 to 1.9 radii apart) as accurate as that of touching
 * spheres. */
static const double seam = 0.4;

/* Is p inside one of the spheres but its own, whose radii are given? */
static int hidden(const sd_shape *s, const double *radius, int own, const double p[3])
{
  for (int j = 0; j < s->n; j++) {
    if (j == own) continue;
    const double *c = s->x + 3 * j, d[3] = {p[0] - c[0], p[1] - c[1], p[2] - c[2]};
    if (sd_dot(d, d) < radius[j] * radius[j]) return 1;
  }
  return 0;
}

/* Which part of its surface every sphere shows: all of it, or by a fine shell of directions. A hair inside, so that spheres that
 * only touch, and points of a symmetric shape that lie on two spheres, are not decided by rounding. */
static sd_status exposed_fractions(const sd_shape *s, sd_shells *cache, double *fraction)
{
  enum { FINE = 642 };
  const sd_shell *fine = NULL;
  sd_status status = SD_OK;
  double *radius = malloc(sizeof(double) * (size_t) s->n);
  if (!radius) return SD_ENOMEMORY;
  for (int i = 0; i < s->n; i++) radius[i] = 0.99983 * s->a[i];
  for (int i = 0; i < s->n && status == SD_OK; i++) {
    int overlaps = 0, count = 0;
    for (int j = 0; j < s->n && !overlaps; j++) {
      const double *x = s->x + 3 * i, *y = s->x + 3 * j,
                   d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
      const double reach = s->a[i] + radius[j];
      overlaps = j != i && sd_dot(d, d) < reach * reach;
    }
    fraction[i] = 1.0;
    if (!overlaps) continue;
    status = sd_shells_get(cache, FINE, &fine);
    for (int m = 0; m < FINE && status == SD_OK; m++) {
      double e[3], p[3];
      sd_multiply3(s->frame, fine->p + 3 * m, e);
      for (int d = 0; d < 3; d++) p[d] = s->x[3 * i + d] + s->a[i] * e[d];
      count += !hidden(s, radius, i, p);
    }
    fraction[i] = (double) count / FINE;
  }
  free(radius);
  return status;
}

enum { FEWEST = 12, MOST = 642 };

/* Points of the whole shell of every sphere: even density, n exposed points for every sphere that shows. Without fractions
 * (NULL): as if nothing were hidden. */
static void share_points(const sd_shape *s, int n, const double *fraction, int *count)
{
  const double most = fmax(MOST, 4.0 * n);
  double area = 0.0;
  int visible = 0;
  for (int i = 0; i < s->n; i++) {
    const double w = fraction ? fraction[i] : 1.0;
    area += w * s->a[i] * s->a[i];
    visible += w > 0.0;
  }
  for (int i = 0; i < s->n; i++) {
    /* equal radii must give n itself, not the next number because of rounding */
    const double share = area > 0.0 ? ceil(n * s->a[i] * s->a[i] * visible / area - 1e-4) : n;
    count[i] = sd_shell_size((int) fmin(most, fmax(FEWEST, share)));
  }
}

/* Points are not quite as even as a sphere, and where they happen to lie at a contact or along a seam is chance. With few
 * points the result is the mean over this many orientations of all shells together. */
static int orientations(int n)
{
  return n == 1 ? 1 : 1 + 95 / n;
}

/* Orientation number k: the first is the frame itself, the others spread evenly over all rotations (unit quaternions from a
 * three-dimensional additive sequence). */
static void orientation(int k, double Q[9])
{
  const double t = fmod(k * 0.8191725133961645, 1.0),
               u = 2.0 * SD_PI * fmod(k * 0.6710436067037893, 1.0),
               v = 2.0 * SD_PI * fmod(k * 0.5497004779019703, 1.0);
  const double w = k ? sqrt(1.0 - t) * sin(u) : 1.0, x = k ? sqrt(1.0 - t) * cos(u) : 0.0;
  const double y = sqrt(t) * sin(v), z = sqrt(t) * cos(v);
  const double R[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
                       2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                       2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
  memcpy(Q, R, sizeof(R));
}

static sd_status surface_allocate(surface *s, size_t n)
{
  s->x = malloc(sizeof(double) * 3 * n);
  s->a = malloc(sizeof(double) * n);
  s->sphere = malloc(sizeof(int) * n);
  return s->x && s->a && s->sphere ? SD_OK : SD_ENOMEMORY;
}

/* Centres alone, for shell 1 */
static sd_status surface_of_centres(const sd_shape *s, surface *out)
{
  *out = (surface){.n = s->n};
  if (surface_allocate(out, (size_t) s->n) != SD_OK) return SD_ENOMEMORY;
  memcpy(out->x, s->x, sizeof(double) * 3 * (size_t) s->n);
  memcpy(out->a, s->a, sizeof(double) * (size_t) s->n);
  for (int i = 0; i < s->n; i++) out->sphere[i] = i;
  return SD_OK;
}

/* Exposed points for count [n] points a sphere (sizes of shells) and orientation number k */
static sd_status surface_of_shells(const sd_shape *s, const int *count, int k, sd_shells *cache,
                                   surface *out)
{
  size_t total = 0;
  double Q[9], G[9];
  const sd_shell *shell;
  sd_status status = SD_OK;
  *out = (surface){0};
  double *deep = malloc(sizeof(double) * (size_t) s->n);
  if (!deep) return SD_ENOMEMORY;
  for (int i = 0; i < s->n && status == SD_OK; i++) {
    status = sd_shells_get(cache, count[i], &shell);
    if (status != SD_OK) break;
    deep[i] = (shell->radius - seam * shell->point) * s->a[i];
    total += (size_t) shell->n;
  }
  if (status == SD_OK) status = surface_allocate(out, total);
  orientation(k, Q);
  sd_product3(s->frame, Q, G);
  for (int i = 0; i < s->n && status == SD_OK; i++) {
    status = sd_shells_get(cache, count[i], &shell);
    for (int m = 0; m < shell->n; m++) {
      double e[3], *p = out->x + 3 * (size_t) out->n;
      sd_multiply3(G, shell->p + 3 * m, e);
      for (int d = 0; d < 3; d++) p[d] = s->x[3 * i + d] + shell->radius * s->a[i] * e[d];
      if (hidden(s, deep, i, p)) continue;
      out->a[out->n] = shell->point * s->a[i];
      out->sphere[out->n++] = i;
    }
  }
  free(deep);
  return status;
}

/* --- solve ------------------------------------------------------------------------------------------------------ */

static double dense_bytes(double unknowns)
{
  return sizeof(double) * (unknowns * unknowns + COLUMNS * unknowns);
}

static double iterative_bytes(double unknowns)
{
  return sizeof(double) * (COLUMNS + 6 + 3) * unknowns;
}

/* Unknowns a point */
static int width(const sd_clump_options *o)
{
  return o->shell == 1 && o->rotation ? 6 : 3;
}

static sd_status check_need(double points, const sd_clump_options *o, sd_clump_need *need)
{
  need->points = (long) points;
  need->dense = dense_bytes(points * width(o));
  need->iterative = iterative_bytes(points * width(o));
  return fmin(need->iterative, need->dense) <= o->memory ? SD_OK : SD_ENOMEMORY;
}

sd_status sd_clump_needs(const sd_shape *shape, const sd_clump_options *o, sd_clump_need *need)
{
  const int n = sd_shell_size(o->shell);
  double points = shape->n;
  if (n > 1) {
    int *count = malloc(sizeof(int) * (size_t) shape->n);
    if (!count) return SD_ENOMEMORY;
    share_points(shape, n, NULL, count);
    points = 0.0;
    for (int i = 0; i < shape->n; i++) points += count[i];
    free(count);
  }
  return check_need(points, o, need);
}

/* Slip of the unit column at y: velocity s, angular velocity w */
static void unit_slip(int column, const double y[3], double s[3], double w[3])
{
  static const int row[6] = {0, 1, 2, 1, 0, 0}, col[6] = {0, 1, 2, 2, 2, 1};
  for (int d = 0; d < 3; d++) s[d] = w[d] = 0.0;
  if (column < 3)
    s[column] = 1.0;
  else if (column < 6) {
    w[column - 3] = 1.0;
    sd_cross(w, y, s);
  } else {
    const int p = row[column - 6], q = col[column - 6];
    s[p] = y[q];
    s[q] = y[p];
  }
}

static sd_status solve_dense(const surface *s, int m, double *B)
{
  const size_t N = (size_t) m * s->n;
  double *A = malloc(sizeof(double) * N * N);
  if (!A) return SD_ENOMEMORY;
  for (int i = 0; i < s->n; i++)
    for (int j = i; j < s->n; j++) {
      const double *x = s->x + 3 * (size_t) i, *y = s->x + 3 * (size_t) j,
                   r[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
      double M[36];
      if (m == 6)
        sd_tensor_grand(r, s->a[i], s->a[j], 1.0, M);
      else
        sd_tensor_uf(SD_TENSOR_RPY, r, s->a[i], s->a[j], 1.0, M);
      for (int p = 0; p < m; p++)
        memcpy(A + (m * (size_t) i + p) * N + m * (size_t) j, M + m * p, sizeof(double) * m);
    }
  const sd_status status = sd_cholesky_solve((int) N, A, COLUMNS, B);
  free(A);
  return status;
}

typedef struct {
  const surface *s;
  const double *ones;
  const sd_clump_options *o;
  int solve, solves, products;
} operator;

static void apply(void *ctx, const double *F, double *u)
{
  operator* op = ctx;
  const int n = op->s->n;
  if (op->o->progress) op->o->progress(op->o->progress_ctx, op->solve, op->solves, op->products++);
  if (width(op->o) == 3) {
    const sd_spheres spheres = {op->s->x, op->s->a, op->ones};
    sd_product_all(SD_TENSOR_RPY, &spheres, n, 0, n, F, u);
    return;
  }
  for (int i = 0; i < n; i++) {
    double sum[6] = {0.0};
    for (int j = 0; j < n; j++) {
      if (j == i) continue;
      const double *x = op->s->x + 3 * i, *y = op->s->x + 3 * j,
                   r[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
      double M[36];
      sd_tensor_grand(r, op->s->a[i], op->s->a[j], 1.0, M);
      for (int p = 0; p < 6; p++)
        for (int q = 0; q < 6; q++) sum[p] += M[6 * p + q] * F[6 * j + q];
    }
    memcpy(u + 6 * i, sum, sizeof(sum));
  }
}

static sd_status solve_iterative(const surface *s, const sd_clump_options *o, int k, int times,
                                 double *B, int *iterations)
{
  const int m = width(o), n = s->n;
  const size_t N = (size_t) m * n;
  double *F = malloc(sizeof(double) * (N + (size_t) SD_SOLVE_WORK(n, m) + 3 * (size_t) n));
  if (!F) return SD_ENOMEMORY;
  double *work = F + N, *drag = work + SD_SOLVE_WORK(n, m), *spin = drag + n, *ones = spin + n;
  for (int i = 0; i < n; i++) {
    drag[i] = 6.0 * SD_PI * s->a[i];
    spin[i] = 8.0 * SD_PI * s->a[i] * s->a[i] * s->a[i];
    ones[i] = 1.0;
  }
  operator op = {.s = s, .ones = ones, .o = o, .solves = COLUMNS * times};
  const sd_system A = {
      .n = n, .drag = drag, .spin = m == 6 ? spin : NULL, .apply = apply, .apply_ctx = &op};
  sd_status status = SD_OK;
  for (int c = 0; c < COLUMNS && status == SD_OK; c++) {
    sd_solve_report report;
    op.solve = COLUMNS * k + c;
    op.products = 0;
    status =
        sd_solve_gradients(&A, B + N * (size_t) c, o->tolerance, o->max_iter, F, work, &report);
    if (report.iterations > *iterations) *iterations = report.iterations;
    memcpy(B + N * (size_t) c, F, sizeof(double) * N);
  }
  free(F);
  return status;
}

/* --- the table ---------------------------------------------------------------------------------------------------- */

/* Response of one sphere to a slip given in columns */
static void respond(const double *table, const double in[COLUMNS], double out[6])
{
  for (int p = 0; p < 6; p++) out[p] = 0.0;
  for (int c = 0; c < COLUMNS; c++)
    for (int p = 0; p < 6; p++) out[p] += table[6 * c + p] * in[c];
}

/* Columns of the symmetric E, and back */
static void to_columns(const double A[9], double E[6])
{
  E[0] = A[0];
  E[1] = A[4];
  E[2] = A[8];
  E[3] = 0.5 * (A[5] + A[7]);
  E[4] = 0.5 * (A[2] + A[6]);
  E[5] = 0.5 * (A[1] + A[3]);
}
static void from_columns(const double E[6], double A[9])
{
  A[0] = E[0];
  A[4] = E[1];
  A[8] = E[2];
  A[5] = A[7] = E[3];
  A[2] = A[6] = E[4];
  A[1] = A[3] = E[5];
}

/* g A g^T */
static void turn(const double g[9], const double A[9], double out[9])
{
  double gA[9], gt[9];
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) gt[3 * p + q] = g[3 * q + p];
  sd_product3(g, A, gA);
  sd_product3(gA, gt, out);
}

static double determinant(const double g[9])
{
  double c[3];
  sd_cross(g, g + 3, c);
  return sd_dot(c, g + 6);
}

/* Average over the symmetries of the shape: turn slip with g, read the forces of the image, turn them back. Torque and angular
 * velocity change sign under reflections. */
static sd_status symmetrize(const sd_shape *s, double *table)
{
  const size_t size = sizeof(double) * 6 * COLUMNS * (size_t) s->n;
  double *old = malloc(size);
  if (!old) return SD_ENOMEMORY;
  memcpy(old, table, size);
  memset(table, 0, size);
  for (int m = 0; m < s->symmetries; m++) {
    const double *g = s->g + 9 * m, hand = determinant(g) < 0.0 ? -1.0 : 1.0;
    for (int c = 0; c < COLUMNS; c++) {
      double in[COLUMNS] = {0.0}, turned[COLUMNS], E[9], gE[9];
      in[c] = 1.0;
      sd_multiply3(g, in, turned);
      sd_multiply3(g, in + 3, turned + 3);
      for (int d = 3; d < 6; d++) turned[d] *= hand;
      from_columns(in + 6, E);
      turn(g, E, gE);
      to_columns(gE, turned + 6);
      for (int k = 0; k < s->n; k++) {
        double out[6], back[6];
        respond(old + 6 * COLUMNS * (size_t) s->perm[(size_t) s->n * m + k], turned, out);
        sd_multiply3t(g, out, back);
        sd_multiply3t(g, out + 3, back + 3);
        double *t = table + 6 * (COLUMNS * (size_t) k + c);
        for (int d = 0; d < 3; d++) {
          t[d] += back[d] / s->symmetries;
          t[d + 3] += hand * back[d + 3] / s->symmetries;
        }
      }
    }
  }
  free(old);
  return SD_OK;
}

/* Forces of the points -> force and torque of every sphere about its own centre */
static void gather(const sd_shape *shape, const surface *s, int m, const double *B, double *table)
{
  const size_t N = (size_t) m * s->n;
  memset(table, 0, sizeof(double) * 6 * COLUMNS * (size_t) shape->n);
  for (int c = 0; c < COLUMNS; c++)
    for (int i = 0; i < s->n; i++) {
      const double *f = B + N * c + (size_t) m * i, *x = shape->x + 3 * s->sphere[i],
                   *y = s->x + 3 * i;
      const double arm[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};
      double *t = table + 6 * (COLUMNS * (size_t) s->sphere[i] + c), torque[3];
      sd_cross(arm, f, torque);
      for (int d = 0; d < 3; d++) {
        t[d] += f[d];
        t[d + 3] += torque[d] + (m == 6 ? f[d + 3] : 0.0);
      }
    }
}

static void lone_sphere(double a, double *table)
{
  memset(table, 0, sizeof(double) * 6 * COLUMNS);
  for (int d = 0; d < 3; d++) {
    table[6 * d + d] = 6.0 * SD_PI * a;
    table[6 * (3 + d) + 3 + d] = 8.0 * SD_PI * a * a * a;
  }
}

/* --- what follows from the table ----------------------------------------------------------------------------------- */

/* Sums over the clump about its centroid: 6 rows, 12 columns */
static void add_up(const sd_shape *s, const double *table, double sum[6][COLUMNS])
{
  memset(sum, 0, sizeof(double) * 6 * COLUMNS);
  for (int k = 0; k < s->n; k++)
    for (int c = 0; c < COLUMNS; c++) {
      const double *t = table + 6 * (COLUMNS * (size_t) k + c);
      double torque[3];
      sd_cross(s->x + 3 * k, t, torque);
      for (int d = 0; d < 3; d++) {
        sum[d][c] += t[d];
        sum[d + 3][c] += t[d + 3] + torque[d];
      }
    }
}

void sd_resistance_shift(const double R[36], const double d[3], double out[36])
{
  /* About P = c + d: velocity of c is U_P + d x W, i.e. (U, W)_c = S^T (U, W)_P; torque about P is T_c - d x F: out = S R S^T
   * with
   * S = [1 0; -[d] 1]. */
  double S[36], SR[36];
  for (int i = 0; i < 36; i++) S[i] = i % 7 == 0;
  S[6 * 3 + 1] = d[2];
  S[6 * 3 + 2] = -d[1];
  S[6 * 4 + 0] = -d[2];
  S[6 * 4 + 2] = d[0];
  S[6 * 5 + 0] = d[1];
  S[6 * 5 + 1] = -d[0];
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 6; q++) {
      SR[6 * p + q] = 0.0;
      for (int k = 0; k < 6; k++) SR[6 * p + q] += S[6 * p + k] * R[6 * k + q];
    }
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 6; q++) {
      double s = 0.0;
      for (int k = 0; k < 6; k++) s += SR[6 * p + k] * S[6 * q + k];
      out[6 * p + q] = s;
    }
}

/* Where the coupling block is symmetric. M: 3x3 blocks translation (tt) and coupling (cc: rotation rows, translation columns)
 * about the present point. Moving it by d changes cc by sign [d] tt; the antisymmetric parts cancel if (tr tt - tt) d = sign
 * vec cc, vec_i = e_ijk cc_jk. Degenerate directions (no translation) stay where they are. */
static void symmetric_coupling(const double tt[9], const double cc[9], double sign, double d[3])
{
  const double trace = tt[0] + tt[4] + tt[8], v[3] = {cc[5] - cc[7], cc[6] - cc[2], cc[1] - cc[3]};
  double A[9], w[3], V[9];
  for (int i = 0; i < 9; i++) A[i] = (i % 4 == 0 ? trace : 0.0) - tt[i];
  sd_eigen(3, A, w, V);
  for (int p = 0; p < 3; p++) d[p] = 0.0;
  for (int k = 0; k < 3; k++) {
    if (!(w[k] > 1e-9 * w[0])) continue;
    const double e[3] = {V[k], V[3 + k], V[6 + k]}, s = sign * sd_dot(e, v) / w[k];
    for (int p = 0; p < 3; p++) d[p] += s * e[p];
  }
}

static void derive(const sd_shape *s, sd_clump *clump)
{
  double sum[6][COLUMNS], tt[9], cc[9];
  add_up(s, clump->table, sum);
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 6; q++) {
      clump->R[6 * p + q] = 0.5 * (sum[p][q] + sum[q][p]);
      clump->strain[6 * p + q] = sum[p][q + 6];
    }
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      tt[3 * p + q] = clump->R[6 * p + q];
      cc[3 * p + q] = clump->R[6 * (p + 3) + q];
    }
  symmetric_coupling(tt, cc, -1.0, clump->centre); /* cc about c + d: cc - [d] tt */
  sd_resistance_shift(clump->R, clump->centre, clump->R_centre);
  sd_pseudo_inverse6(clump->R_centre, clump->mobility);
  /* Mobility about another point at d: velocity there is U + W x d, so tt - [d] (rotation rows, translation columns) + ... ; the
   * trace is least at the centre of mobility. With rr the rotation block: tr = tr tt - v.d + d.(tr rr - rr) d, v = 2 vec. */
  double rr[9], d[3];
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      rr[3 * p + q] = clump->mobility[6 * (p + 3) + q + 3];
      cc[3 * p + q] = clump->mobility[6 * (p + 3) + q];
    }
  symmetric_coupling(rr, cc, 1.0, d);
  double mu = clump->mobility[0] + clump->mobility[7] + clump->mobility[14];
  const double v[3] = {cc[5] - cc[7], cc[6] - cc[2], cc[1] - cc[3]};
  mu -= fabs(sd_dot(v, d));
  clump->radius = 3.0 / (6.0 * SD_PI * mu);
}

/* --- create, forces --------------------------------------------------------------------------------------------------- */

/* Two equal spheres at one point: the force is split between them in no particular way. */
static int coincident(const sd_shape *s)
{
  const double tolerance = SD_SHAPE_TOLERANCE * s->size;
  for (int i = 0; i < s->n; i++)
    for (int j = i + 1; j < s->n; j++) {
      const double *x = s->x + 3 * i, *y = s->x + 3 * j;
      if (fabs(s->a[i] - s->a[j]) <= tolerance && fabs(x[0] - y[0]) <= tolerance &&
          fabs(x[1] - y[1]) <= tolerance && fabs(x[2] - y[2]) <= tolerance)
        return 1;
    }
  return 0;
}

/* Table for the forces on the points of one surface, number k of so many */
static sd_status solve_surface(const sd_shape *shape, const surface *s, const sd_clump_options *o,
                               const sd_clump_need *need, sd_clump *clump, double *table, int k,
                               int times)
{
  const int m = width(o);
  double *B = malloc(sizeof(double) * COLUMNS * m * (size_t) s->n);
  if (!B) return SD_ENOMEMORY;
  for (int c = 0; c < COLUMNS; c++)
    for (int i = 0; i < s->n; i++) {
      double u[3], w[3], *b = B + (size_t) m * ((size_t) s->n * c + i);
      unit_slip(c, s->x + 3 * (size_t) i, u, w);
      memcpy(b, u, sizeof(u));
      if (m == 6) memcpy(b + 3, w, sizeof(w));
    }
  const sd_status status = need->dense <= o->memory
      ? solve_dense(s, m, B)
      : solve_iterative(s, o, k, times, B, &clump->iterations);
  if (status == SD_OK) gather(shape, s, m, B, table);
  free(B);
  return status;
}

/* The mean table of all orientations of the shells, with the symmetry of the shape */
static sd_status solve_shells(const sd_shape *shape, const sd_clump_options *o, sd_shells *cache,
                              sd_clump *clump, sd_clump_need *need)
{
  const int n = sd_shell_size(o->shell), times = orientations(n);
  const size_t size = 6 * COLUMNS * (size_t) shape->n;
  double *fraction = malloc(sizeof(double) * (size_t) shape->n),
         *one = malloc(sizeof(double) * size);
  int *count = malloc(sizeof(int) * (size_t) shape->n);
  sd_status status = fraction && one && count ? exposed_fractions(shape, cache, fraction)
                                              : SD_ENOMEMORY;
  if (status == SD_OK) share_points(shape, n, fraction, count);
  memset(clump->table, 0, sizeof(double) * size);
  for (int k = 0; k < times && status == SD_OK; k++) {
    surface s;
    status = surface_of_shells(shape, count, k, cache, &s);
    if (status == SD_OK) status = check_need(s.n, o, need);
    if (status == SD_OK) status = solve_surface(shape, &s, o, need, clump, one, k, times);
    if (k == 0) clump->points = s.n;
    for (size_t i = 0; i < size && status == SD_OK; i++) clump->table[i] += one[i] / times;
    surface_free(&s);
  }
  if (status == SD_OK) status = symmetrize(shape, clump->table);
  free(fraction);
  free(one);
  free(count);
  return status;
}

sd_status sd_clump_create(const sd_shape *shape, const sd_clump_options *o, sd_shells *cache,
                          sd_clump *clump, sd_clump_need *need)
{
  sd_clump_need own;
  if (!need) need = &own;
  *clump = (sd_clump){.n = shape->n, .points = shape->n};
  sd_status status = sd_clump_needs(shape, o, need);
  if (status != SD_OK) return status;
  if (coincident(shape)) return SD_ESINGULAR;
  clump->table = malloc(sizeof(double) * 6 * COLUMNS * (size_t) shape->n);
  if (!clump->table) return SD_ENOMEMORY;

  if (shape->n == 1 && (o->shell != 1 || o->rotation)) {
    clump->points = sd_shell_size(o->shell);
    lone_sphere(shape->a[0], clump->table);
  } else if (o->shell == 1) {
    surface s;
    status = surface_of_centres(shape, &s);
    if (status == SD_OK) status = solve_surface(shape, &s, o, need, clump, clump->table, 0, 1);
    surface_free(&s);
  } else
    status = solve_shells(shape, o, cache, clump, need);

  if (status == SD_OK)
    derive(shape, clump);
  else
    sd_clump_free(clump);
  return status;
}

void sd_clump_free(sd_clump *clump)
{
  free(clump->table);
  *clump = (sd_clump){0};
}

/* F_k = R table_k in, for the first columns */
static inline void evaluate(const sd_clump *clump, const double R[9], const double *in, int columns,
                            double *restrict F, double *restrict T)
{
  for (int k = 0; k < clump->n; k++) {
    const double *restrict t = clump->table + 6 * COLUMNS * (size_t) k;
    double f[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    for (int c = 0; c < columns; c++)
      for (int p = 0; p < 6; p++) f[p] += t[6 * c + p] * in[c];
    sd_multiply3(R, f, F + 3 * k);
    if (T) sd_multiply3(R, f + 3, T + 3 * k);
  }
}

void sd_clump_forces_rigid(const sd_clump *clump, const double R[9], double eta, const double s0[3],
                           const double W[3], double *F, double *T)
{
  double in[RIGID];
  sd_multiply3t(R, s0, in);
  sd_multiply3t(R, W, in + 3);
  for (int c = 0; c < RIGID; c++) in[c] *= eta;
  evaluate(clump, R, in, RIGID, F, T);
}

void sd_clump_forces(const sd_clump *clump, const double R[9], double eta, const double s0[3],
                     const double A[9], double *F, double *T)
{
  const double W[3] = {0.5 * (A[7] - A[5]), 0.5 * (A[2] - A[6]), 0.5 * (A[3] - A[1])};
  double in[COLUMNS], Rt[9], E[9];
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) Rt[3 * p + q] = R[3 * q + p];
  turn(Rt, A, E);
  to_columns(E, in + 6);
  sd_multiply3t(R, s0, in);
  sd_multiply3t(R, W, in + 3);
  for (int c = 0; c < COLUMNS; c++) in[c] *= eta;
  evaluate(clump, R, in, COLUMNS, F, T);
}
