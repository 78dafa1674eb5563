/* Of pair_style sph/artVisc/tensCorr: forces, and what is kept of them. */
#include "pair_sph_artvisc_tenscorr.h"

#include "fix_sph_grains.h"
#include "fix_sph_settings.h"
#include "fix_wall_sph.h"
#include "keywords.h"
#include "sd_sph_sums.h"

#include "atom.h"
#include "force.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

void PairSph::forces(bool rates)
{
  const int n = particles.n, receivers = shared && force->newton_pair ? n : atom->nlocal;
  const bool pairwise = evflag && vflag_either;
  if (model.artvisc || model.friction || rates || model.scheme != SD_SPH_PLAIN)
    sd_sph_pack_v(n, Sph::numbers(atom->vest), atom->rho, v4.data());
  if (has_own_viscosities()) find_viscosities();
  std::fill(f4.begin(), f4.end(), 0.0);
  if (pairwise) {
    const int *count = corrects ? near.count.data() : pairs.count;
    size_t entries = 0;
    for (int k = 0; k < pairs.n; k++) entries += count[pairs.first[k]];
    each.resize(3 * entries + 1);
  }
  const double nearest =
      sum_forces(model, near, pairs, rates, f4, pairwise ? each.data() : nullptr);
  if (nearest == 0.0) coincident();

  if (corrects) add_kicks(f4);
  for (int i = 0; i < receivers; i++)
    for (int d = 0; d < 3; d++) atom->f[i][d] += f4[4 * (size_t) i + d];
  if (wall) wall->bears(load_of(f4, receivers));
  if (rates)
    for (int i = 0; i < receivers; i++)
      if (atom->mask[i] & continuity->groupbit) atom->drho[i] += f4[4 * (size_t) i + 3];
  if (pairwise) tally();
  if (measured)
    keep_forces();
  else if (grains) {
    own = f4;
    reverse(own.data(), 4);
  }
}

/* Over the list of these neighbours both ways, or over the half list; the square of the shortest
 * distance. */
double PairSph::sum_forces(const sd_sph_model &of, Neighbours &both, const sd_sph_list &half, bool rates,
                           Rows &F, double *of_pairs)
{
  const sd_sph_both list = both.both(atom->nlocal);
  return corrects ? sd_sph_corrected_forces(&of, &list, &particles, F.data(), of_pairs)
                  : sd_sph_forces(&of, &half, &particles, rates, F.data(), of_pairs);
}

/* With correction, the momentum that particles take along as they are shifted. */
void PairSph::add_kicks(Rows &F) const
{
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++) F[4 * (size_t) i + d] += Sph::mass(lmp, i) * kick[3 * (size_t) i + d];
}

/* The forces as their owners have them, and friction: the same loop without pressure. */
void PairSph::keep_forces()
{
  const sd_sph_list list = has_ends() ? pairs_of_flow() : pairs;
  Neighbours &close = has_ends() ? of_flow : near;
  own = f4;    // with the kicks
  if (has_ends()) {
    std::fill(own.begin(), own.end(), 0.0);
    sum_forces(model, close, list, false, own, nullptr);
    if (corrects) add_kicks(own);
  }
  reverse(own.data(), 4);
  rubs.assign(f4.size(), 0.0);
  if (!model.artvisc && !model.friction) return;
  sd_sph_model friction = model;
  friction.tenscorr = 0;
  if (!corrects) friction.scheme = SD_SPH_PLAIN;
  for (int i = 0; i < particles.n; i++) x4[4 * (size_t) i + 3] = 0.0;
  sum_forces(friction, close, list, false, rubs, nullptr);
  reverse(rubs.data(), 4);
}

/* For the virial. With correction F is not opposite on the two: each has its half of F d. */
void PairSph::tally()
{
  const double *F = each.data();
  if (corrects) {
    for (int i = 0; i < atom->nlocal; i++)
      for (int m = 0; m < near.count[i]; m++, F += 3) {
        const int j = near.neighbor[i][m];
        if (j == particles.n) continue;
        const double *xi = atom->x[i], *xj = atom->x[j];
        ev_tally_xyz_full(i, 0.0, 0.0, F[0], F[1], F[2], xi[0] - xj[0], xi[1] - xj[1],
                          xi[2] - xj[2]);
      }
    return;
  }
  for (int k = 0; k < pairs.n; k++) {
    const int i = pairs.first[k];
    for (int m = 0; m < pairs.count[i]; m++, F += 3) {
      const int j = pairs.neighbor[i][m] & pairs.mask;
      const double *xi = atom->x[i], *xj = atom->x[j];
      ev_tally_xyz(i, j, atom->nlocal, shared && force->newton_pair, 0.0, 0.0, F[0], F[1], F[2],
                   xi[0] - xj[0], xi[1] - xj[1], xi[2] - xj[2]);
    }
  }
}

void PairSph::coincident()
{
  for (int k = 0; k < pairs.n; k++) {
    const int i = pairs.first[k];
    for (int m = 0; m < pairs.count[i]; m++) {
      const int j = pairs.neighbor[i][m] & pairs.mask;
      if (memcmp(atom->x[i], atom->x[j], 3 * sizeof(double)) == 0)
        voice.at_step().fail_one("atoms " + std::to_string(atom->tag[i]) + " and " +
                                 std::to_string(atom->tag[j]) + " are at one place");
    }
  }
  voice.at_step().fail_one("two atoms are at one place");
}
