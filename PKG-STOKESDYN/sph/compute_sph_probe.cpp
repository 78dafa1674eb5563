#include "compute_sph_probe.h"

#include "fix_sph_settings.h"
#include "fixes.h"
#include "pair_sph_artvisc_tenscorr.h"
#include "ranks.h"
#include "sd_lattice.h"
#include "sd_sph_probe.h"

#include "atom.h"
#include "domain.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

ComputeSphProbe::ComputeSphProbe(LAMMPS *lmp, int narg, char **arg) :
    Compute(lmp, narg, arg), voice(lmp, "Compute sph/probe")
{
  Sph::require_scene(voice);
  Keywords in(lmp, voice.command, words(narg, arg), 3);
  while (in.more()) {
    Probe probe = {-1, {0.0, 0.0, 0.0}};
    if (in.positional("probe").choice({"pressure", "height"}) == 1)
      probe.axis = (int) in.positional("axis of a height").choice({"x", "y", "z"});
    for (double &x : probe.x) x = in.positional("point of a probe").number();
    probes.push_back(probe);
  }
  in.require(!probes.empty(), "there is no probe: give pressure X Y Z or height AXIS X Y Z");
  vector_flag = 1;
  size_vector = (int) probes.size();
  extvector = 0;
  values.assign(probes.size(), 0.0);
  vector = values.data();
}

void ComputeSphProbe::init()
{
  pair = PairSph::of(voice);
}

double ComputeSphProbe::volume(int i) const
{
  return pair->volume_of(i);
}

template <class Use> void ComputeSphProbe::each_image(const Probe &probe, int i, const Use &use) const
{
  const double reach = 2.0 * pair->smoothing_length(atom->type[i]);
  const double *h = domain->h;
  double d[3];
  int repeats[3], more[3];    // periods to each side; a tilted box is narrower than its edges are long
  for (int k = 0; k < 3; k++) {
    d[k] = atom->x[i][k] - probe.x[k];
    repeats[k] = domain->periodicity[k] && k != probe.axis && k < domain->dimension;
    const double width = domain->prd[k] * (domain->triclinic ? 0.5 : 1.0);
    more[k] = repeats[k] && reach > 0.5 * width ? (int) ceil(reach / width) : 0;
  }
  sd_closest_image(h, repeats, d);
  for (int a = -more[0]; a <= more[0]; a++)
    for (int b = -more[1]; b <= more[1]; b++)
      for (int c = -more[2]; c <= more[2]; c++) {
        const double image[3] = {d[0] + a * h[0] + b * h[5] + c * h[4], d[1] + b * h[1] + c * h[3],
                                 d[2] + c * h[2]};
        use(image);
      }
}

/* From the densities, as the force has it. */
double ComputeSphProbe::pressure(const Probe &probe) const
{
  double mine[2] = {0.0, 0.0}, sums[2];
  for (const auto *fix : fixes_of<FixSphPressure>(lmp))
    for (int i = 0; i < atom->nlocal; i++) {
      if (!(atom->mask[i] & groupbit) || !(atom->mask[i] & fix->groupbit)) continue;
      const double h = pair->smoothing_length(atom->type[i]);
      const sd_sph_spread of = {pair->kernel(), pair->dimension(), h, volume(i)};
      each_image(probe, i, [&](const double d[3]) {
        const double r = std::hypot(d[0], d[1], d[2]);
        if (r < 2.0 * h)
          sd_sph_probe_add(&of, r, sd_sph_pressure(&fix->state, atom->rho[i]), mine);
      });
    }
  MPI_Allreduce(mine, sums, 2, MPI_DOUBLE, MPI_SUM, world);
  return sd_sph_probe_pressure(sums);
}

/* Of this rank: particles whose support the line upwards from the probe crosses. One farther away than
 * 1e12 h, where an eighth of h is no longer told apart, has blown up. */
std::vector<ComputeSphProbe::Near> ComputeSphProbe::along(const Probe &probe) const
{
  std::vector<Near> near;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double h = pair->smoothing_length(atom->type[i]);
    each_image(probe, i, [&](const double d[3]) {
      const double z = d[probe.axis],
                   across = std::hypot(d[(probe.axis + 1) % 3], d[(probe.axis + 2) % 3]);
      if (across < 2.0 * h && z > -2.0 * h && z < 1e12 * h) near.push_back({i, across, z, h});
    });
  }
  return near;
}

/* Samples are an eighth of h apart, in stretches from the end of the highest support downwards. Heights
 * that no support reaches are left out, however many they are. */
double ComputeSphProbe::height(const Probe &probe) const
{
  constexpr double SAMPLES = 4096.0;
  const std::vector<Near> near = along(probe);
  double mine[2] = {0.0, -HUGE_VAL}, ends[2];    // the highest, - the smallest h
  for (const Near &at : near) {
    mine[0] = std::max(mine[0], at.z + 2.0 * at.h);
    mine[1] = std::max(mine[1], -at.h);
  }
  MPI_Allreduce(mine, ends, 2, MPI_DOUBLE, MPI_MAX, world);
  const double step = -ends[1] / 8.0;
  std::vector<double> part, fraction;
  for (double top = ends[0], above = HUGE_VAL; top > 0.0;) {
    const double last = std::min(ceil(top / step) + 1.0, above),
                 first = std::max(0.0, last - SAMPLES + 1.0);
    const sd_sph_stretch at = {first, step, (int) (last - first) + 1};
    part.assign(at.count, 0.0);
    fraction.resize(at.count);
    for (const Near &p : near) {
      const sd_sph_spread of = {pair->kernel(), pair->dimension(), p.h, volume(p.i)};
      sd_sph_gauge_add(&of, p.across, p.z, &at, part.data());
    }
    MPI_Allreduce(part.data(), fraction.data(), at.count, MPI_DOUBLE, MPI_SUM, world);
    const double found = sd_sph_gauge_height(&at, fraction.data());
    if (found > 0.0 || first == 0.0) return found;
    double next = 0.0;
    for (const Near &p : near)
      if (p.z - 2.0 * p.h < first * step)
        next = std::max(next, std::min(p.z + 2.0 * p.h, first * step));
    top = largest_of_all(world, next);
    above = first;
  }
  return 0.0;
}

void ComputeSphProbe::compute_vector()
{
  pair = PairSph::prepared(voice);
  invoked_vector = update->ntimestep;
  for (size_t k = 0; k < probes.size(); k++)
    vector[k] = probes[k].axis < 0 ? pressure(probes[k]) : height(probes[k]);
}

// --- the free surface ---------------------------------------------------------------------------

ComputeSphSurface::ComputeSphSurface(LAMMPS *lmp, int narg, char **arg) :
    Compute(lmp, narg, arg), voice(lmp, "Compute sph/surface/atom")
{
  Sph::require_scene(voice);
  Keywords(lmp, voice.command, words(narg, arg), 3).parse({});
  peratom_flag = 1;
  size_peratom_cols = 2;
}

void ComputeSphSurface::init()
{
  pair = PairSph::of(voice);
}

void ComputeSphSurface::compute_peratom()
{
  pair = PairSph::prepared(voice);
  invoked_peratom = update->ntimestep;
  if (!pair->moments(moments))
    voice.fail("there is no neighbour list yet of these atoms; use it in a run, or after 'run 0'");
  values.assign(2 * (size_t) (atom->nlocal + 1), 0.0);
  rows.resize(atom->nlocal + 1);
  for (int i = 0; i < atom->nlocal; i++) {
    double *row = rows[i] = &values[2 * (size_t) i];
    if (!(atom->mask[i] & groupbit)) continue;
    row[0] = sd_sph_least_eigenvalue(pair->dimension(), &moments[6 * (size_t) i]);
    row[1] = row[0] < SD_SPH_SURFACE;
  }
  array_atom = rows.data();
}

double ComputeSphSurface::memory_usage()
{
  return sizeof(double) * (double) (moments.capacity() + values.capacity() + rows.capacity());
}
