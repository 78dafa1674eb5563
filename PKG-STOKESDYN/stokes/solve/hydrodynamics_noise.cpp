/* Of hydrodynamics: a step with noise and the drift of the mobility, by one solve (sd_bodies_noise.h,
 * sd_drifter.h). Atoms stand where the fix has put them, in this order:
 *
 *   draw()                x                      random slip y and forces of films; half steps v' and v''
 *   stress_of_noise()     x                      for whoever wants that
 *   difference()          x + e W, x - e W       where the mean of one solve lacks some of the drift
 *   films()               x + dt/2 v''
 *   velocities()          x + dt/2 v'            one solve: M' here, L there
 */
#include "hydrodynamics.h"

#include "atom.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* The bodies where they stand */
void Hydrodynamics::assemble(BodyScene::Films films)
{
  clump_poses.find();
  place();
  bodies.place();
  bodies.assemble(films);
}

void Hydrodynamics::draw(const Given &known, const SolveNoise::Draw &draw)
{
  given = known;
  assemble(BodyScene::NOISY_FILMS);
  random.draw(draw);
}

void Hydrodynamics::stress_of_noise(double tolerance, std::vector<double> &of_atoms)
{
  sd_solve_report report = {};
  random.push_alone();
  const double loosest = std::max(settings.tolerance, tolerance);
  account_for(solver.run({Guess::NOISY_MOTIONS, loosest, settings.max_iter}, report), report);
  stress(of_atoms);
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
  random.difference(sign);
  if (shells.on()) add_moments_left(sign * random.part());
}

/* Of bodies that turn the mean of first moments Q^T l lacks kT sum_k (d_k Q)^T A_k, as slip and load do. */
void Hydrodynamics::add_moments_left(double part)
{
  const Points now = points_that_stand();
  const std::vector<double> &l = random.forces_of_moves();
  const size_t n = scene.size();
  const int *first = shells.first_of_rows();
  std::vector<double> S(6 * n + 6, 0.0), f(3 * n + 3, 0.0);
  sd_multiblob_moments((int) n, first, now.r.data(), l.data(), S.data());
  sd_multiblob_forces((int) n, first, l.data(), f.data());
  add_on_members(f, S.data());
  random.moments_left.resize(6 * n + 6, 0.0);
  for (size_t j = 0; j < S.size(); j++) random.moments_left[j] += part * S[j];
}

void Hydrodynamics::films(const Given &known)
{
  if (!settings.lubrication.on) return;
  given = known;
  clump_poses.find();
  stand();
  bodies.stand_films();
}

}    // namespace StokesDyn
