#include "solve_noise.h"

#include "domain.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

SolveNoise::SolveNoise(const Voice &voice, const Scene &scene, Engine &engine, BodyScene &bodies, const Shells &shells,
                       const StokesSettings &settings) :
    Pointers(voice.lmp), voice(voice), scene(scene), engine(engine), bodies(bodies), shells(shells), settings(settings)
{
}

void SolveNoise::forget()
{
  pushed.clear();
  moments_left.clear();
}

/* Of each sphere, those of its points one after the other */
std::vector<double> SolveNoise::numbers(const sd_random_key &of_spheres) const
{
  std::vector<double> w(sd_bodies_unknowns(&bodies.bodies) + 1);
  double *next = w.data();
  for (size_t k = 0; k < (size_t) scene.size(); k++) {
    const int m = shells.on() ? 3 * shells.points_of_row(k) : scene.width();
    sd_random_normals(&of_spheres, scene.tag((int) k), m, next);
    next += m;
  }
  return w;
}

/* Where the sum is split, the near part's process and the waves at once; a near part that is not positive is
 * told of, and the whole matrix takes its place. */
void SolveNoise::draw_slip(const Draw &draw)
{
  const sd_bodies &A = bodies.bodies;
  const size_t rows = sd_bodies_unknowns(&A);
  const std::vector<double> w = numbers(draw.of_spheres);
  std::vector<double> waves(rows + 1);
  slip.assign(rows + 6, 0.0);
  bool divided = engine.anybody_sees() && sd_mobility_divides(engine.mobility());
  sd_noise_report report = {};
  sd_status status = SD_OK;
  const auto process = [&](const sd_bodies &matrix, const sd_ewald *split) {
    const auto roots = shapes.roots(voice, bodies.in_open_space(), split);
    const sd_bodies_blocks blocks = {bodies.in_open_space().data(), roots.data()};
    status = sd_bodies_draw(draw.noise, &matrix, &blocks, w.data(), draw.tolerance, slip.data(), &report);
  };
  if (divided) {
    process(bodies.undrawn(), engine.splitting());
    if (status == SD_EINDEFINITE) {
      divided = false;
      draw.not_positive();
    }
  }
  if (!divided) process(A, nullptr);
  if (status == SD_OK && divided) status = sd_mobility_draw(engine.mobility(), &draw.of_waves, waves.data());
  draw.report(status, report, divided);
  sd_noise_join((long) rows, draw.scale, divided ? waves.data() : nullptr, slip.data());
}

/* How each body follows, and whether that leaves nothing of the drift: not where the mobility is not that of
 * an unbounded fluid of one viscosity, or a coordinate is held by something else. */
void SolveNoise::find_followers()
{
  const std::vector<sd_body> &all = bodies.in_open_space();
  follow.assign(all.size() + 1, nullptr);
  double left = scene.settings.boundary.walled() || domain->dimension == 2 ||
      settings.ambient.visc.is_atom_style() || settings.ambient.grid_has_visc;
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

void SolveNoise::draw(const Draw &draw)
{
  const sd_bodies &A = bodies.bodies;
  const size_t count = sd_bodies_count(&A);
  moments_left.clear();
  shapes.begin(scene.all_epochs().run);
  kT = draw.kT;
  draw_slip(draw);
  pushed.assign(sd_bodies_loads(&A) + scene.width(), 0.0);
  slip_left.assign(slip.size(), 0.0);
  load_left.assign(pushed.size(), 0.0);
  sd_status status = SD_OK;
  const size_t by_bodies = (24 + SD_TIE_OF_BODY) * count, by_spheres = SD_TIE_OF_SPHERE * (size_t) scene.size();
  std::vector<double> scratch(by_bodies + by_spheres + 1);
  if (A.tie) {
    status = bodies.draw_films(draw.of_films, pushed.data());
    if (status == SD_OK) status = sd_tie_make(&A, {scratch.data(), &scratch[by_bodies]});
  }
  sd_noise_join((long) pushed.size(), draw.scale, nullptr, pushed.data());
  find_followers();
  of_points.assign(6 * count + 6, 0.0);
  of_films.assign(6 * count + 6, 0.0);
  const sd_drifter d = drifter();
  const sd_drifter_push all = {bodies.u.data(), slip.data(), bodies.F.data(), pushed.data(),
                               bodies.velocities.empty() ? nullptr : bodies.velocities.data(), 0.1 * draw.tolerance};
  if (status == SD_OK)
    status = sd_drifter_move(&A, &d, &all, scratch.data(), of_points.data(), of_films.data());
  if (status != SD_OK) fail_by(voice.at_step().of("half a step of noise"), status);
  if (!differs) sd_drifter_add_own(&A, &d, kT, slip_left.data(), load_left.data());
}

double SolveNoise::memory_usage() const
{
  double numbers = 0.0;
  for (const auto *array : {&slip, &pushed, &slip_left, &load_left, &of_moves}) numbers += (double) array->capacity();
  return sizeof(double) * numbers;
}

// --- what is left of the drift, by differences ---------------------------------------------------------

/* Of each body, by the lowest of its tags */
std::vector<double> SolveNoise::numbers_of_bodies(const sd_random_key &of_bodies) const
{
  const size_t count = sd_bodies_count(&bodies.bodies);
  std::vector<int64_t> tag(count, INT64_MAX);
  std::vector<double> g(6 * count + 6);
  for (int k = 0; k < scene.size(); k++) {
    int64_t &of_body = tag[sd_rigid_whole(&bodies.bodies.spheres, k)];
    of_body = std::min(of_body, scene.tag(k));
  }
  for (size_t b = 0; b < count; b++) sd_random_normals(&of_bodies, tag[b], 6, &g[6 * b]);
  return g;
}

std::vector<double> SolveNoise::random_moves(const Draw &draw)
{
  const sd_bodies &A = bodies.bodies;
  const size_t count = sd_bodies_count(&A);
  const std::vector<double> g = numbers_of_bodies(draw.of_differences);
  std::vector<double> extent(count + 1), moves(6 * count + 6), W(6 * count + 6);
  const int turning = (int) bodies.first_clump();
  const sd_drifter_random random = {g.data(), scene.smallest(), turning, domain->dimension};
  reach = sd_drifter_moves(&A, &random, extent.data(), moves.data(), W.data());
  of_moves.assign(sd_bodies_unknowns(&A) + 1, 0.0);
  const sd_drifter d = drifter();
  sd_drifter_spread(&A, &d, W.data(), of_moves.data());
  return moves;
}

/* A W stays as it is, the matrices are those of the place. */
void SolveNoise::difference(double sign)
{
  const sd_bodies &A = bodies.bodies;
  const size_t count = sd_bodies_count(&A), n = scene.size();
  std::vector<double> scratch(18 * count + 6 * n + sd_bodies_unknowns(&A) + 1), load(6 * count + 6);
  const sd_status status = sd_drifter_difference(&A, of_moves.data(), sign * part(), scratch.data(),
                                                 slip_left.data(), load.data());
  if (status != SD_OK)
    fail_by(voice.at_step().of("the drift by differences"), status);
  sd_drifter_hand_on(&A, (int) bodies.first_clump(), load.data(), load_left.data());
}

void SolveNoise::push()
{
  const sd_drifter_drawn all = {slip.data(), pushed.data(), slip_left.data(), load_left.data()};
  sd_drifter_add(&bodies.bodies, &all, bodies.u.data(), bodies.F.data());
}

void SolveNoise::push_alone()
{
  if (bodies.bodies.tie) bodies.rest_films();
  std::copy_n(slip.begin(), bodies.u.size(), bodies.u.begin());
  std::copy_n(pushed.begin(), bodies.F.size(), bodies.F.begin());
  std::fill(bodies.velocities.begin(), bodies.velocities.end(), 0.0);
}

}    // namespace StokesDyn
