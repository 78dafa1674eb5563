#include "body_scene.h"

#include "ambient.h"
#include "scene_at_boundary.h"

#include "sd_linear.h"

#include "atom.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

BodyScene::BodyScene(const Voice &voice, const Scene &scene, Engine &engine, Shells &shells, const Ambient &ambient,
                     const ClumpPoses &poses, Lubrication &lubrication) :
    Pointers(voice.lmp), voice(voice), scene(scene), engine(engine), shells(shells), ambient(ambient), poses(poses),
    rigid(poses.rigid.settings), given(poses.given), lubrication(lubrication)
{
}

double BodyScene::memory_usage() const
{
  double numbers = 0.0;
  for (const auto *array : {&F, &flow, &resistance, &u, &velocities, &arm, &D, &r, &slope, &bend})
    numbers += (double) array->capacity();
  return sizeof(double) * numbers;
}

void BodyScene::place()
{
  const size_t m = scene.width();
  const auto row = [&](int i, double *out) {
    const double resists[2] = {ambient.drag(i), ambient.spin(i)};
    double load[6];
    given.load(i, load);
    for (size_t d = 0; d < m; d++) {
      out[d] = load[d];
      out[2 * m + d] = resists[d >= 3];
    }
    if (given.velocities)
      ambient.slip(i, out + m);
    else
      ambient.fluid(i, out + m);
  };
  scene.columns(row, {{&F, m}, {&flow, m}, {&resistance, m}});
  if (given.velocities) return;
  refuse_net_force(voice, scene, F, m);
  scene.drift(flow.data(), (int) m, 1.0);
}

void BodyScene::assemble(Films films)
{
  if (films != STANDING_FILMS) film_arm.clear();
  if (shells.on()) place_points();
  arrange();
  stand_at_wall();
  put_together();
  if (films != NO_FILMS) tie_films(films);
  find_known();
  if (given.velocities) return rest_in(flow);
  if (shells.on())
    flow_at_points(velocity.data(), 3);
  else
    u = flow;
  if (given.swims) slip_of_swimmers();
  carry();
}

void BodyScene::rest_in(const std::vector<double> &slip, bool strained)
{
  if (shells.on())
    slip_at_points(slip, strained);
  else
    u = slip;
  carry();
}

// --- who belongs to whom ---------------------------------------------------------------------------

/* The bodies as the core wants them: free spheres, then clumps. With shells, and near a wall, where a
 * sphere is one with its image, all of them have a shape. */
void BodyScene::arrange()
{
  const size_t n = scene.size();
  /* rows of clumps that are not rigid are free spheres as well */
  const int free_ones = rigid.on ? scene.lone() : scene.size();
  member.clear();
  shaped.clear();
  loner.clear();
  whole.assign(n + 1, 0);
  arm.assign(3 * n + 3, 0.0);
  for (int k = 0; k < free_ones; k++) add_free(k);
  for (const ClumpPoses::Clump &clump : poses.clumps()) add(clump);
  size_t at = 0;
  for (sd_body &body : shaped) {
    body.row = &member[at];
    at += body.shape ? body.shape->m : 1;
  }
}

void BodyScene::add_points(const sd_multiblob_shape &shape, const std::vector<int> &rows)
{
  const int *first = shells.first_of_rows();
  for (int k = 0, s = 0; k < shape.points.m; k++) {
    while (shape.row[k] >= shape.first[s + 1]) s++;
    member.push_back(first[rows[s]] + shape.row[k] - shape.first[s]);
  }
}

const sd_multiblob_shape &BodyScene::points_of(const ClumpPoses::Clump &clump) const
{
  return poses.rigid.shapes.points(poses.shape(clump), shells);
}

void BodyScene::add_free(int k)
{
  const double w = scene.local().w[k], eta = 1.0 / (w * w);
  whole[k] = k;
  if (shells.on()) {
    const sd_multiblob_shape &shape = shells.free_sphere(shells.kinds_of_rows()[k]);
    add_points(shape, {k});
    shaped.push_back({&shape.points, {1, 0, 0, 0, 1, 0, 0, 0, 1}, scene.local().a[k], eta, nullptr});
  } else if (slowed_by_wall()) {
    member.push_back(k);
    shaped.push_back({nullptr, {}, 1.0, eta, nullptr});
  } else
    loner.push_back(k);
}

/* Of its spheres, in the pose that it has */
void BodyScene::find_arms(const ClumpPoses::Clump &clump, std::vector<double> &arms) const
{
  const sd_shape &shape = poses.shape(clump).shape;
  for (int k = 0; k < shape.n; k++) {
    const size_t row = scene.row_of_member((int) poses.member_of(clump, k));
    sd_multiply3(clump.pose, shape.x + 3 * (size_t) k, &arms[3 * row]);
  }
}

void BodyScene::add(const ClumpPoses::Clump &clump)
{
  const ClumpShape &is = poses.shape(clump);
  sd_body body = {nullptr, {}, 1.0, clump.eta, nullptr};
  std::vector<int> rows;
  for (int k = 0; k < is.shape.n; k++) {
    const int row = scene.row_of_member((int) poses.member_of(clump, k));
    rows.push_back(row);
    whole[row] = loner.size() + shaped.size();
  }
  find_arms(clump, arm);
  if (shells.on()) {
    const sd_multiblob_shape &shape = points_of(clump);
    double turn[9];
    add_points(shape, rows);
    body.shape = &shape.points;
    sd_multiblob_shape_stand(&shape, clump.pose, body.R, turn);
  } else {
    member.insert(member.end(), rows.begin(), rows.end());
    body.shape = &poses.rigid.shapes.blocks(is, rigid);
    std::copy_n(clump.pose, 9, body.R);
  }
  shaped.push_back(body);
}

sd_bodies BodyScene::undrawn() const
{
  sd_bodies rest = bodies;
  rest.apply = sd_mobility_apply_rest;
  return rest;
}

void BodyScene::tie_films(Films films)
{
  if (!lubrication.settings.on) return;
  if (films != STANDING_FILMS) lubrication.place(scene, &ambient, films == NOISY_FILMS);
  tie.L = lubrication.matrix();
  tie.above = lubrication.those_above();
  bodies.tie = &tie;
  tie.keep = 0;
}

/* Of smaller gaps the factor would be made anew in every solve (stiffest of sd_tie_kept.c). */
static const double GAP_TO_KEEP = 5e-4;

bool BodyScene::films_by_places() const
{
  return bodies.tie && lubrication.settings.gap >= GAP_TO_KEEP && !bodies.known && !rigid.on &&
      !scene.settings.boundary.walled();
}

void BodyScene::stand_films()
{
  lubrication.place(scene, &ambient);
  if (!rigid.on) return;
  film_arm.assign(3 * (size_t) scene.size() + 3, 0.0);
  for (const ClumpPoses::Clump &clump : poses.clumps()) find_arms(clump, film_arm);
}

/* u = 0 at these points: nobody sees anybody */
static sd_status nobody(void *ctx, const double * /*F*/, double *out)
{
  const sd_rigid *points = static_cast<sd_rigid *>(ctx);
  std::fill_n(out, (size_t) points->width * points->n, 0.0);
  return SD_OK;
}

void BodyScene::put_together()
{
  const int n = scene.size(), width = scene.width();
  const bool sees = engine.anybody_sees();
  const bool clumps = rigid.on;    // not one, on any rank: every sphere is a body, in the order of rows
  bodies = {};
  bodies.lone = loner.size();
  bodies.loner = loner.data();
  bodies.shaped = shaped.size();
  bodies.body = shaped.data();
  bodies.none_shaped = !shells.on() && !rigid.on && !slowed_by_wall();
  bodies.spheres = {n, width, clumps ? whole.data() : nullptr, clumps ? arm.data() : nullptr};
  bodies.points = {n, width, nullptr, nullptr};
  bodies.film_arm = film_arm.empty() ? nullptr : film_arm.data();
  bodies.D = resistance.data();
  bodies.apply = sees ? sd_mobility_apply : nobody;
  bodies.apply_ctx = sees ? (void *) engine.mobility() : &bodies.points;
  bodies.world = engine.ranks();
  if (shells.on()) put_points();
}

// --- what is given ---------------------------------------------------------------------------------

/* Bodies whose velocity is known: all of them, at rest; or those that are held or spun */
void BodyScene::find_known()
{
  const size_t count = loner.size() + shaped.size();
  known.assign(count + 1, given.velocities ? SD_BODY_HELD : SD_BODY_FREE);
  velocities.clear();
  if (given.velocities || given.known) bodies.known = known.data();
  if (given.velocities || !given.known) return;
  velocities.assign(6 * count + 6, 0.0);
  std::vector<double> rows = scene.rows(7, [this](int i, double *out) { out[6] = given.known(i, out); });
  scene.drift(rows.data(), 7, 1.0);
  const size_t lone_ones = first_clump();
  for (size_t b = 0; b < lone_ones; b++) {    // their rows come first
    const double *row = &rows[7 * b];
    known[b] = (char) row[6];
    if (known[b]) std::copy_n(row, 6, &velocities[6 * b]);
  }
  for (size_t c = 0, b = lone_ones; c < poses.clumps().size(); c++, b++) {
    const ClumpPoses::Clump &clump = poses.clumps()[c];
    known[b] = (char) clump.known;
    if (clump.known) std::copy_n(clump.V, 6, &velocities[6 * b]);
  }
}

// --- near a wall ---------------------------------------------------------------------------------

/* Spheres of a body, in the order of its shape */
std::vector<int> BodyScene::spheres_of(const sd_body &body) const
{
  std::vector<int> rows;
  for (int k = 0; k < (body.shape ? body.shape->m : 1); k++) {
    const int row = shells.on() ? sphere[body.row[k]] : body.row[k];
    if (rows.empty() || rows.back() != row) rows.push_back(row);
  }
  return rows;
}

sd_status BodyScene::stand_at_wall(sd_body &body, double count)
{
  const sd_spheres spheres = scene.local();
  const std::vector<int> rows = spheres_of(body);
  std::vector<double> x, a, turn;
  std::vector<sd_multiblob_mask> mask;
  std::vector<int> kind, first(1, 0);
  double centre[3], extent = 0.0;
  sd_minus(spheres.x + 3 * (size_t) rows[0], &arm[3 * (size_t) rows[0]], centre);
  for (size_t k : rows) {
    x.insert(x.end(), spheres.x + 3 * k, spheres.x + 3 * k + 3);
    a.push_back(spheres.a[k]);
    extent = std::max(extent, std::sqrt(sd_dot(&arm[3 * k], &arm[3 * k])) + spheres.a[k]);
    if (!shells.on()) continue;
    turn.insert(turn.end(), shells.turn_of(k), shells.turn_of(k) + 9);
    mask.push_back(shells.mask_of(k));
    kind.push_back(shells.kinds_of_rows()[k]);
    first.push_back(first.back() + shells.points_of_row(k));
  }
  const sd_wall &wall = scene.settings.boundary.nearest(centre);
  const double height = sd_wall_height(&wall, centre);
  if (body.shape && !sd_body_wall_pays(body.shape->m, (int) count, height, extent)) return SD_OK;
  standing.emplace_back();
  sd_body_shape *shape = &standing.back();
  const sd_multiblob_spheres stand = {x.data(),    a.data(),   turn.data(),
                                       mask.data(), (int) rows.size(), kind.data(), first.data()};
  const sd_status status = shells.on()
      ? sd_multiblob_wall_shape(shells.all_models(), &wall, &stand, centre, shape)
      : sd_body_wall_shape(&wall, (int) rows.size(), 6, x.data(), a.data(), centre, shape);
  if (status == SD_ESINGULAR && body.shape) return SD_OK;    // those of open space will do
  if (status != SD_OK) return status;
  body = {shape, {1, 0, 0, 0, 1, 0, 0, 0, 1}, 1.0, body.eta, body.row};
  return SD_OK;
}

/* The bodies have been arranged. */
void BodyScene::stand_at_wall()
{
  standing.clear();
  if (!slowed_by_wall()) return;
  open = shaped;
  const double count = sum_of_all(world, (double) shaped.size());
  for (sd_body &body : shaped) {
    const sd_status status = stand_at_wall(body, count);
    if (status != SD_OK)
      voice.of("keyword wall: blocks of a body").fail_one(sd_status_string(status));
  }
}

/* A strain carries clumps as their shells say. */
void BodyScene::carry()
{
  const auto &clumps = poses.clumps();
  if (!ambient.gradients() || clumps.empty() || shells.on() || slowed_by_wall()) return;
  std::vector<double> gradient(9 * clumps.size()), work(sd_bodies_work(&bodies));
  double centre[3];
  for (size_t c = 0; c < clumps.size(); c++) {
    const sd_clump_motion motion = poses.look_at(clumps[c]);
    const double *pose = clumps[c].pose;
    sd_clump_flow(&poses.shape(clumps[c]).shape, &motion, pose, pose + 9, centre, &gradient[9 * c]);
  }
  sd_bodies_carry(&bodies, gradient.data(), work.data(), u.data());
}

}    // namespace StokesDyn
