/* Styles that are told gravity by a keyword: is it the one of fix gravity? */
#ifndef SD_GRAVITY_H
#define SD_GRAVITY_H

#include "keywords.h"

#include <functional>

namespace StokesDyn {

/* Warns in the first step of a run, when fix gravity has acted once, where it does not give all of these
 * atoms the acceleration that keyword gravity tells. whom: what they are, and what is wrong then. Silent
 * where no fix gravity acts on them, or one on some of them alone, and where fix addforce may do the rest.
 * All ranks, in every step. */
struct Pulled {
  const char *whom, *wrong;
};
void compare_gravity(const Voice &voice, const double told[3], const std::function<bool(int)> &ours,
                     const Pulled &pulled);

}    // namespace StokesDyn
#endif
