/* Kernels of spreading and interpolation. Included by sd_ewald_kernels.c. */

/* A row along z is taken in chunks of so many vectors at most, which stay in registers. */
#define MOST_VECTORS (LANES == LANES_OF(64) ? 6 : 4)

enum {
  MOST_POINTS = SD_WINDOW_COLUMNS,
  MOST_ROW = (3 * MOST_POINTS + MOST_VECTORS * LANES + 7) / 8 * 8
};

/* A spreading in real numbers; points of the window up to whole vectors */
typedef struct {
  int n, width, points, degree, lo[3];
  const sd_spread_place *place;
  real *F, *brick, metric[6], gradient[3][3], coefficient[SD_WINDOW_TERMS][MOST_POINTS + LANES];
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
  s->place = from->place;
  s->F = from->F;
  s->brick = from->brick;
  s->row = from->row;
  s->layer = from->layer;
  for (int k = 0; k < 6; k++) s->metric[k] = (real) from->metric[k];
  for (int k = 0; k < 9; k++) s->gradient[k / 3][k % 3] = (real) from->gradient[k / 3][k % 3];
  for (int m = 0; m <= w->degree; m++)
    for (int k = 0; k < w->points; k++) s->coefficient[m][k] = (real) w->coefficient[m][k];
}

/* phi, and with derivatives phi' and phi'', at the points of one direction; derivatives with
 * respect to the grid's coordinate: d/ds = -2 d/dv. */
INLINE void window_at(const spreading *w, double v_, int derivatives, real *value, real *first,
                      real *second)
{
  const vec v = all((real) v_);
  for (int k = 0; k < w->points; k += LANES) {
    vec f = load_any(w->coefficient[w->degree] + k), f1 = all(0.0), f2 = f1;
    for (int m = w->degree - 1; m >= 0; m--) {
      if (derivatives) {
        f2 = f2 * v + f1;
        f1 = f1 * v + f;
      }
      f = f * v + load_any(w->coefficient[m] + k);
    }
    store_any(value + k, f);
    if (derivatives) {
      store_any(first + k, all(-2.0) * f1);
      store_any(second + k, all(8.0) * f2); /* f2 is half the second derivative */
    }
  }
}

/* Windows of a sphere in x, y, z with derivatives */
typedef struct {
  real value[3][MOST_POINTS + LANES], first[3][MOST_POINTS + LANES],
      second[3][MOST_POINTS + LANES];
} windows;

INLINE void windows_at(int terms, const spreading *s, const sd_spread_place *at, windows *w)
{
  for (int d = 0; d < 3; d++)
    window_at(s, at->v[d], terms > 1, w->value[d], w->first[d], w->second[d]);
}

/* m_t at point p of x, q of y */
INLINE void factors(int terms, const spreading *s, const windows *w, int p, int q, real *m)
{
  const real *g = s->metric, x = w->value[0][p], y = w->value[1][q];
  m[0] = x * y;
  if (terms == 1) return;
  const real xx = w->second[0][p], yy = w->second[1][q];
  m[1] = g[0] * xx * y + g[1] * x * yy;
  if (terms == 2) return;
  const real x1 = w->first[0][p], y1 = w->first[1][q];
  m[1] += 2 * g[3] * x1 * y1;
  m[2] = x1 * y;
  m[3] = x * y1;
}

/* V_t [points][3]. Torques: grad w x T / 2 = sum_d dw/dx_d tau_d, tau_d = G_d x T / 2. */
INLINE void rows_of_force(int terms, const spreading *s, const windows *w, const real *F,
                          real b, real V[4][MOST_ROW])
{
  const real *z = w->value[2], *z1 = w->first[2], *z2 = w->second[2], *g = s->metric;
  const real half = (real) 0.5;
  real tau[3][3] = {{0}};
  if (terms == 4 && s->width == 6)
    for (int d = 0; d < 3; d++) {
      const real *G = s->gradient[d], *T = F + 3;
      tau[d][0] = half * (G[1] * T[2] - G[2] * T[1]);
      tau[d][1] = half * (G[2] * T[0] - G[0] * T[2]);
      tau[d][2] = half * (G[0] * T[1] - G[1] * T[0]);
    }
  for (int k = 0; k < s->points; k++)
    for (int c = 0; c < 3; c++) {
      real *at = &V[0][3 * k + c];
      if (terms == 1) {
        *at = F[c] * z[k];
        continue;
      }
      *at = F[c] * (z[k] + b * g[2] * z2[k]);
      at[MOST_ROW] = b * F[c] * z[k];
      if (terms == 2) continue;
      *at += tau[2][c] * z1[k];
      at[2 * MOST_ROW] = tau[0][c] * z[k] + 2 * b * g[4] * F[c] * z1[k];
      at[3 * MOST_ROW] = tau[1][c] * z[k] + 2 * b * g[5] * F[c] * z1[k];
    }
}

/* The first point of a sphere in the brick */
INLINE real *corner_of(const spreading *s, const sd_spread_place *at)
{
  return s->brick + (at->at[0] - s->lo[0]) * s->layer + (at->at[1] - s->lo[1]) * s->row +
         3L * (at->at[2] - s->lo[2]);
}

/* vectors: of a chunk */
INLINE void spread_chunk(int terms, int vectors, const spreading *s, const windows *w,
                         const real *V, real *corner)
{
  const int points = s->points;
  vec v[4][MOST_VECTORS];
#pragma GCC unroll 4
  for (int t = 0; t < terms; t++)
#pragma GCC unroll 6
    for (int l = 0; l < vectors; l++) v[t][l] = load_any(V + t * MOST_ROW + LANES * l);
  for (int p = 0; p < points; p++)
    for (int q = 0; q < points; q++) {
      real *row = corner + p * s->layer + q * s->row, m[4];
      factors(terms, s, w, p, q, m);
#pragma GCC unroll 6
      for (int l = 0; l < vectors; l++) {
        vec sum = load_any(row + LANES * l);
#pragma GCC unroll 4
        for (int t = 0; t < terms; t++) sum += all(m[t]) * v[t][l];
        store_any(row + LANES * l, sum);
      }
    }
}

INLINE void spread_with(int terms, int vectors, int chunks, const spreading *s)
{
  real V[4][MOST_ROW] = {{0}}; /* beyond the points it stays 0 */
  windows w;
  for (int i = 0; i < s->n; i++) {
    const sd_spread_place *at = s->place + i;
    windows_at(terms, s, at, &w);
    rows_of_force(terms, s, &w, s->F + (long) s->width * i, at->b, V);
    for (int c = 0; c < chunks; c++) {
      const int skip = c * vectors * LANES;
      spread_chunk(terms, vectors, s, &w, V[0] + skip, corner_of(s, at) + skip);
    }
  }
}

/* The transpose of rows_of_force: U and W from S_t = sum_pq m_t row. */
INLINE void force_of_rows(int terms, const spreading *s, const windows *w, real b,
                          real S[4][MOST_ROW], real *U)
{
  const real *z = w->value[2], *z1 = w->first[2], *z2 = w->second[2], *g = s->metric;
  real slope[3][3] = {{0}}; /* sum over the grid of dw/dx_d u */
  for (int c = 0; c < 3; c++) U[c] = 0.0;
  for (int k = 0; k < s->points; k++)
    for (int c = 0; c < 3; c++) {
      const int at = 3 * k + c;
      if (terms == 1) {
        U[c] += S[0][at] * z[k];
        continue;
      }
      U[c] += S[0][at] * (z[k] + b * g[2] * z2[k]) + S[1][at] * b * z[k];
      if (terms == 2) continue;
      U[c] += 2 * b * z1[k] * (g[4] * S[2][at] + g[5] * S[3][at]);
      slope[0][c] += S[2][at] * z[k];
      slope[1][c] += S[3][at] * z[k];
      slope[2][c] += S[0][at] * z1[k];
    }
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

INLINE void gather_chunk(int terms, int vectors, const spreading *s, const windows *w,
                         const real *corner, real *S)
{
  const int points = s->points;
  vec v[4][MOST_VECTORS];
#pragma GCC unroll 4
  for (int t = 0; t < terms; t++)
#pragma GCC unroll 6
    for (int l = 0; l < vectors; l++) v[t][l] = all(0.0);
  for (int p = 0; p < points; p++)
    for (int q = 0; q < points; q++) {
      const real *row = corner + p * s->layer + q * s->row;
      real m[4];
      factors(terms, s, w, p, q, m);
#pragma GCC unroll 6
      for (int l = 0; l < vectors; l++) {
        const vec u = load_any(row + LANES * l);
#pragma GCC unroll 4
        for (int t = 0; t < terms; t++) v[t][l] += all(m[t]) * u;
      }
    }
#pragma GCC unroll 4
  for (int t = 0; t < terms; t++)
#pragma GCC unroll 6
    for (int l = 0; l < vectors; l++) store_any(S + t * MOST_ROW + LANES * l, v[t][l]);
}

INLINE void interpolate_with(int terms, int vectors, int chunks, const spreading *s)
{
  real S[4][MOST_ROW];
  windows w;
  for (int i = 0; i < s->n; i++) {
    const sd_spread_place *at = s->place + i;
    windows_at(terms, s, at, &w);
    for (int c = 0; c < chunks; c++) {
      const int skip = c * vectors * LANES;
      gather_chunk(terms, vectors, s, &w, corner_of(s, at) + skip, S[0] + skip);
    }
    force_of_rows(terms, s, &w, at->b, S, s->F + (long) s->width * i);
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
