/* Of clump_poses: clumps by themselves, by the tables of their shapes: velocities from forces, and forces
 * from velocities. A closed form for each, so there is nothing to solve. */
#include "clump_poses.h"

#include "sd_linear.h"

#include "atom.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* What the spheres of a clump and the fluid at them do. The angular velocities of spheres that are
 * not on a line say nothing that their velocities do not. */
sd_clump_motion ClumpPoses::look_at(const Clump &clump) const
{
  const bool strains = ambient.gradients(), spins = scene.settings.rotation;
  const size_t at = 3 * (size_t) body(clump).begin;
  sd_clump_motion m = {};
  m.x = &spheres.x[at];
  m.v = &spheres.motion[at];
  m.omega = spins && shape(clump).shape.rank < 2 ? &spheres.turning[at] : nullptr;
  std::copy_n(ambient.uniform_velocity(), 3, m.u_uniform);
  m.u = strains ? &spheres.flow[at] : nullptr;
  m.gradient = strains ? &spheres.gradient[3 * at] : nullptr;
  return m;
}

void ClumpPoses::velocities(int width, const Take &take)
{
  double fluid_there[6], V[6], move[6], by_fluid[6];
  for (int i : lone()) {
    const bool known = given.held && given.held(i, V);
    ambient.fluid(i, fluid_there);
    for (int d = 0; d < width; d++) {
      const double k = ambient.resistance(i, d), f = given.load(i, d);
      move[d] = known ? V[d] : fluid_there[d] + f / k;
      by_fluid[d] = known ? k * (fluid_there[d] - V[d]) : -f;
    }
    take(i, move, by_fluid);
  }
  const WholeClumps &whole = scene.whole;
  std::vector<double> v, force, torque, moved(13 * (size_t) whole.size() + 13, 0.0);
  double back[6] = {0.0};
  for (int d = 0; d < 6 && ambient.jumps(); d++) back[d] = -ambient.jumps()[d];
  for (Clump &clump : all_clumps) {
    const ClumpShape &is = shape(clump);
    const size_t n = body(clump).n, at = 3 * (size_t) body(clump).begin;
    const sd_clump_motion motion = look_at(clump);
    v.resize(6 * n);
    force.resize(3 * n);
    torque.resize(3 * n);
    sd_clump_settle(&is.shape, &is.clump, &motion, clump.pose, clump.eta, &spheres.motion[at],
                    &spheres.turning[at], clump.known == SD_BODY_HELD, clump.V, v.data(), force.data(), torque.data());
    for (size_t k = 0; k < n; k++) {
      double *row = &moved[13 * member_of(clump, (int) k)];
      row[0] = 1.0;
      std::copy_n(&v[6 * k], 6, row + 1);
      std::copy_n(&force[3 * k], 3, row + 7);
      std::copy_n(&torque[3 * k], 3, row + 10);
      sd_add_edges(back, &whole.steps[3 * member_of(clump, (int) k)], row + 1);
    }
  }
  if (!rigid.settings.on) return;
  whole.scatter(13, moved.data(), [&](int i, const double *row) {
    if (row[0] != 0.0) take(i, row + 1, row + 7);
  });
}

void ClumpPoses::drag(const Drag &take, std::vector<char> &loose)
{
  enum { NOT_SELECTED, EVALUATED, LOOSE, COLUMNS = 7 };
  const WholeClumps &members = scene.whole;
  const bool turns = scene.settings.rotation;
  std::vector<double> F, T, result(COLUMNS * (size_t) members.size() + COLUMNS, 0.0);
  for (size_t m = 0; m < (size_t) members.size(); m++) result[COLUMNS * m] = LOOSE;
  for (int m : rigid.members()) result[COLUMNS * (size_t) m] = NOT_SELECTED;
  for (const Clump &clump : clumps()) {
    const ClumpShape &is = shape(clump);
    const sd_clump_motion motion = look_at(clump);
    F.resize(3 * (size_t) body(clump).n);
    T.resize(3 * (size_t) body(clump).n);
    sd_clump_drag(&is.shape, &is.clump, &motion, clump.pose, clump.eta, F.data(),
                  turns ? T.data() : nullptr);
    for (size_t k = 0; k < (size_t) body(clump).n; k++) {
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
