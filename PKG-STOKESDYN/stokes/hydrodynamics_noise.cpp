/* Of hydrodynamics: a step with noise and the drift of the mobility, by one solve (sd_bodies_noise.h,
 * sd_drifter.h). Atoms stand where the fix has put them, in this order:
 *
 *   draw()                x                      random slip y and forces of films; half steps v' and v''
 *   difference()          x + e W, x - e W       where the mean of one solve lacks some of the drift
 *   films()               x + dt/2 v''
 *   velocities()          x + dt/2 v'            one solve: M' here, L there
 */
#include "hydrodynamics.h"

#include "callback.h"

#include "atom.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* The bodies where they stand, but for films */
void Hydrodynamics::assemble()
{
  poses.find();
  place();
  bodies.place(width());
  bodies.assemble();
}

void Hydrodynamics::draw(const Given &known, const Solve::Draw &draw)
{
  solvers = ambient.who();
  given = known;
  bodies.begin_films();
  assemble();
  if (settings.lubrication.on) {
    lubrication.place(scene, ambient, true);
    solver.tie_films();
  }
  solver.draw(draw);
}

/* V [6 bodies] of lone spheres and of clumps */
Moves Hydrodynamics::moves_of(const std::vector<double> &V) const
{
  const size_t first = bodies.first_clump();
  Moves all;
  all.atoms.assign(6 * (size_t) atom->nlocal + 6, 0.0);
  std::vector<double> rows(6 * (size_t) scene.size() + 6);
  std::copy_n(V.begin(), 6 * first, rows.begin());
  scene.to_atoms(6, rows.data(), [&](int i, const double *row) {
    std::copy_n(row, 6, &all.atoms[6 * (size_t) i]);
  });
  all.clumps.assign(V.begin() + 6 * first, V.end());
  return all;
}

void Hydrodynamics::difference(const Given &known, double sign)
{
  given = known;
  assemble();
  solver.difference(sign);
}

void Hydrodynamics::films(const Given &known)
{
  if (!settings.lubrication.on) return;
  given = known;
  poses.find();
  scene.stand(solvers, ambient);
  scene.turn_shells();
  bodies.stand_films();
  lubrication.place(scene, ambient);
}

}    // namespace StokesDyn
