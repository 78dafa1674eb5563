/* clump_resistance FILE [shell n] [rotation yes|no] [visc eta] [memory bytes] [digits n]
 *
 * Resistance and mobility of the rigid clump in FILE, from the core of the plugin, without LAMMPS. FILE is a LAMMPS
 * molecule file (sections Coords and Diameters) or a list of spheres, x y z radius a line, separated by blanks or
 * commas; '-' is standard input. Everything comes out in the units of the input. */
#define _POSIX_C_SOURCE 199309L

#include "sd_clump.h"
#include "sd_linear.h"
#include "sd_tensor.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static void stop(const char *what, const char *detail)
{
  fprintf(stderr, "clump_resistance: %s%s%s\n", what, detail ? ": " : "", detail ? detail : "");
  exit(1);
}

/* --- input ------------------------------------------------------------------------------------------------------- */

typedef struct {
  int n, capacity;
  double *x, *a;
} spheres;

static void reserve(spheres *s, int n)
{
  if (n <= s->capacity) return;
  s->capacity = n > 2 * s->capacity ? n : 2 * s->capacity;
  s->x = realloc(s->x, sizeof(double) * 3 * (size_t) s->capacity);
  s->a = realloc(s->a, sizeof(double) * (size_t) s->capacity);
  if (!s->x || !s->a) stop("out of memory", NULL);
}

/* Numbers of a line, comments cut off; -1 if there is a word in it */
static int numbers(char *line, double *v, int most)
{
  int n = 0;
  char *p = line, *end;
  p[strcspn(p, "#\r\n")] = 0;
  for (;; n++) {
    p += strspn(p, " \t,;");
    if (!*p) return n;
    const double value = strtod(p, &end);
    if (end == p || n == most) return -1;
    v[n] = value;
    p = end;
  }
}

/* LAMMPS molecule file: a title, "N atoms", sections. Returns 0 if it is none. */
static int read_molecule(FILE *f, spheres *s)
{
  char line[1024], word[64];
  enum { NONE, COORDS, DIAMETERS } section = NONE;
  int atoms = 0, coords = 0, diameters = 0;
  if (!fgets(line, sizeof(line), f)) return 0;
  while (fgets(line, sizeof(line), f)) {
    double v[8];
    char copy[1024];
    strcpy(copy, line);
    const int n = numbers(copy, v, 8);
    if (n == 0) continue;
    if (n < 0) {
      if (sscanf(line, "%d %63s", &atoms, word) == 2 && !strcmp(word, "atoms")) {
        if (atoms < 1) stop("no atoms", NULL);
        reserve(s, s->n = atoms);
        continue;
      }
      if (sscanf(line, "%63s", word) != 1 || !isalpha((unsigned char) *word)) continue;
      section = !strcmp(word, "Coords") ? COORDS : !strcmp(word, "Diameters") ? DIAMETERS : NONE;
      continue;
    }
    if (section == NONE) continue;
    const int id = (int) v[0];
    if (s->n == 0 || id < 1 || id > s->n || n < (section == COORDS ? 4 : 2))
      stop("molecule file: bad line", line);
    if (section == COORDS) {
      memcpy(s->x + 3 * (id - 1), v + 1, sizeof(double) * 3);
      coords++;
    } else {
      s->a[id - 1] = 0.5 * v[1];
      diameters++;
    }
  }
  if (s->n == 0) return 0;
  if (coords != s->n || diameters != s->n)
    stop("molecule file needs Coords and Diameters of all atoms", NULL);
  return 1;
}

static void read_list(FILE *f, spheres *s)
{
  char line[1024], copy[1024];
  int first = 1;
  while (fgets(line, sizeof(line), f)) {
    double v[8];
    strcpy(copy, line);
    const int n = numbers(copy, v, 8);
    if (n == 0) continue;
    if (n < 0 && first) { /* names of columns */
      first = 0;
      continue;
    }
    first = 0;
    if (n != 4) stop("a line with other than x y z radius", line);
    reserve(s, s->n + 1);
    memcpy(s->x + 3 * s->n, v, sizeof(double) * 3);
    s->a[s->n++] = v[3];
  }
  if (s->n == 0) stop("no spheres", NULL);
}

static spheres read_spheres(const char *name)
{
  /* through memory: standard input cannot be read twice */
  spheres s = {0};
  FILE *f = strcmp(name, "-") ? fopen(name, "r") : stdin, *copy = tmpfile();
  if (!f) stop("cannot read", name);
  if (!copy) stop("cannot make a temporary file", NULL);
  for (int c; (c = getc(f)) != EOF;) putc(c, copy);
  rewind(copy);
  if (!read_molecule(copy, &s)) {
    rewind(copy);
    read_list(copy, &s);
  }
  fclose(copy);
  if (f != stdin) fclose(f);
  return s;
}

/* --- output ------------------------------------------------------------------------------------------------------- */

/* Rounding, of one sign or the other, is not shown. */
static double tidy(double v)
{
  return fabs(v) < 1e-9 ? 0.0 : v;
}

static void print_matrix(const char *title, const double M[36], double scale, int digits)
{
  double largest = 0.0;
  for (int k = 0; k < 36; k++) largest = fmax(largest, fabs(M[k]));
  printf("%s\n", title);
  for (int p = 0; p < 6; p++) {
    for (int q = 0; q < 6; q++) /* rounding is not shown */
      printf(" %*.*g", digits + 7, digits, fabs(M[6 * p + q]) < 1e-12 * largest ? 0.0 : scale * M[6 * p + q]);
    printf("\n");
  }
}

/* Bretherton's B about the axis e, and how much it depends on the direction across e. A free clump in strain turns with
 * slip W = -(R^-1 strain) E; for E = m e + e m its axis turns as B times the strain would turn it. */
static double bretherton(const sd_clump *c, const double inverse[36], const double e[3],
                         double *spread)
{
  double B[2], m[3] = {0, 0, 0}, n[3];
  int least = 0;
  for (int d = 1; d < 3; d++)
    if (fabs(e[d]) < fabs(e[least])) least = d;
  m[least] = 1.0;
  sd_cross(m, e, n);
  const double inv = 1.0 / sqrt(sd_dot(n, n));
  for (int d = 0; d < 3; d++) n[d] *= inv;
  sd_cross(e, n, m); /* n, m, e right-handed */
  for (int k = 0; k < 2; k++) {
    const double E[6] = {2 * m[0] * e[0],           2 * m[1] * e[1],
                         2 * m[2] * e[2],           m[1] * e[2] + m[2] * e[1],
                         m[0] * e[2] + m[2] * e[0], m[0] * e[1] + m[1] * e[0]};
    double load[6], W[3] = {0, 0, 0};
    for (int p = 0; p < 6; p++) {
      load[p] = 0.0;
      for (int q = 0; q < 6; q++) load[p] += c->strain[6 * p + q] * E[q];
    }
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 6; q++) W[p] -= inverse[6 * (p + 3) + q] * load[q];
    B[k] = sd_dot(W, n);
    const double old[3] = {n[0], n[1], n[2]}; /* next: n -> m, m -> -n */
    memcpy(n, m, sizeof(n));
    for (int d = 0; d < 3; d++) m[d] = -old[d];
  }
  *spread = fabs(B[0] - B[1]);
  return 0.5 * (B[0] + B[1]);
}

/* The axis of a block with two equal eigenvalues, its direction in e; 0: none, 3: all equal */
static int axis_of(const double M[36], int block, double e[3])
{
  double A[9], w[3], V[9];
  for (int k = 0; k < 9; k++) A[k] = M[6 * (3 * block + k / 3) + 3 * block + k % 3];
  sd_eigen(3, A, w, V);
  const double small = 1e-6 * fabs(w[0]);
  const int upper = w[0] - w[1] < small, lower = w[1] - w[2] < small;
  if (upper && lower) return 3;
  if (!upper && !lower) return 0;
  for (int d = 0; d < 3; d++) e[d] = V[3 * d + (upper ? 2 : 0)];
  return 1;
}

static void print_tumbling(const sd_clump *c)
{
  double inverse[36], e[3] = {0, 0, 1}, spread;
  sd_pseudo_inverse6(c->R, inverse);
  int axis = axis_of(c->R_centre, 1, e);
  if (axis == 3) axis = axis_of(c->R_centre, 0, e);
  if (axis == 3) {
    const double B = bretherton(c, inverse, e, &spread);
    if (fabs(B) + spread < 1e-6) {
      printf("in shear       turns with the vorticity like a sphere (Bretherton B = 0, aspect "
             "ratio 1)\n");
      return;
    }
  }
  const double B = axis ? bretherton(c, inverse, e, &spread) : 0.0;
  if (!axis || spread > 1e-6) {
    printf("in shear       no axis of symmetry: no single aspect ratio\n");
    return;
  }
  if (e[0] < -1e-9 || (fabs(e[0]) <= 1e-9 && (e[1] < -1e-9 || (fabs(e[1]) <= 1e-9 && e[2] < 0.0))))
    for (int d = 0; d < 3; d++) e[d] = -e[d];
  printf("in shear       axis %.6g %.6g %.6g, Bretherton B %.9g", tidy(e[0]), tidy(e[1]),
         tidy(e[2]), B);
  if (fabs(B) < 1.0 - 1e-9) {
    const double re = sqrt((1.0 + B) / (1.0 - B));
    printf(", effective aspect ratio %.7g, Jeffery period %.7g / shear rate\n", re,
           2.0 * SD_PI * (re + 1.0 / re));
  } else
    printf(": never turns over (aspect ratio %s)\n", B > 0.0 ? "infinite" : "0");
}

static double seconds(void)
{
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double) t.tv_sec + 1e-9 * (double) t.tv_nsec;
}

/* Twice a second; ctx: time of the last line */
static void progress(void *ctx, int solve, int solves, int products)
{
  double *last = ctx;
  if (seconds() < *last + 0.5) return;
  *last = seconds();
  fprintf(stderr, "\rclump_resistance: iterative solve %d of %d, product %d ", solve + 1, solves,
          products + 1);
}

static double positive(const char *keyword, const char *value)
{
  char *end;
  const double v = strtod(value, &end);
  if (*end || end == value || !(v > 0.0) || !isfinite(v)) {
    fprintf(stderr, "clump_resistance: %s must be a number > 0, not %s\n", keyword, value);
    exit(1);
  }
  return v;
}

typedef struct {
  sd_clump_options of_clump;
  double eta;
  int digits;
} wishes;

static wishes read_wishes(int argc, char **argv)
{
  static const char *usage =
      "usage: clump_resistance FILE [shell n] [rotation yes|no] [visc eta] [memory bytes] [digits n]";
  wishes w = {SD_CLUMP_OPTIONS, 1.0, 8};
  w.of_clump.shell = 42;
  w.of_clump.rotation = 1;
  if (argc < 2 || argc % 2) stop(usage, NULL);
  for (int k = 2; k + 1 < argc; k += 2) {
    const char *key = argv[k], *value = argv[k + 1];
    if (!strcmp(key, "shell")) {
      const double n = positive(key, value);
      if (n != floor(n) || n > 1e5 || (n > 1 && n < 12))
        stop("shell must be 1 or a whole number from 12 on, not", value);
      w.of_clump.shell = (int) n;
    } else if (!strcmp(key, "rotation")) {
      if (strcmp(value, "yes") && strcmp(value, "no"))
        stop("rotation must be yes or no, not", value);
      w.of_clump.rotation = !strcmp(value, "yes");
    } else if (!strcmp(key, "visc"))
      w.eta = positive(key, value);
    else if (!strcmp(key, "memory"))
      w.of_clump.memory = positive(key, value);
    else if (!strcmp(key, "digits"))
      w.digits = (int) fmin(positive(key, value), 17.0);
    else
      stop("unknown keyword", key);
  }
  return w;
}

/* The clump, or the end of the program */
static sd_clump create(const sd_shape *shape, const sd_clump_options *o, sd_shells *shells)
{
  sd_clump c;
  sd_clump_need need;
  const sd_status status = sd_clump_create(shape, o, shells, &c, &need);
  if (status == SD_ENOMEMORY) {
    fprintf(stderr,
            "clump_resistance: %ld points need %.3g bytes (dense) or %.3g (iterative), and memory is %.3g\n",
            need.points, need.dense, need.iterative, o->memory);
    exit(1);
  }
  if (status == SD_ESINGULAR) stop("two equal spheres lie at one point, or too nearly so", NULL);
  if (status != SD_OK) stop("no answer", sd_status_string(status));
  if (c.iterations) fprintf(stderr, "\n");
  return c;
}

static void centre_of(const spheres *s, const sd_clump *c, double size, double centre[3])
{
  for (int d = 0; d < 3; d++) {
    centre[d] = 0.0;
    for (int k = 0; k < s->n; k++) centre[d] += s->x[3 * k + d] / s->n;
    centre[d] += c->centre[d];
    if (fabs(centre[d]) < 1e-12 * size) centre[d] = 0.0;
  }
}

/* How it settles in its three main directions, and in the mean of all */
static void print_settling(const sd_clump *c, double eta)
{
  double A[9], w[3], V[9];
  for (int k = 0; k < 9; k++) A[k] = c->mobility[6 * (k / 3) + k % 3];
  sd_eigen(3, A, w, V);
  printf("settling       velocity for a unit force, and beside it the direction\n");
  for (int k = 0; k < 3; k++)
    printf(" %15.10g    %9.6f %9.6f %9.6f\n", w[k] / eta, tidy(V[k]), tidy(V[3 + k]), tidy(V[6 + k]));
  printf(" %15.10g    mean of all orientations\n", 1.0 / (6.0 * SD_PI * eta * c->radius));
}

int main(int argc, char **argv)
{
  wishes wanted = read_wishes(argc, argv);
  sd_clump_options *o = &wanted.of_clump;
  double last_line = seconds(), centre[3];
  o->progress = progress;
  o->progress_ctx = &last_line;

  spheres s = read_spheres(argv[1]);
  sd_shape shape;
  sd_shells shells = {0};
  const double begin = seconds();
  const sd_status status = sd_shape_create(s.n, s.x, s.a, &shape);
  if (status == SD_ENOTFINITE) stop("a coordinate is not a number, or a radius is not > 0", NULL);
  if (status != SD_OK) stop("no answer", sd_status_string(status));
  sd_clump c = create(&shape, o, &shells);

  centre_of(&s, &c, shape.size, centre);
  printf("clump          %d spheres, shell %d%s, %d points, %s, %.3g s\n", s.n,
         sd_shell_size(o->shell),
         o->shell > 1      ? ""
             : o->rotation ? " with rotation"
                           : " without rotation",
         c.points, c.iterations ? "iterative" : "dense", seconds() - begin);
  printf("radius         %.10g (hydrodynamic: the sphere with the clump's mean mobility)\n",
         c.radius);
  printf("centre         %.10g %.10g %.10g (of hydrodynamic stress: all below is about it)\n",
         centre[0], centre[1], centre[2]);
  print_matrix("resistance     rows force, torque; columns velocity, angular velocity", c.R_centre,
               wanted.eta, wanted.digits);
  print_matrix("mobility       rows velocity, angular velocity; columns force, torque", c.mobility,
               1.0 / wanted.eta, wanted.digits);
  print_settling(&c, wanted.eta);
  print_tumbling(&c);

  sd_clump_free(&c);
  sd_shape_free(&shape);
  sd_shells_free(&shells);
  free(s.x);
  free(s.a);
  return 0;
}
