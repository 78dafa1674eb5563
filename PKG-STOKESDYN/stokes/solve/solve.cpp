#include "solve.h"

#include "copy.h"
#include "keywords.h"
#include "settings.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

Solve::Solve(LAMMPS *lmp, const Scene &scene, Engine &engine, BodyScene &bodies, const Shells &shells,
             const StokesSettings &settings) :
    Pointers(lmp), preconditioner(lmp, scene, engine, settings), guess(lmp, scene, engine, bodies, shells, settings),
    scene(scene), engine(engine), bodies(bodies), factor(lmp, scene, bodies)
{
}

double Solve::memory_usage() const
{
  double numbers = (double) room;
  for (const auto *array : {&exerted, &v, &V, &l, &v_with_l, &drag, &spin, &work})
    numbers += (double) array->capacity();
  return sizeof(double) * numbers + preconditioner.memory_usage();
}

// --- bodies ----------------------------------------------------------------------------------------

sd_status Solve::run(const How &how, sd_solve_report &report)
{
  found.set(scene.all_epochs().step);
  FixStokesDynamicsState &memory = *guess.memory;
  if (how.asked != Guess::MOTIONS) {
    factor.forget();
    return solve_bodies(how, guess.recall(how.asked, std::move(l)), report);
  }
  factor.recall(memory);
  const sd_status status = solve_bodies(how, guess.recall(how.asked, std::move(l)), report);
  factor.note(memory);
  return status;
}

sd_status Solve::resist(const double *motions, int max_iter, double *forces)
{
  const std::vector<double> moving(motions, motions + scene.width() * scene.size());
  std::vector<double> exerted_before = exerted, l_before = l, v_before = v_with_l;
  sd_solve_report unused = {};
  bodies.rest_in(moving, false);
  const sd_status status = solve_bodies({Guess::FORCES, 1e-2, max_iter}, guess.none(), unused);
  for (size_t j = 0; j < moving.size(); j++) forces[j] = -exerted[j];
  exerted.swap(exerted_before);
  l.swap(l_before);
  v_with_l.swap(v_before);
  return status;
}

sd_status Solve::solve_bodies(const How &how, Guess::Start start, sd_solve_report &report)
{
  const sd_bodies &A = bodies.bodies;
  V.resize(6 * sd_bodies_count(&A) + 6);
  v.resize(sd_bodies_loads(&A) + 6);
  exerted.resize(sd_bodies_loads(&A) + 6);
  const double *given = bodies.velocities.empty() ? nullptr : bodies.velocities.data();
  const sd_bodies_problem problem = {bodies.u.data(), bodies.F.data(), given,
                                     start.warm,      how.tolerance,   how.max_iter};
  l = std::move(start.l);
  v_with_l = std::move(start.v);
  const sd_bodies_answer answer = {l.data(), v_with_l.data(), V.data(), v.data(), exerted.data()};
  sd_bodies_report made = {};
  const sd_status status = sd_bodies_solve(&A, &problem, &answer, at_least(sd_bodies_work(&A), work), &made);
  fail_if_alone(Voice(lmp, StokesSettings::COMMAND).at_step(), status);
  report = {};
  report.iterations = report.products = made.products;
  report.residual = made.residual;
  report.curvature = made.curvature;
  return status;
}

void Solve::hand_out(const ToAtom &take) const
{
  const size_t m = scene.width();
  std::vector<double> of_atoms;    // not those of the image next to its clump
  if (scene.drift_of_images()) {
    of_atoms = v;
    scene.drift(of_atoms.data(), scene.width(), -1.0);
  }
  const double *moves = of_atoms.empty() ? v.data() : of_atoms.data();
  double moved[12];
  const auto at = [&](size_t k) {
    copy_row(m, moves + m * k, moved);
    for (size_t d = 0; d < m; d++) moved[m + d] = -exerted[m * k + d];
    return (const double *) moved;
  };
  scene.some_to_atoms(2 * scene.width(), at, [&](int i, const double *row) { take(i, row, row + m); });
}

// --- points whose velocities are given -------------------------------------------------------------

sd_system Solve::system()
{
  const size_t n = scene.size(), m = scene.width();
  drag.resize(n + 1);
  spin.resize(n + 1);
  for (size_t k = 0; k < n; k++) {
    drag[k] = bodies.resistance[m * k];
    if (m == 6) spin[k] = bodies.resistance[m * k + 3];
  }
  sd_system system = {};
  system.n = (int) n;
  system.drag = drag.data();
  system.spin = m == 6 ? spin.data() : nullptr;
  system.apply = sd_mobility_apply;
  system.apply_ctx = engine.mobility();
  system.world = engine.ranks();
  return system;
}

double *Solve::make_room()
{
  const size_t needed = SD_SOLVE_WORK(scene.size(), scene.width()) + 1;
  if (needed > room) {
    scratch.reset();
    scratch.reset(new double[needed]);
    room = needed;
  }
  return scratch.get();
}

sd_status Solve::substitution(const How &how, sd_solve_report &report)
{
  const sd_system A = system();
  exerted.resize(bodies.flow.size() + scene.width());
  const sd_status status = sd_solve_substitution(&A, bodies.flow.data(), how.tolerance, how.max_iter,
                                                 exerted.data(), make_room(), &report);
  turn_forces();
  return status;
}

sd_status Solve::gradients(const How &how, sd_solve_report &report)
{
  sd_system A = system();
  exerted.resize(bodies.flow.size() + scene.width());
  const Guess::Start start = guess.recall(how.asked);
  A.warm = start.warm;
  for (size_t j = 0; j < bodies.flow.size() && A.warm; j++) exerted[j] = -start.l[j];
  preconditioner.attach(A, *guess.memory);
  const sd_status status = sd_solve_gradients(&A, bodies.flow.data(), how.tolerance, how.max_iter,
                                              exerted.data(), make_room(), &report);
  turn_forces();
  return status;
}

/* These solvers find the force of the fluid. */
void Solve::turn_forces()
{
  for (size_t j = 0; j < bodies.flow.size(); j++) exerted[j] = -exerted[j];
}

}    // namespace StokesDyn
