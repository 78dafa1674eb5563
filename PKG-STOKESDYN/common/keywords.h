/* One parser for all styles, with one voice for errors: "<command>: keyword <name>: ..." on every rank. */
#ifndef SD_KEYWORDS_H
#define SD_KEYWORDS_H

#include "lammps.h"
#include "lmptype.h"

#include <initializer_list>
#include <limits>
#include <string>
#include <vector>

namespace StokesDyn {

/* Ends the run on all ranks with "<message>"; never returns. For errors that every rank knows. */
[[noreturn]] void fail(LAMMPS_NS::LAMMPS *lmp, const std::string &message);

/* The same where only this rank knows. */
[[noreturn]] void fail_one(LAMMPS_NS::LAMMPS *lmp, const std::string &message);

/* A number as a user would write it: 6 digits. */
std::string text(double value);

/* Walks through "keyword value ..." pairs:
 *   Keywords in(lmp, "Pair style stokes_dynamics", args);
 *   while (in.next()) {
 *     if (in.is("visc")) eta = in.positive();
 *     else in.unknown();
 *   }  */
class Keywords {
 public:
  Keywords(LAMMPS_NS::LAMMPS *lmp, const std::string &command, const std::vector<std::string> &args,
           size_t begin = 0);

  bool next();    // to the next keyword; false at the end
  bool is(const std::string &name) const { return name == key; }
  bool more() const { return at < args.size(); }    // is there another word?
  const std::string &peek() const { return args[at]; }

  std::string word();    // the values of the present keyword, one call each
  double number();       // finite
  double positive();
  double not_negative();
  LAMMPS_NS::bigint integer(LAMMPS_NS::bigint lowest,
                            LAMMPS_NS::bigint highest = std::numeric_limits<int>::max());
  bool yes_no();
  size_t choice(std::initializer_list<const char *> options);    // index of the option given

  [[noreturn]] void unknown() const;                         // the present keyword does not exist
  [[noreturn]] void refuse(const std::string &why) const;    // "<command>: keyword <key>: <why>"

 private:
  LAMMPS_NS::LAMMPS *lmp;
  std::string command, key;
  std::vector<std::string> args;
  size_t at;
};

/* Words of a LAMMPS command as strings. */
std::vector<std::string> words(int narg, char **arg);

/* Does this word read as a number, all of it? Then value is set. "inf" and "nan" count as numbers. */
bool is_number(const std::string &word, double &value);

}    // namespace StokesDyn
#endif
