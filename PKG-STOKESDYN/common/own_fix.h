/* A fix that a style makes for itself, under an ID that users leave to it. */
#ifndef SD_OWN_FIX_H
#define SD_OWN_FIX_H

#include "keywords.h"

namespace LAMMPS_NS {
class Fix;
}

namespace StokesDyn {

class OwnFix {
 public:
  /* of: the style that needs it, which errors name */
  OwnFix(const Voice &of, const std::string &id, const char *style) : id(id), voice(of), style(style) {}
  const std::string id;

  /* nullptr: there is none. Error: a fix of the user's has this ID. */
  LAMMPS_NS::Fix *find() const;
  /* Anew, behind all other fixes, with these words behind its style. Error: as above */
  LAMMPS_NS::Fix *make(const std::string &words = "", const std::string &group = "all") const;
  /* If it is there; that of a user stays. For destructors: no error */
  void take_away() const;

 private:
  const Voice voice;
  const char *const style;
};

}    // namespace StokesDyn
#endif
