/* fix property/global: speed of sound and smoothing length by type, as inputs of LIGGGHTS give
 * them. See doc/pair_sph_artvisc_tenscorr.md. */
#ifndef SD_FIX_PROPERTY_GLOBAL_H
#define SD_FIX_PROPERTY_GLOBAL_H

#include "fix.h"

#include <string>
#include <vector>

namespace StokesDyn {

class FixPropertyGlobal : public LAMMPS_NS::Fix {
 public:
  static constexpr const char *STYLE = "property/global";

  FixPropertyGlobal(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override { return 0; }

  // speedOfSound or sl, and its value for types 1, 2, ...
  std::string property;
  std::vector<double> of_type;
};

}    // namespace StokesDyn
#endif
