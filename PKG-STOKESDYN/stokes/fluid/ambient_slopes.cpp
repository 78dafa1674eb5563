/* Of ambient: how the fluid velocity changes from place to place: derivatives at the spheres, jumps from one
 * image to the next, and what it is at a wall. */
#include "ambient.h"

#include "ranks.h"

#include "sd_lattice.h"
#include "sd_linear.h"

#include "domain.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace LAMMPS_NS;

namespace StokesDyn {

static void edge_of_box(const Domain *domain, int q, double edge[3])
{
  const int step[3] = {q == 0, q == 1, q == 2};
  std::fill_n(edge, 3, 0.0);
  sd_add_edges(domain->h, step, edge);
}

/* Of the components that are formulas: sums [3] of what they grow by along an edge, over this rank's
 * spheres; most [2] the largest growth beyond the one expected [3], and velocity. */
void Ambient::growth_along(const double edge[3], const double expected[3], double sums[3],
                           double most[2])
{
  const std::vector<double> there = velocity_at(edge, false);
  for (size_t i : those)
    for (size_t p = 0; p < 3; p++) {
      if (!settings.velocity[p].is_atom_style()) continue;
      const double here = u[3 * i + p], growth = there[3 * i + p] - here;
      most[0] = std::max(most[0], std::fabs(growth - expected[p]));
      most[1] = std::max(most[1], std::fabs(here));
      sums[p] += growth;
    }
}

/* In a run of no steps fix deform has no rate for some of its styles. */
double Ambient::misfit()
{
  const bool no_rate = motion.deforms && update->endstep == update->beginstep;
  if (u.empty() || settings.grid || settings.box || no_rate) return 0.0;
  double most[2] = {0.0, 0.0}, sums[3] = {0.0}, edge[3], of_box[3];
  modify->clearstep_compute();
  for (int q = 0; q < 3; q++) {
    if (!domain->periodicity[q]) continue;    // along it nobody sees an image
    edge_of_box(domain, q, edge);
    sd_multiply3(motion.flow.gradient, edge, of_box);
    growth_along(edge, of_box, sums, most);
  }
  modify->addstep_compute(update->ntimestep + 1);
  MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, world);
  return most[0] > 0.0 ? most[0] / std::max(most[0], most[1]) : 0.0;
}

/* Which components are stored for atoms: they are of atom style, are the same at another place, and are not
 * one number for all of several spheres, as a constant formula would be. */
void Ambient::find_stored(const std::vector<double> &elsewhere, bool stored[3]) const
{
  double seen[9];    // of each component: is it another one there, largest value, largest -value
  std::fill_n(seen, 9, -INFINITY);
  for (size_t i : those)
    for (size_t d = 0; d < 3; d++) {
      const double here = u[3 * i + d];
      seen[d] = std::max(seen[d], here != elsewhere[3 * i + d] ? 1.0 : 0.0);
      seen[3 + d] = std::max(seen[3 + d], here);
      seen[6 + d] = std::max(seen[6 + d], -here);
    }
  double spheres = (double) those.size();
  MPI_Allreduce(MPI_IN_PLACE, seen, 9, MPI_DOUBLE, MPI_MAX, world);
  MPI_Allreduce(MPI_IN_PLACE, &spheres, 1, MPI_DOUBLE, MPI_SUM, world);
  for (int d = 0; d < 3; d++)
    stored[d] = settings.velocity[d].is_atom_style() && seen[d] <= 0.0 &&
        (spheres < 2.0 || seen[3 + d] > -seen[6 + d]);
}

void Ambient::look_at_plane(int axis, double at, double of_largest[2])
{
  double most[3] = {0.0, 0.0, 0.0};    // along it, across it, and at the spheres
  std::fill_n(of_largest, 2, 0.0);
  if (settings.box) return;
  if (u.empty()) {    // of numbers everybody knows without looking
    for (int d = 0; d < 3; d++)
      if (settings.velocity[d].is_variable())
        most[d == axis] = std::max(most[d == axis], std::fabs(u_uniform[d]));
  } else {
    bool stored[3];
    modify->clearstep_compute();
    const std::vector<double> there = velocity_at([&](int, double *x) { x[axis] = at; }, -1);
    modify->addstep_compute(update->ntimestep + 1);
    find_stored(there, stored);
    for (size_t i : those)
      for (int d = 0; d < 3; d++) {
        if (stored[d] || !std::isfinite(there[3 * i + d])) continue;    // or beyond a grid
        most[d == axis] = std::max(most[d == axis], std::fabs(there[3 * i + d]));
        most[2] = std::max(most[2], std::fabs(u[3 * i + d]));
      }
  }
  MPI_Allreduce(MPI_IN_PLACE, most, 3, MPI_DOUBLE, MPI_MAX, world);
  for (int k = 0; k < 2; k++)
    if (most[k] > 0.0) of_largest[k] = most[k] / std::max(most[k], most[2]);
}

/* The mean over all spheres, since in a flow that goes with the box it is the same for each; the
 * edges have no other components. */
void Ambient::find_jumps()
{
  static const int OF[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};    // velocity, edge
  static const double NOTHING[3] = {0.0, 0.0, 0.0};
  jumping = false;
  std::fill_n(jump, 6, 0.0);
  if (!domain->deform_flag || u.empty() || settings.grid) return;
  double sums[3][3] = {{0.0}}, most[2] = {0.0, 0.0}, count = 1.0, edge[3];
  for (int q = 0; q < 3; q++) {
    edge_of_box(domain, q, edge);
    if (settings.box)
      sd_multiply3(motion.flow.gradient, edge, sums[q]);
    else if (domain->periodicity[q])
      growth_along(edge, NOTHING, sums[q], most);
  }
  if (!settings.box) {
    MPI_Allreduce(MPI_IN_PLACE, sums, 9, MPI_DOUBLE, MPI_SUM, world);
    MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, world);
    count = sum_of_all(world, (double) those.size());
  }
  jumping = settings.box || most[0] > 1e-9 * most[1];
  for (int k = 0; k < 6; k++) jump[k] = jumping ? sums[OF[k][1]][OF[k][0]] / count : 0.0;
}

/* By central differences over one radius to either side. Values stored per atom do not follow, and
 * their gradient comes out as 0. A vorticity that is given needs none of this, and a rotation no
 * component along its own direction. */
void Ambient::read_gradient()
{
  if (gradient.empty() && settings.has_vorticity) return;
  for (size_t q = 0; q < 3; q++) {
    const int but = gradient.empty() ? (int) q : -1;
    double by[3] = {0.0, 0.0, 0.0};
    by[q] = 1.0;
    const std::vector<double> ahead = velocity_at(by, true, but);
    by[q] = -1.0;
    const std::vector<double> behind = velocity_at(by, true, but);
    for (size_t i = 0; i < (size_t) atom->nlocal; i++) {
      double G[9] = {0.0}, rotation[3];
      for (size_t p = 0; p < 3; p++)
        G[3 * p + q] = sd_flow_slope(ahead[3 * i + p], behind[3 * i + p], atom->radius[i]);
      sd_flow_rotation(G, rotation);
      for (size_t p = 0; p < 3; p++) {
        w[3 * i + p] += rotation[p];
        if (!gradient.empty()) gradient[9 * i + 3 * p + q] = G[3 * p + q];
      }
    }
  }
}

void Ambient::read_vorticity()
{
  for (int d = 0; d < 3; d++) settings.vorticity[d].evaluate(lmp, igroup, w.data() + d, 3);
  if (!gradient.empty())
    for (int i = 0; i < atom->nlocal; i++)
      sd_flow_set_vorticity(&w[3 * (size_t) i], &gradient[9 * (size_t) i]);
  for (double &value : w) value *= 0.5;
}

/* By second differences. Values stored per atom do not follow, and have none. */
void Ambient::read_curvature()
{
  std::vector<double> bend(SD_FLOW_SECOND * ((size_t) atom->nlocal + 1), 0.0);
  for (int e = 0; e < SD_FLOW_DIRECTIONS; e++)
    for (const double side : {SD_FLOW_STEP, -SD_FLOW_STEP}) {
      double by[3];
      for (int d = 0; d < 3; d++) by[d] = side * sd_flow_around[e][d];
      const std::vector<double> there = velocity_at(by, true);
      for (size_t i : those)
        for (size_t p = 0; p < 3; p++)
          bend[SD_FLOW_SECOND * i + 6 * p + e] += there[3 * i + p] - u[3 * i + p];
    }
  for (size_t i : those) {
    const double *from = &bend[SD_FLOW_SECOND * i];
    const bool known = std::isfinite(std::accumulate(from, from + SD_FLOW_SECOND, 0.0));
    for (int p = 0; p < 3 && known; p++)
      sd_flow_curvature(from + 6 * p, SD_FLOW_STEP * atom->radius[i],
                        &curvature[SD_FLOW_SECOND * i + 6 * p]);
  }
}

}    // namespace StokesDyn
