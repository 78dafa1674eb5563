#include "compute_sph_energy.h"

#include "fix_sph_settings.h"
#include "fix_sph_tension.h"
#include "fixes.h"
#include "pair_sph_artvisc_tenscorr.h"
#include "ranks.h"

#include "atom.h"
#include "domain.h"
#include "group.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixSphEnergy::FixSphEnergy(LAMMPS *lmp, int narg, char **arg) :
    SphFix(lmp, narg, arg), flow(COLUMNS)
{
  nevery = 1;
  restart_global = 1;
  dynamic_group_allow = 1;
  keep({&flow}, nullptr, false);
}

int FixSphEnergy::setmask()
{
  return FixConst::INITIAL_INTEGRATE | FixConst::END_OF_STEP | FixConst::POST_RUN;
}

sd_sph_members FixSphEnergy::group()
{
  pair = PairSph::prepared(voice);
  states = fixes_of<FixSphPressure>(lmp);
  gravities = fixes_of(lmp, "gravity");
  tensions = fixes_of<FixSphTension>(lmp);
  masses.resize(atom->nlocal + 1);
  for (int i = 0; i < atom->nlocal; i++) masses[i] = Sph::mass(lmp, i);
  const int *mask = atom->mask;
  if (pair->has_ends()) {
    masks.assign(atom->nlocal + 1, 0);
    for (int i = 0; i < atom->nlocal; i++) masks[i] = mask[i] & ~(pair->is_held(i) ? groupbit : 0);
    mask = masks.data();
  }
  return {atom->nlocal, mask, groupbit, masses.data(), Sph::numbers(atom->v)};
}

double FixSphEnergy::elastic_of(sd_sph_members g, const double *rho) const
{
  double sum = 0.0;
  for (const auto *fix : states) {
    g.members = groupbit | fix->groupbit;
    sd_sph_state of_forces = fix->state;
    of_forces.P0 -= pair->reference_pressure();
    sum += sd_sph_elastic_energy(&g, &of_forces, rho);
  }
  return sum;
}

/* sum m g.y over those whom fix gravity pulls; its vector is the one of this step. */
double FixSphEnergy::along_gravity(sd_sph_members g, const double *y) const
{
  double sum = 0.0;
  for (auto *fix : gravities) {
    int dim;
    g.members = groupbit | fix->groupbit;
    sum += sd_sph_along(&g, (const double *) fix->extract("gvec", dim), y);
  }
  return sum;
}

double FixSphEnergy::elastic()
{
  return sum_of_all(world, elastic_of(group(), atom->rho));
}

double FixSphEnergy::surface(const sd_sph_members &g) const
{
  double sum = 0.0;
  for (const auto *fix : tensions)
    if (fix->surface().has_rows(g.n)) sum += fix->tension() * sd_sph_sum(&g, fix->surface().areas().data());
  return sum;
}

/* Positions go on through the faces of a periodic box. */
std::vector<double> FixSphEnergy::places() const
{
  std::vector<double> x(3 * (size_t) atom->nlocal + 3);
  for (int i = 0; i < atom->nlocal; i++) domain->unmap(atom->x[i], atom->image[i], &x[3 * (size_t) i]);
  return x;
}

void FixSphEnergy::measure(double *out)
{
  const sd_sph_members members = group();
  double others;
  out[ON_GROUP] = sd_sph_power(&members, 4, pair->own_forces(), &out[ON_OTHERS]);
  out[RUBS] = sd_sph_power(&members, 4, pair->own_friction(), &others);
  out[RUBS] += others;
  out[PULLED] = 0.0;
  for (const auto *fix : tensions) out[PULLED] += sd_sph_power(&members, 3, fix->surface().forces(), &others);
  out[SHIFTED] = pair->shift() ? along_gravity(members, pair->shift()) : 0.0;
}

void FixSphEnergy::of_particles(const sd_sph_members &members, std::vector<double> &rows) const
{
  rows.assign(COLUMNS * (size_t) (atom->nlocal + 1), 0.0);
  const std::vector<double> x = places();
  for (size_t i = 0; i < (size_t) atom->nlocal; i++) {
    const sd_sph_members one = {1, members.mask + i, groupbit, members.m + i, members.v + 3 * i};
    double *row = &rows[COLUMNS * i], nobody;
    row[STORED] = elastic_of(one, atom->rho + i);
    row[ENERGY] = row[STORED] + sd_sph_kinetic_energy(&one) - along_gravity(one, &x[3 * i]);
    row[POWER] = sd_sph_power(&one, 4, pair->own_forces() + 4 * i, &nobody);
  }
}

/* Who stands in a layer is not pushed by forces. So a particle that has come into the flow in this
 * step got the second half of the step's push, and one that has left it, or is deleted, the first
 * half: these halves are in the trapezoids of end_of_step, and not in what the particle brings. */
void FixSphEnergy::look_at_ends(bool counts)
{
  if (!pair->has_ends()) return;
  const sd_sph_members members = group();
  std::vector<double> rows;
  of_particles(members, rows);
  double now[COLUMNS] = {}, gone[COLUMNS], come[COLUMNS] = {};
  std::copy_n(in_flow, (int) COLUMNS, gone);
  for (int i = 0; i < atom->nlocal; i++) {
    const bool was_there = flow.has(i);
    if (!(members.mask[i] & groupbit)) {
      if (was_there) flow.erase(i);
      continue;
    }
    const double *row = &rows[COLUMNS * (size_t) i];
    double *before = flow.writable(i);
    for (int c = 0; c < COLUMNS; c++) {
      now[c] += row[c];
      if (was_there)
        gone[c] -= before[c];
      else
        come[c] += row[c];
      before[c] = row[c];
    }
  }
  std::copy_n(now, (int) COLUMNS, in_flow);
  if (!counts) return;
  for (int c : {ENERGY, STORED}) brought[c] += come[c] - gone[c];
  brought[ENERGY] -= 0.5 * dt * (come[POWER] + gone[POWER]);
}

void FixSphEnergy::setup(int vflag)
{
  const double now = elastic();
  for (auto *fix : tensions) fix->setup(vflag);    // before its turn, if it comes later
  jumps += now - (has_run != 0.0 ? elastic_then : 0.0);
  has_run = 1.0;
  elastic_then = now;
  measure(power);
  look_at_ends(false);
}

/* fix dt/reset changes the step at the end of one, before or after this fix. */
void FixSphEnergy::initial_integrate(int /*vflag*/)
{
  dt = update->dt;
}

/* The leapfrog's v at full steps: F.v there, times dt, is all that v^2 / 2 gains in the two halves
 * around it, but for the first and last half step of a run. */
void FixSphEnergy::end_of_step()
{
  double now[POWERS];
  measure(now);
  for (int k = 0; k < POWERS; k++) {
    done[k] += 0.5 * dt * (power[k] + now[k]);
    power[k] = now[k];
  }
  look_at_ends(true);
}

void FixSphEnergy::post_run()
{
  elastic_then = elastic();
}

void FixSphEnergy::values(double *out)
{
  const sd_sph_members members = group();
  double mine[5 + POWERS] = {sd_sph_kinetic_energy(&members), -along_gravity(members, places().data()), brought[ENERGY],
                             brought[STORED], surface(members)},
         all[5 + POWERS];
  std::copy_n(done, (int) POWERS, mine + 5);
  MPI_Allreduce(mine, all, 5 + POWERS, MPI_DOUBLE, MPI_SUM, world);
  const double *work = all + 5;
  out[KINETIC] = all[0];
  out[POTENTIAL] = all[1];
  out[ELASTIC] = elastic();
  out[WORK] = -work[ON_OTHERS];
  out[BROUGHT] = all[2];
  out[SURFACE] = all[4];
  out[PULL] = work[PULLED];
  const double stored = has_run != 0.0 ? out[ELASTIC] - jumps - all[3] : 0.0;
  out[DISSIPATED] = out[WORK] - work[ON_GROUP] + work[SHIFTED] - stored;
  out[FRICTION] = -work[RUBS];
}

void FixSphEnergy::write_state(NamedState &)
{
  if (update->whichflag == 1) elastic_then = elastic();
}

std::vector<SavedNumbers> FixSphEnergy::saved()
{
  return {{"done", done, POWERS, true},
          {"brought", brought, 2, true},
          {"elastic", &elastic_then},
          {"jumps", &jumps},
          {"has_run", &has_run}};
}

// --- the compute ---------------------------------------------------------------------------------

ComputeSphEnergy::ComputeSphEnergy(LAMMPS *lmp, int narg, char **arg) :
    Compute(lmp, narg, arg), voice(lmp, "Compute sph/energy"),
    own_fix(voice, std::string(id) + "_SPH_ENERGY", FixSphEnergy::STYLE)
{
  Keywords(lmp, voice.command, words(narg, arg), 3).parse({});
  own_fix.make("", group->names[igroup]);
  scalar_flag = vector_flag = 1;
  extscalar = extvector = 1;
  size_vector = FixSphEnergy::VALUES;
  vector = of_moment;
}

ComputeSphEnergy::~ComputeSphEnergy()
{
  own_fix.take_away();
}

void ComputeSphEnergy::init()
{
  Sph::require_pair(voice);
}

void ComputeSphEnergy::compute_vector()
{
  invoked_vector = update->ntimestep;
  Fix *fix = own_fix.find();
  if (!fix) voice.fail("the fix " + own_fix.id + " has been deleted, but this compute needs it");
  static_cast<FixSphEnergy *>(fix)->values(vector);
}

double ComputeSphEnergy::compute_scalar()
{
  compute_vector();
  invoked_scalar = update->ntimestep;
  scalar = vector[FixSphEnergy::KINETIC] + vector[FixSphEnergy::POTENTIAL] +
      vector[FixSphEnergy::ELASTIC] + vector[FixSphEnergy::SURFACE];
  return scalar;
}
