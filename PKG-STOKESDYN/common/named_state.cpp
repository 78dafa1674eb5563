#include "named_state.h"

#include "keywords.h"

#include "comm.h"
#include "error.h"

#include <algorithm>
#include <cstring>
#include <sstream>

using namespace LAMMPS_NS;

namespace StokesDyn {

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
    if (lmp->comm->me == 0)
      lmp->error->warning(FLERR,
                          "Fix " + style +
                              ": the restart file was written by another version of the plugin, " +
                              printable(version_of(buffer)) + ", this is " SD_VERSION
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
