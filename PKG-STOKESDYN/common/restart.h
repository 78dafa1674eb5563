/* What styles keep in restart files: the words of a pair_style command, which read_restart parses
 * again, so that a new keyword needs nothing here; and numbers by name, so that a file of another
 * version is read by what it says and not by where it stands. */
#ifndef SD_RESTART_H
#define SD_RESTART_H

#include "lammps.h"
#include <mpi.h>

#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

namespace StokesDyn {

/* For the first rank, as Pair::write_restart_settings. The plugin's version comes first. */
void write_words(FILE *fp, const std::vector<std::string> &words);

/* What write_words wrote, on all ranks; files from before the version stood in them are read too.
 * An error if a later version has another format. command: "Pair style ...", for the error. */
std::vector<std::string> read_words(LAMMPS_NS::LAMMPS *lmp, FILE *fp, const std::string &command);

/* Numbers of a restart file, by name, and where they stand */
struct SavedNumbers {
  const char *name;
  double *numbers;
  size_t count = 1;
  /* the file has their sum over the ranks, and the first rank gets it back */
  bool summed = false;
};

/* In the file: a text "stokesdyn 1 STYLE VERSION\n" (before version 1.0.0 without it) and then lines
 * "NAME COUNT VALUE ... VALUE\n", hexadecimal floating point, which loses nothing; closed by a 0.
 * Names have no blanks. */
class NamedState {
 public:
  explicit NamedState(const std::string &style) : style(style) {}

  void put(const std::string &name, double value) { values[name] = {value}; }
  void put(const std::string &name, const std::vector<double> &v) { values[name] = v; }
  /* On all ranks together. */
  void put(MPI_Comm world, const std::vector<SavedNumbers> &all);
  /* Numbers that a double does not hold: 64 bits as two halves. */
  void put_bits(const std::string &name, uint64_t bits);

  /* What the file says, otherwise `absent`. */
  double get(const std::string &name, double absent) const;
  /* Leaves the array as it is, and returns false, unless the file has that many. */
  bool get(const std::string &name, double *out, size_t count) const;
  std::vector<double> get(const std::string &name) const;    // empty: not in the file
  void get(MPI_Comm world, const std::vector<SavedNumbers> &all) const;
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
