/* Forces on rigid clumps in a step. */
#include "rigid_clumps.h"

#include "keywords.h"
#include "ranks.h"

#include "atom.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* Of members: eta (0: takes no part), radius, v, angular velocity, fluid velocity and its gradient,
 * as far as needed. Velocities are those of the images side by side. */
void RigidClumps::gather(const Ambient &ambient)
{
  column = {0, 1, 2, 5, 5, 5, 5};
  if (settings.rotation) column.u = column.gradient = column.end = 8;
  const double *gradient = ambient.gradients(), *jumps = ambient.jumps();
  if (gradient) {
    column.gradient = column.u + 3;
    column.end = column.gradient + 9;
  }
  known_of = whole.gather(column.end, [&](int i, double *row) {
    row[0] = ambient.active()[i] ? ambient.viscosity(i) : 0.0;
    row[column.radius] = atom->radius[i];
    memcpy(row + column.v, atom->v[i], 3 * sizeof(double));
    if (settings.rotation) memcpy(row + column.omega, atom->omega[i], 3 * sizeof(double));
    if (!gradient) return;
    memcpy(row + column.u, ambient.velocity(i), 3 * sizeof(double));
    memcpy(row + column.gradient, gradient + 9 * (size_t) i, 9 * sizeof(double));
  });
  for (size_t m = 0; m < whole.tag.size() && jumps; m++) {
    double *row = &known_of[column.end * m];
    Lattice::add(jumps, &whole.steps[3 * m], row + column.v);
    if (gradient) Lattice::add(jumps, &whole.steps[3 * m], row + column.u);
  }
}

const std::vector<RigidClumps::Body> &RigidClumps::find()
{
  if (recognised != whole.arrangement()) recognise();
  recognised = whole.arrangement();
  return bodies;
}

bool RigidClumps::fits(const Body &body, const double *radii, int columns, double *pose) const
{
  const sd_shape &shape = body.shape->shape;
  const double most = SD_SHAPE_TOLERANCE * shape.size;
  std::vector<double> x;
  for (int k = 0; k < body.n; k++) {
    const size_t m = member[body.begin + k];
    if (!(std::fabs(radii[columns * m] - shape.a[k]) <= most)) return false;
    x.insert(x.end(), &whole.x[3 * m], &whole.x[3 * m] + 3);
  }
  return sd_shape_pose(&shape, x.data(), pose, pose + 9) <= most;
}

/* Of each member, what becomes of it */
void RigidClumps::evaluate_all(const Ambient &ambient)
{
  Step step;
  find();
  gather(ambient);
  result.assign(7 * whole.tag.size() + 7, 0.0);
  for (size_t m = 0; m < whole.tag.size(); m++) result[7 * m] = LOOSE;
  for (const Body &body : bodies) {
    const bool good = evaluate(body, ambient, step);
    for (int k = 0; k < body.n; k++) {
      double *row = &result[7 * (size_t) member[body.begin + k]];
      row[0] = good ? EVALUATED : NOT_SELECTED;
      if (!good) continue;
      memcpy(row + 1, &step.F[3 * k], 3 * sizeof(double));
      if (settings.rotation) memcpy(row + 4, &step.T[3 * k], 3 * sizeof(double));
    }
  }
  settle(step);
}

void RigidClumps::mark_lone(std::vector<char> &loose) const
{
  loose.assign(atom->nlocal + 1, 0);
  for (int i = 0; i < atom->nlocal; i++) loose[i] = atom->molecule[i] == 0;
}

/* The angular velocities of spheres that are not on a line say nothing that their velocities do
 * not: that memory is left alone. */
bool RigidClumps::asks_for_spins(const Body &body) const
{
  return settings.rotation && body.shape->shape.rank < 2;
}

/* What the spheres of a clump do, in the order of its shape; returns how many take part and adds up
 * their viscosities. */
int RigidClumps::collect(const Body &body, bool gradients, Step &step, double &eta) const
{
  const size_t n = body.n;
  const bool spins = asks_for_spins(body);
  if (step.x.size() < 3 * n) {
    for (auto *v : {&step.x, &step.v, &step.omega, &step.u, &step.F, &step.T}) v->resize(3 * n);
    step.gradient.resize(9 * n);
  }
  int taking_part = 0;
  for (size_t k = 0; k < n; k++) {
    const size_t m = member[body.begin + k];
    const double *row = &known_of[column.end * m];
    taking_part += row[0] > 0.0;
    eta += row[0];
    memcpy(&step.x[3 * k], &whole.x[3 * m], 3 * sizeof(double));
    memcpy(&step.v[3 * k], row + column.v, 3 * sizeof(double));
    if (spins) memcpy(&step.omega[3 * k], row + column.omega, 3 * sizeof(double));
    if (!gradients) continue;
    memcpy(&step.u[3 * k], row + column.u, 3 * sizeof(double));
    memcpy(&step.gradient[9 * k], row + column.gradient, 9 * sizeof(double));
  }
  return taking_part;
}

/* F and T of a clump's spheres in step, if it takes part and is whole and rigid. */
bool RigidClumps::evaluate(const Body &body, const Ambient &ambient, Step &step) const
{
  double eta = 0.0, pose[12];
  const int taking_part = collect(body, ambient.gradients() != nullptr, step, eta);
  if (taking_part == 0) return false;
  if (taking_part < body.n) {
    step.split = std::min(step.split, body.molecule);
    return false;
  }
  const sd_shape *shape = &body.shape->shape;
  if (!fits(body, &known_of[column.radius], column.end, pose)) {
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

void RigidClumps::settle(const Step &step)
{
  int64_t first[2] = {step.split, NOBODY};
  for (int64_t molecule : step.bent) first[1] = std::min(first[1], molecule);
  MPI_Allreduce(MPI_IN_PLACE, first, 2, MPI_LMP_BIGINT, MPI_MIN, world);
  refuse(first[0], settings.auto_resolve ? NOBODY : first[1]);
  if (first[1] == NOBODY) return;
  loosen(from_all(world, step.bent));
  for (const auto &clump : whole.clumps)
    for (int m = clump.begin; m < clump.end && loose_molecules.count(clump.molecule); m++)
      result[7 * (size_t) m] = LOOSE;
  arrange();
}

}    // namespace StokesDyn
