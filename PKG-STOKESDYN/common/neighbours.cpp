#include "neighbours.h"

#include "fixes.h"
#include "lammps_compat.h"
#include "ranks.h"

#include "atom.h"
#include "bond.h"
#include "compute.h"
#include "fix.h"
#include "force.h"
#include "group.h"
#include "modify.h"
#include "neighbor.h"
#include "pair.h"
#include "update.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <sstream>

using namespace LAMMPS_NS;

namespace StokesDyn {

// --- names ---------------------------------------------------------------------------------------

static bool fits_one(const char *pattern, const char *name)
{
  if (*pattern == '*') {
    for (const char *rest = name;; rest++) {
      if (fits_one(pattern + 1, rest)) return true;
      if (*rest == '\0') return false;
    }
  }
  return *pattern == *name && (*pattern == '\0' || fits_one(pattern + 1, name + 1));
}

static std::vector<std::string> words_of(const std::string &styles)
{
  std::istringstream in(styles);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

bool fits(const std::string &styles, const std::string &style)
{
  for (const std::string &word : words_of(styles))
    if (fits_one(word.c_str(), style.c_str())) return true;
  return false;
}

bool stands_behind(const Guest &guest, const char *style)
{
  const Modify *modify = guest.lmp->modify;
  for (int k = 0; k < modify->nfix && modify->fix[k] != guest.fix; k++)
    if (fits(style, modify->fix[k]->style)) return true;
  return false;
}

tagint first_moved(LAMMPS *lmp, const std::string &styles, const std::function<bool(int)> &takes_part)
{
  int moved = 0, given = 0;
  for (int k = 0; k < lmp->modify->nfix; k++) {
    const Fix *fix = lmp->modify->fix[k];
    if (fits(styles, plain_style(fix->style))) given |= fix->groupbit;
    else if (fix->time_integrate) moved |= fix->groupbit;
  }
  const int *mask = lmp->atom->mask;
  return first_atom(lmp, [&](int i) { return (mask[i] & moved) && !(mask[i] & given) && takes_part(i); });
}

bool runs_back(const Guest &guest, std::string &says)
{
  says = text(guest.lmp->update->dt);
  return guest.lmp->update->dt < 0.0;
}

bool leaves_out(const Guest &guest, std::string &says)
{
  const int include = guest.lmp->neighbor->includegroup;
  const int bit = guest.lmp->group->bitmask[include], *mask = guest.lmp->atom->mask;
  const tagint first = first_atom(guest.lmp, [&](int i) { return guest.ours(i) && !(mask[i] & bit); });
  says = std::string("include ") + guest.lmp->group->names[include] + ", which leaves out atom " + std::to_string(first);
  return include && first;
}

bool has_bath(const Guest &guest, std::string & /*says*/)
{
  return guest.fix->setmask() & FixConst::POST_FORCE;
}

// --- who is there --------------------------------------------------------------------------------

/* Those of the kind that the row names; of pair and bond styles a hybrid itself, then those below it */
static std::vector<Guest> guests_of(LAMMPS *lmp, const Neighbour &row)
{
  std::vector<Guest> found;
  const auto add = [&](const std::string &style, const std::string &name, const auto &put) {
    if (!fits(row.styles, plain_style(style))) return;
    found.push_back({lmp, plain_style(style), name});
    put(found.back());
  };
  const Modify *modify = lmp->modify;
  for (int i = 0; i < modify->nfix && row.kind == Neighbour::FIX; i++) {
    Fix *fix = modify->fix[i];
    add(fix->style, name_of(fix), [=](Guest &guest) { guest.fix = fix; });
  }
  for (int i = 0; i < modify->ncompute && row.kind == Neighbour::COMPUTE; i++) {
    Compute *compute = modify->compute[i];
    add(compute->style, "compute " + std::string(compute->id) + " of style " + compute->style,
        [=](Guest &guest) { guest.compute = compute; });
  }
  if (row.kind == Neighbour::PAIR)
    for (const auto &each : Compat::pair_styles(lmp->force))
      add(each.first, "pair_style " + each.first, [&](Guest &guest) { guest.pair = each.second; });
  if (row.kind == Neighbour::BOND)
    for (const auto &each : Compat::bond_styles(lmp->force))
      add(each.first, "bond_style " + each.first, [&](Guest &guest) { guest.bond = each.second; });
  if (row.kind == Neighbour::COMMAND) add(row.styles, row.styles, [](Guest &) {});
  if (row.kind == Neighbour::ATOM)
    for (const std::string &style : words_of(row.styles))
      if (lmp->atom->style_match(style.c_str())) add(style, "atom_style " + style, [](Guest &) {});
  return found;
}

// --- does it act on atoms of ours? ---------------------------------------------------------------

/* In each place that is set on any rank */
static void gather(const LAMMPS *lmp, std::vector<int> &set)
{
  std::vector<int> mine = set;
  MPI_Allreduce(mine.data(), set.data(), (int) set.size(), MPI_INT, MPI_MAX, lmp->world);
}

/* Which types of atoms there are, and which of ours: [2 (n + 1)] */
static std::vector<int> types_there(const Guest &guest)
{
  const Atom *atom = guest.lmp->atom;
  std::vector<int> there(2 * ((size_t) atom->ntypes + 1), 0);
  for (int i = 0; i < atom->nlocal; i++) {
    there[atom->type[i]] = 1;
    if (guest.ours(i)) there[atom->ntypes + 1 + atom->type[i]] = 1;
  }
  gather(guest.lmp, there);
  return there;
}

/* Do types i <= j meet through this pair style, one of them of ours? */
static bool meet(const Guest &guest, const std::vector<int> &there, int i, int j)
{
  const int *ours = &there[guest.lmp->atom->ntypes + 1];
  int **set = guest.pair->setflag;
  return (!set || set[i][j]) && there[i] && there[j] && (ours[i] || ours[j]);
}

/* Which types of bonds of this style bind one of ours: [nbondtypes + 1]. Who is at the other end of
 * a bond is known where that atom is on the same rank. */
static std::vector<int> bonds_there(const Guest &guest)
{
  Atom *atom = guest.lmp->atom;
  const int *set = guest.bond->setflag;
  std::vector<int> there((size_t) atom->nbondtypes + 1, 0);
  for (int i = 0; i < atom->nlocal; i++) {
    const bool ours = guest.ours(i);
    if (atom->molecular != Atom::MOLECULAR) {    // bonds of templates
      if (ours) there.assign(there.size(), 1);
      continue;
    }
    for (int m = 0; m < atom->num_bond[i]; m++) {
      const int type = abs(atom->bond_type[i][m]);
      const int other = atom->map_style ? atom->map(atom->bond_atom[i][m]) : -1;
      if (type >= 1 && type <= atom->nbondtypes && (!set || set[type]) &&
          (ours || (other >= 0 && other < atom->nlocal && guest.ours(other))))
        there[type] = 1;
    }
  }
  gather(guest.lmp, there);
  return there;
}

static bool acts_by_types(const Guest &guest)
{
  const std::vector<int> there = types_there(guest);
  for (int i = 1; i <= guest.lmp->atom->ntypes; i++)
    for (int j = i; j <= guest.lmp->atom->ntypes; j++)
      if (meet(guest, there, i, j)) return true;
  return false;
}

static bool acts(const Guest &guest)
{
  const int *mask = guest.lmp->atom->mask;
  if (guest.pair) return acts_by_types(guest);
  if (guest.bond) {
    const std::vector<int> there = bonds_there(guest);
    return std::count(there.begin(), there.end(), 1) > 0;
  }
  const int bit = guest.fix ? guest.fix->groupbit : ~0;
  return first_atom(guest.lmp, [&](int i) { return (mask[i] & bit) && guest.ours(i); }) != 0;
}

// --- the walker ----------------------------------------------------------------------------------

static std::string filled(const std::string &text, const std::string &with)
{
  const size_t hole = text.find("{}");
  return hole == std::string::npos ? text : text.substr(0, hole) + with + text.substr(hole + 2);
}

void Neighbourhood::look(const Voice &voice, const std::vector<Neighbour> &table, unsigned facts,
                         const std::function<unsigned(int)> &sort, const Fix *self)
{
  for (const Neighbour &row : table) {
    if (row.verdict == Neighbour::FINE || (facts & row.where) != row.where) continue;
    for (Guest &guest : guests_of(voice.lmp, row)) {
      std::string says;
      if (self && guest.fix == self) continue;
      guest.ours = [&](int i) { return (sort(i) & row.sorts) != 0; };
      if (row.sorts != Neighbour::ANYWHERE && !acts(guest)) continue;
      if (row.matters && !row.matters(guest, says)) continue;
      const std::string message = guest.name + " " + filled(row.why, says);
      if (row.verdict == Neighbour::ERROR) voice.fail(message);
      if (warned.insert(message).second) voice.warn(message);
    }
  }
}

// --- coefficients --------------------------------------------------------------------------------

std::vector<std::vector<double>> coefficients(const Guest &guest)
{
  std::vector<std::vector<double>> lines;
  const std::vector<int> there = guest.pair ? types_there(guest) : bonds_there(guest);
  std::unique_ptr<FILE, int (*)(FILE *)> file(tmpfile(), fclose);
  if (!file) return lines;
  if (guest.pair) guest.pair->write_data_all(file.get());
  if (guest.bond) guest.bond->write_data(file.get());
  rewind(file.get());
  char line[1000];
  while (fgets(line, sizeof(line), file.get())) {
    std::istringstream in(line);
    std::vector<double> numbers;
    for (double number; in >> number;) numbers.push_back(number);
    if (numbers.size() < 2) continue;
    const int i = (int) numbers[0], j = (int) numbers[1];
    if (guest.pair ? meet(guest, there, i, j) : there[i]) lines.push_back(numbers);
  }
  return lines;
}

}    // namespace StokesDyn
