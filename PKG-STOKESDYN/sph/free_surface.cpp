#include "free_surface.h"

#include "pair_sph_artvisc_tenscorr.h"
#include "sd_sph_deep.h"

#include "atom.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

FreeSurface::FreeSurface(const Voice &voice, const SurfaceTension &how, AtomArray &shown, GhostExchange &ghosts) :
    Pointers(voice.lmp), voice(voice), how(how), shown(shown), ghosts(ghosts), drops(voice.lmp, ghosts)
{
}

void FreeSurface::pull(PairSph *of)
{
  pair = of;
  place();
  make_rows();
  find_normals();
  show(true);
  find_curvatures();
  show(false);
  find_forces();
  drops.keep_momentum(film, who_is_held(), F.data());
  double *f = Sph::numbers(atom->f);
  for (size_t k = 0; k < 3 * (size_t) atom->nlocal; k++) f[k] += F[k];
}

/* Where particles are, and who is near the surface: it may be in supports that are cut, and beside walls. Friction
 * sees the velocities of the time of the force. */
void FreeSurface::place()
{
  const int n = atom->nlocal + atom->nghost;
  const double *v = Sph::numbers(atom->vest);
  std::vector<double> V_of(atom->ntypes + 1, 0.0);
  for (int type = 1; type <= atom->ntypes; type++)
    if (pair->used(type)) V_of[type] = (atom->rmass ? 1.0 : atom->mass[type]) / how.rho0;
  x4.resize(4 * (size_t) (n + 1));
  v4.resize(4 * (size_t) (n + 1));
  sd_sph_pack_x(n, Sph::numbers(atom->x), nullptr, nullptr, 0.0, x4.data());
  sd_sph_pack_v(0, nullptr, nullptr, &v4[4 * (size_t) n]);
  for (int i = 0; i < n; i++) {
    const double V = V_of[atom->type[i]] * (atom->rmass ? atom->rmass[i] : 1.0);
    const bool is_whole = pair->is_whole(i);
    x4[4 * (size_t) i + 3] = is_whole ? -V : V;
    if (!is_whole || how.walls) std::copy_n(v + 3 * (size_t) i, 3, &v4[4 * (size_t) i]);
  }
  if (how.walls) {
    wall.resize(n + 1);
    for (int i = 0; i < n; i++) wall[i] = pair->is_of_wall(i);
    wall[n] = 0;
  }
  list = pair->neighbours_of_each();
  near.resize(atom->nlocal + 1);
  cells.resize(SD_SPH_DEEP_SCRATCH(n));
  const int close = sd_sph_find_near(how.surface.dimension, n, atom->nlocal, x4.data(), 2.0 * how.surface.h,
                                     cells.data(), near.data());
  film = {&how.surface, &list, n, x4.data(), how.walls ? wall.data() : nullptr, near.data(), close};
}

void FreeSurface::make_rows()
{
  const size_t nlocal = atom->nlocal, n = (size_t) film.all, close = (size_t) film.count;
  sums.resize(8 * nlocal + 4);
  whole.resize(4 * nlocal + 4);
  at_surface.assign(4 * (n + 1), 0.0);
  rows = {sums.data(), nullptr, whole.data(), at_surface.data(), nullptr};
  if (how.walls) {
    beside.resize(8 * nlocal + 4);
    at_wall.resize(8 * nlocal + 4);
    rows.beside = beside.data();
    rows.at_wall = at_wall.data();
  }
  who.resize(close + 1);
  count.resize(close + 1);
  neighbor.resize(close + 1);
  first.resize(close + 1);
  turns.resize(SD_SPH_SKIN_SUMS * close + 4);
  own.resize(2 * close + 2);
  const size_t entries = sd_sph_skin_size(&film);
  if (pool.size() < entries) pool.resize(entries + entries / 8);
  skin = {who.data(), neighbor.data(), count.data(), pool.data(), first.data(), nullptr, turns.data(), own.data(), 0};
  for (auto *each : {&kappa, &once}) each->assign(n + 1, 0.0);
  twice.resize(nlocal + 1);
  F.assign(3 * nlocal + 1, 0.0);
  area.assign(nlocal + 1, 0.0);
}

void FreeSurface::find_normals()
{
  sd_sph_film_sums(&film, &rows, &skin);
  if (how.walls) wet_walls();
  sd_sph_film_normals(&film, &rows);
  ghosts.forward(at_surface.data(), 4);
}

void FreeSurface::wet_walls()
{
  const size_t n = (size_t) film.all;
  if (update->setupflag) look_at_walls();
  wet.assign(n + 1, 0.0);
  sd_sph_film_wetness(&film, &rows, wet.data());
  ghosts.forward(wet.data(), 1);
  contact.assign(4 * (n + 1), 0.0);
  for (size_t i = 0; i < n; i++) {
    if (!wall[i]) continue;
    const auto found = how.contacts.find(atom->type[i]);
    const std::pair<double, double> angle = found == how.contacts.end() ? std::make_pair(0.0, 1.0) : found->second;
    const double row[4] = {wet[i], angle.first, angle.second, 1.0};
    std::copy_n(row, 4, &contact[4 * i]);
  }
  sd_sph_film_wet_walls(&film, contact.data(), &rows);
}

/* The wetness of a wall particle needs its neighbours in the wall, which inputs often exclude. */
void FreeSurface::look_at_walls() const
{
  for (int k = 0; k < film.count; k++) {
    const int i = near[k];
    const double *row = &sums[8 * (size_t) i], own = std::fabs(x4[4 * (size_t) i + 3]) * how.surface.W0;
    if (wall[i] && row[0] > 0.0 && row[4] < 1.001 * own)
      voice.fail_one("wall particle " + std::to_string(atom->tag[i]) +
                     " sees fluid and no other wall particle: how wet it is goes by both, so walls need two rows or "
                     "more, and no neigh_modify exclude between their particles");
  }
}

void FreeSurface::find_curvatures()
{
  const size_t weights = sd_sph_skin_weights(&film, &rows, &skin);
  if (weight.size() < weights) weight.resize(weights + weights / 8);
  skin.weight = weight.data();
  sd_sph_film_curvatures(&film, &rows, v4.data(), &skin, kappa.data());
  ghosts.forward(kappa.data(), 1);
  sd_sph_film_means(&skin, kappa.data(), once.data());
  ghosts.forward(once.data(), 1);
  sd_sph_film_means(&skin, once.data(), twice.data());
  sd_sph_film_sharpen(&film, &rows, &skin, kappa.data(), once.data(), twice.data());
  ghosts.forward(once.data(), 1);
  sd_sph_film_inwards(&film, &rows, &skin, once.data(), kappa.data());
}

void FreeSurface::find_forces()
{
  const sd_sph_tension tension = {how.sigma, sd_sph_surface_friction(how.sigma, how.rho0, how.surface.h)};
  sd_sph_tension_forces(&film, &tension, &rows, &skin, kappa.data(), F.data(), area.data());
  if (!how.walls) return;
  pressure.resize(atom->nlocal + 1);
  for (int k = 0; k < film.count; k++)
    pressure[near[k]] = x4[4 * (size_t) near[k] + 3] != 0.0 && !wall[near[k]] ? pair->pressure(near[k]) : 0.0;
  sd_sph_dry_walls(&film, how.sigma, &rows, kappa.data(), pressure.data(), F.data());
}

/* Drops that touch a wall or an open end do not keep their momentum. */
const char *FreeSurface::who_is_held()
{
  const int nlocal = atom->nlocal;
  if (!how.walls && !pair->has_ends()) return nullptr;
  held.assign(nlocal + 1, 0);
  for (int i = 0; i < nlocal && pair->has_ends(); i++) held[i] = pair->is_held(i);
  for (int k = 0; k < film.count && how.walls; k++)
    if (sums[8 * (size_t) near[k] + 4] > 0.0) held[near[k]] = 1;
  return held.data();
}

/* Normals of the surface, or curvatures of all that has one */
void FreeSurface::show(bool normals)
{
  for (int i = 0; i < atom->nlocal && normals; i++)
    if (shown.has(i)) shown.erase(i);
  for (int k = 0; k < film.count; k++) {
    const int i = near[k];
    const double *n = &at_surface[4 * (size_t) i];
    if (!normals && kappa[i] != 0.0) shown.writable(i)[0] = kappa[i];
    if (!normals || !(n[3] > 0.0)) continue;
    double *row = shown.writable(i);
    row[1] = n[3];
    std::copy_n(n, 3, row + 2);
  }
}

double FreeSurface::bytes() const
{
  double bytes = (double) (pool.capacity() * sizeof(int) + weight.capacity() * sizeof(double));
  for (const auto *each : {&x4, &v4, &at_surface, &contact, &whole, &at_wall, &sums, &beside, &turns, &own})
    bytes += (double) each->capacity() * sizeof(double);
  return bytes;
}

}    // namespace StokesDyn
