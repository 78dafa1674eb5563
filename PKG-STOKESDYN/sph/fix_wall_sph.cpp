#include "fix_wall_sph.h"

#include "keywords.h"
#include "lammps_compat.h"
#include "pair_sph_artvisc_tenscorr.h"
#include "sd_sph_wall.h"
#include "sph.h"

#include "atom.h"
#include "domain.h"
#include "force.h"
#include "pair.h"
#include "region.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

void FixRepulsiveWall::push(int i, const double normal[3], double r, double more)
{
  if (!(r > 0.0)) outside(i);
  const double size = sd_sph_repulsion(D, r0, r) + more;
  for (int d = 0; d < 3; d++) {
    atom->f[i][d] += size * normal[d];
    on_wall[d] -= size * normal[d];
  }
}

void FixRepulsiveWall::outside(int i)
{
  const double *x = atom->x[i];
  voice.at_step().fail_one("atom " + std::to_string(atom->tag[i]) + " at " + text(x[0]) + " " +
                           text(x[1]) + " " + text(x[2]) + " is on or behind the wall");
}

// --- planes and the cylinder --------------------------------------------------------------------

FixWallSph::FixWallSph(LAMMPS *lmp, int narg, char **arg) : FixRepulsiveWall(lmp, narg, arg)
{
  Keywords in = keywords(narg, arg);
  if (!in.next()) voice.fail("the wall is missing: xplane, yplane, zplane or zcylinder");
  if (in.is("zcylinder"))
    radius = in.value("R").positive();
  else if (in.is("xplane") || in.is("yplane") || in.is("zplane")) {
    axis = in.is("xplane") ? 0 : in.is("yplane") ? 1 : 2;
    for (int side = 0; side < 2; side++) {
      has[side] = !in.take("NULL");
      if (has[side]) at[side] = in.value(side ? "hi" : "lo").number();
    }
    if (!has[0] && !has[1]) in.refuse("both walls are NULL");
    if (has[0] && has[1] && !(at[0] < at[1]))
      in.refuse("lo " + text(at[0]) + " must be smaller than hi " + text(at[1]));
  } else
    in.unknown({"xplane", "yplane", "zplane", "zcylinder"});
  r0 = in.value("r0").positive();
  D = in.value("D").not_negative();
  in.parse({});
}

/* Particles must not walk round a wall, or see each other behind it. */
void FixWallSph::init()
{
  const std::string kind = axis < 0 ? "zcylinder" : std::string(1, "xyz"[axis]) + "plane";
  if (axis >= 0 && domain->periodicity[axis])
    voice.fail("keyword " + kind + ": the box is periodic in this direction; use 'boundary f' there");
  if (axis >= 0) return;
  const double apart = force->pair ? 0.5 * force->pair->cutforce : 0.0;
  for (int d = 0; d < 2; d++)
    if (domain->periodicity[d] &&
        (-radius - apart < domain->boxlo[d] || radius + apart > domain->boxhi[d]))
      voice.fail("keyword " + kind + ": radius " + text(radius) +
                 " reaches through the periodic boundary in " + std::string(1, "xyz"[d]) +
                 ": it must stay half a support, " + text(apart) + ", away from it");
}

void FixWallSph::post_force(int /*vflag*/)
{
  for (double &f : on_wall) f = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double *x = atom->x[i];
    if (axis < 0) {
      const double rho = sqrt(x[0] * x[0] + x[1] * x[1]), r = radius - rho;
      if (r >= r0 || rho == 0.0) continue;    // on the axis the wall pushes from all sides
      const double inward[3] = {-x[0] / rho, -x[1] / rho, 0.0};
      push(i, inward, r, 0.0);
      continue;
    }
    for (int side = 0; side < 2; side++) {
      if (!has[side]) continue;
      const double sign = side ? -1.0 : 1.0, r = sign * (x[axis] - at[side]);
      if (r >= r0) continue;
      double inward[3] = {0.0, 0.0, 0.0};
      inward[axis] = sign;
      push(i, inward, r, 0.0);
    }
  }
}

// --- any region ---------------------------------------------------------------------------------

FixWallRegionSph::FixWallRegionSph(LAMMPS *lmp, int narg, char **arg) :
    FixRepulsiveWall(lmp, narg, arg)
{
  if (narg < 4) voice.fail("the region is missing");
  region_id = arg[3];
  if (!Compat::region(domain, region_id)) voice.fail("region '" + region_id + "' does not exist");
  Keywords in = keywords(narg, arg);
  in.next();
  r0 = in.value("r0").positive();
  D = in.value("D").not_negative();
  in.parse({});
}

void FixWallRegionSph::init()
{
  pair = PairSph::of(voice);
  find_region();
}

/* A run with 'pre no' may find it deleted or made anew. */
void FixWallRegionSph::find_region()
{
  region = Compat::region_of_step(domain, update, region_id);
  if (!region) voice.fail("region '" + region_id + "' does not exist");
}

/* Repulsion, and the pressure of a mirror particle at the wall. */
void FixWallRegionSph::post_force(int /*vflag*/)
{
  for (double &f : on_wall) f = 0.0;
  find_region();
  region->prematch();
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double *x = atom->x[i];
    if (!region->match(x[0], x[1], x[2])) outside(i);
    const int n = region->surface(x[0], x[1], x[2], r0);
    for (int k = 0; k < n; k++) {
      const auto &contact = region->contact[k];
      const double r = contact.r;
      if (!(r < r0)) continue;
      if (!(r > 0.0)) outside(i);
      const double normal[3] = {contact.delx / r, contact.dely / r, contact.delz / r};
      const double mirror = sd_sph_mirror(Sph::mass(lmp, i), pair->pressure(i) - pair->reference_pressure(),
                                          atom->rho[i], pair->dW_dr(atom->type[i], r));
      push(i, normal, r, mirror);
    }
  }
}

// --- walls of particles -------------------------------------------------------------------------

FixWallAdamiSph::FixWallAdamiSph(LAMMPS *lmp, int narg, char **arg) :
    WallFix(lmp, narg, arg), motion(6)
{
  Sph::require_scene(voice);
  Keywords in = keywords(narg, arg);
  in.parse({
      {"gravity",
       [&] {
         gravity.parse(in);
       }},
      {"slip",
       [&] {
         slip = in.yes_no();
       }},
      {"suction",
       [&] {
         suction = in.yes_no();
       }},
      {"own_acceleration",
       [&] {
         own_acceleration = in.yes_no();
       }},
  });
  if (own_acceleration) keep({&motion}, nullptr, true);
}

void FixWallAdamiSph::init()
{
  Sph::require_pair(voice);
  gravity.init(lmp);
}

const double *FixWallAdamiSph::body_force(int i, const double v[3], double tau)
{
  const bool is_new = own_acceleration && !motion.has(i);
  // fix rigid and fix move give it its velocity after the setup
  if (!own_acceleration || (is_new && update->setupflag)) return gravity.now();
  double *row = motion.writable(i);
  if (is_new) std::copy_n(v, 3, row);
  if (!update->setupflag) sd_sph_wall_acceleration(v, update->dt, tau, row, row + 3);
  for (int d = 0; d < 3; d++) b[d] = gravity.now()[d] - row[3 + d];
  return b;
}
