/* Of hydrodynamics: velocities from forces, and what the next step begins from; films where velocities
 * are known; and what follows from the forces on the fluid: the stress, and the flow. */
#include "hydrodynamics.h"

#include "callback.h"

#include "sd_linear.h"

#include "atom.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

using State = FixStokesDynamicsState;

/* l [3 points] of this rank's rows, in space, from those in the axes of the shells, or back: spheres that
 * are free do not turn */
void Hydrodynamics::turn_points(std::vector<double> &l, bool back) const
{
  const size_t P = shells.points();
  for (size_t k = scene.lone(); k < (size_t) scene.size(); k++)
    for (size_t p = P * k; p < P * (k + 1); p++) {
      const double was[3] = {l[3 * p], l[3 * p + 1], l[3 * p + 2]};
      (back ? sd_multiply3t : sd_multiply3)(shells.turns() + 9 * k, was, &l[3 * p]);
    }
}

/* Forces of the points of this rank's rows as the last solve left them (line 0), or on the line
 * through the last two (1); 0 where there are none. Rows of the memory are in the axes of the shells,
 * so that they turn with them, whoever turns these and whenever the next solve is. */
void Hydrodynamics::recall_points(std::vector<double> &l, double line)
{
  const size_t m = 3 * (size_t) shells.points();
  l.assign(m * scene.size() + m, 0.0);
  if (memory->points == 0) return;
  l = scene.rows((int) m, [&](int i, double *out) {
    const double *row = memory->rows[i], *last = row + memory->of_points(),
                 *before = row + memory->of_points_before();
    for (size_t d = 0; d < m; d++) out[d] = last[d] + line * (last[d] - before[d]);
  });
  turn_points(l, false);
}

void Hydrodynamics::keep_points(std::vector<double> l)
{
  const size_t m = 3 * (size_t) memory->points;
  if (m == 0) return;
  turn_points(l, true);
  double off[2] = {0.0, 0.0};    // from the last, from the line
  scene.to_atoms((int) m, l.data(), [&](int i, const double *row) {
    double *last = memory->rows.give(i) + memory->of_points();
    double *before = memory->rows.give(i) + memory->of_points_before();
    for (size_t d = 0; d < m; d++) {
      const double change = row[d] - last[d], bend = change - (last[d] - before[d]);
      off[0] += change * change;
      off[1] += bend * bend;
      before[d] = last[d];
      last[d] = row[d];
    }
  });
  MPI_Allreduce(MPI_IN_PLACE, off, 2, MPI_DOUBLE, MPI_SUM, world);
  memory->global.line = off[1] < off[0];
}

/* In one loop, which begins from the forces of the last step, with lubrication from its velocities
 * too: v' has no other use in such a run, so they are kept in its place. New random forces leave
 * nothing of either to begin from. */
sd_status Hydrodynamics::move_together(const Velocities::Take &take, const Velocities::Draw *draw,
                                       sd_bodies_report &report)
{
  const size_t m = width();
  place();
  const bool as_shells = shells.settings.on(), on = settings.warm_start;
  const double line = as_shells ? memory->global.line : 0.0;
  if (as_shells)
    recall_points(begin_with.l, line);
  else
    begin_with.l = scene.rows(width(), [&](int i, double *out) {
      for (size_t d = 0; d < m && on; d++) out[d] = -memory->rows[i][State::at(State::FORCE, d)];
    });
  begin_with.v = scene.rows(width(), [&](int i, double *out) {
    const double *row = memory->rows[i], *before = row + memory->of_motion_before();
    for (size_t d = 0; d < m && on; d++) {
      out[d] = row[State::at(State::VPRIME, d)];
      if (line != 0.0) out[d] += line * (out[d] - before[d]);
    }
  });
  Velocities::How how = {width(), on && !draw, settings.tolerance, settings.max_iter};
  how.draw = draw;
  const sd_status status = mobile.together(how, begin_with, take, report);
  forces_found.take(epochs.step);
  films_power.clear();
  if (settings.lubrication.on && status == SD_OK) {
    read_motion();
    find_films_power();
  }
  scene.to_atoms(width(), begin_with.v.data(), [&](int i, const double *now) {
    double *row = memory->rows.give(i);
    for (size_t d = 0; d < m && settings.lubrication.on; d++) {
      double &v = row[State::at(State::VPRIME, d)];
      if (memory->points > 0) row[memory->of_motion_before() + (int) d] = v;
      v = now[d];
    }
  });
  if (as_shells)
    keep_points(begin_with.l);
  else
    scene.to_atoms(width(), begin_with.l.data(), [&](int i, const double *l) {
      for (size_t d = 0; d < m; d++) memory->rows.row(i)[State::at(State::FORCE, d)] = -l[d];
    });
  return status;
}

void Hydrodynamics::velocities(const Velocities::Take &take, const Velocities::Held &held,
                               const std::vector<double> &loads, const Velocities::Draw *draw)
{
  State::Global &global = memory->global;
  sd_bodies_report report = {};
  sd_status status = SD_OK;
  solvers = ambient.who();
  mobile.held = held;
  mobile.loads = loads;
  mobile.find();
  if (settings.rigid.apart()) {
    mobile.apart(width(), take);
    for (int i : solvers)
      memory->rows.give(i);    // those that have one are known to have moved here
  } else
    status = move_together(take, draw, report);
  global.solves++;
  global.iterations = report.products;
  global.residual = report.residual;
  // v' is none of this: a solve for forces begins from nothing.
  global.last_step = update->ntimestep;
  global.last_solve = -1;
  global.reported = global.solutions = 0;
  sd_solve_report as_solver = {};
  as_solver.iterations = report.products;
  as_solver.residual = report.residual;
  if (status == SD_EMAXITER)
    unconverged(status, as_solver);
  else if (status != SD_OK)
    failed(status, as_solver);
}

void Hydrodynamics::turn(int i, const double R[9])
{
  if (settings.rigid.apart()) return;    // no guess is made there
  double *row = memory->rows.row(i);
  const auto turn = [R](double *v) {
    const double was[3] = {v[0], v[1], v[2]};
    sd_multiply3(R, was, v);
  };
  for (int first : {State::FORCE, State::TORQUE, State::VPRIME, State::WPRIME}) turn(row + first);
  for (int half : {0, 3})
    if (memory->points > 0) turn(row + memory->of_motion_before() + half);
}

// --- films between close spheres, and the rows that stand for these in a step without a solve ------

// Steps from one look at the limit that lubrication sets to the next: each costs 30 sparse
// products.
static const int LOOK_AT_FILMS = 1000;

/* Of the films where they stand, as the spheres move. */
void Hydrodynamics::find_films_power()
{
  films_power.clear();
  if (!ambient.varies()) return;
  std::vector<double> power(scene.size() + 1);
  sd_lubrication_strain_power(lubrication.matrix(), films_v.data(), power.data());
  films_power.assign(atom->nlocal + 1, 0.0);
  scene.to_atoms(1, power.data(), [this](int i, const double *p) { films_power[i] = *p; });
}

void Hydrodynamics::stand()
{
  films_power.clear();
  if (!settings.lubrication.on || !ambient.varies()) return;
  stand_rows();
  place_films();
  find_films_power();
}

/* Where nothing was solved in this step */
void Hydrodynamics::stand_rows()
{
  if (standing()) return;
  solvers = ambient.who();
  if (settings.rigid.on) mobile.find();
  surround();
}

void Hydrodynamics::surround()
{
  if (standing()) return;
  scene.stand(solvers, ambient);
  scene.turn_shells();
  if (settings.lubrication.on) scene.surround_films();
  rows_stand.take(epochs.step);
}

/* As the spheres move now, by rows of the scene */
void Hydrodynamics::read_motion()
{
  films_v = scene.rows(6, [this](int i, double *out) {
    std::copy_n(atom->v[i], 3, out);
    std::copy_n(atom->omega[i], 3, out + 3);
  });
  scene.drift(films_v.data(), 6, 1.0);
}

/* Where the spheres stand and as they move now */
void Hydrodynamics::place_films()
{
  surround();
  read_motion();
  lubrication.place(scene, ambient);
}

void Hydrodynamics::lubricate()
{
  place_films();
  films_F.resize(films_v.size());
  lubrication.forces(films_v.data(), films_F.data());
  find_films_power();
  if (update->setupflag || update->ntimestep % LOOK_AT_FILMS == 0)
    guard.look_at_films(*lubrication.matrix(), scene);
  scene.to_atoms(6, films_F.data(), [this](int i, const double *F) {
    double *row = memory->rows.row(i);
    for (int d = 0; d < 6; d++) row[State::at(State::FORCE, d)] += F[d];
  });
}

// --- the forces on the fluid: the stress, and the flow that they make -----------------------------

void Hydrodynamics::stress(std::vector<double> &of_atoms)
{
  const bool films_stand = standing();
  stand_rows();
  if (settings.lubrication.on && !films_stand) place_films();
  const Points now = points_of_now();
  const size_t n = scene.size();
  std::vector<double> points(6 * n + 6, 0.0), films(6 * n + 6, 0.0);
  sd_multiblob_moments(shells.points(), (int) n, now.r.data(), now.l.data(), points.data());
  if (overdamped) mobile.add_constraints(points.data());
  if (settings.lubrication.on) {
    const double *v = overdamped ? mobile.last_velocities() : films_v.data();
    const sd_status status = sd_lubrication_stress(lubrication.matrix(), v, films.data());
    if (status != SD_OK)
      fail_by(voice.of("stress of films"), status);
  }
  of_atoms.assign(12 * (size_t) atom->nlocal + 12, 0.0);
  for (const auto *part : {&points, &films})
    scene.to_atoms(6, part->data(), [&](int i, const double *row) {
      std::copy_n(row, 6, &of_atoms[12 * (size_t) i + (part == &films ? 6 : 0)]);
    });
}

/* Where no solve was needed in this step the rows of the scene may be those of another one. */
Hydrodynamics::Points Hydrodynamics::points_of_now()
{
  if (memory->points == 0 && !solved())
    voice.at_step().fail("the forces of the points are not kept with warm_start no; use warm_start "
                         "yes");
  stand_rows();
  const size_t n = scene.size(), points = n * shells.points();
  const sd_spheres s = scene.local();
  const sd_multiblob_spheres spheres = {s.x, s.a, shells.turns(), shells.masks(), (int) n};
  Points now;
  now.r.resize(3 * points + 3);
  now.x.resize(3 * points + 3);
  now.b.resize(points + 1);
  sd_multiblob_expand(&shells.model(), &spheres, now.r.data(), now.x.data(), now.b.data());
  if (solved())
    now.l = begin_with.l;
  else
    recall_points(now.l, 0.0);
  return now;
}

std::vector<double> Hydrodynamics::of_points_on_fluid()
{
  const Points now = points_of_now();
  const size_t P = shells.points();
  const double *w = scene.local().w;
  std::vector<double> all;
  for (size_t k = 0; k < scene.size() * P; k++) {
    if (!(now.b[k] > 0.0)) continue;
    all.insert(all.end(), &now.x[3 * k], &now.x[3 * k] + 3);
    all.push_back(now.b[k]);
    for (int d = 0; d < 6; d++)
      all.push_back(d < 3 ? w[k / P] * w[k / P] * now.l[3 * k + d] : 0.0);
  }
  return all;
}

/* F is what the mobility knows: without films, which act between two spheres and not on the fluid
 * far from them. */
std::vector<double> Hydrodynamics::on_fluid()
{
  if (shells.settings.on()) return of_points_on_fluid();
  const bool without_films = settings.lubrication.on && !overdamped;
  const int m = width();
  std::vector<double> all;
  const auto add = [&](int i, const double *F) {
    const bool point = settings.scene.tensor == SD_TENSOR_OSEEN;
    all.insert(all.end(), atom->x[i], atom->x[i] + 3);
    all.push_back(point ? 0.0 : atom->radius[i]);
    for (int d = 0; d < 6; d++) all.push_back(d < m ? -F[d] / ambient.viscosity(i) : 0.0);
  };
  if (overdamped && settings.rigid.apart()) {    // these are not kept
    mobile.find();
    mobile.apart(width(), [&](int i, const double *, const double *F) { add(i, F); });
    return all;
  }
  for (int i : ambient.who()) {
    const double *row = memory->rows[i];
    double F[6] = {0.0}, s[6] = {0.0};
    ambient.slip(i, s);
    for (int d = 0; d < m; d++)
      F[d] = without_films ? ambient.resistance(i, d) * (s[d] + row[State::at(State::VPRIME, d)])
                           : row[State::at(State::FORCE, d)];
    add(i, F);
  }
  return all;
}

}    // namespace StokesDyn
