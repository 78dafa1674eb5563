/* Of hydrodynamics: what follows from the forces on the fluid, the stress and the flow that they make. */
#include "hydrodynamics.h"

#include "callback.h"

#include "sd_linear.h"

#include "atom.h"
#include "domain.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

using State = FixStokesDynamicsState;

/* What keeps a member of a clump in its place is what it exerts on the fluid less what acts on it, but for
 * random forces of films: these come from nowhere. */
void Hydrodynamics::stress(std::vector<double> &of_atoms)
{
  const bool films_stand = standing();
  stand_rows();
  if (settings.lubrication.on && !films_stand) place_films();
  const Points now = points_of_now();
  const size_t n = scene.size();
  std::vector<double> points(6 * n + 6, 0.0), films(6 * n + 6, 0.0), f(3 * n + 3);
  sd_multiblob_moments((int) n, shells.first_of_rows(), now.r.data(), now.l.data(), points.data());
  const std::vector<double> &random = solver.random_forces();
  for (size_t k = 0; k < n && overdamped; k++)
    for (size_t d = 0; d < 3; d++)
      f[3 * k + d] = solver.exerted[6 * k + d] - bodies.F[6 * k + d] + (random.empty() ? 0.0 : random[6 * k + d]);
  if (overdamped) add_on_members(f, points.data());
  for (size_t j = 0; j < moments_left.size(); j++) points[j] += moments_left[j];
  if (settings.lubrication.on) {
    const double *v = overdamped ? solver.v.data() : films_v.data();
    const sd_status status = sd_lubrication_stress(lubrication.matrix(), v, films.data());
    if (status != SD_OK)
      fail_by(voice.of("stress of films"), status);
  }
  of_atoms.assign(12 * (size_t) atom->nlocal + 12, 0.0);
  for (const auto *part : {&points, &films})
    scene.to_atoms(6, part->data(), [&](int i, const double *row) {
      std::copy_n(row, 6, &of_atoms[12 * (size_t) i + (part == &films ? 6 : 0)]);
    });
}

void Hydrodynamics::add_on_members(const std::vector<double> &f, double *S) const
{
  for (size_t k = scene.lone(); k < (size_t) scene.size(); k++)
    sd_multiblob_moment(1, &bodies.arms()[3 * k], &f[3 * k], S + 6 * k);
}

Hydrodynamics::Points Hydrodynamics::points_that_stand() const
{
  const int n = scene.size();
  const size_t points = shells.first_of_rows()[n];
  const sd_multiblob_spheres spheres = shells.spheres(scene.local(), n);
  Points now;
  now.r.resize(3 * points + 3);
  now.x.resize(3 * points + 3);
  now.b.resize(points + 1);
  sd_multiblob_expand(shells.all_models(), &spheres, now.r.data(), now.x.data(), now.b.data());
  return now;
}

/* Where no solve was needed in this step the rows of the scene may be those of another one. */
Hydrodynamics::Points Hydrodynamics::points_of_now()
{
  if (memory->shell_points == 0 && !solver.found_now())
    voice.at_step().fail("the forces of the points are not kept with warm_start no; use warm_start "
                         "yes");
  stand_rows();
  Points now = points_that_stand();
  now.l = solver.points_now();
  return now;
}

std::vector<double> Hydrodynamics::of_points_on_fluid(std::vector<double> *viscosity)
{
  const Points now = points_of_now();
  const int *first = shells.first_of_rows();
  const double *w = scene.local().w;
  std::vector<double> all;
  for (int i = 0; i < scene.size(); i++)
    for (size_t k = first[i]; k < (size_t) first[i + 1]; k++) {
      if (!(now.b[k] > 0.0)) continue;
      all.insert(all.end(), &now.x[3 * k], &now.x[3 * k] + 3);
      all.push_back(now.b[k]);
      for (int d = 0; d < 6; d++) all.push_back(d < 3 ? w[i] * w[i] * now.l[3 * k + d] : 0.0);
      if (viscosity) viscosity->push_back(1.0 / (w[i] * w[i]));
    }
  return all;
}

/* F is what the mobility knows: without films, which act between two spheres and not on the fluid
 * far from them. */
std::vector<double> Hydrodynamics::on_fluid(std::vector<double> *viscosity)
{
  if (shells.settings.on()) return of_points_on_fluid(viscosity);
  const bool without_films = settings.lubrication.on && !overdamped;
  const int m = width();
  std::vector<double> all;
  const auto add = [&](int i, const double *F) {
    const bool point = settings.scene.tensor == SD_TENSOR_OSEEN;
    all.insert(all.end(), atom->x[i], atom->x[i] + 3);
    all.push_back(point ? 0.0 : atom->radius[i]);
    for (int d = 0; d < 6; d++) all.push_back(d < m ? -F[d] / ambient.viscosity(i) : 0.0);
    if (viscosity) viscosity->push_back(ambient.viscosity(i));
  };
  if (overdamped && settings.rigid.each_alone()) {    // these are not kept
    clump_poses.find();
    clump_poses.velocities(width(), [&](int i, const double *, const double *F) { add(i, F); });
    return all;
  }
  for (int i : ambient.who()) {
    const double *row = memory->rows[i];
    double F[6] = {0.0}, s[6] = {0.0};
    ambient.slip(i, s);
    for (int d = 0; d < m; d++)
      F[d] = without_films ? ambient.resistance(i, d) * (s[d] + row[State::at(State::VPRIME, d)])
                           : row[State::at(State::FORCE, d)];
    add(i, F);
  }
  return all;
}

void Hydrodynamics::pressure_gradient(double *gradient)
{
  std::fill_n(gradient, 3, 0.0);
  const sd_slab_walls walls = settings.scene.boundary.slab_walls();
  if (!walls.no_flux) return;
  std::vector<double> eta, x, a, F;
  const std::vector<double> rows = on_fluid(&eta);
  const size_t n = eta.size();
  for (size_t k = 0; k < n; k++) {
    const double *row = &rows[10 * k];
    x.insert(x.end(), row, row + 3);
    a.push_back(row[3]);
    for (int d = 0; d < 3; d++) F.push_back(eta[k] * row[4 + d]);
  }
  sd_slab_add_pressure_gradient(&walls, domain->prd, (long) n, x.data(), a.data(), F.data(), gradient);
  MPI_Allreduce(MPI_IN_PLACE, gradient, 3, MPI_DOUBLE, MPI_SUM, world);
}

}    // namespace StokesDyn
