/* Spheres that are near those of this rank: of other ranks, and periodic images, also of its own.
 *
 * They are found from where the spheres stand, among all ranks, and not among LAMMPS's ghosts: a
 * long range needs no comm_modify and costs other styles nothing, any decomposition will do, and
 * the range may change in any step. */
#ifndef SD_IMAGES_H
#define SD_IMAGES_H

#include "sd_ewald.h"

#include <mpi.h>

namespace LAMMPS_NS {
class Domain;
}

#include <vector>

namespace StokesDyn {

class Images {
 public:
  explicit Images(MPI_Comm world);

  /* Spheres x [3n], a [n], w [n] of this rank; behind them come those within `reach` of the
   * smallest parallelepiped, with faces as the box has them, that holds the centres of this rank's.
   * On all ranks together. */
  void find(const sd_ewald_box &box, double reach, std::vector<double> &x, std::vector<double> &a,
            std::vector<double> &w);
  /* rows [width n] of this rank's spheres -> those of the images, in the order of find() */
  void refresh(const double *rows, double *images, int width);

  double memory_usage() const;

 private:
  MPI_Comm world;
  int me, ranks;
  /* [ranks] how many images go to, and come from, each rank */
  std::vector<int> to, from;
  /* the spheres of this rank that go, rank by rank, and how far they are moved: steps of the box's
   * edges, three a sphere */
  std::vector<int> sphere, steps;
  std::vector<double> out;

  std::vector<double> blocks(const sd_ewald_box &box, const std::vector<double> &x) const;
  void choose(const sd_ewald_box &box, double reach, const std::vector<double> &x);
  template <class Row> void send(int width, const Row &row, double *images);
};

/* LAMMPS's box if it is periodic all ways; else an open one, whose lengths mean nothing. */
sd_ewald_box periodic_box(const LAMMPS_NS::Domain *domain);

/* to[p] numbers of `send` to rank p, from[p] of `receive` from it, one rank after the other. */
void exchange_numbers(MPI_Comm world, const double *send, const int *to, double *receive,
                      const int *from);

}    // namespace StokesDyn
#endif
