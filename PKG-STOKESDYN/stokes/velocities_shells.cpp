/* Of velocities: spheres as shells of points (keyword multiblob), for the core's bodies. */
#include "velocities.h"

#include "sd_linear.h"

#include "atom.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

void Velocities::orient()
{
  for (const Clump &clump : clumps()) {
    const sd_multiblob_shape &points =
        rigid.shapes.points(shape(clump), scene.shells->model());
    double pose[9], turn[9];
    sd_multiblob_shape_stand(&points, clump.pose, pose, turn);
    for (int k = 0; k < body(clump).n; k++)
      scene.shells->turn_row(scene.row_of_member((int) member_of(clump, k)), turn, points.mask[k]);
  }
}

/* out [3 points] = velocity + gradient r, and with a curvature as it carries the point; by rows */
void Velocities::flow_at_points(const double *velocity, int stride, double *out) const
{
  const sd_multiblob_spheres &spheres = of_points.spheres;
  for (size_t k = 0; k < sphere.size(); k++) {
    const size_t i = sphere[k];
    double change[3];
    sd_multiply3(&slope[9 * i], &r[3 * k], change);
    if (!bend.empty())
      sd_flow_bend(&bend[SD_FLOW_SECOND * i], &r[3 * k], of_points.model->point * spheres.a[i],
                   change);
    for (int d = 0; d < 3; d++) out[3 * k + d] = velocity[stride * i + d] + change[d];
  }
}

/* Points around the spheres; forces on these, the fluid at the points, their drags */
void Velocities::place_shells()
{
  enum { VELOCITY = 0, SLOPE = 3, FORCE = 12, BEND = 18 };
  const size_t n = scene.size(), P = scene.shells->points();
  const double *gradients = ambient.gradients(), *curvatures = ambient.curvatures();
  const size_t bends = curvatures ? SD_FLOW_SECOND : 0;
  std::vector<double> x(3 * P * n + 3), b(P * n + 1), velocity;
  std::vector<double> rows = scene.rows(BEND + (int) bends, [&](int i, double *out) {
    std::copy_n(ambient.velocity(i), 3, out + VELOCITY);
    if (gradients) std::copy_n(gradients + 9 * (size_t) i, 9, out + SLOPE);
    for (size_t d = 0; d < 6; d++) out[FORCE + d] = load(i, d);
    if (curvatures) std::copy_n(curvatures + bends * (size_t) i, bends, out + BEND);
  });
  scene.drift(rows.data(), BEND + (int) bends, 1.0);
  take_apart(rows, n, {{&velocity, 3}, {&slope, 9}, {&F, 6}, {&bend, bends}});
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
  flow_at_points(velocity.data(), 3, u.data());
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

/* What keeps member k of a clump in its place is what it exerts on the fluid less what acts on it. */
void Velocities::add_constraints(double *S) const
{
  const size_t first = scene.lone(), n = scene.size() - first;
  std::vector<double> f(3 * n + 3);
  for (size_t k = 0; k < n; k++)
    sd_minus(&exerted[6 * (first + k)], &F[6 * (first + k)], &f[3 * k]);
  sd_multiblob_moments(1, (int) n, &arm[3 * first], f.data(), S + 6 * first);
}

/* u of spheres that the fluid passes with this slip, velocity and spin [6 n], strains and bends */
void Velocities::slip_at_points(const double *slip)
{
  for (size_t k = 0; k < (size_t) scene.size(); k++) {
    const double *w = slip + 6 * k + 3, vorticity[3] = {2.0 * w[0], 2.0 * w[1], 2.0 * w[2]};
    sd_flow_set_vorticity(vorticity, &slope[9 * k]);
  }
  flow_at_points(slip, 6, u.data());
}

}    // namespace StokesDyn
