#include "deform_checks.h"

#include "deform_settings.h"
#include "fixes.h"
#include "ranks.h"

#include "atom.h"
#include "domain.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

void check_deform(const Voice &voice, bool inertia, bool moving, bool clumps)
{
  Fix *deform = deform_of(voice.lmp);
  if (!deform) return;
  const Voice name = voice.of(name_of(deform));
  if (moving && plain_style(deform->style) != "deform")    // such as deform/pressure
    name.fail("its rates are not known to the pair style: use fix deform, or fluid_velocity 0 0 0");
  const int remap = DeformSettings::remap(deform);
  const bool x = remap == Domain::X_REMAP, v = remap == Domain::V_REMAP;
  if (x && moving)
    name.fail("remap x moves the spheres with the box, and the fluid carries them as well (keyword "
              "fluid_velocity): they would move twice; use remap v");
  if (x && clumps)
    name.fail("remap x moves the spheres of a rigid clump apart: use remap v and fluid_velocity "
              "box");
  if (inertia && moving && !v)
    name.fail("a sphere that crosses a face of the box needs the velocity of its image, since the "
              "fluid moves with the box (keyword fluid_velocity): use remap v");
}

bool warn_of_volume(const Voice &voice, const BoxMotion &motion)
{
  const double *G = motion.flow.gradient, grows = G[0] + G[4] + G[8];
  double largest = 0.0;
  for (int k = 0; k < 9; k++) largest = std::max(largest, fabs(G[k]));
  if (!(fabs(grows) > 1e-9 * largest)) return false;
  voice.at_step().warn("keyword fluid_velocity: " + name_of(deform_of(voice.lmp)) +
                       " changes the volume of the box, by " + text(grows) + " of it per time, and the fluid, which "
                       "cannot be compressed, is to follow: let the volume stand, as with x trate R y volume z volume");
  return true;
}

void check_images(const Voice &voice, const double *jump)
{
  if (!jump) return;
  static const int EDGE_OF[6] = {0, 1, 2, 2, 2, 1};
  bool moves[3] = {false, false, false};
  double largest = 0.0;
  for (int k = 0; k < 6; k++) largest = std::max(largest, fabs(jump[k]));
  for (int k = 0; k < 6; k++) moves[EDGE_OF[k]] |= fabs(jump[k]) > 1e-9 * largest;
  LAMMPS *lmp = voice.lmp;
  const Atom *atom = lmp->atom;
  const auto elsewhere = [&](int i) {
    const imageint image = atom->image[i];
    return (moves[0] && (image & IMGMASK) != IMGMAX) ||
        (moves[1] && (image >> IMGBITS & IMGMASK) != IMGMAX) ||
        (moves[2] && image >> IMG2BITS != IMGMAX);
  };
  for (int f = 0; f < lmp->modify->nfix; f++) {
    Fix *fix = lmp->modify->fix[f];
    const bool rigid = utils::strmatch(fix->style, "^rigid");
    if (!rigid && !utils::strmatch(fix->style, "^move")) continue;
    int dim = 0;
    const int *body = rigid ? (const int *) fix->extract("body", dim) : nullptr;
    const tagint first = first_atom(lmp, [&](int i) {
      return (body ? body[i] >= 0 : (atom->mask[i] & fix->groupbit) != 0) && elsewhere(i);
    });
    if (first != 0)
      voice.of(name_of(fix)).at_step().fail(
          "atom " + std::to_string(first) + " has crossed a face of the box (its image flags are not "
          "0) whose images move with the fluid (fix deform). This fix keeps the velocity of the atom "
          "there, which is not that of the image: " +
          (rigid ? "use fix stokes_dynamics/overdamped" : "let the atom stay on its side of the face"));
  }
}

void check_strain(const Voice &voice, const BoxMotion &motion)
{
  const sd_box now = box_of(voice.lmp->domain), then = sd_box_later(&motion.flow, &now, voice.lmp->update->dt);
  static const int ALONG[6] = {0, 1, 2, 1, 0, 0};
  double largest = 0.0;
  for (int d = 0; d < 6; d++) largest = std::max(largest, fabs(then.h[d] - now.h[d]) / now.h[ALONG[d]]);
  if (largest > 0.45)
    voice.at_step().fail("the box strains by " + text(largest) + " of an edge in a step, and fix deform cannot "
                         "follow: use a shorter time step");
}

}    // namespace StokesDyn
