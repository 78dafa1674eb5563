#include "restart.h"

#include "keywords.h"

#include "comm.h"
#include "utils.h"

#include <algorithm>
#include <cstring>
#include <sstream>

using namespace LAMMPS_NS;

namespace StokesDyn {

// --- words ---------------------------------------------------------------------------------------

// 2: words alone. 3: the plugin's version before them, whatever else a later format may have.
static const int FORMAT = 3, WITHOUT_VERSION = 2;

void write_words(FILE *fp, const std::vector<std::string> &words)
{
  std::string all = SD_VERSION "\n";
  for (const auto &word : words) all += word + '\n';
  const int head[2] = {FORMAT, (int) all.size()};
  fwrite(head, sizeof(int), 2, fp);
  fwrite(all.data(), 1, all.size(), fp);
}

std::vector<std::string> read_words(LAMMPS *lmp, FILE *fp, const std::string &command)
{
  const bool root = lmp->comm->me == 0;
  int head[2] = {0, 0};
  if (root) utils::sfread(FLERR, head, sizeof(int), 2, fp, nullptr, lmp->error);
  MPI_Bcast(head, 2, MPI_INT, 0, lmp->world);
  const std::string cure = "let that version read it and write a data file (write_data)",
                    ours = ", which reads " + std::to_string(FORMAT);
  const Voice voice(lmp, command);
  if (head[0] < WITHOUT_VERSION || head[1] < 0)
    voice.fail("the restart file was written by another version of the plugin (format " +
               std::to_string(head[0]) + ", this is version " SD_VERSION + ours +
               "); " + cure);
  std::string all(head[1], '\0');
  if (root && !all.empty())
    utils::sfread(FLERR, &all[0], 1, all.size(), fp, nullptr, lmp->error);
  MPI_Bcast(&all[0], head[1], MPI_CHAR, 0, lmp->world);

  std::vector<std::string> words;
  for (size_t from = 0, to; (to = all.find('\n', from)) != std::string::npos; from = to + 1)
    words.push_back(all.substr(from, to - from));
  if (head[0] == WITHOUT_VERSION) return words;
  const std::string version = words.empty() ? "" : words.front();
  if (head[0] != FORMAT)
    voice.fail("the restart file was written by another version of the plugin, " + version +
               ", in format " + std::to_string(head[0]) +
               "; this is version " SD_VERSION + ours + "; " + cure);
  words.erase(words.begin());
  return words;
}

// --- numbers by name -----------------------------------------------------------------------------

static const char MAGIC[] = "stokesdyn 1 ";    // the number is that of the format

/* The version that stands in the head of a state, of whatever format. */
static std::string version_of(const char *buffer)
{
  std::string magic, format, style, version;
  if (strncmp(buffer, "stokesdyn ", 10) == 0)
    std::istringstream(std::string(buffer, strcspn(buffer, "\n"))) >> magic >> format >> style >> version;
  return version.empty() ? "one before 1.0.0" : version;
}

void NamedState::put_bits(const std::string &name, uint64_t bits)
{
  values[name] = {(double) (bits >> 32), (double) (bits & 0xffffffffu)};
}

void NamedState::put(MPI_Comm world, const std::vector<SavedNumbers> &all)
{
  for (const SavedNumbers &each : all) {
    std::vector<double> v(each.numbers, each.numbers + each.count);
    if (each.summed) MPI_Allreduce(each.numbers, v.data(), (int) each.count, MPI_DOUBLE, MPI_SUM, world);
    put(each.name, v);
  }
}

void NamedState::get(MPI_Comm world, const std::vector<SavedNumbers> &all) const
{
  int me;
  MPI_Comm_rank(world, &me);
  for (const SavedNumbers &each : all)
    if (me == 0 || !each.summed) get(each.name, each.numbers, each.count);
}

double NamedState::get(const std::string &name, double absent) const
{
  const auto found = values.find(name);
  return found == values.end() || found->second.empty() ? absent : found->second[0];
}

bool NamedState::get(const std::string &name, double *out, size_t count) const
{
  const auto found = values.find(name);
  if (found == values.end() || found->second.size() != count) return false;
  std::copy(found->second.begin(), found->second.end(), out);
  return true;
}

std::vector<double> NamedState::get(const std::string &name) const
{
  const auto found = values.find(name);
  return found == values.end() ? std::vector<double>() : found->second;
}

uint64_t NamedState::get_bits(const std::string &name, uint64_t absent) const
{
  double half[2];
  return get(name, half, 2) ? (uint64_t) half[0] << 32 | (uint64_t) half[1] : absent;
}

void NamedState::write(FILE *fp) const
{
  std::string out = MAGIC + style + " " SD_VERSION "\n";
  char number[40];
  for (const auto &entry : values) {
    out += entry.first + " " + std::to_string(entry.second.size());
    for (double v : entry.second) {
      snprintf(number, sizeof(number), " %a", v);
      out += number;
    }
    out += "\n";
  }
  const int size = (int) out.size() + 1;
  fwrite(&size, sizeof(int), 1, fp);
  fwrite(out.c_str(), 1, size, fp);
}

bool NamedState::read(LAMMPS *lmp, const char *buffer)
{
  const std::string head = MAGIC + style;
  if (strncmp(buffer, head.c_str(), head.size()) != 0 || !strchr(" \n", buffer[head.size()])) {
    warn(lmp, "Fix " + style + ": the restart file was written by another version of the plugin, " +
                  version_of(buffer) + ", this is " SD_VERSION
                  ": its data for this fix are ignored, and the fix begins anew");
    return false;
  }
  std::istringstream lines(buffer + strcspn(buffer, "\n"));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name, number;
    size_t count = 0;
    words >> name >> count;
    std::vector<double> v;
    while (v.size() < count && words >> number) v.push_back(strtod(number.c_str(), nullptr));
    if (v.size() == count) values[name] = v;
  }
  return true;
}

}    // namespace StokesDyn
