/* How often a pair of spheres, tied by a spring and sheared, is found at a separation r n: the steady
 * Fokker-Planck equation, without sampling. The density is p = w g, w = exp(-U), kT = 1, and
 *
 *   0 = -div(p V) + div(w D grad g)
 *   V_r = r (1 - A) n.E.n,  V_t = r [ W n + (1 - B) (1 - nn) E n ],  D = N_r nn + N_t (1 - nn)
 *
 * in a flow u_x = rate y; A, B, N_r, N_t depend on r. g is a sum of real spherical harmonics of even l
 * and m, by Galerkin, on cells along r, by finite volumes: one block tridiagonal system. */
#ifndef PAIR_DENSITY_H
#define PAIR_DENSITY_H

#include "check.h"

#include "sd_constants.h"

#include <string.h>

enum {
  PAIR_L = 12,
  PAIR_HARMONICS = (PAIR_L / 2 + 1) * (PAIR_L / 2 + 1),
  PAIR_BLOCK = PAIR_HARMONICS * PAIR_HARMONICS
};

/* Of a pair at distance r */
typedef struct {
  double A, B, along, across;
} pair_functions;
typedef pair_functions pair_functions_at(void *ctx, double r);

/* Spring of energy k/2 (r - r0)^2; r is never below `least` */
typedef struct {
  double k, r0, rate, least;
  pair_functions_at *at;
  void *ctx;
} sheared_pair;

/* Means of r, (r - r0)^2, x y, and of the pull of the spring along x times y */
enum { PAIR_R, PAIR_SPREAD, PAIR_XY, PAIR_STRESS, PAIR_MOMENTS };

/* Integrals over the sphere: of Y_a n.E.n Y_b; of Y_b times the change of Y_a along W n, and along
 * (1 - nn) E n */
typedef struct {
  int l[PAIR_HARMONICS];
  double S[PAIR_BLOCK], turn[PAIR_BLOCK], strain[PAIR_BLOCK];
} pair_harmonics;

/* P_lm of cos(theta) = x so that P cos(m phi) sqrt(2) (m = 0: P) is of norm 1 */
static inline double legendre(int l, int m, double x)
{
  double P = sqrt(0.25 / SD_PI), before = 0.0;
  if (l < m) return 0.0;
  for (int k = 1; k <= m; k++) P *= sqrt((2.0 * k + 1.0) / (2.0 * k) * (1.0 - x * x));
  for (int k = m + 1; k <= l; k++) {
    const double now = k * (double) k, last = (k - 1.0) * (k - 1.0), q = m * (double) m;
    const double next = sqrt((4.0 * now - 1.0) / (now - q)) *
        (x * P - sqrt((last - q) / (4.0 * last - 1.0)) * before);
    before = P, P = next;
  }
  return P;
}

/* Y, sin(theta) dY/dtheta, dY/dphi at (x = cos(theta), phi); m < 0: sin(|m| phi) */
static inline void harmonic(int l, int m, double x, double phi, double Y[3])
{
  const int order = abs(m);
  const double norm = m ? sqrt(2.0) : 1.0, P = norm * legendre(l, order, x);
  const double below = l ? sqrt((2.0 * l + 1.0) * (l * l - order * order) / (2.0 * l - 1.0)) : 0.0;
  const double slope = l ? l * x * P - norm * below * legendre(l - 1, order, x) : 0.0;
  const double c = cos(order * phi), s = sin(order * phi);
  Y[0] = P * (m < 0 ? s : c);
  Y[1] = slope * (m < 0 ? s : c);
  Y[2] = order * P * (m < 0 ? c : -s);
}

/* Nodes and weights of Gauss in (-1, 1) */
static inline void gauss(int n, double *x, double *weight)
{
  for (int i = 0; i < n; i++) {
    double at = cos(SD_PI * (i + 0.75) / (n + 0.5)), P = 0.0, slope = 1.0;
    for (int step = 0; step < 50; step++) {
      P = legendre(n, 0, at) / sqrt((2.0 * n + 1.0) / (4.0 * SD_PI));
      const double below = legendre(n - 1, 0, at) / sqrt((2.0 * n - 1.0) / (4.0 * SD_PI));
      slope = n * (at * P - below) / (at * at - 1.0);
      at -= P / slope;
    }
    x[i] = at, weight[i] = 2.0 / ((1.0 - at * at) * slope * slope);
  }
}

static inline void pair_harmonics_create(pair_harmonics *h)
{
  enum { NODES = PAIR_L + 3, TURNS = 2 * PAIR_L + 5 };
  double x[NODES], weight[NODES], Y[PAIR_HARMONICS][3];
  int m[PAIR_HARMONICS], number = 0;
  memset(h, 0, sizeof *h);
  for (int l = 0; l <= PAIR_L; l += 2)
    for (int order = -l; order <= l; order += 2) h->l[number] = l, m[number++] = order;
  assert_int_equal(number, PAIR_HARMONICS);
  gauss(NODES, x, weight);
  for (int node = 0; node < NODES * TURNS; node++) {
    const double z = x[node / TURNS], phi = 2.0 * SD_PI * (node % TURNS) / TURNS;
    const double part = weight[node / TURNS] * 2.0 * SD_PI / TURNS, s = sin(2.0 * phi);
    for (int b = 0; b < number; b++) harmonic(h->l[b], m[b], z, phi, Y[b]);
    for (int ab = 0; ab < PAIR_BLOCK; ab++) {
      const double *of = Y[ab / PAIR_HARMONICS], by = part * Y[ab % PAIR_HARMONICS][0];
      h->S[ab] += by * of[0] * 0.5 * (1.0 - z * z) * s;
      h->turn[ab] -= by * 0.5 * of[2];
      h->strain[ab] += by * 0.5 * (z * s * of[1] + cos(2.0 * phi) * of[2]);
    }
  }
}

/* B [count columns] becomes A^-1 B, with pivots; A is destroyed */
static inline void eliminate(int n, double *A, int count, double *B)
{
  for (int k = 0; k < n; k++) {
    int pivot = k;
    for (int i = k + 1; i < n; i++)
      if (fabs(A[i * n + k]) > fabs(A[pivot * n + k])) pivot = i;
    for (int j = 0; j < n && pivot != k; j++) {
      const double swap = A[k * n + j];
      A[k * n + j] = A[pivot * n + j], A[pivot * n + j] = swap;
    }
    for (int j = 0; j < count && pivot != k; j++) {
      const double swap = B[k * count + j];
      B[k * count + j] = B[pivot * count + j], B[pivot * count + j] = swap;
    }
    const double one = 1.0 / A[k * n + k];
    for (int j = k; j < n; j++) A[k * n + j] *= one;
    for (int j = 0; j < count; j++) B[k * count + j] *= one;
    for (int i = 0; i < n; i++) {
      const double part = A[i * n + k];
      if (i == k || part == 0.0) continue;
      for (int j = k; j < n; j++) A[i * n + j] -= part * A[k * n + j];
      for (int j = 0; j < count; j++) B[i * count + j] -= part * B[k * count + j];
    }
  }
}

/* What goes out through the face at r of a cell of width d: by g of the cells below and above it */
static inline void face(const sheared_pair *p, const pair_harmonics *h, double r, double d,
                        double *below, double *above)
{
  const pair_functions at = p->at(p->ctx, r);
  const double area = r * r * exp(-0.5 * p->k * (r - p->r0) * (r - p->r0));
  for (int ab = 0; ab < PAIR_BLOCK; ab++) {
    const double carried = 0.5 * area * p->rate * r * (1.0 - at.A) * h->S[ab];
    const double spread = ab % (PAIR_HARMONICS + 1) == 0 ? area * at.along / d : 0.0;
    below[ab] = carried + spread, above[ab] = carried - spread;
  }
}

/* What comes into a cell along the sphere, by its g */
static inline void turn_in_cell(const sheared_pair *p, const pair_harmonics *h, double r, double d,
                                double *own)
{
  const pair_functions at = p->at(p->ctx, r);
  const double volume = r * r * d * exp(-0.5 * p->k * (r - p->r0) * (r - p->r0));
  for (int ab = 0; ab < PAIR_BLOCK; ab++) {
    own[ab] = volume * p->rate * (h->turn[ab] + (1.0 - at.B) * h->strain[ab]);
    const int l = h->l[ab / PAIR_HARMONICS];
    if (ab % (PAIR_HARMONICS + 1) == 0) own[ab] -= volume * at.across * l * (l + 1) / (r * r);
  }
}

/* g [cells][harmonics], up to a factor, on cells of width d from r = lo on */
static inline void pair_density_solve(const sheared_pair *p, const pair_harmonics *h, int cells,
                                      double lo, double d, double *g)
{
  enum { H = PAIR_HARMONICS, WIDE = H + 1 };
  const size_t block = sizeof(double) * PAIR_BLOCK;
  double *C = calloc((size_t) cells * H * WIDE, sizeof(double)),
         *faces = calloc(4 * PAIR_BLOCK, sizeof(double));
  double *low[2] = {faces, faces + PAIR_BLOCK},
         *high[2] = {faces + 2 * PAIR_BLOCK, faces + 3 * PAIR_BLOCK};
  double *own = malloc(block);
  for (int i = 0; i < cells;
       i++) { /* own g_i + low g_(i-1) - high g_(i+1) = 0; behind C the right side */
    memcpy(low[0], high[0], block), memcpy(low[1], high[1], block);
    memset(high[0], 0, 2 * block);
    if (i + 1 < cells) face(p, h, lo + (i + 1) * d, d, high[0], high[1]);
    turn_in_cell(p, h, lo + (i + 0.5) * d, d, own);
    double *to = C + (size_t) i * H * WIDE, *last = to - H * WIDE;
    for (int ab = 0; ab < PAIR_BLOCK; ab++) {
      own[ab] += low[1][ab] - high[0][ab];
      to[ab / H * WIDE + ab % H] = high[1][ab];
    }
    if (i == cells / 2) { /* its first row is the sum of all others: g = 1 there in its place */
      memset(own, 0, H * sizeof(double)), memset(low[0], 0, H * sizeof(double)),
          memset(to, 0, WIDE * sizeof(double));
      own[0] = to[H] = 1.0;
    }
    for (int ab = 0; i > 0 && ab < PAIR_BLOCK; ab++) {
      const double part = low[0][ab];
      const int a = ab / H, c = ab % H;
      for (int b = 0; b < H; b++) own[a * H + b] += part * last[c * WIDE + b];
      to[a * WIDE + H] -= part * last[c * WIDE + H];
    }
    eliminate(H, own, WIDE, to);
  }
  for (int i = cells - 1; i >= 0; i--)
    for (int a = 0; a < H; a++) {
      const double *row = C + ((size_t) i * H + (size_t) a) * WIDE;
      g[i * H + a] = row[H];
      for (int b = 0; b < H && i + 1 < cells; b++) g[i * H + a] += row[b] * g[(i + 1) * H + b];
    }
  free(C), free(faces), free(own);
}

/* Within eight standard deviations of the spring */
static inline void pair_density_moments(const sheared_pair *p, int cells, double mean[PAIR_MOMENTS])
{
  const double most = 8.0 / sqrt(p->k), lo = fmax(p->least, p->r0 - most),
               d = (p->r0 + most - lo) / cells;
  pair_harmonics *h = malloc(sizeof *h);
  double *g = malloc(sizeof(double) * PAIR_HARMONICS * (size_t) cells), all = 0.0;
  pair_harmonics_create(h);
  pair_density_solve(p, h, cells, lo, d, g);
  memset(mean, 0, PAIR_MOMENTS * sizeof(double));
  for (int i = 0; i < cells; i++) {
    const double r = lo + (i + 0.5) * d,
                 volume = r * r * exp(-0.5 * p->k * (r - p->r0) * (r - p->r0));
    const double here = volume * g[PAIR_HARMONICS * i];
    double xy = 0.0;
    for (int b = 0; b < PAIR_HARMONICS; b++) xy += volume * h->S[b] * g[PAIR_HARMONICS * i + b];
    all += here;
    mean[PAIR_R] += here * r, mean[PAIR_SPREAD] += here * (r - p->r0) * (r - p->r0);
    mean[PAIR_XY] += xy * r * r, mean[PAIR_STRESS] += xy * r * p->k * (r - p->r0);
  }
  for (int m = 0; m < PAIR_MOMENTS; m++) mean[m] /= all;
  free(g), free(h);
}

#endif
