#include "guess.h"

#include "ranks.h"

#include "atom.h"
#include "update.h"

#include "sd_hash.h"
#include "sd_linear.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;

namespace StokesDyn {

using State = FixStokesDynamicsState;

Guess::Guess(LAMMPS *lmp, const Scene &scene, const Engine &engine, const BodyScene &bodies, const Shells &shells,
             const StokesSettings &settings) :
    Pointers(lmp), scene(scene), engine(engine), bodies(bodies), shells(shells), settings(settings)
{
}

/* What a guess follows from: the pair_style command, what the solve is asked, and which shells the spheres have.
 * What is kept stands while this is the number of the solve that kept it. 0: nobody is to begin from anything */
uint64_t Guess::number(Question asked) const
{
  if (!settings.warm_start || asked == NOISY_MOTIONS) return 0;
  uint64_t all = sd_hash_mix(memory->global.settings + (uint64_t) asked + 1), bits;
  for (double of_shells : {shells.classes.smallest, shells.classes.unlike}) {
    memcpy(&bits, &of_shells, sizeof(bits));
    all = sd_hash_mix(all * SD_HASH_STEP + bits);
  }
  return all;
}

/* Solves of that number that follow one another, whose answers the memory has: 0, 1, 2 */
double Guess::solves_kept(Question asked) const
{
  const uint64_t now = number(asked);
  return now != 0 && now == memory->global.guess ? memory->global.solutions : 0.0;
}

/* Of this solve. Where a run begins, spheres stand as in the step before. */
sd_guess_answers Guess::answers(double kept) const
{
  return {kept > 0.0 && update->setupflag, 0.0, 0.0};
}

/* Is the next guess on the line? The same on all ranks */
void Guess::choose(const sd_guess_answers &found, double kept)
{
  double off[2] = {found.off_last, found.off_line};
  MPI_Allreduce(MPI_IN_PLACE, off, 2, MPI_DOUBLE, MPI_SUM, world);
  memory->global.line = (found.again ? memory->global.line != 0.0 : kept > 1.0) && off[1] < off[0];
}

double Guess::line() const
{
  return update->setupflag ? 0.0 : memory->global.line;
}

Guess::Start Guess::none(std::vector<double> room) const
{
  const size_t n = scene.size(), of_spheres = width() * (n + 1);
  const size_t of_points = shells.settings.on() ? 3 * (size_t) shells.first_of_rows()[n] + 3 : of_spheres;
  room.assign(of_points, 0.0);
  return {false, std::move(room), std::vector<double>(settings.lubrication.on ? of_spheres : 0)};
}

Guess::Start Guess::recall(Question asked, std::vector<double> room) const
{
  const bool needless = asked == MOTIONS && settings.forces_are_loads() && !bodies.bodies.known;
  if (needless || solves_kept(asked) == 0.0) return none(std::move(room));
  Start start = {true, {}, {}};
  if (shells.settings.on())
    start.l = recall_points(line(), std::move(room));
  else if (asked == FORCES)
    start.l = recall_forces();
  else
    start.l = recall_spheres(line());
  if (asked == MOTIONS && settings.lubrication.on) start.v = recall_motions();
  return start;
}

void Guess::keep(Question asked, const Found &found)
{
  State::Global &global = memory->global;
  const double kept = solves_kept(asked);
  if (asked == FORCES)
    keep_perturbation(found.exerted);
  else if (settings.lubrication.on)
    keep_motions(found.v, kept);
  if (shells.settings.on() && engine.anybody_sees())
    keep_points(found.l, kept);
  else if (!shells.settings.on() && asked != FORCES)
    keep_spheres(found.l, kept);
  global.guess = number(asked);
  global.solutions = answers(kept).again ? kept : std::min(2.0, kept + 1.0);
}

// --- where velocities are given --------------------------------------------------------------------

/* With the v' of the last solve, or on the line through the last two */
std::vector<double> Guess::recall_forces() const
{
  const size_t m = width();
  const bool line = memory->global.solutions > 1.0;
  std::vector<double> l = scene.rows((int) m, [&](int i, double *out) {
    const double *row = memory->rows[i], *before = row + memory->before();
    for (size_t d = 0; d < m; d++) {
      const double last = row[State::at(State::VPRIME, d)];
      out[d] = line ? 2.0 * last - before[d] : last;
    }
  });
  sd_guess_exerted(m * scene.size(), bodies.resistance.data(), bodies.flow.data(), l.data());
  return l;
}

/* v' of the solution, and what the next guess is made of. Spheres that see nobody have none: not what the
 * tolerance of a solve from zero has left of theirs either. */
void Guess::keep_perturbation(const std::vector<double> &exerted)
{
  const size_t m = width();
  std::vector<double> perturbed(m * scene.size() + m, 0.0);
  for (size_t k = 0; k < (size_t) scene.size(); k++)
    if (!engine.alone((int) k))
      sd_guess_perturbation(m, &bodies.resistance[m * k], &bodies.flow[m * k], &exerted[m * k], &perturbed[m * k]);
  scene.to_atoms((int) m, perturbed.data(), [&](int i, const double *now) {
    double *row = memory->rows.writable(i), *before = row + memory->before();
    for (size_t d = 0; d < m; d++) {
      double &last = row[State::at(State::VPRIME, d)];
      if (memory->history) before[d] = last;
      last = now[d];
    }
  });
}

// --- where loads are given -------------------------------------------------------------------------

/* Velocities less those of the fluid stand in the place of v', which has no other use in such a run; films alone
 * ask for them. In a box that shears the velocity of a sphere that crosses its border jumps, and so does that of
 * the fluid. */
std::vector<double> Guess::recall_motions() const
{
  const size_t m = width();
  const double line = this->line();
  const size_t at_before = line != 0.0 ? memory->velocities_before() : 0;
  std::vector<double> v = scene.rows((int) m, [&](int i, double *out) {
    const double *row = memory->rows[i], *before = row + at_before;
    for (size_t d = 0; d < m; d++) out[d] = sd_guess_at(line, row[State::at(State::VPRIME, d)], before[d]);
  });
  for (size_t j = 0; j < m * scene.size(); j++) v[j] += bodies.flow[j];
  return v;
}

void Guess::keep_motions(const std::vector<double> &v, double kept)
{
  const size_t m = width();
  sd_guess_answers found = answers(kept);
  double relative[6];
  const auto at = [&](size_t k) {
    for (size_t d = 0; d < m; d++) relative[d] = v[m * k + d] - bodies.flow[m * k + d];
    return (const double *) relative;
  };
  scene.some_to_atoms((int) m, at, [&](int i, const double *now) {
    double *row = memory->rows.writable(i);
    for (size_t d = 0; d < m; d++) {
      double &last = row[State::at(State::VPRIME, d)];
      if (lines())
        sd_guess_take(&found, now[d], 1.0, &last, &row[memory->velocities_before() + (int) d]);
      else
        last = now[d];
    }
  });
}

/* Of spheres that are points, their forces on the fluid: the memory has those on the spheres. */
std::vector<double> Guess::recall_spheres(double line) const
{
  const size_t at_before = line != 0.0 ? memory->forces_before() : 0;
  return scene.rows((int) width(), [&](int i, double *out) {
    const double *row = memory->rows[i], *before = row + at_before;
    for (size_t d = 0; d < width(); d++)
      out[d] = -sd_guess_at(line, row[State::at(State::FORCE, d)], before[d]);
  });
}

void Guess::keep_spheres(const std::vector<double> &l, double kept)
{
  sd_guess_answers found = answers(kept);
  scene.to_atoms((int) width(), l.data(), [&](int i, const double *now) {
    double *row = memory->rows.writable(i), *before = row + memory->forces_before();
    for (size_t d = 0; d < width(); d++) {
      double &last = row[State::at(State::FORCE, d)];
      if (lines())
        sd_guess_take(&found, -now[d], d < 3 ? 1.0 : atom->radius[i], &last, &before[d]);
      else
        last = -now[d];
    }
  });
  if (lines()) choose(found, kept);
}

void Guess::turn(int i, const double R[9])
{
  if (!memory->rows.has(i)) return;
  double *row = memory->rows.row(i);
  const auto turn = [R](double *v) {
    const double was[3] = {v[0], v[1], v[2]};
    sd_multiply3(R, was, v);
  };
  for (int first : {State::FORCE, State::TORQUE, State::VPRIME, State::WPRIME}) turn(row + first);
  for (int half = 0; half < memory->width() && lines(); half += 3) {
    turn(row + memory->velocities_before() + half);
    if (memory->lines) turn(row + memory->forces_before() + half);
  }
}

// --- of shells, forces of their points ---------------------------------------------------------------

/* Forces on the n points of the sphere of row k, in space from those in the axes of its shell, or back: spheres
 * that are free do not turn */
void Guess::turn_points(size_t k, int n, bool back, double *l) const
{
  for (int p = 0; p < n && k >= (size_t) scene.lone(); p++, l += 3) {
    const double was[3] = {l[0], l[1], l[2]};
    (back ? sd_multiply3t : sd_multiply3)(shells.turn_of(k), was, l);
  }
}

/* As the last solve left them (line 0), or on the line through the last two (1); 0 where there are
 * none. */
std::vector<double> Guess::recall_points(double line, std::vector<double> found_then) const
{
  const int *first = shells.first_of_rows(), *kinds = shells.kinds_of_rows();
  found_then.assign(3 * (size_t) first[scene.size()] + 3, 0.0);
  for (int kind = 0; kind < shells.kinds() && memory->shell_points > 0; kind++) {
    const int n = shells.model(kind).n;
    const auto read = [&](int i, double *out) {
      const auto of = memory->points_of(i, kind, n);
      for (int d = 0; d < 3 * n; d++)
        out[d] = of.now ? sd_guess_at(line, of.now[d], of.before[d]) : 0.0;
    };
    scene.rows_to(3 * n, read, [&](size_t k) {
      return kinds[k] == kind ? &found_then[3 * (size_t) first[k]] : nullptr;
    });
  }
  for (size_t k = scene.lone(); k < (size_t) scene.size(); k++)
    turn_points(k, shells.points_of_row(k), false, &found_then[3 * (size_t) first[k]]);
  return found_then;
}

void Guess::keep_points(const std::vector<double> &l, double kept)
{
  if (memory->shell_points == 0) return;
  const int *first = shells.first_of_rows(), *kinds = shells.kinds_of_rows();
  sd_guess_answers found = answers(kept);
  for (int kind = 0; kind < shells.kinds(); kind++) {
    const int n = shells.model(kind).n;
    std::vector<double> turned(3 * n);
    const auto at = [&](size_t k) -> const double * {
      if (kinds[k] != kind) return nullptr;
      const double *row = &l[3 * (size_t) first[k]];
      if (k < (size_t) scene.lone()) return row;
      std::copy_n(row, 3 * n, turned.data());
      turn_points(k, n, true, turned.data());
      return turned.data();
    };
    scene.some_to_atoms(3 * n, at, [&](int i, const double *row) {
      const auto of = memory->writable_points(i, kind, n);
      for (int d = 0; d < 3 * n && of.now; d++) sd_guess_take(&found, row[d], 1.0, &of.now[d], &of.before[d]);
    });
  }
  choose(found, kept);
}

}    // namespace StokesDyn
