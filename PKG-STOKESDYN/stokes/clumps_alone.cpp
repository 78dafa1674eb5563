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
  if (!rigid.settings.on) return;
  std::vector<double> v, force, torque;
  double back[6] = {0.0}, row[12];
  for (int d = 0; d < 6 && ambient.jumps(); d++) back[d] = -ambient.jumps()[d];
  const auto all = [&](const auto &give) {
    for (Clump &clump : all_clumps) {
      const ClumpShape &is = shape(clump);
      const size_t n = body(clump).n, at = 3 * (size_t) body(clump).begin;
      const sd_clump_motion motion = look_at(clump);
      v.resize(6 * n);
      force.resize(3 * n);
      torque.resize(3 * n);
      sd_clump_settle(&is.shape, &is.clump, &motion, clump.pose, clump.eta, &spheres.motion[at],
                      &spheres.turning[at], clump.known == SD_BODY_HELD, clump.V, v.data(),
                        force.data(), torque.data());
      for (size_t k = 0; k < n; k++) {
        const size_t m = member_of(clump, (int) k);
        std::copy_n(&v[6 * k], 6, row);
        std::copy_n(&force[3 * k], 3, row + 6);
        std::copy_n(&torque[3 * k], 3, row + 9);
        sd_add_edges(back, &scene.whole.steps[3 * m], row);
        give(m, row);
      }
    }
  };
  scene.whole.scatter(12, all, [&](int i, const double *of) { take(i, of, of + 6); });
}

void ClumpPoses::drag(const Drag &take, std::vector<char> &loose)
{
  const bool turns = scene.settings.rotation;
  std::vector<double> F, T;
  double row[7] = {0.0};    // loose, force, torque
  const auto all = [&](const auto &give) {
    for (const Clump &clump : clumps()) {
      const ClumpShape &is = shape(clump);
      const sd_clump_motion motion = look_at(clump);
      F.resize(3 * (size_t) body(clump).n);
      T.resize(3 * (size_t) body(clump).n);
      sd_clump_drag(&is.shape, &is.clump, &motion, clump.pose, clump.eta, F.data(),
                    turns ? T.data() : nullptr);
      for (size_t k = 0; k < (size_t) body(clump).n; k++) {
        std::copy_n(&F[3 * k], 3, row + 1);
        if (turns) std::copy_n(&T[3 * k], 3, row + 4);
        give(member_of(clump, (int) k), row);
      }
    }
    row[0] = 1.0;
    for (size_t m = 0; m < rigid.places().size(); m++)
      if (rigid.places()[m] < 0) give(m, row);
  };
  loose.assign(atom->nlocal + 1, 0);
  for (int i = 0; i < atom->nlocal; i++) loose[i] = atom->molecule[i] == 0;
  scene.whole.scatter(7, all, [&](int i, const double *of) {
    if (of[0] == 0.0)
      take(i, of + 1);
    else
      loose[i] = 1;
  });
}

}    // namespace StokesDyn
