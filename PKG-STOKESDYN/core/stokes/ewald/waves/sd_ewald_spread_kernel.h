/* Kernels of spreading and interpolation. Included by sd_ewald_kernels.c. */

/* A row along z is taken in chunks of so many vectors at most, which stay in registers. */
#define MOST_VECTORS (LANES == 8 ? 6 : 4)

enum {
  MOST_POINTS = SD_WINDOW_COLUMNS,
  MOST_ROW = (3 * MOST_POINTS + MOST_VECTORS * LANES + 7) / 8 * 8
};

/* phi, and with derivatives phi' and phi'', at the points of one direction; derivatives with
 * respect to the grid's coordinate: d/ds = -2 d/dv. */
INLINE void window_at(const sd_window *w, double v_, int derivatives, double *value, double *first,
                      double *second)
{
  const vec v = all(v_);
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
  double value[3][MOST_POINTS + LANES], first[3][MOST_POINTS + LANES],
      second[3][MOST_POINTS + LANES];
} windows;

INLINE void windows_at(int terms, const sd_spreading *s, const sd_spread_place *at, windows *w)
{
  for (int d = 0; d < 3; d++)
    window_at(s->window, at->v[d], terms > 1, w->value[d], w->first[d], w->second[d]);
}

/* m_t at point p of x, q of y */
INLINE void factors(int terms, const sd_spreading *s, const windows *w, int p, int q, double *m)
{
  const double *g = s->metric, x = w->value[0][p], y = w->value[1][q];
  m[0] = x * y;
  if (terms == 1) return;
  const double xx = w->second[0][p], yy = w->second[1][q];
  m[1] = g[0] * xx * y + g[1] * x * yy;
  if (terms == 2) return;
  const double x1 = w->first[0][p], y1 = w->first[1][q];
  m[1] += 2.0 * g[3] * x1 * y1;
  m[2] = x1 * y;
  m[3] = x * y1;
}

/* V_t [points][3]. Torques: grad w x T / 2 = sum_d dw/dx_d tau_d, tau_d = G_d x T / 2. */
INLINE void rows_of_force(int terms, const sd_spreading *s, const windows *w, const double *F,
                          double b, double V[4][MOST_ROW])
{
  const double *z = w->value[2], *z1 = w->first[2], *z2 = w->second[2], *g = s->metric;
  double tau[3][3] = {{0.0}};
  if (terms == 4 && s->width == 6)
    for (int d = 0; d < 3; d++) {
      const double *G = s->gradient[d], *T = F + 3;
      tau[d][0] = 0.5 * (G[1] * T[2] - G[2] * T[1]);
      tau[d][1] = 0.5 * (G[2] * T[0] - G[0] * T[2]);
      tau[d][2] = 0.5 * (G[0] * T[1] - G[1] * T[0]);
    }
  for (int k = 0; k < s->window->points; k++)
    for (int c = 0; c < 3; c++) {
      double *at = &V[0][3 * k + c];
      if (terms == 1) {
        *at = F[c] * z[k];
        continue;
      }
      *at = F[c] * (z[k] + b * g[2] * z2[k]);
      at[MOST_ROW] = b * F[c] * z[k];
      if (terms == 2) continue;
      *at += tau[2][c] * z1[k];
      at[2 * MOST_ROW] = tau[0][c] * z[k] + 2.0 * b * g[4] * F[c] * z1[k];
      at[3 * MOST_ROW] = tau[1][c] * z[k] + 2.0 * b * g[5] * F[c] * z1[k];
    }
}

/* The first point of a sphere in the brick */
INLINE double *corner_of(const sd_spreading *s, const sd_spread_place *at)
{
  return s->brick + (at->at[0] - s->lo[0]) * s->layer + (at->at[1] - s->lo[1]) * s->row +
         3L * (at->at[2] - s->lo[2]);
}

/* vectors: of a chunk */
INLINE void spread_chunk(int terms, int vectors, const sd_spreading *s, const windows *w,
                         const double *V, double *corner)
{
  const int points = s->window->points;
  vec v[4][MOST_VECTORS];
#pragma GCC unroll 4
  for (int t = 0; t < terms; t++)
#pragma GCC unroll 6
    for (int l = 0; l < vectors; l++) v[t][l] = load_any(V + t * MOST_ROW + LANES * l);
  for (int p = 0; p < points; p++)
    for (int q = 0; q < points; q++) {
      double *row = corner + p * s->layer + q * s->row, m[4];
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

INLINE void spread_with(int terms, int vectors, int chunks, const sd_spreading *s)
{
  double V[4][MOST_ROW] = {{0.0}}; /* beyond the points it stays 0 */
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
INLINE void force_of_rows(int terms, const sd_spreading *s, const windows *w, double b,
                          double S[4][MOST_ROW], double *U)
{
  const double *z = w->value[2], *z1 = w->first[2], *z2 = w->second[2], *g = s->metric;
  double slope[3][3] = {{0.0}}; /* sum over the grid of dw/dx_d u */
  for (int c = 0; c < 3; c++) U[c] = 0.0;
  for (int k = 0; k < s->window->points; k++)
    for (int c = 0; c < 3; c++) {
      const int at = 3 * k + c;
      if (terms == 1) {
        U[c] += S[0][at] * z[k];
        continue;
      }
      U[c] += S[0][at] * (z[k] + b * g[2] * z2[k]) + S[1][at] * b * z[k];
      if (terms == 2) continue;
      U[c] += 2.0 * b * z1[k] * (g[4] * S[2][at] + g[5] * S[3][at]);
      slope[0][c] += S[2][at] * z[k];
      slope[1][c] += S[3][at] * z[k];
      slope[2][c] += S[0][at] * z1[k];
    }
  if (s->width < 6) return;
  double *W = U + 3;
  for (int c = 0; c < 3; c++) W[c] = 0.0;
  for (int d = 0; d < 3; d++) {
    const double *G = s->gradient[d], *A = slope[d];
    W[0] -= 0.5 * (G[1] * A[2] - G[2] * A[1]);
    W[1] -= 0.5 * (G[2] * A[0] - G[0] * A[2]);
    W[2] -= 0.5 * (G[0] * A[1] - G[1] * A[0]);
  }
}

INLINE void gather_chunk(int terms, int vectors, const sd_spreading *s, const windows *w,
                         const double *corner, double *S)
{
  const int points = s->window->points;
  vec v[4][MOST_VECTORS];
#pragma GCC unroll 4
  for (int t = 0; t < terms; t++)
#pragma GCC unroll 6
    for (int l = 0; l < vectors; l++) v[t][l] = all(0.0);
  for (int p = 0; p < points; p++)
    for (int q = 0; q < points; q++) {
      const double *row = corner + p * s->layer + q * s->row;
      double m[4];
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

INLINE void interpolate_with(int terms, int vectors, int chunks, const sd_spreading *s)
{
  double S[4][MOST_ROW];
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
    case 2: call(terms, 2, chunks, s); break; \
    case 3: call(terms, 3, chunks, s); break; \
    case 4: call(terms, 4, chunks, s); break; \
    MORE_VECTORS(call, terms)                 \
    default: break;                           \
  }
#if LANES == 8
#define MORE_VECTORS(call, terms)             \
    case 5: call(terms, 5, chunks, s); break; \
    case 6: call(terms, 6, chunks, s); break;
#else
#define MORE_VECTORS(call, terms)
#endif
#define OF_TERMS(call)                                                  \
  do {                                                                  \
    const int wide = (3 * s->window->points + LANES - 1) / LANES;       \
    const int chunks = (wide + MOST_VECTORS - 1) / MOST_VECTORS;        \
    const int vectors = (wide + chunks - 1) / chunks;                   \
    if (s->terms == 1) OF_VECTORS(call, 1)                              \
    else if (s->terms == 2) OF_VECTORS(call, 2)                         \
    else OF_VECTORS(call, 4)                                            \
  } while (0)

static void spread(const sd_spreading *s)
{
  OF_TERMS(spread_with);
}

static void interpolate(const sd_spreading *s)
{
  OF_TERMS(interpolate_with);
}
