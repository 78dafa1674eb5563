/* Of Brownian motion: what has a drift that its schemes leave out, or noise of its own or none. */
#include "noise.h"

#include "checks.h"
#include "fix_stokes_dynamics_overdamped.h"
#include "hydrodynamics.h"
#include "keywords.h"
#include "overdamped_checks.h"

#include "atom.h"
#include "domain.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "pair.h"
#include "utils.h"

#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* what: a setting or a command; way: out */
[[noreturn]] static void drifts(LAMMPS *lmp, const std::string &keyword, const std::string &what,
                                const std::string &way)
{
  fail(lmp, keyword + what +
                ": the mobility has a drift, which schemes ab2 and euler leave out: " + way);
}

/* Of the pair style: a divergence of the mobility, or no noise that is known */
static void refuse_settings(LAMMPS *lmp, const std::string &keyword, const StokesSettings &s,
                            const Ambient::Settings &fluid, bool midpoint)
{
  const std::string pair = " of pair_style stokes_dynamics";
  if (s.shells.on()) drifts(lmp, keyword, "keyword multiblob" + pair, "leave it out");
  if (s.lubrication.on) drifts(lmp, keyword, "keyword lubrication" + pair, "use lubrication no");
  if (s.rigid.on && !s.rigid.apart() && !midpoint)
    drifts(lmp, keyword, "keyword rigid_clumps" + pair + " with clumps that feel each other",
           "use scheme midpoint or clumps_only yes");
  if (s.rigid.on && !s.rigid.apart() && s.rigid.shell > 1)
    fail(lmp, keyword + "keyword shell" + pair +
                  ": clumps with shells that feel each other have no noise: use rotation yes "
                  "without a shell");
  if (s.scene.wall.sign && !midpoint)
    drifts(lmp, keyword, "keyword wall" + pair, "use scheme midpoint");
  if (s.scene.tensor == SD_TENSOR_OSEEN)
    fail(lmp, keyword + "keyword tensor: 'oseen'" + pair +
                  " has negative mobilities, and no noise: use tensor rpy");
  if (s.scene.taper != SD_TAPER_NONE)
    drifts(lmp, keyword, "keyword taper" + pair, "use cut_off_distance inf");
  if (std::isfinite(s.scene.cutoff) && !s.rigid.apart())
    drifts(lmp, keyword, "keyword cut_off_distance: '" + text(s.scene.cutoff) + "'" + pair,
           "use inf");
  if ((fluid.visc.is_atom_style() || fluid.grid_has_visc) && !midpoint)
    drifts(lmp, keyword, "keyword visc" + pair + ", which varies in space",
           "use scheme midpoint or one viscosity for all");
}

void Noise::refuse(const Hydrodynamics &hydro, const Fix *self, const Ways &ways) const
{
  const std::string keyword = command + ": keyword temperature: ";
  refuse_settings(lmp, keyword, hydro.settings, hydro.ambient.settings, ways.midpoint);
  if (!atom->tag_enable)
    fail(lmp, keyword + "the noise of an atom goes by its ID, and there are none: atom_modify id yes");
  if (domain->dimension == 2 && !ways.midpoint)
    drifts(lmp, keyword, "dimension 2, which holds a coordinate", "use scheme midpoint");
  if (ways.adapts)
    fail(lmp, keyword + "averages over steps of unequal length are not those of time: leave adapt out");
  if (ways.holds) drifts(lmp, keyword, "keyword held", "leave it out");
  for (int i = 0; i < modify->nfix; i++) {
    const Fix *fix = modify->fix[i];
    if (fix == self) continue;
    const std::string name = "fix " + std::string(fix->id) + " of style " + fix->style;
    if (utils::strmatch(fix->style, "^dt/reset"))
      fail(lmp, keyword + name +
                    " makes steps of unequal length, whose averages are not those of time: take it "
                    "away");
    for (const char *style : {"^viscous", "^langevin", "^brownian"})
      if (utils::strmatch(fix->style, style))
        fail(lmp, keyword + name + " has noise or a drag of its own: take it away");
  }
  if (force->pair_match("^brownian", 0, 1))
    fail(lmp, keyword + "pair_style brownian* has noise of its own: take it away");
  refuse_friction(lmp, keyword);
}

void Noise::init(Hydrodynamics &hydro, const Fix *self, const Ways &ways)
{
  const std::string keyword = command + ": keyword temperature";
  check_room_of_blas(lmp, command);
  temperature.init(lmp, keyword);
  if (temperature.is_atom_style())
    fail(lmp, keyword + ": noise has one temperature: use an equal-style variable");
  refuse(hydro, self, ways);
  hydro.scene.settings.positive = !ways.midpoint;
}

}    // namespace StokesDyn
