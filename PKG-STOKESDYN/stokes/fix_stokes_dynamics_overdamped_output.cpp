/* Of fix stokes_dynamics/overdamped: what it reports, and its restart files. */
#include "fix_stokes_dynamics_overdamped.h"

#include "keywords.h"

#include "sd_linear.h"
#include "sd_neighbor.h"

#include "atom.h"
#include "force.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

double FixStokesDynamicsOverdamped::compute_scalar()
{
  hydrodynamics();    // an error if there is none
  return sum_of_all(world, within_run() ? dissipation() : left.dissipation);
}

/* Of this rank: power that its spheres lose to the fluid */
double FixStokesDynamicsOverdamped::dissipation() const
{
  const Hydrodynamics &hydro = hydrodynamics();
  double mine = 0.0, s[6] = {0.0};
  for (int i : hydro.ambient.who()) {
    hydro.ambient.slip(i, s);
    mine += sd_dot(s + 3, output[i] + 6) - sd_dot(output[i], output[i] + 3) + hydro.strain_power(i);
  }
  return mine;
}

/* While atoms have the indices of the last step: commands between two runs give them others. */
void FixStokesDynamicsOverdamped::note_left()
{
  left = {dissipation(), fastest()};
}

void FixStokesDynamicsOverdamped::post_run()
{
  causes.note(hydrodynamics());
  note_left();
}

double FixStokesDynamicsOverdamped::compute_vector(int k)
{
  hydrodynamics();    // an error if there is none
  const FixStokesDynamicsState *memory = FixStokesDynamicsState::find(lmp);
  if (!memory) return 0.0;
  const std::function<double()> values[] = {[&] { return fastest_of_all(); },
                                            [&] { return largest_of_all(world, error_figure()); },
                                            [&] { return sqrt(largest_of_all(world, steps.farthest())); },
                                            [&] { return memory->global.iterations; },
                                            [&] { return memory->global.residual; },
                                            [&] { return memory->global.solves; },
                                            [&] { return memory->global.unconverged; },
                                            [&] { return smallest_gap(); },
                                            [&] { return update->dt; },
                                            [&] { return (double) noise.report().products; },
                                            [&] { return noise.report().error; },
                                            [&] { return drives.count_overloaded(); },
                                            [&] { return pressure_gradient(0); },
                                            [&] { return pressure_gradient(1); },
                                            [&] { return pressure_gradient(2); }};
  return values[k]();
}

/* In units of pressure over length, which in units real and metal is not force over volume */
double FixStokesDynamicsOverdamped::pressure_gradient(int d) const
{
  Hydrodynamics &hydro = hydrodynamics();
  double gradient[3] = {0.0};
  if (hydro.computed_in((double) update->ntimestep)) hydro.pressure_gradient(gradient);
  return force->nktv2p * gradient[d];
}

double FixStokesDynamicsOverdamped::fastest_of_all() const
{
  return largest_of_all(world, within_run() ? fastest() : left.fastest);
}

/* Of this rank, by the velocity of the fluid and that beyond it: nobody else writes to those. */
double FixStokesDynamicsOverdamped::fastest() const
{
  const Ambient &ambient = hydrodynamics().ambient;
  double mine = 0.0, v[3];
  for (int i : ambient.who()) {
    for (int d = 0; d < 3; d++) v[d] = output[i][d] + ambient.velocity(i)[d];
    mine = std::max(mine, sd_dot(v, v));
  }
  return sqrt(mine);
}

/* Largest |v - v_old| / a of this rank, where velocities have just been found */
double FixStokesDynamicsOverdamped::change_of_velocities() const
{
  const Hydrodynamics &hydro = hydrodynamics();
  const ClumpPoses &poses = hydro.poses();
  double most = 0.0, old[6];    // a square
  for (int i : poses.lone()) {
    if (!before.has(i)) continue;
    at_image(hydro, before[i], atom->x[i], old);
    for (int d = 0; d < 3; d++) old[d] -= lone_velocity[i][d];
    most = std::max(most, sd_dot(old, old) / (atom->radius[i] * atom->radius[i]));
  }
  for (const ClumpPoses::Clump &clump : poses.clumps()) {
    const ClumpShape &is = poses.shape(clump);
    const int first = poses.own_clump(clump).atom;
    double now_V[6], change[6];    // in the axes of the shape
    if (!before.has(first)) continue;
    tracked_velocity(clump, is, now_V);
    at_image(hydro, before[first], clump.pose + 9, old);
    for (int d = 0; d < 6; d++) old[d] = now_V[d] - old[d];
    for (int half : {0, 3}) sd_multiply3t(clump.pose, old + half, change + half);
    most = sd_shape_fastest(&is.shape, tracked(is), change, change + 3, most);
  }
  return sqrt(most);
}

/* Largest dt |v - v_old| / (2 a) of this rank: what Euler's step would be off by */
double FixStokesDynamicsOverdamped::error_figure() const
{
  return 0.5 * update->dt * velocity_change;
}

/* Between spheres whose centres are within four times the largest radius, where they are now: also between two
 * runs, when atoms have come, gone, or other indices than in the last step */
double FixStokesDynamicsOverdamped::smallest_gap() const
{
  const bool bound = hydrodynamics().settings.rigid.on && atom->molecule_flag;
  std::vector<double> x, a, bodies;
  double mine = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit) || !output.has(i)) continue;
    x.insert(x.end(), atom->x[i], atom->x[i] + 3);
    a.push_back(atom->radius[i]);
    bodies.push_back(ubuf(bound ? (int64_t) atom->molecule[i] : (int64_t) 0).d);
    mine = std::max(mine, atom->radius[i]);
  }
  const int n = (int) a.size();
  const double largest = largest_of_all(world, mine);
  if (largest == 0.0) return INFINITY;
  const double reach = 4.0 * largest;
  const Lattice lattice = Lattice::of(domain);
  Halo halo(world);
  if (!halo.find(lattice, reach, x))
    voice.fail_one("the smallest gap: the largest radius, " + text(largest) + ", reaches more than "
                   "1000 images of each sphere and 1e7 in all; is it in other units?");
  halo.extend(lattice.h, x, {&a, &bodies});
  std::vector<int64_t> body;
  for (double bits : bodies) body.push_back(ubuf(bits).i);
  double gap = INFINITY;
  if (n > 0 && sd_smallest_gap(x.data(), a.data(), body.data(), n, a.size(), reach, &gap) != SD_OK)
    voice.fail_one("out of memory for the smallest gap");
  return smallest_of_all(world, gap);
}

double FixStokesDynamicsOverdamped::ideal_pressure() const
{
  const ClumpPoses &poses = hydrodynamics().poses();
  double count = 0.0;
  for (int i : poses.lone()) count += !drives.stays(i);
  for (const ClumpPoses::Clump &clump : poses.clumps()) count += clump.known == SD_BODY_FREE;
  return noise.on() ? count * noise.energy() : 0.0;
}

// --- restart -------------------------------------------------------------------------------------------------

void FixStokesDynamicsOverdamped::write_state(NamedState &)
{
  if (causes.due) causes.note(hydrodynamics());
}

std::vector<SavedNumbers> FixStokesDynamicsOverdamped::saved()
{
  return {{"step", &last.step},
          {"dt", &last.dt},
          {"next_dt", &last.next_dt},
          {"atoms", &last.atoms},
          {"causes", causes.prints, Causes::ALL}};
}
