/* The fixes of a scene by their style. */
#ifndef SD_FIXES_H
#define SD_FIXES_H

#include "fix.h"
#include "lammps.h"
#include "modify.h"
#include "utils.h"

#include <cstring>
#include <string>
#include <vector>

namespace StokesDyn {

/* "fix ID of style STYLE", as errors name it */
inline std::string name_of(const LAMMPS_NS::Fix *fix)
{
  return "fix " + std::string(fix->id) + " of style " + fix->style;
}

/* A style of LAMMPS without the ending of a package that runs it faster: gravity of gravity/omp */
inline std::string plain_style(const std::string &style)
{
  for (const char *ending : {"/kk/device", "/kk/host", "/kk", "/gpu", "/intel", "/omp", "/opt"})
    if (style.size() > strlen(ending) && style.substr(style.size() - strlen(ending)) == ending)
      return style.substr(0, style.size() - strlen(ending));
  return style;
}

/* All whose style this pattern matches (utils::strmatch), in the order of the input */
inline std::vector<LAMMPS_NS::Fix *> fixes_like(LAMMPS_NS::LAMMPS *lmp, const std::string &pattern)
{
  std::vector<LAMMPS_NS::Fix *> found;
  for (int i = 0; i < lmp->modify->nfix; i++)
    if (LAMMPS_NS::utils::strmatch(lmp->modify->fix[i]->style, pattern)) found.push_back(lmp->modify->fix[i]);
  return found;
}

/* The first of them, nullptr: there is none */
inline LAMMPS_NS::Fix *fix_like(LAMMPS_NS::LAMMPS *lmp, const std::string &pattern)
{
  const auto found = fixes_like(lmp, pattern);
  return found.empty() ? nullptr : found.front();
}

/* All of this plain style, in the order of the input. */
inline std::vector<LAMMPS_NS::Fix *> fixes_of(LAMMPS_NS::LAMMPS *lmp, const std::string &style)
{
  std::vector<LAMMPS_NS::Fix *> found;
  for (int i = 0; i < lmp->modify->nfix; i++)
    if (style == plain_style(lmp->modify->fix[i]->style)) found.push_back(lmp->modify->fix[i]);
  return found;
}

template <class Style> std::vector<Style *> fixes_of(LAMMPS_NS::LAMMPS *lmp)
{
  std::vector<Style *> found;
  for (auto *fix : fixes_of(lmp, Style::STYLE)) found.push_back(static_cast<Style *>(fix));
  return found;
}

/* Those that move atoms: all that integrate in time, but for atoms at rest */
inline std::vector<LAMMPS_NS::Fix *> movers_of(LAMMPS_NS::LAMMPS *lmp)
{
  std::vector<LAMMPS_NS::Fix *> found;
  for (int i = 0; i < lmp->modify->nfix; i++) {
    LAMMPS_NS::Fix *fix = lmp->modify->fix[i];
    if (fix->time_integrate && !strstr(fix->style, "stationary")) found.push_back(fix);
  }
  return found;
}

/* Of these, those that move each atom by the force on it: all but fix move and rigid bodies */
inline std::vector<LAMMPS_NS::Fix *> integrators_of(LAMMPS_NS::LAMMPS *lmp)
{
  std::vector<LAMMPS_NS::Fix *> found;
  for (auto *fix : movers_of(lmp))
    if (strcmp(fix->style, "move") != 0 && !strstr(fix->style, "rigid")) found.push_back(fix);
  return found;
}

/* Union of their group bits */
inline int groups_of(const std::vector<LAMMPS_NS::Fix *> &fixes)
{
  int bits = 0;
  for (const auto *fix : fixes) bits |= fix->groupbit;
  return bits;
}

}    // namespace StokesDyn
#endif
