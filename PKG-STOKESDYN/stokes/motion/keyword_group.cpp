#include "keyword_group.h"

#include "ranks.h"

#include "atom.h"
#include "group.h"

using namespace LAMMPS_NS;

namespace StokesDyn {

void KeywordGroup::find(const Voice &keyword)
{
  bit = 0;
  if (!on()) return;
  number = keyword.lmp->group->find(name);
  if (number < 0) keyword.fail("group '" + name + "' does not exist");
  bit = keyword.lmp->group->bitmask[number];
}

void KeywordGroup::require_moved(const Voice &keyword, int by_bit) const
{
  const int *mask = keyword.lmp->atom->mask;
  if (const tagint other = first_atom(keyword.lmp, [&](int i) {
        return (mask[i] & bit) && !(mask[i] & by_bit);
      }))
    keyword.fail("atom " + std::to_string(other) + " is not in the group of this fix, which does not "
                 "move it: give a group whose atoms are in both");
}

}    // namespace StokesDyn
