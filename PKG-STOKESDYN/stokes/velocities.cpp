#include "velocities.h"

#include "callback.h"
#include "keywords.h"
#include "settings.h"

#include "sd_linear.h"

#include "atom.h"

#include <algorithm>
#include <cmath>
#include <iterator>

using namespace LAMMPS_NS;

namespace StokesDyn {

Velocities::Velocities(LAMMPS *lmp, const Parts &parts) :
    Pointers(lmp), scene(parts.scene), ambient(parts.ambient), rigid(parts.rigid),
    lubrication(parts.lubrication)
{
}

double Velocities::memory_usage() const
{
  double numbers = 24.0 * spheres.eta.capacity();
  for (const auto *array : {&F, &u, &v, &exerted, &D, &arm, &V, &work, &gradient})
    numbers += array->capacity();
  return sizeof(double) * numbers;
}

// --- the clumps where they stand -----------------------------------------------------------------

/* What clumps must know of their spheres; velocities are those of the images side by side. */
void Velocities::gather(bool moving)
{
  enum { ETA, RADIUS, X, MOTION = X + 3, TURNING = MOTION + 3, FLOW = TURNING + 3, GRADIENT = FLOW + 3 };
  const double *gradients = ambient.gradients(), *jumps = ambient.jumps();
  const bool turns = !moving || scene.settings.rotation;
  const size_t columns = gradients ? GRADIENT + 9 : FLOW, n = rigid.members().size();
  const std::vector<double> rows = scene.whole.gather((int) columns, [&](int i, double *row) {
    row[ETA] = ambient.active()[i] ? ambient.viscosity(i) : 0.0;
    row[RADIUS] = atom->radius[i];
    for (size_t d = 0; d < 3; d++) {
      row[MOTION + d] = moving ? atom->v[i][d] : load(i, d);
      if (turns) row[TURNING + d] = moving ? atom->omega[i][d] : load(i, 3 + d);
    }
    if (!gradients) return;
    std::copy_n(ambient.velocity(i), 3, row + FLOW);
    std::copy_n(gradients + 9 * (size_t) i, 9, row + GRADIENT);
  });
  std::vector<double> ordered(columns * n + 1);
  for (size_t k = 0; k < n; k++) {
    const size_t m = rigid.members()[k];
    const int *steps = &scene.whole.steps[3 * m];
    double *row = &ordered[columns * k];
    std::copy_n(&rows[columns * m], columns, row);
    std::copy_n(&scene.whole.x[3 * m], 3, row + X);
    if (jumps && moving) sd_add_edges(jumps, steps, row + MOTION);
    if (jumps && gradients) sd_add_edges(jumps, steps, row + FLOW);
  }
  const size_t flows = gradients ? 3 : 0;
  take_apart(ordered, n, {{&spheres.eta, 1}, {&spheres.radius, 1}, {&spheres.x, 3}, {&spheres.motion, 3},
                          {&spheres.turning, 3}, {&spheres.flow, flows}, {&spheres.gradient, 3 * flows}});
}

void Velocities::find(bool moving)
{
  found.take(scene.since().lists);
  all_clumps.clear();
  all_lone.clear();
  const auto free = [this](int i) {
    return !rigid.settings.on || atom->molecule[i] == 0;
  };
  if (!moving)    // nobody asks for them
    std::copy_if(ambient.who().begin(), ambient.who().end(), std::back_inserter(all_lone), free);
  if (!rigid.settings.on) return;
  const auto &all = rigid.find();
  gather(moving);
  int64_t split = RigidClumps::NOBODY;
  std::vector<int64_t> bent;
  for (size_t b = 0; b < all.size(); b++) {
    const RigidClumps::Body &body = all[b];
    Clump clump = {(int) b, {}, 0.0, {}, false};
    int taking_part = 0;
    for (int k = 0; k < body.n; k++) {
      const double eta_k = spheres.eta[body.begin + k];
      taking_part += eta_k > 0.0;
      clump.eta += eta_k;
    }
    clump.eta /= body.n;
    if (taking_part == 0) continue;
    if (taking_part < body.n) split = std::min(split, body.molecule);
    if (!rigid.fits(body, &spheres.radius[body.begin], clump.pose))
      bent.push_back(body.molecule);
    all_clumps.push_back(clump);
  }
  if (rigid.settle(split, bent)) return find(moving);
  find_held();
}

// --- rows ------------------------------------------------------------------------------------------

/* Clumps whose velocity is given: by that of their first sphere, on its image. */
void Velocities::find_held()
{
  for (Clump &clump : all_clumps) clump.held = false;
  if (!held || !rigid.settings.on) return;
  const std::vector<double> of_member = scene.whole.gather(7, [this](int i, double *out) {
    out[0] = held(i, out + 1);
  });
  int64_t split = RigidClumps::NOBODY;
  for (Clump &clump : all_clumps) {
    const double *first = &of_member[7 * member_of(clump, 0)];
    clump.held = first[0] != 0.0;
    for (int k = 1; k < body(clump).n; k++)
      if ((of_member[7 * member_of(clump, k)] != 0.0) != clump.held)
        split = std::min(split, body(clump).molecule);
    if (!clump.held) continue;
    double arm[3], turning[3];
    std::copy_n(first + 1, 6, clump.V);
    if (ambient.jumps())
      sd_add_edges(ambient.jumps(), &scene.whole.steps[3 * member_of(clump, 0)], clump.V);
    sd_minus(clump.pose + 9, &spheres.x[3 * (size_t) body(clump).begin], arm);
    sd_cross(clump.V + 3, arm, turning);
    for (int d = 0; d < 3; d++) clump.V[d] += turning[d];
  }
  split = smallest_of_all(world, split);
  if (split != RigidClumps::NOBODY)
    Voice(lmp, "Fix stokes_dynamics/overdamped")
        .fail("keyword held: the clump of molecule " + std::to_string(split) +
              " is only partly in the group: all of its spheres must be in it, or none");
}

/* [6 bodies] what is given of velocities, for the core; is_held tells which */
std::vector<double> Velocities::given_velocities()
{
  const size_t bodies = loner.size() + shaped.size();
  std::vector<double> given(6 * bodies + 6, 0.0);
  is_held.assign(bodies + 1, 0);
  std::vector<double> rows = scene.rows(7, [this](int i, double *out) { out[6] = held(i, out); });
  scene.drift(rows.data(), 7, 1.0);
  const size_t lone_ones = bodies - clumps().size();    // whose rows come first
  for (size_t b = 0; b < lone_ones; b++) {
    const double *row = &rows[7 * b];
    is_held[b] = (char) row[6];
    if (is_held[b]) std::copy_n(row, 6, &given[6 * b]);
  }
  for (size_t c = 0, b = lone_ones; c < clumps().size(); c++, b++) {
    is_held[b] = clumps()[c].held ? SD_BODY_HELD : SD_BODY_FREE;
    if (is_held[b]) std::copy_n(clumps()[c].V, 6, &given[6 * b]);
  }
  return given;
}

/* Forces on the spheres, the fluid at them, their drags */
void Velocities::place(int width)
{
  const size_t m = width;
  const std::vector<double> rows = scene.rows(3 * width, [&](int i, double *out) {
    for (size_t d = 0; d < m; d++) {
      out[d] = load(i, d);
      out[2 * m + d] = ambient.resistance(i, d);
    }
    ambient.fluid(i, out + m);
  });
  take_apart(rows, scene.size(), {{&F, m}, {&u, m}, {&D, m}});
  scene.drift(u.data(), width, 1.0);
}

/* The bodies as the core wants them: free spheres, then clumps. With shells, and near a wall, where a
 * sphere is one with its image, all of them have a shape. */
void Velocities::arrange()
{
  const Shells *shells = scene.shells;
  const size_t n = scene.size(), P = shells ? shells->points() : 1;
  const bool wall = scene.settings.wall.sign && scene.settings.rotation;
  /* rows of clumps that are not rigid are free spheres as well */
  const int free_ones = rigid.settings.on ? scene.lone() : scene.size();
  member.clear();
  shaped.clear();
  loner.clear();
  whole.assign(n + 1, 0);
  arm.assign(3 * n + 3, 0.0);
  const auto add_points = [&](const sd_multiblob_shape &shape, const std::vector<int> &rows) {
    for (int k = 0; k < shape.points.m; k++)
      member.push_back(P * rows[shape.row[k] / P] + shape.row[k] % P);
  };
  for (int k = 0; k < free_ones; k++) {
    const double w = scene.local().w[k], eta = 1.0 / (w * w);
    whole[k] = k;
    if (shells) {
      const sd_multiblob_shape &shape = shells->free_sphere();
      add_points(shape, {k});
      shaped.push_back(
          {&shape.points, {1, 0, 0, 0, 1, 0, 0, 0, 1}, scene.local().a[k], eta, nullptr});
    } else if (wall) {
      member.push_back(k);
      shaped.push_back({nullptr, {}, 1.0, eta, nullptr});
    } else
      loner.push_back(k);
  }
  for (const Clump &clump : clumps()) {
    const ClumpShape &is = shape(clump);
    sd_body body = {nullptr, {}, 1.0, clump.eta, nullptr};
    std::vector<int> rows;
    for (int k = 0; k < is.shape.n; k++) {
      const int row = scene.row_of_member((int) member_of(clump, k));
      rows.push_back(row);
      whole[row] = loner.size() + shaped.size();
      sd_multiply3(clump.pose, is.shape.x + 3 * (size_t) k, &arm[3 * (size_t) row]);
    }
    if (shells) {
      const sd_multiblob_shape &shape = rigid.shapes.points(is, shells->model());
      double turn[9];
      add_points(shape, rows);
      body.shape = &shape.points;
      sd_multiblob_shape_stand(&shape, clump.pose, body.R, turn);
    } else {
      member.insert(member.end(), rows.begin(), rows.end());
      body.shape = &rigid.shapes.blocks(is, rigid.settings);
      std::copy_n(clump.pose, 9, body.R);
    }
    shaped.push_back(body);
  }
  size_t at = 0;
  for (sd_body &body : shaped) {
    body.row = &member[at];
    at += body.shape ? body.shape->m : 1;
  }
  V.resize(6 * (loner.size() + shaped.size()) + 6);
}

/* u = 0: nobody sees anybody */
static sd_status nobody(void *ctx, const double * /*F*/, double *out)
{
  const sd_mobility_scene *scene = static_cast<sd_mobility_scene *>(ctx);
  std::fill_n(out, (size_t) scene->how.width * scene->n, 0.0);
  return SD_OK;
}

sd_bodies Velocities::bodies(int width)
{
  const int n = scene.size();
  sd_bodies A = {};
  A.lone = loner.size();
  A.loner = loner.data();
  A.shaped = shaped.size();
  A.body = shaped.data();
  A.spheres = {n, width, whole.data(), arm.data()};
  A.points = {n, width, nullptr, nullptr};
  A.D = D.data();
  alone.how.width = width;
  alone.n = n;
  const bool sees = scene.anybody_sees();
  A.apply = sees ? sd_mobility_apply : nobody;
  A.apply_ctx = sees ? (void *) scene.mobility() : &alone;
  A.world = scene.ranks();
  return A;
}

sd_bodies Velocities::assemble(int width)
{
  if (scene.shells)
    place_shells();
  else
    place(width);
  arrange();
  in_open_space = shaped;
  stand_at_wall();
  return scene.shells ? bodies_of_shells() : bodies(width);
}

// --- near a wall ---------------------------------------------------------------------------------

/* Spheres of a body, in the order of its shape */
std::vector<int> Velocities::spheres_of(const sd_body &body) const
{
  const int points = scene.shells ? scene.shells->points() : 1;
  std::vector<int> rows;
  for (int k = 0; k < (body.shape ? body.shape->m : 1); k++)
    if (rows.empty() || rows.back() != body.row[k] / points) rows.push_back(body.row[k] / points);
  return rows;
}

sd_status Velocities::stand_at_wall(sd_body &body, double bodies)
{
  const sd_wall &wall = scene.settings.wall;
  const sd_spheres spheres = scene.local();
  const std::vector<int> rows = spheres_of(body);
  std::vector<double> x, a, turn;
  std::vector<sd_multiblob_mask> mask;
  double centre[3], extent = 0.0;
  sd_minus(spheres.x + 3 * (size_t) rows[0], &arm[3 * (size_t) rows[0]], centre);
  for (size_t k : rows) {
    x.insert(x.end(), spheres.x + 3 * k, spheres.x + 3 * k + 3);
    a.push_back(spheres.a[k]);
    extent = std::max(extent, std::sqrt(sd_dot(&arm[3 * k], &arm[3 * k])) + spheres.a[k]);
    if (!scene.shells) continue;
    turn.insert(turn.end(), scene.shells->turns() + 9 * k, scene.shells->turns() + 9 * k + 9);
    mask.push_back(scene.shells->masks()[k]);
  }
  const double height = sd_wall_height(&wall, centre);
  if (body.shape && !sd_body_wall_pays(body.shape->m, (int) bodies, height, extent)) return SD_OK;
  standing.emplace_back();
  sd_body_shape *shape = &standing.back();
  const sd_multiblob_spheres shells = {x.data(), a.data(), turn.data(), mask.data(),
                                       (int) rows.size()};
  const sd_status status = scene.shells
      ? sd_multiblob_wall_shape(&scene.shells->model(), &wall, &shells, centre, shape)
      : sd_body_wall_shape(&wall, (int) rows.size(), 6, x.data(), a.data(), centre, shape);
  if (status == SD_ESINGULAR && body.shape) return SD_OK;    // those of open space will do
  if (status != SD_OK) return status;
  body = {shape, {1, 0, 0, 0, 1, 0, 0, 0, 1}, 1.0, body.eta, body.row};
  return SD_OK;
}

/* The bodies have been arranged. */
void Velocities::stand_at_wall()
{
  standing.clear();
  if (!scene.settings.wall.sign || !scene.settings.rotation) return;
  const double bodies = sum_of_all(world, (double) shaped.size());
  for (sd_body &body : shaped) {
    const sd_status status = stand_at_wall(body, bodies);
    if (status != SD_OK)
      Voice(lmp, StokesSettings::COMMAND)
          .of("keyword wall: blocks of a body")
          .fail_one(sd_status_string(status));
  }
}

// --- the loop --------------------------------------------------------------------------------------

/* A strain carries clumps as their shells say. */
void Velocities::carry(const sd_bodies &A, double *flow)
{
  if (!ambient.gradients() || clumps().empty() || scene.shells || scene.settings.wall.sign) return;
  gradient.resize(9 * clumps().size());
  double centre[3];
  for (size_t c = 0; c < clumps().size(); c++) {
    const sd_clump_motion motion = look_at(clumps()[c]);
    const double *pose = clumps()[c].pose;
    sd_clump_flow(&shape(clumps()[c]).shape, &motion, pose, pose + 9, centre, &gradient[9 * c]);
  }
  work.resize(sd_bodies_work(&A));
  sd_bodies_carry(&A, gradient.data(), work.data(), flow);
}

sd_status Velocities::solve(const sd_bodies &A, const sd_bodies_problem &problem, Guess &guess,
                            sd_bodies_report &report)
{
  v.resize(sd_bodies_loads(&A) + 6);
  exerted.resize(sd_bodies_loads(&A) + 6);
  work.resize(sd_bodies_work(&A));
  const sd_bodies_motion motion = {guess.l.data(), guess.v.data(), V.data(), v.data(),
                                   exerted.data()};
  const sd_status status = sd_bodies_solve(&A, &problem, &motion, work.data(), &report);
  fail_if_alone(Voice(lmp, StokesSettings::COMMAND).at_step(), status);
  return status;
}

/* Everybody is held, at rest in a fluid that moves with the slip. */
sd_status Velocities::resist(const How &how, const std::vector<double> &slip, Guess &guess,
                             std::vector<double> &on_spheres, sd_bodies_report &report)
{
  sd_bodies A = assemble(how.width);
  const std::vector<char> held(sd_bodies_count(&A) + 1, SD_BODY_HELD);
  A.held = held.data();
  const size_t m = how.width, rows = m * scene.size();
  if (scene.shells) {
    if (how.unstrained) {
      std::fill(slope.begin(), slope.end(), 0.0);
      bend.clear();
    }
    slip_at_points(slip.data());
  } else {
    std::copy_n(slip.begin(), rows, u.begin());
    guess.l.assign(rows + m, 0.0);
    for (size_t j = 0; j < rows && how.warm; j++) guess.l[j] = -on_spheres[j];
  }
  carry(A, u.data());
  const sd_bodies_problem problem = {u.data(), F.data(),      nullptr,
                                     how.warm, how.tolerance, how.max_iter};
  const sd_status status = solve(A, problem, guess, report);
  for (size_t j = 0; j < rows; j++) on_spheres[j] = -exerted[j];
  return status;
}

/* By the numbers of each sphere, those of its points one after the other */
void Velocities::draw_forces(const sd_bodies &A, int width, const Draw &draw)
{
  const size_t n = scene.size(), m = sd_bodies_rows(&A) / std::max(n, (size_t) 1);
  std::vector<double> w(m * n + 1), pushed(sd_bodies_loads(&A) + width);
  for (const Clump &clump : clumps()) rigid.shapes.take_root(shape(clump));
  if (scene.shells) scene.shells->take_root();
  for (size_t k = 0; k < n; k++)
    sd_random_normals(&draw.of_spheres, scene.tag((int) k), (int) m, &w[m * k]);
  sd_noise_report report = {};
  sd_status status = sd_bodies_draw(draw.noise, &A, in_open_space.data(), w.data(), draw.tolerance,
                                    pushed.data(), &report);
  if (status == SD_OK && A.tie) status = lubrication.draw(scene, draw.of_films, pushed.data());
  draw.report(status, report);
  for (size_t j = 0; j < (size_t) width * n; j++) F[j] += pushed[j] *= draw.scale;
  scene.to_atoms(width, pushed.data(), draw.take);
}

sd_status Velocities::together(const How &how, Guess &guess, const Take &take,
                               sd_bodies_report &report)
{
  sd_bodies A = assemble(how.width);
  if (lubrication.settings.on) {
    lubrication.place(scene, ambient, how.draw != nullptr);
    tie.L = lubrication.matrix();
    A.tie = &tie;
  }
  carry(A, u.data());
  std::vector<double> given;
  if (held) {
    given = given_velocities();
    A.held = is_held.data();
  }
  if (how.draw) draw_forces(A, how.width, *how.draw);
  const sd_bodies_problem problem = {u.data(), F.data(),      held ? given.data() : nullptr,
                                     how.warm, how.tolerance, how.max_iter};
  const sd_status status = solve(A, problem, guess, report);
  for (size_t c = 0; c < clumps().size(); c++)
    std::copy_n(&V[6 * (sd_bodies_count(&A) - clumps().size() + c)], 6, all_clumps[c].V);
  const size_t m = how.width, n = scene.size();
  std::vector<double> moved(2 * m * n + 2 * m);
  if (scene.shells) moved_with = v;
  scene.drift(v.data(), how.width, -1.0);    // an atom's, not those of the image next to its clump
  for (size_t k = 0; k < n; k++) {
    double *row = &moved[2 * m * k];
    std::copy_n(&v[m * k], m, row);
    for (size_t d = 0; d < m; d++) row[m + d] = -exerted[m * k + d];
  }
  scene.to_atoms(2 * how.width, moved.data(),
                 [&](int i, const double *row) { take(i, row, row + m); });
  return status;
}

}    // namespace StokesDyn
