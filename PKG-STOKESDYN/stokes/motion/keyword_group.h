/* The group that a keyword names: of held, pin, spin, torque and squirm. */
#ifndef SD_KEYWORD_GROUP_H
#define SD_KEYWORD_GROUP_H

#include "keywords.h"

#include <string>

namespace StokesDyn {

struct KeywordGroup {
  /* empty: the keyword is not given, and nobody is in it */
  std::string name;
  /* of LAMMPS, since find() */
  int number = 0, bit = 0;

  bool on() const { return !name.empty(); }
  /* Before a run, and in each step, as a run with 'pre no' may find it deleted or made anew. Error: there is
   * no such group. keyword: who complains, "...: keyword NAME" */
  void find(const Voice &keyword);
  /* Error: an atom of it that is not in the group of the fix, which has this bit */
  void require_moved(const Voice &keyword, int by_bit) const;
};

}    // namespace StokesDyn
#endif
