/* Of velocities: spheres as shells of points (keyword multiblob), for the core's bodies. */
#include "velocities.h"

#include "sd_linear.h"

#include "atom.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

void Velocities::orient()
{
  for (const Clump &clump : clumps) {
    const sd_multiblob_shape &shape = rigid.points(*clump.body->shape, scene.shells->model());
    double pose[9], turn[9];
    sd_multiblob_shape_stand(&shape, clump.pose, pose, turn);
    for (int k = 0; k < clump.body->n; k++)
      scene.shells->turn_row(scene.row_of_member((int) member_of(clump, k)), turn, shape.mask[k]);
  }
}

/* out [3 points] = velocity + gradient r, by rows */
void Velocities::flow_at_points(const double *velocity, int stride, const double *gradient,
                                double *out) const
{
  for (size_t k = 0; k < sphere.size(); k++) {
    double change[3];
    sd_multiply3(gradient + 9 * (size_t) sphere[k], &r[3 * k], change);
    for (int d = 0; d < 3; d++) out[3 * k + d] = velocity[stride * (size_t) sphere[k] + d] + change[d];
  }
}

/* Points around the spheres; forces on these, the fluid at the points, their drags */
void Velocities::place_shells()
{
  enum { VELOCITY = 0, SLOPE = 3, FORCE = 12, COLUMNS = 18 };
  const size_t n = scene.size(), P = scene.shells->points();
  const double *gradients = ambient.gradients();
  std::vector<double> x(3 * P * n + 3), b(P * n + 1);
  std::vector<double> rows = scene.rows(COLUMNS, [&](int i, double *out) {
    std::fill_n(out, (int) COLUMNS, 0.0);
    std::copy_n(ambient.velocity(i), 3, out + VELOCITY);
    if (gradients) std::copy_n(gradients + 9 * (size_t) i, 9, out + SLOPE);
    std::copy_n(atom->f[i], 3, out + FORCE);
    std::copy_n(atom->torque[i], 3, out + FORCE + 3);
  });
  scene.drift(rows.data(), COLUMNS, 1.0);
  F.resize(6 * n + 6);
  slope.resize(9 * n + 9);
  for (size_t k = 0; k < n; k++) {
    std::copy_n(&rows[COLUMNS * k + FORCE], 6, &F[6 * k]);
    std::copy_n(&rows[COLUMNS * k + SLOPE], 9, &slope[9 * k]);
  }
  const sd_spheres spheres = scene.local();
  of_points.model = &scene.shells->model();
  of_points.spheres = {spheres.x, spheres.a, scene.shells->turns(), scene.shells->masks(), (int) n};
  of_points.w = spheres.w;
  r.resize(3 * P * n + 3);
  of_points.r = r.data();
  sd_multiblob_expand(of_points.model, &of_points.spheres, r.data(), x.data(), b.data());
  sphere.resize(P * n);
  D.assign(3 * P * n + 3, 1.0);
  u.resize(3 * P * n + 3);
  for (size_t k = 0; k < P * n; k++) {
    sphere[k] = (int) (k / P);
    const double w = spheres.w[sphere[k]], drag = 6.0 * SD_PI * b[k] / (w * w);
    for (int d = 0; d < 3 && b[k] > 0.0; d++) D[3 * k + d] = drag;
  }
  flow_at_points(rows.data() + VELOCITY, COLUMNS, slope.data(), u.data());
}

/* A body for each free sphere, then the clumps */
void Velocities::arrange_shells()
{
  const size_t n = scene.size(), P = scene.shells->points();
  const sd_spheres spheres = scene.local();
  member.clear();
  shaped.clear();
  loner.clear();
  whole.assign(n + 1, 0);
  arm.assign(3 * n + 3, 0.0);
  const auto add_points = [&](const sd_multiblob_shape &shape, const std::vector<int> &rows) {
    for (int k = 0; k < shape.points.m; k++)
      member.push_back(P * rows[shape.row[k] / P] + shape.row[k] % P);
  };
  for (int k = 0; k < scene.lone(); k++) {
    const double w = spheres.w[k];
    whole[k] = shaped.size();
    add_points(scene.shells->free_sphere(), {k});
    shaped.push_back({&scene.shells->free_sphere().points,
                      {1, 0, 0, 0, 1, 0, 0, 0, 1},
                      spheres.a[k],
                      1.0 / (w * w),
                      nullptr});
  }
  for (const Clump &clump : clumps) {
    const sd_multiblob_shape &shape = rigid.points(*clump.body->shape, scene.shells->model());
    std::vector<int> rows;
    for (int k = 0; k < clump.body->n; k++) {
      rows.push_back(scene.row_of_member((int) member_of(clump, k)));
      whole[rows.back()] = shaped.size();
      sd_multiply3(clump.pose, clump.body->shape->shape.x + 3 * (size_t) k,
                   &arm[3 * (size_t) rows.back()]);
    }
    add_points(shape, rows);
    sd_body body = {&shape.points, {}, 1.0, clump.eta, nullptr};
    double turn[9];
    sd_multiblob_shape_stand(&shape, clump.pose, body.R, turn);
    shaped.push_back(body);
  }
  size_t at = 0;
  for (sd_body &body : shaped) {
    body.row = &member[at];
    at += body.shape->m;
  }
  V.resize(6 * shaped.size() + 6);
}

sd_bodies Velocities::bodies_of_shells()
{
  const int n = scene.size(), all = scene.shells->points() * n;
  sd_bodies A = bodies(3);
  A.spheres = {n, 6, whole.data(), arm.data()};
  A.points = {all, 3, sphere.data(), r.data()};
  whole_shells.resize(n + 1);
  for (int k = 0; k < n; k++)
    whole_shells[k] = (of_points.spheres.mask[k] & SD_MULTIBLOB_WHOLE) != 0;
  faces = {scene.shells->points(), scene.shells->free_sphere().faces, of_points.spheres.turn,
           whole_shells.data()};
  A.faces = &faces;
  alone.n = all;
  of_points.pairs = A.apply;
  of_points.pairs_ctx = A.apply_ctx;
  A.apply = sd_multiblob_apply;
  A.apply_ctx = &of_points;
  return A;
}

void Velocities::add_moments(const std::vector<double> &l, double *S) const
{
  sd_multiblob_moments(&scene.shells->model(), scene.size(), r.data(), l.data(), S);
}

/* What keeps member k of a clump in its place is what it exerts on the fluid less what acts on it. */
void Velocities::add_constraints(double *S) const
{
  static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
  for (size_t k = scene.lone(); k < (size_t) scene.size(); k++) {
    const double *x = &arm[3 * k];
    double f[3];
    sd_minus(&exerted[6 * k], &F[6 * k], f);
    const double trace = sd_dot(x, f) / 3.0;
    for (int e = 0; e < 6; e++) {
      const int p = row[e], q = column[e];
      S[6 * k + e] += 0.5 * (x[p] * f[q] + x[q] * f[p]) - (p == q ? trace : 0.0);
    }
  }
}

/* u of spheres that the fluid passes with this slip, velocity and spin [6 n], and strains */
void Velocities::slip_at_points(const double *slip)
{
  for (size_t k = 0; k < (size_t) scene.size(); k++) {
    double *G = &slope[9 * k];
    const double *w = slip + 6 * k + 3;
    const double turning[9] = {0.0, -w[2], w[1], w[2], 0.0, -w[0], -w[1], w[0], 0.0};
    const double E[9] = {G[0],
                         0.5 * (G[1] + G[3]),
                         0.5 * (G[2] + G[6]),
                         0.5 * (G[1] + G[3]),
                         G[4],
                         0.5 * (G[5] + G[7]),
                         0.5 * (G[2] + G[6]),
                         0.5 * (G[5] + G[7]),
                         G[8]};
    for (int d = 0; d < 9; d++) G[d] = E[d] + turning[d];
  }
  flow_at_points(slip, 6, slope.data(), u.data());
}

}    // namespace StokesDyn
