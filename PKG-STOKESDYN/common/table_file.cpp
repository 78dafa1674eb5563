#include "table_file.h"

#include "comm.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* The text of a file, the same on every rank. */
static std::string text_of(const Voice &what, const std::string &file)
{
  const LAMMPS *lmp = what.lmp;
  std::string text;
  int size = -1;
  FILE *fp = lmp->comm->me == 0 ? fopen(file.c_str(), "r") : nullptr;
  if (fp) {
    char buffer[4096];
    for (size_t n; (n = fread(buffer, 1, sizeof(buffer), fp)) > 0;) text.append(buffer, n);
    fclose(fp);
    size = (int) text.size();
  }
  MPI_Bcast(&size, 1, MPI_INT, 0, lmp->world);
  if (size < 0) what.fail("cannot read file '" + file + "'");
  text.resize(size);
  MPI_Bcast(&text[0], size, MPI_CHAR, 0, lmp->world);
  return text;
}

std::vector<std::vector<double>> read_rows(const Voice &what, const std::string &file)
{
  std::vector<std::vector<double>> rows;
  std::istringstream lines(text_of(what, file));
  std::string line, word;
  for (int number = 1; std::getline(lines, line); number++) {
    line = line.substr(0, line.find('#'));
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    std::vector<double> row;
    for (double value; words >> word; row.push_back(value))
      if (!is_number(word, value) || !std::isfinite(value))
        what.fail("file '" + file + "', line " + std::to_string(number) + ": '" + word +
                  "' is not a finite number");
    if (!row.empty()) rows.push_back(row);
  }
  return rows;
}

}    // namespace StokesDyn
