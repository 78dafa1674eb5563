/* Of hydrodynamics: the forces on the fluid, for the flow that they make. */
#include "hydrodynamics.h"

#include "callback.h"

#include "atom.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

using State = FixStokesDynamicsState;
static const std::string COMMAND = StokesSettings::COMMAND;

/* Where no solve was needed in this step the rows of the scene may be those of another one. */
Hydrodynamics::Points Hydrodynamics::points_of_now()
{
  if (memory->points == 0 && !solved())
    fail(lmp,
         COMMAND + ": step " + std::to_string(update->ntimestep) +
             ": the forces of the points are not kept with warm_start no; use warm_start yes");
  stand_rows();
  const size_t n = scene.size(), points = n * shells.points();
  const sd_spheres s = scene.local();
  const sd_multiblob_spheres spheres = {s.x, s.a, shells.turns(), shells.masks(), (int) n};
  Points now;
  now.r.resize(3 * points + 3);
  now.x.resize(3 * points + 3);
  now.b.resize(points + 1);
  sd_multiblob_expand(&shells.model(), &spheres, now.r.data(), now.x.data(), now.b.data());
  if (solved())
    now.l = begin_with.l;
  else
    recall_points(now.l, 0.0);
  return now;
}

std::vector<OnFluid> Hydrodynamics::of_points_on_fluid()
{
  const Points now = points_of_now();
  const size_t P = shells.points();
  const double *w = scene.local().w;
  std::vector<OnFluid> all;
  for (size_t k = 0; k < scene.size() * P; k++) {
    if (!(now.b[k] > 0.0)) continue;
    const double over_eta = w[k / P] * w[k / P], *x = &now.x[3 * k];
    OnFluid row = {{x[0], x[1], x[2]}, now.b[k], {}, {}};
    for (int d = 0; d < 3; d++) row.F[d] = over_eta * now.l[3 * k + d];
    all.push_back(row);
  }
  return all;
}

/* F is what the mobility knows: without films, which act between two spheres and not on the fluid
 * far from them. */
std::vector<OnFluid> Hydrodynamics::on_fluid()
{
  if (shells.settings.on()) return of_points_on_fluid();
  const bool turns = rotation(), without_films = settings.lubrication.on && !overdamped;
  std::vector<OnFluid> all;
  const auto add = [&](int i, const double *F, const double *T) {
    const double over_eta = -1.0 / ambient.viscosity(i), *x = atom->x[i];
    OnFluid row = {{x[0], x[1], x[2]},
                   settings.scene.tensor == SD_TENSOR_OSEEN ? 0.0 : atom->radius[i], {}, {}};
    for (int d = 0; d < 3; d++) {
      row.F[d] = over_eta * F[d];
      if (turns) row.T[d] = over_eta * T[d];
    }
    all.push_back(row);
  };
  if (overdamped && settings.rigid.apart()) {    // these are not kept
    mobile.find();
    mobile.apart(width(), [&](int i, const double *, const double *F) { add(i, F, F + 3); });
    return all;
  }
  for (int i : ambient.who()) {
    const double *row = memory->rows[i];
    double F[6] = {0.0}, s[6] = {0.0};
    std::copy_n(row + State::FORCE, 3, F);
    if (turns) std::copy_n(row + State::TORQUE, 3, F + 3);
    if (without_films) {
      ambient.slip(i, s);
      for (int d = 0; d < 3; d++) {
        F[d] = ambient.drag(i) * (s[d] + row[State::VPRIME + d]);
        F[3 + d] = ambient.spin(i) * (s[3 + d] + row[State::WPRIME + d]);
      }
    }
    add(i, F, F + 3);
  }
  return all;
}

}    // namespace StokesDyn
