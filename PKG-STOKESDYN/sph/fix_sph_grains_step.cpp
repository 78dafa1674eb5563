/* Of fix sph/grains: a step. The volume fraction, the flux of water and grains, stresses and drag. */
#include "fix_sph_grains.h"

#include "pair_sph_artvisc_tenscorr.h"
#include "ranks.h"
#include "sd_sphere.h"

#include "atom.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

// --- the volume fraction -------------------------------------------------------------------------

/* phi as the last step has left it. */
void FixSphGrains::recall()
{
  const int n = atom->nlocal + atom->nghost;
  phi.assign(n + 1, 0.0);
  for (int i = 0; i < atom->nlocal; i++) phi[i] = rows[i][0];
  forward(phi.data(), 1);
}

void FixSphGrains::find_fractions()
{
  recall();
  around.follow(*pair, groupbit, law.h);
  weigh();
  const bool displaces = fills && filled == 0.0, goes_on = update->setupflag && resumes();
  if (!goes_on) sum_fractions();
  if (update->setupflag && !goes_on && !displaces) {    // the volumes had the phi of another scene, or none
    weigh();
    sum_fractions();
  }
  mean_phi = around.mean_of(phi.data(), 1);
  check_fractions();
  if (update->setupflag) displace();
}

void FixSphGrains::sum_fractions()
{
  const sd_sph_around list = around.list();
  const sd_sph_grains of_grains = are_grains();
  std::vector<double> found(around.points.size() + 1, 0.0);
  sd_sph_grain_fractions(&list, &of_grains, volume.data(), found.data());
  std::vector<double> all = around.at_atoms(found, 1);
  reverse(all.data(), 1);
  for (int i = 0; i < atom->nlocal; i++)
    if (all[i] != 0.0 || rows.has(i)) *rows.writable(i) = all[i];
  recall();
}

/* What grains are, and the weights of the water around them. */
void FixSphGrains::weigh()
{
  const size_t n = around.grains.size(), m = around.points.size();
  a.resize(n + 1);
  V.resize(n + 1);
  M.resize(n + 1);
  for (size_t j = 0; j < n; j++) {
    a[j] = atom->radius[around.grains[j]];
    V[j] = sd_sphere_volume(a[j]);
    M[j] = atom->mask[around.grains[j]] & free_bits & ~held_bits ? atom->rmass[around.grains[j]] : HUGE_VAL;
  }
  volume.resize(m + 1);
  sd_sph_grain_volumes((int) m, around.points.data(), atom->rmass, atom->rho, phi.data(), volume.data());
  wet.resize(n + 1);
  own.resize(n + 1);
  const sd_sph_around list = around.list();
  const sd_sph_points of_points = {around.places.data(), volume.data(), around.walls.data()};
  const sd_sph_grains of_grains = are_grains();
  sd_sph_grain_weights(law.kernel, law.h, &list, around.grain_places.data(), &of_points, wet.data());
  sd_sph_grain_shares(&list, &of_grains, volume.data(), own.data());
}

/* The volume of the particles stays, and so all that has been found with it. */
void FixSphGrains::displace()
{
  if (fills && filled == 0.0)
    sd_sph_grain_displace((int) around.points.size(), around.points.data(), phi.data(), atom->rmass);
  filled = 1.0;
}

std::vector<double> FixSphGrains::rows_of_grains(double **vectors) const
{
  std::vector<double> rows(3 * around.grains.size() + 1);
  for (size_t j = 0; j < around.grains.size(); j++) std::copy_n(vectors[around.grains[j]], 3, &rows[3 * j]);
  return rows;
}

const double *FixSphGrains::mixture(const double *v)
{
  const std::vector<double> velocities = rows_of_grains(atom->v);
  std::vector<double> there(3 * around.points.size() + 1, 0.0);
  const sd_sph_around list = around.list();
  const sd_sph_grains of_grains = are_grains();
  sd_sph_grain_flux(&list, &of_grains, volume.data(), velocities.data(), there.data());
  moved = around.at_atoms(there, 3);
  reverse(moved.data(), 3);
  forward(moved.data(), 3);
  sd_sph_grain_water_flux(atom->nlocal + atom->nghost, phi.data(), v, moved.data());
  return moved.data();
}

void FixSphGrains::divide_rates(const double *slope, const double *du, double *rate)
{
  sd_sph_grain_rates(atom->nlocal, phi.data(), slope, du, rate);
}

// --- a run that goes on ---------------------------------------------------------------------------

/* All that the force on a grain depends on beside the state of grains and water. */
std::vector<double> FixSphGrains::law_of_now() const
{
  return {(double) law.drag.law, (double) law.drag.hindrance, law.drag.fall, law.exponent, law.eta,
          law.h, (double) law.kernel, (double) own_flow, (double) pair->has_laplacian(), update->dt};
}

void FixSphGrains::setup_pre_exchange()
{
  same_forces = law_of_now() == law_of_end && end.still_stands(groupbit);
}

/* Then phi and the forces of its last step stand, which had velocities at half step. */
bool FixSphGrains::resumes() const
{
  return same_forces && pair->resumes();
}

void FixSphGrains::post_run()
{
  end.record(groupbit);
  law_of_end = law_of_now();
}

void FixSphGrains::write_state(NamedState &state)
{
  end.write(groupbit, state);
  if (update->whichflag == 1) law_of_end = law_of_now();
  state.put("law", law_of_end);
}

void FixSphGrains::read_state(const NamedState &state)
{
  end.read(state);
  law_of_end = state.get("law");
}

// --- a step --------------------------------------------------------------------------------------

void FixSphGrains::setup(int vflag)
{
  if (!resumes()) {
    post_force(vflag);
    return;
  }
  std::fill_n(total, 3, 0.0);
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++) {
      atom->f[i][d] += shown[i][1 + d];
      if (atom->mask[i] & groupbit) total[d] += shown[i][1 + d];
    }
}

void FixSphGrains::post_force(int /*vflag*/)
{
  for (int i = 0; i < atom->nlocal; i++)
    if (pair->is_particle(i)) shown.writable(i)[0] = phi[i];
  std::vector<double> F(3 * around.grains.size() + 1, 0.0), D = F;
  stresses(F);
  drags(F, D);
  std::fill_n(total, 3, 0.0);
  for (size_t j = 0; j < around.grains.size(); j++)
    for (int d = 0; d < 3; d++) {
      const double both = F[3 * j + d] + D[3 * j + d];
      shown.writable(around.grains[j])[1 + d] = both;
      atom->f[around.grains[j]][d] += both;
      total[d] += both;
    }
}

/* Of the force of SPH, by volume: water keeps 1 - phi of it. */
void FixSphGrains::stresses(std::vector<double> &F)
{
  const double *sph = pair->own_forces();
  std::vector<double> forces(3 * (size_t) (atom->nlocal + atom->nghost) + 1, 0.0);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!pair->is_particle(i)) continue;
    for (int d = 0; d < 3; d++) {
      forces[3 * (size_t) i + d] = sph[4 * (size_t) i + d];
      const double given = phi[i] * sph[4 * (size_t) i + d];
      shown.writable(i)[1 + d] = -given;
      atom->f[i][d] -= given;
    }
  }
  forward(forces.data(), 3);
  std::vector<double> on_water = around.at_points(forces.data(), 3);
  const sd_sph_around list = around.list();
  const sd_sph_grains of_grains = are_grains();
  sd_sph_grain_stresses(&list, &of_grains, (int) around.points.size(), volume.data(), on_water.data(), F.data());
}

/* Of the water at the places of grains, and of these */
FixSphGrains::Slip FixSphGrains::slip_of_now()
{
  return {around.mean_of(Sph::numbers(atom->v), 3), rows_of_grains(atom->v)};
}

/* That at the end of the step, which all forces but drag make: those of atoms, and the stresses F of grains */
FixSphGrains::Slip FixSphGrains::slip_without_drag(const std::vector<double> &F)
{
  const double dt = update->dt;    // at a setup as well: that force begins the first step
  const std::vector<double> on_grains = rows_of_grains(atom->f);
  std::vector<double> water(3 * (size_t) (atom->nlocal + atom->nghost) + 1);
  std::copy_n(Sph::numbers(atom->v), 3 * (size_t) atom->nlocal, water.data());
  sd_sph_grain_push(atom->nlocal, dt, Sph::numbers(atom->f), nullptr, atom->rmass, water.data());
  forward(water.data(), 3);
  Slip slip = {around.mean_of(water.data(), 3), rows_of_grains(atom->v)};
  sd_sph_grain_push((int) around.grains.size(), dt, on_grains.data(), F.data(), M.data(), slip.grains.data());
  return slip;
}

/* Force over slip of each grain, by the law at the slip of now */
std::vector<double> FixSphGrains::drag_factors()
{
  const int n = (int) around.grains.size();
  std::vector<double> k(n + 1), at_grains(n + 1);
  const std::vector<double> rho = around.mean_of(atom->rho, 1);
  sd_sph_grain_phi(n, mean_phi.data(), own.data(), at_grains.data());
  const sd_sph_grains of_grains = are_grains();
  const Slip now = slip_of_now();
  const sd_sph_slip slip = {now.water.data(), now.grains.data()};
  sd_sph_grain_drag(&law, n, &of_grains, &slip, rho.data(), at_grains.data(), k.data());
  check_bodies(k);
  for (int j = 0; j < n; j++) shown.writable(around.grains[j])[0] = at_grains[j];
  return k;
}

/* Drag D at the velocities of the end of the step, which it makes itself: all grains that slow a particle
 * slow it together. */
void FixSphGrains::drags(const std::vector<double> &F, std::vector<double> &D)
{
  const Slip without = slip_without_drag(F);
  const sd_sph_slip slip = {without.water.data(), without.grains.data()};
  const std::vector<double> k = drag_factors();
  const sd_sph_around list = around.list();
  std::vector<double> total_drag(around.points.size() + 1, 0.0);
  sd_sph_grain_load(&list, k.data(), total_drag.data());
  std::vector<double> slowed = around.at_atoms(total_drag, 1);
  reverse(slowed.data(), 1);
  for (int i = 0; i < atom->nlocal; i++)
    if (slowed[i] != 0.0) slowed[i] /= atom->rmass[i];
  forward(slowed.data(), 1);
  const std::vector<double> slowed_points = around.at_points(slowed.data(), 1);
  sd_sph_grain_drags(&list, update->dt, &slip, M.data(), k.data(), slowed_points.data(), D.data());
  give_back(D);
}

/* Drag on grains slows the water of all ranks. */
void FixSphGrains::give_back(const std::vector<double> &D)
{
  const sd_sph_around list = around.list();
  std::vector<double> mine(3 * around.points.size() + 1, 0.0);
  sd_sph_grain_reactions(&list, D.data(), mine.data());
  std::vector<double> all = around.at_atoms(mine, 3);
  reverse(all.data(), 3);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!pair->is_particle(i)) continue;
    for (int d = 0; d < 3; d++) {
      shown.writable(i)[1 + d] += all[3 * (size_t) i + d];
      atom->f[i][d] += all[3 * (size_t) i + d];
    }
  }
}

double FixSphGrains::compute_vector(int k)
{
  return k < 3 ? sum_of_all(world, total[k]) : largest_of_all(world, largest);
}
