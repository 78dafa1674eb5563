#include "sd_body_shape.h"

#include "sd_dense_internal.h"
#include "sd_linear.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Row (k, p) of K: e_p.(U + W x X) = e_p.U + (X x e_p).W for p < 3, and W_p for the spins. */
static void shape_rigid_row(const double X[3], int p, double row[6])
{
  memset(row, 0, 6 * sizeof(double));
  row[p] = 1.0;
  if (p >= 3) return;
  const double e[3] = {p == 0, p == 1, p == 2};
  sd_cross(X, e, row + 3);
}

void sd_body_shape_answer(const sd_body_shape *s, const double *y, double *out)
{
  const int N = s->width * s->m;
  if (s->mirrored) {
    sd_mirrored_apply(s->mirrored, y, out);
    return;
  }
  SD_KERNELS_OF(sd_dense, plain, sd_isa_of(SD_ISA_BEST))->times(N, s->inverse, y, out);
}

/* rigid = inverse K of a dense inverse */
static void apply_dense(const sd_body_shape *s, const double *inverse, double *rigid)
{
  const size_t w = (size_t) s->width, N = w * (size_t) s->m;
  memset(rigid, 0, sizeof(double) * 6 * N);
  for (size_t j = 0; j < N; j++) {
    double K[6];
    shape_rigid_row(s->x + 3 * (j / w), (int) (j % w), K);
    for (size_t i = 0; i < N; i++)
      for (int c = 0; c < 6; c++) rigid[6 * i + c] += inverse[i * N + j] * K[c];
  }
}

/* R = K^T rigid: what works on the body as a whole */
static void collect_rigid(const sd_body_shape *s, const double *rigid, double R[36])
{
  const size_t w = (size_t) s->width, N = w * (size_t) s->m;
  memset(R, 0, 36 * sizeof(double));
  for (size_t i = 0; i < N; i++) {
    double K[6];
    shape_rigid_row(s->x + 3 * (i / w), (int) (i % w), K);
    for (int p = 0; p < 6; p++)
      for (int c = 0; c < 6; c++) R[6 * p + c] += K[p] * rigid[6 * i + c];
  }
}

/* out += sign N C: (U, W) of the free body in the unit strains E, C = K^T M_b^-1 E the force that
 * they make on it when it is held. What is left of them turns and shifts the body: slip has no
 * force in all when N (F + C) = 0. */
static void motion_in_strain(const double N[36], const double C[36], double out[36], double sign)
{
  for (int p = 0; p < 6; p++)
    for (int c = 0; c < 6; c++)
      for (int q = 0; q < 6; q++) out[6 * p + c] += sign * N[6 * p + q] * C[6 * q + c];
}

/* dN and dE, and K dN K^T added to M, with torques. rigid = M_b^-1 K of the spheres without shells: its transpose
 * gives C of the spheres, column by column, without another solve. */
static void add_shells(sd_body_shape *s, const sd_clump *shells, const double *rigid,
                       const double N_spheres[36], double *M)
{
  const size_t N = 6 * (size_t) s->m;
  double N_shell[36], C[36] = {0.0};
  sd_pseudo_inverse6(shells->R, N_shell);
  for (int e = 0; e < 36; e++) s->shell[e] = N_shell[e] - N_spheres[e];
  for (size_t i = 0; i < N; i++) {
    if (i % 6 >= 3) continue; /* spheres do not turn with a strain */
    for (int c = 0; c < 6; c++) {
      double v[3];
      sd_clump_unit_strain(c, s->x + 3 * (i / 6), v);
      for (int p = 0; p < 6; p++) C[6 * p + c] += rigid[6 * i + p] * v[i % 6];
    }
  }
  motion_in_strain(N_shell, shells->strain, s->carried, 1.0);
  motion_in_strain(N_spheres, C, s->carried, -1.0);
  for (size_t i = 0; i < N; i++) {
    double Ki[6], t[6] = {0.0};
    shape_rigid_row(s->x + 3 * (i / 6), (int) (i % 6), Ki);
    for (int p = 0; p < 6; p++)
      for (int c = 0; c < 6; c++) t[c] += Ki[p] * s->shell[6 * p + c];
    for (size_t j = 0; j < N; j++) {
      double Kj[6];
      shape_rigid_row(s->x + 3 * (j / 6), (int) (j % 6), Kj);
      for (int c = 0; c < 6; c++) M[i * N + j] += t[c] * Kj[c];
    }
  }
}

/* One sphere that turns, about its own centre: K = I, and M is the mobility of the body. */
static int is_its_sphere(const sd_body_shape *s)
{
  return s->m == 1 && s->width == 6 && s->x[0] == 0.0 && s->x[1] == 0.0 && s->x[2] == 0.0;
}

/* inverse, rigid, mobility and resistance from M, which `inverse` holds on entry */
static sd_status complete(sd_body_shape *s)
{
  const int its_sphere = is_its_sphere(s);
  if (its_sphere) memcpy(s->mobility, s->inverse, sizeof s->mobility);
  const sd_status status = sd_inverse(s->width * s->m, s->inverse);
  if (status != SD_OK) return status;
  if (its_sphere) {
    memcpy(s->rigid, s->inverse, sizeof s->resistance);
    memcpy(s->resistance, s->inverse, sizeof s->resistance);
    return SD_OK;
  }
  apply_dense(s, s->inverse, s->rigid);
  collect_rigid(s, s->rigid, s->resistance);
  sd_pseudo_inverse6(s->resistance, s->mobility);
  return SD_OK;
}

sd_status sd_body_shape_of(int m, int width, const double *x, const double *radius, const double *M,
                           sd_body_shape *s)
{
  const size_t N = (size_t) width * (size_t) m;
  *s = (sd_body_shape){.m = m, .width = width};
  s->x = malloc(sizeof(double) * 3 * (size_t) m);
  s->radius = malloc(sizeof(double) * (size_t) m);
  s->inverse = malloc(sizeof(double) * N * N);
  s->rigid = malloc(sizeof(double) * 6 * N);
  sd_status status = s->x && s->radius && s->inverse && s->rigid ? SD_OK : SD_ENOMEMORY;
  if (status == SD_OK) {
    memcpy(s->x, x, sizeof(double) * 3 * (size_t) m);
    memcpy(s->radius, radius, sizeof(double) * (size_t) m);
    memcpy(s->inverse, M, sizeof(double) * N * N);
    status = complete(s);
  }
  if (status != SD_OK) sd_body_shape_free(s);
  return status;
}

/* rigid by columns; work [6 m] */
static void complete_mirrored(sd_body_shape *s, double *work)
{
  const size_t N = 3 * (size_t) s->m;
  double *answer = work + N;
  for (int c = 0; c < 6; c++) {
    for (size_t j = 0; j < N; j++) {
      double K[6];
      shape_rigid_row(s->x + 3 * (j / 3), (int) (j % 3), K);
      work[j] = K[c];
    }
    sd_mirrored_apply(s->mirrored, work, answer);
    for (size_t j = 0; j < N; j++) s->rigid[6 * j + (size_t) c] = answer[j];
  }
  collect_rigid(s, s->rigid, s->resistance);
  sd_pseudo_inverse6(s->resistance, s->mobility);
}

sd_status sd_body_shape_mirrored(int m, const double *x, const double *radius, const double axes[9],
                                 const double *M, sd_body_shape *s)
{
  const size_t N = 3 * (size_t) m;
  *s = (sd_body_shape){.m = m, .width = 3};
  s->x = malloc(sizeof(double) * N);
  s->radius = malloc(sizeof(double) * (size_t) m);
  s->rigid = malloc(sizeof(double) * 6 * N);
  s->mirrored = calloc(1, sizeof *s->mirrored);
  double *work = malloc(sizeof(double) * 2 * N);
  sd_status status = s->x && s->radius && s->rigid && s->mirrored && work ? SD_OK : SD_ENOMEMORY;
  if (status == SD_OK) status = sd_mirrored_create(m, x, axes, M, s->mirrored);
  if (status == SD_OK) {
    memcpy(s->x, x, sizeof(double) * N);
    memcpy(s->radius, radius, sizeof(double) * (size_t) m);
    complete_mirrored(s, work);
  } else
    sd_body_shape_free(s);
  free(work);
  return status;
}

sd_status sd_body_shape_create(const sd_shape *shape, const sd_clump *shells, sd_body_shape *s)
{
  const size_t N = 6 * (size_t) shape->n;
  double *M = malloc(sizeof(double) * N * N);
  *s = (sd_body_shape){0};
  if (!M) return SD_ENOMEMORY;
  sd_wall_matrix(NULL, shape->n, 6, shape->x, shape->a, M);
  sd_status status = sd_body_shape_of(shape->n, 6, shape->x, shape->a, M, s);
  /* Now N_spheres and M_b^-1 K are known, which M_b' is made of; then once more with it. */
  if (status == SD_OK && shells) {
    memcpy(s->inverse, M, sizeof(double) * N * N);
    add_shells(s, shells, s->rigid, s->mobility, s->inverse);
    status = complete(s);
    if (status != SD_OK) sd_body_shape_free(s);
  }
  free(M);
  return status;
}

sd_status sd_body_wall_shape(const sd_wall *wall, int m, int width, const double *x,
                             const double *a, const double centre[3], sd_body_shape *out)
{
  const size_t N = (size_t) width * (size_t) m;
  double *M = malloc(sizeof(double) * (N * N + 3 * (size_t) m)), *arm = M + N * N;
  *out = (sd_body_shape){0};
  if (!M) return SD_ENOMEMORY;
  sd_wall_matrix(wall, m, width, x, a, M);
  for (size_t k = 0; k < (size_t) m; k++) sd_minus(x + 3 * k, centre, arm + 3 * k);
  const sd_status status = sd_body_shape_of(m, width, arm, a, M, out);
  free(M);
  return status;
}

int sd_body_wall_pays(int m, int bodies, double height, double extent)
{
  return height < 10.0 * extent && (m <= SD_BODY_WALL_SMALL || m <= 3.0 * bodies);
}

void sd_body_shape_free(sd_body_shape *s)
{
  if (s->mirrored) sd_mirrored_free(s->mirrored);
  free(s->mirrored);
  free(s->x);
  free(s->radius);
  free(s->inverse);
  free(s->rigid);
  *s = (sd_body_shape){0};
}
