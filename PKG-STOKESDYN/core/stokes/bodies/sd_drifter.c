#include "sd_drifter.h"

#include <math.h>
#include <string.h>

#include "sd_bodies_alone.h"
#include "sd_linear.h"
#include "sd_tie.h"

static void keep_free(const sd_bodies *A, const double *known, double *v)
{
  for (int b = 0; b < sd_bodies_count(A); b++)
    for (int d = 0; d < 6; d++)
      if (sd_bodies_velocity_known(A, b, d)) v[6 * (long) b + d] = known ? known[6 * (long) b + d] : 0.0;
}

/* Numbers of one point, about its own centre, and back */
static void read_point(const sd_bodies *A, int row, const double *y, double V[6])
{
  const int w = A->points.width;
  memset(V, 0, 6 * sizeof(double));
  memcpy(V, y + (long) w * row, sizeof(double) * (size_t) w);
}

/* v [6 bodies] = A^T y, y [points]; 0 where a velocity is given */
static void follow_points(const sd_bodies *A, const sd_drifter *d, const double *y, double *v)
{
  for (int e = 0; e < A->lone; e++) read_point(A, A->loner[e], y, v + 6 * (long) e);
  for (int b = 0; b < A->shaped; b++) {
    const sd_body *body = d->body + b;
    const sd_body_follow *follow = d->follow[b];
    double *V = v + 6 * (long) (A->lone + b), own[6] = {0.0};
    if (!follow) {
      read_point(A, A->body[b].row[0], y, V);
      continue;
    }
    const int w = A->points.width;
    for (int i = 0; i < follow->n; i += 3) {
      double there[3];
      sd_multiply3t(body->R, y + (long) w * body->row[i / w] + i % w, there);
      for (int c = 0; c < 6; c++)
        for (int p = 0; p < 3; p++) own[c] += follow->A[6 * (long) (i + p) + c] * there[p];
    }
    sd_multiply3(body->R, own, V);
    sd_multiply3(body->R, own + 3, V + 3);
    for (int p = 3; p < 6; p++) V[p] /= body->a;
  }
  keep_free(A, NULL, v);
}

void sd_drifter_spread(const sd_bodies *A, const sd_drifter *d, const double *v, double *l)
{
  const int w = A->points.width;
  memset(l, 0, sizeof(double) * (size_t) sd_bodies_unknowns(A));
  for (int e = 0; e < A->lone; e++)
    memcpy(l + (long) w * A->loner[e], v + 6 * (long) e, sizeof(double) * (size_t) w);
  for (int b = 0; b < A->shaped; b++) {
    const sd_body *body = d->body + b;
    const sd_body_follow *follow = d->follow[b];
    const double *V = v + 6 * (long) (A->lone + b);
    double own[6];
    if (!follow) {
      memcpy(l + (long) w * A->body[b].row[0], V, sizeof(double) * (size_t) w);
      continue;
    }
    sd_multiply3t(body->R, V, own);
    sd_multiply3t(body->R, V + 3, own + 3);
    for (int p = 3; p < 6; p++) own[p] /= body->a;
    for (int i = 0; i < follow->n; i += 3) {
      double there[3] = {0.0};
      for (int p = 0; p < 3; p++)
        for (int c = 0; c < 6; c++) there[p] += follow->A[6 * (long) (i + p) + c] * own[c];
      sd_multiply3(body->R, there, l + (long) w * body->row[i / w] + i % w);
    }
  }
}

/* load [6 bodies] -= K^T L K v; on_spheres [12 spheres] */
static sd_status bear_films(const sd_bodies *A, const double *v, double *on_spheres, double *borne,
                            double *load)
{
  if (!A->tie) return SD_OK;
  const sd_rigid films = sd_bodies_films(A);
  double *moved = on_spheres, *forces = on_spheres + 6 * (long) A->spheres.n;
  sd_rigid_move(&films, v, moved);
  const sd_status status = sd_lubrication_apply(A->tie->L, moved, forces);
  if (status != SD_OK) return status;
  sd_rigid_collect(&films, forces, sd_bodies_count(A), borne);
  for (long j = 0; j < 6 * (long) sd_bodies_count(A); j++) load[j] -= borne[j];
  return SD_OK;
}

/* v [6 bodies] += P^-1 load, of what is not given; work [12 bodies] */
static sd_status add_response(const sd_bodies *A, double tolerance, sd_tie_room room, double *load, double *work,
                              double *v)
{
  const long motions = 6 * (long) sd_bodies_count(A);
  double *z = work, *borne = z + motions;
  keep_free(A, NULL, load);
  sd_bodies_alone_move(A, load, z);
  keep_free(A, NULL, z);
  for (long j = 0; j < motions; j++)
    if (!A->tie || !sd_tie_binds(A, (int) (j / 6))) v[j] += z[j];
  if (!A->tie) return SD_OK;
  memset(z, 0, sizeof(double) * (size_t) motions);
  const sd_tie_problem problem = {load, NULL, tolerance, 0};
  const sd_status status = sd_tie_solve(A, &problem, room, z, borne);
  for (long j = 0; j < motions && status == SD_OK; j++)
    if (sd_tie_binds(A, (int) (j / 6))) v[j] += z[j];
  return status;
}

sd_status sd_drifter_move(const sd_bodies *A, const sd_drifter *d, const sd_drifter_push *push,
                          double *work, double *of_points, double *of_films)
{
  const int bodies = sd_bodies_count(A);
  const long motions = 6 * (long) bodies;
  double *load = work, *noise = load + motions, *on_spheres = noise + motions;
  double *borne = on_spheres + SD_TIE_OF_SPHERE * (long) A->spheres.n;
  const sd_tie_room room = {borne + 2 * motions, on_spheres};
  follow_points(A, d, push->u, of_points);
  memset(load, 0, sizeof(double) * (size_t) motions);
  if (push->F) sd_rigid_collect(&A->spheres, push->F, bodies, load);
  if (A->tie) {
    const sd_rigid films = sd_bodies_films(A);
    sd_rigid_collect(&films, A->tie->L->carried, bodies, borne);
    for (long j = 0; j < motions; j++) load[j] += borne[j];
  }
  keep_free(A, push->velocities, of_points);
  sd_status status = bear_films(A, of_points, on_spheres, borne, load);
  if (status == SD_OK) status = add_response(A, push->tolerance, room, load, borne, of_points);
  follow_points(A, d, push->y, noise);
  for (long j = 0; j < motions; j++) of_points[j] += noise[j];
  memcpy(of_films, of_points, sizeof(double) * (size_t) motions);
  if (!A->tie || status != SD_OK) return status;
  memset(load, 0, sizeof(double) * (size_t) motions);
  if (push->f) sd_rigid_collect(&A->spheres, push->f, bodies, load);
  status = bear_films(A, noise, on_spheres, borne, load);
  return status == SD_OK ? add_response(A, push->tolerance, room, load, borne, of_films) : status;
}

sd_status sd_drifter_difference(const sd_bodies *A, const double *l, double part, double *work, double *slip,
                                double *load)
{
  const long motions = 6 * (long) sd_bodies_count(A), n = sd_bodies_unknowns(A);
  double *still = work, *bodies = still + motions, *on_spheres = bodies + 2 * motions;
  double *u = on_spheres + 6 * (long) A->spheres.n;
  memset(still, 0, sizeof(double) * (size_t) motions);
  const sd_status status = sd_bodies_product(A, sd_bodies_shells(A), l, still, bodies, on_spheres, u);
  if (status != SD_OK) return status;
  for (long j = 0; j < n; j++) slip[j] += part * u[j];
  sd_bodies_collect(A, l, on_spheres, bodies);
  for (long j = 0; j < motions; j++) load[j] -= part * bodies[j];
  return SD_OK;
}

void sd_drifter_add_own(const sd_bodies *A, const sd_drifter *d, double kT, double *slip, double *load)
{
  const int w = A->points.width;
  for (int b = 0; b < A->shaped; b++) {
    const sd_body *body = d->body + b;
    const sd_body_follow *own = d->follow[b];
    if (!own || !own->slip || sd_bodies_known(A, A->lone + b) != SD_BODY_FREE) continue;
    double turned[3];
    for (int i = 0; i < own->n; i += 3) {
      sd_multiply3(body->R, own->slip + i, turned);
      double *there = slip + (long) w * body->row[i / w] + i % w;
      for (int p = 0; p < 3; p++) there[p] += kT / (body->eta * body->a * body->a) * turned[p];
    }
    sd_multiply3(body->R, own->torque, turned);
    double *first = load + (long) A->spheres.width * sd_rigid_whole(&A->points, body->row[0]);
    for (int p = 0; p < 3; p++) first[3 + p] -= kT * turned[p];
  }
}

/* Over the radius of the smallest sphere: the error of differences falls with its square, that of rounding
 * grows. */
static const double FAR = 1e-4;

/* Is number d of the velocity of a body one by which it moves? */
static int drifter_moves_by(const sd_bodies *A, const sd_drifter_random *random, int b, int d)
{
  const int in_plane = d < 2 || d == 5;
  if (random->dimension == 2 && !in_plane) return 0;
  return !sd_bodies_velocity_known(A, b, d) && (d < 3 || b >= random->turning);
}

double sd_drifter_moves(const sd_bodies *A, const sd_drifter_random *random, double *extent, double *moves,
                        double *W)
{
  const double e = FAR * random->smallest;
  for (int b = 0; b < sd_bodies_count(A); b++) extent[b] = random->smallest;
  for (int k = 0; k < A->spheres.n && A->spheres.arm; k++) {
    const double *arm = A->spheres.arm + 3 * (long) k;
    double *of_body = extent + sd_rigid_whole(&A->spheres, k);
    *of_body = fmax(*of_body, sqrt(sd_dot(arm, arm)));
  }
  for (int b = 0; b < sd_bodies_count(A); b++)
    for (int d = 0; d < 6; d++) {
      const long j = 6 * (long) b + d;
      const double s = d < 3 ? 1.0 : extent[b];
      const double g = drifter_moves_by(A, random, b, d) ? random->normals[j] : 0.0;
      moves[j] = e * (g / s);
      W[j] = g * s;
    }
  return e;
}

void sd_drifter_hand_on(const sd_bodies *A, int turning, double *of_bodies, double *load)
{
  for (int k = 0; k < A->spheres.n; k++) {
    const int b = sd_rigid_whole(&A->spheres, k);
    for (int d = 3; d < 6 && b >= turning; d++) {
      load[(long) A->spheres.width * k + d] += of_bodies[6 * (long) b + d];
      of_bodies[6 * (long) b + d] = 0.0;
    }
  }
}

void sd_drifter_add(const sd_bodies *A, const sd_drifter_drawn *drawn, double *u, double *F)
{
  for (long j = 0; j < sd_bodies_unknowns(A); j++) u[j] += drawn->slip[j] + drawn->slip_left[j];
  for (long j = 0; j < sd_bodies_loads(A); j++) F[j] += drawn->load[j] + drawn->load_left[j];
}
