/* Tables of numbers in text files. */
#ifndef SD_TABLE_FILE_H
#define SD_TABLE_FILE_H

#include "keywords.h"

#include <string>
#include <vector>

namespace StokesDyn {

/* All numbers of a file, row by row, the same on every rank; the first reads it. '#' begins a comment,
 * commas count as blanks. What is no finite number ends the run, with the name of the file and the line. */
std::vector<std::vector<double>> read_rows(const Voice &what, const std::string &file);

}    // namespace StokesDyn
#endif
