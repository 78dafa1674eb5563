/* Of velocities: clumps by themselves, by the tables of their shapes: velocities from forces, and
 * forces from velocities. */
#include "velocities.h"

#include "sd_linear.h"

#include "atom.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* What the spheres of a clump and the fluid at them do, in the order of its shape. The angular
 * velocities of spheres that are not on a line say nothing that their velocities do not. */
const sd_clump_motion &Velocities::look_at(const Clump &clump, bool moving)
{
  const RigidClumps::Body &body = *clump.body;
  const bool strains = ambient.gradients() != nullptr;
  const bool spins = moving && scene.settings.rotation && body.shape->shape.rank < 2;
  Around &a = around;
  if (a.x.size() < 3 * (size_t) body.n) {
    for (auto *rows : {&a.x, &a.v, &a.omega, &a.u, &a.F, &a.T}) rows->resize(3 * (size_t) body.n);
    a.gradient.resize(9 * (size_t) body.n);
  }
  for (int k = 0; k < body.n && (moving || strains); k++) {
    const double *known = known_of(clump, k), *motion = known + column.motion;
    memcpy(&a.x[3 * (size_t) k], at(clump, k), 3 * sizeof(double));
    if (moving) memcpy(&a.v[3 * (size_t) k], motion, 3 * sizeof(double));
    if (spins) memcpy(&a.omega[3 * (size_t) k], motion + 3, 3 * sizeof(double));
    if (!strains) continue;
    memcpy(&a.u[3 * (size_t) k], known + column.flow, 3 * sizeof(double));
    memcpy(&a.gradient[9 * (size_t) k], known + column.gradient, 9 * sizeof(double));
  }
  a.motion = {};
  a.motion.x = a.x.data();
  a.motion.v = a.v.data();
  a.motion.omega = spins ? a.omega.data() : nullptr;
  std::copy_n(ambient.uniform_velocity(), 3, a.motion.u_uniform);
  a.motion.u = strains ? a.u.data() : nullptr;
  a.motion.gradient = strains ? a.gradient.data() : nullptr;
  return a.motion;
}

/* Velocity of the fluid at the centroid and its gradient over the clump */
void Velocities::flow_over(const Clump &clump, double fluid[3], double G[9])
{
  sd_clump_flow(&clump.body->shape->shape, &look_at(clump, false), clump.pose, clump.pose + 9, fluid,
                G);
}

/* Force and torque about the centroid */
void Velocities::load_on(const Clump &clump, double load[6]) const
{
  const double *c = clump.pose + 9;
  std::fill_n(load, 6, 0.0);
  for (int k = 0; k < clump.body->n; k++) {
    const double *f = known_of(clump, k) + column.motion, *torque = f + 3, *x = at(clump, k);
    const double arm[3] = {x[0] - c[0], x[1] - c[1], x[2] - c[2]};
    double couple[3];
    sd_cross(arm, f, couple);
    for (int d = 0; d < 3; d++) {
      load[d] += f[d];
      load[3 + d] += torque[d] + couple[d];
    }
  }
}

void Velocities::apart(int width, const Take &take)
{
  double move[6], by_fluid[6];
  for (int i : lone) {
    const double k = ambient.drag(i), k_spin = ambient.spin(i);
    ambient.fluid(i, move);
    for (int d = 0; d < 3; d++) {
      move[d] += atom->f[i][d] / k;
      by_fluid[d] = -atom->f[i][d];
      if (width == 3) continue;
      move[3 + d] += atom->torque[i][d] / k_spin;
      by_fluid[3 + d] = -atom->torque[i][d];
    }
    double given[6];
    if (held && held(i, given)) {
      ambient.fluid(i, by_fluid);
      for (int d = 0; d < width; d++) {
        move[d] = given[d];
        by_fluid[d] = (d < 3 ? k : k_spin) * (by_fluid[d] - given[d]);
      }
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
  result.assign(COLUMNS * (size_t) members.size() + COLUMNS, 0.0);
  for (size_t m = 0; m < (size_t) members.size(); m++) result[COLUMNS * m] = LOOSE;
  for (int m : rigid.members()) result[COLUMNS * (size_t) m] = NOT_SELECTED;
  for (const Clump &clump : clumps) {
    const ClumpShape &is = *clump.body->shape;
    const sd_clump_motion &motion = look_at(clump, true);
    sd_clump_drag(&is.shape, &is.clump, &motion, clump.pose, clump.eta, around.F.data(),
                  turns ? around.T.data() : nullptr);
    for (int k = 0; k < clump.body->n; k++) {
      double *row = &result[COLUMNS * member_of(clump, k)];
      row[0] = EVALUATED;
      memcpy(row + 1, &around.F[3 * (size_t) k], 3 * sizeof(double));
      if (turns) memcpy(row + 4, &around.T[3 * (size_t) k], 3 * sizeof(double));
    }
  }
  loose.assign(atom->nlocal + 1, 0);
  for (int i = 0; i < atom->nlocal; i++) loose[i] = atom->molecule[i] == 0;
  members.scatter(COLUMNS, result.data(), [&](int i, const double *row) {
    if (row[0] == EVALUATED) take(i, row + 1, turns ? row + 4 : nullptr);
    if (row[0] == LOOSE) loose[i] = 1;
  });
}

}    // namespace StokesDyn
