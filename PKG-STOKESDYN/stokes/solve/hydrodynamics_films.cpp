/* Of hydrodynamics: films between close spheres whose velocities are known, and the rows that stand for
 * these in a step without a solve. */
#include "hydrodynamics.h"

#include "atom.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

using State = FixStokesDynamicsState;

// Steps from one look at the limit that lubrication sets to the next: each costs 30 sparse
// products.
static const int LOOK_AT_FILMS = 1000;

/* Of the films where they stand, as the spheres move. */
void Hydrodynamics::find_films_power()
{
  films_power.clear();
  if (!ambient.varies()) return;
  std::vector<double> power(scene.size() + 1);
  sd_lubrication_strain_power(lubrication.matrix(), films_v.data(), power.data());
  films_power.assign(atom->nlocal + 1, 0.0);
  scene.to_atoms(1, power.data(), [this](int i, const double *p) { films_power[i] = *p; });
}

void Hydrodynamics::keep_forces()
{
  films_power.clear();
  if (!settings.lubrication.on || !ambient.varies()) return;
  stand_rows();
  place_films();
  find_films_power();
}

/* Where nothing was solved in this step */
void Hydrodynamics::stand_rows()
{
  if (standing()) return;
  if (settings.rigid.on) clump_poses.find();
  stand();
}

/* As the spheres move now, by rows of the scene */
void Hydrodynamics::read_motion()
{
  films_v = scene.rows(6, [this](int i, double *out) {
    std::copy_n(atom->v[i], 3, out);
    std::copy_n(atom->omega[i], 3, out + 3);
  });
  scene.drift(films_v.data(), 6, 1.0);
}

/* Where the spheres stand and as they move now */
void Hydrodynamics::place_films()
{
  if (!standing()) stand();
  read_motion();
  lubrication.place(scene, &ambient);
}

void Hydrodynamics::lubricate()
{
  place_films();
  std::vector<double> by_films(films_v.size());
  lubrication.forces(films_v.data(), by_films.data());
  find_films_power();
  if (update->setupflag || update->ntimestep % LOOK_AT_FILMS == 0)
    guard.look_at_films(*lubrication.matrix(), scene);
  scene.to_atoms(6, by_films.data(), [this](int i, const double *F) {
    double *row = memory->rows.row(i);
    for (int d = 0; d < 6; d++) row[State::at(State::FORCE, d)] += F[d];
  });
}

}    // namespace StokesDyn
