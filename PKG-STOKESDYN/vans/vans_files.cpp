#include "vans_files.h"

#include "table_file.h"

namespace StokesDyn {

/* A table of several columns is something else. */
std::vector<double> read_list(const Voice &what, const std::string &file, size_t expected,
                                     const std::string &count)
{
  const auto rows = read_rows(what, file);
  std::vector<double> list;
  for (size_t k = 0; k < rows.size(); k++) {
    if (rows.size() > 1 && rows[k].size() > 1)
      what.fail("file '" + file + "': row " + std::to_string(k + 1) + " has " +
                std::to_string(rows[k].size()) + " values, one per row is needed");
    list.insert(list.end(), rows[k].begin(), rows[k].end());
  }
  if (expected && list.size() != expected)
    what.fail("file '" + file + "' has " + std::to_string(list.size()) + " values, " + count +
              " = " + std::to_string(expected) + " are needed");
  return list;
}

std::vector<double> read_profile(const Voice &what, const std::string &file, int ncell)
{
  return read_list(what, file, ncell + 1, "ncell + 1");
}

std::vector<std::vector<double>> read_given(const Voice &what, const std::string &file, int ncell,
                                            size_t nclass)
{
  const size_t N = ncell, columns = 3 + 2 * nclass;
  const auto rows = read_rows(what, file);
  const std::string name = "file '" + file + "'";
  if (rows.size() != N)
    what.fail(name + " has " + std::to_string(rows.size()) + " rows, ncell = " +
              std::to_string(N) + " are needed");
  std::vector<std::vector<double>> given(columns, std::vector<double>(N));
  for (size_t n = 0; n < N; n++) {
    const std::string row = std::to_string(n + 1);
    if (rows[n].size() != columns && rows[n].size() != 3)
      what.fail(name + ", row " + row + " has " + std::to_string(rows[n].size()) +
                " values; phi, velocity and drag" +
                (nclass ? ", then phi and drag of each of class_radii," : "") + " are needed");
    if (rows[n].size() < given.size()) given.resize(3);
    for (size_t c = 0; c < given.size(); c++) given[c][n] = rows[n][c];
    if (!(rows[n][0] >= 0.0 && rows[n][0] < 1.0))
      what.fail(name + ": phi = " + text(rows[n][0]) + " in slice " + row +
                ", it must be in [0, 1)");
  }
  return given;
}

std::vector<double> read_edges(const Voice &what, const std::string &file, double &z_ref)
{
  std::vector<double> edge = read_list(what, file, 0, "");
  const std::string name = "file '" + file + "'";
  if (edge.size() < 3)
    what.fail(name + " has " + std::to_string(edge.size()) + " edges, at least 3 are needed");
  z_ref = edge[0];
  for (size_t k = 0; k < edge.size(); k++) {
    edge[k] -= z_ref;
    if (k > 0 && !(edge[k] > edge[k - 1]))
      what.fail(name + ": edge " + std::to_string(k + 1) + " (" + text(edge[k] + z_ref) +
                ") is not above the one before");
  }
  return edge;
}

}    // namespace StokesDyn
