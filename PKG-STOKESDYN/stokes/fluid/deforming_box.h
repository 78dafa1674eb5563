/* The box that fix deform changes: how it moves now, as a flow, and what goes with that.
 *
 * LAMMPS's own rates (Domain::h_rate) are those of the step before for some styles, and missing for
 * others; these are of the present moment for all, whether the box has been flipped or not. */
#ifndef SD_DEFORMING_BOX_H
#define SD_DEFORMING_BOX_H

#include "keywords.h"

#include "sd_box_flow.h"

namespace LAMMPS_NS {
class Domain;
class Fix;
}

namespace StokesDyn {

struct BoxMotion {
  /* is there a fix deform? Otherwise all is 0 */
  bool deforms = false;
  /* that takes the box along: LAMMPS's h_rate, lambda and h_ratelo */
  sd_box_flow flow = {};
};

/* nullptr: there is none */
LAMMPS_NS::Fix *deform_of(LAMMPS_NS::LAMMPS *);

/* Of this step, or so many steps later. Error: a style of fix deform that says no rate (deform/pressure). */
BoxMotion motion_of_box(const Voice &voice, double later = 0.0);

/* LAMMPS brings the box to a step at the end of it, and until then forces know that of the step
 * before. This does it now, so that positions, box and forces are of one moment; LAMMPS's own turn
 * then finds it done. On all ranks. */
void bring_box_to_this_step(LAMMPS_NS::LAMMPS *lmp);

/* LAMMPS's box, and another one in its place. On all ranks. */
sd_box box_of(const LAMMPS_NS::Domain *);
void put_box(LAMMPS_NS::Domain *, const sd_box &);

}    // namespace StokesDyn
#endif
