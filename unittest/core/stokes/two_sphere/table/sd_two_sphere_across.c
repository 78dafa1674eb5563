#include <math.h>
#include <string.h>

#include "sd_two_sphere_modes_internal.h"

/* Motions across the axis, sphere moving along x or spinning about y:
 *
 *   v = r p/2 + w,   p = P cos phi,   w_z = W cos phi,   w_x = U + Q cos 2 phi,   w_y = Q sin 2 phi
 *
 * with harmonic P = S sin t sum p_n P_n', W = S sin t sum w_n P_n', U = S sum u_n P_n and Q = S
 * sin^2 t sum q_n P_n'', S = (cosh xi - m)^(1/2) (after Dean & O'Neill 1963, O'Neill & Majumdar
 * 1970). No slip on a sphere with its centre at z_s:
 *
 *   W + z P/2 = -w_y rho,   U + rho P/4 = u_x + w_y (z - z_s),   Q + rho P/4 = 0
 *
 * times (cosh xi - m)/S, with the recurrences of m P_n and its derivatives, couples a mode to its
 * neighbours. div v = 0 is 3P/2 + (r.grad P)/2 + dW/dz + dU/drho + dQ/drho + 2Q/rho = 0; each of
 * these maps bispherical harmonics to such, and parts + and - fulfil it by themselves. With it a
 * mode has four unknowns and four equations a sphere.
 *
 * The unknowns are scaled to be of one size: k^2 p, k w, u, k^2 q. */
enum { P, W, U, Q, FAMILIES, UNKNOWNS = 2 * FAMILIES, MOTIONS = 4 };

typedef struct {
  /* cosh and sinh of xi on the sphere (sinh < 0 on sphere 2), its |xi|, z of its centre */
  sd_real ch, sh, g, z;
} sphere;

/* One row of equations of mode n for the unknowns of modes n - 1, n, n + 1 */
typedef sd_real triple[3][FAMILIES];

/* No slip, rows W U Q, all at one xi: unknowns are what the family is there, in n's own scale. */
static void no_slip(int n, const sphere *s, triple row[FAMILIES])
{
  const sd_real k = n + 0.5L, below = 0.5L / (k - 1.0L), above = 0.5L / (k + 1.0L);
  memset(row, 0, FAMILIES * sizeof(triple));
  row[W][0][W] = -(n - 1) * below;
  row[W][1][W] = s->ch;
  row[W][2][W] = -(n + 2) * above;
  row[W][1][P] = 0.5L * s->sh;
  row[U][0][U] = -n * below;
  row[U][1][U] = s->ch;
  row[U][2][U] = -(n + 1) * above;
  row[U][0][P] = -0.25L * n * (n - 1.0L) * below;
  row[U][2][P] = 0.25L * (n + 1.0L) * (n + 2) * above;
  row[Q][0][Q] = -(n - 2) * below;
  row[Q][1][Q] = s->ch;
  row[Q][2][Q] = -(n + 3) * above;
  row[Q][0][P] = 0.25L * below;
  row[Q][2][P] = -0.25L * above;
}

/* div v = 0 for the part of sphere 1 (sign 1) or 2 (sign -1) */
static void continuity(int n, sd_real sign, const sphere *s, triple row)
{
  const sd_real k = n + 0.5L, up = expl(s->g), down = expl(-s->g);
  row[0][P] = -0.25L * (n - 1) * up;
  row[1][P] = 1.25L;
  row[2][P] = 0.25L * (n + 2) * down;
  row[0][W] = -0.5L * sign * (n - 1) * up;
  row[1][W] = sign * k;
  row[2][W] = -0.5L * sign * (n + 2) * down;
  row[0][U] = -0.5L * up;
  row[1][U] = 1.0L;
  row[2][U] = -0.5L * down;
  row[0][Q] = 0.5L * (n - 1.0L) * (n - 2) * up;
  row[1][Q] = -(n - 1.0L) * (n + 2);
  row[2][Q] = 0.5L * (n + 2.0L) * (n + 3) * down;
}

/* what a family's unknown of mode n is over its scaled one */
static sd_real unscaled(int family, int n)
{
  const sd_real k = n + 0.5L;
  return family == U ? 1.0L : family == W ? 1.0L / k : 1.0L / (k * k);
}

/* modes of a family begin at 1 1 0 2 */
static int exists(int family, int n)
{
  return n >= (family == U ? 0 : family == Q ? 2 : 1);
}

/* Block n of the system: sum over b of B[b] x_(n - 1 + b) = rhs, families of +, then of -. Where
 * the other's part is met, it has come through the gap. first: of the unknowns, FAMILIES where
 * there is nothing but sphere 2. */
typedef sd_real block[UNKNOWNS][UNKNOWNS];

static void fill(int n, int first, const sphere s[2], block B[3], triple slip[2][FAMILIES])
{
  sd_real through[3] = {0.0L};
  for (int b = 0; b < 3 && first == 0; b++) through[b] = expl(-(n - 0.5L + b) * (s[0].g + s[1].g));
  memset(B, 0, 3 * sizeof(block));
  for (int i = first / FAMILIES; i < 2; i++) {
    no_slip(n, &s[i], slip[i]);
    continuity(n, i ? -1.0L : 1.0L, &s[i], slip[i][P]);
    for (int f = 0; f < FAMILIES; f++) {
      const int at = FAMILIES * i + f;
      if (!exists(f, n)) {
        B[1][at][at] = 1.0L;
        continue;
      }
      for (int b = 0; b < 3; b++) {
        const int m = n - 1 + b;
        if (m < 0) continue;
        for (int g = 0; g < FAMILIES; g++) {
          const sd_real c = slip[i][f][b][g] * unscaled(g, m) / unscaled(f == P ? U : f, n);
          B[b][at][FAMILIES * i + g] = c;
          if (f != P) B[b][at][FAMILIES * (1 - i) + g] = through[b] * c;
        }
      }
    }
  }
}

/* The right-hand side of a sphere's own motion: rho and 1 in modes. h_n are those of (cosh xi -
 * m)^(1/2). */
static void own_motion(int n, const sphere *s, sd_real along[FAMILIES], sd_real spin[FAMILIES])
{
  const sd_real k = n + 0.5L, e = expl(-k * s->g);
  const sd_real h = -0.5L / SD_ROOT2_LONG *
      (expl(-(k - 1.0L) * s->g) / (k - 1.0L) - expl(-(k + 1.0L) * s->g) / (k + 1.0L));
  memset(along, 0, FAMILIES * sizeof(sd_real));
  memset(spin, 0, FAMILIES * sizeof(sd_real));
  along[U] = h;
  spin[U] = SD_ROOT2_LONG * s->sh * e - s->z * h;
  if (exists(W, n)) spin[W] = 2.0L * h * k;
}

/* Modes - of sphere 2 alone: v = (3a/4)(e_x/r + x r/r^3) + (a^3/4)(e_x/r^3 - 3x r/r^5) about its
 * centre, and a^3 e_y x r/r^3. 1/r has the modes sqrt2 sinh(beta) e^(-2k beta) here, the rest are
 * its derivatives. */
static void alone(int n, const sphere *s, sd_real along[FAMILIES], sd_real spin[FAMILIES])
{
  const sd_real k = n + 0.5L, sh = -s->sh, ch = s->ch, e = SD_ROOT2_LONG * expl(-k * s->g);
  const sd_real ks = k * sh;
  along[P] = 3.0L * sh * sh * e;
  along[W] = ks * sh * e;
  along[U] = (0.75L + 0.5L * ks * ks - ks * ch + 0.25L * ch * ch + 0.125L * sh * sh) * e;
  along[Q] = -0.5L * sh * sh * e;
  spin[P] = spin[Q] = 0.0L;
  spin[W] = -2.0L * e;
  spin[U] = (ch - 2.0L * ks) / sh * e;
  for (int f = 0; f < FAMILIES; f++)
    if (!exists(f, n)) along[f] = spin[f] = 0.0L;
}

/* rhs of mode n: sphere 1 moves with its own no slip, sphere 2 by what its lone flow leaves on
 * sphere 1, where it has come through the gap. */
static void right_hand_side(int n, const sphere s[2], triple slip[2][FAMILIES],
                            sd_real rhs[UNKNOWNS][MOTIONS])
{
  sd_real along[FAMILIES], spin[FAMILIES];
  memset(rhs, 0, UNKNOWNS * sizeof rhs[0]);
  own_motion(n, &s[0], along, spin);
  for (int f = W; f < FAMILIES; f++) {
    rhs[f][0] = along[f];
    rhs[f][2] = spin[f];
  }
  for (int b = n ? 0 : 1; b < 3; b++) {
    const int m = n - 1 + b;
    const sd_real through = expl(-(m + 0.5L) * (s[0].g + s[1].g));
    alone(m, &s[1], along, spin);
    for (int f = W; f < FAMILIES; f++)
      for (int g = 0; g < FAMILIES && exists(f, n); g++) {
        const sd_real c = slip[0][f][b][g] * through / unscaled(f, n);
        rhs[f][1] -= c * along[g];
        rhs[f][3] -= c * spin[g];
      }
  }
}

/* A X = B in place of B; A [UNKNOWNS] from row and column first on, with row pivots */
static void solve(int first, block A, sd_real B[][UNKNOWNS + MOTIONS])
{
  for (int k = first; k < UNKNOWNS; k++) {
    int best = k;
    for (int i = k + 1; i < UNKNOWNS; i++)
      if (fabsl(A[i][k]) > fabsl(A[best][k])) best = i;
    for (int j = first; j < UNKNOWNS; j++) {
      const sd_real t = A[k][j];
      A[k][j] = A[best][j];
      A[best][j] = t;
    }
    for (int j = first; j < UNKNOWNS + MOTIONS; j++) {
      const sd_real t = B[k][j];
      B[k][j] = B[best][j];
      B[best][j] = t;
    }
    for (int i = k + 1; i < UNKNOWNS; i++) {
      const sd_real l = A[i][k] / A[k][k];
      for (int j = k + 1; j < UNKNOWNS; j++) A[i][j] -= l * A[k][j];
      for (int j = first; j < UNKNOWNS + MOTIONS; j++) B[i][j] -= l * B[k][j];
    }
  }
  for (int k = UNKNOWNS - 1; k >= first; k--)
    for (int j = first; j < UNKNOWNS + MOTIONS; j++) {
      for (int i = k + 1; i < UNKNOWNS; i++) B[k][j] -= A[k][i] * B[i][j];
      B[k][j] /= A[k][k];
    }
}

/* From the highest mode down, all that lies above mode n is known as functions of x_n:
 *
 *   x_(n+1) = Z x_n + y,     F of all modes above n = T x_n + t
 *
 * Z [UNKNOWNS], y [MOTIONS] side by side, and so T and t. */
typedef struct {
  sd_real next[UNKNOWNS][UNKNOWNS + MOTIONS], sum[4][UNKNOWNS + MOTIONS];
} above;

/* T += forces F1 F2 and torques T1 T2 about the centres of mode n. Far away P is F x/(4 pi r^3) and
 * W is -T x/(8 pi r^3) about the origin; a mode is 2 sqrt2 rho/r^3 n(n + 1)/2 there. */
static void add_forces(int n, const sphere s[2], sd_real T[4][UNKNOWNS + MOTIONS])
{
  const sd_real k = n + 0.5L;
  for (int i = 0; i < 2; i++) {
    const sd_real weight = 4.0L * SD_PI_LONG * SD_ROOT2_LONG * n * (n + 1.0L) * expl(-k * s[i].g);
    const int at = FAMILIES * i;
    T[i][at + P] += weight * unscaled(P, n);
    T[i + 2][at + P] -= s[i].z * weight * unscaled(P, n);
    T[i + 2][at + W] -= 2.0L * weight * unscaled(W, n);
  }
}

/* from modes above n to modes above n - 1; first: unknowns + are nothing any more */
static void step_down(int n, int first, const sphere s[2], above *a)
{
  block B[3];
  triple slip[2][FAMILIES];
  sd_real rhs[UNKNOWNS][MOTIONS], next[UNKNOWNS][UNKNOWNS + MOTIONS] = {{0.0L}};
  fill(n, first, s, B, slip);
  if (first == 0)
    right_hand_side(n, s, slip, rhs);
  else
    memset(rhs, 0, sizeof rhs);
  for (int i = first; i < UNKNOWNS; i++) {
    for (int j = first; j < UNKNOWNS; j++) {
      next[i][j] = -B[0][i][j];
      for (int l = first; l < UNKNOWNS; l++) B[1][i][j] += B[2][i][l] * a->next[l][j];
    }
    for (int j = 0; j < MOTIONS; j++) {
      next[i][UNKNOWNS + j] = rhs[i][j];
      for (int l = first; l < UNKNOWNS; l++)
        next[i][UNKNOWNS + j] -= B[2][i][l] * a->next[l][UNKNOWNS + j];
    }
  }
  solve(first, B[1], next);
  add_forces(n, s, a->sum);
  for (int i = 0; i < 4; i++) {
    sd_real T[UNKNOWNS + MOTIONS] = {0};
    for (int j = first; j < UNKNOWNS + MOTIONS; j++) {
      if (j >= UNKNOWNS) T[j] = a->sum[i][j];
      for (int l = first; l < UNKNOWNS; l++) T[j] += a->sum[i][l] * next[l][j];
    }
    memcpy(a->sum[i], T, sizeof T);
  }
  for (int i = first; i < UNKNOWNS; i++) memcpy(a->next[i], next[i], sizeof next[i]);
}

void sd_two_sphere_across(sd_real alpha, sd_real beta, sd_real Y[4][4])
{
  const sphere s[2] = {{coshl(alpha), sinhl(alpha), alpha, 1.0L / tanhl(alpha)},
                       {coshl(beta), -sinhl(beta), beta, -1.0L / tanhl(beta)}};
  const int modes = (int) (SD_TWO_SPHERE_DEPTH / (alpha + beta)) + 30;
  const int alone_to = modes + (int) (0.5L * SD_TWO_SPHERE_DEPTH / beta);
  above a;
  memset(&a, 0, sizeof a);
  for (int n = alone_to; n > modes; n--) step_down(n, FAMILIES, s, &a);
  for (int n = modes; n >= 0; n--) step_down(n, 0, s, &a);
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < MOTIONS; j++) Y[i][j] = a.sum[i][UNKNOWNS + j];
  const sd_real a2 = 1.0L / sinhl(beta);
  Y[1][1] += 6.0L * SD_PI_LONG * a2;
  Y[3][3] += 8.0L * SD_PI_LONG * a2 * a2 * a2;
}
