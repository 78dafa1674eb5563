#include "flow_file.h"

#include "keywords.h"

#include "sd_hash.h"

#include "comm.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <new>
#include <sstream>
#include <stdexcept>

using namespace LAMMPS_NS;

namespace StokesDyn {

static const char *const AXIS[SD_GRID_AXES] = {"x", "y", "z", "time"};
static const char *const COLUMNS[] = {"ux", "uy", "uz", "eta"};

/* First and last node of a periodic axis are one place: they may differ by what is left of numbers
 * of six digits. */
static constexpr double SEAM = 1e-5;

/* What the first rank does. Every fault throws a std::runtime_error with the place of it. */
class FlowReader {
 public:
  FlowReader(const std::string &path, FlowFile &flow);
  void read();

 private:
  FlowFile &flow;
  std::ifstream in;
  double bytes = 0.0;
  std::string line;
  long at_line = 0;
  bool binary = false;

  [[noreturn]] void refuse(const std::string &why) const { throw std::runtime_error(why); }
  [[noreturn]] void refuse_line(const std::string &why) const
  {
    refuse("line " + std::to_string(at_line) + ": " + why);
  }
  bool next_line();
  void read_header();
  void read_axis(int axis, std::istringstream &words);
  void read_columns(std::istringstream &words);
  void require_size();
  void read_text();
  void read_row(double *row);
  void read_binary();
  void look_at_seams() const;
};

FlowReader::FlowReader(const std::string &path, FlowFile &flow) :
    flow(flow), in(path, std::ios::binary | std::ios::ate)
{
  if (!in) refuse(std::string("cannot be opened: ") + std::strerror(errno));
  bytes = (double) in.tellg();
  in.seekg(0);
  if (!in || bytes < 0.0 || in.peek() == EOF) refuse("is empty, or no file that can be read");
}

void FlowReader::read()
{
  read_header();
  require_size();
  if (binary)
    read_binary();
  else
    read_text();
  flow.grid.value = flow.values.data();
  look_at_seams();
}

/* Past blank lines and comments. */
bool FlowReader::next_line()
{
  while (std::getline(in, line)) {
    at_line++;
    const size_t first = line.find_first_not_of(" \t\r");
    if (first != std::string::npos && line[first] != '#') return true;
  }
  return false;
}

void FlowReader::read_header()
{
  flow.grid.columns = 0;
  std::string key, kind;
  const bool any = next_line();
  std::istringstream title(line);
  if (!any || !(title >> key >> kind) || key != "stokesdyn_grid" || kind != "1")
    refuse_line("a grid begins with 'stokesdyn_grid 1'");
  do {
    if (!next_line()) refuse("ends within its header, which 'rows text' or 'rows binary' closes");
    std::istringstream words(line);
    words >> key;
    const auto axis = std::find(AXIS, AXIS + SD_GRID_AXES, key) - AXIS;
    if (axis < SD_GRID_AXES)
      read_axis((int) axis, words);
    else if (key == "columns")
      read_columns(words);
    else if (key != "rows")
      refuse_line("unknown word '" + key + "': x, y, z, time, columns or rows");
    else if (!(words >> kind) || (kind != "text" && kind != "binary"))
      refuse_line("'rows' is followed by 'text' or 'binary'");
  } while (key != "rows");
  binary = kind == "binary";

  for (int d = 0; d < SD_GRID_TIME; d++)
    if (flow.nodes[d].empty()) refuse_line(std::string("no axis ") + AXIS[d] + " before the rows");
  if (flow.grid.columns == 0) refuse_line("no 'columns ux uy uz' before the rows");
  if (!flow.nodes[SD_GRID_TIME].empty()) return;
  flow.nodes[SD_GRID_TIME] = {0.0};
  sd_grid_axis_init(&flow.grid.axis[SD_GRID_TIME], 1, flow.nodes[SD_GRID_TIME].data(),
                    SD_OUTSIDE_CLAMP);
}

/* N, then the first and the last node or all of them, then perhaps what is beyond. */
void FlowReader::read_axis(int axis, std::istringstream &words)
{
  const std::string name = AXIS[axis];
  std::vector<double> &nodes = flow.nodes[axis];
  if (!nodes.empty()) refuse_line("axis " + name + " is given twice");
  std::string word;
  double count = 0.0, number;
  if (!(words >> word) || !is_number(word, count) || !(count >= 1.0) || count > 1e9 ||
      count != std::floor(count))
    refuse_line("axis " + name + ": the number of nodes '" + word + "' must be an integer >= 1");

  sd_outside outside = SD_OUTSIDE_NONE;
  while (words >> word) {
    if (!is_number(word, number)) break;
    if (!std::isfinite(number))
      refuse_line("axis " + name + ": '" + word + "' is not a finite number");
    nodes.push_back(number);
    word.clear();
  }
  if (word == "clamp")
    outside = SD_OUTSIDE_CLAMP;
  else if (word == "periodic")
    outside = SD_OUTSIDE_PERIODIC;
  else if (!word.empty() && word != "error")
    refuse_line("axis " + name + ": '" + word + "' is neither a number nor error, clamp, periodic");
  if (words >> word) refuse_line("axis " + name + ": unexpected '" + word + "'");

  const int n = (int) count;
  if (nodes.size() == 2 && n > 2) {
    const double first = nodes[0], last = nodes[1];
    if (!(last > first))
      refuse_line("axis " + name + ": its last node " + text(last) + " must be above the first, " +
                  text(first));
    if (n > bytes) refuse_line("axis " + name + ": the file is too short for so many nodes");
    nodes.resize(n);
    for (int k = 1; k < n; k++) nodes[k] = first + (last - first) * k / (n - 1);
    nodes[n - 1] = last;
  }
  if ((int) nodes.size() != n)
    refuse_line("axis " + name + ": " + std::to_string(nodes.size()) + " coordinates for " +
                std::to_string(n) + " nodes; the first and the last, or all");
  if (const int k = sd_grid_axis_init(&flow.grid.axis[axis], n, nodes.data(), outside))
    refuse_line("axis " + name + ": node " + std::to_string(k + 1) + " at " + text(nodes[k]) +
                " is not above the one before it, " + text(nodes[k - 1]));
}

void FlowReader::read_columns(std::istringstream &words)
{
  if (flow.grid.columns) refuse_line("'columns' is given twice");
  std::string word;
  while (words >> word) {
    if (flow.grid.columns == 4 || word != COLUMNS[flow.grid.columns])
      refuse_line("the columns are 'ux uy uz' or 'ux uy uz eta', not '" + word + "'");
    flow.grid.columns++;
  }
  if (flow.grid.columns < 3) refuse_line("the columns are 'ux uy uz' or 'ux uy uz eta'");
}

/* Before memory is asked for: a number takes 8 bytes in binary, 2 at least as text. */
void FlowReader::require_size()
{
  double numbers = flow.grid.columns;
  for (const auto &nodes : flow.nodes) numbers *= (double) nodes.size();
  const double left = bytes - (double) in.tellg();
  if (binary && left != 8.0 * numbers)
    refuse_line("after it come " + text(left) + " bytes of rows, and not the " +
                text(8.0 * numbers) + " of " + text(numbers) + " numbers");
  if (!binary && left < 2.0 * numbers - 1.0)
    refuse_line("after it come " + text(left) + " bytes: too few for the rows of " +
                text(numbers / flow.grid.columns) + " nodes");
}

void FlowReader::read_text()
{
  const size_t size = sd_flow_grid_size(&flow.grid), columns = flow.grid.columns;
  flow.values.resize(size);
  for (size_t k = 0; k < size; k += columns) {
    if (!next_line())
      refuse("line " + std::to_string(at_line) + ": ends after " + std::to_string(k / columns) +
             " of " + std::to_string(size / columns) + " rows");
    read_row(&flow.values[k]);
  }
  if (next_line()) refuse_line("more than the " + std::to_string(size / columns) + " rows of the grid");
}

void FlowReader::read_row(double *row)
{
  const char *at = line.c_str();
  for (int p = 0; p < flow.grid.columns; p++) {
    char *end;
    row[p] = std::strtod(at, &end);
    if (end == at || (*end != '\0' && !std::isspace((unsigned char) *end)))
      refuse_line(std::string("no number for ") + COLUMNS[p] + ": '" + line.substr(0, 60) + "'");
    if (!std::isfinite(row[p]))
      refuse_line(std::string(COLUMNS[p]) + " is not a finite number: '" + line.substr(0, 60) + "'");
    at = end;
  }
  if (flow.grid.columns == 4 && !(row[3] > 0.0))
    refuse_line("the viscosity " + text(row[3]) + " must be > 0");
  while (std::isspace((unsigned char) *at)) at++;
  if (*at != '\0')
    refuse_line("more than " + std::to_string(flow.grid.columns) + " numbers: '" +
                line.substr(0, 60) + "'");
}

void FlowReader::read_binary()
{
  const uint16_t one = 1;
  if (*(const unsigned char *) &one != 1)
    refuse("binary rows are little-endian, which this machine is not: use 'rows text'");
  flow.values.resize(sd_flow_grid_size(&flow.grid));
  in.read((char *) flow.values.data(), (std::streamsize) (8 * flow.values.size()));
  if (!in) refuse("could not be read to its end");
  flow.grid.value = flow.values.data();
  const size_t bad = sd_flow_grid_fault(&flow.grid), columns = flow.grid.columns;
  if (bad < flow.values.size())
    refuse("row " + std::to_string(bad / columns + 1) + " after line " + std::to_string(at_line) +
           ": " + COLUMNS[bad % columns] + " is " + text(flow.values[bad]) +
           (bad % columns == 3 ? ", and must be > 0" : ", no finite number"));
}

void FlowReader::look_at_seams() const
{
  for (int d = 0; d < SD_GRID_AXES; d++) {
    const double seam = sd_flow_grid_seam(&flow.grid, d);
    if (seam > SEAM)
      refuse(std::string("axis ") + AXIS[d] +
             " is periodic, but its last node, which is its first one again, differs by " +
             text(seam) + " of the largest value");
  }
}

/* From the first rank to all. */
void FlowFile::share(MPI_Comm world)
{
  int shape[2 * SD_GRID_AXES + 1];
  for (int d = 0; d < SD_GRID_AXES; d++) {
    shape[d] = (int) nodes[d].size();
    shape[SD_GRID_AXES + d] = grid.axis[d].outside;
  }
  shape[2 * SD_GRID_AXES] = grid.columns;
  MPI_Bcast(shape, 2 * SD_GRID_AXES + 1, MPI_INT, 0, world);
  grid.columns = shape[2 * SD_GRID_AXES];
  for (int d = 0; d < SD_GRID_AXES; d++) {
    nodes[d].resize(shape[d]);
    MPI_Bcast(nodes[d].data(), shape[d], MPI_DOUBLE, 0, world);
    sd_grid_axis_init(&grid.axis[d], shape[d], nodes[d].data(), (sd_outside) shape[SD_GRID_AXES + d]);
  }
  values.resize(sd_flow_grid_size(&grid));
  grid.value = values.data();
  constexpr size_t PIECE = 1 << 26;    // MPI counts with int
  for (size_t k = 0; k < values.size(); k += PIECE)
    MPI_Bcast(&values[k], (int) std::min(PIECE, values.size() - k), MPI_DOUBLE, 0, world);

  uint64_t hash = 0;
  auto add = [&hash](double number) {
    uint64_t bits;
    std::memcpy(&bits, &number, sizeof bits);
    hash = sd_hash_mix(hash + SD_HASH_STEP + bits);
  };
  for (int number : shape) add(number);
  for (const auto &axis : nodes)
    for (double node : axis) add(node);
  for (double number : values) add(number);
  fingerprint = sd_hash_unit(hash);
}

std::shared_ptr<const FlowFile> FlowFile::read(const Voice &voice, const std::string &path)
{
  LAMMPS *lmp = voice.lmp;
  std::shared_ptr<FlowFile> flow(new FlowFile);
  flow->path = path;
  std::string fault;
  if (lmp->comm->me == 0) try {
      FlowReader(path, *flow).read();
    } catch (const std::bad_alloc &) {
      fault = "more numbers than this machine has memory for";
    } catch (const std::runtime_error &error) {
      fault = error.what();
    }
  int length = (int) fault.size();
  MPI_Bcast(&length, 1, MPI_INT, 0, lmp->world);
  fault.resize(length);
  MPI_Bcast(&fault[0], length, MPI_CHAR, 0, lmp->world);
  if (length) voice.fail("grid file '" + path + "' " + fault);
  flow->share(lmp->world);
  return flow;
}

}    // namespace StokesDyn
