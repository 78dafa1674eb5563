/* Of pair_style sph/artVisc/tensCorr: a run and its steps. */
#include "pair_sph_artvisc_tenscorr.h"

#include "compute_sph_energy.h"
#include "fix_nve_sph.h"
#include "fix_sph_grains.h"
#include "fix_sph_settings.h"
#include "fix_sph_shift.h"
#include "fix_sph_tension.h"
#include "fix_wall_sph.h"
#include "fixes.h"
#include "lammps_compat.h"
#include "neighbours_sph.h"
#include "ranks.h"
#include "sd_sph_probe.h"
#include "sd_sph_step.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "force.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

void PairSph::init_style()
{
  Sph::require_scene(voice);
  if (update->whichflag == 2)
    voice.fail("cannot be minimised: it has no energy; define the pair styles without it meanwhile "
               "('pair_style none' if there are no others)");
  if (strncmp(update->integrate_style, "respa", 5) == 0)
    voice.fail("cannot be used with run_style respa");
  if (force->pair_match(STYLE, 1) != this)
    voice.fail("may appear only once in a hybrid pair style");
  if (atom->tag_enable == 0) voice.fail("requires atom IDs");
  single_enable = force->pair != this;    // alone it would say that there are no forces
  roles.find();
  rho0 = roles.only_rest_density();
  choose_scheme();
  roles.remember();
  check_stiffness(*this, roles);
  roles.check_groups();
  roles.check_openings();

  forces.begin(!fixes_of(lmp, FixSphEnergy::STYLE).empty());
  needs_velocity = model.artvisc || model.friction || roles.continuity;
  // As comm_modify vel yes: each pair must see the same velocities on both sides.
  if (needs_velocity && !comm->ghost_velocity) comm->ghost_velocity = asked_for_velocities = 1;
  if (neighbor->skin <= 0.0)
    voice.fail("command neighbor: a skin of 0 is too small; a tenth of h is usual");
  if (neighbor->build_once || (!neighbor->dist_check && std::max(neighbor->every, neighbor->delay) > 1))
    voice.warn(
        "with neigh_modify once yes or check no, LAMMPS does not notice when the neighbour list is outdated");
  dangerous_builds = neighbor->ndanger;
  Compat::request_half_list(neighbor, this, instance_me, !rows.shared);
  begun = false;
  if (roles.continuity) roles.continuity->computed = -1;
}

/* What the options make of rate and force, and the fixes that this needs */
void PairSph::choose_scheme()
{
  model.delta = roles.continuity && roles.is_leapfrog() ? roles.continuity->delta : 0.0;
  const SphScheme scheme = StokesDyn::choose_scheme(*this, roles);
  model.scheme = scheme.scheme;
  middle.begin(scheme);
  friction_fix.take_away();
  if (implicit) friction_fix.make();
  roles.state = FixSphShift::provide(shift_fix, shifts, corrects || pliant);
  rows.shared = sd_sph_level_of(&model) == SD_SPH_RATE;
}

/* Here and not in init_style, since the domain learns of fix deform after that, and pair styles below a
 * hybrid of their types. */
void PairSph::setup()
{
  begun = true;
  roles.check_layers();
  neighbourhood.look(voice, sph_neighbours, (roles.continuity ? CONTINUITY : 0u) | (roles.grains ? GRAINS : 0u) |
                    (fixes_of(lmp, FixSphTension::STYLE).empty() ? 0u : TENSION), [this](int i) {
    if (!used(atom->type[i]))
      return roles.grains && (atom->mask[i] & roles.grains->groupbit) ? (unsigned) GRAIN : 0u;
    return (unsigned) (roles.is_wall(i) ? WALL : WATER);
  });
  if (needs_velocity && domain->deform_vremap && !fixes_of(lmp, "sph").empty())
    voice.fail("fix deform with remap v: fix sph extrapolates velocities too early, before LAMMPS "
               "adds the jump at the faces that glide; use fix nve/sph");
  if (domain->deform_vremap && finds_surface())
    voice.fail("fix deform with remap v: the momentum that shift carries would differ on the two "
               "sides of a face that glides; use correction yes");
}

// --- a step -------------------------------------------------------------------------------------

void PairSph::compute(int eflag, int vflag)
{
  require_prepared();
  if (roles.continuity && !begun)
    voice.fail("cannot be used with rerun, dynamical_matrix and third_order, nor with 'pre no' after write_data, "
               "write_restart and the like: densities of fix sph/density/continuity go on in runs that are prepared "
               "for, and a dump file has none; use pair_style zero for what needs no forces of the water, or restart "
               "files, and leave out 'pre no'");
  if (roles.continuity) refuse_again();
  ev_init(eflag, vflag);
  listed = {atom->nlocal, atom->nghost};
  check_list();
  if (roles.continuity && !moved_box.follow(atom->rho))
    voice.warn("the box has changed since the last run, but the particles have not moved with it: "
               "their densities stay as they are; if these are wrong, use set ... sph/rho");
  rows.look_at_densities(atom->nlocal);
  if (roles.grains) roles.grains->find_fractions();
  rows.prepare(list, cutsq);
  if (update->setupflag) checks.look_at_beginning();
  if (needs_velocity) estimate_velocities();
  if (roles.is_leapfrog() && update->setupflag && roles.has_walls()) settle_walls();

  middle.find_densities();
  rows.find_pressures();
  if (roles.has_walls()) walls.follow();
  const bool pairwise = evflag && vflag_either;
  forces.compute(pairwise);
  if (roles.wall) roles.wall->bears(roles.load_on_walls(forces.given(), forces.who_gets()));
  if (pairwise) tally();
  if (update->setupflag && roles.wall) checks.look_at_bodies();

  for (auto *fix : roles.pressures) fix->output(rows.P.data());
  if (roles.continuity) roles.continuity->output(atom->drho);
}

/* For compute pair/local and its like below a hybrid, which ask all styles of it: the forces of this one
 * need more than a pair, so its share is 0. Alone it has no answer: computes see that (init_style),
 * pair_write asks before. */
double PairSph::single(int, int, int, int, double, double, double, double &fforce)
{
  if (force->pair == this)
    voice.fail("forces depend on more than a distance, on densities and velocities: pair_write has nothing to write");
  fforce = 0.0;
  return 0.0;
}

/* Each force advances the densities, or adds to their rates. */
void PairSph::refuse_again()
{
  auto &computed = roles.continuity->computed;
  if (computed == update->ntimestep && update->nsteps > 0)
    voice.at_step().fail("another command asks for the forces of this step again, as fix numdiff, gcmc or atom/swap "
                         "and compute born/matrix or fep do, and densities would go on twice: take it out");
  computed = update->ntimestep;
}

/* A list that could not be rebuilt in time misses pairs. LAMMPS counts that as a dangerous build
 * and goes on. */
void PairSph::check_list()
{
  if (update->setupflag) {
    dangerous_builds = neighbor->ndanger;
    return;
  }
  if (neighbor->ago != 0 || neighbor->ndanger == dangerous_builds) return;
  dangerous_builds = neighbor->ndanger;
  if (std::max(neighbor->every, neighbor->delay) <= 1) return;
  voice.at_step().fail("particles moved more than half the neighbour skin " + text(neighbor->skin) +
                       " before the neighbour list could be rebuilt; use neigh_modify delay 0 every 1, "
                       "or a larger skin");
}

/* vest is the velocity at the time of the force. The integrators set it before the force; who has
 * none of them moves with v. That of LAMMPS's fix sph is v at the start of a run, and its ghosts
 * have not heard of that yet. */
void PairSph::estimate_velocities()
{
  const int n = rows.particles.n;
  const int bits = update->setupflag && roles.integrators.empty() ? 0 : roles.with_own_vest();
  for (int i = 0; i < n; i++)
    if (!(atom->mask[i] & bits)) memcpy(atom->vest[i], atom->v[i], 3 * sizeof(double));
}

/* At the start of a run, before any rate sees the densities that walls have in the input. Velocities are
 * then again those of estimate_velocities(). */
void PairSph::settle_walls()
{
  rows.pack_places();
  rows.find_pressures();
  walls.follow();
  if (needs_velocity) estimate_velocities();
}

/* For the virial. With correction F is not opposite on the two: each has its half of F d. */
void PairSph::tally()
{
  const double *F = forces.of_pairs();
  if (corrects) {
    for (int i = 0; i < atom->nlocal; i++)
      for (int m = 0; m < rows.near.count[i]; m++, F += 3) {
        const int j = rows.near.neighbor[i][m];
        if (j == rows.particles.n) continue;
        const double *xi = atom->x[i], *xj = atom->x[j];
        ev_tally_xyz_full(i, 0.0, 0.0, F[0], F[1], F[2], xi[0] - xj[0], xi[1] - xj[1],
                          xi[2] - xj[2]);
      }
    return;
  }
  for (int k = 0; k < rows.pairs.n; k++) {
    const int i = rows.pairs.first[k];
    for (int m = 0; m < rows.pairs.count[i]; m++, F += 3) {
      const int j = rows.pairs.neighbor[i][m] & rows.pairs.mask;
      const double *xi = atom->x[i], *xj = atom->x[j];
      ev_tally_xyz(i, j, atom->nlocal, rows.shared && force->newton_pair, 0.0, 0.0, F[0], F[1], F[2],
                   xi[0] - xj[0], xi[1] - xj[1], xi[2] - xj[2]);
    }
  }
}

void PairSph::rub_implicitly(double tau)
{
  forces.rub_implicitly(tau);
  if (roles.wall) roles.wall->bears_more(roles.load_on_walls(forces.given(), atom->nlocal));
}

// --- for other fixes ----------------------------------------------------------------------------

double PairSph::one_smoothing_length(const Voice &of) const
{
  double least = HUGE_VAL, most = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!is_particle(i)) continue;
    least = std::min(least, smoothing_length(atom->type[i]));
    most = std::max(most, smoothing_length(atom->type[i]));
  }
  least = smallest_of_all(world, least);
  most = largest_of_all(world, most);
  if (most > least * (1.0 + 1e-9))
    of.fail("types of pair_style sph/artVisc/tensCorr have smoothing lengths from " + text(least) + " to " +
            text(most) + ": it needs one h for all of them");
  return most > 0.0 ? least : 0.0;
}

void PairSph::largest_approach(std::vector<double> &largest)
{
  rows.prepare(list, cutsq);
  rows.pack_places();
  sd_sph_pack_v(rows.particles.n, Sph::numbers(atom->vest), atom->rho, rows.v4.data());
  largest.assign(rows.particles.n + 1, 0.0);
  sd_sph_approach(&rows.model, &rows.pairs, &rows.particles, largest.data());
  reverse(largest.data(), 1, true);
}

bool PairSph::moments(std::vector<double> &M)
{
  int current = listed == std::make_pair(atom->nlocal, atom->nghost);
  MPI_Allreduce(MPI_IN_PLACE, &current, 1, MPI_INT, MPI_MIN, world);
  if (!current) return false;
  rows.prepare(list, cutsq);
  rows.pack_volumes();
  M.assign(6 * (size_t) (rows.particles.n + 1), 0.0);
  sd_sph_moments(&rows.model, &rows.pairs, &rows.particles, M.data());
  reverse(M.data(), 6);
  return true;
}
