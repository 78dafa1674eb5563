/* Kernels of spreading and interpolation. Included by sd_ewald_kernels.c. */

/* A row along z is taken in chunks of so many vectors at most, which stay in registers. */
#define MOST_VECTORS (LANES == LANES_OF(64) ? 6 : 4)

/* Numbers of a column and of a row up to whole vectors of any set, since vectors that begin anywhere take
 * twice as long to read */
#define WHOLE(numbers) (((numbers) + 15) / 16 * 16)
enum {
  MOST_COLUMN = WHOLE(SD_WINDOW_COLUMNS + LANES),
  MOST_ROW = WHOLE(3 * SD_WINDOW_COLUMNS + MOST_VECTORS * LANES)
};

/* A spreading in real numbers; points of the window up to whole vectors */
typedef struct {
  int n, width, points, degree, lo[3];
  const int (*corner)[3];
  const real (*place)[4];
  real *F, *brick, metric[6], gradient[3][3];
  real coefficient[SD_WINDOW_TERMS][MOST_COLUMN] ALIGNED(64);
  /* along a row of the grid, where each point has three numbers: the same thrice, and which is whose */
  real thrice[SD_WINDOW_TERMS][MOST_ROW] ALIGNED(64), of[3][MOST_ROW] ALIGNED(64);
  long row, layer;
} spreading;

static void in_reals(const sd_spreading *from, spreading *s)
{
  const sd_window *w = from->window;
  memset(s, 0, sizeof(*s));
  s->n = from->n;
  s->width = from->width;
  s->points = w->points;
  s->degree = w->degree;
  memcpy(s->lo, from->lo, sizeof(s->lo));
  s->corner = from->corner;
  s->place = from->place;
  s->F = from->F;
  s->brick = from->brick;
  s->row = from->row;
  s->layer = from->layer;
  for (int k = 0; k < 6; k++) s->metric[k] = (real) from->metric[k];
  for (int k = 0; k < 9; k++) s->gradient[k / 3][k % 3] = (real) from->gradient[k / 3][k % 3];
  for (int m = 0; m <= w->degree; m++)
    for (int k = 0; k < 3 * w->points; k++)
      s->coefficient[m][k / 3] = s->thrice[m][k] = (real) w->coefficient[m][k / 3];
  for (int k = 0; k < 3 * w->points; k++) s->of[k % 3][k] = 1;
}

/* phi, and with derivatives phi' and phi'', at LANES columns of the coefficients [][stride] from here on; for
 * many, at most 3, values of v, whose polynomials are found side by side. Derivatives with respect to the
 * grid's coordinate: d/ds = -2 d/dv. */
INLINE void window_at(const real *coefficient, int stride, int degree, int derivatives, int many,
                      const vec *v, vec value[][3])
{
  vec f[3], f1[3], f2[3];
#pragma GCC unroll 3
  for (int d = 0; d < many; d++) {
    f[d] = load(coefficient + degree * stride);
    f1[d] = f2[d] = all(0.0);
  }
#pragma GCC unroll 8
  for (int m = degree - 1; m >= 0; m--) {
    const vec next = load(coefficient + m * stride);
#pragma GCC unroll 3
    for (int d = 0; d < many; d++) {
      if (derivatives) {
        f2[d] = f2[d] * v[d] + f1[d];
        f1[d] = f1[d] * v[d] + f[d];
      }
      f[d] = f[d] * v[d] + next;
    }
  }
#pragma GCC unroll 3
  for (int d = 0; d < many; d++) {
    value[d][0] = f[d];
    value[d][1] = all(-2.0) * f1[d];
    value[d][2] = all(8.0) * f2[d]; /* f2 is half the second derivative */
  }
}

/* Windows of a sphere in x, y, z with derivatives */
typedef struct {
  real value[3][MOST_COLUMN] ALIGNED(64), first[3][MOST_COLUMN] ALIGNED(64);
  real second[3][MOST_COLUMN] ALIGNED(64);
} windows;

/* Of the terms of sd_spreading: is the one of unlike radii among them, and those of torques? */
INLINE int unlike(int terms)
{
  return terms == 2 || terms == 4;
}

INLINE int turning(int terms)
{
  return terms >= 3;
}

/* Of sphere i */
INLINE void windows_at(int directions, int terms, const spreading *s, int i, windows *w)
{
  vec v[3], f[3][3];
  for (int d = 0; d < directions; d++) v[d] = all(s->place[i][d]);
  for (int k = 0; k < s->points; k += LANES) {
    window_at(s->coefficient[0] + k, MOST_COLUMN, s->degree, terms > 1, directions, v, f);
    for (int d = 0; d < directions; d++) {
      store(w->value[d] + k, f[d][0]);
      if (turning(terms)) store(w->first[d] + k, f[d][1]);
      if (unlike(terms)) store(w->second[d] + k, f[d][2]);
    }
  }
}

/* sum_t m_t V_t = A_0 phi_y + A_1 phi_y' + A_2 phi_y'': the factors of these at point p of x */
INLINE void factors_of_y(int terms, const spreading *s, const windows *w, int p, const vec V[4], vec A[3])
{
  const real *g = s->metric, x = w->value[0][p];
  A[0] = all(x) * V[0];
  if (unlike(terms)) {
    A[0] += all(g[0] * w->second[0][p]) * V[1];
    A[2] = all(g[1] * x) * V[1];
  }
  if (turning(terms)) {
    A[0] += all(w->first[0][p]) * V[2];
    A[1] = all(x) * V[3];
  }
  if (terms == 4) A[1] += all(2 * g[3] * w->first[0][p]) * V[1];
}

/* The transpose: S_t += what the sums A along y are to m_t */
INLINE void add_factors_of_y(int terms, const spreading *s, const windows *w, int p, const vec A[3], vec S[4])
{
  const real *g = s->metric, x = w->value[0][p];
  S[0] += all(x) * A[0];
  if (unlike(terms)) S[1] += all(g[0] * w->second[0][p]) * A[0] + all(g[1] * x) * A[2];
  if (turning(terms)) {
    S[2] += all(w->first[0][p]) * A[0];
    S[3] += all(x) * A[1];
  }
  if (terms == 4) S[1] += all(2 * g[3] * w->first[0][p]) * A[1];
}

/* What a sphere spreads: F; and of torques, grad w x T / 2 = sum_d dw/dx_d tau_d, tau_d = G_d x T / 2 */
INLINE void strengths(int terms, const spreading *s, const real *F, real to[4][3])
{
  memset(to, 0, sizeof(real[4][3]));
  for (int c = 0; c < 3; c++) to[0][c] = F[c];
  if (!turning(terms) || s->width < 6) return;
  const real half = (real) 0.5, *T = F + 3;
  for (int d = 0; d < 3; d++) {
    const real *G = s->gradient[d];
    to[1 + d][0] = half * (G[1] * T[2] - G[2] * T[1]);
    to[1 + d][1] = half * (G[2] * T[0] - G[0] * T[2]);
    to[1 + d][2] = half * (G[0] * T[1] - G[1] * T[0]);
  }
}

/* LANES numbers of a row [points][3] that has `from` at each point, from `skip` on */
INLINE vec repeated(const spreading *s, int skip, const real *from)
{
  vec row = all(from[0]) * load(s->of[0] + skip);
  for (int c = 1; c < 3; c++) row += all(from[c]) * load(s->of[c] + skip);
  return row;
}

/* LANES numbers of V_t [points][3] of sphere i, from `skip` on */
INLINE void row_of_force(int terms, const spreading *s, int skip, int i, real from[4][3], vec V[4])
{
  const real *g = s->metric;
  const vec b = all(s->place[i][3]), v = all(s->place[i][2]), F = repeated(s, skip, from[0]);
  vec found[1][3];
  window_at(s->thrice[0] + skip, MOST_ROW, s->degree, terms > 1, 1, &v, found);
  const vec *z = found[0];
  V[0] = F * (unlike(terms) ? z[0] + b * all(g[2]) * z[2] : z[0]);
  if (unlike(terms)) V[1] = b * F * z[0];
  if (!turning(terms)) return;
  V[0] += repeated(s, skip, from[3]) * z[1];
  V[2] = repeated(s, skip, from[1]) * z[0];
  V[3] = repeated(s, skip, from[2]) * z[0];
  if (!unlike(terms)) return;
  V[2] += all(2 * g[4]) * b * F * z[1];
  V[3] += all(2 * g[5]) * b * F * z[1];
}

/* The first point of a sphere in the brick, or of several that are taken together */
INLINE real *corner_at(const spreading *s, const int at[3])
{
  return s->brick + (at[0] - s->lo[0]) * s->layer + (at[1] - s->lo[1]) * s->row + 3L * (at[2] - s->lo[2]);
}

/* vectors: of a chunk, the numbers from `skip` on */
INLINE void spread_chunk(int terms, int vectors, const spreading *s, const windows *w, int i, real from[4][3],
                         int skip)
{
  const int points = s->points;
  real *corner = corner_at(s, s->corner[i]) + skip;
  vec v[MOST_VECTORS][4];
#pragma GCC unroll 6
  for (int l = 0; l < vectors; l++) row_of_force(terms, s, skip + LANES * l, i, from, v[l]);
  for (int p = 0; p < points; p++) {
    vec A[MOST_VECTORS][3];
#pragma GCC unroll 6
    for (int l = 0; l < vectors; l++) factors_of_y(terms, s, w, p, v[l], A[l]);
#pragma GCC unroll 4
    for (int q = 0; q < points; q++) {
      real *row = corner + p * s->layer + q * s->row;
#pragma GCC unroll 6
      for (int l = 0; l < vectors; l++) {
        vec sum = load_any(row + LANES * l) + all(w->value[1][q]) * A[l][0];
        if (turning(terms)) sum += all(w->first[1][q]) * A[l][1];
        if (unlike(terms)) sum += all(w->second[1][q]) * A[l][2];
        store_any(row + LANES * l, sum);
      }
    }
  }
}

COPIED void spread_with(int terms, int vectors, int chunks, const spreading *s)
{
  windows w;
  for (int i = 0; i < s->n; i++) {
    real from[4][3];
    windows_at(2, terms, s, i, &w);
    strengths(terms, s, s->F + (long) s->width * i, from);
    for (int c = 0; c < chunks; c++) spread_chunk(terms, vectors, s, &w, i, from, c * vectors * LANES);
  }
}

/* The transpose of row_of_force: U and W from S_t = sum_pq m_t row. Four numbers of a row are taken for
 * three, since four are a vector. */
INLINE void force_of_rows(int terms, const spreading *s, const windows *w, real b,
                          real S[4][MOST_ROW], real *U)
{
  const real *z = w->value[2], *z1 = w->first[2], *z2 = w->second[2], *g = s->metric;
  real sum[4] = {0}, slope[3][4] = {{0}}; /* sum over the grid of w u, and of dw/dx_d u */
  for (int k = 0; k < s->points; k++)
    for (int c = 0; c < 4; c++) {
      const int at = 3 * k + c;
      sum[c] += S[0][at] * z[k];
      if (unlike(terms)) sum[c] += b * (g[2] * S[0][at] * z2[k] + S[1][at] * z[k]);
      if (!turning(terms)) continue;
      if (unlike(terms)) sum[c] += 2 * b * z1[k] * (g[4] * S[2][at] + g[5] * S[3][at]);
      slope[0][c] += S[2][at] * z[k];
      slope[1][c] += S[3][at] * z[k];
      slope[2][c] += S[0][at] * z1[k];
    }
  for (int c = 0; c < 3; c++) U[c] = sum[c];
  if (s->width < 6) return;
  const real half = (real) 0.5;
  real *W = U + 3;
  for (int c = 0; c < 3; c++) W[c] = 0.0;
  for (int d = 0; d < 3; d++) {
    const real *G = s->gradient[d], *A = slope[d];
    W[0] -= half * (G[1] * A[2] - G[2] * A[1]);
    W[1] -= half * (G[2] * A[0] - G[0] * A[2]);
    W[2] -= half * (G[0] * A[1] - G[1] * A[0]);
  }
}

/* A vector that is as long as a line of the cache and begins anywhere takes as long to read as two that begin
 * with lines. So of forces alone whole lines of the brick are read, the first of which begins `within`
 * numbers before the window, and one more than there are vectors. (Spreading, which also writes, is slower
 * so.) */
#if defined(SD_AVX512) && !defined(SD_SINGLE)
enum { IN_LINES = 1 };

/* Lanes first ... first + LANES - 1 of two vectors */
INLINE vec lanes_from(int first, vec a, vec b)
{
  const __m512i lanes = _mm512_setr_epi64(0, 1, 2, 3, 4, 5, 6, 7);
  return _mm512_permutex2var_pd(a, _mm512_add_epi64(_mm512_set1_epi64(first), lanes), b);
}
#else
enum { IN_LINES = 0 };
#define lanes_from(first, a, b) (a)
#endif

INLINE void gather_chunk(int terms, int vectors, const spreading *s, const windows *w,
                         const real *corner, real *S)
{
  const int points = s->points, lines = IN_LINES && terms == 1, all_vectors = vectors + lines;
  const int within = lines ? (int) ((corner - s->brick) % LANES) : 0;
  vec v[MOST_VECTORS + 1][4];
  corner -= within;
#pragma GCC unroll 7
  for (int l = 0; l < all_vectors; l++)
    for (int t = 0; t < 4; t++) v[l][t] = all(0.0);
  for (int p = 0; p < points; p++) {
    vec A[MOST_VECTORS + 1][3];
#pragma GCC unroll 7
    for (int l = 0; l < all_vectors; l++) A[l][0] = A[l][1] = A[l][2] = all(0.0);
#pragma GCC unroll 4
    for (int q = 0; q < points; q++) {
      const real *row = corner + p * s->layer + q * s->row;
#pragma GCC unroll 7
      for (int l = 0; l < all_vectors; l++) {
        const vec u = load_any(row + LANES * l);
        A[l][0] += all(w->value[1][q]) * u;
        if (turning(terms)) A[l][1] += all(w->first[1][q]) * u;
        if (unlike(terms)) A[l][2] += all(w->second[1][q]) * u;
      }
    }
#pragma GCC unroll 7
    for (int l = 0; l < all_vectors; l++) add_factors_of_y(terms, s, w, p, A[l], v[l]);
  }
#pragma GCC unroll 6
  for (int l = 0; l < vectors && lines; l++) v[l][0] = lanes_from(within, v[l][0], v[l + 1][0]);
#pragma GCC unroll 6
  for (int l = 0; l < vectors; l++)
#pragma GCC unroll 4
    for (int t = 0; t < 4; t++) store(S + t * MOST_ROW + LANES * l, v[l][t]);
}

COPIED void interpolate_with(int terms, int vectors, int chunks, const spreading *s)
{
  real S[4][MOST_ROW] ALIGNED(64) = {{0}};
  windows w;
  for (int i = 0; i < s->n; i++) {
    windows_at(3, terms, s, i, &w);
    for (int c = 0; c < chunks; c++) {
      const int skip = c * vectors * LANES;
      gather_chunk(terms, vectors, s, &w, corner_at(s, s->corner[i]) + skip, S[0] + skip);
    }
    force_of_rows(terms, s, &w, s->place[i][3], S, s->F + (long) s->width * i);
  }
}

/* A copy for each number of terms and of vectors in a chunk */
#define OF_VECTORS(call, terms)               \
  switch (vectors) {                          \
    FEW_VECTORS(call, terms)                  \
    case 2: call(terms, 2, chunks, s); break; \
    case 3: call(terms, 3, chunks, s); break; \
    case 4: call(terms, 4, chunks, s); break; \
    MORE_VECTORS(call, terms)                 \
    default: break;                           \
  }
#ifdef SD_SINGLE
#define FEW_VECTORS(call, terms) \
  case 1: call(terms, 1, chunks, s); break;
#else
#define FEW_VECTORS(call, terms)
#endif
#if LANES == LANES_OF(64)
#define MORE_VECTORS(call, terms)             \
    case 5: call(terms, 5, chunks, s); break; \
    case 6: call(terms, 6, chunks, s); break;
#else
#define MORE_VECTORS(call, terms)
#endif
#define OF_TERMS(call)                                                  \
  do {                                                                  \
    const int wide = (3 * asked->window->points + LANES - 1) / LANES;   \
    const int chunks = (wide + MOST_VECTORS - 1) / MOST_VECTORS;        \
    const int vectors = (wide + chunks - 1) / chunks;                   \
    spreading in;                                                       \
    const spreading *s = &in;                                           \
    in_reals(asked, &in);                                               \
    if (asked->terms == 1) OF_VECTORS(call, 1)                              \
    else if (asked->terms == 2) OF_VECTORS(call, 2)                         \
    else if (asked->terms == 3) OF_VECTORS(call, 3)                         \
    else OF_VECTORS(call, 4)                                            \
  } while (0)

static void spread(const sd_spreading *asked)
{
  OF_TERMS(spread_with);
}

static void interpolate(const sd_spreading *asked)
{
  OF_TERMS(interpolate_with);
}
