/* Of solve: what noise adds to the solve of a step, as slip of the points and forces of films. */
#include "solve.h"

#include "keywords.h"
#include "settings.h"

#include "sd_linear.h"

#include "domain.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* Of each sphere, those of its points one after the other */
std::vector<double> Solve::numbers(const sd_random_key &of_spheres) const
{
  std::vector<double> w(sd_bodies_unknowns(&bodies.bodies) + 1);
  double *next = w.data();
  for (size_t k = 0; k < (size_t) scene.size(); k++) {
    const int m = scene.shells ? 3 * scene.shells->points_of_row(k) : bodies.width;
    sd_random_normals(&of_spheres, scene.tag((int) k), m, next);
    next += m;
  }
  return w;
}

/* Where the sum is split, the near part's process and the waves at once; a near part that is not positive is
 * told of, and the whole matrix takes its place. */
void Solve::draw_slip(const Draw &draw)
{
  const sd_bodies &A = bodies.bodies;
  const size_t rows = sd_bodies_unknowns(&A);
  const Voice voice(lmp, StokesSettings::COMMAND);
  const std::vector<double> w = numbers(draw.of_spheres);
  std::vector<double> waves(rows + 1);
  slip.assign(rows + 6, 0.0);
  bool divided = scene.anybody_sees() && sd_mobility_divides(scene.mobility());
  sd_noise_report report = {};
  sd_status status = SD_OK;
  const auto process = [&](const sd_bodies &matrix, const sd_ewald *split) {
    const auto roots = shapes.roots(voice, bodies.in_open_space(), split);
    const sd_bodies_blocks blocks = {bodies.in_open_space().data(), roots.data()};
    status = sd_bodies_draw(draw.noise, &matrix, &blocks, w.data(), draw.tolerance, slip.data(), &report);
  };
  if (divided) {
    process(bodies.undrawn(), scene.splitting());
    if (status == SD_EINDEFINITE) {
      divided = false;
      draw.not_positive();
    }
  }
  if (!divided) process(A, nullptr);
  if (status == SD_OK && divided) status = sd_mobility_draw(scene.mobility(), &draw.of_waves, waves.data());
  draw.report(status, report, divided);
  for (size_t j = 0; j < rows; j++) slip[j] = draw.scale * (slip[j] + (divided ? waves[j] : 0.0));
}

/* How each body follows, and whether that leaves nothing of the drift: not where the mobility is not that of
 * an unbounded fluid of one viscosity, or a coordinate is held by something else. */
void Solve::find_followers()
{
  const std::vector<sd_body> &all = bodies.in_open_space();
  const Voice voice(lmp, StokesSettings::COMMAND);
  follow.assign(all.size() + 1, nullptr);
  double left = scene.settings.boundary.walled() || domain->dimension == 2 ||
      ambient.settings.visc.is_atom_style() || ambient.settings.grid_has_visc;
  for (size_t b = 0; b < all.size(); b++) {
    const int number = bodies.bodies.lone + (int) b;
    follow[b] = shapes.follow(voice, all[b]);
    if (!follow[b]) continue;
    if (!follow[b]->exact) left = 1.0;
    if (all[b].shape->turns != SD_BODY_STILL && sd_bodies_known(&bodies.bodies, number) == SD_BODY_PINNED) left = 1.0;
  }
  MPI_Allreduce(MPI_IN_PLACE, &left, 1, MPI_DOUBLE, MPI_MAX, world);
  differs = left != 0.0;
}

/* What bodies that turn leave of the drift, constant in their axes: slip, and torque on their first sphere */
void Solve::add_own()
{
  const sd_bodies &A = bodies.bodies;
  const std::vector<sd_body> &all = bodies.in_open_space();
  for (size_t b = 0; b < all.size(); b++) {
    const sd_body_follow *own = follow[b];
    if (!own || !own->slip || sd_bodies_known(&A, A.lone + (int) b) != SD_BODY_FREE) continue;
    const size_t width = A.points.width;
    double turned[3];
    for (size_t i = 0; i < (size_t) own->n; i += 3) {
      sd_multiply3(all[b].R, own->slip + i, turned);
      double *there = &slip_left[width * all[b].row[i / width] + i % width];
      for (size_t d = 0; d < 3; d++) there[d] += kT / all[b].eta * turned[d];
    }
    sd_multiply3(all[b].R, own->torque, turned);
    const size_t point = all[b].row[0], sphere = A.points.whole ? A.points.whole[point] : point;
    for (size_t d = 0; d < 3; d++) load_left[A.spheres.width * sphere + 3 + d] -= kT * turned[d];
  }
}

void Solve::draw(const Draw &draw)
{
  const sd_bodies &A = bodies.bodies;
  const size_t count = sd_bodies_count(&A);
  const Voice voice = Voice(lmp, StokesSettings::COMMAND).at_step();
  shapes.begin(scene.all_epochs().run);
  kT = draw.kT;
  draw_slip(draw);
  pushed.assign(sd_bodies_loads(&A) + bodies.width, 0.0);
  slip_left.assign(slip.size(), 0.0);
  load_left.assign(pushed.size(), 0.0);
  sd_status status = SD_OK;
  const size_t by_bodies = (24 + SD_TIE_OF_BODY) * count, by_spheres = SD_TIE_OF_SPHERE * (size_t) scene.size();
  std::vector<double> scratch(by_bodies + by_spheres + 1);
  if (A.tie) {
    status = bodies.draw_films(draw.of_films, pushed.data());
    if (status == SD_OK) status = sd_tie_make(&A, {scratch.data(), &scratch[by_bodies]});
  }
  for (double &force : pushed) force *= draw.scale;
  find_followers();
  of_points.assign(6 * count + 6, 0.0);
  of_films.assign(6 * count + 6, 0.0);
  const sd_drifter d = drifter();
  const sd_drifter_push all = {bodies.u.data(), slip.data(), bodies.F.data(), pushed.data(),
                               bodies.velocities.empty() ? nullptr : bodies.velocities.data(), 0.1 * draw.tolerance};
  if (status == SD_OK)
    status = sd_drifter_move(&A, &d, &all, scratch.data(), of_points.data(), of_films.data());
  if (status != SD_OK) fail_by(voice.of("half a step of noise"), status);
  if (!differs) add_own();
}

// --- what is left of the drift, by differences ---------------------------------------------------------

/* Over the radius of the smallest sphere: the error falls with its square, that of rounding grows. */
static const double FAR = 1e-4;

std::vector<double> Solve::random_moves(const Draw &draw)
{
  const sd_bodies &A = bodies.bodies;
  const size_t count = sd_bodies_count(&A), lone = bodies.first_clump();
  std::vector<double> W(6 * count + 6), unit(6 * count + 6);
  std::vector<int64_t> tag(count, INT64_MAX);
  std::vector<double> size(count, scene.smallest());
  reach = FAR * scene.smallest();
  for (size_t k = 0; k < (size_t) scene.size(); k++) {
    const size_t b = sd_rigid_whole(&A.spheres, (int) k);
    const double *arm = &bodies.arms()[3 * k];
    tag[b] = std::min(tag[b], scene.tag((int) k));
    size[b] = std::max(size[b], std::sqrt(sd_dot(arm, arm)));
  }
  for (size_t b = 0; b < count; b++) {
    double normals[6];
    sd_random_normals(&draw.of_differences, tag[b], 6, normals);
    for (size_t d = 0; d < 6; d++) {
      const bool turning = d >= 3, free = !sd_bodies_velocity_known(&A, (int) b, (int) d) && (!turning || b >= lone);
      const bool leaves = domain->dimension == 2 && d >= 2 && d < 5;
      const double length = turning ? size[b] : 1.0;
      if (!free || leaves) continue;
      W[6 * b + d] = normals[d] / length;
      unit[6 * b + d] = normals[d] * length;
    }
  }
  of_moves.assign(sd_bodies_unknowns(&A) + 1, 0.0);
  const sd_drifter d = drifter();
  sd_drifter_spread(&A, &d, unit.data(), of_moves.data());
  for (double &w : W) w *= reach;
  return W;
}

/* A W stays as it is, the matrices are those of the place. Torques of clumps act on their first sphere. */
void Solve::difference(double sign)
{
  const sd_bodies &A = bodies.bodies;
  const size_t count = sd_bodies_count(&A), n = scene.size();
  std::vector<double> scratch(18 * count + 6 * n + sd_bodies_unknowns(&A) + 1), load(6 * count + 6);
  const sd_status status = sd_drifter_difference(&A, of_moves.data(), sign * kT / (2.0 * reach), scratch.data(),
                                                 slip_left.data(), load.data());
  if (status != SD_OK)
    fail_by(Voice(lmp, StokesSettings::COMMAND).at_step().of("the drift by differences"), status);
  std::vector<char> done(count + 1, 0);
  for (size_t k = 0; k < n; k++) {
    const size_t b = sd_rigid_whole(&A.spheres, (int) k);
    for (size_t d = 3; d < 6 && !done[b] && b >= bodies.first_clump(); d++)
      load_left[(size_t) A.spheres.width * k + d] += load[6 * b + d];
    done[b] = 1;
  }
}

void Solve::push()
{
  for (long j = 0; j < sd_bodies_unknowns(&bodies.bodies); j++) bodies.u[j] += slip[j] + slip_left[j];
  for (long j = 0; j < sd_bodies_loads(&bodies.bodies); j++) bodies.F[j] += pushed[j] + load_left[j];
}

void Solve::push_alone()
{
  if (bodies.bodies.tie) bodies.rest_films();
  std::copy_n(slip.begin(), bodies.u.size(), bodies.u.begin());
  std::copy_n(pushed.begin(), bodies.F.size(), bodies.F.begin());
  std::fill(bodies.velocities.begin(), bodies.velocities.end(), 0.0);
}

}    // namespace StokesDyn
