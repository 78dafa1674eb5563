#include "keywords.h"

#include "comm.h"
#include "error.h"
#include "update.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* How many bytes of UTF-8 begin here: 1 to 4, 0: none that can be printed */
static size_t printable_bytes(const std::string &text, size_t at)
{
  const unsigned char c = text[at];
  if (c < 0x80) return c >= ' ' && c != 0x7f;
  const size_t n = c >= 0xc2 && c < 0xe0 ? 2 : c >= 0xe0 && c < 0xf0 ? 3 : c >= 0xf0 && c < 0xf5 ? 4 : 0;
  if (n == 0 || at + n > text.size()) return 0;
  for (size_t k = 1; k < n; k++)
    if (((unsigned char) text[at + k] & 0xc0) != 0x80) return 0;
  const unsigned char second = text[at + 1];    // no overlong forms, no surrogates, no controls
  const bool proper = !(c == 0xe0 && second < 0xa0) && !(c == 0xed && second > 0x9f) &&
      !(c == 0xf0 && second < 0x90) && !(c == 0xf4 && second > 0x8f) && !(c == 0xc2 && second < 0xa0);
  return proper ? n : 0;
}

std::string printable(const std::string &text)
{
  std::string out;
  for (size_t at = 0; at < text.size();) {
    const size_t n = printable_bytes(text, at);
    char code[5];
    snprintf(code, sizeof(code), "\\x%02x", (unsigned char) text[at]);
    out += n > 0 ? text.substr(at, n) : code;
    at += n > 0 ? n : 1;
  }
  return out;
}

/* Where a rank ends by MPI_Abort, its own or another's, what buffers hold is lost: the message, where the output is a
 * file or a pipe. */
static void flush_output(LAMMPS *lmp)
{
  if (lmp->screen) fflush(lmp->screen);
  if (lmp->logfile) fflush(lmp->logfile);
}

void fail(LAMMPS *lmp, const std::string &message)
{
  // The std::string overload: no fmt types among our symbols, and no fmt in the message.
  try {
    lmp->error->all(FLERR, printable(message));
  } catch (...) {
    flush_output(lmp);
    throw;
  }
  abort();    // error->all does not return
}

void fail_one(LAMMPS *lmp, const std::string &message)
{
  // LAMMPS ends by MPI_Abort. What another rank than 0 prints goes through a pipe of mpirun, which may drop it as well:
  // mpirun gets time to read.
  try {
    lmp->error->one(FLERR, printable(message));
  } catch (...) {
    flush_output(lmp);
    if (lmp->comm->nprocs > 1) std::this_thread::sleep_for(std::chrono::milliseconds(300));
    throw;
  }
  abort();    // error->one does not return
}

void warn(LAMMPS *lmp, const std::string &message)
{
  if (lmp->comm->me == 0) lmp->error->warning(FLERR, printable(message));
}

void Voice::fail(const std::string &what) const
{
  StokesDyn::fail(lmp, command + ": " + what);
}

void Voice::fail_one(const std::string &what) const
{
  StokesDyn::fail_one(lmp, command + ": " + what);
}

void Voice::warn(const std::string &what) const
{
  StokesDyn::warn(lmp, command + ": " + what);
}

Voice Voice::at_step() const
{
  return of("step " + std::to_string(lmp->update->ntimestep));
}

void Voice::tell(const std::string &what) const
{
  if (lmp->comm->me == 0) utils::logmesg(lmp, command + ": " + what + "\n");
}

std::string text(double value)
{
  char buffer[40];
  snprintf(buffer, sizeof(buffer), "%.6g", value);
  return buffer;
}

std::vector<std::string> words(int narg, char **arg)
{
  return std::vector<std::string>(arg, arg + narg);
}

bool is_number(const std::string &word, double &value)
{
  // strtod skips space and reads hexadecimal numbers
  if (word.empty() || isspace((unsigned char) word[0])) return false;
  if (word.find_first_of("xX") != std::string::npos) return false;
  char *end;
  const double v = strtod(word.c_str(), &end);
  if (*end != '\0') return false;
  value = v;
  return true;
}

Keywords::Keywords(LAMMPS *lmp, const std::string &command, const std::vector<std::string> &args,
                   size_t begin) :
    Voice(lmp, command), args(args), at(begin), first(begin)
{
}

Keywords &Keywords::positional(const std::string &name)
{
  key = name;
  first = at;
  return *this;
}

void Keywords::parse(std::initializer_list<Keyword> table)
{
  while (next()) {
    const auto entry = std::find_if(table.begin(), table.end(),
                                    [&](const Keyword &keyword) { return is(keyword.name); });
    if (entry == table.end()) {
      std::vector<std::string> names;
      for (const Keyword &keyword : table) names.push_back(keyword.name);
      unknown(names);
    }
    entry->read();
  }
}

bool Keywords::given(const std::string &name) const
{
  return std::find(seen.begin(), seen.end(), name) != seen.end();
}

void Keywords::require(bool condition, const std::string &rule) const
{
  if (!condition) fail(rule);
}

bool Keywords::next()
{
  if (!more()) return false;
  key = args[at++];
  first = at;
  if (given(key)) refuse("given twice");
  seen.push_back(key);
  return true;
}

bool Keywords::take(const std::string &option)
{
  if (!more() || peek() != option) return false;
  at++;
  return true;
}

Keywords &Keywords::value(const std::string &name)
{
  next_value = name;
  return *this;
}

std::string Keywords::word()
{
  const std::string name = std::exchange(next_value, "");
  if (at >= args.size()) {
    const std::string which = !name.empty() ? ": " + name : at > first ? " after '" + args[at - 1] + "'" : "";
    refuse("value missing" + which);
  }
  if (args[at].empty()) refuse("'' is empty");
  return args[at++];
}

double Keywords::number()
{
  const std::string w = word();
  double value = 0.0;
  check(is_number(w, value), "is not a number");
  check(std::isfinite(value), "is not a finite number");
  return value;
}

double Keywords::positive()
{
  const double value = number();
  check(value > 0.0, "must be > 0");
  return value;
}

double Keywords::not_negative()
{
  const double value = number();
  check(value >= 0.0, "must be >= 0");
  return value;
}

bigint Keywords::integer(bigint lowest, bigint highest)
{
  const std::string w = word();
  char *end;
  errno = 0;
  const long long value = strtoll(w.c_str(), &end, 10);    // which skips space
  check(!isspace((unsigned char) w[0]) && *end == '\0', "is not an integer");
  const bool clipped = errno == ERANGE;    // then value is the lowest or the highest there is
  check(value >= lowest && !(clipped && value < 0), "must be >= " + std::to_string(lowest));
  check(value <= highest && !clipped, "must be <= " + std::to_string(highest));
  return value;
}

bool Keywords::yes_no()
{
  return choice({"no", "yes"}) == 1;
}

size_t Keywords::choice(std::initializer_list<const char *> options)
{
  const std::string w = word();
  std::string list;
  size_t i = 0;
  for (const char *option : options) {
    if (w == option) return i;
    list += (i++ ? ", " : "") + std::string(option);
  }
  refuse("'" + w + "' is none of: " + list);
}

void Keywords::check(bool condition, const std::string &rule) const
{
  if (!condition) refuse("'" + args[at - 1] + "' " + rule);
}

Keywords &Keywords::elsewhere(const std::string &names, const std::string &command)
{
  others.emplace_back(" " + names + " ", command);
  return *this;
}

void Keywords::unknown(const std::vector<std::string> &names) const
{
  for (const auto &other : others)
    if (other.first.find(" " + key + " ") != std::string::npos)
      fail("unknown keyword '" + key + "': it is a keyword of " + other.second);
  // most often a value too many
  const std::string after = seen.size() < 2
      ? ""
      : ": keyword " + seen[seen.size() - 2] + " before it has all of its values";
  std::string there;
  for (const std::string &name : names) there += (there.empty() ? "" : ", ") + name;
  fail("unknown keyword '" + key + "'" + after +
       (there.empty() ? "; nothing may follow here" : "; those that there are: " + there));
}

void Keywords::refuse(const std::string &why) const
{
  fail("keyword " + key + ": " + why);
}

}    // namespace StokesDyn
