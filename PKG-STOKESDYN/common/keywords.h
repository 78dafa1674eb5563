/* One parser for all styles, with one voice for errors: "<command>: keyword <name>: ..." on every
 * rank. */
#ifndef SD_KEYWORDS_H
#define SD_KEYWORDS_H

#include "lammps.h"
#include "lmptype.h"

#include <functional>
#include <initializer_list>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace StokesDyn {

/* Ends the run on all ranks with "<message>"; never returns. For errors that every rank knows. */
[[noreturn]] void fail(LAMMPS_NS::LAMMPS *lmp, const std::string &message);

/* The same where only this rank knows. */
[[noreturn]] void fail_one(LAMMPS_NS::LAMMPS *lmp, const std::string &message);

/* A warning that all ranks ask for, printed by the first. */
void warn(LAMMPS_NS::LAMMPS *lmp, const std::string &message);

/* Text of a file or a script as it can be printed: bytes that are no UTF-8, and controls, as \xNN.
 * Every message of fail, fail_one, warn and Voice goes through it. */
std::string printable(const std::string &text);

/* A number as a user would write it: 6 digits. */
std::string text(double value);

/* One command's errors and warnings: "<command>: <what>". */
class Voice {
 public:
  Voice(LAMMPS_NS::LAMMPS *lmp, const std::string &command) : lmp(lmp), command(command) {}

  LAMMPS_NS::LAMMPS *const lmp;
  const std::string command;

  /* as `fail` and `fail_one` */
  [[noreturn]] void fail(const std::string &what) const;
  [[noreturn]] void fail_one(const std::string &what) const;
  /* a warning, or a line of the log, that all ranks ask for; printed by the first */
  void warn(const std::string &what) const;
  void tell(const std::string &what) const;
  /* the voice of a part of the command: "<command>: <part>: <what>"; of this step */
  Voice of(const std::string &part) const { return Voice(lmp, command + ": " + part); }
  Voice at_step() const;
};

/* A keyword of a command, and what reads the values that follow it. */
struct Keyword {
  const char *name;
  std::function<void()> read;
};

/* The words of a command: first those in fixed places, then "keyword value ..." in any order.
 *   Keywords in(lmp, "Fix example", words(narg, arg), 3);
 *   nevery = in.positional("N").integer(1);
 *   in.parse({
 *       {"visc", [&] { eta = in.positive(); }},
 *       {"gravity", [&] { for (double &component : g) component = in.number(); }},
 *   });
 *   in.require(in.given("visc"), "keyword visc is required: the dynamic viscosity");
 * A keyword that is not in the table, or that is there twice, is an error. */
class Keywords : private Voice {
 public:
  Keywords(LAMMPS_NS::LAMMPS *lmp, const std::string &command, const std::vector<std::string> &args,
           size_t begin = 0);

  /* The next words are the value of an argument without keyword; name: for errors. */
  Keywords &positional(const std::string &name);
  /* All that is left. An empty table: nothing may be left. */
  void parse(std::initializer_list<Keyword> table);
  bool given(const std::string &name) const;
  /* Unless the condition holds, an error: "<command>: <rule>". */
  void require(bool condition, const std::string &rule) const;

  /* The same by hand: to the next keyword (false at the end), and which it is. */
  bool next();
  bool is(const std::string &name) const { return name == key; }
  /* "<command>: keyword <key>" */
  std::string present() const { return command + ": keyword " + key; }

  /* What the next value is, in the words of the style's page: an error that it is missing says so,
   *   temperature = in.value("T").positive(), seed = in.value("seed").integer(1); */
  Keywords &value(const std::string &name);
  /* The values of the present keyword, one call each. */
  std::string word();
  double number();    // finite
  double positive();
  double not_negative();
  LAMMPS_NS::bigint integer(LAMMPS_NS::bigint lowest,
                            LAMMPS_NS::bigint highest = std::numeric_limits<int>::max());
  bool yes_no();
  /* index of the option given, or that as an enum */
  size_t choice(std::initializer_list<const char *> options);
  template <class Enum> Enum option(std::initializer_list<const char *> options)
  {
    return (Enum) choice(options);
  }
  /* Unless the condition holds, an error about the last word taken: "<command>: keyword <key>:
   * '<word>' <rule>" */
  void check(bool condition, const std::string &rule) const;
  /* Takes the next word if it is this one: for "off", "inf" and the like in place of a number. */
  bool take(const std::string &option);
  bool more() const { return at < args.size(); }
  size_t left() const { return args.size() - at; }
  const std::string &peek() const { return args[at]; }

  /* "<command>: unknown keyword <key>", with those that there are */
  [[noreturn]] void unknown(const std::vector<std::string> &names) const;
  /* Keywords, with blanks between them, that belong to another command, as one might have thought: an
   * error that is given for them names it. */
  Keywords &elsewhere(const std::string &names, const std::string &command);
  /* "<command>: keyword <key>: <why>" */
  [[noreturn]] void refuse(const std::string &why) const;

 private:
  std::string key, next_value;
  std::vector<std::string> args, seen;
  std::vector<std::pair<std::string, std::string>> others;
  size_t at, first;    // the next word; the first of the present argument
};

/* Words of a LAMMPS command as strings. */
std::vector<std::string> words(int narg, char **arg);

/* Does this word read as a number, all of it? Then value is set. Decimal only, as in LAMMPS's own
 * commands; "inf" and "nan" count as numbers. */
bool is_number(const std::string &word, double &value);

}    // namespace StokesDyn
#endif
