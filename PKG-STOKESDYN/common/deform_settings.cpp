#include "deform_settings.h"

#include "fixes.h"
#include "keywords.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <vector>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* The settings as restart files have them: the number of bytes, and the bytes. Only the first rank
 * writes. */
static std::vector<char> saved_by(Fix *fix)
{
  char *bytes = nullptr;
  size_t length = 0;
  FILE *memory = open_memstream(&bytes, &length);
  if (!memory) throw std::bad_alloc();
  fix->write_restart(memory);
  fclose(memory);
  const std::vector<char> all(bytes, bytes + length);
  free(bytes);
  return all;
}

void DeformSettings::check(LAMMPS *lmp, Fix *fix)
{
  const auto *deform = static_cast<FixDeform *>(fix);
  const size_t size = 6 * sizeof(Set);
  bool known = deform->*&DeformSettings::h_rate == lmp->domain->h_rate &&
      deform->*&DeformSettings::h_ratelo == lmp->domain->h_ratelo;
  const std::vector<char> saved = saved_by(fix);
  if (known && !saved.empty())
    known = saved.size() == sizeof(int) + size && memcmp(&saved[sizeof(int)], of(fix), size) == 0;
  if (!known)
    StokesDyn::fail_one(lmp,
                        name_of(fix) + " keeps its settings in another way than that of LAMMPS "
                        SD_LAMMPS_VERSION ": build this plugin from the source of this LAMMPS "
                        "(-D LAMMPS_SOURCE_DIR=DIR)");
}

}    // namespace StokesDyn
