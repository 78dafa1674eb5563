#include "rigid_clumps.h"

#include "keywords.h"

#include "sd_linear.h"

#include "atom.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* To ghosts: eta (0: takes no part), v, angular velocity, fluid velocity and its gradient, as far as needed. */
void RigidClumps::gather(const Motion &m)
{
  column = {0, 1, 4, 4, 4, 4};
  if (settings.rotation) column.u = column.gradient = column.end = 7;
  if (m.gradient) {
    column.gradient = column.u + 3;
    column.end = column.gradient + 9;
  }
  scene.refresh_ghosts(ghosts, column.end, [&](int i, double *row) {
    row[0] = m.active[i] ? (m.eta ? m.eta[i] : m.eta_uniform) : 0.0;
    memcpy(row + column.v, atom->v[i], 3 * sizeof(double));
    if (settings.rotation) memcpy(row + column.omega, atom->omega[i], 3 * sizeof(double));
    if (m.gradient) {
      memcpy(row + column.u, m.u_inf ? m.u_inf + 3 * (size_t) i : m.u_uniform, 3 * sizeof(double));
      memcpy(row + column.gradient, m.gradient + 9 * (size_t) i, 9 * sizeof(double));
    }
  });
}

/* Slip of a clump in pose R, c: s0 at the centroid and the gradient A (row-major) of the slip field. Spheres in the shape's order. */
void RigidClumps::slip(const Shape &s, const double R[9], const double c[3], const Motion &m,
                       double s0[3], double W[3], double A[9]) const
{
  const int n = s.shape.n;
  const double share = 1.0 / n;
  const bool spins = settings.rotation && s.shape.rank < 2;    // the centres do not tell all of it
  double U[3] = {0.0}, L[3] = {0.0}, spin[3] = {0.0}, u[3] = {0.0}, G[9] = {0.0};
  for (int k = 0; k < n; k++) {
    const Sphere &sphere = spheres[k];
    const double *v = sphere.v;
    const double r[3] = {x[3 * k] - c[0], x[3 * k + 1] - c[1], x[3 * k + 2] - c[2]};
    double rv[3];
    sd_cross(r, v, rv);
    for (int d = 0; d < 3; d++) {
      U[d] += v[d] * share;
      L[d] += rv[d];
    }
    if (spins)
      for (int d = 0; d < 3; d++) spin[d] += sphere.omega[d] * share;
    if (!m.gradient) continue;
    for (int d = 0; d < 3; d++) u[d] += sphere.u[d] * share;
    for (int d = 0; d < 9; d++) G[d] += sphere.gradient[d] * share;
  }
  // Angular velocity from the velocities of the centres; about an axis that all of them sit on, from the spheres' own.
  double body[3], turned[3];
  sd_multiply3t(R, L, body);
  sd_multiply3(s.spin_inverse, body, turned);
  if (spins) {
    sd_multiply3t(R, spin, body);
    const double about = sd_dot(body, s.axis);
    for (int d = 0; d < 3; d++)
      turned[d] = s.shape.rank == 0 ? body[d] : turned[d] + about * s.axis[d];
  }
  double w[3];
  sd_multiply3(R, turned, w);
  if (!m.gradient) {
    for (int d = 0; d < 3; d++) {
      s0[d] = m.u_uniform[d] - U[d];
      W[d] = -w[d];
    }
    return;
  }
  // What the given gradient does not explain of the fluid velocities at the centres is fitted: all of it, where the fluid velocity is
  // stored per atom.
  double B[9] = {0.0}, RB[9], fit[9], Rt[9], residual[9];
  for (int k = 0; k < n; k++) {
    const Sphere &sphere = spheres[k];
    const double r[3] = {x[3 * k] - c[0], x[3 * k + 1] - c[1], x[3 * k + 2] - c[2]};
    double e[3];
    sd_multiply3(G, r, e);
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++) B[3 * p + q] += (sphere.u[p] - u[p] - e[p]) * r[q];
  }
  // B (sum r r)^-1 = B R (sum X X)^-1 R^T
  sd_product3(B, R, RB);
  sd_product3(RB, s.gradient_inverse, fit);
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) Rt[3 * p + q] = R[3 * q + p];
  sd_product3(fit, Rt, residual);
  const double Wx[9] = {0.0, -w[2], w[1], w[2], 0.0, -w[0], -w[1], w[0], 0.0};
  for (int d = 0; d < 9; d++) A[d] = G[d] + residual[d] - Wx[d];
  for (int d = 0; d < 3; d++) s0[d] = u[d] - U[d];
}

enum { SPLIT = 1, BENT = 2 };

void RigidClumps::begin_step(const Motion &m, std::vector<char> &loose)
{
  if (scene.update_clumps()) recognise();
  gather(m);
  const int nlocal = atom->nlocal;
  loose.resize(nlocal);
  for (int i = 0; i < nlocal; i++) loose[i] = atom->molecule[i] == 0;
  worst = 0;
  bent.clear();
}

bool RigidClumps::evaluate(size_t number, const Motion &m, std::vector<char> &loose)
{
  const auto &clump = scene.clumps[number];
  const Known &of = *of_clump[number];
  const int n = clump.end - clump.begin, nlocal = atom->nlocal;
  if (of.shape < 0) {
    for (int k = clump.begin; k < clump.end; k++)
      if (scene.owned[k] >= 0) loose[scene.owned[k]] = 1;
    return false;
  }
  if (x.size() < 3 * (size_t) n) {
    x.resize(3 * (size_t) n);
    F.resize(3 * (size_t) n);
    T.resize(3 * (size_t) n);
    spheres.resize(n);
  }
  int taking_part = 0;
  double eta = 0.0;
  for (int k = 0; k < n; k++) {
    const int j = scene.member[clump.begin + of.perm[k]];
    memcpy(&x[3 * (size_t) k], atom->x[j], 3 * sizeof(double));
    if (j < nlocal) {
      taking_part += m.active[j];
      eta += m.eta ? m.eta[j] : m.eta_uniform;
      spheres[k] = {atom->v[j], settings.rotation ? atom->omega[j] : nullptr,
                    m.u_inf ? m.u_inf + 3 * (size_t) j : m.u_uniform,
                    m.gradient ? m.gradient + 9 * (size_t) j : nullptr};
    } else {
      const double *row = &ghosts[(size_t) column.end * (j - nlocal)];
      taking_part += row[0] > 0.0;
      eta += row[0];
      spheres[k] = {row + column.v, row + column.omega, row + column.u, row + column.gradient};
    }
  }
  if (taking_part == 0) return false;
  if (taking_part < n) {
    worst = std::max(worst, 4 * clump.molecule + SPLIT);
    return false;
  }
  const Shape &s = shapes[of.shape];
  double R[9], c[3], s0[3], W[3], A[9];
  const double deviation = sd_shape_pose(&s.shape, x.data(), R, c);
  if (!(deviation <= RIGID_TO * s.shape.size)) {
    worst = std::max(worst, 4 * clump.molecule + BENT);
    bent.push_back(clump.molecule);
    return false;
  }
  slip(s, R, c, m, s0, W, A);
  double *torque = settings.rotation ? T.data() : nullptr;
  if (m.gradient)
    sd_clump_forces(&s.clump, R, eta / n, s0, A, F.data(), torque);
  else
    sd_clump_forces_rigid(&s.clump, R, eta / n, s0, W, F.data(), torque);
  return true;
}

void RigidClumps::end_step(std::vector<char> &loose)
{
  int64_t any;
  MPI_Allreduce(&worst, &any, 1, MPI_LMP_BIGINT, MPI_MAX, world);
  if (any % 4 == SPLIT)
    fail(lmp,
         command + ": keyword rigid_clumps: the clump of molecule " + std::to_string(any / 4) +
             " is split by the keyword group or region: all of its spheres must be selected, or "
             "none");
  if (any % 4 == BENT && !settings.auto_resolve)
    fail(lmp,
         command + ": keyword rigid_clumps: the clump of molecule " + std::to_string(any / 4) +
             " is not rigid: its shape has changed by more than " + text(RIGID_TO) +
             " of its size (rigid_clumps auto solves such clumps anew)");
  if (any) {    // from now on the solver has them
    for (double molecule : from_all_ranks(bent, world)) {
      loose_molecules.insert((int64_t) molecule);
      const auto found = known.find((int64_t) molecule);
      if (found != known.end()) found->second.shape = -1;
    }
    for (size_t number = 0; number < scene.clumps.size(); number++)
      if (of_clump[number]->shape < 0)
        for (int k = scene.clumps[number].begin; k < scene.clumps[number].end; k++)
          if (scene.owned[k] >= 0) loose[scene.owned[k]] = 1;
  }
}

}    // namespace StokesDyn
