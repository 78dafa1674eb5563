#include "own_fix.h"

#include "lammps_compat.h"

#include "fix.h"
#include "modify.h"

using namespace LAMMPS_NS;

namespace StokesDyn {

Fix *OwnFix::find() const
{
  Fix *fix = Compat::fix(voice.lmp->modify, id);
  if (fix && std::string(style) != fix->style)
    voice.fail("the fix ID " + id + " is taken by a fix of style " + fix->style +
               ", and this style needs it for itself; give that fix another ID");
  return fix;
}

Fix *OwnFix::make(const std::string &words, const std::string &group) const
{
  Modify *modify = voice.lmp->modify;
  if (find()) modify->delete_fix(id);
  modify->add_fix(id + " " + group + " " + style + " " + words);
  return Compat::fix(modify, id);
}

void OwnFix::take_away() const
{
  Modify *modify = voice.lmp->modify;
  const Fix *fix = Compat::fix(modify, id);
  if (fix && std::string(style) == fix->style) modify->delete_fix(id);
}

}    // namespace StokesDyn
