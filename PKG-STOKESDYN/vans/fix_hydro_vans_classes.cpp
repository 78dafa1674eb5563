/* Of fix hydro/vans: which sizes of grains are apart in its averages. */
#include "fix_hydro_vans.h"

#include "ranks.h"

#include "atom.h"
#include "group.h"

#include <algorithm>
#include <cmath>
#include <map>

using namespace LAMMPS_NS;
using namespace StokesDyn;

/* A class for each radius, as long as there are no more than these. */
static constexpr size_t MAX_CLASSES = 32;

/* The different radii of the grains that are averaged, in the order of the lowest atom ID that has
 * each; of more than MAX_CLASSES not all. */
std::vector<double> FixHydroVans::different_radii(int bit) const
{
  struct First {
    double radius;
    tagint tag;
  };
  std::map<double, tagint> mine;
  for (int i = 0; i < atom->nlocal && mine.size() <= MAX_CLASSES; i++) {
    if (!(atom->mask[i] & bit) || !(atom->radius[i] > 0.0)) continue;
    tagint &lowest = mine.emplace(atom->radius[i], atom->tag[i]).first->second;
    lowest = std::min(lowest, atom->tag[i]);
  }
  std::vector<First> all;
  for (const auto &entry : mine) all.push_back({entry.first, entry.second});
  all = from_all(world, all);
  std::sort(all.begin(), all.end(), [](const First &p, const First &q) { return p.tag < q.tag; });
  std::vector<double> radii;
  for (const First &each : all)
    if (std::find(radii.begin(), radii.end(), each.radius) == radii.end())
      radii.push_back(each.radius);
  return radii;
}

/* n bins of equal ratio from the smallest grain to the largest, each with the volume and the surface
 * of its grains. */
void FixHydroVans::find_bins(int n, int bit)
{
  double lo = HUGE_VAL, hi = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & bit) || !(atom->radius[i] > 0.0)) continue;
    lo = std::min(lo, atom->radius[i]);
    hi = std::max(hi, atom->radius[i]);
  }
  lo = smallest_of_all(world, lo);
  hi = largest_of_all(world, hi);
  if (!(hi > 0.0) || !std::isfinite(hi)) {    // no grains yet; or a radius that averages refuse
    stream.set_classes({});
    return;
  }
  std::vector<double> limit(n + 1), radius(n), volume(n), sums(2 * (size_t) n, 0.0), all(sums);
  sd_vans_bins(lo, hi, n, limit.data());
  take.assign(atom->nlocal, 0);
  for (int i = 0; i < atom->nlocal; i++)
    take[i] = (atom->mask[i] & bit) && atom->radius[i] > 0.0;
  const sd_vans_averaging how = {set.point, n, nullptr, nullptr, limit.data()};
  const sd_vans_grains sorted = {atom->nlocal, nullptr, nullptr, atom->radius,
                                 nullptr, nullptr, take.data(), nullptr};
  sd_vans_class_sums(&how, &sorted, sums.data());
  MPI_Allreduce(sums.data(), all.data(), 2 * n, MPI_DOUBLE, MPI_SUM, world);
  sd_vans_class_means(n, limit.data(), all.data(), radius.data(), volume.data());
  if (set.classes && limit != stream.class_limits)
    set.voice.tell("keyword classes: the radii from " + text(lo) + " to " + text(hi) + " are sorted into " +
                   std::to_string(n) + " bins of the ratio " + text(std::pow(hi / lo, 1.0 / n)));
  stream.set_classes(radius, limit, volume);
}

/* One class for each radius, or bins. Classes of radii stay where they are when the grains of one have gone, and so
 * do the columns of outputs. */
void FixHydroVans::find_classes()
{
  const auto is_class = [this](double a) {
    const auto &known = stream.class_radii;
    return std::find(known.begin(), known.end(), a) != known.end();
  };
  if (set.has_grains() && set.class_radii.empty() && (set.classes || set.wants_pores())) {
    const int found = group->find(set.average.c_str()),
              bit = found < 0 ? 1 : group->bitmask[found];
    const std::vector<double> radii = set.bins ? std::vector<double>() : different_radii(bit);
    if (set.bins || radii.size() > MAX_CLASSES)
      find_bins(set.bins ? set.bins : (int) MAX_CLASSES, bit);
    else if (!radii.empty() && (stream.bins() || !std::all_of(radii.begin(), radii.end(), is_class)))
      stream.set_classes(radii);
  }
  size_array_cols = ARRAY_COLUMNS + (set.upflow ? 2 : 0);
  size_vector = VECTOR_SIZE;
  if (!set.classes) return;
  const int nclass = (int) stream.class_radii.size();
  size_array_cols += SD_VANS_ROWS * nclass;
  size_vector += CLASS_NUMBERS * nclass;
}
