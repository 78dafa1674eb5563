/* The flow that forces on the fluid make at given places, above a floor, in a slit or in an open layer
 * (sd_slab.h): the engine of the spheres moves specks there, spheres on which nothing acts and which
 * are so small that it makes no difference to how they go along.
 *
 * They come in pieces of about as many specks as there are spheres and far from each other, so that
 * a piece costs about two products of the spheres, and memory has a bound. */
#ifndef SD_FLOW_IN_SLAB_H
#define SD_FLOW_IN_SLAB_H

#include "callback.h"
#include "halo.h"

#include "sd_mobility.h"

#include <vector>

namespace LAMMPS_NS {
class Domain;
}

namespace StokesDyn {

class Voice;
struct FlowSources;
struct SceneSettings;

class FlowInSlab {
 public:
  /* u [3m] += the flow of these at x [3m], places of this rank; 0 where there is no fluid. Torques are not
   * read. On all ranks together. Errors: no grid for the sum, more images than memory has room for */
  void add(const Voice &voice, const SceneSettings &, const FlowSources &, const std::vector<double> &x,
           double *u);
  double memory_usage() const;

 private:
  /* the last splitting, and the engine with its tables */
  sd_slab slab = {};
  Owned<sd_mobility, sd_mobility_free> omega;
  double rows = 0.0;

  /* spheres of this rank, then specks; forces on them */
  struct Piece {
    std::vector<double> x, a, F;
  };
  static sd_slab_spheres with_specks(MPI_Comm, const sd_slab_walls &, const Piece &sources,
                                     const std::vector<double> &x);
  double choose(const Voice &, const SceneSettings &, const Piece &sources, const std::vector<double> &x);
  void add_piece(const Voice &, const SceneSettings &, Piece &piece, std::vector<double> &u);
};

}    // namespace StokesDyn
#endif
