#include "lost_pairs.h"

#include "pair_sph_artvisc_tenscorr.h"
#include "ranks.h"

#include "atom.h"
#include "comm.h"
#include "force.h"
#include "group.h"
#include "neigh_list.h"
#include "neighbor.h"

using namespace LAMMPS_NS;

namespace StokesDyn {

using Set = std::function<bool(int)>;

static const PairSph *style_of(const Guest &guest)
{
  return static_cast<const PairSph *>(guest.lmp->force->pair_match(Sph::PAIR_STYLE, 1));
}

/* May it lose those of its own kind? */
static bool stands_alone(const PairSph *pair, int i)
{
  return pair->is_of_wall(i) || pair->rests_alone(i);
}

/* The first of ours in a set but for this one, 0: there is none; flows: one that needs its own kind */
static tagint first_of(const Guest &guest, const Set &set, bool flows, tagint but = 0)
{
  const PairSph *pair = style_of(guest);
  const tagint *tag = guest.lmp->atom->tag;
  return first_atom(guest.lmp, [&](int i) {
    return pair->is_particle(i) && set(i) && tag[i] != but && !(flows && stands_alone(pair, i));
  });
}

/* Is there a pair between two sets that counts? says: its atoms */
static bool are_kept_apart(const Guest &guest, const Set &one, const Set &other, std::string &says)
{
  tagint a = first_of(guest, one, true), b = first_of(guest, other, false, a);
  if (!a || !b) {
    a = first_of(guest, other, true);
    b = first_of(guest, one, false, a);
  }
  if (a && b) says = ", so that atoms " + std::to_string(a) + " and " + std::to_string(b) + " would not see each other";
  return a && b;
}

static Set of_type(const Guest &guest, int type)
{
  const int *types = guest.lmp->atom->type;
  return [=](int i) { return types[i] == type; };
}

static Set of_group(const Guest &guest, int group, bool within = true)
{
  const int *mask = guest.lmp->atom->mask, bit = guest.lmp->group->bitmask[group];
  return [=](int i) { return ((mask[i] & bit) != 0) == within; };
}

static std::string named(const Guest &guest, int group)
{
  return guest.lmp->group->names[group];
}

static bool excludes_types(const Guest &guest, std::string &says)
{
  const Neighbor *list = guest.lmp->neighbor;
  for (int k = 0; k < list->nex_type; k++) {
    const int one = list->ex1_type[k], other = list->ex2_type[k];
    if (!are_kept_apart(guest, of_type(guest, one), of_type(guest, other), says)) continue;
    says = "exclude type " + std::to_string(one) + " " + std::to_string(other) + says;
    return true;
  }
  return false;
}

static bool excludes_groups(const Guest &guest, std::string &says)
{
  const Neighbor *list = guest.lmp->neighbor;
  for (int k = 0; k < list->nex_group; k++) {
    const int one = list->ex1_group[k], other = list->ex2_group[k];
    if (!are_kept_apart(guest, of_group(guest, one), of_group(guest, other), says)) continue;
    says = "exclude group " + named(guest, one) + " " + named(guest, other) + says;
    return true;
  }
  return false;
}

/* Water without molecule IDs is one molecule, 0. IDs are not compared: what would lose no pair, since each particle
 * has an ID of its own, is refused as well. */
static bool excludes_molecules(const Guest &guest, std::string &says)
{
  const Neighbor *list = guest.lmp->neighbor;
  for (int k = 0; k < list->nex_mol; k++) {
    const Set members = of_group(guest, list->ex_mol_group[k]);
    if (!are_kept_apart(guest, members, members, says)) continue;
    says = std::string("exclude molecule") + (list->ex_mol_intra[k] ? "/intra " : "/inter ") +
        named(guest, list->ex_mol_group[k]) + says;
    return true;
  }
  return false;
}

bool loses_by_exclude(const Guest &guest, std::string &says)
{
  return excludes_types(guest, says) || excludes_groups(guest, says) || excludes_molecules(guest, says);
}

static const Set ANYBODY = [](int) { return true; };

bool loses_by_include(const Guest &guest, std::string &says)
{
  const int group = guest.lmp->neighbor->includegroup;
  if (!group || !are_kept_apart(guest, of_group(guest, group, false), ANYBODY, says)) return false;
  says = "include " + named(guest, group) + says;
  return true;
}

bool loses_ghosts(const Guest &guest, std::string &says)
{
  struct Borders : Comm {
    static int group_of(const Comm *comm) { return comm->*&Borders::bordergroup; }
  };
  const int group = Borders::group_of(guest.lmp->comm);
  if (!group || !are_kept_apart(guest, of_group(guest, group, false), ANYBODY, says)) return false;
  says = "group " + named(guest, group) + says + " across ranks and periodic faces";
  return true;
}

bool loses_by_bonds(const Guest &guest, std::string &says)
{
  const Atom *atom = guest.lmp->atom;
  const int *kept = guest.lmp->neighbor->special_flag;
  if (atom->molecular != Atom::MOLECULAR) return false;
  const Set bound = [=](int i) {
    int before = 0;
    for (int k = 1; k <= 3; before = atom->nspecial[i][k - 1], k++)
      if (kept[k] == 0 && atom->nspecial[i][k - 1] > before) return true;
    return false;
  };
  const tagint first = first_of(guest, bound, true);
  if (first) says = "atom " + std::to_string(first);
  return first != 0;
}

bool loses_by_types(const Guest &guest, std::string &says)
{
  const NeighList *list = style_of(guest)->list;
  if (!list || !list->ijskip) return false;
  for (int i = 1; i <= guest.lmp->atom->ntypes; i++)
    for (int j = i; j <= guest.lmp->atom->ntypes; j++) {
      if (!list->ijskip[i][j] || !are_kept_apart(guest, of_type(guest, i), of_type(guest, j), says)) continue;
      says = "types " + std::to_string(i) + " and " + std::to_string(j) + says;
      return true;
    }
  return false;
}

}    // namespace StokesDyn
