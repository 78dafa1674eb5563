/* Between the core and LAMMPS: exceptions become statuses, statuses errors, and objects of the core have
 * owners. What the core calls must not throw: its frames are C. */
#ifndef SD_CALLBACK_H
#define SD_CALLBACK_H

#include "keywords.h"

#include "sd_status.h"

#include <new>
#include <type_traits>

namespace StokesDyn {

/* An object of the core, zeros in the beginning, that frees what it holds when it goes */
template <class T, void (*release)(T *)> struct Owned : T {
  Owned() : T() {}
  ~Owned() { release(this); }
  Owned(const Owned &) = delete;
  Owned &operator=(const Owned &) = delete;
};

/* The body of a function that the core calls: SD_OK, or what it returns. An exception ends there, as
 * a status that the core hands back to its caller; LAMMPS has printed the text of its own by then. */
template <class Body> sd_status callback(const Body &body) noexcept
{
  try {
    if constexpr (!std::is_void_v<decltype(body())>) return body();
    body();
    return SD_OK;
  } catch (const std::bad_alloc &) {
    return SD_ENOMEMORY;
  } catch (...) {
    return SD_ECALLBACK;
  }
}

/* Ends the run for a status of the core. Memory and callbacks fail on one rank, while the others
 * wait for it; everything else is the same on all. */
[[noreturn]] inline void fail_by(const Voice &voice, sd_status status, const std::string &what)
{
  if (status == SD_ENOMEMORY || status == SD_ECALLBACK) voice.fail_one(what);
  voice.fail(what);
}
[[noreturn]] inline void fail_by(const Voice &voice, sd_status status)
{
  fail_by(voice, status, sd_status_string(status));
}
/* Right behind a function of the core in which ranks speak with each other: what this rank alone has
 * not ends the run before the others, who wait in there, are asked for anything else. */
inline void fail_if_alone(const Voice &voice, sd_status status)
{
  if (status == SD_ENOMEMORY || status == SD_ECALLBACK) fail_by(voice, status);
}

}    // namespace StokesDyn
#endif
