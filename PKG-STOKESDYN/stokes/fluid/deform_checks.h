/* What a box that fix deform changes does not go with. */
#ifndef SD_DEFORM_CHECKS_H
#define SD_DEFORM_CHECKS_H

#include "deforming_box.h"

namespace StokesDyn {

/* Does fix deform change the box as the fluid and the spheres need it? Errors that name it:
 *   remap x      moves the spheres with the box; where the fluid carries them they would move twice
 *   remap none   a sphere with inertia that crosses a face keeps the velocity of the other side
 * inertia: velocities are LAMMPS's; moving: the fluid does not rest; clumps: rigid ones */
void check_deform(const Voice &voice, bool inertia, bool moving, bool clumps);

/* The fluid cannot be compressed. A warning, if it is to follow a box whose volume changes by more than
 * rounding. Was it given? */
bool warn_of_volume(const Voice &voice, const BoxMotion &motion);

/* Fixes that go on with the velocity of an atom when it crosses a face of the box: fix move, and fix
 * rigid*, whose atoms all have the velocity that belongs to one image of the body. So no atom of theirs
 * may be in another image along an edge whose images move with the fluid. jump: that of
 * Ambient::jumps(), nullptr: there is no such edge. Error, on all ranks: an atom that is, with fix and
 * step. */
void check_images(const Voice &voice, const double *jump);

/* Does fix deform follow such a flow in a step? It takes a tilt that is nearest to the last one, which is
 * another one beyond half an edge. Error: the box strains by more, at least nearly. */
void check_strain(const Voice &voice, const BoxMotion &motion);

}    // namespace StokesDyn
#endif
