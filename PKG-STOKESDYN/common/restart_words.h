/* The words of a pair_style command in a restart file: read_restart parses them again, so a new
 * keyword needs nothing here. */
#ifndef SD_RESTART_WORDS_H
#define SD_RESTART_WORDS_H

#include "lammps.h"

#include <cstdio>
#include <string>
#include <vector>

namespace StokesDyn {

/* For the first rank, as Pair::write_restart_settings. The plugin's version comes first. */
void write_words(FILE *fp, const std::vector<std::string> &words);

/* What write_words wrote, on all ranks; files from before the version stood in them are read too.
 * An error if a later version has another format. command: "Pair style ...", for the error. */
std::vector<std::string> read_words(LAMMPS_NS::LAMMPS *lmp, FILE *fp, const std::string &command);

}    // namespace StokesDyn
#endif
