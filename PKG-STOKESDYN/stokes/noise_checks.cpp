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

static const std::string DRIFT =
    ": its mobility has a drift, which schemes ab2 and euler leave out: ";

/* Of the pair style: a divergence of the mobility, or no noise that is known */
static void refuse_settings(LAMMPS *lmp, const std::string &keyword, const StokesSettings &s)
{
  const std::string pair = " of pair_style stokes_dynamics";
  if (s.shells.on())
    fail(lmp, keyword + "keyword multiblob" + pair + DRIFT + "leave it out");
  if (s.lubrication.on)
    fail(lmp, keyword + "keyword lubrication" + pair + DRIFT + "use lubrication no");
  if (s.rigid.on && !s.rigid.apart())
    fail(lmp, keyword + "keyword rigid_clumps" + pair + " with clumps that feel each other" + DRIFT +
                  "use clumps_only yes");
  if (s.scene.tensor == SD_TENSOR_OSEEN)
    fail(lmp, keyword + "keyword tensor: 'oseen'" + pair +
                  " has negative mobilities, and no noise: use tensor rpy");
  if (s.scene.taper != SD_TAPER_NONE)
    fail(lmp, keyword + "keyword taper" + pair + DRIFT + "use cut_off_distance inf");
  if (std::isfinite(s.scene.cutoff) && !s.rigid.apart())
    fail(lmp, keyword + "keyword cut_off_distance: '" + text(s.scene.cutoff) + "'" + pair + DRIFT +
                  "use inf");
  if (s.ambient.visc.is_atom_style() || s.ambient.grid_has_visc)
    fail(lmp, keyword + "keyword visc" + pair + ", which varies in space" + DRIFT +
                  "use one viscosity for all");
}

void Noise::refuse(const Hydrodynamics &hydro, const Fix *self, bool adapts, bool holds) const
{
  const std::string keyword = command + ": keyword temperature: ";
  refuse_settings(lmp, keyword, hydro.settings);
  if (!atom->tag_enable)
    fail(lmp, keyword + "the noise of an atom goes by its ID, and there are none: atom_modify id yes");
  if (domain->dimension == 2)
    fail(lmp, keyword + "dimension 2" + DRIFT + "use three dimensions");
  if (adapts)
    fail(lmp, keyword + "averages over steps of unequal length are not those of time: leave adapt out");
  if (holds) fail(lmp, keyword + "keyword held" + DRIFT + "leave it out");
  for (int i = 0; i < modify->nfix; i++) {
    const Fix *fix = modify->fix[i];
    if (fix == self) continue;
    const std::string name = "fix " + std::string(fix->id) + " of style " + fix->style;
    if (utils::strmatch(fix->style, "^dt/reset"))
      fail(lmp, keyword + name +
                    " makes steps of unequal length, whose averages are not those of time: take it "
                    "away");
    if (utils::strmatch(fix->style, "^enforce2d"))
      fail(lmp, keyword + name + " holds coordinates" + DRIFT + "take it away");
    for (const char *style : {"^viscous", "^langevin", "^brownian"})
      if (utils::strmatch(fix->style, style))
        fail(lmp, keyword + name + " has noise or a drag of its own: take it away");
  }
  if (force->pair_match("^brownian", 0, 1))
    fail(lmp, keyword + "pair_style brownian* has noise of its own: take it away");
  refuse_friction(lmp, keyword);
}

void Noise::init(Hydrodynamics &hydro, const Fix *self, bool adapts, bool holds)
{
  const std::string keyword = command + ": keyword temperature";
  check_room_of_blas(lmp, command);
  temperature.init(lmp, keyword);
  if (temperature.is_atom_style())
    fail(lmp, keyword + ": an atom-style variable: noise has one temperature, use an equal-style one");
  refuse(hydro, self, adapts, holds);
  hydro.scene.settings.positive = true;
}

}    // namespace StokesDyn
