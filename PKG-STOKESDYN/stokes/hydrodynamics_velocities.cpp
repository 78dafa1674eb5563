/* Of hydrodynamics: velocities from forces, what the next step begins from, and the stress. */
#include "hydrodynamics.h"

#include "callback.h"

#include "sd_linear.h"

#include "atom.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

using State = FixStokesDynamicsState;
static const std::string COMMAND = StokesSettings::COMMAND;

/* Forces of the points of this rank's rows as the last solve left them (line 0), or on the line
 * through the last two (1); 0 where there are none */
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
}

void Hydrodynamics::keep_points(const std::vector<double> &l)
{
  const size_t m = 3 * (size_t) memory->points;
  if (m == 0) return;
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
  const size_t n = scene.size();
  const double line = shells.settings.on() ? memory->global.line : 0.0;
  std::vector<double> rows = scene.rows(2 * width(), [&](int i, double *out) {
    const double *row = memory->rows[i], *before = row + memory->of_motion_before();
    for (size_t d = 0; d < m && settings.warm_start; d++) {
      out[d] = -row[d < 3 ? State::FORCE + d : State::TORQUE + d - 3];
      out[m + d] = row[d < 3 ? State::VPRIME + d : State::WPRIME + d - 3];
      if (line != 0.0) out[m + d] += line * (out[m + d] - before[d]);
    }
  });
  if (shells.settings.on())
    recall_points(begin_with.l, memory->global.line);
  else
    begin_with.l.assign(m * n + m, 0.0);
  begin_with.v.assign(m * n + m, 0.0);
  for (size_t k = 0; k < n; k++) {
    if (!shells.settings.on()) std::copy_n(&rows[2 * m * k], m, &begin_with.l[m * k]);
    std::copy_n(&rows[2 * m * k + m], m, &begin_with.v[m * k]);
  }
  Velocities::How how = {width(), settings.warm_start && !draw, settings.tolerance,
                         settings.max_iter};
  how.draw = draw;
  const sd_status status = mobile.together(how, begin_with, take, report);
  forces_found.take(epochs.step);
  films_power.clear();
  if (settings.lubrication.on && status == SD_OK) {
    read_motion();
    find_films_power();
  }
  for (size_t k = 0; k < n; k++) {
    if (!shells.settings.on()) std::copy_n(&begin_with.l[m * k], m, &rows[2 * m * k]);
    std::copy_n(&begin_with.v[m * k], m, &rows[2 * m * k + m]);
  }
  if (shells.settings.on()) keep_points(begin_with.l);
  scene.to_atoms(2 * width(), rows.data(), [&](int i, const double *from) {
    double *row = memory->rows.give(i);
    for (size_t d = 0; d < m; d++) {
      row[d < 3 ? State::FORCE + d : State::TORQUE + d - 3] = -from[d];
      if (!settings.lubrication.on) continue;
      double &v = row[d < 3 ? State::VPRIME + d : State::WPRIME + d - 3];
      if (memory->points > 0) row[memory->of_motion_before() + (int) d] = v;
      v = from[m + d];
    }
  });
  return status;
}

void Hydrodynamics::velocities(const Velocities::Take &take, const Velocities::Held &held,
                               const Velocities::Draw *draw)
{
  State::Global &global = memory->global;
  sd_bodies_report report = {};
  sd_status status = SD_OK;
  solvers = ambient.who();
  mobile.held = held;
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
  double *row = memory->rows.row(i), turned[3];
  for (int first : {State::FORCE, State::TORQUE, State::VPRIME, State::WPRIME}) {
    sd_multiply3(R, row + first, turned);
    std::copy_n(turned, 3, row + first);
  }
  const int behind = memory->points > 0 ? 2 * memory->points + 2 : 0;
  for (int p = 0; p < behind; p++) { /* of both solves, and the motion before */
    double *of_point = row + memory->of_points() + 3 * p;
    sd_multiply3(R, of_point, turned);
    std::copy_n(turned, 3, of_point);
  }
}

void Hydrodynamics::stress(std::vector<double> &of_atoms)
{
  const bool films_stand = standing();
  stand_rows();
  if (settings.lubrication.on && !films_stand) place_films();
  const Points now = points_of_now();
  const size_t n = scene.size();
  std::vector<double> points(6 * n + 6, 0.0), films(6 * n + 6, 0.0), rows(12 * n + 12);
  sd_multiblob_moments(&shells.model(), (int) n, now.r.data(), now.l.data(), points.data());
  if (overdamped) mobile.add_constraints(points.data());
  if (settings.lubrication.on) {
    const double *v = overdamped ? mobile.last_velocities() : films_v.data();
    const sd_status status = sd_lubrication_stress(lubrication.matrix(), v, films.data());
    if (status != SD_OK)
      fail_by(lmp, status, COMMAND + ": stress of films: " + sd_status_string(status));
  }
  for (size_t k = 0; k < n; k++) {
    std::copy_n(&points[6 * k], 6, &rows[12 * k]);
    std::copy_n(&films[6 * k], 6, &rows[12 * k + 6]);
  }
  of_atoms.assign(12 * (size_t) atom->nlocal + 12, 0.0);
  scene.to_atoms(12, rows.data(), [&](int i, const double *row) {
    std::copy_n(row, 12, &of_atoms[12 * (size_t) i]);
  });
}

}    // namespace StokesDyn
