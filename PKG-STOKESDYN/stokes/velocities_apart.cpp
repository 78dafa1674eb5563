/* Of velocities: clumps by themselves, by the tables of their shapes: velocities from forces, and
 * forces from velocities. */
#include "velocities.h"

#include "sd_linear.h"

#include "atom.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* What the spheres of a clump and the fluid at them do. The angular velocities of spheres that are
 * not on a line say nothing that their velocities do not. */
sd_clump_motion Velocities::look_at(const Clump &clump) const
{
  const bool strains = ambient.gradients(), spins = scene.settings.rotation;
  const size_t at = 3 * (size_t) clump.body->begin;
  sd_clump_motion m = {};
  m.x = &spheres.x[at];
  m.v = &spheres.motion[at];
  m.omega = spins && clump.body->shape->shape.rank < 2 ? &spheres.turning[at] : nullptr;
  std::copy_n(ambient.uniform_velocity(), 3, m.u_uniform);
  m.u = strains ? &spheres.flow[at] : nullptr;
  m.gradient = strains ? &spheres.gradient[3 * at] : nullptr;
  return m;
}

/* Velocity of the fluid at the centroid and its gradient over the clump */
void Velocities::flow_over(const Clump &clump, double fluid[3], double G[9]) const
{
  const sd_clump_motion motion = look_at(clump);
  sd_clump_flow(&clump.body->shape->shape, &motion, clump.pose, clump.pose + 9, fluid, G);
}

/* Force and torque about the centroid */
void Velocities::load_on(const Clump &clump, double load[6]) const
{
  std::fill_n(load, 6, 0.0);
  for (size_t k = clump.body->begin; k < (size_t) clump.body->begin + clump.body->n; k++) {
    const double *f = &spheres.motion[3 * k];
    double arm[3], couple[3];
    sd_minus(&spheres.x[3 * k], clump.pose + 9, arm);
    sd_cross(arm, f, couple);
    for (int d = 0; d < 3; d++) {
      load[d] += f[d];
      load[3 + d] += spheres.turning[3 * k + d] + couple[d];
    }
  }
}

void Velocities::apart(int width, const Take &take)
{
  double fluid_there[6], given[6], move[6], by_fluid[6];
  for (int i : lone) {
    const bool known = held && held(i, given);
    ambient.fluid(i, fluid_there);
    for (int d = 0; d < width; d++) {
      const double k = ambient.resistance(i, d), load = d < 3 ? atom->f[i][d] : atom->torque[i][d - 3];
      move[d] = known ? given[d] : fluid_there[d] + load / k;
      by_fluid[d] = known ? k * (fluid_there[d] - given[d]) : -load;
    }
    take(i, move, by_fluid);
  }
  const WholeClumps &whole = scene.whole;
  std::vector<double> force, torque, moved(13 * (size_t) whole.size() + 13, 0.0);
  double back[6] = {0.0};
  for (int d = 0; d < 6 && ambient.jumps(); d++) back[d] = -ambient.jumps()[d];
  for (Clump &clump : clumps) {
    const RigidClumps::Body &body = *clump.body;
    double fluid[3], G[9], load[6], arm[3], turning[3];
    flow_over(clump, fluid, G);
    load_on(clump, load);
    if (!clump.held)
      sd_clump_free_velocity(&body.shape->clump, clump.pose, clump.eta, load, fluid, G, clump.V);
    force.resize(3 * (size_t) body.n);
    torque.resize(3 * (size_t) body.n);
    drag_on(clump, fluid, G, force.data(), torque.data());
    for (int k = 0; k < body.n; k++) {
      double *row = &moved[13 * member_of(clump, k)];
      sd_multiply3(clump.pose, body.shape->shape.x + 3 * (size_t) k, arm);
      sd_cross(clump.V + 3, arm, turning);
      row[0] = 1.0;
      for (int d = 0; d < 3; d++) {
        row[1 + d] = clump.V[d] + turning[d];
        row[4 + d] = clump.V[3 + d];
        row[7 + d] = force[3 * (size_t) k + d];
        row[10 + d] = torque[3 * (size_t) k + d];
      }
      Lattice::add(back, &whole.steps[3 * member_of(clump, k)], row + 1);
    }
  }
  if (!rigid.settings.on) return;
  whole.scatter(13, moved.data(), [&](int i, const double *row) {
    if (row[0] != 0.0) take(i, row + 1, row + 7);
  });
}

/* Of the fluid on the spheres of a clump that moves with V */
void Velocities::drag_on(const Clump &clump, const double fluid[3], const double G[9], double *F,
                         double *T) const
{
  const sd_clump *what = &clump.body->shape->clump;
  const double *W = clump.V + 3;
  double s[3];
  for (int d = 0; d < 3; d++) s[d] = fluid[d] - clump.V[d];
  if (!ambient.gradients()) {
    const double minus_W[3] = {-W[0], -W[1], -W[2]};
    sd_clump_forces_rigid(what, clump.pose, clump.eta, s, minus_W, F, T);
    return;
  }
  const double turning[9] = {0.0, -W[2], W[1], W[2], 0.0, -W[0], -W[1], W[0], 0.0};
  double A[9];
  for (int d = 0; d < 9; d++) A[d] = G[d] - turning[d];
  sd_clump_forces(what, clump.pose, clump.eta, s, A, F, T);
}

void Velocities::drag(const Drag &take, std::vector<char> &loose)
{
  enum { NOT_SELECTED, EVALUATED, LOOSE, COLUMNS = 7 };
  find(true);
  const WholeClumps &members = scene.whole;
  const bool turns = scene.settings.rotation;
  std::vector<double> F, T, result(COLUMNS * (size_t) members.size() + COLUMNS, 0.0);
  for (size_t m = 0; m < (size_t) members.size(); m++) result[COLUMNS * m] = LOOSE;
  for (int m : rigid.members()) result[COLUMNS * (size_t) m] = NOT_SELECTED;
  for (const Clump &clump : clumps) {
    const ClumpShape &is = *clump.body->shape;
    const sd_clump_motion motion = look_at(clump);
    F.resize(3 * (size_t) clump.body->n);
    T.resize(3 * (size_t) clump.body->n);
    sd_clump_drag(&is.shape, &is.clump, &motion, clump.pose, clump.eta, F.data(),
                  turns ? T.data() : nullptr);
    for (size_t k = 0; k < (size_t) clump.body->n; k++) {
      double *row = &result[COLUMNS * member_of(clump, (int) k)];
      row[0] = EVALUATED;
      std::copy_n(&F[3 * k], 3, row + 1);
      if (turns) std::copy_n(&T[3 * k], 3, row + 4);
    }
  }
  loose.assign(atom->nlocal + 1, 0);
  for (int i = 0; i < atom->nlocal; i++) loose[i] = atom->molecule[i] == 0;
  members.scatter(COLUMNS, result.data(), [&](int i, const double *row) {
    if (row[0] == EVALUATED) take(i, row + 1);
    if (row[0] == LOOSE) loose[i] = 1;
  });
}

}    // namespace StokesDyn
