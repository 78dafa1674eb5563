/* Which commands of LAMMPS go with a style of ours, as data. Each model has a table of rows in its
 * room; at the beginning of a run it asks this one walker, which looks whether what a row names is
 * there and acts on atoms of ours. doc/howto_trouble.md shows the tables row by row. */
#ifndef SD_NEIGHBOURS_H
#define SD_NEIGHBOURS_H

#include "keywords.h"

#include <functional>
#include <set>
#include <string>
#include <vector>

namespace LAMMPS_NS {
class Bond;
class Compute;
class Fix;
class Pair;
}

namespace StokesDyn {

/* A command of LAMMPS that stands beside a style of ours; of the pointers one is set, none for an
 * atom style and a command. */
struct Guest {
  LAMMPS_NS::LAMMPS *lmp;
  /* without the ending of an accelerator package (plain_style) */
  std::string style;
  /* as messages name it: "fix ID of style STYLE", "pair_style STYLE" */
  std::string name;
  LAMMPS_NS::Fix *fix = nullptr;
  LAMMPS_NS::Pair *pair = nullptr;
  LAMMPS_NS::Bond *bond = nullptr;
  LAMMPS_NS::Compute *compute = nullptr;
  /* is owned atom i one of ours that the row speaks of? */
  std::function<bool(int)> ours = nullptr;
};

struct Neighbour {
  /* COMMAND: a setting that is always there, of which `matters` says what it does */
  enum Kind { FIX, PAIR, BOND, COMPUTE, ATOM, COMMAND };
  /* FINE: a row for the page, of what one might doubt */
  enum Verdict { FINE, WARNING, ERROR };
  enum : unsigned { ANYWHERE = 0 };

  Kind kind;
  /* names of styles, with blanks between them; * stands for any letters (but for ATOM) */
  const char *styles;
  /* bits that the room defines: all of them must be facts of this run; 0: always */
  unsigned where;
  Verdict verdict;
  /* what happens and the way out, behind the name of the guest; {}: what `matters` says */
  const char *why;
  /* of guests whose name alone does not tell; the same on all ranks. nullptr: always */
  bool (*matters)(const Guest &guest, std::string &says) = nullptr;
  /* bits that the room defines: the sorts of its atoms that count; ANYWHERE: it counts whatever it
   * acts on */
  unsigned sorts = ~0u;
};

/* The walker. Each warning is given once in the life of its owner. */
class Neighbourhood {
 public:
  /* Errors and warnings of the rows that hold: "<command of voice>: <name of the guest> <why>".
   * facts: bits of this run. sort(i): bits of owned atom i, 0: it is none of ours. A fix acts on
   * the atoms of its group, a pair style on those of the types of its pair_coeff, a bond style on
   * those that it binds, all others on all. self: a fix that is not looked at. On all ranks
   * together, when LAMMPS has initialised its pair styles (Fix::init, Pair::setup), or before for
   * rows that do not look at coefficients. */
  void look(const Voice &voice, const std::vector<Neighbour> &table, unsigned facts,
            const std::function<unsigned(int)> &sort, const LAMMPS_NS::Fix *self = nullptr);

 private:
  std::set<std::string> warned;
};

/* Does one of these names (Neighbour::styles) fit? */
bool fits(const std::string &styles, const std::string &style);

/* Does the guest, a fix, stand in the input behind one of this style? */
bool stands_behind(const Guest &guest, const char *style);

/* The lowest ID of the atoms that take part and that a fix integrates, but that are in the group of no fix of
 * these styles, which give them a motion or a force or hold them; 0: there is none. The same on all ranks. */
LAMMPS_NS::tagint first_moved(LAMMPS_NS::LAMMPS *lmp, const std::string &styles,
                              const std::function<bool(int)> &takes_part);

/* Is the time step below 0? says: what it is */
bool runs_back(const Guest &guest, std::string &says);

/* Does neigh_modify include leave out one of ours? LAMMPS does not set the forces of that one to 0 in a step.
 * says: the setting, and the lowest ID */
bool leaves_out(const Guest &guest, std::string &says);

/* Has fix rigid its keyword langevin? Only then it has something to do after forces. */
bool has_bath(const Guest &guest, std::string &says);

/* What this pair or bond style would write into data files, as far as it acts on atoms of ours:
 * lines of numbers, of a pair style i j and the coefficients of these types, of a bond style the
 * type and its coefficients; empty: it writes none. On all ranks together. */
std::vector<std::vector<double>> coefficients(const Guest &guest);

}    // namespace StokesDyn
#endif
