#include "velocities.h"

#include "callback.h"

#include "sd_clump_motion.h"
#include "sd_linear.h"

#include "atom.h"
#include "comm.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;

namespace StokesDyn {

Velocities::Velocities(LAMMPS *lmp, const Parts &parts) :
    Pointers(lmp), scene(parts.scene), ambient(parts.ambient), rigid(parts.rigid),
    lubrication(parts.lubrication)
{
}

Velocities::~Velocities()
{
  sd_tie_free(&tie);
}

double Velocities::memory_usage() const
{
  double numbers = ghosts.capacity();
  for (const auto *array : {&F, &u, &v, &exerted, &D, &arm, &V, &work, &gradient})
    numbers += array->capacity();
  return sizeof(double) * numbers;
}

// --- the clumps where they stand -----------------------------------------------------------------

enum { ETA = 0, LOAD = 1, FLOW = 7, GRADIENT = 10, WITH_FLOW = 19 };

/* What clumps must know of spheres on other ranks. */
void Velocities::gather_ghosts()
{
  const double *gradients = ambient.gradients();
  columns = gradients ? WITH_FLOW : FLOW;
  scene.refresh_ghosts(ghosts, columns, [&](int i, double *row) {
    row[ETA] = ambient.active()[i] ? ambient.viscosity(i) : 0.0;
    std::copy_n(atom->f[i], 3, row + LOAD);
    std::copy_n(atom->torque[i], 3, row + LOAD + 3);
    if (!gradients) return;
    std::copy_n(ambient.velocity(i), 3, row + FLOW);
    std::copy_n(gradients + 9 * (size_t) i, 9, row + GRADIENT);
  });
}

/* Who is in no clump; and is a clump here and elsewhere? */
void Velocities::part_lone()
{
  if (arranged == rigid.arrangement() && selection == ambient.selection()) return;
  arranged = rigid.arrangement();
  selection = ambient.selection();
  std::vector<char> bound(atom->nlocal, 0);
  int crosses = 0;
  for (int i : rigid.owns()) {
    if (i >= 0) bound[i] = 1;
    crosses = crosses || i < 0;
  }
  across = crosses;
  lone.clear();
  for (int i : ambient.who())
    if (!bound[i]) lone.push_back(i);
}

void Velocities::find()
{
  clumps.clear();
  if (!rigid.settings.on) {
    lone = ambient.who();
    return;
  }
  const auto &all = rigid.find();
  part_lone();
  int anywhere = across;
  MPI_Allreduce(MPI_IN_PLACE, &anywhere, 1, MPI_INT, MPI_MAX, world);
  across = anywhere;
  if (across) gather_ghosts();

  int64_t split = RigidClumps::NOBODY, bent = RigidClumps::NOBODY;
  std::vector<double> x;
  for (const auto &body : all) {
    const sd_shape &shape = body.shape->shape;
    Clump clump = {&body, {}, 0.0, {}};
    int taking_part = 0;
    x.resize(3 * (size_t) body.n);
    for (int k = 0; k < body.n; k++) {
      const int j = rigid.members()[body.begin + k], i = rigid.owns()[body.begin + k];
      const double eta_k = i < 0 ? ghost(j)[ETA] : ambient.active()[i] ? ambient.viscosity(i) : 0.0;
      taking_part += eta_k > 0.0;
      clump.eta += eta_k / body.n;
      for (int d = 0; d < 3; d++) x[3 * (size_t) k + d] = atom->x[j][d];
    }
    if (taking_part == 0) continue;
    if (taking_part < body.n) split = std::min(split, body.molecule);
    const double deviation = sd_shape_pose(&shape, x.data(), clump.pose, clump.pose + 9);
    if (!(deviation <= SD_SHAPE_TOLERANCE * shape.size)) bent = std::min(bent, body.molecule);
    clumps.push_back(clump);
  }
  int64_t trouble[2] = {split, bent};
  MPI_Allreduce(MPI_IN_PLACE, trouble, 2, MPI_LMP_BIGINT, MPI_MIN, world);
  rigid.refuse(trouble[0], trouble[1]);
}

/* Velocity of the fluid at the centroid and its gradient over the clump */
void Velocities::flow_over(const Clump &clump, double fluid[3], double G[9])
{
  const RigidClumps::Body &body = *clump.body;
  const double *gradients = ambient.gradients();
  sd_clump_motion motion = {};
  std::copy_n(ambient.uniform_velocity(), 3, motion.u_uniform);
  std::vector<double> x, velocity, of_velocity;
  if (gradients) {
    for (int k = 0; k < body.n; k++) {
      const int j = rigid.members()[body.begin + k], i = rigid.owns()[body.begin + k];
      const double *at = atom->x[j];
      const double *v = i < 0 ? ghost(j) + FLOW : ambient.velocity(i);
      const double *g = i < 0 ? ghost(j) + GRADIENT : gradients + 9 * (size_t) i;
      x.insert(x.end(), at, at + 3);
      velocity.insert(velocity.end(), v, v + 3);
      of_velocity.insert(of_velocity.end(), g, g + 9);
    }
    motion.x = x.data();
    motion.u = velocity.data();
    motion.gradient = of_velocity.data();
  }
  sd_clump_flow(&body.shape->shape, &motion, clump.pose, clump.pose + 9, fluid, G);
}

/* Force and torque about the centroid */
void Velocities::load_on(const Clump &clump, double load[6]) const
{
  const RigidClumps::Body &body = *clump.body;
  const int *members = &rigid.members()[body.begin], *owns = &rigid.owns()[body.begin];
  const double *c = clump.pose + 9;
  std::fill_n(load, 6, 0.0);
  for (int k = 0; k < body.n; k++) {
    const double *f = owns[k] < 0 ? ghost(members[k]) + LOAD : atom->f[owns[k]];
    const double *torque = owns[k] < 0 ? f + 3 : atom->torque[owns[k]], *x = atom->x[members[k]];
    const double arm[3] = {x[0] - c[0], x[1] - c[1], x[2] - c[2]};
    double couple[3];
    sd_cross(arm, f, couple);
    for (int d = 0; d < 3; d++) {
      load[d] += f[d];
      load[3 + d] += torque[d] + couple[d];
    }
  }
}

// --- rows ------------------------------------------------------------------------------------------

/* Forces on the spheres, the fluid at them, their drags */
void Velocities::place(int width)
{
  const std::vector<int> &who = ambient.who();
  const size_t m = width, n = who.size();
  row_of.assign(atom->nlocal, -1);
  F.resize(m * n + m);
  u.resize(m * n + m);
  D.resize(m * n + m);
  for (size_t k = 0; k < n; k++) {
    const int i = who[k];
    row_of[i] = k;
    for (int d = 0; d < 3; d++) {
      F[m * k + d] = atom->f[i][d];
      if (width == 6) F[m * k + 3 + d] = atom->torque[i][d];
    }
    ambient.fluid(i, &u[m * k]);
    for (size_t d = 0; d < m; d++) D[m * k + d] = d < 3 ? ambient.drag(i) : ambient.spin(i);
  }
}

/* The bodies as the core wants them: free spheres, then clumps */
void Velocities::arrange()
{
  const size_t n = ambient.who().size();
  member.clear();
  shaped.clear();
  loner.clear();
  whole.assign(n + 1, 0);
  arm.assign(3 * n + 3, 0.0);
  for (int i : lone) {
    whole[row_of[i]] = loner.size();
    loner.push_back(row_of[i]);
  }
  std::vector<double> arms;
  for (const Clump &clump : clumps) {
    sd_body body = {&rigid.blocks(*clump.body->shape), {}, 1.0, clump.eta, nullptr};
    std::copy_n(clump.pose, 9, body.R);
    arms.resize(3 * (size_t) clump.body->n);
    sd_body_arms(&body, arms.data());
    for (int k = 0; k < clump.body->n; k++) {
      const int row = row_of[rigid.owns()[clump.body->begin + k]];
      member.push_back(row);
      whole[row] = loner.size() + shaped.size();
      std::copy_n(&arms[3 * (size_t) k], 3, &arm[3 * (size_t) row]);
    }
    shaped.push_back(body);
  }
  size_t at = 0;
  for (sd_body &body : shaped) {
    body.row = &member[at];
    at += body.shape->m;
  }
  V.resize(6 * (loner.size() + shaped.size()) + 6);
}

/* u = 0: nobody sees anybody */
static sd_status nobody(void *ctx, const double * /*F*/, double *out)
{
  const sd_mobility_scene *scene = static_cast<sd_mobility_scene *>(ctx);
  std::fill_n(out, (size_t) scene->how.width * scene->n, 0.0);
  return SD_OK;
}

sd_bodies Velocities::bodies(int width)
{
  const int n = ambient.who().size();
  sd_bodies A = {};
  A.lone = loner.size();
  A.loner = loner.data();
  A.shaped = shaped.size();
  A.body = shaped.data();
  A.spheres = {n, width, whole.data(), arm.data()};
  A.points = {n, width, nullptr, nullptr};
  A.D = D.data();
  alone.how.width = width;
  alone.n = n;
  const bool sees = scene.anybody_sees();
  A.apply = sees ? sd_mobility_apply : nobody;
  A.apply_ctx = sees ? (void *) scene.mobility() : &alone;
  A.world.ctx = &scene;
  A.world.me = comm->me;
  A.world.ranks = comm->nprocs;
  A.world.sum = Scene::sum;
  return A;
}

/* A strain carries clumps as their shells say. */
void Velocities::carry(const sd_bodies &A, double *flow)
{
  if (!ambient.gradients() || clumps.empty()) return;
  gradient.resize(9 * clumps.size());
  double centre[3];
  for (size_t c = 0; c < clumps.size(); c++) flow_over(clumps[c], centre, &gradient[9 * c]);
  work.resize(sd_bodies_work(&A));
  sd_bodies_carry(&A, gradient.data(), work.data(), flow);
}

sd_status Velocities::solve(const sd_bodies &A, const How &how, const sd_bodies_problem &problem,
                            Guess &guess, sd_bodies_report &report)
{
  v.resize(u.size());
  exerted.resize(u.size());
  work.resize(sd_bodies_work(&A));
  const sd_bodies_motion motion = {guess.l.data(), guess.v.data(), V.data(), v.data(),
                                   exerted.data()};
  return sd_bodies_solve(&A, &problem, &motion, work.data(), &report);
}

/* Everybody is held, at rest in a fluid that moves with the slip. */
sd_status Velocities::resist(const How &how, const std::vector<double> &slip,
                             std::vector<double> &on_spheres, sd_bodies_report &report)
{
  place(how.width);
  arrange();
  sd_bodies A = bodies(how.width);
  const std::vector<char> held(loner.size() + shaped.size() + 1, 1);
  A.held = held.data();
  const size_t m = how.width, rows = m * ambient.who().size();
  std::copy_n(slip.begin(), rows, u.begin());
  carry(A, u.data());
  Guess guess;
  guess.l.assign(rows + m, 0.0);
  for (size_t j = 0; j < rows && how.warm; j++) guess.l[j] = -on_spheres[j];
  const sd_bodies_problem problem = {u.data(),      F.data(),     nullptr,
                                     how.warm, how.tolerance, how.max_iter};
  const sd_status status = solve(A, how, problem, guess, report);
  for (size_t j = 0; j < rows; j++) on_spheres[j] = -exerted[j];
  return status;
}

sd_status Velocities::together(const How &how, Guess &guess, const Take &take,
                               sd_bodies_report &report)
{
  place(how.width);
  arrange();
  sd_bodies A = bodies(how.width);
  if (lubrication.settings.on) {
    lubrication.place(ambient);
    tie.L = lubrication.matrix();
    A.tie = &tie;
  }
  carry(A, u.data());
  const sd_bodies_problem problem = {u.data(),      F.data(),     nullptr,
                                     how.warm, how.tolerance, how.max_iter};
  const sd_status status = solve(A, how, problem, guess, report);
  for (size_t c = 0; c < clumps.size(); c++)
    std::copy_n(&V[6 * (loner.size() + c)], 6, clumps[c].V);
  for (size_t k = 0; k < ambient.who().size(); k++) {
    const size_t row = how.width * k;
    double by_fluid[6];
    for (int d = 0; d < how.width; d++) by_fluid[d] = -exerted[row + d];
    take(ambient.who()[k], &v[row], by_fluid);
  }
  return status;
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
    take(i, move, by_fluid);
  }
  std::vector<double> force, torque;
  for (Clump &clump : clumps) {
    const RigidClumps::Body &body = *clump.body;
    const int *owns = &rigid.owns()[body.begin];
    double fluid[3], G[9], load[6], arm[3], turning[3];
    flow_over(clump, fluid, G);
    load_on(clump, load);
    sd_clump_free_velocity(&body.shape->clump, clump.pose, clump.eta, load, fluid, G, clump.V);
    force.resize(3 * (size_t) body.n);
    torque.resize(3 * (size_t) body.n);
    drag_on(clump, fluid, G, force.data(), torque.data());
    for (int k = 0; k < body.n; k++) {
      if (owns[k] < 0) continue;
      sd_multiply3(clump.pose, body.shape->shape.x + 3 * (size_t) k, arm);
      sd_cross(clump.V + 3, arm, turning);
      for (int d = 0; d < 3; d++) {
        move[d] = clump.V[d] + turning[d];
        move[3 + d] = clump.V[3 + d];
        by_fluid[d] = force[3 * (size_t) k + d];
        by_fluid[3 + d] = torque[3 * (size_t) k + d];
      }
      take(owns[k], move, by_fluid);
    }
  }
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

}    // namespace StokesDyn
