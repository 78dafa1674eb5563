/* What the core calls must not throw: its frames are C. */
#ifndef SD_CALLBACK_H
#define SD_CALLBACK_H

#include "sd_status.h"

#include <new>

namespace StokesDyn {

/* The body of a function that the core calls. An exception ends there, as a status that the core
 * hands back to its caller;
 * LAMMPS has printed the text of its own by then. */
template <class Body> sd_status callback(const Body &body) noexcept
{
  try {
    return body();
  } catch (const std::bad_alloc &) {
    return SD_ENOMEMORY;
  } catch (...) {
    return SD_ECALLBACK;
  }
}

}    // namespace StokesDyn
#endif
