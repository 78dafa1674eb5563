/* A flow on a grid, from the file of "fluid_velocity grid FILE". The format is in
 * doc/pair_stokes_dynamics.md: a header of a line each for the axes x, y, z and time, then a row of
 * velocity, and of viscosity if given, for every node.
 *
 * One rank reads; all of them keep the whole grid, since spheres go everywhere. */
#ifndef SD_FLOW_FILE_H
#define SD_FLOW_FILE_H

#include "keywords.h"

#include "sd_flow_grid.h"

#include <memory>
#include <string>
#include <vector>

namespace StokesDyn {

class FlowFile {
 public:
  /* On all ranks. Errors name file and line. */
  static std::shared_ptr<const FlowFile> read(const Voice &voice, const std::string &path);

  FlowFile(const FlowFile &) = delete;
  FlowFile &operator=(const FlowFile &) = delete;

  /* of this LAMMPS's memory */
  sd_flow_grid grid;
  std::string path;
  /* of all that the grid says: 0 to 1. Another one is another flow. */
  double fingerprint = 0.0;

  bool has_viscosity() const { return grid.columns > 3; }

 private:
  friend class FlowReader;
  std::vector<double> nodes[SD_GRID_AXES], values;

  FlowFile() = default;
  void share(MPI_Comm world);
};

}    // namespace StokesDyn
#endif
