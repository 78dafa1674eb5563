/* Of Brownian motion: what has a drift that its schemes leave out, or noise of its own or none. */
#include "noise.h"

#include "checks.h"
#include "fixes.h"
#include "fix_stokes_dynamics_overdamped.h"
#include "hydrodynamics.h"
#include "keywords.h"
#include "overdamped_checks.h"

#include "atom.h"
#include "domain.h"
#include "fix.h"
#include "force.h"

#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

static const std::string PAIR = " of pair_style stokes_dynamics";

/* Does the viscosity differ from place to place? */
static bool varies(const Ambient::Settings &fluid)
{
  return fluid.visc.is_atom_style() || fluid.grid_has_visc;
}

std::string Noise::drift(const Hydrodynamics &hydro, const std::string &holds) const
{
  const StokesSettings &s = hydro.settings;
  const Ambient::Settings &fluid = hydro.ambient.settings;
  if (domain->dimension == 2) return "dimension 2, which holds a coordinate";
  if (s.rigid.apart()) return "";
  if (s.shells.on()) return "keyword multiblob" + PAIR;
  if (s.lubrication.on) return "keyword lubrication" + PAIR;
  if (s.rigid.on) return "keyword rigid_clumps" + PAIR + " with clumps that feel each other";
  if (s.scene.wall.sign) return "keyword wall" + PAIR;
  if (varies(fluid)) return "keyword visc" + PAIR + ", which varies in space";
  return holds;
}

/* A mobility that has no root, or a drift that no scheme has */
static void refuse_settings(const Voice &keyword, const StokesSettings &s,
                            const Ambient::Settings &fluid)
{
  if (s.rigid.apart() && keyword.lmp->domain->dimension == 2)
    keyword.fail("keyword clumps_only" + PAIR + ": lone clumps in a plane have a drift: use "
                 "clumps_only no");
  if (s.rigid.apart() && varies(fluid))
    keyword.fail("keyword clumps_only" + PAIR + ": lone clumps in a viscosity that varies in space "
                 "have a drift: use clumps_only no, or a number for visc");
  if (s.scene.tensor == SD_TENSOR_OSEEN)
    keyword.fail("keyword tensor: 'oseen'" + PAIR + " may have negative mobilities, for which "
                 "there is no noise: use tensor rpy");
  if (s.scene.taper != SD_TAPER_NONE)
    keyword.fail("keyword taper" + PAIR + ": the mobility has a drift, which schemes leave out: "
                 "use cut_off_distance inf");
  if (std::isfinite(s.scene.cutoff) && !s.rigid.apart())
    keyword.fail("keyword cut_off_distance: '" + text(s.scene.cutoff) + "'" + PAIR +
                 ": the mobility has a drift, which schemes leave out: use inf");
}

void Noise::refuse(const Hydrodynamics &hydro, const Ways &ways) const
{
  const Voice keyword = voice.of("keyword temperature");
  refuse_settings(keyword, hydro.settings, hydro.ambient.settings);
  const std::string what = drift(hydro, ways.holds);
  if (!what.empty() && !ways.midpoint)
    keyword.fail(what + ": the mobility has a drift, which schemes ab2 and euler leave out: use "
                 "scheme midpoint");
  if (!atom->tag_enable)
    keyword.fail("the noise of an atom depends on its ID, and there are no IDs: atom_modify id "
                 "yes");
  if (ways.adapts)
    keyword.fail("averages over steps of unequal length are not averages over time: leave out "
                 "adapt");
  if (const Fix *fix = fix_like(lmp, "^dt/reset"))
    keyword.fail(name_of(fix) + " makes steps of unequal length, whose averages are not those of "
                 "time: take it away");
  for (const char *style : {"^viscous", "^langevin", "^brownian"})
    if (const Fix *fix = fix_like(lmp, style))
      keyword.fail(name_of(fix) + " has noise or a drag of its own: take it away");
  if (force->pair_match("^brownian", 0, 1))
    keyword.fail("pair_style brownian* has noise of its own: take it away");
  refuse_friction(keyword);
}

void Noise::init(Hydrodynamics &hydro, const Ways &ways)
{
  const Voice keyword = voice.of("keyword temperature");
  check_room_of_blas(voice);
  temperature.init(lmp, keyword.command);
  if (temperature.is_atom_style())
    keyword.fail("all atoms have one temperature: use an equal-style variable");
  refuse(hydro, ways);
  midpoint = ways.midpoint;
  hydro.scene.settings.positive = !midpoint;
}

}    // namespace StokesDyn
