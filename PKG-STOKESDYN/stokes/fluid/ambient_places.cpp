/* Of ambient: the fluid velocity at places where there is no sphere, and the fluid in the middle of a
 * step. */
#include "ambient.h"

#include "keywords.h"
#include "lammps_compat.h"
#include "ranks.h"

#include "comm.h"
#include "domain.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <array>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* LAMMPS evaluates formulas for atoms only. If no sphere takes part, one atom of the lowest rank
 * that has any is asked in their place, as one of the group; if there are no atoms at all, one that
 * is taken away again. */
class Ambient::Carrier {
 public:
  Carrier(Atom *atom, MPI_Comm world, const std::vector<int> &those, int groupbit) : atom(atom)
  {
    who = those;
    const auto parts = from_all(world, std::vector<int>{(int) those.size(), atom->nlocal});
    int rank, lender = -1;
    MPI_Comm_rank(world, &rank);
    for (size_t p = 0; p < parts.size(); p += 2) {
      if (parts[p] > 0) return;
      if (lender < 0 && parts[p + 1] > 0) lender = (int) p / 2;
    }
    if (rank != std::max(lender, 0)) return;
    if (lender < 0) {
      double origin[3] = {0.0, 0.0, 0.0};
      atom->avec->create_atom(1, origin);
      made = true;
    }
    mask = atom->mask[0];
    atom->mask[0] |= groupbit;
    lent = true;
    who.assign(1, 0);
  }
  ~Carrier()
  {
    if (lent) atom->mask[0] = mask;
    if (made) atom->nlocal--;
  }
  std::vector<int> who;

 private:
  Atom *atom;
  int mask = 0;
  bool lent = false, made = false;
};

/* The largest velocities that atoms have at one place, and the smallest with a minus sign: they are the same
 * unless a velocity is that of an atom and not of a place. */
struct AtOnePlace {
  double most[6] = {-INFINITY, -INFINITY, -INFINITY, -INFINITY, -INFINITY, -INFINITY};

  void note(int d, double v)
  {
    most[d] = std::max(most[d], v);
    most[3 + d] = std::max(most[3 + d], -v);
  }
  /* On all ranks together */
  void require_one(const Voice &voice)
  {
    MPI_Allreduce(MPI_IN_PLACE, most, 6, MPI_DOUBLE, MPI_MAX, voice.lmp->world);
    for (int d = 0; d < 3; d++)
      if (most[d] + most[3 + d] > 1e-12 * std::fabs(most[d]))
        voice.fail("keyword fluid_velocity: step " + std::to_string(voice.lmp->update->ntimestep) +
                   ": the velocity belongs to atoms (" + text(-most[3 + d]) + " to " + text(most[d]) +
                   " at one place), so that it is not known between them; use formulas in x, y, z, or "
                   "grid FILE, or box");
  }
};

/* As many places at a time as there are atoms on all ranks. In the first round all atoms are at the
 * first place. */
std::vector<double> Ambient::formulas_at(const std::vector<double> &mine)
{
  const Carrier carrier(atom, world, those, groupbit);
  const std::vector<int> &those = carrier.who;
  const std::vector<double> x = from_all(world, mine);
  const std::vector<int> atoms = from_all(world, std::vector<int>(1, (int) those.size()));
  const std::vector<int> numbers = from_all(world, std::vector<int>(1, (int) mine.size()));
  size_t at_once = 0, before = 0, begin_of_mine = 0;
  for (int p = 0; p < comm->nprocs; p++) {
    if (p == comm->me) before = at_once;
    if (p < comm->me) begin_of_mine += numbers[p];
    at_once += atoms[p];
  }
  std::vector<double> u(x.size() + 1, 0.0), value(atom->nlocal + 1);
  const size_t places = x.size() / 3;
  const Places kept(atom);
  AtOnePlace first;
  modify->clearstep_compute();
  for (size_t round = 0; at_once > 0 && places > 0 && round <= (places - 1) / at_once + 1; round++) {
    const auto place_of = [&](size_t k) {
      return round == 0 ? 0 : std::min(places - 1, (round - 1) * at_once + before + k);
    };
    for (size_t k = 0; k < those.size(); k++)
      std::copy_n(&x[3 * place_of(k)], 3, atom->x[those[k]]);
    for (int d = 0; d < 3; d++) {
      if (!settings.velocity[d].is_atom_style()) continue;
      settings.velocity[d].evaluate(lmp, igroup, value.data(), 1);
      for (size_t k = 0; k < those.size(); k++) {
        const double v = value[those[k]];
        if (round == 0)
          first.note(d, v);
        else if ((round - 1) * at_once + before + k < places)
          u[3 * place_of(k) + d] = v;
      }
    }
  }
  modify->addstep_compute(update->ntimestep + 1);
  first.require_one(voice);
  MPI_Allreduce(MPI_IN_PLACE, u.data(), mpi_count((double) x.size()), MPI_DOUBLE, MPI_SUM, world);
  return std::vector<double>(u.begin() + begin_of_mine, u.begin() + begin_of_mine + mine.size());
}

std::vector<double> Ambient::at_places(const std::vector<double> &x)
{
  const size_t n = x.size() / 3;
  std::vector<double> out(3 * n);
  for (size_t k = 0; k < n; k++) std::copy_n(u_uniform, 3, &out[3 * k]);
  if (settings.box)
    for (size_t k = 0; k < n; k++) sd_box_flow_at(&motion.flow, &x[3 * k], &out[3 * k]);
  else if (!settings.grid && varies()) {
    const std::vector<double> formulas = formulas_at(x);
    for (size_t k = 0; k < 3 * n; k++)
      if (settings.velocity[k % 3].is_atom_style()) out[k] = formulas[k];
  }
  if (settings.grid) grid_at(x, out);
  return out;
}

/* The same of the grid. Error: a place that is outside of it */
void Ambient::grid_at(const std::vector<double> &x, std::vector<double> &out) const
{
  const sd_flow_grid &grid = settings.grid->grid;
  sd_flow_frame frame;
  sd_flow_grid_frame(&grid, now, &frame);    // read() has looked at the time
  double wrong[4] = {0.0, 0.0, 0.0, 0.0};
  for (size_t k = 0; k < x.size() / 3; k++) {
    double place[3] = {x[3 * k], x[3 * k + 1], x[3 * k + 2]}, value[4];
    domain->remap(place);
    sd_flow_grid_at(&grid, &frame, 1, place, value, nullptr);
    std::copy_n(value, 3, &out[3 * k]);
    if (std::isfinite(value[0]) || wrong[0] > 0.0) continue;
    wrong[0] = comm->me + 1;
    std::copy_n(place, 3, wrong + 1);
  }
  const std::array<double, 4> mine = {wrong[0], wrong[1], wrong[2], wrong[3]};
  for (const auto &there : from_all(world, std::vector<std::array<double, 4>>(1, mine)))
    if (there[0] > 0.0)
      voice.fail("keyword fluid_velocity: step " + std::to_string(update->ntimestep) +
                 ": a point of fix stokes_dynamics/field: " + outside_of_grid(&there[1]));
}

/* All that read_fluid() finds */
std::vector<double> Ambient::values() const
{
  std::vector<double> all(u_uniform, u_uniform + 3);
  all.push_back(eta_uniform);
  for (const auto *part : {&eta, &u, &w, &gradient, &curvature})
    all.insert(all.end(), part->begin(), part->end());
  all.insert(all.end(), motion.flow.gradient, motion.flow.gradient + 9);
  all.insert(all.end(), motion.flow.corner, motion.flow.corner + 3);
  all.insert(all.end(), motion.flow.corner_velocity, motion.flow.corner_velocity + 3);
  all.insert(all.end(), jump, jump + 6);
  return all;
}

void Ambient::look_ahead(double time)
{
  change.clear();
  if (steady()) return;
  const std::vector<double> then = values();
  now = time;
  read_fluid(wanted);
  check();
  change = values();
  for (size_t k = 0; k < change.size(); k++) change[k] -= then[k];
}

void Ambient::half_a_step_back()
{
  if (change.empty()) return;
  const double *of = change.data();
  const auto back = [&of](double &value) { value -= 0.5 * *of++; };
  for (double &value : u_uniform) back(value);
  back(eta_uniform);
  for (auto *part : {&eta, &u, &w, &gradient, &curvature})
    for (double &value : *part) back(value);
  for (double &value : motion.flow.gradient) back(value);
  for (double &value : motion.flow.corner) back(value);
  for (double &value : motion.flow.corner_velocity) back(value);
  for (double &value : jump) back(value);
  change.clear();
  // the same for an atom and its images, to rounding
  if (settings.box) {
    read_box(!gradient.empty());
    find_jumps();
  }
  check();
}

}    // namespace StokesDyn
