/* What a fix or pair style keeps in a restart file: numbers by name, so that a file of another
 * version is read by what it says and not by where it stands.
 *
 * In the file: a text "stokesdyn 1 STYLE VERSION\n" (before version 1.0.0 without it) and then lines
 * "NAME COUNT VALUE ... VALUE\n", hexadecimal floating point, which loses nothing; closed by a 0.
 * Names have no blanks. */
#ifndef SD_NAMED_STATE_H
#define SD_NAMED_STATE_H

#include "lammps.h"

#include <cstdio>
#include <map>
#include <string>
#include <vector>

namespace StokesDyn {

class NamedState {
 public:
  explicit NamedState(const std::string &style) : style(style) {}

  void put(const std::string &name, double value) { values[name] = {value}; }
  void put(const std::string &name, const std::vector<double> &v) { values[name] = v; }
  /* Numbers that a double does not hold: 64 bits as two halves. */
  void put_bits(const std::string &name, uint64_t bits);

  bool has(const std::string &name) const { return values.count(name) > 0; }
  /* What the file says, otherwise `absent`. */
  double get(const std::string &name, double absent) const;
  /* Leaves the array as it is, and returns false, unless the file has that many. */
  bool get(const std::string &name, double *out, size_t count) const;
  std::vector<double> get(const std::string &name) const;    // empty: not in the file
  uint64_t get_bits(const std::string &name, uint64_t absent) const;

  /* As LAMMPS's Fix::write_restart wants it: the length in bytes, an int, and then the bytes. For
   * the first rank. */
  void write(FILE *fp) const;
  /* What Fix::restart was given. False: written by another version of the plugin or for another
   * style, nothing is taken, and one warning has been given. The buffer is closed by a 0, or it is
   * none of ours. */
  bool read(LAMMPS_NS::LAMMPS *lmp, const char *buffer);

 private:
  std::string style;
  std::map<std::string, std::vector<double>> values;
};

}    // namespace StokesDyn
#endif
