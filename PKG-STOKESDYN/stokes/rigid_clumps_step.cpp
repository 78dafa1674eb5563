/* Forces on rigid clumps in a step. */
#include "rigid_clumps.h"

#include "keywords.h"
#include "ranks.h"

#include "atom.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* To ghosts: eta (0: takes no part), v, angular velocity, fluid velocity and its gradient, as far
 * as needed. */
void RigidClumps::gather(const Ambient &ambient)
{
  column = {0, 1, 4, 4, 4, 4};
  if (settings.rotation) column.u = column.gradient = column.end = 7;
  const double *gradient = ambient.gradients();
  if (gradient) {
    column.gradient = column.u + 3;
    column.end = column.gradient + 9;
  }
  scene.refresh_ghosts(ghosts, column.end, [&](int i, double *row) {
    row[0] = ambient.active()[i] ? ambient.viscosity(i) : 0.0;
    memcpy(row + column.v, atom->v[i], 3 * sizeof(double));
    if (settings.rotation) memcpy(row + column.omega, atom->omega[i], 3 * sizeof(double));
    if (gradient) {
      memcpy(row + column.u, ambient.velocity(i), 3 * sizeof(double));
      memcpy(row + column.gradient, gradient + 9 * (size_t) i, 9 * sizeof(double));
    }
  });
}

const std::vector<RigidClumps::Body> &RigidClumps::find()
{
  if (scene.update_clumps()) recognised = false;
  if (!recognised) recognise();
  recognised = true;
  return bodies;
}

void RigidClumps::begin_step(const Ambient &ambient, std::vector<char> &loose)
{
  find();
  gather(ambient);
  loose.assign(atom->nlocal, 0);
  for (int i : not_ours) loose[i] = 1;
}

/* The angular velocities of spheres that are not on a line say nothing that their velocities do
 * not: that memory is left alone. */
bool RigidClumps::asks_for_spins(const Body &body) const
{
  return settings.rotation && body.shape->shape.rank < 2;
}

/* What the spheres of a clump do, in the order of its shape; returns how many take part and adds up
 * their viscosities. */
int RigidClumps::collect(const Body &body, const Ambient &ambient, Step &step, double &eta) const
{
  const size_t n = body.n;
  const int nlocal = atom->nlocal;
  const bool spins = asks_for_spins(body);
  const double *gradient = ambient.gradients();
  if (step.x.size() < 3 * n) {
    for (auto *v : {&step.x, &step.v, &step.omega, &step.u, &step.F, &step.T}) v->resize(3 * n);
    step.gradient.resize(9 * n);
  }
  int taking_part = 0;
  for (size_t k = 0; k < n; k++) {
    const int j = member[body.begin + k];
    const bool ghost = j >= nlocal;
    const double *row = ghost ? &ghosts[(size_t) column.end * (j - nlocal)] : nullptr;
    const double eta_k = ghost ? row[0] : ambient.active()[j] ? ambient.viscosity(j) : 0.0;
    taking_part += eta_k > 0.0;
    eta += eta_k;
    memcpy(&step.x[3 * k], atom->x[j], 3 * sizeof(double));
    memcpy(&step.v[3 * k], ghost ? row + column.v : atom->v[j], 3 * sizeof(double));
    if (spins)
      memcpy(&step.omega[3 * k], ghost ? row + column.omega : atom->omega[j], 3 * sizeof(double));
    if (!gradient) continue;
    memcpy(&step.u[3 * k], ghost ? row + column.u : ambient.velocity(j), 3 * sizeof(double));
    memcpy(&step.gradient[9 * k], ghost ? row + column.gradient : gradient + 9 * (size_t) j,
           9 * sizeof(double));
  }
  return taking_part;
}

/* F and T of a clump's spheres in step, if it takes part and is whole and rigid. */
bool RigidClumps::evaluate(const Body &body, const Ambient &ambient, Step &step) const
{
  double eta = 0.0, pose[12];
  const int taking_part = collect(body, ambient, step, eta);
  if (taking_part == 0) return false;
  if (taking_part < body.n) {
    step.split = std::min(step.split, body.molecule);
    return false;
  }
  const sd_shape *shape = &body.shape->shape;
  const double deviation = sd_shape_pose(shape, step.x.data(), pose, pose + 9);
  if (!(deviation <= SD_SHAPE_TOLERANCE * shape->size)) {
    step.bent.push_back(body.molecule);
    return false;
  }
  sd_clump_motion motion = {};
  motion.x = step.x.data();
  motion.v = step.v.data();
  motion.omega = asks_for_spins(body) ? step.omega.data() : nullptr;
  memcpy(motion.u_uniform, ambient.uniform_velocity(), sizeof(motion.u_uniform));
  motion.u = ambient.gradients() ? step.u.data() : nullptr;
  motion.gradient = ambient.gradients() ? step.gradient.data() : nullptr;
  sd_clump_drag(shape, &body.shape->clump, &motion, pose, eta / body.n, step.F.data(),
                settings.rotation ? step.T.data() : nullptr);
  return true;
}

void RigidClumps::refuse(int64_t split, int64_t bent) const
{
  if (split != NOBODY)
    fail(lmp,
         command + ": keyword rigid_clumps: the clump of molecule " + std::to_string(split) +
             " is split by the keyword group or region: all of its spheres must be selected, or "
             "none");
  if (bent != NOBODY) not_rigid(bent);
}

void RigidClumps::end_step(const Step &step, std::vector<char> &loose)
{
  int64_t first[2] = {step.split, NOBODY};
  for (int64_t molecule : step.bent) first[1] = std::min(first[1], molecule);
  MPI_Allreduce(MPI_IN_PLACE, first, 2, MPI_LMP_BIGINT, MPI_MIN, world);
  refuse(first[0], settings.auto_resolve ? NOBODY : first[1]);
  if (first[1] == NOBODY) return;
  loosen(from_all(world, step.bent));
  arrange();
  for (int i : not_ours) loose[i] = 1;
}

}    // namespace StokesDyn
