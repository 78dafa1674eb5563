#include "gravity.h"

#include "fixes.h"
#include "ranks.h"

#include "update.h"

#include <algorithm>
#include <array>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

using Acceleration = std::array<double, 3>;

/* False: nobody knows, or not all are pulled alike. */
static bool is_pulled(LAMMPS *lmp, const std::function<bool(int)> &ours, Acceleration &a)
{
  const auto some = [&](int bits, bool in) {
    return first_atom(lmp, [&](int i) { return ours(i) && ((lmp->atom->mask[i] & bits) != 0) == in; }) != 0;
  };
  bool found = false;
  a.fill(0.0);
  for (auto *fix : fixes_of(lmp, "gravity")) {
    if (!some(fix->groupbit, true)) continue;
    if (some(fix->groupbit, false)) return false;
    int dim;
    const auto *g = (const double *) fix->extract("gvec", dim);
    for (int d = 0; d < 3; d++) a[d] += g[d];
    found = true;
  }
  return found && fixes_of(lmp, "addforce").empty();
}

void compare_gravity(const Voice &voice, const double told[3], const std::function<bool(int)> &ours,
                     const Pulled &pulled)
{
  const Update *update = voice.lmp->update;
  Acceleration a;
  if (update->setupflag || update->ntimestep != update->firststep + 1 || !is_pulled(voice.lmp, ours, a)) return;
  const double g = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  bool same = true;
  std::string mine, theirs;
  for (int d = 0; d < 3; d++) {
    // digits that were left out are none of another slope
    same = same && fabs(told[d] - a[d]) <= 5e-4 * g + 0.02 * std::max(fabs(told[d]), fabs(a[d]));
    mine += " " + text(told[d]);
    theirs += " " + text(a[d]);
  }
  if (!same)
    voice.warn("keyword gravity has the numbers" + mine + ", and fix gravity pulls the " + pulled.whom + " with" +
               theirs + ": " + pulled.wrong);
}

}    // namespace StokesDyn
