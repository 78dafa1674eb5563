/* Of neighbours_stokes: pair_style hybrid/scaled, which tells its factors to restart files only. */
#include "neighbours_stokes.h"

#include "lammps_compat.h"

#include "force.h"
#include "pair.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* A number of a restart file; 0 behind its end */
template <class T> static T number_at(const std::string &bytes, size_t at)
{
  T value = 0;
  if (at + sizeof(T) <= bytes.size()) memcpy(&value, &bytes[at], sizeof(T));
  return value;
}

/* A name of a restart file: its length with the 0 at its end, and itself */
static std::string as_written(const std::string &name)
{
  const int length = (int) name.size() + 1;
  return std::string((const char *) &length, sizeof(int)) + name + '\0';
}

/* The variables that stand from `at` to the end: how many, and their names; false: none do */
static bool read_variables(const std::string &bytes, size_t at, std::vector<std::string> &names)
{
  const int n = number_at<int>(bytes, at);
  at += sizeof(int);
  names.clear();
  for (int k = 0; k < n && at < bytes.size(); k++) {
    const int length = number_at<int>(bytes, at);
    at += sizeof(int);
    if (length < 1 || at + length > bytes.size() || bytes[at + length - 1] != '\0') return false;
    names.push_back(bytes.substr(at, length - 1));
    at += length;
  }
  return n >= 0 && (int) names.size() == n && at == bytes.size();
}

/* What stands at the end of the file: [n] factors, [n] -1 or which variable, since 2025 the same for
 * variables of atom style, the variables. lists: how many lists of variables; false: it is not so. */
struct Scales {
  std::vector<double> factors;
  std::vector<int> which;
  std::vector<std::string> variables;
};
static bool read_scales(const std::string &bytes, size_t from, size_t n, size_t lists, Scales &scales)
{
  const size_t width = n * (sizeof(double) + lists * sizeof(int));
  size_t at = from;
  while (at < bytes.size() && !read_variables(bytes, at + width, scales.variables)) at++;
  if (at >= bytes.size()) return false;
  scales.factors.clear();
  scales.which.assign(n, -1);
  for (size_t k = 0; k < n; k++) {
    scales.factors.push_back(number_at<double>(bytes, at + k * sizeof(double)));
    if (!std::isfinite(scales.factors[k])) return false;
    for (size_t list = 0; list < lists; list++) {
      const int which = number_at<int>(bytes, at + n * sizeof(double) + (list * n + k) * sizeof(int));
      if (which < -1 || which >= (int) scales.variables.size()) return false;
      scales.which[k] = std::max(scales.which[k], which);
    }
  }
  return true;
}

/* The file: number of styles, ..., their names and settings, and Scales. */
bool scales_us(const Guest &guest, std::string &says)
{
  std::unique_ptr<FILE, int (*)(FILE *)> file(tmpfile(), fclose);
  if (!file) return false;
  guest.pair->write_restart(file.get());
  std::string bytes(ftell(file.get()), '\0');
  rewind(file.get());
  if (fread(&bytes[0], 1, bytes.size(), file.get()) != bytes.size()) return false;

  const size_t n = number_at<int>(bytes, 0), mine = bytes.find(as_written("stokes_dynamics"));
  size_t before = 0;
  for (const auto &style : Compat::pair_styles(guest.lmp->force))
    before += bytes.find(as_written(style.first)) < mine;
  Scales scales;
  if (!read_scales(bytes, mine, n, 2, scales) && !read_scales(bytes, mine, n, 1, scales)) return false;
  const int which = scales.which[before];
  says = which >= 0 ? "v_" + scales.variables[which] : text(scales.factors[before]);
  return which >= 0 || scales.factors[before] != 1.0;
}

}    // namespace StokesDyn
