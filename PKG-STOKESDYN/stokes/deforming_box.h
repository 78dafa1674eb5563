/* The box that fix deform changes: how it moves now, as a flow, and what goes with that.
 *
 * LAMMPS's own rates (Domain::h_rate) are those of the step before for some styles, and missing for
 * others; these are of the present moment for all, whether the box has been flipped or not. */
#ifndef SD_DEFORMING_BOX_H
#define SD_DEFORMING_BOX_H

#include "keywords.h"

namespace StokesDyn {

struct BoxMotion {
  /* is there a fix deform? Otherwise all is 0 */
  bool deforms = false;
  /* d u_p / d x_q of the flow that takes the box along, row-major */
  double gradient[9] = {0.0};
  /* the corner xlo ylo zlo, and its velocity */
  double corner[3] = {0.0}, corner_velocity[3] = {0.0};

  /* Velocity at x: that of LAMMPS's h_rate, lambda and h_ratelo */
  void at(const double *x, double *u) const
  {
    for (int p = 0; p < 3; p++) {
      u[p] = corner_velocity[p];
      for (int q = 0; q < 3; q++) u[p] += gradient[3 * p + q] * (x[q] - corner[q]);
    }
  }
};

/* Of this step. Error: a style of fix deform that says no rate (deform/pressure). */
BoxMotion motion_of_box(const Voice &voice);

/* Does fix deform change the box as the fluid and the spheres need it? Errors that name it:
 *   remap x      moves the spheres with the box; where the fluid carries them they would move twice
 *   remap none   a sphere with inertia that crosses a face keeps the velocity of the other side
 * inertia: velocities are LAMMPS's; moving: the fluid does not rest; clumps: rigid ones */
void check_deform(const Voice &voice, bool inertia, bool moving,
                  bool clumps);

/* Fixes that go on with the velocity of an atom when it crosses a face of the box: fix move, and fix
 * rigid*, whose atoms all have the velocity that belongs to one image of the body. So no atom of theirs
 * may be in another image along an edge whose images move with the fluid. jump: that of
 * Ambient::jumps(), nullptr: there is no such edge. Error, on all ranks: an atom that is, with fix and
 * step. */
void check_images(const Voice &voice, const double *jump);

/* LAMMPS brings the box to a step at the end of it, and until then forces know that of the step
 * before. This does it now, so that positions, box and forces are of one moment; LAMMPS's own turn
 * then finds it done. On all ranks. */
void bring_box_to_this_step(LAMMPS_NS::LAMMPS *lmp);

}    // namespace StokesDyn
#endif
