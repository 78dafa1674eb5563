#include "sd_shell.h"

#include "sd_linear.h"
#include "sd_tensor.h"

#include <stdlib.h>
#include <string.h>

/* The largest int that is 6 (mod 12) */
enum { LARGEST = 2147483646 };

int sd_shell_size(int n)
{
  if (n <= 1) return 1;
  if (n < 12) return 12;
  if (n > LARGEST) return LARGEST;
  while (n % 12 != 0 && n % 12 != 2 && n % 12 != 6 && n % 12 != 8) n++;
  return n;
}

/* --- points ----------------------------------------------------------------------------------- */

/* Orbit of p under T_h, appended to out [3n]: sign changes and cyclic permutations. Returns the new
 * n. */
static int append_orbit(const double p[3], double *out, int n)
{
  for (int turn = 0; turn < 3; turn++) {
    const double c[3] = {p[turn], p[(turn + 1) % 3], p[(turn + 2) % 3]};
    if (turn > 0 && p[0] == p[1] && p[1] == p[2]) break;
    for (int s = 0; s < 8; s++) {
      int image = 1; /* a zero has one sign only */
      for (int d = 0; d < 3; d++)
        if ((s >> d & 1) && c[d] == 0.0) image = 0;
      if (!image) continue;
      for (int d = 0; d < 3; d++) out[3 * n + d] = (s >> d & 1) ? -c[d] : c[d];
      n++;
    }
  }
  return n;
}

/* n = 10 * 4^k + 2: the icosahedron, its edges halved k times. Returns 0 if n is no such number or
 * memory is short. */
static int icosahedral(int n, double *out)
{
  int level = 0, size = 12;
  while (size < n) {
    size = 4 * size - 6;
    level++;
  }
  if (size != n) return 0;
  const double golden = 0.5 * (1.0 + sqrt(5.0));
  double vertex[3] = {0.0, 1.0, golden};
  sd_normalize(vertex);
  int count = append_orbit(vertex, out, 0);
  for (int l = 0; l < level; l++) {
    /* Edges of a subdivided icosahedron are its pairs closer than 1.4 times its shortest edge. */
    double least = 4.0;
    for (int j = 1; j < count; j++) least = fmin(least, sd_distance_squared(out, out + 3 * j));
    const int old = count;
    for (int i = 0; i < old; i++)
      for (int j = i + 1; j < old; j++) {
        double m[3];
        if (sd_distance_squared(out + 3 * i, out + 3 * j) > 1.96 * least) continue;
        if (count == n) return 0;
        for (int d = 0; d < 3; d++) m[d] = out[3 * i + d] + out[3 * j + d];
        sd_normalize(m);
        memcpy(out + 3 * count++, m, sizeof(m));
      }
  }
  return count == n;
}

int sd_shell_points(int n, double *p)
{
  return n >= 12 && icosahedral(n, p);
}

/* Orbits of a point set: fixed ones (6, 8), then m on mirror planes (0, y, z), then k general
 * ones. */
typedef struct {
  int six, eight, planar, general;
  double (*p)[3]; /* [planar + general] representatives */
} orbits;

static int shell_spread(const orbits *o, double *out)
{
  const double six[3] = {1.0, 0.0, 0.0}, third = sqrt(1.0 / 3.0), eight[3] = {third, third, third};
  int n = 0;
  if (o->six) n = append_orbit(six, out, n);
  if (o->eight) n = append_orbit(eight, out, n);
  for (int i = 0; i < o->planar + o->general; i++) n = append_orbit(o->p[i], out, n);
  return n;
}

/* Coulomb energy per orbit point of every representative, and the force on it along the sphere (and
 * its mirror plane) */
static double coulomb(const orbits *o, const double *all, int n, double (*force)[3])
{
  double energy = 0.0;
  for (int i = 0; i < o->planar + o->general; i++) {
    const double *p = o->p[i];
    double e = 0.0, f[3] = {0.0, 0.0, 0.0};
    for (int j = 0; j < n; j++) {
      double r[3];
      sd_minus(p, all + 3 * j, r);
      const double sq = sd_dot(r, r);
      if (sq == 0.0) continue;
      const double inv = 1.0 / sqrt(sq), inv3 = inv / sq;
      e += inv;
      for (int d = 0; d < 3; d++) f[d] += r[d] * inv3;
    }
    const double normal = sd_dot(f, p);
    for (int d = 0; d < 3; d++) force[i][d] = f[d] - normal * p[d];
    if (i < o->planar) force[i][0] = 0.0;
    energy += (i < o->planar ? 12.0 : 24.0) * e;
  }
  return energy;
}

/* Steepest descent with a step that grows while the energy falls. all [3n], scratch [2][...] of the
 * caller. */
static double relax(orbits *o, double *all, double (*force)[3], double (*last)[3])
{
  const int m = o->planar + o->general;
  int n = shell_spread(o, all);
  double energy = coulomb(o, all, n, force), step = 0.1 / n;
  for (int k = 0; k < 400 && step > 1e-13; k++) {
    double largest = 0.0;
    memcpy(last, o->p, sizeof(double) * 3 * (size_t) m);
    for (int i = 0; i < m; i++) largest = fmax(largest, sd_dot(force[i], force[i]));
    if (step * sqrt(largest) > 0.3 / sqrt(n)) step = 0.3 / sqrt(n * largest);
    for (int i = 0; i < m; i++) {
      for (int d = 0; d < 3; d++) {
        o->p[i][d] = last[i][d] + step * force[i][d];
        if (i >= o->planar || d > 0)
          o->p[i][d] = fabs(o->p[i][d]); /* an image in the first octant */
      }
      sd_normalize(o->p[i]);
      /* Points on a mirror plane or axis by accident would be fewer than their orbit. */
      for (int d = i < o->planar ? 1 : 0; d < 3; d++) o->p[i][d] = fmax(o->p[i][d], 1e-6);
      sd_normalize(o->p[i]);
    }
    n = shell_spread(o, all);
    const double now = coulomb(o, all, n, force);
    if (now < energy) {
      energy = now;
      step *= 1.2;
    } else {
      memcpy(o->p, last, sizeof(double) * 3 * (size_t) m);
      n = shell_spread(o, all);
      coulomb(o, all, n, force);
      step *= 0.4;
    }
  }
  /* The fixed orbits count in the energy that the others feel; their own does not change. */
  return energy;
}

/* First guess: points of a rank-1 lattice in the first octant, those with x the largest (a third of
 * the octant) */
static void first_guess(orbits *o, int start)
{
  const int m = o->planar + o->general;
  int i = o->planar, k = 1 + 7 * start;
  for (int j = 0; j < o->planar; j++) {
    const double phi = 0.5 * SD_PI * (j + 0.35 + 0.1 * start) / o->planar;
    o->p[j][0] = 0.0;
    o->p[j][1] = cos(phi);
    o->p[j][2] = sin(phi);
  }
  for (; i < m; k++) {
    const double s = fmod(0.7548776662466927 * k, 1.0),
                 phi = 0.5 * SD_PI * fmod(0.5698402909980532 * k, 1.0);
    const double rho = sqrt(1.0 - s * s), p[3] = {rho * cos(phi), rho * sin(phi), s};
    if (p[0] < p[1] || p[0] < p[2]) continue;
    memcpy(o->p[i++], p, sizeof(p));
  }
}

static sd_status even_points(int n, double *out)
{
  orbits o = {.six = n % 12 == 2 || n % 12 == 6, .eight = n % 12 == 2 || n % 12 == 8};
  const int rest = (n - 6 * o.six - 8 * o.eight) / 12; /* = planar + 2 general */
  /* Points of orbits on the three mirror planes: four of an orbit lie on each great circle. A
   * circle in n even points carries sqrt(pi n) of them if they stand in squares, sqrt(sqrt(3)/2 pi
   * n) in triangles: a quarter is 0.44 or 0.41 sqrt(n) orbits. Two more and two fewer are tried as
   * well. */
  const int likely = (int) (0.43 * sqrt(n) + 0.5);
  double best = INFINITY;
  double *scratch = malloc(sizeof(double) * (size_t) (3 * n + 9 * rest + 9));
  if (!scratch) return SD_ENOMEMORY;
  double *all = scratch, (*force)[3] = (double(*)[3])(scratch + 3 * (size_t) n),
         (*last)[3] = force + rest + 1;
  o.p = last + rest + 1;
  for (int planar = rest % 2; planar <= rest; planar += 2) {
    if (abs(planar - likely) > 2) continue;
    o.planar = planar;
    o.general = (rest - planar) / 2;
    for (int start = 0; start < 10; start++) {
      first_guess(&o, start);
      double energy = relax(&o, all, force, last);
      /* Energy of the whole set: the fixed orbits' own share, from their side. */
      double fixed = 0.0;
      const int m = 6 * o.six + 8 * o.eight;
      for (int i = 0; i < m; i++)
        for (int j = 0; j < n; j++)
          if (i != j) fixed += 1.0 / sqrt(sd_distance_squared(all + 3 * i, all + 3 * j));
      energy += fixed;
      if (energy < best) {
        best = energy;
        memcpy(out, all, sizeof(double) * 3 * (size_t) n);
      }
    }
  }
  free(scratch);
  return SD_OK;
}

/* --- calibration ------------------------------------------------------------------------------ */

/* The three mirror planes leave the shell as it is, so forces need solving in one octant only: the image
 * of a point under the sign changes s carries chi(s) s F, with chi = s_x for translation along x, s_x s_y
 * for rotation about z. Components that change sign under a mirror plane on which the point itself lies
 * are zero.
 * How many points the planes make of p; zero [3]: which components of its force they take away */
static int images_of(const double p[3], int rotation, int zero[3])
{
  int count = 1;
  for (int d = 0; d < 3; d++) count *= p[d] == 0.0 ? 1 : 2;
  for (int c = 0; c < 3; c++) {
    zero[c] = 0;
    for (int d = 0; d < 3; d++) {
      const double chi = (d == 0 || (rotation && d == 1)) ? -1.0 : 1.0;
      if (p[d] == 0.0 && chi * (c == d ? -1.0 : 1.0) < 0.0) zero[c] = 1;
    }
  }
  return count;
}

/* block [9] out: velocity at p from the force at q, with those at the images of q */
static void add_up_images(const double p[3], const double q[3], double kappa, int rotation, double block[9])
{
  for (int e = 0; e < 9; e++) block[e] = 0.0;
  for (int s = 0; s < 8; s++) {
    double sign[3], r[3], M[9];
    int image = 1;
    for (int d = 0; d < 3; d++) {
      sign[d] = (s >> d & 1) ? -1.0 : 1.0;
      if (sign[d] < 0.0 && q[d] == 0.0) image = 0;
      r[d] = p[d] - sign[d] * q[d];
    }
    if (!image) continue;
    const double chi = rotation ? sign[0] * sign[1] : sign[0];
    sd_tensor_uf(SD_TENSOR_RPY, r, kappa, kappa, 1.0, M);
    for (int e = 0; e < 9; e++) block[e] += chi * sign[e % 3] * M[e];
  }
}

/* Resistance of a shell of radius 1 with points of radius kappa, eta = 1: translation along x, or
 * rotation about z.
 * octant [3m]: points with x, y, z >= 0; A [9 m m], b [6 m]: scratch */
static sd_status shell_resistance(const double *octant, int m, double kappa, int rotation,
                                  double *A, double *b, double *resistance)
{
  const int n = 3 * m;
  for (int i = 0; i < m; i++) {
    const double *p = octant + 3 * i;
    int zero[3];
    const int size = images_of(p, rotation, zero);
    const double u[3] = {rotation ? -p[1] : 1.0, rotation ? p[0] : 0.0, 0.0};
    for (int c = 0; c < 3; c++) b[3 * i + c] = zero[c] ? 0.0 : size * u[c];
    for (int j = i; j < m; j++) {
      double block[9];
      add_up_images(p, octant + 3 * j, kappa, rotation, block);
      for (int c = 0; c < 3; c++)
        for (int e = 0; e < 3; e++)
          A[(size_t) (3 * i + c) * n + 3 * j + e] = size * block[3 * c + e];
    }
    for (int c = 0; c < 3; c++) {
      if (!zero[c]) continue;
      /* rows from k on are upper triangle only: later ones do not touch column k */
      const int k = 3 * i + c;
      for (int l = 0; l < n; l++) A[(size_t) k * n + l] = A[(size_t) l * n + k] = 0.0;
      A[(size_t) k * n + k] = 1.0;
    }
  }
  double total = 0.0;
  double *u = b + n;
  memcpy(u, b, sizeof(double) * (size_t) n);
  const sd_status status = sd_cholesky_solve(n, A, 1, b);
  for (int k = 0; k < n; k++) total += u[k] * b[k];
  *resistance = total;
  return status;
}

/* T^3/Q - 27 pi^2, relative; T itself comes out too */
static sd_status mismatch(const double *octant, int m, double kappa, double *A, double *b,
                          double *T, double *g)
{
  double Q;
  *g = 0.0;
  sd_status status = shell_resistance(octant, m, kappa, 0, A, b, T);
  if (status == SD_OK) status = shell_resistance(octant, m, kappa, 1, A, b, &Q);
  if (status == SD_OK) *g = *T * *T * *T / (27.0 * SD_PI * SD_PI * Q) - 1.0;
  return status;
}

/* By secants. The mismatch rises with kappa through its first root near kappa = 1.1/sqrt(n), where the
 * points do not overlap yet, and falls through a second one, which is the icosahedron's
 * (sd_shell.h). */
static sd_status calibrate(sd_shell *shell)
{
  const int n = shell->n;
  double *octant = malloc(sizeof(double) * 3 * (size_t) n);
  if (!octant) return SD_ENOMEMORY;
  int m = 0;
  for (int i = 0; i < n; i++) {
    const double *p = shell->p + 3 * i;
    if (p[0] >= 0.0 && p[1] >= 0.0 && p[2] >= 0.0) memcpy(octant + 3 * m++, p, 3 * sizeof(double));
  }
  double *A = malloc(sizeof(double) * (9 * (size_t) m * m + 6 * (size_t) m));
  if (!A) {
    free(octant);
    return SD_ENOMEMORY;
  }
  double *b = A + 9 * (size_t) m * m, T = 0.0, g = 0.0, last_g = 0.0;
  double kappa = n == SD_SHELL_FAT ? 0.86 : 1.1 / sqrt(n), last = 1.02 * kappa;
  sd_status status = mismatch(octant, m, last, A, b, &T, &last_g);
  if (status == SD_OK) status = mismatch(octant, m, kappa, A, b, &T, &g);
  for (int k = 0; k < 30 && status == SD_OK && g != last_g && fabs(kappa - last) > 1e-13 * kappa;
       k++) {
    const double step = -g * (kappa - last) / (g - last_g);
    last = kappa;
    last_g = g;
    kappa += step;
    status = mismatch(octant, m, kappa, A, b, &T, &g);
  }
  if (status == SD_OK && !(fabs(g) < 1e-10)) status = SD_ESINGULAR;
  shell->radius = 6.0 * SD_PI / T;
  shell->point = kappa * shell->radius;
  free(A);
  free(octant);
  return status;
}

sd_status sd_shell_create(int n_wanted, sd_shell *shell)
{
  const int n = sd_shell_size(n_wanted);
  *shell =
      (sd_shell){.n = n, .radius = 0.0, .point = 1.0, .p = calloc(3 * (size_t) n, sizeof(double))};
  if (!shell->p) return SD_ENOMEMORY;
  if (n == 1) return SD_OK;
  sd_status status = icosahedral(n, shell->p) ? SD_OK : even_points(n, shell->p);
  if (status == SD_OK) status = calibrate(shell);
  if (status != SD_OK) sd_shell_free(shell);
  return status;
}

void sd_shell_free(sd_shell *shell)
{
  free(shell->p);
  *shell = (sd_shell){0};
}

void sd_shells_free(sd_shells *cache)
{
  for (int i = 0; i < cache->count; i++) sd_shell_free(cache->shell + i);
  free(cache->shell);
  *cache = (sd_shells){0};
}
