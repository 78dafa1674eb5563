/* The box that fix deform changes: how it moves now, as a flow, and what goes with that.
 *
 * LAMMPS's own rates (Domain::h_rate) are those of the step before for some styles, and missing for
 * others; these are of the present moment for all, whether the box has been flipped or not. */
#ifndef SD_DEFORMING_BOX_H
#define SD_DEFORMING_BOX_H

#include "keywords.h"

#include "sd_lattice.h"

namespace LAMMPS_NS {
class Domain;
}

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

/* Of this step, or so many steps later. Error: a style of fix deform that says no rate (deform/pressure). */
BoxMotion motion_of_box(const Voice &voice, double later = 0.0);

/* Does fix deform change the box as the fluid and the spheres need it? Errors that name it:
 *   remap x      moves the spheres with the box; where the fluid carries them they would move twice
 *   remap none   a sphere with inertia that crosses a face keeps the velocity of the other side
 * inertia: velocities are LAMMPS's; moving: the fluid does not rest; clumps: rigid ones */
void check_deform(const Voice &voice, bool inertia, bool moving,
                  bool clumps);

/* The fluid cannot be compressed. A warning, if it is to follow a box whose volume changes by more than
 * rounding. Was it given? */
bool warn_of_volume(const Voice &voice, const BoxMotion &flow);

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

/* Does fix deform follow such a flow in a step? It takes a tilt that is nearest to the last one, which is
 * another one beyond half an edge. Error: the box strains by more, at least nearly. */
void check_strain(const Voice &voice, const BoxMotion &flow);

/* LAMMPS's box, and another one in its place. On all ranks. */
sd_box box_of(const LAMMPS_NS::Domain *);
void put_box(LAMMPS_NS::Domain *, const sd_box &);
/* The box `now`, as it is a time t later: exact where edges change evenly, else to second order */
sd_box box_later(const BoxMotion &flow, const sd_box &now, double t);

/* How far bodies go in the half step from the start of a step, or in all of it by velocities of its
 * middle. */
struct StepWithBox {
  double t;    // how long they go
  /* Does the flow take the box along? Then velocities beyond that of the box count, which are the same for
   * a body and its images, and the box carries what has been moved (sd_box_step) */
  bool carried = false;
  sd_box start = {}, at = {}, to = {};
  /* where velocities are of */
  BoxMotion flow = {};
  /* step [3] of a body that is at x when the step starts, by V [3], which it has at `place` in the box
   * `at`. Not carried: t V */
  void displacement(const double *V, const double *place, const double *x, double *step) const;
};

}    // namespace StokesDyn
#endif
