/* Of hydrodynamics: what follows from the forces on the fluid, the stress and the flow that they make. */
#include "hydrodynamics.h"

#include "callback.h"

#include "atom.h"
#include "domain.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

using State = FixStokesDynamicsState;

void Hydrodynamics::stress(std::vector<double> &of_atoms)
{
  const bool films_stand = standing();
  stand_rows();
  if (settings.lubrication.on && !films_stand) place_films();
  const Points now = points_of_now();
  const size_t n = scene.size();
  std::vector<double> points(6 * n + 6, 0.0), films(6 * n + 6, 0.0), f(3 * n + 3);
  sd_multiblob_moments((int) n, shells.first_of_rows(), now.r.data(), now.l.data(), points.data());
  if (overdamped) {
    const double *of_noise = random.forces().empty() ? nullptr : random.forces().data();
    sd_bodies_bonds(&bodies.bodies, solver.exerted.data(), bodies.F.data(), of_noise, f.data());
    add_on_members(f, points.data());
  }
  for (size_t j = 0; j < random.moments_left.size(); j++) points[j] += random.moments_left[j];
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
  const size_t first = scene.lone();
  const int members = scene.size() - (int) first;
  if (members > 0) sd_multiblob_moments_at(members, &bodies.arms()[3 * first], &f[3 * first], S + 6 * first);
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

void FlowSources::reserve(size_t n)
{
  for (auto *numbers : {&x, &F, &T}) numbers->reserve(3 * n + 3);    // data() is a place even where there are none
  for (auto *numbers : {&a, &eta}) numbers->reserve(n + 1);
}

FlowSources Hydrodynamics::of_points_on_fluid()
{
  const Points now = points_of_now();
  const int *first = shells.first_of_rows();
  const double *w = scene.local().w;
  FlowSources all;
  all.reserve(first[scene.size()]);
  for (int i = 0; i < scene.size(); i++)
    for (size_t k = first[i]; k < (size_t) first[i + 1]; k++) {
      if (!(now.b[k] > 0.0)) continue;
      all.x.insert(all.x.end(), &now.x[3 * k], &now.x[3 * k] + 3);
      all.a.push_back(now.b[k]);
      for (int d = 0; d < 3; d++) all.F.push_back(w[i] * w[i] * now.l[3 * k + d]);
      all.eta.push_back(1.0 / (w[i] * w[i]));
    }
  all.T.resize(all.F.size());
  return all;
}

FlowSources Hydrodynamics::on_fluid()
{
  if (shells.on()) return of_points_on_fluid();
  const bool without_films = settings.lubrication.on && !overdamped;
  const int m = scene.width();
  FlowSources all;
  all.reserve(ambient.who().size());
  const auto add = [&](int i, const double *F) {
    const bool point = settings.scene.tensor == SD_TENSOR_OSEEN;
    const double eta = ambient.viscosity(i);
    all.x.insert(all.x.end(), atom->x[i], atom->x[i] + 3);
    all.a.push_back(point ? 0.0 : atom->radius[i]);
    for (int d = 0; d < 6; d++) (d < 3 ? all.F : all.T).push_back(d < m ? -F[d] / eta : 0.0);
    all.eta.push_back(eta);
  };
  if (overdamped && settings.rigid.each_alone()) {    // these are not kept
    clump_poses.find();
    clump_poses.velocities([&](int i, const double *, const double *F) { add(i, F); });
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
  FlowSources all = on_fluid();
  for (size_t j = 0; j < all.F.size(); j++) all.F[j] *= all.eta[j / 3];
  sd_slab_add_pressure_gradient(&walls, domain->prd, (long) all.a.size(), all.x.data(), all.a.data(), all.F.data(),
                                gradient);
  MPI_Allreduce(MPI_IN_PLACE, gradient, 3, MPI_DOUBLE, MPI_SUM, world);
}

}    // namespace StokesDyn
