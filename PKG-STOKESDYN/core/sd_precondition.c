#include "sd_precondition.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "sd_product_internal.h"

/* LAPACK: Cholesky factor, and inverse from it, of the lower triangle (column-major). */
void dpotrf_(const char *uplo, const int *n, double *A, const int *lda, int *info);
void dpotri_(const char *uplo, const int *n, double *A, const int *lda, int *info);

/* Block of C, unit diagonal, into A (column-major, leading dimension lda), symmetric 3x3. */
static void unit_block(const sd_law *law, const sd_spheres *s, int i, int j, double *A, long lda)
{
  const double *xi = s->x + 3 * (long) i, *xj = s->x + 3 * (long) j;
  const double r[3] = {xi[0] - xj[0], xi[1] - xj[1], xi[2] - xj[2]};
  const double R = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
  double f, g;
  if (law->tensor == SD_TENSOR_RPY)
    sd_rpy_radial(R, s->a[i], s->a[j], &f, &g);
  else
    sd_oseen_radial(R, &f, &g);
  const double c = sqrt(s->a[i] * s->a[j]) * sd_taper_factor(law, R), inv = R > 0.0 ? 1.0 / R : 0.0;
  for (int q = 0; q < 3; q++)
    for (int p = 0; p < 3; p++)
      A[p + lda * q] = c * (g * (r[p] * inv) * (r[q] * inv) + (p == q ? f : 0.0));
}

/* Lower triangle of C of the spheres member[0 ... m-1], with 1 + extra on the diagonal. */
static void fill(const sd_law *law, const sd_spheres *s, const int *member, int m, double extra,
                 double *A)
{
  const long lda = 3 * (long) m;
  for (int j = 0; j < m; j++)
    for (int i = j; i < m; i++) {
      double *block = A + 3 * i + lda * (3 * j);
      if (i != j) {
        unit_block(law, s, member[i], member[j], block, lda);
        continue;
      }
      for (int q = 0; q < 3; q++)
        for (int p = 0; p < 3; p++) block[p + lda * q] = p == q ? 1.0 + extra : 0.0;
    }
}

/* Cholesky factor of C of these spheres. Singular within rounding (spheres at one point): once more with a small diagonal. */
static sd_status factor(const sd_law *law, const sd_spheres *s, const int *member, int m, double *A)
{
  static const double extra[] = {0.0, 1e-12, 1e-9, 1e-6};
  const int size = 3 * m;
  for (int k = 0; k < 4; k++) {
    int info;
    fill(law, s, member, m, extra[k], A);
    dpotrf_("L", &size, A, &size, &info);
    if (info == 0) {
      /* A NaN need not stop dpotrf; it always reaches the last pivot. */
      const double last = A[(long) size * size - 1];
      return last > 0.0 && last < INFINITY ? SD_OK : SD_ENOTFINITE;
    }
    if (!(A[(info - 1) * ((long) size + 1)] < INFINITY)) return SD_ENOTFINITE;
  }
  return SD_EINDEFINITE;
}

static void torques(int width, const double *drag, const double *spin, int n, const double *r,
                    double *z)
{
  if (width != 6) return;
  for (int i = 0; i < n; i++)
    for (int k = 3; k < 6; k++)
      z[6 * (long) i + k] = drag[i] == 0.0 ? 0.0 : spin[i] * r[6 * (long) i + k];
}

/* --- sparse factor ------------------------------------------------------------------------------------------------ */

/* Cells of one side over some of the spheres, chained; a hash of the cell's three numbers picks the chain. */
typedef struct {
  double side;
  int buckets; /* a power of two */
  int *head, *next;
} cells;

static int64_t cell_of(const cells *c, double x)
{
  return (int64_t) floor(x / c->side);
}

static int bucket(const cells *c, int64_t i, int64_t j, int64_t k)
{
  const uint64_t h = (uint64_t) i * 0x9e3779b97f4a7c15u ^ (uint64_t) j * 0xc2b2ae3d27d4eb4fu ^
      (uint64_t) k * 0x165667b19e3779f9u;
  return (int) ((h ^ (h >> 29)) & (uint64_t) (c->buckets - 1));
}

static void cells_clear(cells *c, double side)
{
  c->side = side;
  for (int k = 0; k < c->buckets; k++) c->head[k] = -1;
}

static void cells_add(cells *c, const double *x, int i)
{
  const double *p = x + 3 * (long) i;
  const int b = bucket(c, cell_of(c, p[0]), cell_of(c, p[1]), cell_of(c, p[2]));
  c->next[i] = c->head[b];
  c->head[b] = i;
}

static int cells_create(cells *c, int n)
{
  c->buckets = 16;
  while (c->buckets < n) c->buckets *= 2;
  c->head = malloc(sizeof(int) * (size_t) c->buckets);
  c->next = malloc(sizeof(int) * (size_t) (n + 1));
  return c->head && c->next;
}

static void cells_free(cells *c)
{
  free(c->head);
  free(c->next);
}

static double squared(const double *x, int i, int j)
{
  const double *p = x + 3 * (long) i, *q = x + 3 * (long) j;
  const double d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
  return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

/* for (j: the spheres in the cells that the ball around sphere i meets) */
#define FOR_EACH_NEAR(c, x, i, radius, j)                                                         \
  for (int64_t cx_ = cell_of(c, (x)[3 * (long) (i)] - (radius)),                                  \
               cx1_ = cell_of(c, (x)[3 * (long) (i)] + (radius));                                 \
       cx_ <= cx1_; cx_++)                                                                        \
    for (int64_t cy_ = cell_of(c, (x)[3 * (long) (i) + 1] - (radius)),                            \
                 cy1_ = cell_of(c, (x)[3 * (long) (i) + 1] + (radius));                           \
         cy_ <= cy1_; cy_++)                                                                      \
      for (int64_t cz_ = cell_of(c, (x)[3 * (long) (i) + 2] - (radius)),                          \
                   cz1_ = cell_of(c, (x)[3 * (long) (i) + 2] + (radius));                         \
           cz_ <= cz1_; cz_++)                                                                    \
        for (int j = (c)->head[bucket(c, cx_, cy_, cz_)]; j >= 0; j = (c)->next[j])               \
          if (cell_of(c, (x)[3 * (long) j]) == cx_ && cell_of(c, (x)[3 * (long) j + 1]) == cy_ && \
              cell_of(c, (x)[3 * (long) j + 2]) == cz_)

/* Heap of spheres, the one with the largest key on top; equal keys: the smaller index. Keys only fall, and are put right when
 * met. */
typedef struct {
  int count;
  int *sphere;
  double *key;
} heap;

static int above(const heap *h, int i, int j)
{
  return h->key[i] > h->key[j] || (h->key[i] == h->key[j] && h->sphere[i] < h->sphere[j]);
}

static void sink(heap *h, int i)
{
  for (;;) {
    int top = i;
    for (int child = 2 * i + 1; child <= 2 * i + 2; child++)
      if (child < h->count && above(h, child, top)) top = child;
    if (top == i) return;
    const double key = h->key[i];
    const int sphere = h->sphere[i];
    h->key[i] = h->key[top];
    h->sphere[i] = h->sphere[top];
    h->key[top] = key;
    h->sphere[top] = sphere;
    i = top;
  }
}

static int gather_active(const sd_spheres *s, int n, int *list, double *extent)
{
  double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
  int count = 0;
  *extent = 0.0;
  for (int i = 0; i < n; i++) {
    if (!(s->a[i] > 0.0)) continue;
    list[count++] = i;
    for (int d = 0; d < 3; d++) {
      lo[d] = fmin(lo[d], s->x[3 * (long) i + d]);
      hi[d] = fmax(hi[d], s->x[3 * (long) i + d]);
    }
  }
  for (int d = 0; d < 3 && count > 0; d++) *extent = fmax(*extent, hi[d] - lo[d]);
  return count;
}

/* Cells small enough to find few, and not so small that their numbers overflow. */
static double cell_side(double reach, double extent)
{
  const double least = 1e-9 * extent;
  return reach > least ? reach : least > 0.0 ? least : 1.0;
}

int sd_farthest_first(const sd_spheres *s, int n, int *order, double *distance)
{
  const double *x = s->x;
  double extent;
  cells c = {0};
  heap h = {0};
  double *sq = malloc(sizeof(double) * (size_t) (n + 1));
  h.sphere = malloc(sizeof(int) * (size_t) (n + 1));
  h.key = malloc(sizeof(double) * (size_t) (n + 1));
  int count = -1;
  if (!cells_create(&c, n) || !sq || !h.sphere || !h.key) goto end;

  count = gather_active(s, n, h.sphere, &extent);
  if (count == 0) goto end;
  order[0] = h.sphere[0];
  distance[0] = INFINITY;
  h.count = count - 1;
  for (int k = 0; k < h.count; k++) {
    h.sphere[k] = h.sphere[k + 1];
    h.key[k] = sq[h.sphere[k]] = squared(x, h.sphere[k], order[0]);
  }
  for (int k = h.count / 2; k >= 0; k--) sink(&h, k);

  c.side = INFINITY;
  for (int found = 1; found < count;) {
    const int i = h.sphere[0];
    if (h.key[0] > sq[i]) {
      h.key[0] = sq[i];
      sink(&h, 0);
      continue;
    }
    const double reach = sqrt(sq[i]);
    order[found] = i;
    distance[found++] = reach;
    h.count--;
    h.sphere[0] = h.sphere[h.count];
    h.key[0] = h.key[h.count];
    sink(&h, 0);
    if (2.0 * reach < c.side) { /* the spheres that are left, in cells of the new size */
      const double side = cell_side(reach, extent);
      if (side < c.side) {
        cells_clear(&c, side);
        for (int k = 0; k < h.count; k++) cells_add(&c, x, h.sphere[k]);
      }
    }
    FOR_EACH_NEAR(&c, x, i, reach, j)
    {
      const double d = squared(x, i, j);
      if (d < sq[j]) sq[j] = d;
    }
  }
end:
  cells_free(&c);
  free(sq);
  free(h.sphere);
  free(h.key);
  return count;
}

void sd_sparse_free(sd_sparse *f)
{
  free(f->first);
  free(f->row);
  free(f->value);
  free(f->scratch);
  memset(f, 0, sizeof(*f));
}

/* Rows of all columns of this part: the sphere itself, then those before it and nearer than rho times its distance. */
static sd_status find_rows(sd_sparse *f, const sd_spheres *s, const int *order,
                           const double *distance, int count, double rho, int *largest)
{
  const double *x = s->x;
  double extent;
  cells c = {0};
  long capacity = 0, used = 0;
  sd_status status = SD_ENOMEMORY;
  int *list = malloc(sizeof(int) * (size_t) (f->n + 1));
  f->first = malloc(sizeof(long) * (size_t) (count / f->parts + 2));
  if (!cells_create(&c, f->n) || !list || !f->first) goto end;
  gather_active(s, f->n, list, &extent);

  c.side = INFINITY;
  *largest = 0;
  for (int k = 0; k < count; k++) {
    const int i = order[k];
    /* a little wider, so that rounding does not split the equal distances of a lattice */
    const double reach = k > 0 ? (1.0 + 1e-6) * rho * distance[k] : 0.0, reach_sq = reach * reach;
    if (k > 0 && 2.0 * reach < c.side) {
      const double side = cell_side(reach, extent);
      if (side < c.side) {
        cells_clear(&c, side);
        for (int l = 0; l < k; l++) cells_add(&c, x, order[l]);
      }
    }
    if (k % f->parts == f->part) {
      f->first[f->columns++] = used;
      if (used + k + 1 > capacity) {
        capacity = 2 * (used + k + 1);
        int *more = realloc(f->row, sizeof(int) * (size_t) capacity);
        if (!more) goto end;
        f->row = more;
      }
      f->row[used++] = i;
      const long begin = used;
      if (k > 0) FOR_EACH_NEAR(&c, x, i, reach, j)
        {
          if (squared(x, i, j) <= reach_sq) f->row[used++] = j;
        }
      if (used - begin + 1 > *largest) *largest = (int) (used - begin + 1);
    }
    if (k > 0) cells_add(&c, x, i); /* the first waits for the size of the cells */
  }
  f->first[f->columns] = used;
  status = SD_OK;
end:
  cells_free(&c);
  free(list);
  return status;
}

/* Last three columns X of R^-T, R the lower Cholesky factor (size x size, column-major): R^T X = E from the bottom up. */
static void last_columns(const double *R, int size, double *X)
{
  for (int k = size - 1; k >= 0; k--) {
    const double *column = R + (long) size * k;
    double v[3] = {0.0, 0.0, 0.0};
    if (k >= size - 3) v[k - (size - 3)] = 1.0;
    for (int p = k + 1; p < size; p++)
      for (int q = 0; q < 3; q++) v[q] -= column[p] * X[3 * p + q];
    for (int q = 0; q < 3; q++) X[3 * k + q] = v[q] / column[k];
  }
}

sd_status sd_sparse_create(sd_sparse *f, const sd_law *law, const sd_spheres *s, int n, double rho,
                           int part, int parts)
{
  memset(f, 0, sizeof(*f));
  f->n = n;
  f->part = part;
  f->parts = parts;
  int largest = 0, count = -1;
  sd_status status = SD_ENOMEMORY;
  int *order = malloc(sizeof(int) * (size_t) (n + 1)), *member = NULL;
  double *distance = malloc(sizeof(double) * (size_t) (n + 1)), *A = NULL, *X = NULL;
  for (int i = 0; i < n; i++)
    for (int d = 0; d < 3; d++)
      if (s->a[i] > 0.0 && !isfinite(s->x[3 * (long) i + d])) {
        status = SD_ENOTFINITE;
        goto end;
      }
  if (order && distance) count = sd_farthest_first(s, n, order, distance);
  if (count < 0 || find_rows(f, s, order, distance, count, rho, &largest) != SD_OK) goto end;
  f->value = malloc(sizeof(float) * (size_t) (12 * f->first[f->columns] + 1));
  f->scratch = malloc(sizeof(double) * (size_t) (8 * (long) n + 1));
  member = malloc(sizeof(int) * (size_t) (largest + 1));
  A = malloc(sizeof(double) * (size_t) (9 * (long) largest * largest + 1));
  X = malloc(sizeof(double) * (size_t) (9 * (long) largest + 1));
  if (!f->value || !f->scratch || !member || !A || !X) goto end;

  status = SD_OK;
  for (int k = 0; k < f->columns && status == SD_OK; k++) {
    const int *row = f->row + f->first[k];
    const int m = (int) (f->first[k + 1] - f->first[k]);
    for (int l = 0; l < m; l++) member[l] = row[m - 1 - l]; /* its own last */
    status = factor(law, s, member, m, A);
    if (status != SD_OK) break;
    last_columns(A, 3 * m, X);
    float *value = f->value + 12 * f->first[k];
    for (int l = 0; l < m; l++)
      for (int q = 0; q < 3; q++) {
        for (int p = 0; p < 3; p++)
          value[12 * l + 4 * q + p] = (float) X[9 * (m - 1 - l) + 3 * p + q];
        value[12 * l + 4 * q + 3] = 0.0f;
      }
  }
end:
  free(order);
  free(distance);
  free(member);
  free(A);
  free(X);
  if (status != SD_OK) sd_sparse_free(f);
  return status;
}

/* What the kernels do, where there are none. */
static void plain_sparse(int columns, const long *first, const int *row, const float *value,
                         const double *in, double *out)
{
  for (int k = 0; k < columns; k++) {
    double t[3] = {0.0, 0.0, 0.0};
    for (long l = first[k]; l < first[k + 1]; l++) {
      const double *v = in + 4 * (long) row[l];
      for (int q = 0; q < 3; q++) {
        const float *B = value + 12 * l + 4 * q;
        t[q] += B[0] * v[0] + B[1] * v[1] + B[2] * v[2];
      }
    }
    for (long l = first[k]; l < first[k + 1]; l++) {
      double *v = out + 4 * (long) row[l];
      const float *B = value + 12 * l;
      for (int p = 0; p < 3; p++) v[p] += B[p] * t[0] + B[4 + p] * t[1] + B[8 + p] * t[2];
    }
  }
}

void sd_sparse_apply(void *ctx, const double *r, double *z)
{
  const sd_sparse *f = ctx;
  const struct sd_kernels *kernels = sd_kernels_of(sd_isa_best());
  const long w = f->width;
  double *in = f->scratch, *out = in + 4 * (long) f->n;
  for (int i = 0; i < f->n; i++) {
    const double root = sqrt(f->drag[i]);
    for (int d = 0; d < 3; d++) in[4 * (long) i + d] = root * r[w * i + d];
    in[4 * (long) i + 3] = 0.0;
  }
  memset(out, 0, 4 * sizeof(double) * (size_t) f->n);
  (kernels ? kernels->sparse : plain_sparse)(f->columns, f->first, f->row, f->value, in, out);
  for (int i = 0; i < f->n; i++) {
    const double root = sqrt(f->drag[i]);
    for (int d = 0; d < 3; d++) z[w * i + d] = root * out[4 * (long) i + d];
  }
  if (f->part == 0)
    torques(f->width, f->drag, f->spin, f->n, r, z);
  else if (w == 6)
    for (int i = 0; i < f->n; i++)
      for (int d = 3; d < 6; d++) z[6 * (long) i + d] = 0.0;
}

/* --- blocks ------------------------------------------------------------------------------------------------------- */

static void uncouple(sd_blocks *b)
{
  free(b->rigid);
  free(b->mobility);
  free(b->total);
  free(b->friction);
  b->rigid = b->mobility = b->total = b->friction = NULL;
  sd_sparse_free(&b->far);
}

void sd_blocks_free(sd_blocks *b)
{
  uncouple(b);
  free(b->first);
  free(b->member);
  free(b->start);
  free(b->inverse);
  free(b->turn);
  free(b->root);
  free(b->scratch);
  memset(b, 0, sizeof(*b));
}

static sd_status blocks_allocate(sd_blocks *b, const sd_spheres *s, int n, int blocks,
                                 const long *first, const int *member)
{
  b->n = n;
  b->blocks = blocks;
  b->first = malloc(sizeof(long) * (size_t) (blocks + 1));
  b->start = malloc(sizeof(long) * (size_t) (blocks + 1));
  b->member = malloc(sizeof(int) * (size_t) (first[blocks] + 1));
  b->turn = calloc((size_t) blocks + 1, sizeof(double) * 9);
  b->root = calloc((size_t) n + 1, sizeof(double));
  if (!b->first || !b->start || !b->member || !b->turn || !b->root) return SD_ENOMEMORY;
  long count = 0, largest = 0;
  b->start[0] = 0;
  for (int k = 0; k < blocks; k++) {
    b->first[k] = count;
    for (long l = first[k]; l < first[k + 1]; l++) {
      const int i = member[l];
      if (!(s->a[i] > 0.0)) continue;
      b->member[count++] = i;
      b->root[i] = sqrt(6.0 * SD_PI * s->a[i]) / s->w[i];
    }
    const long m = count - b->first[k];
    if (m > largest) largest = m;
    b->start[k + 1] = b->start[k] + 9 * m * m;
    for (int d = 0; d < 3; d++) b->turn[9 * (long) k + 4 * d] = 1.0;
  }
  b->first[blocks] = count;
  b->inverse = malloc(sizeof(double) * (size_t) (b->start[blocks] + 1));
  b->scratch = malloc(sizeof(double) * (size_t) (6 * largest + 1));
  return b->inverse && b->scratch ? SD_OK : SD_ENOMEMORY;
}

sd_status sd_blocks_create(sd_blocks *b, const sd_law *law, const sd_spheres *s, int n, int blocks,
                           const long *first, const int *member)
{
  memset(b, 0, sizeof(*b));
  sd_status status = blocks_allocate(b, s, n, blocks, first, member);
  for (int k = 0; k < blocks && status == SD_OK; k++) {
    const int m = (int) (b->first[k + 1] - b->first[k]), size = 3 * m;
    double *A = b->inverse + b->start[k];
    if (m == 0) continue;
    status = factor(law, s, b->member + b->first[k], m, A);
    if (status != SD_OK) break;
    int info;
    dpotri_("L", &size, A, &size, &info);
    if (info != 0) status = SD_EINDEFINITE;
    for (long q = 0; q < size; q++) /* the other triangle */
      for (long p = 0; p < q; p++) A[p + size * q] = A[q + size * p];
  }
  if (status != SD_OK) sd_blocks_free(b);
  return status;
}

void sd_blocks_turn(sd_blocks *b, int block, const double *R)
{
  memcpy(b->turn + 9 * (long) block, R, 9 * sizeof(double));
}

/* out = R v, and R^T v */
static void turned(const double *R, const double *v, double *out)
{
  for (int d = 0; d < 3; d++) out[d] = R[3 * d] * v[0] + R[3 * d + 1] * v[1] + R[3 * d + 2] * v[2];
}

static void turned_back(const double *R, const double *v, double *out)
{
  for (int d = 0; d < 3; d++) out[d] = R[d] * v[0] + R[3 + d] * v[1] + R[6 + d] * v[2];
}

/* Inverse of a symmetric positive definite 3x3 matrix. */
static void inverse3(const double *S, double *T)
{
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      const int a = (q + 1) % 3, b = (q + 2) % 3, c = (p + 1) % 3, d = (p + 2) % 3;
      T[3 * p + q] = S[3 * a + c] * S[3 * b + d] - S[3 * a + d] * S[3 * b + c];
    }
  const double det = S[0] * T[0] + S[1] * T[3] + S[2] * T[6];
  for (int p = 0; p < 9; p++) T[p] /= det;
}

/* rigid = B W, mobility = S^-1; returns the mean friction trace(S)/3. */
static double rigid_translations(sd_blocks *b, int k)
{
  const int *member = b->member + b->first[k];
  const int m = (int) (b->first[k + 1] - b->first[k]), size = 3 * m;
  const double *A = b->inverse + b->start[k];
  double *BW = b->rigid + 9 * b->first[k], S[9] = {0};
  memset(BW, 0, sizeof(double) * 9 * (size_t) m);
  for (int j = 0; j < m; j++)
    for (int i = 0; i < m; i++) {
      const double roots = b->root[member[i]] * b->root[member[j]];
      for (int p = 0; p < 3; p++)
        for (int q = 0; q < 3; q++)
          BW[9 * i + 3 * p + q] += roots * A[3 * i + p + (long) size * (3 * j + q)];
    }
  for (int i = 0; i < m; i++)
    for (int p = 0; p < 9; p++) S[p] += BW[9 * i + p];
  inverse3(S, b->mobility + 9 * (long) k);
  return (S[0] + S[4] + S[8]) / 3.0;
}

sd_status sd_blocks_couple(sd_blocks *b, const sd_law *law, const sd_spheres *s, double rho)
{
  const size_t K = (size_t) b->blocks;
  double *x = malloc(sizeof(double) * 5 * (K + 1)), *a = x + 3 * K, *w = a + K;
  uncouple(b);
  b->rigid = malloc(sizeof(double) * (size_t) (9 * b->first[K] + 1));
  b->mobility = calloc(9 * K + 1, sizeof(double));
  b->total = calloc(9 * K + 1, sizeof(double));
  b->friction = calloc(K + 1, sizeof(double));
  sd_status status = SD_ENOMEMORY;
  if (x && b->rigid && b->mobility && b->total && b->friction) {
    for (size_t k = 0; k < K; k++) {
      /* In the middle, with the mean viscosity of the clump */
      double sum = 0.0, radii = 0.0;
      a[k] = w[k] = x[3 * k] = x[3 * k + 1] = x[3 * k + 2] = 0.0;
      for (long l = b->first[k]; l < b->first[k + 1]; l++) {
        const int i = b->member[l];
        for (int d = 0; d < 3; d++) x[3 * k + d] += s->a[i] * s->x[3 * (long) i + d];
        radii += s->a[i];
        sum += s->a[i] / (s->w[i] * s->w[i]);
      }
      if (radii == 0.0) continue;
      for (int d = 0; d < 3; d++) x[3 * k + d] /= radii;
      b->friction[k] = rigid_translations(b, (int) k);
      a[k] = b->friction[k] * radii / (6.0 * SD_PI * sum);
      w[k] = sqrt(radii / sum);
    }
    const sd_spheres bodies = {x, a, w};
    status = sd_sparse_create(&b->far, law, &bodies, b->blocks, rho, 0, 1);
  }
  free(x);
  if (status != SD_OK) {
    uncouple(b);
    return status;
  }
  b->far.width = 3;
  b->far.drag = b->friction;
  return SD_OK;
}

/* z += B W S^-1 (Q S^-1 - 1) W^T z, given z = B r */
static void couple(const sd_blocks *b, double *z, long w)
{
  double *force = b->total, *velocity = force + 3 * (long) b->blocks,
         *coupled = velocity + 3 * (long) b->blocks;
  for (int k = 0; k < b->blocks; k++) {
    double *c = force + 3 * (long) k, own[3], v[3];
    c[0] = c[1] = c[2] = 0.0;
    for (long l = b->first[k]; l < b->first[k + 1]; l++)
      for (int d = 0; d < 3; d++) c[d] += z[w * b->member[l] + d];
    turned_back(b->turn + 9 * (long) k, c, own);
    turned(b->mobility + 9 * (long) k, own, v);
    turned(b->turn + 9 * (long) k, v, velocity + 3 * (long) k);
  }
  sd_sparse_apply((void *) &b->far, velocity, coupled);
  for (int k = 0; k < b->blocks; k++) {
    const double *R = b->turn + 9 * (long) k;
    double *c = force + 3 * (long) k, own[3], e[3], f[3], z_own[3];
    for (int d = 0; d < 3; d++) c[d] = coupled[3 * (long) k + d] - c[d];
    turned_back(R, c, own);
    turned(b->mobility + 9 * (long) k, own, e);
    for (long l = b->first[k]; l < b->first[k + 1]; l++) {
      turned(b->rigid + 9 * l, e, z_own);
      turned(R, z_own, f);
      for (int d = 0; d < 3; d++) z[w * b->member[l] + d] += f[d];
    }
  }
}

void sd_blocks_apply(void *ctx, const double *r, double *z)
{
  const sd_blocks *b = ctx;
  const long w = b->width;
  for (int i = 0; i < b->n; i++)
    if (b->root[i] == 0.0)
      for (int d = 0; d < 3; d++) z[w * i + d] = b->drag[i] * r[w * i + d];
  for (int k = 0; k < b->blocks; k++) {
    const int *member = b->member + b->first[k];
    const int m = (int) (b->first[k + 1] - b->first[k]), size = 3 * m;
    const double *A = b->inverse + b->start[k], *R = b->turn + 9 * (long) k;
    double *in = b->scratch, *out = in + size;
    for (int l = 0; l < m; l++) {
      turned_back(R, r + w * member[l], in + 3 * l);
      for (int d = 0; d < 3; d++) {
        in[3 * l + d] *= b->root[member[l]];
        out[3 * l + d] = 0.0;
      }
    }
    for (int q = 0; q < size; q++) {
      const double *column = A + (long) size * q, v = in[q];
      for (int p = 0; p < size; p++) out[p] += column[p] * v;
    }
    for (int l = 0; l < m; l++) {
      double *f = out + 3 * l;
      for (int d = 0; d < 3; d++) f[d] *= b->root[member[l]];
      turned(R, f, z + w * member[l]);
    }
  }
  if (b->rigid) couple(b, z, w);
  torques(b->width, b->drag, b->spin, b->n, r, z);
}
