/* What the files hold that keywords of fix hydro/vans name. Whatever they lack ends the run. */
#ifndef SD_VANS_FILES_H
#define SD_VANS_FILES_H

#include "keywords.h"

#include <string>
#include <vector>

namespace StokesDyn {

/* One number in a row, or all of them in one row. So many are expected, which errors call `count`; 0: any */
std::vector<double> read_list(const Voice &what, const std::string &file, size_t expected,
                              const std::string &count);

/* Edges of slices, from that at z_ref, which is out, upwards: heights above it */
std::vector<double> read_edges(const Voice &what, const std::string &file, double &z_ref);

/* ncell + 1 velocities of the water */
std::vector<double> read_profile(const Voice &what, const std::string &file, int ncell);

/* The columns of a file for keyword given: phi, velocity, drag, then, if nclass, phi and drag of
 * each class; the latter may be missing. */
std::vector<std::vector<double>> read_given(const Voice &what, const std::string &file, int ncell,
                                            size_t nclass);

}    // namespace StokesDyn
#endif
