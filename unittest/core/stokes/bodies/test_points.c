/* Bodies of points, held bodies and bodies of any size: sd_bodies.h against dense solutions of its system.
 * Spheres of 12 points (an icosahedron) that know forces alone, free, held, and two that touch in a clump. */
#include "arms.h"
#include "check.h"
#include "plain.h"

#include "sd_bodies.h"
#include "sd_linear.h"
#include "sd_pose.h"
#include "sd_tensor.h"

#include <string.h>

/* Of a unit sphere: distance and radius of its points, with which its drag and its rotation are right */
static const double REACH = 0.6563217307, POINT = 0.5622830568;
static const double ETA = 1.3;
enum { K = 12, BODIES = 7, SPHERES = 8, POINTS = K * SPHERES, ROWS = 3 * POINTS };

/* Unit vectors to the corners of an icosahedron */
static void icosahedron(double *x)
{
  const double g = 0.5 * (1.0 + sqrt(5.0)), s = 1.0 / sqrt(1.0 + g * g);
  int k = 0;
  for (int axis = 0; axis < 3; axis++)
    for (int p = -1; p <= 1; p += 2)
      for (int q = -1; q <= 1; q += 2, k++) {
        x[3 * k + axis] = 0.0;
        x[3 * k + (axis + 1) % 3] = s * p;
        x[3 * k + (axis + 2) % 3] = s * g * q;
      }
}

/* Six free spheres, the second of radius 2, and a clump of two that touch */
typedef struct {
  sd_body_shape one, two;
  sd_body body[BODIES];
  /* spheres; points */
  double c[3 * SPHERES], radius[SPHERES], spheres_arm[3 * SPHERES];
  int of_body[SPHERES];
  double x[ROWS], a[POINTS], arm[ROWS], D[ROWS], u[ROWS];
  int of_sphere[POINTS], row[POINTS];
  double F[6 * SPHERES], velocities[6 * BODIES];
  char known[BODIES];
  double w[POINTS];
  sd_packed packed;
  double l[ROWS], v[6 * SPHERES], V[6 * BODIES], exerted[6 * SPHERES];
  sd_bodies_report report;
} cloud;

static sd_status product(void *ctx, const double *F, double *u)
{
  sd_packed_share(&((cloud *) ctx)->packed, 0, 1, F, u);
  return SD_OK;
}

static void make_shapes(cloud *s)
{
  double x[6 * K], a[2 * K], M[36 * K * K];
  icosahedron(x);
  for (int j = 0; j < 3 * K; j++) x[j] *= REACH;
  for (int k = 0; k < 2 * K; k++) a[k] = POINT;
  sd_wall_matrix(NULL, K, 3, x, a, M);
  assert_int_equal(sd_body_shape_of(K, 3, x, a, M, &s->one), SD_OK);
  for (int k = K; k < 2 * K; k++)
    for (int d = 0; d < 3; d++) x[3 * k + d] = x[3 * (k - K) + d] + (d == 2);
  for (int k = 0; k < K; k++) x[3 * k + 2] -= 1.0;
  sd_wall_matrix(NULL, 2 * K, 3, x, a, M);
  assert_int_equal(sd_body_shape_of(2 * K, 3, x, a, M, &s->two), SD_OK);
}

static cloud *cloud_create(void)
{
  static const double at[3 * BODIES] = {0, 0, 0, 3.4, 0.5, 0, -1, 2.2, 0.3, 0.4, -0.3, 2.3, -2.4, -0.2, 0.5, 1, 3.5,
                                        1.5, 0, -2.6, 0};
  cloud *s = calloc(1, sizeof(cloud));
  const double turn[3] = {0.7, -0.3, 0.5};
  uint64_t seed = 3;
  make_shapes(s);
  for (int b = 0, sphere = 0, point = 0; b < BODIES; b++) {
    sd_body *body = s->body + b;
    *body = (sd_body){.shape = b < 6 ? &s->one : &s->two, .a = b == 1 ? 2.0 : 1.0, .eta = ETA, .row = s->row + point};
    sd_rotation(turn, body->R);
    double arms[6 * K];
    arms_of(body, arms);
    for (int k = 0; k < body->shape->m; k++, point++) {
      if (k % K == 0) {
        const double centre[3] = {0, 0, b < 6 ? 0.0 : k ? 1.0 : -1.0};
        sd_multiply3(body->R, centre, s->spheres_arm + 3 * sphere);
        for (int d = 0; d < 3; d++) s->c[3 * sphere + d] = at[3 * b + d] + s->spheres_arm[3 * sphere + d];
        s->radius[sphere] = body->a;
        s->of_body[sphere++] = b;
      }
      s->row[point] = point;
      s->of_sphere[point] = sphere - 1;
      s->a[point] = POINT * body->a;
      s->w[point] = 1.0 / sqrt(ETA);
      for (int d = 0; d < 3; d++) {
        s->x[3 * point + d] = at[3 * b + d] + arms[3 * k + d];
        s->arm[3 * point + d] = arms[3 * k + d] - s->spheres_arm[3 * (sphere - 1) + d];
        s->D[3 * point + d] = 6.0 * SD_PI * ETA * s->a[point];
      }
      s->u[3 * point] = 0.2 * s->x[3 * point + 1];
    }
  }
  for (int j = 0; j < 6 * SPHERES; j++) s->F[j] = uniform(&seed, -20, 20);
  for (int j = 0; j < 6 * BODIES; j++) s->velocities[j] = uniform(&seed, -1, 1);
  const sd_law law = {.tensor = SD_TENSOR_RPY};
  const sd_spheres spheres = {s->x, s->a, s->w};
  assert_int_equal(sd_packed_all(&s->packed, SD_ISA_BEST, &law, &spheres, POINTS, 3), SD_OK);
  return s;
}

static void cloud_free(cloud *s)
{
  sd_body_shape_free(&s->one);
  sd_body_shape_free(&s->two);
  sd_packed_free(&s->packed);
  free(s);
}

static sd_bodies cloud_bodies(cloud *s)
{
  return (sd_bodies){.shaped = BODIES,
                     .body = s->body,
                     .known = s->known,
                     .spheres = {SPHERES, 6, s->of_body, s->spheres_arm},
                     .points = {POINTS, 3, s->of_sphere, s->arm},
                     .D = s->D,
                     .apply = product,
                     .apply_ctx = s};
}

static void cloud_solve(cloud *s, double tolerance)
{
  const sd_bodies A = cloud_bodies(s);
  const sd_bodies_problem problem = {s->u, s->F, s->velocities, 0, tolerance, 100};
  const sd_bodies_answer answer = {s->l, NULL, s->V, s->v, s->exerted};
  double *work = malloc(sizeof(double) * (size_t) sd_bodies_work(&A));
  for (long j = 0; j < sd_bodies_work(&A); j++) work[j] = NAN;
  assert_int_equal(sd_bodies_solve(&A, &problem, &answer, work, &s->report), SD_OK);
  free(work);
}

/* K [6 BODIES][ROWS], from the places of points and bodies alone */
static double *dense_K(const cloud *s)
{
  double *out = calloc(6 * BODIES * ROWS, sizeof(double));
  for (int k = 0; k < POINTS; k++) {
    const int sphere = s->of_sphere[k], b = s->of_body[sphere];
    double r[3];
    for (int d = 0; d < 3; d++)
      r[d] = s->x[3 * k + d] - s->c[3 * sphere + d] + s->spheres_arm[3 * sphere + d];
    for (int d = 0; d < 3; d++) {
      const double e[3] = {d == 0, d == 1, d == 2};
      double v[3];
      sd_cross(e, r, v);
      out[(6 * b + d) * ROWS + 3 * k + d] = 1.0;
      for (int g = 0; g < 3; g++) out[(6 * b + 3 + d) * ROWS + 3 * k + g] = v[g];
    }
  }
  return out;
}

static double *dense_M(const cloud *s)
{
  double *M = malloc(sizeof(double) * ROWS * ROWS);
  for (int i = 0; i < POINTS; i++)
    for (int j = 0; j < POINTS; j++) {
      double r[3], block[9];
      sd_minus(s->x + 3 * i, s->x + 3 * j, r);
      sd_tensor_uf(SD_TENSOR_RPY, r, s->a[i], s->a[j], ETA, block);
      for (int p = 0; p < 3; p++)
        for (int q = 0; q < 3; q++) M[(3 * i + p) * ROWS + 3 * j + q] = block[3 * p + q];
    }
  return M;
}

/* Loads of bodies: their spheres' about the centres of the bodies */
static void onto_bodies(const cloud *s, const double *on_spheres, double *f)
{
  memset(f, 0, sizeof(double) * 6 * BODIES);
  for (int i = 0; i < SPHERES; i++) {
    double couple[3], *to = f + 6 * s->of_body[i];
    sd_cross(s->spheres_arm + 3 * i, on_spheres + 6 * i, couple);
    for (int d = 0; d < 6; d++) to[d] += on_spheres[6 * i + d] + (d < 3 ? 0.0 : couple[d - 3]);
  }
}

/* With R = K^T M^-1 K and C = K^T M^-1 u: forces of bodies f = R V - C. Held rows: V given; others f given. */
static void dense_solution(const cloud *s, double *V, double *f)
{
  enum { N = 6 * BODIES };
  double *M = dense_M(s), *KT = dense_K(s), *B = malloc(sizeof(double) * (N + 1) * ROWS), R[N * N], C[N], H[N * N];
  memcpy(B, KT, sizeof(double) * N * ROWS);
  memcpy(B + N * ROWS, s->u, sizeof(double) * ROWS);
  assert_int_equal(sd_cholesky_solve(ROWS, M, N + 1, B), SD_OK);
  for (int p = 0; p < N; p++) {
    C[p] = 0.0;
    for (int j = 0; j < ROWS; j++) C[p] += KT[p * ROWS + j] * B[N * ROWS + j];
    for (int q = 0; q < N; q++) {
      R[N * p + q] = 0.0;
      for (int j = 0; j < ROWS; j++) R[N * p + q] += KT[p * ROWS + j] * B[q * ROWS + j];
    }
  }
  onto_bodies(s, s->F, f);
  memcpy(H, R, sizeof(H));
  for (int p = 0; p < N; p++) {
    V[p] = s->known[p / 6] ? s->velocities[p] : f[p] + C[p];
    for (int q = 0; q < N && !s->known[p / 6]; q++)
      if (s->known[q / 6]) V[p] -= R[N * p + q] * s->velocities[q];
    for (int q = 0; q < N; q++)
      if (s->known[p / 6] || s->known[q / 6]) H[N * p + q] = p == q;
  }
  assert_int_equal(sd_cholesky_solve(N, H, 1, V), SD_OK);
  for (int p = 0; p < N; p++) {
    f[p] = -C[p];
    for (int q = 0; q < N; q++) f[p] += R[N * p + q] * V[q];
  }
  free(M), free(KT), free(B);
}

static double difference(const double *a, const double *b, int n)
{
  double off = 0.0, all = 0.0;
  for (int j = 0; j < n; j++) {
    off += pow(a[j] - b[j], 2);
    all += b[j] * b[j];
  }
  return sqrt(off / all);
}

/* Nobody held, one sphere held, a clump and the large sphere held, all held: velocities and forces in shear */
static void spheres_of_points_move_as_the_dense_solution_says(void **state)
{
  (void) state;
  static const char who[4][BODIES + 1] = {"0000000", "1000000", "0100001", "1111111"};
  cloud *s = cloud_create();
  for (int e = 0; e < 4; e++) {
    double V[6 * BODIES], f[6 * BODIES], exerted[6 * BODIES];
    for (int b = 0; b < BODIES; b++) s->known[b] = who[e][b] == '1';
    cloud_solve(s, 1e-11);
    dense_solution(s, V, f);
    onto_bodies(s, s->exerted, exerted);
    assert_true(difference(s->V, V, 6 * BODIES) < 1e-8);
    assert_true(difference(exerted, f, 6 * BODIES) < 1e-8);
    for (int i = 0; i < SPHERES; i++) { /* and spheres go with their bodies */
      double turning[3];
      sd_cross(V + 6 * s->of_body[i] + 3, s->spheres_arm + 3 * i, turning);
      for (int d = 0; d < 3; d++) CHECK_NEAR(s->v[6 * i + d], V[6 * s->of_body[i] + d] + turning[d], 1e-7);
    }
  }
  cloud_free(s);
}

/* One shape for every size: a lone sphere of radius a has drag 6 pi eta a and 8 pi eta a^3, to the digits of
 * REACH and POINT */
static void a_lone_sphere_of_points_has_its_own_drag(void **state)
{
  (void) state;
  cloud *s = cloud_create();
  sd_bodies A = cloud_bodies(s);
  for (int b = 0; b < 2; b++) { /* radii 1 and 2 */
    double F[6 * SPHERES] = {0.0}, V[6], u[ROWS] = {0.0}, work[10000], l[ROWS], v[6], exerted[6];
    const double a = s->radius[b], zero[3] = {0.0};
    const int whole[1] = {0}, none[K] = {0};
    int row[K];
    sd_body lone = s->body[b];
    const sd_spheres spheres = {s->x + 3 * K * b, s->a + K * b, s->w};
    const sd_law law = {.tensor = SD_TENSOR_RPY};
    for (int k = 0; k < K; k++) row[k] = k;
    lone.row = row;
    F[1] = F[5] = 1.0;
    sd_packed_free(&s->packed);
    assert_int_equal(sd_packed_all(&s->packed, SD_ISA_BEST, &law, &spheres, K, 3), SD_OK);
    A.shaped = 1;
    A.body = &lone;
    A.spheres = (sd_rigid){1, 6, whole, zero};
    A.points = (sd_rigid){K, 3, none, s->arm + 3 * K * b};
    A.D = s->D + 3 * K * b;
    assert_true(sd_bodies_work(&A) < 10000);
    const sd_bodies_problem problem = {u, F, NULL, 0, 1e-10, 9};
    const sd_bodies_answer answer = {l, NULL, V, v, exerted};
    assert_int_equal(sd_bodies_solve(&A, &problem, &answer, work, &s->report), SD_OK);
    CHECK_NEAR(V[1] * 6.0 * SD_PI * ETA * a, 1.0, 1e-8);
    CHECK_NEAR(V[5] * 8.0 * SD_PI * ETA * a * a * a, 1.0, 1e-8);
    assert_int_equal(s->report.products, 1);
  }
  cloud_free(s);
}

/* Mobility and resistance are one matrix: velocities from loads, given back to the same bodies as held, take the
 * loads to hold them; and two such pairs do each other's work. */
static void what_holds_bodies_is_what_moves_them(void **state)
{
  (void) state;
  cloud *s = cloud_create();
  double V[2][6 * BODIES], f[2][6 * BODIES], work[2] = {0.0};
  memset(s->u, 0, sizeof(s->u));
  uint64_t seed = 17;
  for (int e = 0; e < 2; e++) {
    double loads[6 * BODIES];
    memset(s->known, 0, sizeof(s->known));
    for (int j = 0; j < 6 * SPHERES; j++) s->F[j] = uniform(&seed, -20, 20);
    cloud_solve(s, 1e-11);
    memcpy(V[e], s->V, sizeof(s->V));
    memcpy(s->velocities, s->V, sizeof(s->V));
    onto_bodies(s, s->F, loads);
    memset(s->known, 1, sizeof(s->known));
    memset(s->F, 0, sizeof(s->F)); /* not read */
    cloud_solve(s, 1e-11);
    onto_bodies(s, s->exerted, f[e]);
    assert_true(difference(f[e], loads, 6 * BODIES) < 1e-8);
  }
  for (int j = 0; j < 6 * BODIES; j++) {
    work[0] += f[0][j] * V[1][j];
    work[1] += f[1][j] * V[0][j];
  }
  CHECK_NEAR(work[0] / work[1], 1.0, 1e-8);
  cloud_free(s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(spheres_of_points_move_as_the_dense_solution_says),
      cmocka_unit_test(a_lone_sphere_of_points_has_its_own_drag),
      cmocka_unit_test(what_holds_bodies_is_what_moves_them),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
