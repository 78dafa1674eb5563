/* Of body_scene: spheres as shells of points (keyword multiblob): where the points stand, and what flows there. */
#include "body_scene.h"

#include "ambient.h"

#include "sd_flow_points.h"
#include "sd_linear.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

void BodyScene::orient()
{
  for (const ClumpPoses::Clump &clump : poses.clumps()) {
    const sd_multiblob_shape &points = points_of(clump);
    double pose[9], turn[9];
    sd_multiblob_shape_stand(&points, clump.pose, pose, turn);
    for (int k = 0; k < poses.own_clump(clump).n; k++)
      shells.turn_row(scene.row_of_member((int) poses.member_of(clump, k)), turn,
                             points.mask[k]);
  }
}

/* Points around the spheres, their drags; what the fluid does around each sphere */
void BodyScene::place_points()
{
  enum { VELOCITY = 0, SLOPE = 3, BEND = 12 };
  const size_t n = scene.size(), points = shells.first_of_rows()[n];
  const double *gradients = ambient.gradients(), *curvatures = ambient.curvatures();
  const size_t bends = curvatures ? SD_FLOW_SECOND : 0;
  std::vector<double> rows = scene.rows(BEND + (int) bends, [&](int i, double *out) {
    std::copy_n(ambient.velocity(i), 3, out + VELOCITY);
    if (gradients) std::copy_n(gradients + 9 * (size_t) i, 9, out + SLOPE);
    if (curvatures) std::copy_n(curvatures + bends * (size_t) i, bends, out + BEND);
  });
  scene.drift(rows.data(), BEND + (int) bends, 1.0);
  take_apart(rows, n, {{&velocity, 3}, {&slope, 9}, {&bend, bends}});
  const sd_spheres spheres = scene.local();
  of_points.model = shells.all_models();
  of_points.spheres = shells.spheres(spheres, (int) n);
  of_points.w = spheres.w;
  r.resize(3 * points + 3);
  of_points.r = r.data();
  u.resize(3 * points + 3);
  double *b = u.data();    // until the fluid there is known
  sd_multiblob_expand(of_points.model, &of_points.spheres, r.data(), nullptr, b);
  sphere.resize(points);
  for (size_t k = 0; k < n; k++)
    std::fill_n(sphere.begin() + of_points.spheres.first[k], shells.points_of_row(k), (int) k);
  D.resize(3 * points + 3);
  sd_multiblob_drags(&of_points, b, D.data());
}

void BodyScene::flow_at_points(const double *of_spheres, int stride)
{
  const sd_flow_spheres flow = {of_spheres, stride, slope.data(), bend.empty() ? nullptr : bend.data()};
  sd_flow_at_points(&of_points, &flow, u.data());
}

/* Of spheres that the fluid passes with this slip, velocity and spin [6 n]; strains and bends are the
 * fluid's own, or there are none */
void BodyScene::slip_at_points(const std::vector<double> &slip, bool strained)
{
  if (!strained) {
    std::fill(slope.begin(), slope.end(), 0.0);
    bend.clear();
  }
  for (size_t k = 0; k < (size_t) scene.size(); k++) {
    const double *w = &slip[6 * k + 3], vorticity[3] = {2.0 * w[0], 2.0 * w[1], 2.0 * w[2]};
    sd_flow_set_vorticity(vorticity, &slope[9 * k]);
  }
  flow_at_points(slip.data(), 6);
}

/* Of the bodies: points on spheres */
void BodyScene::put_points()
{
  const int n = scene.size(), all = shells.first_of_rows()[n];
  bodies.points = {all, 3, sphere.data(), r.data()};
  bodies.D = D.data();
  whole_shells.resize(n + 1);
  for (int k = 0; k < n; k++)
    whole_shells[k] = (char) sd_multiblob_is_whole(&of_points.spheres, k);
  const char *whole_ones = rigid.on ? whole_shells.data() : nullptr;
  faces = {shells.faces(), of_points.spheres.turn, whole_ones, of_points.spheres.kind,
           of_points.spheres.first};
  bodies.faces = &faces;
  bodies.add = sd_multiblob_add;
  bodies.add_ctx = &of_points;
}

/* u at the points less the slip there */
void BodyScene::slip_of_swimmers()
{
  enum { B1 = 3, B2, BETA, COLUMNS };
  const std::vector<double> rows = scene.rows(COLUMNS, [this](int i, double *out) {
    sd_squirmer_stroke stroke = {};
    if (!given.swims(i, stroke)) return;
    std::copy_n(stroke.e, 3, out);
    out[B1] = stroke.B1;
    out[B2] = stroke.B2;
    out[BETA] = stroke.beta;
  });
  for (size_t k = 0; k < (size_t) scene.size(); k++) {
    const double *row = &rows[COLUMNS * k];
    if (sd_dot(row, row) == 0.0) continue;
    const sd_squirmer_stroke stroke = {{row[0], row[1], row[2]}, row[B1], row[B2], row[BETA]};
    const size_t first = of_points.spheres.first[k];
    const int kind = of_points.spheres.kind[k];
    sd_squirmer_slip(&shells.model(kind), &shells.squirmer(kind), &stroke,
                     of_points.spheres.a[k], &r[3 * first], &u[3 * first]);
  }
}

}    // namespace StokesDyn
