/* The spheres of all ranks that take part, in order of tag: the same on every rank, so that nothing depends
 * on the decomposition. What an engine sees that sums all pairs. */
#ifndef SD_CLOUD_H
#define SD_CLOUD_H

#include "epochs.h"

#include "sd_product.h"

#include "pointers.h"

#include <cstdint>
#include <vector>

namespace StokesDyn {

class Cloud : protected LAMMPS_NS::Pointers {
 public:
  explicit Cloud(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp) {}

  /* From the spheres of this rank. rows: since when they are these. On all ranks together, as what follows */
  void gather(const sd_spheres &own, const std::vector<int64_t> &tags, const std::vector<int64_t> &molecules,
              const Epoch &rows);
  int size() const { return n; }
  sd_spheres spheres() const { return {x.data(), a.data(), w.data()}; }
  const std::vector<int64_t> &molecules() const { return molecule; }

  /* From rows of this rank's spheres to rows of the cloud, and, summed over the ranks, back: width numbers of
   * each sphere; or, with first [size + 1], so many for each of its points */
  void to_all(const double *own_rows, double *rows, int width, const int *first = nullptr) const;
  void to_own(const double *rows, double *own_rows, int width, const int *first = nullptr);

  double memory_usage() const { return 5.0 * sizeof(double) * n; }

 private:
  int n = 0;
  Stamp sorted;
  /* [n] place of each sphere, the ranks' spheres one after the other */
  std::vector<int> place_of;
  /* [nprocs] */
  std::vector<int> spheres_of_rank;
  std::vector<double> x, a, w, in_order_of_rank;
  std::vector<int64_t> molecule;
  size_t own_rows_of(const int *first) const;
};

}    // namespace StokesDyn
#endif
